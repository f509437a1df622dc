//! Values of enumerations as their numbers, and assignments to variables with bounds.

use std::borrow::Cow;

use super::checks::Checks;
use super::concerned::is_concerned;
use super::scopes::{Admits, Around, Found, Scopes, Var};
use crate::{
    Arg, BinaryOp, Chart, ChartItem, Document, Expr, ExprKind, Item, Limits, Literal, Path, Problem, Said,
    Span, StandardFunction, Type, VarDecl, VarKind, codes, say,
};

/// Most values that a message lists.
const SHOWN: usize = 20;

/// Replaces values of enumerations by their numbers, and puts checks into the assignments to variables with bounds. Returns
/// the problems found as well.
pub fn held(document: &Document) -> (Cow<'_, Document>, Vec<Problem>) {
    match Checker::of(document) {
        Some(held) => {
            let (document, problems) = held.document(document);
            (Cow::Owned(document), problems)
        }
        None => (Cow::Borrowed(document), Vec::new()),
    }
}

/// Checks and changes the expressions and statements of one document.
pub struct Checker<'d> {
    pub(super) scopes: Scopes<'d>,
    pub(super) checks: Checks,
    pub(super) problems: Vec<Problem>,
    /// True for a question, which changes nothing: an argument outside of the bounds of a parameter is no fault there.
    asked: bool,
}

