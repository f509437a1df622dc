//! Enumerations of the file, which stay types of `TYPE … END_TYPE` with names for their values.
//!
//! Up to here a variable of an enumeration is an INT with [`Limits::Of`], and numbers stand in the places of values. An
//! enumeration stays if its numbers are 0, 1, 2 …, which compilers give the values as well, and if all its variables are only
//! compared for equality, assigned, given to parameters of the same type and chosen from by CASE, each time beside a value
//! or a variable of the same type (IEC 61131-3:2003, 2.3.3.1). Otherwise its variables stay INT, and its values numbers.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use g7_model::visit::Visitor as Reader;
use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    Arg, BinaryOp, Block, Body, ChartItem, Document, Expr, ExprKind, Function, Item, Limits, Name, Order,
    Path, Problem, Span, Stmt, StmtKind, Type, ValueType, VarDecl, VarKind, named::numbered,
};

use super::form::Form;
use super::identifiers::Names;
use crate::nodes;
use crate::report::renamed;
use crate::variables::{Declared, Home, Variables, of_value};

/// The enumerations that stay, by their names in the document.
#[derive(Default)]
pub(super) struct Enumerations {
    types: BTreeMap<Box<str>, Enumeration>,
}

/// The names that an enumeration and its values have in the written file.
struct Enumeration {
    name: Name,
    /// In the order of their numbers 0, 1, 2 …
    values: Vec<Name>,
}

impl Enumerations {
    /// Finds the enumerations of `document` that can stay, and puts their types and the names of their values into `out`, the
    /// rewritten document.
    pub(super) fn of(
        document: &Document,
        form: Form,
        out: &mut Document,
        names: &mut Names,
    ) -> (Enumerations, Option<Problem>) {
        let counts = counts(document);
        let mut made = Enumerations::default();
        if counts.is_empty() {
            return (made, None);
        }
        let variables = Variables::of(out);
        let mut looking = Looking::new(&variables, form, counts, None);
        looking.document(out);
        document.composed().filter(|c| !c.block).flat_map(|c| &c.members).for_each(|m| looking.initial(m));
        let staying = looking.staying();
        if staying.is_empty() {
            return (made, None);
        }
        let changed = made.name(document, out, &staying, names);
        let mut naming = Looking::new(&variables, form, looking.counts, Some(&made));
        naming.document(out);
        let mut types: Vec<&Enumeration> = made.types.values().collect();
        types.sort_by_key(|t| t.name.at.0.start);
        let types: Vec<Item> = types.into_iter().map(Enumeration::declared).collect();
        out.items.splice(1..1, types);
        (made, changed)
    }

    /// Gives the enumerations and their values names that nothing else has.
    fn name(
        &mut self,
        document: &Document,
        out: &Document,
        staying: &BTreeSet<Box<str>>,
        names: &mut Names,
    ) -> Option<Problem> {
        // Compilers know the names of values everywhere.
        for c in out.composed().chain(document.composed().filter(|c| !c.block)) {
            let own = c.members.iter().chain(&c.inouts).flat_map(|m| &m.names);
            own.for_each(|n| names.reserve(&n.text));
        }
        let mut changed = Vec::new();
        let mut give = |name: &Name, wish: &str| {
            let new = names.free(None, wish);
            if *new != *name.text {
                changed.push((name.at.0, name.text.clone(), new.clone()));
            }
            Name::new(new, name.at.0)
        };
        for (name, values) in enumerations(document).filter(|(name, _)| staying.contains(&name.text)) {
            let new = give(name, &name.text);
            let values = values.iter().map(|(value, _)| give(value, &value.text)).collect();
            self.types.insert(name.text.clone(), Enumeration { name: new, values });
        }
        renamed(&changed)
    }

    fn get(&self, limits: Option<&Limits>) -> Option<&Enumeration> {
        match limits {
            Some(Limits::Of(name)) => self.types.get(&name.text),
            _ => None,
        }
    }

