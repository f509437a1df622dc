//! Reads the files that a file uses, each once, and joins their items with its own.
//!
//! ```text
//! Source (the head) -> paths of its `use` lines -> a reader (disk, page, library) -> Sources -> model::linked -> the whole
//! ```
//!
//! The *head* is the file that is checked, run or edited; all others are read because of it.
//!
//! # What must hold
//!
//! - Nothing here opens a file: the caller gives a reader, which decides which folders may be read.
//! - A path in a text is relative to the file of that text. It becomes a path from the folder of the head (`lib/a.g7`,
//!   `../b.g7`), so that a file has one path, whoever uses it.
//! - A file whose bytes have not changed is not parsed again.

use std::collections::HashMap;
use std::sync::Arc;

use g7_model::linked::{Linked, MOST_FILES, linked, unusable};
use g7_model::{Document, FileId, Item, Problem, Said, Severity, Span, Use, say};

use crate::source::{Links, Other, Source};

/// The bytes of a file by its path from the folder of the head, or why it cannot be read.
pub type Reader<'r> = &'r mut dyn FnMut(&str) -> Result<Vec<u8>, Said>;

/// The distance between the numbers ([`FileId`]) of the head and of the files that it uses.
const APART: u32 = 1 << 16;

/// Converts a path that is written in the file `from` to a path from the folder of the head. `from` is such a path too,
/// and empty for the head.
///
/// # Errors
///
/// It is not a relative path of a .g7 file.
pub fn resolved(from: &str, written: &str) -> Result<String, Said> {
    if written.contains('\\') {
        return Err(say!("the parts of a path are separated by `/`"));
    }
    if written.starts_with('/') || written.contains(':') {
        return Err(say!("a path is relative to the file in which it stands"));
    }
    if written.chars().any(char::is_control) {
        return Err(say!("a path has no control characters"));
    }
    if !written.ends_with(".g7") {
        return Err(say!("only .g7 files can be used; `g7 import` converts others"));
    }
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = folder.split('/').filter(|p| !p.is_empty()).collect();
    for part in written.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|p| *p != "..") => _ = parts.pop(),
            part => parts.push(part),
        }
    }
    Ok(parts.join("/"))
}

/// The name of a used file in messages: `plant/lib/b.g7` for the path `lib/b.g7`, if the head is `plant/a.g7`.
pub fn named(head: &str, path: &str) -> String {
    let folder = head.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = folder.split('/').collect();
    let mut rest = path;
    while let Some(up) = rest.strip_prefix("../") {
        if parts.last().is_none_or(|p| matches!(*p, "" | "." | "..")) {
            break;
        }
        parts.pop();
        rest = up;
    }
    parts.push(rest);
    if folder.is_empty() { rest.to_owned() } else { parts.join("/") }
}

impl Source {
    /// Reads all files that this one uses, directly or through others, and joins their items with its own. Call it
    /// again after a change of the text.
    pub fn link(&mut self, read: Reader<'_>) {
        let before = std::mem::take(&mut self.links);
        if self.document.uses().next().is_some() {
            self.links = links(self, &before, read);
        }
    }

    /// Joins the items of the files that `other` uses, without reading these again. For a changed text of the file
    /// `other`.
    #[must_use]
    pub fn linked_like(mut self, other: &Source) -> Source {
        self.link(&mut |path| {
            let known = other.links.others.iter().find(|o| !o.library && o.path == path);
            known.map(|o| o.source.bytes.clone()).ok_or_else(|| say!("it was not read"))
        });
        self
    }
}

impl Source {
    /// The charts of this file with plants, tests and properties of others behind its own: what somebody hands in, and
    /// what somebody else asks of it. Places in these items lead to their own files.
    #[must_use]
    pub fn asked_by(mut self, others: &[(Arc<Source>, Vec<Item>)]) -> Source {
        let through = Span { file: self.id(), start: 0, end: 0 };
        for (source, items) in others {
            for document in [Some(&mut self.document), self.links.whole.as_mut()].into_iter().flatten() {
                document.items.extend(items.iter().cloned());
            }
            let (path, source) = (source.name.clone(), Arc::clone(source));
            self.links.others.push(Other { path, library: false, source, through });
        }
        self
    }

    /// The charts of this file without its own plants, tests and properties.
    #[must_use]
    pub fn charts_alone(mut self) -> Source {
        self.amend(|document| {
            document.items.retain(|i| !matches!(i, Item::Plant(_) | Item::Test(_) | Item::Prove(_)));
        });
        self
    }
}

/// Reads the files that the head uses. `before` are the files of the last call: those with the same bytes are kept.
fn links(head: &Source, before: &Links, read: Reader<'_>) -> Links {
    let mut loader =
        Loader { head, before, read, numbers: HashMap::new(), others: Vec::new(), problems: Vec::new() };
    let mut ways = vec![loader.uses(&head.document, "", None)];
    while let Some(other) = loader.others.get(ways.len() - 1) {
        // Parts of the library use only other parts (`tests/tests/house/linked.rs`), so the path is never looked at.
        let path = if other.library { String::new() } else { other.path.clone() };
        let (source, through) = (Arc::clone(&other.source), other.through);
        ways.push(loader.uses(&source.document, &path, Some(through)));
    }
    let Loader { others, mut problems, .. } = loader;
    let documents = std::iter::once(&head.document).chain(others.iter().map(|o| &o.source.document));
    let files: Vec<Linked<'_>> =
        documents.zip(ways).map(|(document, uses)| Linked { document, uses }).collect();
    let (whole, mut wrong) = linked(&files);
    problems.append(&mut wrong);
    let of_syntax = others.iter().flat_map(|o| &o.source.problems);
    problems.extend(of_syntax.filter(|p| p.severity() == Severity::Error).cloned());
    Links { others, whole: Some(whole), problems }
}

