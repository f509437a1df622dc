//! Function blocks that stay, for formats that have such: a call stays a call, and an instance is one variable.
//!
//! ```text
//! instances -> with_blocks -> the writers of exchange that have function blocks
//! ```
//!
//! # What must hold
//!
//! - A function block stays if it has a body and no chart, if its inputs, outputs and in-outs are of elementary types,
//!   if its body names nothing of the file but constants and values of enumerations, and if others use nothing of its
//!   instances but calls, inputs and outputs. Each other one is taken apart, see [`super`].
//! - The members and the body of a function block that stays are plain, like all else in the result.
//! - A function block that stays stands behind those that it has instances of.
//! - A member of a structure is a variable of its own, as in [`decomposed`], with [`VarDecl::part_of`]. The structures of which
//!   there are such members are the first types of the result, each behind those that it has members of. An initial value in
//!   these is a literal, or a list of such.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::base::{Composition, Kept};
use super::kept::{is_parameter, is_written};
use super::plain::{decomposed, without_locals};
use crate::named::numbered;
use crate::visit_mut::{self, Use, Visitor};
use crate::{
    Body, Composed, Document, Expr, ExprKind, Item, Limits, Literal, Path, Problem, Severity, Span, VarDecl,
    VarKind, bare, codes,
};

/// How often a document is looked through for function blocks that cannot stay; after that, all are taken apart.
const ROUNDS: usize = 16;

/// The document with plain variables, and without function blocks except those that can stay. If `initial`, their instances
/// keep their initial values; otherwise each call gives these.
///
/// The problems tell where the result runs otherwise. Those of [`decomposed`] are left out: the caller has seen them.
pub fn with_blocks(document: &Document, initial: bool) -> (Cow<'_, Document>, Vec<Problem>) {
    let mut names = candidates(document);
    let rounds = if document.composed().next().is_some() { ROUNDS } else { 0 };
    for _ in 0..rounds {
        let kept = Kept { names: names.clone(), initial, structures: true, ..Kept::default() };
        match staying(document, &kept) {
            Ok((made, told)) => return (Cow::Owned(made), told),
            Err(_) if names.is_empty() => break,
            Err(refused) => names.retain(|name| !refused.contains(name)),
        }
    }
    (decomposed(document).0, Vec::new())
}

/// A function block as a document: its members and in-outs are the variables, and its body stands before the charts.
pub fn as_document(of: &Composed) -> Document {
    let variables = of.members.iter().chain(&of.inouts).cloned().map(Item::Var);
    let body = of.body.clone().map(|body| Item::Pre(body, of.at));
    Document { items: variables.chain(body).collect(), notes: Vec::new() }
}

/// The function block that a document of [`as_document`] has become; `new` tells the new name of a variable.
pub fn as_block<'n>(of: &'n Composed, document: Document, new: impl Fn(&'n str) -> &'n str) -> Composed {
    let given: HashSet<&str> = of.inouts.iter().flat_map(|i| &i.names).map(|n| new(&n.text)).collect();
    let (mut members, mut inouts, mut body) = (Vec::new(), Vec::new(), None);
    for item in document.items {
        match item {
            Item::Var(v) if v.names.iter().any(|n| given.contains(&*n.text)) => inouts.push(v),
            Item::Var(v) => members.push(v),
            Item::Pre(own, _) => body = Some(own),
            _ => {}
        }
    }
    Composed { members, inouts, body, ..of.clone() }
}

/// The function blocks that can stay as far as their own text tells.
fn candidates(document: &Document) -> BTreeSet<Box<str>> {
    let with_charts: BTreeSet<&str> =
        document.charts().filter_map(|c| c.block.as_ref()).map(|b| &*b.text).collect();
    let known = Known::of(document);
    document
        .composed()
        .filter(|c| c.block && !with_charts.contains(&*c.name.text))
        .filter(|c| known.fits(c))
        .map(|c| c.name.text.clone())
        .collect()
}

