//! PL7 pages: 14 lines of 11 cells each. The first line holds the connectors that arrive, the last
//! line those that leave; between them stand six lines of steps, each with a line of transitions
//! under it.
//!
//! `cells` follows the sequences and gives each symbol its cell; `grid` computes the size of the cells and the links
//! between them. Sheets of paper (`paper`) take the symbols in the same order.

mod cells;
mod grid;

pub(crate) use cells::{Cells, cells};
pub(crate) use grid::place;
