//! PL7 pages: 14 lines of 11 cells each. The first line holds the connectors that
//! arrive, the last those that leave; between them stand six lines of steps, each
//! with a line of transitions under it.
//!
//! `cells` says which cell each symbol has, `paper` how large the cells are and
//! how the links run between them.

mod cells;
mod paper;

pub(crate) use paper::place;

/// Columns of a page.
const COLUMNS: u32 = 11;
/// Lines of steps of a page.
const LINES: u32 = 6;