/// The names of a file that a function block can use and stay: values of enumerations, and constants with a written
/// value.
struct Known<'d> {
    values: HashSet<&'d str>,
    /// The number of each value, by the names of its enumeration and of itself.
    numbers: HashMap<(&'d str, &'d str), i128>,
    /// The names of variables, which hide such values.
    variables: HashSet<&'d str>,
    constants: HashMap<&'d str, &'d Expr>,
}

impl<'d> Known<'d> {
    fn of(document: &'d Document) -> Known<'d> {
        let mut known = Known {
            values: HashSet::new(),
            numbers: HashMap::new(),
            variables: HashSet::new(),
            constants: HashMap::new(),
        };
        for item in &document.items {
            match item {
                Item::Type(t) => {
                    known.values.extend(t.type_names().map(|n| &*n.text));
                    let numbered = numbered(t.values()).into_iter();
                    known.numbers.extend(
                        numbered.filter_map(|(value, n)| Some(((&*t.names.first()?.text, &*value.text), n?))),
                    );
                }
                Item::Var(v) if v.kind == VarKind::Const => {
                    let value = v.init.as_ref().filter(|e| is_written(e) && v.limits.is_none());
                    known.constants.extend(v.names.iter().filter_map(|n| Some((&*n.text, value?))));
                }
                Item::Var(v) => known.variables.extend(v.names.iter().map(|n| &*n.text)),
                _ => {}
            }
        }
        known
    }

    fn has(&self, name: &str) -> bool {
        self.constants.contains_key(name) || self.values.contains(name) && !self.variables.contains(name)
    }

    fn fits(&self, of: &Composed) -> bool {
        let plain = |v: &VarDecl| v.of.is_none() && v.array.is_none();
        let parameters = of.members.iter().filter(|m| is_parameter(m)).chain(&of.inouts);
        let mut all = of.members.iter().chain(&of.inouts);
        let Some(body) = &of.body else { return false };
        let mut names = Names { own: own_names(of), known: self, fits: true };
        let mut body = body.block().clone();
        visit_mut::block(&mut body, &mut names);
        let unbounded =
            all.all(|m| m.range().is_none()) && body.locals.iter().all(|l| l.ty.range().is_none());
        names.fits && parameters.into_iter().all(plain) && unbounded
    }
}

/// The names that a function block declares.
fn own_names(of: &Composed) -> BTreeSet<Box<str>> {
    let locals = of.body.iter().flat_map(|b| &b.block().locals).flat_map(|l| &l.names);
    let members = of.members.iter().chain(&of.inouts).flat_map(|m| &m.names);
    members.chain(locals).map(|n| n.text.clone()).collect()
}

/// Looks whether a body names anything else of the file.
struct Names<'k, 'd> {
    own: BTreeSet<Box<str>>,
    known: &'k Known<'d>,
    fits: bool,
}

impl Visitor for Names<'_, '_> {
    fn path(&mut self, path: &mut Path, how: Use, _: Span) {
        let Some(first) = path.names.first().map(|n| bare(&n.text).0) else { return };
        self.fits &= self.own.contains(first) || self.known.has(first) && how == Use::Read;
    }

