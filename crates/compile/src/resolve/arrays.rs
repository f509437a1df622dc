//! Arrays: `a[i]` in a declaration, an expression, an assignment and an action.
//!
//! ```text
//! var a : ARRAY[1..3] OF INT  ->  the variables `a[1]`, `a[2]`, `a[3]`, one behind the other
//! a[2]                        ->  ir::ExprKind::Var, as any variable
//! a[i]                        ->  ir::ExprKind::Element over all of them
//! ```
//!
//! # What must hold
//!
//! The elements of an array are consecutive variables of one class and type, in the order of their indexes, the
//! last index counting fastest (IEC 61131-3:2003, 2.4.1.2). An index outside of its bounds is a problem where it
//! is known, and the fault `range` in a run.

use std::collections::HashMap;

use g7_model::{
    Array as Written, Expr as WrittenExpr, ExprKind as Form, Name, Path, Problem, Span, Type, VarDecl, codes,
    element_name, say,
};

use super::refer::Ref;
use super::resolver::Resolver;
use super::scopes::{Array, Entity};
use super::types::{Typed, converted};
use crate::held::held;
use crate::ir::{
    BinaryOp, ChartId, Elements, Expr, ExprKind, Stmt, StmtKind, Target, Value, VarClass, VarId,
};

/// The elements that all arrays of a document together may have.
const MOST: u64 = 1 << 16;

/// An element of an array.
pub(super) enum Element {
    /// One with known indexes.
    Known(VarId),
    /// One with a variable index: all elements, their type, and the index in each dimension (LINT, from 0).
    Chosen(Elements, Type, Vec<Expr>),
}

impl Array {
    /// The number of its elements.
    fn count(&self) -> u32 {
        if self.dimensions.is_empty() { 0 } else { self.dimensions.iter().map(|(_, n)| n).product() }
    }

    /// The name of an element: `a[1,2]`, or `m[1].t[2]` for a member of an array of structures.
    fn element_name(&self, mut place: u32) -> String {
        let mut all: Vec<String> = Vec::new();
        for (least, count) in self.dimensions.iter().rev() {
            all.push((least + i64::from(place % count)).to_string());
            place /= count;
        }
        all.reverse();
        element_name(&self.name, &all)
    }

    /// The element with these indexes, each from 0.
    fn chosen(&self, indexes: Vec<Expr>) -> Element {
        let places: Option<Vec<i64>> = indexes.iter().map(known).collect();
        let all = Elements { first: self.first, counts: self.dimensions.iter().map(|(_, n)| *n).collect() };
        let Some(places) = places else { return Element::Chosen(all, self.ty, indexes) };
        let place = places.iter().zip(&all.counts).fold(0, |sum, (i, count)| sum * i64::from(*count) + i);
        Element::Known(VarId(self.first.0 + place as u32))
    }
}

