//! The types that a file declares, and what their variables and members are.
//!
//! `walk` follows paths through them, and so does an editor that completes one.

use std::collections::HashMap;

use g7_model::composed::DEEP;
use g7_model::{Body, Chart, Composed, Document, Item, Local, Name, Type, VarDecl};

use super::named::Definition;
use crate::resolve::Traced;

/// The types of a file, and its variables.
#[derive(Debug, Default)]
pub struct Types<'d> {
    types: HashMap<&'d str, &'d Composed>,
    /// The types that are no structures and function blocks.
    others: HashMap<&'d str, &'d VarDecl>,
    /// By the name of their chart and their own.
    vars: HashMap<(Option<&'d str>, &'d str), &'d VarDecl>,
    /// The charts of function blocks.
    charts: Vec<&'d Chart>,
}

/// The type of a variable or of a part of one; of an array, that of its elements.
#[derive(Clone, Copy, Debug)]
pub enum Kind<'d> {
    /// A type that the file declares.
    Composed(&'d Composed),
    /// A type of the language.
    Plain(Type),
    /// The file names a type that it does not declare.
    Unknown,
}

/// A name that a structure or function block declares.
#[derive(Clone, Copy, Debug)]
pub struct Member<'d> {
    /// The type that declares it.
    pub of: &'d Composed,
    /// Its name there.
    pub name: &'d Name,
    /// Its declaration.
    pub declared: Declared<'d>,
}