    fn expr(&mut self, e: &mut Expr) {
        self.fits &= !matches!(e.kind, ExprKind::Direct(_));
    }
}

/// Puts the values of constants of the file in their places in a function block.
struct Constants<'k, 'd> {
    own: BTreeSet<Box<str>>,
    known: &'k Known<'d>,
}

/// Replaces the values of an enumeration by their numbers in the initial value of one of its variables.
struct Values<'k, 'd> {
    known: &'k Known<'d>,
    of: Option<&'k str>,
}

impl Visitor for Values<'_, '_> {
    fn expr(&mut self, e: &mut Expr) {
        let (Some(of), ExprKind::Path(path)) = (self.of, &e.kind) else { return };
        let number = path.names.last().and_then(|value| self.known.numbers.get(&(of, &*value.text)));
        if let Some(number) = number {
            e.kind = ExprKind::Literal(Literal::Int(*number, None));
        }
    }
}

impl Constants<'_, '_> {
    /// The same in the initial value and the bounds of a declaration.
    fn declaration(&mut self, v: &mut VarDecl) {
        v.init.iter_mut().for_each(|e| visit_mut::expr(e, self));
        for (least, most) in v.array.iter_mut().flat_map(|a| &mut a.dimensions) {
            visit_mut::expr(least, self);
            visit_mut::expr(most, self);
        }
    }
}

impl Visitor for Constants<'_, '_> {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Path(path) = &e.kind else { return };
        let [name] = path.names.as_slice() else { return };
        if let Some(value) = self.known.constants.get(&*name.text).filter(|_| !self.own.contains(&name.text))
        {
            e.kind = value.kind.clone();
        }
    }
}

/// The document in which these function blocks stay.
///
/// # Errors
///
/// Those of them that cannot.
fn staying(document: &Document, kept: &Kept) -> Result<(Document, Vec<Problem>), BTreeSet<Box<str>>> {
    let mut main = Plain::of(document, kept);
    if main.wrong {
        return Err(kept.names.clone());
    }
    let mut units = Units {
        types: document.composed().map(|c| (&*c.name.text, c)).collect(),
        enumerations: document.items.iter().filter(|i| matches!(i, Item::Type(_))).collect(),
        kept,
        known: Known::of(document),
        made: Vec::new(),
        seen: BTreeSet::new(),
        told: main.told,
    };
    let mut refused = std::mem::take(&mut main.refused);
    main.used.iter().for_each(|name| units.add(name, &mut refused));
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut items: Vec<Item> = main.document.items;
    let structures = structures(&units, &items);
    let first = items.iter().position(|i| matches!(i, Item::Var(_) | Item::Chart(_))).unwrap_or(items.len());
    items.splice(first..first, structures.into_iter().chain(units.made).map(Item::Composed));
    Ok((Document { items, notes: main.document.notes }, units.told))
}

/// True for a literal, and for a list of such.
fn all_written(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::List(values) => values.iter().all(|(_, e)| is_written(e)),
        _ => is_written(e),
    }
}

/// The structures of which there are members, and the structures in these.
fn structures(units: &Units<'_>, items: &[Item]) -> Vec<Composed> {
    let of_blocks = units.made.iter().flat_map(|c| &c.members);
    let of_items = items.iter().flat_map(|item| match item {
        Item::Var(v) => vec![v],
        Item::Chart(c) => c.vars().collect(),
        _ => Vec::new(),
    });
    let named = of_items.chain(of_blocks).filter_map(|v| v.part_of.as_ref());
    let (mut made, mut seen) = (Vec::new(), BTreeSet::new());
    named.for_each(|name| units.structure(&name.text, &mut seen, &mut made));
    made
}

/// A document in plain form.
struct Plain {
    document: Document,
    /// The function blocks that stay and of which there are instances, in the order of the document.
    used: Vec<Box<str>>,
    refused: BTreeSet<Box<str>>,
    /// True if an error was found.
    wrong: bool,
    /// Tells of what runs otherwise.
    told: Vec<Problem>,
}

impl Plain {
    fn of(document: &Document, kept: &Kept) -> Plain {
        let own = without_locals(document);
        let Some(mut made) = Composition::of(&own) else {
            let (used, refused) = (Vec::new(), BTreeSet::new());
            let document = own.into_owned();
            return Plain { document, used, refused, wrong: false, told: Vec::new() };
        };
        made.kept.clone_from(kept);
        let plain = made.walked(&own);
        let used = document.composed().map(|c| &c.name.text);
        let used = used.filter(|n| made.kept.names.contains(*n) && made.used.contains(&***n));
        let wrong = made.problems.iter().any(|p: &Problem| p.severity() == Severity::Error);
        let used = used.cloned().collect();
        let mut told = made.problems;
        told.retain(|p| p.code.id == codes::DIFFERENT.id);
        Plain { used, document: plain, refused: made.kept.refused, wrong, told }
    }
}

