//! A printed file, and the choice of files; made by [`crate::print_as`] and by what puts files together.

/// A file that was printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// How the C code of a chart is put into files; Rust is one file in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parts {
    /// A header and a source file that need no other.
    #[default]
    Whole,
    /// The chart apart from what is the same for all charts: `g7.h` and `g7.c`, which a program has once.
    Apart,
    /// One file that a compiler takes as it is.
    One,
}