/// The declaration of a member.
#[derive(Clone, Copy, Debug)]
pub enum Declared<'d> {
    /// A member or a parameter.
    Var(&'d VarDecl),
    /// A parameter that stands for a variable of the caller.
    InOut(&'d VarDecl),
    /// A variable of the body; it is a member too once the body is compiled.
    Local(&'d Local),
}

impl<'d> Member<'d> {
    /// All members of a type, in the order of the text.
    pub fn all(of: &'d Composed) -> impl Iterator<Item = Member<'d>> {
        let members = of.members.iter().map(Declared::Var);
        let inouts = of.inouts.iter().map(Declared::InOut);
        let locals = locals(of).iter().map(Declared::Local);
        members
            .chain(inouts)
            .chain(locals)
            .flat_map(move |declared| declared.names().iter().map(move |name| Member { of, name, declared }))
    }

    /// The member of a type that has this name.
    pub fn named(of: &'d Composed, name: &str) -> Option<Member<'d>> {
        Member::all(of).find(|m| *m.name.text == *name)
    }

    pub(super) fn definition(&self) -> Definition {
        Definition::Member { of: self.of.name.text.to_string(), name: self.name.text.to_string() }
    }
}

impl<'d> Declared<'d> {
    /// The names declared together.
    pub fn names(self) -> &'d [Name] {
        match self {
            Declared::Var(v) | Declared::InOut(v) => &v.names,
            Declared::Local(l) => &l.names,
        }
    }
}

/// The local variables of the body. Those of a body in another language stand in no declarations that are read.
fn locals(of: &Composed) -> &[Local] {
    match &of.body {
        Some(Body::St(block)) => &block.locals,
        Some(Body::Other(..)) | None => &[],
    }
}

/// The values of an enumeration, each with the name of the enumeration before it; none for other types.
pub fn values(t: &VarDecl) -> impl Iterator<Item = (&Name, &Name)> {
    let of = t.names.first();
    t.values().iter().filter_map(move |(name, _)| Some((of?, name)))
}

impl<'d> Types<'d> {
    /// The types and variables of a document. Of two with one name, the first counts.
    pub fn of(document: &'d Document) -> Types<'d> {
        let mut made = Types::default();
        for item in &document.items {
            match item {
                Item::Composed(c) => _ = made.types.entry(&*c.name.text).or_insert(c),
                Item::Type(t) => made.others.extend(t.names.first().map(|name| (&*name.text, t))),
                Item::Var(v) => made.declare(None, v),
                Item::Chart(c) => {
                    c.vars().for_each(|v| made.declare(Some(&c.name.text), v));
                    made.charts.extend(c.block.is_some().then_some(c));
                }
                _ => {}
            }
        }
        made
    }

    fn declare(&mut self, chart: Option<&'d str>, v: &'d VarDecl) {
        for name in &v.names {
            self.vars.entry((chart, &*name.text)).or_insert(v);
        }
    }

    /// The charts of a function block.
    pub fn charts(&self, of: &Composed) -> impl Iterator<Item = &'d Chart> {
        self.charts.iter().copied().filter(|c| c.block.as_ref().is_some_and(|b| b.text == of.name.text))
    }

    /// The type with this name that is no structure and no function block.
    pub fn other(&self, name: &str) -> Option<&'d VarDecl> {
        self.others.get(name).copied()
    }

    /// True if the file declares a type of this name.
    pub fn has(&self, name: &str) -> bool {
        self.types.contains_key(name) || self.others.contains_key(name)
    }

    /// The names of a path that is a value of an enumeration: `Automatic`, `Mode.Automatic`. None for other paths, and for
    /// a value of two enumerations.
    pub(super) fn value(&self, names: &[Name]) -> Vec<Traced> {
        match names {
            [only] => {
                let mut all =
                    self.others.values().flat_map(|t| values(t)).filter(|(_, v)| v.text == only.text);
                match (all.next(), all.next()) {
                    (Some((of, name)), None) => vec![(0, Definition::value(of, name), 0)],
                    _ => Vec::new(),
                }
            }
            [ty, name] => {
                let Some(t) = self.others.get(&*ty.text) else { return Vec::new() };
                let mut all = vec![(0, Definition::Type(ty.text.to_string()), 0)];
                let found = values(t).find(|(_, v)| v.text == name.text);
                all.extend(found.map(|(of, name)| (1, Definition::value(of, name), 0)));
                all
            }
            _ => Vec::new(),
        }
    }

    /// True if the file declares no type.
    pub fn is_empty(&self) -> bool {
        self.types.is_empty()
    }

    /// The type with this name.
    pub fn named(&self, name: &str) -> Option<&'d Composed> {
        self.types.get(name).copied()
    }

    /// A variable of a chart, or of the file.
    pub fn variable(&self, chart: Option<&str>, name: &str) -> Option<&'d VarDecl> {
        self.vars.get(&(chart, name)).copied()
    }

    /// The type of a variable.
    pub fn kind(&self, v: &VarDecl) -> Kind<'d> {
        match &v.of {
            Some(of) => self.kind_named(&of.text, 0),
            None => Kind::Plain(v.ty),
        }
    }

    /// The type with this name. If it is another name for a type, that type; `passed` counts such names on the way.
    fn kind_named(&self, name: &str, passed: usize) -> Kind<'d> {
        if let Some(composed) = self.named(name) {
            return Kind::Composed(composed);
        }
        let Some(t) = self.others.get(name).filter(|_| passed < DEEP) else {
            return Kind::Unknown;
        };
        match &t.of {
            Some(of) => self.kind_named(&of.text, passed + 1),
            None => Kind::Plain(t.ty),
        }
    }

    /// The type of a member.
    pub fn kind_of(&self, member: &Member<'_>) -> Kind<'d> {
        match member.declared {
            Declared::Var(v) | Declared::InOut(v) => self.kind(v),
            Declared::Local(l) => match &l.ty.of {
                Some(of) => self.kind_named(&of.text, 0),
                None => Kind::Plain(l.ty.base),
            },
        }
    }

    /// Follows the names behind a variable: the members that they are, and what the last one is. It ends early at a
    /// name that is no member of a type of the file.
    pub fn behind(&self, kind: Kind<'d>, names: &[&str]) -> (Vec<Member<'d>>, Kind<'d>) {
        let (mut kind, mut found) = (kind, Vec::new());
        for name in names {
            let Kind::Composed(of) = kind else { break };
            let Some(member) = Member::named(of, name) else { break };
            kind = self.kind_of(&member);
            found.push(member);
        }
        (found, kind)
    }
}
