//! Values that a program before the charts brings up to date: step times that count scans, and what the
//! conditions of actions read.
//!
//! `bodies.rs` asks for them; `assemble.rs` puts the statements into the program.

use std::collections::HashSet;

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    ActionKind, Arg, BinaryOp, ChartItem, Expr, ExprKind, FbKind, Item, Literal, Nanos, Path, Span, Stmt,
    Target, Type, Work, say,
};

use super::bodies::{At, MOST_CONSTANTS};
use super::form::Form;
use super::lower::Lower;
use crate::nodes;
use crate::scopes::{Ref, StepKey, VarKey};

/// The most that a step time counts, which is an INT, and the most scans that are counted for its seconds.
const MOST: [i128; 2] = [32_767, 2_147_483_647];

/// Units of times that are numbers, and the greatest number that stands for one time: `%X1.T` stays at 9999.
const TENTHS: (Nanos, i64) = (Nanos::from_millis(100), 9998);
const MILLISECONDS: (Nanos, i64) = (Nanos::from_millis(1), i32::MAX as i64 - 1);

/// No step is active for longer, as far as blocks that count its time can tell: some 27 years.
pub(crate) const LONGEST: Nanos = Nanos::from_millis(10_000 * 86_400_000);

impl<'d> Lower<'d> {
    /// The time of a step where it counts scans: `Fill.t`, an INT, or `Fill.s`, a REAL. A counter goes up before the
    /// charts evolve while the step is active; in the scan of the activation it is 0.
    pub(super) fn counted(&mut self, step: StepKey, seconds: bool, span: Span, at: &At<'d>) -> Expr {
        if let Some(known) = self.counts.get(&(step, seconds)) {
            return nodes::name(&[known], span);
        }
        if !self.can_watch(span, at, say!("a step time")) {
            return nodes::int(0, span);
        }
        let own = self.names.step(step).to_string();
        let active = self.active(step, span, &At::default(), 0);
        let started = self.started(span);
        let on = nodes::and(active, nodes::name(&[&started], span), span);
        let ty = if seconds { Type::Dint } else { Type::Int };
        let counter = self.fresh(None, &format!("{own}_scans"), ty, span);
        let scans = nodes::name(&[&counter], span);
        let [of_int, of_dint] = MOST;
        let most = nodes::int(if seconds { of_dint } else { of_int }, span);
        let more = nodes::binary(BinaryOp::Add, scans.clone(), nodes::int(1, span), span);
        let goes_on = nodes::binary(BinaryOp::Lt, scans.clone(), most, span);
        let count = nodes::when(goes_on, vec![nodes::assign(scans.clone(), more, span)], Vec::new(), span);
        let none = nodes::assign(scans.clone(), nodes::int(0, span), span);
        self.looking.push(nodes::when(on, vec![count], vec![none], span));
        let mut name = counter;
        if seconds {
            let cycle = self.document.cycle().unwrap_or(Nanos::from_millis(10)).count();
            let real = |text: String| {
                nodes::expr(ExprKind::Literal(Literal::Real(text.into(), Some(Type::Lreal))), span)
            };
            let scans = nodes::call("DINT_TO_LREAL", vec![scans], span);
            let nanos = nodes::binary(BinaryOp::Mul, scans, real(format!("{cycle}.0")), span);
            let value = nodes::binary(BinaryOp::Div, nanos, real("1000000000.0".into()), span);
            name = self.fresh(None, &format!("{own}_seconds"), Type::Real, span);
            let value = nodes::call("LREAL_TO_REAL", vec![value], span);
            self.looking.push(nodes::assign(nodes::name(&[&name], span), value, span));
        }
        let value = nodes::name(&[&name], span);
        self.counts.insert((step, seconds), name);
        value
    }

    /// The time of a macro-step, or of a step in another program. A block counts it, called behind the charts, where
    /// the step begins, and before them, so that the time is that of the scan.
    pub(super) fn clock(&mut self, step: StepKey, span: Span) -> Expr {
        if let Some(known) = self.clocks.get(&step) {
            return nodes::name(&[known], span);
        }
        let own = self.names.step(step).to_string();
        let active = self.active(step, span, &At::default(), 0);
        let clock = self.fresh(None, &format!("{own}_clock"), Type::Fb(FbKind::Ton), span);
        let time = self.fresh(None, &format!("{own}_time"), Type::Time, span);
        let inputs = vec![("IN", active.clone()), ("PT", nodes::time(LONGEST, span))];
        let call = nodes::invoke(nodes::path(&[&clock], span), inputs, span);
        self.closing.push(call.clone());
        self.looking.push(call);
        // A step that has ended keeps its time.
        let value = nodes::name(&[&time], span);
        let now = nodes::assign(value.clone(), nodes::name(&[&clock, "ET"], span), span);
        self.looking.push(nodes::when(active, vec![now], Vec::new(), span));
        self.clocks.insert(step, time);
        value
    }

