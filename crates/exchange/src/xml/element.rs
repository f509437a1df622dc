//! XML as it is written.

use std::fmt::Write;

/// An element with its attributes, and elements or text within.
pub(crate) struct Element {
    tag: String,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
    text: String,
}

impl Element {
    pub(crate) fn new(tag: &str) -> Element {
        Element { tag: tag.to_string(), attributes: Vec::new(), children: Vec::new(), text: String::new() }
    }

    pub(crate) fn with(mut self, name: &'static str, value: impl ToString) -> Element {
        self.attributes.push((name, value.to_string()));
        self
    }

    pub(crate) fn child(mut self, child: Element) -> Element {
        self.children.push(child);
        self
    }

    pub(crate) fn children(mut self, children: impl IntoIterator<Item = Element>) -> Element {
        self.children.extend(children);
        self
    }

    /// The same under another name.
    pub(crate) fn renamed(mut self, tag: &str) -> Element {
        self.tag = tag.to_string();
        self
    }

    pub(crate) fn push(&mut self, child: Element) {
        self.children.push(child);
    }

    /// Text in the paragraph of XHTML that TC6 wants round it.
    pub(crate) fn formatted(tag: &str, text: &str) -> Element {
        let mut inner = Element::new("xhtml").with("xmlns", "http://www.w3.org/1999/xhtml");
        inner.text = text.to_string();
        Element::new(tag).child(inner)
    }

    /// Prints it, two blanks a level.
    pub(crate) fn print(&self, level: usize, text: &mut String) {
        let blanks = " ".repeat(2 * level);
        let _ = write!(text, "{blanks}<{}", self.tag);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escaped(value, true));
        }
        if !self.text.is_empty() {
            let _ = writeln!(text, ">{}</{}>", escaped(&self.text, false), self.tag);
            return;
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

/// Text as it stands in an element or attribute. What XML cannot hold is a question mark.
fn escaped(value: &str, attribute: bool) -> String {
    let mut text = String::with_capacity(value.len());
    for c in value.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' if attribute => text.push_str("&quot;"),
            '\n' | '\t' if !attribute => text.push(c),
            '\n' | '\t' | '\r' => {
                let _ = write!(text, "&#{};", u32::from(c));
            }
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => text.push('?'),
            c => text.push(c),
        }
    }
    text
}
