//! A new name for a part that several files use.
//!
//! ```text
//! files of a project, each linked to those that it uses (rig::Source) -> here -> the change of each text
//! ```
//!
//! Files that are used speak of names that only the head declares or takes in. So a name is followed in each head whose
//! whole contains its declaration, and in all files of that head.
//!
//! # What must hold
//!
//! After the change each name of each head means the same part as before; else nothing is changed.

use std::collections::BTreeMap;

use g7_compile::references::Written;
use g7_compile::{Definition, References, references};
use g7_edit::{Renaming, Splice, spliced};
use g7_model::{FileId, Said, Severity, Span, say};
use g7_rig::Source;

/// The changes of texts, by the names of their files.
pub type Changes = BTreeMap<String, Vec<Splice>>;

/// The declaration of the name at a byte of a file: the name of the file in which it stands, and its bytes there.
pub fn declared(head: &Source, at: usize) -> Option<(String, std::ops::Range<usize>)> {
    let known = references(head.whole()).seen_from(head.id());
    let named = known.at(u32::try_from(at).unwrap_or(u32::MAX))?;
    let place = known.declaration(named)?;
    Some((head.home(place).name.clone(), place.bytes()))
}

/// The file with this name: the head itself, or a file that it uses. Parts of the library are not searched.
pub fn file<'h>(head: &'h Source, name: &str) -> Option<&'h Source> {
    own(head).find(|source| source.name == name)
}

/// True if the file with this name is the head itself, or a file that it uses.
pub fn has(head: &Source, name: &str) -> bool {
    file(head, name).is_some()
}

/// A new name for a part.
pub struct Renamed<'h> {
    /// The changes of the texts; none if the part has this name already.
    pub changes: Changes,
    /// Each head that the change concerns, before and after it.
    pub heads: Vec<(&'h Source, Source)>,
}

/// Gives the part that is declared at a place of a file another name, in all files of the heads that have this file. The
/// name of each [`Source`] is its path from one folder.
///
/// # Errors
///
/// The name is taken, something would mean another part, or a file with errors may use the name.
pub fn rename<'h>(
    heads: &[&'h Source],
    (name, at): (&str, &std::ops::Range<usize>),
    to: &str,
) -> Result<Renamed<'h>, Said> {
    let mut changes = Changes::new();
    let mut judged = Vec::new();
    for head in heads {
        let Some(home) = file(head, name) else { continue };
        let refs = references(head.whole());
        let place = Span { file: home.id(), start: at.start as u32, end: at.end as u32 };
        let Some(part) = at_declaration(&refs, place) else {
            return Err(say!("correct the syntax errors of {} first", Said::foreign(home.name.as_str())));
        };
        let renaming = Renaming::new(part, to)?;
        if renaming.is_nothing() {
            return Ok(Renamed { changes: Changes::new(), heads: Vec::new() });
        }
        renaming.free(head.whole(), &refs)?;
        for source in own(head) {
            if source.has_errors() && renaming.names().iter().any(|name| source.text.contains(name)) {
                return Err(mended_first(source, renaming.names()[0]));
            }
            let splices = renaming.splices(&refs, source.id(), &source.text)?;
            merge(changes.entry(source.name.clone()).or_default(), splices);
        }
        judged.push((*head, refs, renaming));
    }
    changes.retain(|_, splices| !splices.is_empty());
    let after = |(head, refs, renaming): (&'h Source, References, Renaming)| {
        Ok((head, judged_after(head, &refs, &renaming, &changes)?))
    };
    let heads = judged.into_iter().map(after).collect::<Result<_, Said>>()?;
    Ok(Renamed { changes, heads })
}

/// A head after the change.
fn changed(head: &Source, changes: &Changes) -> Option<Source> {
    let text = |source: &Source| match changes.get(&source.name) {
        Some(splices) => spliced(&source.text, splices),
        None => Some(source.text.clone()),
    };
    let mut after = Source::native(&head.name, text(head)?.into_bytes(), head.id().0);
    after.link(&mut |path| {
        let other = head.others().iter().find(|o| !o.library && o.path == path);
        let text = other.and_then(|o| text(&o.source));
        text.map(String::into_bytes).ok_or_else(|| say!("it was not read"))
    });
    Some(after)
}

/// A head after the change. Refuses a change after which one of its names means another part, or a text cannot be read.
fn judged_after(
    head: &Source,
    refs: &References,
    renaming: &Renaming,
    changes: &Changes,
) -> Result<Source, Said> {
    let after = changed(head, changes).ok_or_else(|| say!("the change does not fit the text"))?;
    let errors = |source: &Source| {
        let mut problems = source.read_problems();
        problems.retain(|p| p.severity() == Severity::Error);
        problems
    };
    let before = errors(head);
    let new =
        errors(&after).into_iter().find(|p| !before.iter().any(|b| (b.code, &b.what) == (p.code, &p.what)));
    if let Some(problem) = new {
        return Err(say!("this cannot be written: {}", problem.what));
    }
    let names: Vec<(FileId, &str)> = own(head).map(|s| (s.id(), s.name.as_str())).collect();
    let of_file = |id: FileId| {
        let name = names.iter().find(|(file, _)| *file == id).map(|(_, name)| *name);
        name.and_then(|name| changes.get(name)).map_or(&[][..], Vec::as_slice)
    };
    renaming.keeps_the_rest(refs, &references(after.whole()), of_file)?;
    Ok(after)
}

/// The part that is declared at a place.
fn at_declaration(refs: &References, place: Span) -> Option<Definition> {
    let found = refs.all().iter().find(|u| u.at == place && u.written == Written::Declared)?;
    Some(found.definition.clone())
}

/// A head and the files that it uses, without the parts of the library.
fn own(head: &Source) -> impl Iterator<Item = &Source> {
    std::iter::once(head).chain(head.others().iter().filter(|o| !o.library).map(|o| &*o.source))
}

fn merge(all: &mut Vec<Splice>, more: Vec<Splice>) {
    all.extend(more);
    all.sort_by_key(|s| (s.start, s.end));
    all.dedup();
}

fn mended_first(source: &Source, name: &str) -> Said {
    let file = Said::foreign(source.name.as_str());
    say!("{file} may name `{name}` too: correct its syntax errors first")
}
