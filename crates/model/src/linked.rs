//! Replaces each `use` line by the items of the file that it names.
//!
//! ```text
//! loader -> a Document for each file -> here -> one Document -> compile, verify, writers of other formats
//! ```
//!
//! # What must hold
//!
//! - The items of a file appear once, in the place of the first `use` line that names it, however many files use it.
//! - Every item keeps its place, with its file ([`Span::file`]).
//! - Tests, plants, properties and notes of a used file are left out: they are about that file alone.
//! - The profile, the scan time and the target of a used file must be those of the head.

use crate::{Document, Item, Problem, Profile, Said, Span, Use, codes, say};

/// The greatest number of files that one file uses, with those that they use.
pub const MOST_FILES: usize = 1000;

/// The head, or a file that it uses.
#[derive(Clone, Debug)]
pub struct Linked<'d> {
    /// Its items.
    pub document: &'d Document,
    /// For each `use` line, in the order of [`Document::uses`], the position of its file in the list of files; `None` if
    /// the file could not be read.
    pub uses: Vec<Option<usize>>,
}

/// The document of all files together, the first of which is the head. Also returns circles and settings that differ.
pub fn linked(files: &[Linked<'_>]) -> (Document, Vec<Problem>) {
    let Some(head) = files.first() else { return (Document::default(), Vec::new()) };
    let mut linker = Linker {
        files,
        done: vec![false; files.len()],
        way: Vec::new(),
        items: Vec::new(),
        problems: Vec::new(),
    };
    linker.file(0);
    for (number, file) in files.iter().enumerate().skip(1) {
        if linker.done.get(number) == Some(&true) {
            linker.settings(head.document, file.document);
        }
    }
    (Document { items: linker.items, notes: head.document.notes.clone() }, linker.problems)
}

/// The problem of a `use` line whose file is not there to be joined.
pub fn unusable(used: &Use, why: &Said) -> Problem {
    Problem::new(&codes::BAD_USE, used.name.at.0, say!("`{}` cannot be used: {why}", used.name.text))
}

struct Linker<'d> {
    files: &'d [Linked<'d>],
    /// For each file, true if its items are in the list.
    done: Vec<bool>,
    /// The files from the head to the present one, each with the place of the `use` line that leads to the next.
    way: Vec<(usize, Span)>,
    items: Vec<Item>,
    problems: Vec<Problem>,
}

impl<'d> Linker<'d> {
    fn file(&mut self, number: usize) {
        let Some(file) = self.files.get(number) else { return };
        let mut uses = file.uses.iter().copied();
        for item in &file.document.items {
            match item {
                // If the file could not be read, that was reported before.
                Item::Use(used) => {
                    if let Some(next) = uses.next().flatten() {
                        self.used(number, next, used);
                    }
                }
                Item::Test(_) | Item::Plant(_) | Item::Prove(_) if number > 0 => {}
                Item::Profile(_) | Item::Cycle(..) | Item::Target(..) if number > 0 => {}
                item => self.items.push(item.clone()),
            }
        }
        if let Some(done) = self.done.get_mut(number) {
            *done = true;
        }
    }

    fn used(&mut self, number: usize, next: usize, used: &Use) {
        let at = used.name.at.0;
        if next == number || self.way.iter().any(|(file, _)| *file == next) {
            return self.circle(next, used);
        }
        if self.done.get(next) == Some(&false) {
            self.way.push((number, at));
            self.file(next);
            self.way.pop();
        }
    }

    /// Reports a file that uses itself, directly or through others.
    fn circle(&mut self, next: usize, used: &Use) {
        let what = say!("`{}` uses itself in a circle", used.name.text);
        let mut problem = Problem::new(&codes::BAD_USE, used.name.at.0, what);
        let first = self.way.iter().position(|(file, _)| *file == next).unwrap_or(self.way.len());
        for (_, at) in self.way.iter().skip(first) {
            problem = problem.related(*at, say!("the circle goes through here"));
        }
        let help = say!("put what both need into a third file, and use that in both");
        self.problems.push(problem.help(help));
    }

    /// Reports each setting (profile, scan time, target) of a used file that is not that of the head, the first file.
    fn settings(&mut self, head: &Document, file: &Document) {
        let target = |d: &Document| {
            d.items.iter().find_map(|i| if let Item::Target(plc, at) = i { Some((*plc, at.0)) } else { None })
        };
        for item in &file.items {
            match item {
                Item::Profile(p) => {
                    let (own, default) = (head.profile(), Profile::default());
                    let same = own.unwrap_or(&default) == p;
                    self.setting(same, say!("the profile"), p.at.0, own.map(|p| p.at.0));
                }
                Item::Cycle(time, at) => {
                    let own = head.items.iter().find(|i| matches!(i, Item::Cycle(..))).map(Item::at);
                    self.setting(head.cycle() == Some(*time), say!("the scan time"), at.0, own);
                }
                Item::Target(plc, at) => {
                    let own = target(head);
                    let same = own.is_some_and(|(own, _)| own == *plc);
                    self.setting(same, say!("the target"), at.0, own.map(|(_, at)| at));
                }
                _ => {}
            }
        }
    }

    fn setting(&mut self, same: bool, what: Said, at: Span, own: Option<Span>) {
        if same {
            return;
        }
        let told = say!("{what} of this file differs from that of the file that uses it");
        let problem = Problem::new(&codes::BAD_USE, at, told);
        let problem = match own {
            Some(own) => problem.related(own, say!("here it is another one")),
            None => problem,
        };
        let help = say!("write it in the file that uses this one alone, or the same in both");
        self.problems.push(problem.help(help));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FileId, Name};

    fn uses(name: &str, file: u32) -> Item {
        let at = Span { file: FileId(file), start: 0, end: 1 };
        Item::Use(Use { name: Name::new(name, at), library: false, at: at.into() })
    }

    fn pre(file: u32) -> Item {
        let at = Span { file: FileId(file), start: 5, end: 6 };
        Item::Cycle(crate::Nanos::new(1), at.into())
    }

    #[test]
    fn each_file_stands_once_and_a_circle_ends() {
        let documents: Vec<Document> = [
            vec![uses("b", 0), uses("c", 0), pre(0)],
            vec![uses("c", 1), pre(1)],
            vec![uses("b", 2), uses("x", 2)],
        ]
        .into_iter()
        .map(|items| Document { items, notes: Vec::new() })
        .collect();
        let ways = [vec![Some(1), Some(2)], vec![Some(2)], vec![Some(1), None]];
        let files: Vec<Linked<'_>> =
            documents.iter().zip(ways).map(|(document, uses)| Linked { document, uses }).collect();
        let (whole, problems) = linked(&files);
        assert_eq!(whole.items.len(), 1, "the setting of the head alone");
        let places: Vec<u32> = problems.iter().map(|p| p.at.file.0).collect();
        assert_eq!(places, [2], "one circle, told where it closes");
        assert_eq!(problems[0].related.len(), 1);
        assert_eq!(problems[0].related[0].0.file.0, 1);
    }
}
