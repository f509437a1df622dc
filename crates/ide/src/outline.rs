//! The outline of a file: its items, and what stands in them; and what can be folded.

use std::ops::Range;

use g7_model::{
    Chart, ChartItem, Composed, Instance, InstanceNames, Item, Name, Plant, PlantItem, Property, Said, Span,
    VarDecl, say,
};

use crate::file::Readable;
use crate::tables::{class, declaration, kind, value_type};

/// The kind of an entry of the outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A chart, an expansion or a task.
    Chart,
    /// A step.
    Step,
    /// A transition with a label.
    Transition,
    /// A variable or constant.
    Variable,
    /// A named action, transition section or function.
    Function,
    /// A plant.
    Plant,
    /// A test or property.
    Test,
}

/// An entry of the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: Kind,
    /// Its comment or declaration; may be empty.
    pub detail: Said,
    /// The bytes of the whole item.
    pub range: Range<usize>,
    /// The bytes of its name.
    pub named: Range<usize>,
    /// The entries within it.
    pub inside: Vec<Entry>,
}

/// The outline of a text.
pub fn outline(readable: &Readable<'_>) -> Vec<Entry> {
    let document = readable.document;
    document.items.iter().flat_map(|item| entries(item, readable.text)).collect()
}

fn entries(item: &Item, text: &str) -> Vec<Entry> {
    match item {
        Item::Var(v) => variables(v),
        Item::Chart(c) => vec![chart(c)],
        Item::Instance(i) => instance(i),
        Item::Composed(c) => vec![composed(c)],
        Item::Type(t) => {
            let told = || detail(t.comment.as_deref(), || say!("type"));
            t.names.iter().map(|name| entry(name, Kind::Function, told(), t.at.0)).collect()
        }
        Item::Action(a) => {
            vec![entry(&a.name, Kind::Function, detail(a.comment.as_deref(), || say!("action")), a.at.0)]
        }
        Item::Section(s) => vec![entry(&s.name, Kind::Function, say!("transition section"), s.at.0)],
        Item::Function(f) => {
            vec![entry(
                &f.name,
                Kind::Function,
                say!("function : {}", Said::foreign(value_type(&f.result))),
                f.at.0,
            )]
        }
        Item::Plant(p) => vec![plant(p)],
        Item::Test(t) => vec![titled(t.title.to_string(), t.at.0)],
        Item::Prove(p) => vec![titled(first_line(p, text), p.at.0)],
        Item::Profile(_)
        | Item::Cycle(..)
        | Item::Target(..)
        | Item::Use(_)
        | Item::Pre(..)
        | Item::Post(..)
        | Item::Layout(_) => Vec::new(),
    }
}

/// An instance with a name of its own. Those of a range have no entry: their chart has one.
fn instance(i: &Instance) -> Vec<Entry> {
    let InstanceNames::One(name) = &i.names else { return Vec::new() };
    vec![entry(name, Kind::Chart, say!("instance of `{}`", i.chart.text), i.at.0)]
}

/// A structure or a function block with its members.
fn composed(c: &Composed) -> Entry {
    let what = if c.block { say!("function block") } else { say!("structure") };
    let own = entry(&c.name, Kind::Function, detail(c.comment.as_deref(), || what), c.at.0);
    Entry { inside: c.members.iter().chain(&c.inouts).flat_map(variables).collect(), ..own }
}

/// A property has no name; its text stands for it.
fn first_line(p: &Property, text: &str) -> String {
    let words = text.get(p.at.0.bytes()).unwrap_or("prove");
    words.lines().next().unwrap_or("prove").chars().take(80).collect()
}

fn chart(c: &Chart) -> Entry {
    let inside = c.items.iter().flat_map(|item| match item {
        ChartItem::Var(v) => variables(v),
        ChartItem::Step(s) => {
            let plain = || if s.initial { say!("initial step") } else { say!("step") };
            vec![entry(&s.name, Kind::Step, detail(s.comment.as_deref(), plain), s.at.0)]
        }
        ChartItem::Transition(t) => {
            let told = || detail(t.comment.as_deref(), Said::default);
            t.label.iter().map(|l| entry(l, Kind::Transition, told(), t.at.0)).collect()
        }
        ChartItem::Action(a) => {
            vec![entry(&a.name, Kind::Function, detail(a.comment.as_deref(), || say!("action")), a.at.0)]
        }
        ChartItem::Section(s) => vec![entry(&s.name, Kind::Function, say!("transition section"), s.at.0)],
        ChartItem::Pre(..) | ChartItem::Post(..) => Vec::new(),
    });
    let own = entry(&c.name, Kind::Chart, detail(c.comment.as_deref(), || kind(c.kind)), c.at.0);
    Entry { inside: inside.collect(), ..own }
}

