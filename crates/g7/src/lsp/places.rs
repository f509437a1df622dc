//! Places of a text as the protocol has them: lines, and UTF-16 code units on a line.

use std::ops;
use std::path::PathBuf;

use g7_edit::Splice;
use g7_ide::{File, Positions};
use g7_rig::Source;
use lsp_types::{Position, Range, TextEdit, Uri};

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

/// A range of bytes of a file that an open one uses.
pub(super) fn range_in(source: &Source, bytes: &ops::Range<usize>) -> Range {
    let positions = Positions::new(&source.text);
    let place = |byte| position(&positions, &source.text, byte);
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

/// The path of a file on this machine that an address names.
pub(super) fn path(uri: &Uri) -> Option<PathBuf> {
    if !uri.scheme()?.as_str().eq_ignore_ascii_case("file") {
        return None;
    }
    let path = uri.path().as_estr().decode().into_string().ok()?;
    // `/c:/charts` on Windows.
    let drive = path.as_bytes().get(2) == Some(&b':');
    let path = if drive { path.strip_prefix('/').unwrap_or(&path) } else { &path };
    Some(PathBuf::from(path))
}

/// The address of a file in the folder of another one.
pub(super) fn beside(uri: &Uri, name: &str) -> Option<Uri> {
    let (folder, _) = uri.as_str().rsplit_once('/')?;
    let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'.' | b'_' | b'~');
    let written = |b: u8| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") };
    format!("{folder}/{}", name.bytes().map(written).collect::<String>()).parse().ok()
}
