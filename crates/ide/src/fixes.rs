//! Changes that fix a problem; offered only if they certainly do.

use g7_edit::{Gesture, ItemId, Row, Splice};
use g7_model::{Problem, Said, TextEdit, codes, say};

use crate::file::File;
use crate::gestures::draft;
use crate::ids::{self, Thing};

/// A change that fixes a problem.
#[derive(Debug)]
pub struct Fix {
    /// Its effect, as an order.
    pub title: String,
    /// The change of the text.
    pub splices: Vec<Splice>,
}

/// The fixes of a problem; gestures are tried only if `time` is true.
pub fn fixes(file: &File, p: &Problem, time: bool) -> Vec<Fix> {
    let mut found: Vec<Fix> = carried(file, p);
    if found.is_empty() && time && file.is_clean() {
        let gestures = gestures(file, p);
        found.extend(gestures.into_iter().filter_map(|(title, gesture)| {
            let edit = draft(file, &gesture).ok()?;
            Some(Fix { title: title.in_language(file.language), splices: edit.splices })
        }));
    }
    found
}

/// The fixes that the problem carries.
fn carried(file: &File, p: &Problem) -> Vec<Fix> {
    let splice = |edit: &TextEdit| {
        let range = file.source.range(edit.at);
        Splice::new(range.start, range.end, edit.text.as_str())
    };
    let fix = |fix: &g7_model::Fix| {
        let mut splices: Vec<Splice> = fix.edits.iter().map(splice).collect();
        splices.sort_by_key(|s| (s.start, s.end));
        Fix { title: fix.label.in_language(file.language), splices }
    };
    p.fixes.iter().map(fix).collect()
}

/// Gestures that may fix the problem, each with its title.
fn gestures(file: &File, p: &Problem) -> Vec<(Said, Gesture)> {
    let document = &file.source.document;
    let thing = || ids::at(document, p.at);
    let transition = || match thing() {
        Some(Thing::Transition(c, n)) => Some(ItemId::transition(&*c.name.text, n)),
        _ => None,
    };
    let there = file.text().get(file.source.range(p.at)).unwrap_or("").trim_matches('`');
    if p.code == &codes::UNUSED_VARIABLE {
        let of = document.charts().find(|c| ids::holds(c.at.0, p.at));
        let name = of.map_or(there.to_owned(), |c| format!("{}.{there}", c.name.text));
        return vec![(say!("delete `{there}`"), Gesture::DeleteVariable { name })];
    }
    if p.code == &codes::PRIORITY_IGNORED
        && p.help.as_deref() == Some("leave the number out")
        && let Some(id) = transition()
    {
        return vec![(say!("leave the number out"), Gesture::Priority { id, n: None })];
    }
    if p.code == &codes::SAME_TRANSITION
        && let Some(id) = transition()
    {
        return vec![(say!("delete this transition"), Gesture::Delete { ids: vec![id], heal: false })];
    }
    if p.code == &codes::UNKNOWN_NAME && is_name(there) && *p.what == format!("nothing is called `{there}`") {
        let declared = |class: &str, title: Said| {
            let row = Row {
                name: there.to_owned(),
                class: class.to_owned(),
                ty: "BOOL".to_owned(),
                ..Row::default()
            };
            (title, Gesture::Variable { name: None, row })
        };
        return vec![
            declared("input", say!("declare `{there}` as an input")),
            declared("output", say!("declare `{there}` as an output")),
            declared("var", say!("declare `{there}` as a variable")),
        ];
    }
    Vec::new()
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}