impl<'d> Resolver<'_, 'd> {
    /// Declares the arrays of a declaration; returns their elements, array by array.
    pub(super) fn declare_arrays(
        &mut self,
        chart: Option<ChartId>,
        decl: &'d VarDecl,
        class: VarClass,
    ) -> Vec<VarId> {
        let Some(written) = &decl.array else { return Vec::new() };
        // The names of an array that cannot be are known all the same, so that their uses are no problems of their own.
        let dimensions = self.fitting_array(decl, written).unwrap_or_default();
        let mut ids = Vec::new();
        let held = held(decl, &self.scopes.enumerations);
        for name in &decl.names {
            let number = self.scopes.arrays.len() as u32;
            if !self.define(chart, name, Entity::Array(number)) {
                continue;
            }
            let array = Array {
                name: self.qualified(chart, &name.text),
                first: VarId(self.unit.vars.len() as u32),
                dimensions: dimensions.clone(),
                ty: decl.ty,
                at: name.at.0,
            };
            for place in 0..array.count() {
                let element = array.element_name(place).into();
                let id = self.add_var(element, class, decl.ty, name.at.0);
                if let Some(v) = self.unit.vars.get_mut(id.index()) {
                    v.held.clone_from(&held);
                    v.retain = decl.retain;
                    v.inverted = decl.inverted;
                    v.comment.clone_from(&decl.comment);
                }
                if class == VarClass::Const {
                    self.pending.insert(id);
                }
                ids.push(id);
            }
            self.scopes.arrays.push(array);
        }
        ids
    }

    /// Reports a variable in back-ticks that has the name of an element of an array. Tests, traces and io files could
    /// not tell the two apart.
    pub(super) fn name_elements_once(&mut self) {
        if self.scopes.arrays.is_empty() {
            return;
        }
        let mut seen = HashMap::new();
        let mut clashes = Vec::new();
        for v in self.unit.vars.iter().filter(|v| v.name.ends_with(']')) {
            if let Some(first) = seen.insert(&v.name, v.at) {
                clashes.push((Name::new(v.name.clone(), v.at), first));
            }
        }
        clashes.iter().for_each(|(name, first)| self.defined_twice(name, *first));
    }

    /// The bounds of each dimension; reports a problem if there can be no such array.
    fn fitting_array(&mut self, decl: &VarDecl, written: &Written) -> Option<Vec<(i64, u32)>> {
        let at = written.at.0;
        if let Type::Fb(kind) = decl.ty {
            let what = say!("there are no arrays of function blocks such as {}", kind);
            let help = say!("declare each instance: `var t1, t2 : {}`", kind.name());
            return self.report(Problem::new(&codes::BAD_DECLARATION, at, what).help(help));
        }
        if let Some(address) = &decl.address {
            let what = say!("an array has no address of its own");
            let help = say!("give its elements their channels in the io file, or declare single variables");
            let place = address.at.0;
            self.problems.push(Problem::new(&codes::BAD_DECLARATION, place, what).help(help));
        }
        let mut dimensions = Vec::new();
        let mut count = 1_u64;
        for (least, most) in &written.dimensions {
            let (low, high) = (self.bound(least), self.bound(most));
            let (low, high) = (low?, high?);
            let place = least.at.0.to(most.at.0);
            if low > high {
                let what = say!("an array from {low} to {high} has no elements");
                return self.report(Problem::new(&codes::EMPTY_RANGE, place, what));
            }
            let number = high.abs_diff(low).saturating_add(1);
            count = count.saturating_mul(number);
            let before: u64 = self.scopes.arrays.iter().map(|a| u64::from(a.count())).sum();
            let all = count.saturating_mul(decl.names.len() as u64).saturating_add(before);
            if all > MOST {
                let what = say!("all arrays together have at most {MOST} elements");
                return self.report(Problem::new(&codes::OUT_OF_RANGE, place, what));
            }
            dimensions.push((low, number as u32));
        }
        (!dimensions.is_empty()).then_some(dimensions)
    }

    /// A bound: a whole number, or a constant that is one and stands before the array.
    fn bound(&mut self, e: &WrittenExpr) -> Option<i64> {
        let known = match &e.kind {
            Form::Path(path) => match self.found(&path.names) {
                Some(Ref::Var(v)) => match self.var(v).map(|v| (v.class, &v.init)) {
                    Some((VarClass::Const, Value::Int(n))) => i64::try_from(*n).ok(),
                    _ => None,
                },
                _ => None,
            },
            Form::Bad => return None,
            written => written.whole().and_then(|n| i64::try_from(n).ok()),
        };
        if known.is_none() {
            let what =
                say!("a bound of an array is a whole number, or a constant that is declared before it");
            return self.report(Problem::new(&codes::NOT_CONSTANT, e.at.0, what));
        }
        known
    }

    /// Resolves the values that a declaration gives to its arrays.
    pub(super) fn give_elements(&mut self, chart: Option<ChartId>, decl: &VarDecl, ids: &[VarId]) {
        let Some(first) = ids.first() else { return };
        let Some(count) = self
            .scopes
            .arrays
            .iter()
            .find(|a| a.first == *first && a.count() > 0)
            .map(|a| a.count() as usize)
        else {
            return;
        };
        let given = decl.init.as_ref().map(|e| self.element_values(chart, decl.ty, e, count));
        let given = given.unwrap_or_default();
        let usual = decl.usual.as_ref().and_then(|e| self.constant(chart, e, decl.ty));
        let safe = decl.safe.as_ref().and_then(|e| self.constant(chart, e, decl.ty));
        for array in ids.chunks(count) {
            for (n, id) in array.iter().enumerate() {
                self.pending.remove(id);
                let Some(v) = self.unit.vars.get_mut(id.index()) else { continue };
                if let Some(value) = given.get(n).and_then(Option::as_ref).or(usual.as_ref()) {
                    v.init = value.clone();
                }
                if let Some(value) = &safe {
                    v.safe = value.clone();
                }
            }
        }
    }

    fn element_values(
        &mut self,
        chart: Option<ChartId>,
        ty: Type,
        e: &WrittenExpr,
        count: usize,
    ) -> Vec<Option<Value>> {
        let Form::List(list) = &e.kind else { return Vec::new() };
        let mut values = Vec::new();
        for (times, value) in list {
            let value = self.constant(chart, value, ty);
            let room = count.saturating_sub(values.len());
            if *times as usize > room {
                let what = say!("there are more values than the {count} elements of the array");
                self.problems.push(Problem::new(&codes::OUT_OF_RANGE, e.at.0, what));
            }
            values.extend(std::iter::repeat_n(value, room.min(*times as usize)));
        }
        values
    }

    /// The array that a path names, if it names one.
    pub(super) fn array_named(&self, names: &[Name]) -> Option<&Array> {
        match self.named(names) {
            Some(Entity::Array(n)) => self.scopes.arrays.get(n as usize),
            _ => None,
        }
    }

    /// Finds an element; reports a problem if there is none.
    pub(super) fn element(&mut self, path: &Path, index: &[WrittenExpr], at: Span) -> Option<Element> {
        let Some(array) = self.array_named(&path.names).cloned() else {
            self.refer(&path.names)?;
            let what = say!("`{}` is no array; it has no elements", path.text());
            return self.report(Problem::new(&codes::WRONG_KIND, at, what));
        };
        if array.count() == 0 {
            return None; // Its declaration has been reported.
        }
        if index.len() != array.dimensions.len() {
            let (has, given) = (array.dimensions.len(), index.len());
            let what = say!("the number of indexes of `{}` is {has}; {given} stand here", array.name);
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        }
        let mut all = Vec::new();
        for (e, dimension) in index.iter().zip(&array.dimensions) {
            all.push(self.index(&array, e, *dimension));
        }
        let all: Option<Vec<Expr>> = all.into_iter().collect();
        Some(array.chosen(all?))
    }

    /// An index from 0, LINT; it is within its bounds where it is known.
    fn index(&mut self, array: &Array, e: &WrittenExpr, (least, count): (i64, u32)) -> Option<Expr> {
        let value = self.any_value(e)?;
        let at = value.at;
        if !value.ty.is_integer() {
            let what = say!("an index is a whole number; this is {}", value.ty);
            return self.report(Problem::new(&codes::WRONG_TYPE, at, what));
        }
        if let ExprKind::Const(Value::Int(n)) = value.kind {
            let place = n - i128::from(least);
            if !(0..i128::from(count)).contains(&place) {
                let most = least + i64::from(count) - 1;
                let what = say!("`{}` goes from {least} to {most}; there is no {n}", array.name);
                return self.report(Problem::new(&codes::OUT_OF_RANGE, at, what));
            }
            return Some(long(place as i64, at));
        }
        let value = converted(value, Type::Lint);
        let kind = ExprKind::Binary(BinaryOp::Sub, Box::new(value.clone()), Box::new(long(least, at)));
        Some(if least == 0 { value } else { Expr { kind, ty: Type::Lint, at } })
    }

    /// The value of an element, or of a bit of one.
    pub(super) fn read_element(
        &mut self,
        path: &Path,
        index: &[WrittenExpr],
        bit: Option<&Name>,
        at: Span,
    ) -> Option<Typed> {
        match (self.element(path, index, at)?, bit) {
            (Element::Known(v), None) => {
                self.has_value(v, &path.text(), at)?;
                self.read(Ref::Var(v), at)
            }
            (Element::Known(v), Some(bit)) => {
                let part = self.bit_of_element(v, bit)?;
                self.read(part, at)
            }
            (Element::Chosen(_, ty, _), Some(_)) => self.needs_known(ty, at),
            (Element::Chosen(_, ty @ Type::String(_), _), None) => self.needs_known(ty, at),
            (Element::Chosen(all, ty, index), None) => {
                let constants = self.var(all.first).is_some_and(|v| v.class == VarClass::Const);
                if !constants && !self.may_read(Ref::Var(all.first), at) {
                    return None;
                }
                Some(Typed::of(ExprKind::Element(all, index), ty, at))
            }
        }
    }

    /// The element that an assignment writes.
    pub(super) fn element_target(
        &mut self,
        path: &Path,
        index: &[WrittenExpr],
        at: Span,
    ) -> Option<(Target, Type)> {
        match self.element(path, index, at)? {
            Element::Known(v) => self.writable(Ref::Var(v), at),
            Element::Chosen(_, ty @ Type::String(_), _) => self.needs_known(ty, at),
            Element::Chosen(all, ty, index) => {
                let class = self.var(all.first).map(|v| v.class)?;
                self.may_write(all.first, class, at)?;
                Some((Target::Element(all, index), ty))
            }
        }
    }

    /// The bit of a known element that an assignment writes, if it writes one.
    pub(super) fn element_bit(
        &mut self,
        path: &Path,
        index: &[WrittenExpr],
        bit: &Name,
        at: Span,
    ) -> Option<(VarId, u8)> {
        match self.element(path, index, at)? {
            Element::Known(v) => match self.bit_of_element(v, bit)? {
                Ref::Bit(v, bit) => Some((v, bit)),
                _ => None,
            },
            Element::Chosen(_, ty, _) => self.needs_known(ty, at),
        }
    }

    fn bit_of_element(&mut self, v: VarId, bit: &Name) -> Option<Ref> {
        let part = self.part(v, &bit.text);
        if part.is_none() {
            let (name, ty) = self.var(v).map(|v| (v.name.clone(), v.ty))?;
            let what = say!("`{name}` is a {ty}; it has no member `{}`", bit.text);
            return self.report(Problem::new(&codes::UNKNOWN_MEMBER, bit.at.0, what));
        }
        part
    }

    /// Reports an index that is not known before the chart runs, where it must be.
    pub(super) fn needs_known<T>(&mut self, ty: Type, at: Span) -> Option<T> {
        let what = match ty {
            Type::String(_) => {
                say!("an element of an array of STRING needs an index that is known before the chart runs")
            }
            _ => say!("an index that is known before the chart runs is needed here"),
        };
        self.report(
            Problem::new(&codes::NOT_CONSTANT, at, what).help(say!("choose by CASE among known indexes")),
        )
    }

    /// `a := b` of whole arrays; the outer `None` means that these are none.
    #[allow(clippy::option_option, reason = "no arrays, or arrays that do not fit")]
    pub(super) fn whole_arrays(&mut self, to: &WrittenExpr, from: &WrittenExpr) -> Option<Option<StmtKind>> {
        let named = |e: &WrittenExpr| match &e.kind {
            Form::Path(path) => self.array_named(&path.names).cloned(),
            _ => None,
        };
        let target = named(to)?;
        let Some(source) = named(from) else {
            let what =
                say!("`{}` is an array; only an array of its bounds and type can be assigned", target.name);
            return Some(self.report(Problem::new(&codes::WRONG_TYPE, from.at.0, what)));
        };
        if target.count() == 0 || source.count() == 0 {
            return Some(None); // Its declaration has been reported.
        }
        if target.dimensions != source.dimensions || target.ty != source.ty {
            let what = say!("`{}` and `{}` differ in bounds or type", target.name, source.name);
            return Some(self.report(Problem::new(&codes::WRONG_TYPE, to.at.0.to(from.at.0), what)));
        }
        Some(self.copies(&target, &source, to.at.0))
    }

    fn copies(&mut self, target: &Array, source: &Array, at: Span) -> Option<StmtKind> {
        let class = self.var(target.first).map(|v| v.class)?;
        self.may_write(target.first, class, at)?;
        let mut list = Vec::new();
        for place in 0..target.count() {
            let value = self.read(Ref::Var(VarId(source.first.0 + place)), at)?;
            let kind = StmtKind::Assign(Target::Var(VarId(target.first.0 + place)), value.expr);
            list.push(Stmt { kind, at });
        }
        Some(StmtKind::If(Vec::new(), list))
    }
}

fn known(e: &Expr) -> Option<i64> {
    match e.kind {
        ExprKind::Const(Value::Int(n)) => i64::try_from(n).ok(),
        _ => None,
    }
}

fn long(n: i64, at: Span) -> Expr {
    Expr { kind: ExprKind::Const(Value::Int(n.into())), ty: Type::Lint, at }
}