struct Loader<'l, 'r> {
    head: &'l Source,
    before: &'l Links,
    read: Reader<'r>,
    /// The number of each file that was found, by its path; that of a part of the library by its name.
    numbers: HashMap<(bool, String), Option<usize>>,
    others: Vec<Other>,
    problems: Vec<Problem>,
}

impl Loader<'_, '_> {
    /// The number of the file for each `use` line; the head has the number 0.
    fn uses(&mut self, document: &Document, from: &str, through: Option<Span>) -> Vec<Option<usize>> {
        document.uses().map(|used| self.used(used, from, through.unwrap_or(used.name.at.0))).collect()
    }

    fn used(&mut self, used: &Use, from: &str, through: Span) -> Option<usize> {
        // The parser has reported the missing name.
        if used.name.text.is_empty() {
            return None;
        }
        let path =
            if used.library { Ok(used.name.text.to_string()) } else { resolved(from, &used.name.text) };
        let found = path.and_then(|path| self.found(used.library, path, through));
        found.map_err(|why| self.refuse(used, &why)).ok().flatten()
    }

    /// The number of a file; `None` if an earlier `use` line of it has reported that it cannot be read.
    fn found(&mut self, library: bool, path: String, through: Span) -> Result<Option<usize>, Said> {
        let own = self.head.name.rsplit('/').next().unwrap_or_default();
        if !library && path == own {
            return Ok(Some(0));
        }
        if let Some(known) = self.numbers.get(&(library, path.clone())) {
            return Ok(*known);
        }
        self.numbers.insert((library, path.clone()), None);
        if self.others.len() >= MOST_FILES {
            return Err(say!("a file uses {MOST_FILES} others at most, with those that they use"));
        }
        let (name, bytes) = if library {
            (
                format!("library/{path}.g7"),
                g7_library::part(&path).ok_or_else(no_part)?.text.as_bytes().to_vec(),
            )
        } else {
            (named(&self.head.name, &path), (self.read)(&path)?)
        };
        let source = self.source(name, bytes);
        self.others.push(Other { path: path.clone(), library, source, through });
        self.numbers.insert((library, path), Some(self.others.len()));
        Ok(Some(self.others.len()))
    }

    fn source(&self, name: String, bytes: Vec<u8>) -> Arc<Source> {
        let number = self.others.len();
        let id = self.head.id().0.wrapping_add(APART * (number as u32 + 1));
        let known = self.before.others.get(number).map(|o| &o.source);
        match known.filter(|s| s.name == name && s.bytes == bytes && s.id() == FileId(id)) {
            Some(known) => Arc::clone(known),
            None => Arc::new(Source::native(&name, bytes, id)),
        }
    }

    fn refuse(&mut self, used: &Use, why: &Said) {
        let problem = unusable(used, why);
        let near = g7_model::similar(&used.name.text, &parts()).filter(|_| used.library);
        self.problems.push(match near {
            Some(near) => problem.meant(near),
            None => problem,
        });
    }
}

/// The names of the parts of the library.
fn parts() -> Vec<&'static str> {
    g7_library::PARTS.iter().map(|p| p.name).collect()
}

fn no_part() -> Said {
    say!("the library of this g7 has no such part; it has {}", Said::foreign(parts().join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_relative_to_its_file() {
        let is = |from, written| resolved(from, written).expect("a path");
        assert_eq!(is("", "axis.g7"), "axis.g7");
        assert_eq!(is("lib/axis.g7", "drive.g7"), "lib/drive.g7");
        assert_eq!(is("lib/axis.g7", "../io.g7"), "io.g7");
        assert_eq!(is("lib/axis.g7", "./.././../x/io.g7"), "../x/io.g7");
        assert_eq!(is("../lib/axis.g7", "../../io.g7"), "../../io.g7");
        for wrong in ["/etc/a.g7", "C:/a.g7", "a\\b.g7", "a.st", "", "a\u{7}.g7", "http://x/a.g7"] {
            assert!(resolved("", wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn a_file_has_the_name_that_the_user_would_give_it() {
        assert_eq!(named("a.g7", "lib/b.g7"), "lib/b.g7");
        assert_eq!(named("plant/a.g7", "lib/b.g7"), "plant/lib/b.g7");
        assert_eq!(named("plant/a.g7", "../b.g7"), "b.g7");
        assert_eq!(named("../a.g7", "../b.g7"), "../../b.g7");
        assert_eq!(named("/x/y/a.g7", "../../b.g7"), "/b.g7");
        assert_eq!(named("a.g7", "../b.g7"), "../b.g7");
    }
}