impl<'d> Checker<'d> {
    /// None if a document that [`super::declared`] gave has no enumerations and no bounds.
    pub fn of(document: &'d Document) -> Option<Checker<'d>> {
        is_concerned(document).then(|| Checker {
            scopes: Scopes::of(document),
            checks: Checks::default(),
            problems: Vec::new(),
            asked: false,
        })
    }

    /// An expression that stands outside of all charts; any value is taken.
    pub fn query(&mut self, e: &Expr) -> (Expr, Vec<Problem>) {
        let mut e = e.clone();
        self.problems.clear();
        self.asked = true;
        self.typed(&mut e, Around { chart: None, locals: &[] });
        (e, std::mem::take(&mut self.problems))
    }

    fn document(mut self, document: &Document) -> (Document, Vec<Problem>) {
        self.checks = Checks::of(document);
        let mut items = Vec::new();
        for item in &document.items {
            let mut own = item.clone();
            match &mut own {
                Item::Var(v) => self.declaration(v, None),
                Item::Chart(c) => self.chart(c),
                other => self.item(other),
            }
            items.push(own);
        }
        // A compiler that reads from the top down knows the checks where functions call them.
        let first = items.iter().position(|i| matches!(i, Item::Function(_))).unwrap_or(items.len());
        items.splice(first..first, self.checks.into_items());
        (Document { items, notes: document.notes.clone() }, self.problems)
    }

    fn chart(&mut self, chart: &mut Chart) {
        let name = chart.name.text.clone();
        for item in &mut chart.items {
            match item {
                ChartItem::Var(v) => self.declaration(v, Some(&name)),
                other => self.chart_item(other, &name),
            }
        }
    }

    /// The values of a declaration.
    fn declaration(&mut self, v: &mut VarDecl, chart: Option<&str>) {
        let around = Around { chart, locals: &[] };
        let range = v.range();
        let limits = v.limits.take();
        let wanted = match limits.as_deref() {
            Some(Limits::Of(name)) => Some(&*name.text),
            _ => None,
        };
        let values = v.init.iter_mut().chain(&mut v.safe).chain(v.usual.as_deref_mut());
        if v.kind == VarKind::Input && range.is_some() {
            let at = v.names.first().map_or(v.at.0, |n| n.at.0);
            let what = say!("the values of an input come from outside, so its type has no bounds");
            let help = say!("copy it by `LIMIT` into a variable with bounds");
            let problem = Problem::new(&codes::WRONG_TYPE, at, what).help(help);
            // Of a structure, each element of an array would tell it.
            if !self.problems.contains(&problem) {
                self.problems.push(problem);
            }
        }
        for e in values {
            match &mut e.kind {
                ExprKind::List(list) => {
                    list.iter_mut().for_each(|(_, e)| self.value_of(e, wanted, range, around));
                }
                _ => self.value_of(e, wanted, range, around),
            }
        }
        v.limits = limits;
    }

    fn value_of(
        &mut self,
        e: &mut Expr,
        wanted: Option<&str>,
        range: Option<(i128, i128)>,
        around: Around<'_, 'd>,
    ) {
        self.expect(e, wanted, around);
        let Some((low, high)) = range.filter(|_| e.kind != ExprKind::Bad) else { return };
        match self.number(e, around) {
            Some(n) => self.within(n, (low, high), e.at.0),
            None => {
                let what = say!(
                    "the value of a variable with bounds is known here: a whole number, or a constant with a written number"
                );
                self.problems.push(Problem::new(&codes::NOT_CONSTANT, e.at.0, what));
                e.kind = ExprKind::Bad;
            }
        }
    }

    /// The number of a constant.
    fn number(&self, e: &Expr, around: Around<'_, 'd>) -> Option<i128> {
        match &e.kind {
            ExprKind::Path(path) => match self.scopes.find(path, around) {
                Found::Var(var, false) => var.number,
                _ => None,
            },
            kind => kind.whole(),
        }
    }

    fn within(&mut self, n: i128, (low, high): (i128, i128), at: Span) {
        if !(low..=high).contains(&n) {
            let what = say!("{n} is outside of {low}..{high}");
            self.problems.push(Problem::new(&codes::OUT_OF_RANGE, at, what));
        }
    }

    /// Changes an expression whose value must not be one of an enumeration.
    pub(super) fn plain(&mut self, e: &mut Expr, around: Around<'_, 'd>) {
        self.expect(e, None, around);
    }

    /// Changes an expression whose value must be one of the enumeration `wanted`; if that is None, of no enumeration.
    pub(super) fn expect(&mut self, e: &mut Expr, wanted: Option<&str>, around: Around<'_, 'd>) {
        let found = self.typed(e, around);
        self.agree(found, wanted, e);
    }

    /// Reports an expression whose value is not of the wanted enumeration. The expression becomes [`ExprKind::Bad`], so that
    /// later passes report nothing about it.
    fn agree(&mut self, found: Option<&str>, wanted: Option<&str>, e: &mut Expr) {
        if e.kind == ExprKind::Bad {
            return;
        }
        let (what, help) = match (found, wanted) {
            (Some(found), Some(wanted)) if found != wanted => {
                (say!("this is a value of `{found}`, and one of `{wanted}` is needed"), self.values(wanted))
            }
            (None, Some(wanted)) => (say!("a value of `{wanted}` is needed here"), self.values(wanted)),
            (Some(found), None) => (
                say!("a value of `{found}` cannot stand here"),
                say!(
                    "values of an enumeration are compared by `=` and `<>`; `{found}_TO_INT` gives the number of one"
                ),
            ),
            _ => return,
        };
        e.kind = ExprKind::Bad;
        self.problems.push(Problem::new(&codes::WRONG_TYPE, e.at.0, what).help(help));
    }

    fn values(&self, ty: &str) -> Said {
        let mut names = self.scopes.names_of(ty);
        if names.len() > SHOWN {
            names.truncate(SHOWN);
            names.push("…");
        }
        say!("its values are {}", Said::foreign(names.join(", ")))
    }

    /// Changes an expression, and returns the enumeration that its value is of.
    pub(super) fn typed(&mut self, e: &mut Expr, around: Around<'_, 'd>) -> Option<&'d str> {
        let at = e.at;
        match &mut e.kind {
            ExprKind::Literal(_) | ExprKind::Bad => None,
            ExprKind::Direct(text) => match self.scopes.at_address(text) {
                Some((Var { admits: Admits::Values(ty), .. }, _)) => Some(ty),
                _ => None,
            },
            ExprKind::Path(path) => {
                let found = self.scopes.find(path, around);
                if let Some(problem) = self.no_value(&found, path, at.0) {
                    self.problems.push(problem);
                    e.kind = ExprKind::Bad;
                    return None;
                }
                match found {
                    // A bit of a variable of an enumeration is refused too: as a value, it fits where no bit fits.
                    Found::Var(Var { admits: Admits::Values(ty), .. }, _) => Some(ty),
                    Found::Value(ty, number) => {
                        e.kind = ExprKind::Literal(Literal::Int(number, None));
                        Some(ty)
                    }
                    _ => None,
                }
            }
            ExprKind::Element(path, index, _) => {
                index.iter_mut().for_each(|e| self.plain(e, around));
                match self.scopes.find(path, around) {
                    Found::Var(Var { admits: Admits::Values(ty), .. }, _) => Some(ty),
                    _ => None,
                }
            }
            ExprKind::Unary(_, a) => {
                self.plain(a, around);
                None
            }
            ExprKind::Binary(BinaryOp::Eq | BinaryOp::Ne, a, b) => {
                self.same([&mut **a, &mut **b].into_iter(), around);
                None
            }
            ExprKind::Binary(_, a, b) => {
                self.plain(a, around);
                self.plain(b, around);
                None
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.plain(t1, around);
                self.plain(e, around);
                t2.iter_mut().for_each(|t| self.plain(t, around));
                None
            }
            ExprKind::List(values) => {
                values.iter_mut().for_each(|(_, e)| self.plain(e, around));
                None
            }
            ExprKind::Call(path, args) => {
                if let Some(number) = self.number_of(path, args, around) {
                    *e = number;
                    return None;
                }
                self.call(path, args, around)
            }
        }
    }

