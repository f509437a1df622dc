//! The differences of the languages of controllers, before any of them is printed: the one translation of a chart
//! ([`super::scan`]) reads them.

/// The choices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// Steps are set and reset; receptivities have memories.
    pub(crate) set_reset: bool,
    /// The controller has the function blocks of IEC 61131-3; otherwise they are printed as assignments.
    pub(crate) own_blocks: bool,
    /// Letters of a name.
    pub(crate) longest: usize,
}

impl Default for Dialect {
    fn default() -> Dialect {
        Dialect { set_reset: false, own_blocks: true, longest: usize::MAX }
    }
}
