//! XML as it is written: elements with attributes, nothing between them.

use std::fmt::Write;

/// An element.
pub(super) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    pub(super) children: Vec<Element>,
}

impl Element {
    pub(super) fn new(tag: &'static str) -> Element {
        Element { tag, attributes: Vec::new(), children: Vec::new() }
    }

    /// Sets an attribute; one that is there takes the new value.
    pub(super) fn set(&mut self, name: &'static str, value: &str) {
        match self.attributes.iter_mut().find(|(n, _)| *n == name) {
            Some((_, old)) => *old = value.to_string(),
            None => self.attributes.push((name, value.to_string())),
        }
    }

    /// Prints it, two blanks a level. Nesting is bounded by that of terms.
    pub(super) fn print(&self, level: usize, text: &mut String) {
        let blanks = " ".repeat(2 * level);
        let _ = write!(text, "{blanks}<{}", self.tag);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escaped(value));
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.print(level + 1, text);
        }
        let _ = writeln!(text, "{blanks}</{}>", self.tag);
    }
}

/// Text as it stands in an attribute. What XML cannot hold is a question mark.
fn escaped(value: &str) -> String {
    let mut text = String::with_capacity(value.len());
    for c in value.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\n' | '\t' | '\r' => {
                let _ = write!(text, "&#{};", u32::from(c));
            }
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => text.push('?'),
            c => text.push(c),
        }
    }
    text
}