    /// The new name of the enumeration of a member. The initial values of the member become names of values.
    pub(super) fn of_member(&self, decl: &VarDecl, values: &mut [Expr]) -> Option<Name> {
        let of = self.get(decl.limits.as_deref())?;
        if !firsts(decl) {
            values.iter_mut().for_each(|e| of.value(e));
        }
        Some(of.name.clone())
    }

    /// Puts the new name of its enumeration into the type of a parameter, a local variable or a result.
    fn name_type(&self, ty: &mut ValueType) {
        if let Some(of) = self.get(ty.limits.as_deref()) {
            ty.of = Some(Box::new(of.name.clone()));
        }
    }

    /// Puts the new name of its enumeration into a declaration, and the names of values into its initial value.
    fn declare(&self, decl: &mut VarDecl) {
        let Some(of) = self.get(decl.limits.as_deref()) else { return };
        decl.of = Some(Box::new(of.name.clone()));
        if firsts(decl) {
            decl.init = None;
        }
        match decl.init.as_mut().map(|e| &mut e.kind) {
            Some(ExprKind::List(values)) => values.iter_mut().for_each(|(_, e)| of.value(e)),
            Some(_) => decl.init.iter_mut().for_each(|e| of.value(e)),
            None => {}
        }
    }
}

/// True for an array whose elements all begin with the first value of the enumeration. This needs no initial values.
fn firsts(decl: &VarDecl) -> bool {
    let Some(ExprKind::List(all)) = decl.init.as_ref().map(|e| &e.kind) else { return false };
    all.iter().all(|(_, e)| e.kind.whole() == Some(0))
}

impl Enumeration {
    /// Puts the name of a value in the place of its number.
    fn value(&self, e: &mut Expr) {
        let place = e.kind.whole().and_then(|n| usize::try_from(n).ok());
        if let Some(name) = place.and_then(|n| self.values.get(n)) {
            *e = nodes::name(&[&name.text], e.at.0);
        }
    }

    fn declared(&self) -> Item {
        let values = self.values.iter().map(|name| (name.clone(), None)).collect();
        let limits = Some(Box::new(Limits::Values(values)));
        let at = self.name.at;
        Item::Type(VarDecl { limits, ..VarDecl::new(VarKind::Var, vec![self.name.clone()], Type::Int, at) })
    }
}

/// The names and values of the enumerations of a document.
type Values = [(Name, Option<Expr>)];

fn enumerations(document: &Document) -> impl Iterator<Item = (&Name, &Values)> {
    document.items.iter().filter_map(|item| match item {
        Item::Type(t) if !t.values().is_empty() => Some((t.names.first()?, t.values())),
        _ => None,
    })
}

/// The number of values of each enumeration whose numbers are 0, 1, 2 …
fn counts(document: &Document) -> BTreeMap<Box<str>, i128> {
    let one = |(name, values): (&Name, &Values)| {
        let numbers = numbered(values).into_iter().map(|(_, n)| n);
        numbers.eq((0..).map(Some).take(values.len())).then(|| (name.text.clone(), values.len() as i128))
    };
    enumerations(document).filter_map(one).collect()
}

/// Counts all uses of variables of enumerations. With `made`, it replaces the numbers beside them by the names of values.
struct Looking<'a> {
    variables: &'a Variables,
    form: Form,
    /// The number of values of each enumeration.
    counts: BTreeMap<Box<str>, i128>,
    made: Option<&'a Enumerations>,
    home: Home,
    /// The number of uses of the variables of each enumeration.
    named: BTreeMap<Box<str>, usize>,
    /// The number of those uses in a place where the name of a value can stand.
    right: BTreeMap<Box<str>, usize>,
    /// The enumerations with a value that has no name.
    nameless: BTreeSet<Box<str>>,
    /// The names of local variables of bodies.
    locals: HashSet<Box<str>>,
    /// The parameters, the local variables and the result of a function, while this is walked.
    own: BTreeMap<Box<str>, Declared>,
}

