//! Places of a text and changes of it, as they are sent: in UTF-16 code units.

use std::ops::Range;

use g7_edit::Splice;
use g7_ide::{File, Positions};
use serde::{Deserialize, Serialize};

/// A replacement in a text; places are in code units.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Splice"))]
pub(crate) struct Change {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) insert: String,
}

/// Converts splices to code units of the text before them.
pub(crate) fn outward(file: &File, splices: &[Splice]) -> Vec<Change> {
    changes(&file.positions, file.text(), splices)
}

/// The same for a text that is no longer that of the file.
pub(crate) fn changes(positions: &Positions, text: &str, splices: &[Splice]) -> Vec<Change> {
    let unit = |byte| positions.unit(text, byte);
    let change = |s: &Splice| Change { from: unit(s.start), to: unit(s.end), insert: s.insert.clone() };
    splices.iter().map(change).collect()
}

/// Converts changes to splices.
pub(crate) fn inward(file: &File, changes: &[Change]) -> Vec<Splice> {
    let byte = |unit| file.positions.byte(file.text(), unit);
    changes.iter().map(|s| Splice::new(byte(s.from), byte(s.to), s.insert.as_str())).collect()
}

/// A range of bytes in code units.
pub(crate) fn units(file: &File, range: &Range<usize>) -> (usize, usize) {
    let unit = |byte| file.positions.unit(file.text(), byte);
    (unit(range.start), unit(range.end))
}
