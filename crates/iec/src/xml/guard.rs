//! Refuses hostile and broken files before they are read.
//!
//! After [`tree`] the number of elements, their depth, the number of attributes of each and the
//! size of the file are bounded, and no entity has been defined or expanded.

use std::ops::Range;

use g7_model::{Said, codes, say};
use roxmltree::{Document, ParsingOptions};

use crate::report::Report;

/// The largest file that is read. Real charts have some 20 kB.
const MOST_BYTES: usize = 8 << 20;
/// The most elements and texts of a file.
const MOST_NODES: u32 = 400_000;
/// The deepest nesting of elements; a macro-step in a macro-step takes two.
const DEEPEST: usize = 100;
/// The most attributes of one element, because the XML reader compares each with each.
const MOST_ATTRIBUTES: usize = 200;

/// The text of the file, if it is UTF-8.
pub fn text<'a>(bytes: &'a [u8], report: &mut Report) -> Option<&'a str> {
    if bytes.len() > MOST_BYTES {
        let what = say!("the file has {} bytes; at most {MOST_BYTES} are read", bytes.len());
        report.say(&codes::TOO_LARGE, &(0..0), what);
        return None;
    }
    if wide(bytes).is_some() {
        report.say(&codes::BAD_ENCODING, &(0..0), say!("the file is UTF-16; save it as UTF-8"));
        return None;
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Some(text),
        Err(error) => {
            let at = error.valid_up_to();
            let what = match declared(bytes) {
                Some(name) => {
                    say!("the file is declared as {} and is not UTF-8; save it as UTF-8", Said::foreign(name))
                }
                None => say!("the file is not UTF-8 text; save it as UTF-8"),
            };
            report.say(&codes::BAD_ENCODING, &(at..at + 1), what);
            None
        }
    }
}

/// The elements of the file, if it is well-formed and within the limits.
pub fn tree<'a>(text: &'a str, report: &mut Report) -> Option<Document<'a>> {
    if let Some(name) = declared(text.as_bytes())
        && !name.eq_ignore_ascii_case("utf-8")
        && !name.eq_ignore_ascii_case("us-ascii")
        && let Some(at) = text.bytes().position(|b| b >= 0x80)
    {
        let what = say!("the file is declared as {}; save it as UTF-8", Said::foreign(name));
        report.say(&codes::BAD_ENCODING, &(at..at + 1), what);
        return None;
    }
    survey(text.as_bytes(), report)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    match Document::parse_with_options(text, options) {
        Ok(tree) => Some(tree),
        Err(roxmltree::Error::NodesLimitReached) => {
            let what = say!("the file has more than {MOST_NODES} elements");
            report.say(&codes::TOO_LARGE, &(0..0), what);
            None
        }
        Err(error) => {
            let at = offset(text, error.pos());
            report.say(
                &codes::BAD_XML,
                &(at..at),
                say!("not well-formed XML: {}", Said::foreign(plain(&error))),
            );
            None
        }
    }
}

/// The message of the XML reader without its line number, because the problem has a place.
fn plain(error: &roxmltree::Error) -> String {
    let text = error.to_string();
    let tail = format!(" at {}", error.pos());
    text.strip_suffix(&tail).unwrap_or(&text).replace('\'', "`")
}

/// The offset of a line and column, both counted from 1.
fn offset(text: &str, at: roxmltree::TextPos) -> usize {
    let row = usize::try_from(at.row).unwrap_or(1).max(1);
    let col = usize::try_from(at.col).unwrap_or(1).max(1);
    let start =
        if row == 1 { 0 } else { text.match_indices('\n').nth(row - 2).map_or(text.len(), |(i, _)| i + 1) };
    let line = text.get(start..).unwrap_or("");
    start + line.char_indices().nth(col - 1).map_or(line.len(), |(i, _)| i)
}

/// Checks the limits tag by tag, without recursion.
fn survey(bytes: &[u8], report: &mut Report) -> Option<()> {
    let mut depth = 0usize;
    let mut i = 0;
    while let Some(open) = find(bytes, i, b"<") {
        let rest = bytes.get(open..).unwrap_or(&[]);
        if rest.starts_with(b"<!--") {
            i = find(bytes, open + 4, b"-->").map_or(bytes.len(), |e| e + 3);
        } else if rest.starts_with(b"<![CDATA[") {
            i = find(bytes, open + 9, b"]]>").map_or(bytes.len(), |e| e + 3);
        } else if rest.starts_with(b"<?") {
            i = find(bytes, open + 2, b"?>").map_or(bytes.len(), |e| e + 2);
        } else if rest.starts_with(b"<!") {
            let at = open..(open + 9).min(bytes.len());
            report.say(
                &codes::BAD_XML,
                &at,
                say!("a document type declaration; JGrafchart writes none and none is read"),
            );
            return None;
        } else {
            let tag = Tag::read(bytes, open);
            if tag.attributes > MOST_ATTRIBUTES {
                let what = say!("an element with more than {MOST_ATTRIBUTES} attributes");
                report.say(&codes::TOO_LARGE, &(open..open + 1), what);
                return None;
            }
            if tag.closing {
                depth = depth.saturating_sub(1);
            } else if !tag.empty {
                depth += 1;
            }
            if depth > DEEPEST {
                let what = say!("elements nested more than {DEEPEST} deep");
                report.say(&codes::TOO_DEEP, &(open..open + 1), what);
                return None;
            }
            i = tag.end;
        }
    }
    Some(())
}