    /// `%X1.T`, or `TIME_TO_DINT(Fill.T)`, against a number: the time of the step against so many tenths or thousandths
    /// of a second. Alone they have no exact form, because conversions of times to numbers count in units of the
    /// maker's choice.
    pub(super) fn counted_time(
        &mut self,
        op: BinaryOp,
        a: &Expr,
        b: &Expr,
        span: Span,
        at: &At<'d>,
    ) -> Option<Expr> {
        let of = |e: &Expr| match &e.kind {
            ExprKind::Direct(address) => {
                Some((self.scopes.direct_step(address.strip_suffix(".T")?)?, TENTHS))
            }
            ExprKind::Call(function, args) => Some((self.milliseconds(function, args, at)?, MILLISECONDS)),
            _ => None,
        };
        let ((step, (unit, most)), number, op) = match (of(a), of(b)) {
            (Some(step), None) => (step, b, op),
            (None, Some(step)) => (step, a, turned(op)),
            _ => return None,
        };
        let value = self.folded(number, at.chart, MOST_CONSTANTS)?;
        let ExprKind::Literal(Literal::Int(n, _)) = value.kind else { return None };
        let n = i64::try_from(n).ok().filter(|n| (0..=most).contains(n) && !at.function)?;
        let time = self.time_of(step, span, at);
        let against = |op, n: i64| nodes::binary(op, time.clone(), nodes::time(unit * n, span), span);
        let (from, below) = (|n| against(BinaryOp::Ge, n), |n| against(BinaryOp::Lt, n));
        Some(match op {
            BinaryOp::Ge => from(n),
            BinaryOp::Gt => from(n + 1),
            BinaryOp::Lt => below(n),
            BinaryOp::Le => below(n + 1),
            BinaryOp::Eq => nodes::and(from(n), below(n + 1), span),
            BinaryOp::Ne => nodes::or(below(n), from(n + 1), span),
            _ => return None,
        })
    }

    /// The step whose time is converted to a number, which counts milliseconds in this program; CODESYS does the same.
    fn milliseconds(&self, function: &Path, args: &[Arg], at: &At<'d>) -> Option<StepKey> {
        let ([name], [arg]) = (function.names.as_slice(), args) else { return None };
        let wide = ["TIME_TO_DINT", "TIME_TO_LINT", "TIME_TO_UDINT", "TIME_TO_ULINT"];
        let of_time = wide.iter().any(|w| name.text.eq_ignore_ascii_case(w));
        if !of_time || arg.output || self.scan_clock || matches!(self.form, Form::Codesys { .. }) {
            return None;
        }
        let ExprKind::Path(path) = &arg.value.kind else { return None };
        let own = matches!(path.names.as_slice(), [one] if at.locals.iter().any(|(l, _)| **l == *one.text));
        match self.scopes.refer(at.chart, &path.names) {
            Some(Ref::Time(step)) if !own => Some(step),
            _ => None,
        }
    }

    /// A variable as it was before the actions and bodies of the scan.
    pub(super) fn copy(&mut self, key: VarKey<'d>, span: Span) -> Expr {
        let Some(decl) = self.scopes.decl(key) else { return nodes::bad(span) };
        let known = self.copies.len();
        let copy = self.copy_of(key, None, decl.ty, span);
        if self.copies.len() > known
            && let Some(copy) = self.new_globals.last_mut()
        {
            copy.array.clone_from(&decl.array);
        }
        copy
    }

    /// The same of a variable or of a member of an instance, which is of this type.
    pub(super) fn copy_of(&mut self, key: VarKey<'d>, member: Option<&str>, ty: Type, span: Span) -> Expr {
        let place = (key, member.map(str::to_owned));
        if let Some(known) = self.copies.get(&place) {
            return nodes::name(&[known], span);
        }
        // The copy is made by a program of its own, so the variable becomes one of the file.
        if key.0.is_some() && (self.units.is_empty() || member.is_some()) {
            self.wanted.insert(key);
        }
        let own = self.names.var(key.0, key.1).unwrap_or(key.1);
        let wish = member.map_or_else(|| format!("{own}_before"), |m| format!("{own}_{m}_before"));
        let name = self.fresh(None, &wish, ty, span);
        self.copies.insert(place, name.clone());
        nodes::name(&[&name], span)
    }