impl<'a> Looking<'a> {
    fn new(
        variables: &'a Variables,
        form: Form,
        counts: BTreeMap<Box<str>, i128>,
        made: Option<&'a Enumerations>,
    ) -> Looking<'a> {
        Looking {
            variables,
            form,
            counts,
            made,
            home: Home::File,
            named: BTreeMap::new(),
            right: BTreeMap::new(),
            nameless: BTreeSet::new(),
            locals: HashSet::new(),
            own: BTreeMap::new(),
        }
    }

    fn document(&mut self, document: &mut Document) {
        for item in &mut document.items {
            self.home = match item {
                Item::Chart(c) => Home::Chart(c.name.text.clone()),
                Item::Composed(c) => Home::Block(c.name.text.clone()),
                _ => Home::File,
            };
            match item {
                Item::Var(v) => self.declared(v),
                Item::Chart(c) => {
                    let own = c.items.iter_mut();
                    own.filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None })
                        .for_each(|v| self.declared(v));
                }
                Item::Composed(c) => {
                    c.members.iter_mut().for_each(|v| self.declared(v));
                    c.inouts.iter_mut().for_each(|v| self.declared(v));
                    if let Some(Body::St(block)) = &mut c.body {
                        visit_mut::block(block, self);
                    }
                }
                Item::Function(f) => self.function(f),
                _ => {}
            }
            if !matches!(item, Item::Function(_)) {
                self.locals_of(item);
            }
            visit_mut::item(item, self);
        }
    }

    /// A function, whose names hide all others.
    fn function(&mut self, f: &mut Function) {
        let locals = f.body.locals.iter().flat_map(|l| l.names.iter().map(|n| (n, &l.ty)));
        let own = f.params.iter().map(|p| (&p.name, &p.ty)).chain([(&f.name, &f.result)]).chain(locals);
        self.own = own.map(|(name, ty)| (name.text.clone(), of_value(ty))).collect();
        for local in &mut f.body.locals {
            if let (Some(of), Some(value)) = (of_value(&local.ty).of, &mut local.init) {
                self.place(&of, value);
            }
        }
        visit_mut::block(&mut f.body, self);
        self.own.clear();
        if let Some(made) = self.made {
            f.params.iter_mut().for_each(|p| made.name_type(&mut p.ty));
            f.body.locals.iter_mut().for_each(|l| made.name_type(&mut l.ty));
            made.name_type(&mut f.result);
        }
    }

    /// The arguments of a function of the file, which gives one value, too.
    fn arguments(&mut self, called: &Path, args: &mut [Arg]) {
        let Some(function) = self.variables.function(called) else { return };
        if let Some(of) = &function.result.of {
            *self.named.entry(of.clone()).or_default() += 1;
        }
        for (place, arg) in args.iter_mut().enumerate() {
            if let Some(of) = function.parameter(arg, place).and_then(|p| p.of.clone()) {
                self.place(&of, &mut arg.value);
            }
        }
    }

    /// The enumeration of the variable that a path names.
    fn of_path(&self, path: &Path) -> Option<Box<str>> {
        let own = if let [name] = path.names.as_slice() { self.own.get(&name.text) } else { None };
        match own {
            Some(own) => own.of.clone(),
            None => self.variables.of_path(&self.home, path).map(Box::from),
        }
    }

    /// Notes the names of local variables, which hide others.
    fn locals_of(&mut self, item: &Item) {
        struct Locals<'l>(&'l mut HashSet<Box<str>>);
        impl<'d> Reader<'d> for Locals<'_> {
            fn path(&mut self, _: &'d [Name]) {}
            fn direct(&mut self, _: &'d str, _: Span) {}
            fn order(&mut self, _: &'d Order) {}
            fn enter(&mut self, block: &'d Block) {
                self.0.extend(block.locals.iter().flat_map(|l| &l.names).map(|n| n.text.clone()));
            }
        }
        Locals(&mut self.locals).item(item);
    }

    fn declared(&mut self, decl: &mut VarDecl) {
        match self.made {
            Some(made) => made.declare(decl),
            None => self.initial(decl),
        }
    }

    /// Notes a declaration whose initial value has no name. Without a value it is the number 0.
    fn initial(&mut self, decl: &VarDecl) {
        let Some(Limits::Of(of)) = decl.limits.as_deref() else { return };
        let named = |e: &Expr| self.has(&of.text, e);
        let fits = match decl.init.as_ref().map(|e| (e, &e.kind)) {
            // matiec ends at the name of a value in such a list.
            Some((_, ExprKind::List(_))) if self.form.is_of_matiec() => firsts(decl),
            Some((_, ExprKind::List(values))) => values.iter().all(|(_, e)| named(e)),
            Some((e, _)) => named(e),
            // The standard takes the first value where none is written (2.4.3.1).
            None => true,
        };
        if !fits {
            self.nameless.insert(of.text.clone());
        }
    }

    /// The enumerations that can stay.
    fn staying(&self) -> BTreeSet<Box<str>> {
        let of_variables = self.variables.enumerated().map(|(_, of)| of);
        let used: BTreeSet<&str> = of_variables.chain(self.variables.of_functions()).collect();
        let local = self.variables.enumerated().filter(|(n, _)| self.locals.contains(*n));
        let hidden: BTreeSet<&str> = local.map(|(_, of)| of).collect();
        let stays = |name: &str| {
            used.contains(name)
                && !hidden.contains(name)
                && !self.nameless.contains(name)
                && !self.variables.unclear.contains(name)
                && self.named.get(name) == self.right.get(name)
        };
        self.counts.keys().filter(|name| stays(name)).cloned().collect()
    }

    fn of(&self, e: &Expr) -> Option<Box<str>> {
        let path = match &e.kind {
            ExprKind::Path(path) => path,
            ExprKind::Element(path, _, None) => path,
            ExprKind::Call(path, _) => return self.variables.function(path)?.result.of.clone(),
            _ => return None,
        };
        self.of_path(path)
    }

    /// A place where a value or a variable of an enumeration can stand.
    fn place(&mut self, of: &str, e: &mut Expr) {
        if self.of(e).is_some_and(|own| *own == *of) {
            *self.right.entry(of.into()).or_default() += 1;
        } else if let Some(made) = self.made {
            made.types.get(of).iter().for_each(|t| t.value(e));
        } else if !self.has(of, e) {
            self.nameless.insert(of.into());
        }
    }

    /// True for the number of a value.
    fn has(&self, of: &str, e: &Expr) -> bool {
        e.kind.whole().zip(self.counts.get(of)).is_some_and(|(n, count)| (0..*count).contains(&n))
    }
}

