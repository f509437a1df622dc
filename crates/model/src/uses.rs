//! The line with which a file takes in another one.

use crate::{Name, Place};

/// `use 'lib/axis.g7'`: the items of another file; `use debounce`: those of a part of the library that comes with G7.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// The path of the file as it is written, or the name of the part.
    pub name: Name,
    /// True for a part of the library.
    pub library: bool,
    /// Where it stands.
    pub at: Place,
}
