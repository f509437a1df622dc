//! References by position: `//@partialGrafcets.0/@steps.1` is the second `steps` of the first
//! `partialGrafcets` of the file.

use g7_model::{Said, say};
use std::collections::HashMap;
use std::ops::Range;

use g7_iec::report::shown;
use g7_iec::xml::attr;

/// An element of the file.
pub(super) type Xml<'a> = roxmltree::Node<'a, 'a>;

/// All elements, by their parent and the feature that contains them.
pub(super) struct Refs<'a> {
    root: Xml<'a>,
    children: HashMap<(roxmltree::NodeId, &'a str), Vec<Xml<'a>>>,
    /// The elements with an `xmi:id`.
    ids: HashMap<&'a str, Xml<'a>>,
}

impl<'a> Refs<'a> {
    pub(super) fn new(root: Xml<'a>) -> Refs<'a> {
        let mut refs = Refs { root, children: HashMap::new(), ids: HashMap::new() };
        for xml in root.descendants().filter(Xml::is_element) {
            if let Some(parent) = xml.parent() {
                refs.children.entry((parent.id(), xml.tag_name().name())).or_default().push(xml);
            }
            let id = xml.attributes().find(|a| a.name() == "id" && a.namespace().is_some());
            if let Some(id) = id {
                refs.ids.entry(id.value()).or_insert(xml);
            }
        }
        refs
    }

    /// The element of a reference, or a description of the mistake.
    pub(super) fn resolve(&self, reference: &str) -> Result<Xml<'a>, Said> {
        let path = reference.strip_prefix('#').unwrap_or(reference);
        if path.contains('#') {
            return Err(say!("`{}` is a reference into another file", shown(reference)));
        }
        let Some(path) = path.strip_prefix('/') else {
            return match self.ids.get(path) {
                Some(xml) => Ok(*xml),
                None => Err(say!("no element has the identifier `{}`", shown(reference))),
            };
        };
        let mut segments = path.split('/');
        let first = segments.next().unwrap_or("");
        if !matches!(first, "" | "0") {
            return Err(say!("`{}`: the file has one root only", shown(reference)));
        }
        let mut here = self.root;
        for segment in segments {
            here = self.step(here, segment, reference)?;
        }
        Ok(here)
    }

    /// Follows one segment of a path, `@steps.1` or `@term`.
    fn step(&self, here: Xml<'a>, segment: &str, whole: &str) -> Result<Xml<'a>, Said> {
        let named = segment.strip_prefix('@').map(|rest| match rest.rsplit_once('.') {
            Some((name, number)) => (name, number.parse::<usize>().ok()),
            None => (rest, Some(0)),
        });
        let Some((name, Some(number))) = named else {
            return Err(say!("`{}` is no reference: `{}`", shown(whole), shown(segment)));
        };
        let list = self.children.get(&(here.id(), name));
        let count = list.map_or(0, Vec::len);
        list.and_then(|l| l.get(number)).copied().ok_or_else(|| match count {
            0 => say!("`{}` leads nowhere: there are no `{}`", shown(whole), shown(name)),
            n => say!("`{}` leads nowhere: there are {n} `{}`, counted from 0", shown(whole), shown(name)),
        })
    }
}

/// One reference of an attribute.
pub(super) struct Reference {
    /// The reference as written.
    pub(super) text: String,
    /// Its place in the file.
    pub(super) at: Range<usize>,
}

/// The references in an attribute.
pub(super) fn list(xml: Xml, name: &str) -> Vec<Reference> {
    let Some(text) = attr::text(xml, name) else { return Vec::new() };
    let mut found = Vec::new();
    let mut start = None;
    for (i, c) in text.text.char_indices().chain([(text.text.len(), ' ')]) {
        match (c.is_whitespace(), start) {
            (false, None) => start = Some(i),
            (true, Some(from)) => {
                let part = from..i;
                let at = text.place(&part);
                let text = text.text.get(part).unwrap_or("").to_string();
                found.push(Reference { text, at });
                start = None;
            }
            _ => {}
        }
    }
    found
}