    /// The problem of a value that two enumerations have, or that the named enumeration does not have.
    fn no_value(&self, found: &Found<'_>, path: &Path, at: Span) -> Option<Problem> {
        match found {
            Found::Both(one, other) => {
                let value = path.text();
                let what = say!("`{value}` is a value of `{one}` and of `{other}`");
                let problem = Problem::new(&codes::WRONG_TYPE, at, what);
                Some(problem.help(say!("write `{one}.{value}` or `{other}.{value}`")))
            }
            Found::NoValue(ty) => {
                let value = path.names.get(1).map_or("", |n| &*n.text);
                let at = path.names.get(1).map_or(at, |n| n.at.0);
                let what = say!("`{}` has no value `{value}`", ty);
                let problem = Problem::new(&codes::UNKNOWN_MEMBER, at, what);
                let names = self.scopes.names_of(ty);
                Some(match crate::similar(value, &names) {
                    Some(near) => problem.meant(near),
                    None => problem.help(self.values(ty)),
                })
            }
            Found::Var(..) | Found::Value(..) | Found::Other => None,
        }
    }

    /// Changes expressions that must all be of one enumeration, or all of none; returns the enumeration.
    fn same<'e>(
        &mut self,
        mut list: impl Iterator<Item = &'e mut Expr>,
        around: Around<'_, 'd>,
    ) -> Option<&'d str> {
        let first = list.next()?;
        let found = self.typed(first, around);
        let mut wanted = found;
        for e in list {
            let next = self.typed(e, around);
            match wanted {
                // The first one is a number beside a value.
                None if next.is_some() => {
                    self.agree(None, next, first);
                    wanted = next;
                }
                _ => self.agree(next, wanted, e),
            }
        }
        wanted
    }

    /// `Mode_TO_INT(mode)`: the number of a value.
    fn number_of(&mut self, path: &Path, args: &mut [Arg], around: Around<'_, 'd>) -> Option<Expr> {
        let [name] = path.names.as_slice() else { return None };
        let ty = name.text.strip_suffix("_TO_INT")?;
        let (ty, _) = self.scopes.enumerations.get_key_value(ty)?;
        let (ty, [only]) = (*ty, args) else { return None };
        self.expect(&mut only.value, Some(ty), around);
        Some(only.value.clone())
    }

    fn call(&mut self, path: &Path, args: &mut [Arg], around: Around<'_, 'd>) -> Option<&'d str> {
        if let Some(signature) = self.scopes.function(path).cloned() {
            for (place, arg) in args.iter_mut().enumerate() {
                let admits = signature.of(arg, place);
                self.given(&mut arg.value, admits, around);
            }
            return if let Admits::Values(ty) = signature.result { Some(ty) } else { None };
        }
        let function = match path.names.as_slice() {
            [name] => StandardFunction::named(&name.text),
            _ => None,
        };
        use StandardFunction as F;
        match function {
            Some(F::Move | F::Operator(BinaryOp::Eq | BinaryOp::Ne)) => {
                let ty = self.same(args.iter_mut().map(|a| &mut a.value), around);
                ty.filter(|_| function == Some(F::Move))
            }
            Some(f @ (F::Sel | F::Mux)) => {
                // The first input chooses among the others; with names it can stand anywhere.
                let chooses = |a: &Arg| a.name.as_ref().is_some_and(|n| f.row().place(&n.text) == Some(0));
                let choice = args.iter().position(chooses).unwrap_or(0);
                if let Some(arg) = args.get_mut(choice) {
                    self.plain(&mut arg.value, around);
                }
                let others = args.iter_mut().enumerate().filter(|(n, _)| *n != choice);
                self.same(others.map(|(_, a)| &mut a.value), around)
            }
            _ => {
                args.iter_mut().for_each(|a| self.plain(&mut a.value, around));
                None
            }
        }
    }

    /// Changes the value of an assignment, so that the target gets only values that it can have.
    pub(super) fn assigned(&mut self, target: &mut Expr, value: &mut Expr, around: Around<'_, 'd>) {
        let (var, part) = self.target(target, around);
        let admits = var.map_or(Admits::All, |v| v.admits);
        match admits {
            Admits::Values(_) | Admits::Range(..) if part => {
                self.plain(value, around);
                self.only_assigned(target);
            }
            Admits::Range(low, high, ty)
                if var.is_some_and(|v| v.array) && matches!(target.kind, ExprKind::Path(_)) =>
            {
                self.plain(value, around);
                self.bounded(value, (low, high, ty), true, around);
            }
            admits => self.given(value, admits, around),
        }
    }

    /// Changes the value that a variable or a parameter gets, so that it is one of those that this can have.
    pub(super) fn given(&mut self, value: &mut Expr, admits: Admits<'d>, around: Around<'_, 'd>) {
        match admits {
            Admits::All => self.plain(value, around),
            Admits::Values(ty) => self.expect(value, Some(ty), around),
            Admits::Range(low, high, ty) => {
                self.plain(value, around);
                self.bounded(value, (low, high, ty), false, around);
            }
        }
    }

    fn bounded(
        &mut self,
        value: &mut Expr,
        (low, high, ty): (i128, i128, Type),
        whole: bool,
        around: Around<'_, 'd>,
    ) {
        if let Some(n) = self.number(value, around) {
            return self.within(n, (low, high), value.at.0);
        }
        if self.asked || self.is_limited(value, (low, high), around) {
            return;
        }
        let source = match &value.kind {
            ExprKind::Call(path, _) if whole => self.scopes.find(path, around),
            ExprKind::Path(path) => self.scopes.find(path, around),
            ExprKind::Element(path, _, None) => self.scopes.find(path, around),
            _ => Found::Other,
        };
        let result = match &value.kind {
            ExprKind::Call(path, _) => self.scopes.function(path).map(|f| f.result),
            _ => None,
        };
        let admits = if let Found::Var(var, false) = source { Some(var.admits) } else { result };
        if let Some(Admits::Range(least, most, _)) = admits
            && low <= least
            && most <= high
        {
            return;
        }
        if whole {
            let what = say!("an array with bounds is copied from one with the same or closer bounds");
            let problem = Problem::new(&codes::WRONG_TYPE, value.at.0, what);
            return self.problems.push(problem.help(say!("assign the elements in a FOR loop")));
        }
        let at = value.at;
        let plain = std::mem::replace(value, Expr { kind: ExprKind::Bad, at });
        *value = self.checks.held(plain, (low, high, ty), at);
    }

    /// True for `LIMIT(0, x, 100)` with bounds that are known and fit.
    fn is_limited(&self, value: &Expr, (low, high): (i128, i128), around: Around<'_, 'd>) -> bool {
        let ExprKind::Call(path, args) = &value.kind else { return false };
        let ([name], [least, _, most]) = (path.names.as_slice(), args.as_slice()) else { return false };
        if StandardFunction::named(&name.text) != Some(StandardFunction::Limit)
            || args.iter().any(|a| a.name.is_some())
        {
            return false;
        }
        let bounds = self.number(&least.value, around).zip(self.number(&most.value, around));
        bounds.is_some_and(|(least, most)| low <= least && least <= most && most <= high)
    }

    /// The variable that a target names; the flag is true if the target is only a bit or a member of it.
    fn target(&mut self, target: &mut Expr, around: Around<'_, 'd>) -> (Option<Var<'d>>, bool) {
        let (path, bit) = match &mut target.kind {
            ExprKind::Path(path) => (&*path, false),
            ExprKind::Element(path, index, bit) => {
                index.iter_mut().for_each(|e| self.plain(e, around));
                (&**path, bit.is_some())
            }
            ExprKind::Direct(text) => {
                return self.scopes.at_address(text).map_or((None, false), |(var, bit)| (Some(var), bit));
            }
            _ => return (None, false),
        };
        match self.scopes.find(path, around) {
            Found::Var(var, part) => (Some(var), part || bit),
            _ => (None, false),
        }
    }

    /// Reports a target that must be written by assignments only, where something else writes it.
    pub(super) fn written(&mut self, target: &mut Expr, around: Around<'_, 'd>) {
        if let (Some(Var { admits: Admits::Values(_) | Admits::Range(..), .. }), _) =
            self.target(target, around)
        {
            self.only_assigned(target);
        }
    }

    fn only_assigned(&mut self, target: &Expr) {
        let name = match &target.kind {
            ExprKind::Direct(text) => format!("%{text}"),
            kind => kind.variable().unwrap_or_default(),
        };
        let what = say!("`{}` has bounds or is of an enumeration; only an assignment writes it", name);
        let problem = Problem::new(&codes::WRONG_TYPE, target.at.0, what);
        self.problems.push(problem.help(say!("use a variable without bounds here, and assign it")));
    }
}
