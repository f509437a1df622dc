//! Bytes of a file to text.

use crate::problems::Problems;
use g7_model::{FileId, Problem, Said, Span, codes, say};
use std::borrow::Cow;

/// Replaces each byte that is not UTF-8, so that all offsets stay those of the file.
pub(crate) const SUBSTITUTE: char = '\u{1a}';

/// The largest size of a file, in bytes.
pub(crate) const MOST_BYTES: usize = 64 << 20;

/// The text of a file's bytes. Each byte that is not UTF-8 is replaced by one
/// control character, so that spans into the text are spans into the file too.
pub fn decode(bytes: &[u8], file: FileId) -> (Cow<'_, str>, Vec<Problem>) {
    let mut problems = Problems::default();
    if let Some(problem) = too_large(bytes.len(), file) {
        problems.add(problem.at, || problem);
        return (Cow::Borrowed(""), problems.finish());
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return (Cow::Borrowed(text), problems.finish());
    }
    let utf16 = matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]);
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        let start = text.len();
        text.extend(chunk.invalid().iter().map(|_| SUBSTITUTE));
        if text.len() > start && !(utf16 && start > 0) {
            let at = span(file, start, text.len());
            problems.add(at, || broken(at, chunk.invalid(), utf16));
        }
    }
    (Cow::Owned(text), problems.finish())
}

/// The problem of a file that is too large to read.
pub(crate) fn too_large(len: usize, file: FileId) -> Option<Problem> {
    (len > MOST_BYTES).then(|| {
        let what = say!("the file has {len} bytes; at most {MOST_BYTES} are read");
        Problem::new(&codes::TOO_LARGE, span(file, 0, 0), what)
    })
}

fn broken(at: Span, bytes: &[u8], utf16: bool) -> Problem {
    if utf16 {
        let help = say!("save the file as UTF-8");
        return Problem::new(&codes::BAD_ENCODING, at, say!("the file is UTF-16 text")).help(help);
    }
    let hex: Vec<String> = bytes.iter().map(|b| format!("{b:02X}")).collect();
    let what = say!("byte {} is not UTF-8", Said::foreign(hex.join(" ")));
    Problem::new(&codes::BAD_ENCODING, at, what).help(say!("save the file as UTF-8"))
}

fn span(file: FileId, start: usize, end: usize) -> Span {
    let clamp = |n| u32::try_from(n).unwrap_or(u32::MAX);
    Span { file, start: clamp(start), end: clamp(end) }
}
