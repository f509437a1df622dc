//! Writes XML.

use std::fmt::Write;

/// An element with its attributes and either child elements or text.
pub struct Element {
    tag: String,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
    text: String,
    on_one_line: bool,
}

impl Element {
    /// An empty element.
    pub fn new(tag: &str) -> Element {
        Element {
            tag: tag.to_string(),
            attributes: Vec::new(),
            children: Vec::new(),
            text: String::new(),
            on_one_line: false,
        }
    }

    /// An element with text.
    pub fn with_text(tag: &str, text: &str) -> Element {
        Element { text: text.to_string(), ..Element::new(tag) }
    }

    /// The same element, to be printed on one line with all within it.
    pub fn on_one_line(mut self) -> Element {
        self.on_one_line = true;
        self
    }

    /// Adds an attribute.
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Element {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// Adds a child element at the end.
    pub fn child(mut self, child: Element) -> Element {
        self.children.push(child);
        self
    }

    /// Adds child elements at the end.
    pub fn children(mut self, children: impl IntoIterator<Item = Element>) -> Element {
        self.children.extend(children);
        self
    }

    /// The same element with another name.
    pub fn renamed(mut self, tag: &str) -> Element {
        self.tag = tag.to_string();
        self
    }

    /// Sets an attribute; replaces its value if it exists.
    pub fn set(&mut self, name: &'static str, value: &str) {
        match self.attributes.iter_mut().find(|(n, _)| *n == name) {
            Some((_, old)) => *old = value.to_string(),
            None => self.attributes.push((name, value.to_string())),
        }
    }

    /// Adds child elements at the end.
    pub fn extend(&mut self, children: impl IntoIterator<Item = Element>) {
        self.children.extend(children);
    }

    /// Adds a child element at the end.
    pub fn push(&mut self, child: Element) {
        self.children.push(child);
    }

    /// An element with text in the XHTML paragraph that TC6 requires.
    pub fn formatted(tag: &str, text: &str) -> Element {
        let inner = Element::with_text("xhtml", text).with("xmlns", "http://www.w3.org/1999/xhtml");
        Element::new(tag).child(inner)
    }

    /// Writes each text of XHTML in a paragraph `xhtml:p`, whose name space this element declares.
    pub fn in_paragraphs(mut self) -> Element {
        self.paragraphs();
        self.with("xmlns:xhtml", "http://www.w3.org/1999/xhtml")
    }

    fn paragraphs(&mut self) {
        if self.tag == "xhtml" {
            self.tag = "xhtml:p".to_string();
            self.attributes.clear();
        }
        self.children.iter_mut().for_each(Element::paragraphs);
    }

    /// Moves all objects of a drawing to one place and leaves out their sizes, which says that they have none.
    pub fn unplaced(mut self) -> Element {
        if self.tag == "position" {
            self.set("x", "0");
            self.set("y", "0");
        }
        self.attributes.retain(|(name, _)| !matches!(*name, "width" | "height"));
        self.children = self.children.into_iter().map(Element::unplaced).collect();
        self
    }

    /// Prints the element with two blanks of indentation for each level.
    pub fn print(&self, level: usize, text: &mut String) {
        let blanks = " ".repeat(2 * level);
        text.push_str(&blanks);
        if self.on_one_line || self.children.is_empty() {
            self.closely(text);
            text.push('\n');
            return;
        }
        self.start(text);
        text.push_str(">\n");
        for child in &self.children {
            child.print(level + 1, text);
        }
        let _ = writeln!(text, "{blanks}</{}>", self.tag);
    }

    /// The start tag, without its end.
    fn start(&self, text: &mut String) {
        let _ = write!(text, "<{}", self.tag);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escaped(value, true));
        }
    }

    /// Prints the element without breaking a line.
    fn closely(&self, text: &mut String) {
        self.start(text);
        if self.text.is_empty() && self.children.is_empty() {
            text.push_str("/>");
            return;
        }
        let _ = write!(text, ">{}", escaped(&self.text, false));
        self.children.iter().for_each(|child| child.closely(text));
        let _ = write!(text, "</{}>", self.tag);
    }
}

/// Escapes text for an element or attribute. A character that XML cannot hold becomes a question
/// mark.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(element: &Element) -> String {
        let mut text = String::new();
        element.print(0, &mut text);
        text
    }

    #[test]
    fn signs_of_xml_are_escaped_and_read_back_as_they_were() {
        let value = "a < b && \"c\" > 'd'\tå\n";
        let text = printed(&Element::new("e").with("v", value).child(Element::formatted("f", value)));
        let tree = roxmltree::Document::parse(&text).expect("well formed");
        assert_eq!(tree.root_element().attribute("v"), Some(value), "{text}");
        let inner = tree.descendants().find(|n| n.has_tag_name(("http://www.w3.org/1999/xhtml", "xhtml")));
        assert_eq!(inner.and_then(|n| n.text()), Some(value), "{text}");
    }

    #[test]
    fn what_xml_cannot_hold_is_a_question_mark() {
        let text = printed(&Element::new("e").with("v", "a\u{1}b\u{FFFE}c\u{7}"));
        assert_eq!(text, "<e v=\"a?b?c?\"/>\n");
    }

    #[test]
    fn an_attribute_that_is_set_again_takes_the_new_value() {
        let mut element = Element::new("e").with("a", 1).with("b", 2);
        element.set("a", "3");
        element.set("c", "4");
        assert_eq!(printed(&element), "<e a=\"3\" b=\"2\" c=\"4\"/>\n");
    }

    #[test]
    fn elements_stand_two_blanks_deeper_than_the_one_round_them() {
        let mut element = Element::new("a").child(Element::new("b").child(Element::new("c")));
        element.extend([Element::new("d")]);
        assert_eq!(printed(&element), "<a>\n  <b>\n    <c/>\n  </b>\n  <d/>\n</a>\n");
        let close =
            Element::new("b").child(Element::with_text("c", "x")).child(Element::new("d")).on_one_line();
        assert_eq!(printed(&Element::new("a").child(close)), "<a>\n  <b><c>x</c><d/></b>\n</a>\n");
    }
}