/// A tag, as far as the check needs it.
struct Tag {
    end: usize,
    closing: bool,
    empty: bool,
    attributes: usize,
}

impl Tag {
    /// Reads the tag at `open`. It ends behind its `>`, before the next `<`, or at the end of the
    /// file.
    fn read(bytes: &[u8], open: usize) -> Tag {
        let mut tag = Tag { end: bytes.len(), closing: false, empty: false, attributes: 0 };
        let mut quote = None;
        let mut last = b'<';
        for (i, &b) in bytes.iter().enumerate().skip(open + 1) {
            match (quote, b) {
                (Some(q), _) if q == b => quote = None,
                (Some(_), b'<') | (None, b'<') => {
                    tag.end = i;
                    return tag;
                }
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(b),
                (None, b'=') => tag.attributes += 1,
                (None, b'/') if last == b'<' => tag.closing = true,
                (None, b'>') => {
                    tag.empty = last == b'/' && !tag.closing;
                    tag.end = i + 1;
                    return tag;
                }
                (None, _) => {}
            }
            last = b;
        }
        tag
    }
}

/// The first occurrence of `what` at or behind `from`.
fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    let first = *what.first()?;
    let mut i = from;
    loop {
        let rest = bytes.get(i..)?;
        let step = rest.iter().position(|&b| b == first)?;
        if rest.get(step..).is_some_and(|r| r.starts_with(what)) {
            return Some(i + step);
        }
        i += step + 1;
    }
}

/// The encoding named by the XML declaration.
fn declared(bytes: &[u8]) -> Option<String> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let head = bytes.get(..find(bytes, 0, b"?>")?.min(200))?;
    let head = head.strip_prefix(b"<?xml")?;
    let rest = head.get(find(head, 0, b"encoding")? + 8..)?;
    let text: String = rest.iter().map(|&b| char::from(b)).collect();
    let value = text.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    value.get(1..)?.split(quote).next().map(str::to_string)
}

/// The byte order of a file in UTF-16; None for any other file.
fn wide(bytes: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match bytes.get(..4)? {
        [0xFF, 0xFE, ..] | [b'<', 0, _, 0] => Some(u16::from_le_bytes),
        [0xFE, 0xFF, ..] | [0, b'<', 0, _] => Some(u16::from_be_bytes),
        _ => None,
    }
}

/// The name of the first element, from the beginning of any file.
pub fn root_name(bytes: &[u8]) -> Option<String> {
    const HEAD: usize = 1 << 16;
    /// Replaces characters beyond Latin letters, above all a byte order mark.
    const MARK: u8 = 0x1A;
    let head = bytes.get(..bytes.len().min(HEAD))?;
    let narrow: Vec<u8> = match wide(head) {
        Some(join) => head
            .chunks_exact(2)
            .filter_map(|pair| <[u8; 2]>::try_from(pair).ok())
            .map(|pair| u8::try_from(join(pair)).unwrap_or(MARK))
            .collect(),
        None => head.to_vec(),
    };
    let mut i =
        if narrow.starts_with(b"\xEF\xBB\xBF") { 3 } else { usize::from(narrow.first() == Some(&MARK)) };
    loop {
        let open = i + narrow.get(i..)?.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = narrow.get(open..).filter(|r| r.starts_with(b"<"))?;
        i = if rest.starts_with(b"<!--") {
            find(&narrow, open + 4, b"-->")? + 3
        } else if rest.starts_with(b"<?") {
            find(&narrow, open + 2, b"?>")? + 2
        } else if rest.starts_with(b"<!") {
            find(&narrow, open, b">")? + 1
        } else {
            let name: Range<usize> = open + 1..narrow.len();
            let name = narrow.get(name)?;
            let end = name.iter().position(|b| b.is_ascii_whitespace() || matches!(b, b'>' | b'/' | b'<'));
            return Some(String::from_utf8_lossy(name.get(..end.unwrap_or(name.len()))?).into_owned());
        };
    }
}