    /// The statements that make the copies.
    pub(super) fn copied(&self, body: &mut Vec<Stmt>) {
        let at = Span::default();
        for ((key, member), name) in &self.copies {
            let own = self.names.var(key.0, key.1).unwrap_or(key.1);
            let unit = key.0.filter(|_| member.is_none()).and_then(|c| self.program_of(c));
            let unit = unit.and_then(|p| self.units.get(p)).map(String::as_str);
            let path: Vec<&str> = unit.into_iter().chain([own]).chain(member.as_deref()).collect();
            body.push(nodes::assign(nodes::name(&[name], at), nodes::name(&path, at), at));
        }
    }

    /// The variables that conditions of actions read copies of.
    pub(super) fn copied_in_conditions(&self) -> HashSet<VarKey<'d>> {
        struct Paths(Vec<Path>);
        impl Visitor for Paths {
            fn path(&mut self, path: &mut Path, _: Use, _: Span) {
                self.0.push(path.clone());
            }
        }
        let mut all = HashSet::new();
        for (number, chart) in self.scopes.charts.iter().enumerate() {
            let mut paths = Paths(Vec::new());
            for action in chart.steps().flat_map(|s| &s.actions) {
                if let ActionKind::Qualified { condition: Some(e), .. }
                | ActionKind::EachScan { condition: Some(e), .. } = &action.kind
                {
                    visit_mut::expr(&mut e.clone(), &mut paths);
                }
            }
            all.extend(paths.0.iter().filter_map(
                |path| match self.scopes.refer(Some(number), &path.names) {
                    Some(Ref::Var(key) | Ref::Bit(key, _)) => {
                        Some(key).filter(|key| self.moved.contains(key))
                    }
                    _ => None,
                },
            ));
        }
        all
    }

    /// The variables that actions drive or bodies of charts write, and the instances that these call.
    pub(super) fn moving(&self) -> HashSet<VarKey<'d>> {
        struct Writes(Vec<Path>);
        impl Visitor for Writes {
            fn path(&mut self, path: &mut Path, how: Use, _at: Span) {
                if how != Use::Read {
                    self.0.push(path.clone());
                }
            }
        }
        let mut all: HashSet<VarKey> = self.driven_by.keys().copied().collect();
        let mut file = Writes(Vec::new());
        for item in &self.document.items {
            if let Item::Action(a) = item {
                visit_mut::stmts(&mut a.body.block().statements.clone(), &mut file);
            }
        }
        let mut written: Vec<(Option<usize>, Path)> = file.0.into_iter().map(|p| (None, p)).collect();
        for (number, chart) in self.scopes.charts.iter().enumerate() {
            let mut own = Writes(Vec::new());
            for item in &chart.items {
                match item {
                    ChartItem::Action(a) => {
                        visit_mut::stmts(&mut a.body.block().statements.clone(), &mut own);
                    }
                    ChartItem::Step(step) => {
                        for action in &step.actions {
                            let work = match &action.kind {
                                ActionKind::Qualified { target: Target::Work(work), .. }
                                | ActionKind::EachScan { work, .. } => work,
                                _ => continue,
                            };
                            visit_mut::stmts(&mut statements(work), &mut own);
                        }
                    }
                    _ => {}
                }
            }
            written.extend(own.0.into_iter().map(|p| (Some(number), p)));
        }
        for (chart, path) in written {
            if let Some(Ref::Var(key)) = self.scopes.refer(chart, &path.names) {
                all.insert(key);
            }
        }
        all
    }
}

/// The comparison with its operands in the other order.
fn turned(op: BinaryOp) -> BinaryOp {
    match op {
        BinaryOp::Lt => BinaryOp::Gt,
        BinaryOp::Le => BinaryOp::Ge,
        BinaryOp::Gt => BinaryOp::Lt,
        BinaryOp::Ge => BinaryOp::Le,
        same => same,
    }
}

fn statements(work: &Work) -> Vec<Stmt> {
    work.statements().to_vec()
}
