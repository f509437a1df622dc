//! Charts on pages. `cells` follows the sequences of a chart and gives each symbol its turn.
//!
//! - Pages of PL7: 14 lines of 11 cells each. The first line holds the connectors that arrive, the last
//!   line those that leave; between them stand six lines of steps, each with a line of transitions
//!   under it. `grid` computes the size of the cells and the links between them.
//! - Sheets of paper: `sheets` puts as many symbols on each as fit, in the same order; `part` lays the symbols of a sheet
//!   out with a `stub` for each end of a link that leads to another one; `frame` is the paper itself.

mod cells;
mod frame;
mod grid;
mod part;
mod sheets;
mod stub;
#[cfg(test)]
mod tests;

pub use frame::{Field, MM, Page, Paper, Size, TitleBlock};
pub(crate) use grid::place;
pub use sheets::{Away, Sheet, sheets};

/// Number of columns of a page.
const COLUMNS: u32 = 11;
/// Number of lines of steps of a page.
const LINES: u32 = 6;