/// The function blocks that stay, each behind those that it has instances of.
struct Units<'d> {
    types: HashMap<&'d str, &'d Composed>,
    /// The other types of the file.
    enumerations: Vec<&'d Item>,
    kept: &'d Kept,
    known: Known<'d>,
    made: Vec<Composed>,
    seen: BTreeSet<Box<str>>,
    told: Vec<Problem>,
}

impl<'d> Units<'d> {
    fn add(&mut self, name: &str, refused: &mut BTreeSet<Box<str>>) {
        let Some(of) = self.types.get(name).copied() else { return };
        if !self.seen.insert(of.name.text.clone()) {
            return;
        }
        let unit = Plain::of(&self.unit(of), self.kept);
        refused.extend(unit.refused);
        self.told.extend(unit.told);
        if unit.wrong {
            refused.insert(of.name.text.clone());
            return;
        }
        unit.used.iter().for_each(|inner| self.add(inner, refused));
        self.made.push(as_block(of, unit.document, |name| name));
    }

    /// A structure behind those that it has members of; the types of a file stand in each other at most [`super::DEEP`]
    /// deep.
    fn structure(&self, name: &str, seen: &mut BTreeSet<&'d str>, made: &mut Vec<Composed>) {
        let Some(of) = self.types.get(name).copied().filter(|of| seen.insert(&*of.name.text)) else { return };
        let inner = of.members.iter().filter_map(|m| m.of.as_ref());
        inner.for_each(|inner| self.structure(&inner.text, seen, made));
        let mut own = of.clone();
        let mut constants = Constants { own: BTreeSet::new(), known: &self.known };
        for v in &mut own.members {
            let of = if let Some(Limits::Of(of)) = v.limits.as_deref() { Some(&*of.text) } else { None };
            let mut named = Values { known: &self.known, of };
            v.init.iter_mut().for_each(|e| visit_mut::expr(e, &mut named));
            constants.declaration(v);
            v.init = v.init.take().filter(all_written);
        }
        made.push(own);
    }

    /// The function block as a document with the types of its variables.
    fn unit(&self, of: &'d Composed) -> Document {
        let mut constants = Constants { own: own_names(of), known: &self.known };
        let mut own = of.clone();
        for v in own.members.iter_mut().chain(&mut own.inouts) {
            constants.declaration(v);
        }
        if let Some(body) = &mut own.body {
            // The constants stand in the statements, whatever language shows these.
            let mut block = body.block().clone();
            visit_mut::block(&mut block, &mut constants);
            *body = Body::St(block);
        }
        let types = self.within(of);
        // Function blocks that are taken apart in this one may name values of enumerations.
        let named = self.enumerations.iter().copied().filter(|_| !types.is_empty());
        let types = types.iter().map(|c| Item::Composed((*c).clone()));
        let items = named.cloned().chain(types).chain(as_document(&own).items).collect();
        Document { items, notes: Vec::new() }
    }

    /// The types of a function block's variables, and those of their members.
    fn within(&self, of: &'d Composed) -> Vec<&'d Composed> {
        let (mut found, mut seen, mut next) = (Vec::new(), BTreeSet::new(), vec![of]);
        while let Some(one) = next.pop() {
            for name in one.members.iter().chain(&one.inouts).filter_map(|m| m.of.as_ref()) {
                if let Some(inner) = self.types.get(&*name.text).copied().filter(|_| seen.insert(&*name.text))
                {
                    found.push(inner);
                    next.push(inner);
                }
            }
        }
        found
    }
}
