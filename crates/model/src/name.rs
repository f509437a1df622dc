//! Names as the author wrote them, and parameters: names with a type.
//!
//! All other files of the document use this one; it knows places and types only.

use crate::{Place, Span, Type};

/// A name with its place. Text without back-ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// As the author wrote it.
    pub text: Box<str>,
    /// Where it stands.
    pub at: Place,
}

impl Name {
    /// A name at a place.
    pub fn new(text: impl Into<Box<str>>, at: Span) -> Name {
        Name { text: text.into(), at: at.into() }
    }
}

/// A parameter of a function, or an attribute of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: Type,
}
