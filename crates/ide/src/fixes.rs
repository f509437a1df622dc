//! Changes that fix a problem. A problem carries some; others are gestures, which are drafted when somebody
//! chooses one: a draft reads the file anew, and a file may have hundreds of problems.

use std::collections::BTreeMap;

use g7_edit::{Edit, Gesture, ItemId, Row, Splice};
use g7_model::{Problem, Said, TextEdit, codes, say};

use crate::file::File;
use crate::gestures::draft;
use crate::ids::{self, Thing};
use crate::undeclared::{Undeclared, undeclared, unknown};

/// A change that fixes a problem.
#[derive(Debug)]
pub struct Fix {
    /// Its effect, as an order.
    pub title: String,
    way: Way,
}

#[derive(Debug)]
enum Way {
    Splices(Vec<Splice>),
    Gesture(Gesture),
}

impl Fix {
    /// The change of the text, if the problem carries it; that of a gesture is found by [`Fix::edit`], which reads
    /// the file anew.
    pub fn splices(&self) -> Option<&[Splice]> {
        match &self.way {
            Way::Splices(splices) => Some(splices),
            Way::Gesture(_) => None,
        }
    }

    /// The change of the file.
    pub fn edit(&self, file: &File) -> Result<Edit, Said> {
        match &self.way {
            Way::Splices(splices) => Ok(Edit { splices: splices.clone(), ..Edit::default() }),
            Way::Gesture(gesture) => draft(file, gesture),
        }
    }
}

/// The fixes of the problems of a file. What they have in common is found once.
pub struct Fixes<'f> {
    file: &'f File,
    /// In the order of the text.
    undeclared: Vec<Undeclared>,
    /// The index there, by the name: a file can have thousands of such names, each with several problems.
    by_name: BTreeMap<String, usize>,
}

impl<'f> Fixes<'f> {
    /// Those of a file.
    pub fn of(file: &'f File) -> Fixes<'f> {
        let undeclared = undeclared(file.text(), &file.source.document, &file.problems);
        let by_name = undeclared.iter().zip(0..).map(|(u, n)| (u.name.clone(), n)).collect();
        Fixes { file, undeclared, by_name }
    }

    /// The names that nothing declares.
    pub fn undeclared(&self) -> &[Undeclared] {
        &self.undeclared
    }

    /// The fixes of a problem of the file: those that it carries, otherwise gestures. A name that nothing declares may
    /// be a slip or a new one, so it has both.
    pub fn fixes(&self, p: &Problem) -> Vec<Fix> {
        let mut found = carried(self.file, p);
        let new = unknown(self.file.text(), p);
        if self.file.is_clean() && (found.is_empty() || new.is_some()) {
            let gestures = match new {
                Some(name) => self.declarations(name),
                None => gestures(self.file, p),
            };
            let title = |t: Said| t.in_language(self.file.language);
            found.extend(
                gestures.into_iter().map(|(t, gesture)| Fix { title: title(t), way: Way::Gesture(gesture) }),
            );
        }
        found
    }

    /// The declarations of a name, the likely one first.
    fn declarations(&self, name: &str) -> Vec<(Said, Gesture)> {
        let Some(new) = self.by_name.get(name).and_then(|n| self.undeclared.get(*n)) else {
            return Vec::new();
        };
        let mut classes = ["input", "output", "var"];
        classes.sort_by_key(|class| *class != new.class);
        let ty = new.ty.as_str();
        let declared = |class: &str| {
            let title = match class {
                "input" => say!("declare `{name} : {ty}` as an input"),
                "output" => say!("declare `{name} : {ty}` as an output"),
                _ => say!("declare `{name} : {ty}` as a variable"),
            };
            let rows = vec![Row { class: class.to_owned(), ..new.row() }];
            (title, Gesture::Declare { rows, with: None })
        };
        classes.map(declared).into()
    }
}

/// The fixes that a problem carries.
pub fn carried(file: &File, p: &Problem) -> Vec<Fix> {
    let splice = |edit: &TextEdit| {
        let range = file.source.range(edit.at);
        Splice::new(range.start, range.end, edit.text.as_str())
    };
    let fix = |fix: &g7_model::Fix| {
        let mut splices: Vec<Splice> = fix.edits.iter().map(splice).collect();
        splices.sort_by_key(|s| (s.start, s.end));
        Fix { title: fix.label.in_language(file.language), way: Way::Splices(splices) }
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
        let of = document.charts().find(|c| c.at.0.holds(p.at));
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
    Vec::new()
}
