//! The types that a file declares with `type`, and the declarations of variables of these types.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use super::concerned::is_concerned;
use crate::composed::{DEEP, defined_twice, of_language, unknown_type};
use crate::{
    Array, ChartItem, Document, Expr, ExprKind, Item, Limits, Literal, Name, Path, Problem, Span, Type,
    VarDecl, VarKind, codes, say, visit_mut,
};

/// Most values of an enumeration.
pub const MOST: usize = 1 << 12;

/// Puts each declared type in the place of its name, in all declarations of variables. Also returns the problems of the
/// declared types.
pub fn declared(document: &Document) -> (Cow<'_, Document>, Vec<Problem>) {
    if !is_concerned(document) {
        return (Cow::Borrowed(document), Vec::new());
    }
    let mut types = Types::of(document);
    let items = document.items.iter().filter_map(|item| types.item(item)).collect();
    (Cow::Owned(Document { items, notes: document.notes.clone() }), types.problems)
}

/// The declared types of a file.
pub(super) struct Types<'d> {
    /// Each type, already without the names of other declared types.
    known: HashMap<&'d str, VarDecl>,
    /// The constants of the file that are written numbers.
    constants: HashMap<&'d str, i128>,
    /// The values of enumerations that have the number 0, each behind its enumeration.
    zeros: HashSet<(&'d str, &'d str)>,
    /// The structures and function blocks.
    composed: HashSet<&'d str>,
    pub(super) problems: Vec<Problem>,
}

