//! Finds what every name of a document refers to: for renaming, for "go to the definition" and for
//! hovers.
//!
//! ```text
//! model::Document -> resolve (names) -> here: name by name, the whole document
//! ```
//!
//! Names are looked up in the order of `resolve`. An unknown name stands in a list of its own. Plants
//! and tests are followed too; they see the charts from outside.

mod members;
mod named;
mod plants;
mod walk;

use g7_model::{Document, FileId, Span};

pub use members::{Declared, Kind, Member, Types, values};
pub use named::{Definition, Unknown, Use, Written};

/// Every name of a document with what it refers to, in the order of the text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct References {
    uses: Vec<Use>,
    unknown: Vec<Unknown>,
    /// The file in which a byte is looked up; in any if there is none.
    file: Option<FileId>,
}

impl References {
    /// Finds what the name at a byte refers to. The byte just after a name counts as part of it.
    pub fn at(&self, offset: u32) -> Option<&Definition> {
        self.use_at(offset).map(|u| &u.definition)
    }

    /// The same for a document of several files: bytes are those of this file.
    #[must_use]
    pub fn seen_from(mut self, file: FileId) -> References {
        self.file = Some(file);
        self
    }

    /// Finds the name at a byte. The byte just after a name counts as part of it.
    pub fn use_at(&self, offset: u32) -> Option<&Use> {
        let here = self.uses.iter().filter(|u| self.file.is_none_or(|file| u.at.file == file));
        let near = here.filter(|u| u.at.start <= offset && offset <= u.at.end);
        near.min_by_key(|u| (offset == u.at.end, u.at.end - u.at.start))
    }

    /// Every place of a name, including its declaration.
    pub fn of(&self, definition: &Definition) -> Vec<Span> {
        self.uses_of(definition).map(|u| u.at).collect()
    }

    /// Every place where a definition is named, including its declaration.
    pub fn uses_of<'r>(&'r self, definition: &'r Definition) -> impl Iterator<Item = &'r Use> {
        self.uses.iter().filter(move |u| u.definition == *definition)
    }

    /// Where it is declared.
    pub fn declaration(&self, definition: &Definition) -> Option<Span> {
        self.uses_of(definition).find(|u| u.written == Written::Declared).map(|u| u.at)
    }

    /// All of them.
    pub fn all(&self) -> &[Use] {
        &self.uses
    }

    /// Names that are read and refer to nothing that is read.
    pub fn unknown(&self) -> &[Unknown] {
        &self.unknown
    }
}

/// Follows every name of a document.
pub fn references(doc: &Document) -> References {
    let (mut uses, unknown) = walk::uses(doc);
    uses.sort_by_key(|u| (u.at, u.before));
    uses.dedup();
    References { uses, unknown, file: None }
}

#[cfg(test)]
mod tests;
