//! The text of an attribute with the place of each of its characters.

use std::ops::Range;

use roxmltree::Node;

/// A decoded attribute value with the place of each of its parts.
#[derive(Clone, Debug, Default)]
pub struct Text {
    /// The value, with entities replaced.
    pub text: String,
    /// The place of the value in the file, between the quotes.
    pub at: Range<usize>,
    /// Pairs of offsets: from this byte of the text on, the file continues at that byte.
    jumps: Vec<(usize, usize)>,
}

impl Text {
    /// The place in the file of a range of bytes of the text.
    pub fn place(&self, part: &Range<usize>) -> Range<usize> {
        let start = self.offset(part.start);
        start..self.offset(part.end).max(start)
    }

    fn offset(&self, byte: usize) -> usize {
        let next = self.jumps.partition_point(|(text, _)| *text <= byte);
        match next.checked_sub(1).and_then(|i| self.jumps.get(i)) {
            Some((text, file)) => (file + (byte - text)).min(self.at.end),
            None => (self.at.start + byte).min(self.at.end),
        }
    }
}

/// An attribute's value with its places.
pub fn text(node: Node, name: &str) -> Option<Text> {
    let attribute = node.attribute_node(name)?;
    let at = attribute.range_value();
    let raw = node.document().input_text().get(at.clone())?;
    Some(decode(raw, at))
}

/// Replaces the entities of a value. A well-formed file has no unknown ones.
fn decode(raw: &str, at: Range<usize>) -> Text {
    let mut text = String::with_capacity(raw.len());
    let mut jumps = Vec::new();
    let mut rest = raw;
    while let Some(c) = rest.chars().next() {
        let here = at.end - rest.len();
        let entity = if c == '&' { rest.split_once(';') } else { None };
        if let Some((name, behind)) = entity {
            jumps.push((text.len(), here));
            text.push(entity_char(name).unwrap_or('\u{FFFD}'));
            rest = behind;
            jumps.push((text.len(), at.end - rest.len()));
        } else {
            // XML reads a line end or tab in an attribute as a blank.
            text.push(if matches!(c, '\n' | '\r' | '\t') { ' ' } else { c });
            rest = rest.get(c.len_utf8()..).unwrap_or("");
        }
    }
    Text { text, at, jumps }
}

/// The character of an entity, given with its `&`.
fn entity_char(name: &str) -> Option<char> {
    match name.strip_prefix('&')? {
        "lt" => Some('<'),
        "gt" => Some('>'),
        "amp" => Some('&'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        number => {
            let number = number.strip_prefix('#')?;
            let code = match number.strip_prefix('x') {
                Some(hex) => u32::from_str_radix(hex, 16).ok()?,
                None => number.parse().ok()?,
            };
            char::from_u32(code)
        }
    }
}

/// The start tag of an element, which messages underline.
pub fn head(node: Node) -> Range<usize> {
    let whole = node.range();
    let from = node.attributes().map(|a| a.range().end).max().unwrap_or(whole.start);
    let input = node.document().input_text();
    let tail = input.get(from..whole.end).unwrap_or("");
    let end = tail.find('>').map_or(whole.end, |i| from + i + 1);
    whole.start..end
}

/// The text of an element and its descendants, with its places. It may be marked up in any dialect:
/// in CDATA, in XHTML paragraphs, or bare.
pub fn content(node: Node) -> Text {
    let input = node.document().input_text();
    let start = head(node).end;
    let whole = node.range();
    let inside = input.get(start..whole.end).unwrap_or("");
    let length = if start >= whole.end { 0 } else { inside.rfind("</").unwrap_or(0) };
    let at = start.min(whole.end)..(start + length).min(whole.end).max(start.min(whole.end));
    strip(input.get(at.clone()).unwrap_or(""), at)
}

/// Text without tags and comments, with entities replaced.
fn strip(raw: &str, at: Range<usize>) -> Text {
    let mut out = Text { text: String::with_capacity(raw.len()), at: at.clone(), jumps: Vec::new() };
    let mut rest = raw;
    while let Some(c) = rest.chars().next() {
        let here = at.end - rest.len();
        if let Some(cdata) = rest.strip_prefix("<![CDATA[") {
            let (piece, behind) = cdata.split_once("]]>").unwrap_or((cdata, ""));
            out.jumps.push((out.text.len(), here + 9));
            out.text.push_str(piece);
            rest = behind;
        } else if let Some(note) = rest.strip_prefix("<!--") {
            rest = note.split_once("-->").map_or("", |(_, behind)| behind);
        } else if c == '<' {
            let (tag, behind) = rest.split_once('>').unwrap_or((rest, ""));
            let name = tag.trim_start_matches(['<', '/']).trim_end_matches('/').trim();
            let name = name.split_once(':').map_or(name, |(_, n)| n);
            if matches!(name.split_whitespace().next(), Some("p" | "br" | "div" | "li"))
                && !out.text.is_empty()
            {
                out.text.push('\n');
            }
            rest = behind;
        } else if c == '&' {
            let (name, behind) = rest.split_once(';').unwrap_or((rest, ""));
            out.jumps.push((out.text.len(), here));
            out.text.push(entity_char(name).unwrap_or('\u{FFFD}'));
            rest = behind;
        } else {
            let length = rest.find(['<', '&']).unwrap_or(rest.len());
            out.jumps.push((out.text.len(), here));
            out.text.push_str(rest.get(..length).unwrap_or(""));
            rest = rest.get(length..).unwrap_or("");
        }
    }
    out
}
