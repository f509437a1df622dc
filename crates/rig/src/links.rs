//! The files that a file uses: found by their paths, read once, and put together with it.
//!
//! ```text
//! Source (the head) -> paths of its `use` lines -> a reader (disk, page, library) -> Sources -> model::linked -> the whole
//! ```
//!
//! # What must hold
//!
//! - Nothing here opens a file. Whoever reads a file decides which folder may be read.
//! - A path is relative to the file in which it is written, and one file has one path: `lib/a.g7`, `../b.g7`,
//!   counted from the folder of the head.
//! - A file that did not change is not parsed again.

use std::collections::HashMap;
use std::sync::Arc;

use g7_model::linked::{Linked, MOST_FILES, linked};
use g7_model::{Document, FileId, Problem, Said, Severity, Span, Use, codes, say};

use crate::source::{Links, Other, Source};

/// The bytes of a file by its path from the folder of the head, or why it cannot be read.
pub type Reader<'r> = &'r mut dyn FnMut(&str) -> Result<Vec<u8>, Said>;

/// The first number of a file that another one uses lies this far above the number of that.
const APART: u32 = 1 << 16;

/// The path of a file from the folder of the head, as written in the file with the path `from`.
///
/// # Errors
///
/// The text is no relative path of a .g7 file.
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

/// The name of a file in messages: its path in terms of the name of the head.
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
    /// Reads the files that this one uses, those that they use, and puts all together. It is done again after a
    /// change of the text; files whose bytes are the same are not parsed again.
    pub fn link(&mut self, read: Reader<'_>) {
        let before = std::mem::take(&mut self.links);
        if self.document.uses().next().is_some() {
            self.links = links(self, &before, read);
        }
    }

    /// Links this file to the files that another one uses, without reading them again: a changed text of the same
    /// file.
    #[must_use]
    pub fn linked_like(mut self, other: &Source) -> Source {
        self.link(&mut |path| {
            let known = other.links.others.iter().find(|o| !o.library && o.path == path);
            known.map(|o| o.source.bytes.clone()).ok_or_else(|| say!("it was not read"))
        });
        self
    }
}

/// Reads what the head uses. Files of `before` with the same bytes are kept.
fn links(head: &Source, before: &Links, read: Reader<'_>) -> Links {
    let mut loader =
        Loader { head, before, read, numbers: HashMap::new(), others: Vec::new(), problems: Vec::new() };
    let mut ways = vec![loader.uses(&head.document, "", None)];
    while let Some(other) = loader.others.get(ways.len() - 1) {
        // A part of the library uses other parts alone; a test holds it to that.
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
        // A name that is missing was told by the parser.
        if used.name.text.is_empty() {
            return None;
        }
        let path =
            if used.library { Ok(used.name.text.to_string()) } else { resolved(from, &used.name.text) };
        let found = path.and_then(|path| self.found(used.library, path, through));
        found.map_err(|why| self.refuse(used, why)).ok().flatten()
    }

    /// The number of a file. `None` if a `use` line before told why there is none.
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

    fn refuse(&mut self, used: &Use, why: Said) {
        let problem =
            Problem::new(&codes::BAD_USE, used.name.at.0, say!("`{}` cannot be used: {why}", used.name.text));
        let names: Vec<&str> = g7_library::PARTS.iter().map(|p| p.name).collect();
        let near = g7_model::similar(&used.name.text, &names).filter(|_| used.library);
        self.problems.push(match near {
            Some(near) => problem.meant(near),
            None => problem,
        });
    }
}

fn no_part() -> Said {
    let names: Vec<&str> = g7_library::PARTS.iter().map(|p| p.name).collect();
    say!("the library of this g7 has no such part; it has {}", Said::foreign(names.join(", ")))
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