impl<'d> Types<'d> {
    fn of(document: &'d Document) -> Types<'d> {
        let mut types = Types {
            known: HashMap::new(),
            constants: HashMap::new(),
            zeros: HashSet::new(),
            composed: HashSet::new(),
            problems: Vec::new(),
        };
        for item in &document.items {
            match item {
                Item::Var(v) => types.constants.extend(constants(v)),
                Item::Composed(c) => _ = types.composed.insert(&*c.name.text),
                _ => {}
            }
        }
        let mut written: HashMap<&'d str, &'d VarDecl> = HashMap::new();
        let mut order = Vec::new();
        let taken = names(document);
        for item in &document.items {
            let Item::Type(t) = item else { continue };
            let Some(name) = t.names.first().filter(|n| !n.text.is_empty()) else { continue };
            if types.is_free(name, written.get(&*name.text).and_then(|t| t.names.first()), &taken) {
                written.insert(&name.text, t);
                order.push(t);
            }
        }
        for t in order {
            let mut way = Vec::new();
            types.follow(t, &written, &mut way);
        }
        types
    }

    /// Reports the name of a type that means something else already.
    fn is_free(&mut self, name: &Name, first: Option<&Name>, taken: &HashMap<&str, Span>) -> bool {
        if let Some(problem) = of_language(name) {
            self.problems.push(problem);
            return false;
        }
        let first = first.map(|n| n.at.0).or_else(|| taken.get(&*name.text).copied());
        self.problems.extend(first.map(|first| defined_twice(name, first)));
        first.is_none()
    }

    /// Adds a type to the known ones. If it names another declared type, that one is added first; `way` are the types that
    /// wait for this one.
    fn follow(
        &mut self,
        t: &'d VarDecl,
        written: &HashMap<&'d str, &'d VarDecl>,
        way: &mut Vec<&'d VarDecl>,
    ) {
        let Some(name) = t.names.first() else { return };
        if self.known.contains_key(&*name.text) {
            return;
        }
        if let Some(place) = way.iter().position(|on| on.names.first().is_some_and(|n| n.text == name.text)) {
            let mut problem = Problem::new(
                &codes::RECURSION,
                name.at.0,
                say!("the type `{}` stands for itself", name.text),
            );
            for on in way.iter().skip(place + 1).flat_map(|on| on.names.first()) {
                problem = problem.related(on.at.0, say!("by way of `{}`", on.text));
            }
            self.problems.push(problem);
            self.known.insert(&name.text, VarDecl { of: None, limits: None, ..t.clone() });
            return;
        }
        way.push(t);
        if let Some(next) = t.of.as_ref().and_then(|of| written.get(&*of.text)) {
            if way.len() < DEEP {
                self.follow(next, written, way);
            } else {
                let what = say!("types stand in each other at most {DEEP} deep");
                self.problems.push(Problem::new(&codes::TOO_DEEP, name.at.0, what));
                self.known.insert(&name.text, VarDecl { of: None, ..t.clone() });
            }
        }
        way.pop();
        if self.known.contains_key(&*name.text) {
            return;
        }
        let mut own = t.clone();
        let values = t.values();
        if !values.is_empty() {
            self.enumeration(values);
            let zeros = numbered(values).into_iter().filter(|(_, number)| *number == Some(0));
            self.zeros.extend(zeros.map(|(value, _)| (&*name.text, &*value.text)));
            let usual = values.first().map(|(first, _)| value_of(name, first));
            own.init = t.init.clone().map(|e| qualified(e, name, values)).or(usual);
            own.limits = Some(Box::new(Limits::Of(name.clone())));
        } else {
            self.apply(&mut own, &HashMap::new());
            self.known_name(&mut own);
        }
        self.known.insert(&name.text, own);
    }

    /// Reports a type that does not exist, as in `type A : Missing`.
    pub(super) fn known_name(&mut self, t: &mut VarDecl) {
        let Some(of) = t.of.take_if(|of| !self.composed.contains(&*of.text)) else { return };
        if of.text.is_empty() {
            return; // The name could not be read; the parser has reported it.
        }
        let mut names: Vec<&str> = Type::names().collect();
        names.extend(self.composed.iter().chain(self.known.keys()).copied());
        names.sort_unstable();
        self.problems.push(unknown_type(&of, &names));
    }

    /// True for the number 0 and for a value with this number.
    pub(super) fn is_zero(&self, e: &Expr) -> bool {
        match &e.kind {
            ExprKind::Path(path) => match path.names.as_slice() {
                [ty, value] => self.zeros.contains(&(&*ty.text, &*value.text)),
                _ => false,
            },
            kind => kind.whole() == Some(0),
        }
    }

    /// Checks the names and numbers of an enumeration.
    fn enumeration(&mut self, values: &[(Name, Option<Expr>)]) {
        let (mut names, mut numbers) = (HashMap::new(), HashMap::new());
        if let Some((name, _)) = values.get(MOST) {
            let what = say!("an enumeration has at most {MOST} values");
            return self.problems.push(Problem::new(&codes::TOO_LARGE, name.at.0, what));
        }
        for (name, number) in numbered(values) {
            if let Some(first) = names.insert(&*name.text, name.at.0).filter(|_| !name.text.is_empty()) {
                self.problems.push(defined_twice(name, first));
            }
            let Some(number) = number else {
                let at = name.at.0;
                let what = say!("the number of a value is a whole number of INT");
                self.problems.push(Problem::new(&codes::OUT_OF_RANGE, at, what));
                continue;
            };
            if let Some(first) = numbers.insert(number, name.at.0) {
                let what = say!("two values have the number {number}");
                let problem = Problem::new(&codes::DEFINED_TWICE, name.at.0, what);
                self.problems.push(problem.related(first, say!("defined here first")));
            }
        }
    }

    /// The item without names of declared types. Of the types themselves, only enumerations stay in the document: their
    /// values are looked up later.
    fn item(&mut self, item: &Item) -> Option<Item> {
        let mut own = item.clone();
        let mut inner = HashMap::new();
        match &mut own {
            Item::Type(t) => {
                let name = &t.names.first()?.text;
                let kept = !t.values().is_empty() && self.known.contains_key(&**name);
                return kept.then_some(own);
            }
            Item::Var(v) => self.apply(v, &inner),
            Item::Chart(c) => {
                self.params(&mut c.params);
                if let Item::Chart(c) = item {
                    inner.extend(c.vars().flat_map(constants));
                }
                for item in &mut c.items {
                    if let ChartItem::Var(v) = item {
                        self.apply(v, &inner);
                    }
                }
            }
            Item::Composed(c) => {
                if let Item::Composed(c) = item {
                    inner.extend(c.members.iter().flat_map(constants));
                }
                c.members.iter_mut().chain(&mut c.inouts).for_each(|m| self.apply(m, &inner));
                c.inouts.iter_mut().for_each(|m| m.init = None);
            }
            Item::Function(f) => self.function(f),
            _ => {}
        }
        visit_mut::blocks(&mut own, &mut |block| self.locals(block, &inner));
        Some(own)
    }

    /// Replaces the name of a declared type in a declaration, or checks the bounds that are written there. `inner` are the
    /// constants of the chart or function block round it.
    pub(super) fn apply(&mut self, v: &mut VarDecl, inner: &HashMap<&str, i128>) {
        if let Some(ty) = v.of.as_ref().and_then(|of| self.known.get(&*of.text)) {
            let many = v.array.is_some();
            v.ty = ty.ty;
            v.of.clone_from(&ty.of);
            v.limits.clone_from(&ty.limits);
            if let Some(array) = &ty.array {
                let at = v.array.as_ref().map_or(array.at, |a| a.at);
                let before = v.array.take().map_or(Vec::new(), |a| a.dimensions);
                let dimensions = [before, array.dimensions.clone()].concat();
                v.array = Some(Box::new(Array { dimensions, at }));
            }
            v.usual.clone_from(&ty.usual);
            match (&ty.array, &ty.init) {
                (Some(_), None) => {}
                // The type has values for one array, and here are several arrays.
                (Some(_), Some(_)) if many => {
                    let at = v.names.first().map_or(v.at.0, |n| n.at.0);
                    let what = say!("an array of arrays has values of its own");
                    let help = say!("write the values in brackets here, or leave them out of the type");
                    if v.init.is_none() {
                        self.problems.push(Problem::new(&codes::WRONG_TYPE, at, what).help(help));
                    }
                }
                (None, Some(value)) if many => v.usual = Some(Box::new(value.clone())),
                (_, Some(value)) => v.init = v.init.take().or_else(|| Some(value.clone())),
                (None, None) => {}
            }
            return;
        }
        let Some(Limits::Range(least, most)) = v.limits.as_deref() else { return };
        let (least, most) = (least.clone(), most.clone());
        v.limits = self.range(&least, &most, v, inner);
        // The default is the lower limit (IEC 61131-3:2003, 2.4.3.1).
        if let Some(Limits::Range(least, _)) = v.limits.as_deref() {
            match v.array {
                Some(_) => v.usual = Some(Box::new(least.clone())),
                None if v.init.is_none() => v.init = Some(least.clone()),
                None => {}
            }
        }
    }

    /// The written bounds as numbers; None, with a problem, if they are no bounds of this type.
    fn range(
        &mut self,
        least: &Expr,
        most: &Expr,
        v: &VarDecl,
        inner: &HashMap<&str, i128>,
    ) -> Option<Box<Limits>> {
        let number = |e: &Expr| match &e.kind {
            ExprKind::Path(path) => match path.names.as_slice() {
                [name] => inner.get(&*name.text).or_else(|| self.constants.get(&*name.text)).copied(),
                _ => None,
            },
            kind => kind.whole(),
        };
        let at = least.at.0.to(most.at.0);
        let (Some(low), Some(high)) = (number(least), number(most)) else {
            let what = say!("a bound of a type is a whole number, or a constant with a written number");
            self.problems.push(Problem::new(&codes::NOT_CONSTANT, at, what));
            return None;
        };
        let (lowest, highest) = v.ty.bounds()?;
        if low > high {
            let what = say!("a type from {low} to {high} has no values");
            self.problems.push(Problem::new(&codes::EMPTY_RANGE, at, what));
            return None;
        }
        if low < lowest || high > highest {
            let what = say!("{} holds {lowest} to {highest}", v.ty);
            self.problems.push(Problem::new(&codes::OUT_OF_RANGE, at, what));
            return None;
        }
        Some(Box::new(Limits::Range(whole(low, least), whole(high, most))))
    }
}

/// The values of an enumeration with their numbers. A value without a written number has one more than the value before it,
/// the first one 0. None stands for a number that no INT can have.
pub fn numbered(values: &[(Name, Option<Expr>)]) -> Vec<(&Name, Option<i128>)> {
    let fits = |n: &i128| Type::Int.bounds().is_some_and(|(least, most)| (least..=most).contains(n));
    let mut next = Some(0_i128);
    let mut all = Vec::new();
    for (name, written) in values {
        let number = match written {
            Some(e) => e.kind.whole(),
            None => next,
        };
        let number = number.filter(fits);
        next = number.map(|n| n + 1);
        all.push((name, number));
    }
    all
}

/// The names that a file declares, except for types.
fn names(document: &Document) -> HashMap<&str, Span> {
    let mut all = HashMap::new();
    for item in &document.items {
        let names = match item {
            Item::Var(v) => v.names.iter().collect(),
            Item::Chart(c) => vec![&c.name],
            Item::Composed(c) => vec![&c.name],
            Item::Function(f) => vec![&f.name],
            _ => Vec::new(),
        };
        for name in names {
            all.entry(&*name.text).or_insert(name.at.0);
        }
    }
    all
}

fn constants(v: &VarDecl) -> Vec<(&str, i128)> {
    let value = v.init.as_ref().filter(|_| v.kind == VarKind::Const).and_then(|e| e.kind.whole());
    value.map_or(Vec::new(), |n| v.names.iter().map(|name| (&*name.text, n)).collect())
}

/// `Mode.Manual`.
fn value_of(ty: &Name, value: &Name) -> Expr {
    let names = vec![Name { text: ty.text.clone(), at: value.at }, value.clone()];
    Expr { kind: ExprKind::Path(Path { names }), at: value.at }
}

/// A bare value of an enumeration in its own declaration, with the name of the type.
fn qualified(e: Expr, ty: &Name, values: &[(Name, Option<Expr>)]) -> Expr {
    match &e.kind {
        ExprKind::Path(path) => match path.names.as_slice() {
            [only] if values.iter().any(|(name, _)| name.text == only.text) => value_of(ty, only),
            _ => e,
        },
        _ => e,
    }
}

fn whole(n: i128, e: &Expr) -> Expr {
    Expr { kind: ExprKind::Literal(Literal::Int(n, None)), at: e.at }
}
