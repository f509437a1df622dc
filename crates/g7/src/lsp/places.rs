//! Places of a text as the protocol has them: lines, and UTF-16 code units on a line.

use std::ops;
use std::path::{Path, PathBuf};

use g7_edit::Splice;
use g7_ide::{File, Positions};
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
    range_of(&file.positions, file.text(), bytes)
}

/// A range of bytes of a text.
pub(super) fn range_of(positions: &Positions, text: &str, bytes: &ops::Range<usize>) -> Range {
    Range::new(position(positions, text, bytes.start), position(positions, text, bytes.end))
}

/// The bytes of a range of a file.
pub(super) fn bytes(file: &File, range: Range) -> ops::Range<usize> {
    let place = |at| byte(&file.positions, file.text(), at);
    let start = place(range.start);
    start..place(range.end).max(start)
}

/// A change of the text of a file.
pub(super) fn edits(file: &File, splices: &[Splice]) -> Vec<TextEdit> {
    edits_of(&file.positions, file.text(), splices)
}

/// A change of a text.
pub(super) fn edits_of(positions: &Positions, text: &str, splices: &[Splice]) -> Vec<TextEdit> {
    let edit = |s: &Splice| TextEdit::new(range_of(positions, text, &(s.start..s.end)), s.insert.clone());
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

/// A part of a path, as an address has it.
fn escaped(part: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'.' | b'_' | b'~');
    let written = |b: u8| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") };
    part.bytes().map(written).collect()
}

/// The address of a file by its whole path.
pub(super) fn uri(path: &Path) -> Option<Uri> {
    let path = path.to_str()?.replace('\\', "/");
    let parts: Vec<String> = path.trim_start_matches('/').split('/').map(escaped).collect();
    format!("file:///{}", parts.join("/")).parse().ok()
}

/// The address of a file by its path from the folder of another one; the parts of the path are separated by `/`.
pub(super) fn beside(uri: &Uri, path: &str) -> Option<Uri> {
    let (mut folder, _) = uri.as_str().rsplit_once('/')?;
    let mut rest = path;
    while let Some(up) = rest.strip_prefix("../") {
        (folder, _) = folder.rsplit_once('/')?;
        rest = up;
    }
    format!("{folder}/{}", rest.split('/').map(escaped).collect::<Vec<_>>().join("/")).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_beside_another_one_leads_to_its_path() {
        let head: Uri = "file:///plant/x/a.g7".parse().expect("an address");
        let beside = |path| beside(&head, path).expect("an address");
        assert_eq!(beside("line 2/é%.g7").as_str(), "file:///plant/x/line%202/%C3%A9%25.g7");
        assert_eq!(beside("../b.g7").as_str(), "file:///plant/b.g7");
        assert_eq!(path(&beside("line 2/é%.g7")), Some(PathBuf::from("/plant/x/line 2/é%.g7")));
        let whole = uri(std::path::Path::new("/plant/x/line 2/é%.g7")).expect("an address");
        assert_eq!(whole, beside("line 2/é%.g7"));
        assert_eq!(path(&"untitled:a".parse().expect("an address")), None);
    }
}
