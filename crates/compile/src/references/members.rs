//! The types that a file declares, and what their variables and members are.
//!
//! `walk` follows paths through them, and so does an editor that completes one.

use std::collections::HashMap;

use g7_model::{Body, ChartItem, Composed, Document, Item, Local, Name, Type, VarDecl};

use super::named::Definition;

/// The structures and function blocks of a file, and its variables.
#[derive(Debug, Default)]
pub struct Types<'d> {
    types: HashMap<&'d str, &'d Composed>,
    /// By the name of their chart and their own.
    vars: HashMap<(Option<&'d str>, &'d str), &'d VarDecl>,
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

impl<'d> Types<'d> {
    /// The types and variables of a document. Of two with one name, the first counts.
    pub fn of(document: &'d Document) -> Types<'d> {
        let mut made = Types::default();
        for item in &document.items {
            match item {
                Item::Composed(c) => _ = made.types.entry(&*c.name.text).or_insert(c),
                Item::Var(v) => made.declare(None, v),
                Item::Chart(c) => c.items.iter().for_each(|i| {
                    if let ChartItem::Var(v) = i {
                        made.declare(Some(&c.name.text), v);
                    }
                }),
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
            Some(of) => self.named(&of.text).map_or(Kind::Unknown, Kind::Composed),
            None => Kind::Plain(v.ty),
        }
    }

    /// The type of a member.
    pub fn kind_of(&self, member: &Member<'_>) -> Kind<'d> {
        match member.declared {
            Declared::Var(v) | Declared::InOut(v) => self.kind(v),
            Declared::Local(l) => Kind::Plain(l.ty),
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
