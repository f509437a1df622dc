//! The function blocks of a document that stay function blocks (see [`g7_model::composed::with_blocks`]).
//!
//! Each is rewritten as a document of its own. The rest of the document uses it by the new names of its parameters.

use std::collections::{BTreeMap, HashMap};

use g7_model::composed::{as_block, as_document};
use g7_model::{
    Arg, Composed, Document, Expr, ExprKind, Item, Literal, Name, Path, Problem, Profile, ProfileName, Span,
    Stmt, StmtKind, Type, VarDecl,
};

use super::bodies::{At, named};
use super::identifiers::Names;
use super::lower::{Form, Lower};
use super::lowered;
use crate::nodes;
use crate::report::renamed;
use crate::scopes::{Ref, VarKey};

/// The new names of the function blocks of a document.
#[derive(Default)]
pub(super) struct Blocks {
    types: BTreeMap<Box<str>, Renamed>,
    /// The names that had to be changed.
    changed: Option<Problem>,
}

#[derive(Default)]
struct Renamed {
    name: String,
    /// The members, by their names in the document, with their types.
    members: HashMap<Box<str>, (String, Type)>,
    inouts: Vec<Box<str>>,
}

impl Blocks {
    /// Gives each function block its name. Those of members follow in [`Blocks::lowered`].
    pub(super) fn of(document: &Document) -> Blocks {
        let mut names = Names::new(0);
        let mut made = Blocks::default();
        for c in composed(document) {
            let name = names.give(None, &c.name, "", "");
            let inouts = c.inouts.iter().flat_map(|i| &i.names).map(|n| n.text.clone()).collect();
            made.types.insert(c.name.text.clone(), Renamed { name, members: HashMap::new(), inouts });
        }
        made.changed = renamed(&names.renamed);
        made
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.types.values().map(|t| t.name.as_str())
    }

    /// The new name of a function block.
    pub(super) fn named(&self, of: &Name) -> Name {
        Name::new(self.types.get(&of.text).map_or(&*of.text, |t| t.name.as_str()), of.at.0)
    }

    /// Puts the new names of its type and of the parameters that have initial values into the declaration of an instance.
    pub(super) fn instance(&self, decl: &mut VarDecl) {
        let Some(of) = &mut decl.of else { return };
        let members = self.types.get(&of.text).map(|t| &t.members);
        **of = self.named(of);
        let Some(Expr { kind: ExprKind::Call(_, fields), .. }) = &mut decl.init else { return };
        for field in fields {
            let Some(name) = &mut field.name else { continue };
            let Some((new, ty)) = members.and_then(|m| m.get(&name.text)) else { continue };
            name.text = new.as_str().into();
            typed(&mut field.value, *ty);
        }
    }

    /// Rewrites all function blocks. Each stands behind those that it has instances of, so that their names are known.
    pub(super) fn lowered(&mut self, document: &Document, form: Form) -> (Vec<Composed>, Vec<Problem>) {
        let (mut all, mut problems) = (Vec::new(), Vec::from_iter(self.changed.take()));
        for c in composed(document) {
            let (made, mut own, names) = lowered(&unit(document, c), form, self);
            problems.append(&mut own);
            let name = self.named(&c.name);
            let Some(entry) = self.types.get_mut(&c.name.text) else { continue };
            for decl in c.members.iter().chain(&c.inouts) {
                let new = |n: &Name| Some((n.text.clone(), (names.var(None, &n.text)?.to_owned(), decl.ty)));
                entry.members.extend(decl.names.iter().filter_map(new));
            }
            let is_inout =
                |n: &str| entry.inouts.iter().any(|i| entry.members.get(i).is_some_and(|m| m.0 == n));
            all.push(Composed { name, ..as_block(c, made, is_inout) });
        }
        (all, problems)
    }
}

fn composed(document: &Document) -> impl Iterator<Item = &Composed> {
    document.items.iter().filter_map(|i| if let Item::Composed(c) = i { Some(c) } else { None })
}

/// A function block as a document, with the functions of the file.
fn unit(document: &Document, c: &Composed) -> Document {
    let profile = Profile { name: ProfileName::Iec61131, switches: Vec::new(), at: c.at };
    let functions = document.items.iter().filter(|i| matches!(i, Item::Function(_))).cloned();
    let items = std::iter::once(Item::Profile(profile)).chain(functions).chain(as_document(c).items);
    Document { items: items.collect(), notes: Vec::new() }
}

/// Gives a literal the form that a type needs, where no type is seen from its text.
fn typed(e: &mut Expr, ty: Type) {
    if let ExprKind::Literal(Literal::Int(n, of @ None)) = &mut e.kind {
        if ty.is_real() {
            e.kind = ExprKind::Literal(Literal::Real(format!("{n}.0").into(), None));
        } else if ty.is_bits() && ty != Type::Bool {
            *of = Some(ty);
        }
    }
}

impl<'d> Lower<'d> {
    /// The type of an instance.
    fn block_of(&self, key: VarKey<'d>) -> Option<&'d Renamed> {
        let of = self.scopes.decl(key).filter(|d| d.is_own_instance())?.of.as_ref()?;
        let blocks: &'d Blocks = self.blocks;
        blocks.types.get(&of.text)
    }

    /// A member of an instance, or a bit of one; so many names stand behind the instance.
    pub(super) fn inner(
        &mut self,
        key: VarKey<'d>,
        path: &Path,
        rest: usize,
        span: Span,
        at: &At<'d>,
    ) -> Expr {
        let of = self.block_of(key);
        let mut names = self.var_names(key, at);
        let behind = path.names.len().saturating_sub(rest);
        for (n, name) in path.names.iter().skip(behind).enumerate() {
            let member = of.filter(|_| n == 0).and_then(|of| of.members.get(&name.text));
            names.push(member.map_or_else(|| name.text.to_string(), |(new, _)| new.clone()));
        }
        named(&names, span)
    }

    /// The call of a function block of the file; None for another call.
    pub(super) fn own_call(&mut self, path: &Path, args: &[Arg], span: Span, at: &At<'d>) -> Option<Stmt> {
        let Some(Ref::Var(key)) = self.scopes.refer(at.chart, &path.names).filter(|_| !at.function) else {
            return None;
        };
        let of = self.block_of(key)?;
        self.note(path, true, at);
        let inout = |a: &Arg| a.name.as_ref().is_some_and(|n| of.inouts.contains(&n.text));
        args.iter().filter(|a| inout(a)).for_each(|a| self.writes(&a.value, at));
        let mut args = self.args(args, at);
        for name in args.iter_mut().filter_map(|a| a.name.as_mut()) {
            if let Some((new, _)) = of.members.get(&name.text) {
                name.text = new.as_str().into();
            }
        }
        let name = self.var_names(key, at).join(".");
        Some(Stmt { kind: StmtKind::Call(nodes::path(&[&name], span), args), at: span.into() })
    }
}
