//! The frame of a file of Control Expert, the same for a section in any language.

use super::element::Element;

/// A file with one section and its variables. `content` is the tool's word for the kind of file.
pub fn file(root: &str, content: &str, name: &str, section: Element, variables: Vec<Element>) -> String {
    let header = Element::new("fileHeader").with("company", "G7").with("product", "Control Expert");
    let root = Element::new(root)
        .child(header.with("content", content).with("DTDVersion", "41"))
        .child(Element::new("contentHeader").with("name", name).with("version", "0.0.000"))
        .child(section)
        .child(Element::new("dataBlock").children(variables));
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n".to_owned();
    root.print(0, &mut text);
    text
}
