//! Charts on sheets of paper: `sheets` puts as many symbols on each as fit, in the order in which `pages` follows the
//! sequences; `part` lays the symbols of a sheet out with a `stub` for each end of a link that leads to another one; `frame`
//! is the paper itself.

mod frame;
mod part;
mod sheets;
mod stub;
#[cfg(test)]
mod tests;

pub use frame::{Field, MM, Page, Paper, Size, TitleBlock};
pub use sheets::{Away, Sheet, sheets};