impl Visitor for Looking<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        if let Some(of) = self.of_path(path) {
            *self.named.entry(of).or_default() += 1;
        }
    }

    fn expr(&mut self, e: &mut Expr) {
        match &mut e.kind {
            ExprKind::Binary(BinaryOp::Eq | BinaryOp::Ne, a, b) => {
                if let Some(of) = self.of(a).or_else(|| self.of(b)) {
                    self.place(&of, a);
                    self.place(&of, b);
                }
            }
            ExprKind::Call(path, args) => self.arguments(path, args),
            _ => {}
        }
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        match &mut stmt.kind {
            StmtKind::Assign { target, value } => {
                if let Some(of) = self.of(target) {
                    self.place(&of, target);
                    self.place(&of, value);
                }
            }
            StmtKind::Case(selector, arms, _) => {
                let Some(of) = self.of(selector) else { return };
                self.place(&of, selector);
                for (value, end) in arms.iter_mut().flat_map(|a| &mut a.labels) {
                    match end {
                        None => self.place(&of, value),
                        Some(_) => _ = self.nameless.insert(of.clone()),
                    }
                }
            }
            StmtKind::Call(called, args) => {
                for arg in args {
                    let of = arg
                        .name
                        .as_ref()
                        .and_then(|n| self.variables.of_parameter(&self.home, called, &n.text));
                    if let Some(of) = of.map(Box::<str>::from) {
                        self.place(&of, &mut arg.value);
                    }
                }
            }
            _ => {}
        }
    }

    fn all_bodies(&self) -> bool {
        true
    }
}
