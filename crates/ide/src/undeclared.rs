//! The names that nothing declares, each with the declaration that its uses ask for: its class from where it
//! stands, its type from what it is joined with. Fixes, the fields of the drawing and "declare all" read this list.
//!
//! # What must hold
//!
//! A name is in the list exactly if a problem says that nothing has this name. Its type comes from those uses that
//! tell one; if none does, it is BOOL.

use std::collections::{BTreeMap, BTreeSet};

use g7_edit::Row;
use g7_model::{Document, Problem, Span, codes};

use crate::file::OWN;

mod types;
mod wants;

/// A name that nothing declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undeclared {
    /// The name.
    pub name: String,
    /// `input`, `output` or `var`.
    pub class: &'static str,
    /// Its type as a declaration writes it.
    pub ty: String,
    /// The places that use it, as far as problems tell of them.
    pub uses: Vec<Span>,
}

impl Undeclared {
    /// The row of the table of variables that declares it.
    pub fn row(&self) -> Row {
        Row { name: self.name.clone(), class: self.class.to_owned(), ty: self.ty.clone(), ..Row::default() }
    }
}

/// The names of a text that some problems call unknown, in the order of the text.
pub fn undeclared(text: &str, document: &Document, problems: &[Problem]) -> Vec<Undeclared> {
    let mut uses: BTreeMap<&str, Vec<Span>> = BTreeMap::new();
    let mut order: Vec<&str> = Vec::new();
    for p in problems {
        if let Some(name) = unknown(text, p) {
            let places = uses.entry(name).or_insert_with(|| {
                order.push(name);
                Vec::new()
            });
            places.push(p.at);
        }
    }
    if order.is_empty() {
        return Vec::new();
    }
    let names: BTreeSet<&str> = order.iter().copied().collect();
    let found = wants::wanted(document, &names);
    let one = |name: &str| {
        let facts = found.get(name).cloned().unwrap_or_default();
        Undeclared {
            name: name.to_owned(),
            class: facts.class(),
            ty: facts.ty(),
            uses: uses.get(name).cloned().unwrap_or_default(),
        }
    };
    order.into_iter().map(one).collect()
}

/// The name that a problem says nothing has, if a declaration of it can solve the problem.
pub fn unknown<'t>(text: &'t str, p: &Problem) -> Option<&'t str> {
    if p.code != &codes::UNKNOWN_NAME || p.at.file != OWN {
        return None;
    }
    let there = text.get(p.at.bytes())?.trim_matches('`');
    let plain = !there.is_empty() && there.chars().all(|c| c.is_alphanumeric() || c == '_');
    (plain && *p.what == format!("nothing is called `{there}`")).then_some(there)
}
