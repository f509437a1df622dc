//! Places of a text as the protocol has them: lines, and UTF-16 code units on a line.

use std::ops;

use g7_edit::Splice;
use g7_ide::{File, Positions};
use lsp_types::{Position, Range, TextEdit};

/// A byte of a text as a position.
pub(super) fn position(positions: &Positions, text: &str, byte: usize) -> Position {
    let (line, unit) = positions.line_unit(text, byte);
    let whole = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Position::new(whole(line), whole(unit))
}

/// A position as a byte of a text; one beyond the end of a line is that end.
pub(super) fn byte(positions: &Positions, text: &str, at: Position) -> usize {
    positions.at_line_unit(text, at.line as usize, at.character as usize)
}

/// A range of bytes of a file.
pub(super) fn range(file: &File, bytes: &ops::Range<usize>) -> Range {
    let place = |byte| position(&file.positions, file.text(), byte);
    Range::new(place(bytes.start), place(bytes.end))
}

/// The bytes of a range of a file.
pub(super) fn bytes(file: &File, range: Range) -> ops::Range<usize> {
    let place = |at| byte(&file.positions, file.text(), at);
    let start = place(range.start);
    start..place(range.end).max(start)
}

/// A change of the text of a file.
pub(super) fn edits(file: &File, splices: &[Splice]) -> Vec<TextEdit> {
    let edit = |s: &Splice| TextEdit::new(range(file, &(s.start..s.end)), s.insert.clone());
    splices.iter().map(edit).collect()
}
