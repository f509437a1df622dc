//! The function blocks of a document that stay function blocks (see [`g7_model::composed::with_blocks`]).
//!
//! Each is rewritten as a document of its own. The rest of the document uses it by the new names of its parameters.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::{Composed, Document, Expr, ExprKind, Literal, Name, Problem, Type, UnaryOp, VarDecl};

use super::identifiers::Names;
use crate::report::renamed;

/// The function blocks of a document, with the names that they and their members have in the written file, and the names of
/// its structures.
#[derive(Default)]
pub(super) struct Blocks {
    types: BTreeMap<Box<str>, Renamed>,
    /// The names that had to be changed.
    changed: Option<Problem>,
}

/// A function block with its new names.
#[derive(Default)]
pub(super) struct Renamed {
    name: String,
    /// The new names of the members, by those in the document.
    members: HashMap<Box<str>, String>,
    /// The types of the members, by their new names.
    types: HashMap<String, Type>,
}

impl Renamed {
    /// The new name of a member.
    pub(super) fn member(&self, name: &str) -> Option<&str> {
        self.members.get(name).map(String::as_str)
    }

    /// The type of a member, by its new name.
    pub(super) fn type_of(&self, new: &str) -> Option<Type> {
        self.types.get(new).copied()
    }
}

impl Blocks {
    /// Gives each function block its name, which is none of these words. Those of members follow in [`Blocks::enter`].
    pub(super) fn of(document: &Document, reserved: HashSet<&'static str>) -> Blocks {
        let mut names = Names::new(0, reserved);
        let mut made = Blocks::default();
        for c in document.composed() {
            let name = names.give(None, &c.name, "", "");
            made.types.insert(c.name.text.clone(), Renamed { name, ..Renamed::default() });
        }
        made.changed = renamed(&names.renamed);
        made
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.types.values().map(|t| t.name.as_str())
    }

    /// The new name of a function block or a structure.
    pub(super) fn named(&self, of: &Name) -> Name {
        Name::new(self.types.get(&of.text).map_or(&*of.text, |t| t.name.as_str()), of.at.0)
    }

    /// A function block, by its name in the document.
    pub(super) fn get(&self, name: &str) -> Option<&Renamed> {
        self.types.get(name)
    }

    /// Takes the new names of the members of a function block.
    pub(super) fn enter(&mut self, c: &Composed, names: &Names) -> Option<&Renamed> {
        let entry = self.types.get_mut(&c.name.text)?;
        for decl in c.members.iter().chain(&c.inouts) {
            for name in &decl.names {
                let Some(new) = names.var(None, &name.text) else { continue };
                entry.members.insert(name.text.clone(), new.to_owned());
                entry.types.insert(new.to_owned(), decl.ty);
            }
        }
        Some(entry)
    }

    /// The problem of the names that had to be changed.
    pub(super) fn take_changed(&mut self) -> Option<Problem> {
        self.changed.take()
    }

    /// Puts the new names of its type and of the parameters that have initial values into the declaration of an instance.
    pub(super) fn instance(&self, decl: &mut VarDecl) {
        let Some(of) = &mut decl.of else { return };
        let block = self.types.get(&of.text);
        **of = self.named(of);
        let Some(Expr { kind: ExprKind::Call(_, fields), .. }) = &mut decl.init else { return };
        for field in fields {
            let Some(name) = &mut field.name else { continue };
            let Some((block, new)) = block.and_then(|b| Some((b, b.member(&name.text)?))) else { continue };
            name.text = new.into();
            block.type_of(new).iter().for_each(|ty| typed(&mut field.value, *ty));
        }
    }
}

/// Gives a literal the form that a type needs, where no type is seen from its text.
pub(super) fn typed(e: &mut Expr, ty: Type) {
    match &mut e.kind {
        ExprKind::Literal(Literal::Int(n, None)) if ty.is_real() => {
            e.kind = ExprKind::Literal(Literal::Real(format!("{n}.0").into(), None));
        }
        ExprKind::Literal(Literal::Int(_, of @ None)) if ty.is_bits() && ty != Type::Bool => *of = Some(ty),
        ExprKind::Unary(UnaryOp::Neg, inner) => typed(inner, ty),
        _ => {}
    }
}