fn plant(p: &Plant) -> Entry {
    let inside = p.items.iter().flat_map(|item| match item {
        PlantItem::Const { names, at, .. } => {
            names.iter().map(|n| entry(n, Kind::Variable, Said::foreign("const"), at.0)).collect()
        }
        PlantItem::State(s) => {
            s.names.iter().map(|n| entry(n, Kind::Variable, say!("state of the plant"), s.at.0)).collect()
        }
        PlantItem::Parts(x) => vec![entry(&x.name, Kind::Variable, say!("parts of the plant"), x.at.0)],
        PlantItem::Arrivals(a) => vec![entry(&a.name, Kind::Variable, say!("arrivals of the plant"), a.at.0)],
        PlantItem::Rate(_)
        | PlantItem::Drive(_)
        | PlantItem::On(..)
        | PlantItem::Each(..)
        | PlantItem::View(_) => Vec::new(),
    });
    let own = entry(&p.name, Kind::Plant, detail(p.comment.as_deref(), || say!("plant")), p.at.0);
    Entry { inside: inside.collect::<Vec<_>>(), ..own }
}

fn variables(v: &VarDecl) -> Vec<Entry> {
    let declared =
        |name: &Name| Said::foreign(declaration(&name.text, v).trim_start_matches(class(v.kind)).trim());
    let told = |name: &Name| detail(v.comment.as_deref(), || declared(name));
    v.names.iter().map(|n| entry(n, Kind::Variable, told(n), v.at.0)).collect()
}

/// The comment of an item, or what stands in its place.
fn detail(comment: Option<&str>, plain: impl FnOnce() -> Said) -> Said {
    comment.map_or_else(plain, Said::foreign)
}

fn entry(name: &Name, kind: Kind, detail: Said, at: Span) -> Entry {
    let (range, named) = (at.bytes(), name.at.0.bytes());
    // A name lies inside its item, also where several names share a declaration.
    let named = if range.start <= named.start && named.end <= range.end { named } else { range.clone() };
    Entry { name: name.text.to_string(), kind, detail, range, named, inside: Vec::new() }
}

fn titled(name: String, at: Span) -> Entry {
    let name = if name.is_empty() { "test".to_owned() } else { name };
    Entry {
        name,
        kind: Kind::Test,
        detail: Said::default(),
        range: at.bytes(),
        named: at.bytes(),
        inside: Vec::new(),
    }
}

/// The parts of a text that an editor can fold: everything between braces, and notes in a row.
pub fn folds(text: &str) -> Vec<Range<usize>> {
    use g7_syntax::TokenKind;
    let (mut open, mut folds) = (Vec::new(), Vec::new());
    let mut notes: Option<Range<usize>> = None;
    for t in g7_syntax::tokens(text) {
        if t.kind == TokenKind::Note {
            let joined = |n: &Range<usize>| text.get(n.end..t.start).is_some_and(|b| b.trim().is_empty());
            notes = match notes.take() {
                Some(n) if joined(&n) => Some(n.start..t.end),
                other => {
                    folds.extend(other);
                    Some(t.start..t.end)
                }
            };
            continue;
        }
        folds.extend(notes.take());
        match t.kind {
            TokenKind::LBrace => open.push(t.start),
            TokenKind::RBrace => folds.extend(open.pop().map(|start| start..t.end)),
            _ => {}
        }
    }
    folds.extend(notes);
    folds.retain(|f| text.get(f.clone()).is_some_and(|t| t.contains('\n')));
    folds.sort_by_key(|f| f.start);
    folds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braces_and_rows_of_notes_fold_if_they_have_several_lines() {
        let text = "// a\n// b\nchart C {\n  step 1 { N V }\n}\n";
        let folded: Vec<&str> = folds(text).into_iter().map(|r| &text[r]).collect();
        assert_eq!(folded, ["// a\n// b", "{\n  step 1 { N V }\n}"]);
    }
}
