//! The parts of a template that a submission must leave as they are.
//!
//! A note `// locked` locks the items behind it, up to the next empty line; an item that begins there is locked as a
//! whole. Profile, scan time and target of the template are always locked. A part is known by its name, so its place
//! in the file is free.

use g7_model::{Document, Item, Note, Said, Span, VarDecl, say};
use g7_rig::Source;

/// A part that must stay.
#[derive(Clone, Debug)]
pub(crate) struct Locked {
    key: Key,
    item: Item,
}

/// The kind and the name of a part, by which it is found again.
type Key = (&'static str, String);

/// A locked part that a submission has changed.
#[derive(Clone, Debug)]
pub struct Changed {
    /// `path:line:column` in the submission; its path alone where the part is missing.
    pub place: String,
    /// The same in its text; nothing where the part is missing.
    pub at: Option<Span>,
    /// The sentence.
    pub what: Said,
}

/// The locked parts of a template, and the notes that lock nothing.
pub(crate) fn locked(template: &Source) -> (Vec<Locked>, Vec<Span>) {
    let document = &template.document;
    let mut found: Vec<Locked> = document.items.iter().filter(|i| is_setting(i)).flat_map(parts).collect();
    let mut idle = Vec::new();
    for note in document.notes.iter().filter(|n| is_mark(n)) {
        let before = found.len();
        let mut end = note.at.end;
        let is_inside =
            document.items.iter().any(|i| i.at().start < note.at.start && note.at.end < i.at().end);
        let behind = document.items.iter().filter(|i| i.at().start >= note.at.end && !is_inside);
        for item in behind.filter(|i| !is_setting(i) && !is_of_the_exercise(i)) {
            if has_empty_line(template.text.get(end as usize..item.at().start as usize).unwrap_or_default()) {
                break;
            }
            end = item.at().end;
            found.extend(parts(item));
        }
        if found.len() == before {
            idle.push(note.at);
        }
    }
    (found, idle)
}

/// True if an empty line stands between two items.
fn has_empty_line(between: &str) -> bool {
    let lines: Vec<&str> = between.split('\n').collect();
    // The first piece ends the line of the item before, the last one is the indent of the item behind.
    lines.get(1..lines.len().max(2) - 1).is_some_and(|inner| inner.iter().any(|l| l.trim().is_empty()))
}

/// True for the note that locks.
fn is_mark(note: &Note) -> bool {
    let text = note.text.strip_prefix("//").map(str::trim_start).unwrap_or_default();
    text.strip_prefix("locked").is_some_and(|rest| rest.trim().is_empty() || rest.starts_with(':'))
}

/// True for plants, tests and properties: a submission cannot change these, because the exercise brings its own.
pub(crate) fn is_of_the_exercise(item: &Item) -> bool {
    matches!(item, Item::Plant(_) | Item::Test(_) | Item::Prove(_))
}

fn is_setting(item: &Item) -> bool {
    matches!(item, Item::Profile(_) | Item::Cycle(..) | Item::Target(..))
}

/// The parts of an item, each with its key: a declaration of several names has a part for each.
fn parts(item: &Item) -> Vec<Locked> {
    let one =
        |kind: &'static str, name: &str| vec![Locked { key: (kind, name.to_owned()), item: item.clone() }];
    match item {
        Item::Var(v) => singles(v).map(|v| Locked { key: key_of(&v), item: Item::Var(v) }).collect(),
        Item::Type(t) => singles(t).map(|t| Locked { key: key_of(&t), item: Item::Type(t) }).collect(),
        Item::Chart(c) => one("chart", &c.name.text),
        Item::Composed(c) => one("type", &c.name.text),
        Item::Action(a) => one("action", &a.name.text),
        Item::Section(s) => one("section", &s.name.text),
        Item::Function(f) => one("function", &f.name.text),
        Item::Instance(i) => one("instance", &i.chart.text),
        Item::Use(u) => one("use", &u.name.text),
        Item::Pre(..) => one("pre", "pre"),
        Item::Post(..) => one("post", "post"),
        Item::Profile(_) => one("setting", "profile"),
        Item::Cycle(..) => one("setting", "scan"),
        Item::Target(..) => one("setting", "target"),
        Item::Plant(_) | Item::Test(_) | Item::Prove(_) | Item::Layout(_) => Vec::new(),
    }
}

/// One declaration for each name. The comment is left out, because it is not locked.
fn singles(all: &VarDecl) -> impl Iterator<Item = VarDecl> {
    all.names.iter().map(|name| VarDecl { names: vec![name.clone()], comment: None, ..all.clone() })
}

fn key_of(one: &VarDecl) -> Key {
    ("variable", one.names.first().map(|n| n.text.to_string()).unwrap_or_default())
}

/// The locked parts that a submission has changed or left out.
pub(crate) fn changed(locked: &[Locked], template: &Document, submission: &Source) -> Vec<Changed> {
    let own: Vec<Locked> = submission.document.items.iter().flat_map(parts).collect();
    let mut found = Vec::new();
    for part in locked {
        let name = Said::foreign(part.key.1.as_str());
        match own.iter().find(|o| o.key == part.key) {
            Some(there) if there.item == part.item => {}
            Some(there) => found.push(Changed {
                place: submission.place(there.item.at()),
                at: Some(there.item.at()),
                what: say!("the locked part `{name}` is not as in the template"),
            }),
            None => found.push(Changed {
                place: submission.name.clone(),
                at: None,
                what: say!("the locked part `{name}` is missing"),
            }),
        }
    }
    // A setting that the template does not have is locked at its default value.
    for there in own.iter().filter(|o| o.key.0 == "setting") {
        let in_template = template.items.iter().flat_map(parts).any(|t| t.key == there.key);
        if !in_template && !is_usual(&there.item) {
            let name = Said::foreign(there.key.1.as_str());
            found.push(Changed {
                place: submission.place(there.item.at()),
                at: Some(there.item.at()),
                what: say!("the template leaves `{name}` at its usual value, and this changes it"),
            });
        }
    }
    found
}

/// True for a setting with its default value.
fn is_usual(item: &Item) -> bool {
    match item {
        Item::Profile(p) => *p == g7_model::Profile::default(),
        _ => false,
    }
}
