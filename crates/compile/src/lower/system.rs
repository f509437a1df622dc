//! PRE, POST, and the system bits and words of PL7 and Unity.
//!
//! They act at the service point between PRE and the evolution: what PRE asks
//! for happens in the same scan, what an action asks for in the next.

use g7_engine::{Addr, Arith, Cmp, Limits, Service};
use g7_model::{Span, TargetPlc, Type};

use super::terms::store_word;
use super::work::Lower;
use crate::ir::{Body, ChartId, StepId, StepSort, VarClass, VarId};
use crate::tree::{Expr, ExprKind, Gate, Stmt, StmtKind};

/// Macro-steps that a word of `%SW22` … `%SW25` has a bit for.
const BITS: u32 = 16;

impl Lower<'_> {
    /// The system bit or word of this name, where the unit has it.
    pub(super) fn system_var(&self, name: &str) -> Option<Addr> {
        let at = self.unit.vars.iter().position(|v| v.class == VarClass::System && &*v.name == name)?;
        Some(self.words.addr(VarId(at as u32)))
    }

    /// The words behind the system bits, made before all else: they live on from
    /// scan to scan. `%S0` and `%S1` belong together, since a restart says which of
    /// them is TRUE; and the bits that act on charts need `%S0`.
    #[inline(never)]
    pub(super) fn look_at_system_bits(&mut self) {
        let named = |l: &Self, name| l.system_var(name).is_some();
        let acts = self.has_acting_bits();
        if acts || named(self, "%S0") || named(self, "%S1") {
            let cold = self.system_var("%S0").unwrap_or_else(|| self.words.hidden(0));
            let warm = self.system_var("%S1").unwrap_or_else(|| self.words.hidden(0));
            self.restarts = Some((cold, warm));
            if let Some(word) = self.words.init.get_mut(cold.0 as usize) {
                *word = 1; // TRUE in the first scan after a cold start
            }
        }
        if named(self, "%S23") {
            self.stop_all = Some(self.words.hidden(0));
        }
        if acts {
            self.fresh = Some(self.words.hidden(1));
        }
    }

    /// A system bit acts on charts: one of `%S21` to `%S24`, or `%S0` where the program
    /// writes it.
    fn has_acting_bits(&self) -> bool {
        let system = |v: &(&crate::ir::Var, &bool)| v.0.class == VarClass::System;
        self.unit.vars.iter().zip(&self.uses.written).filter(system).any(|(var, written)| match &*var.name {
            "%S0" => *written,
            "%S21" | "%S22" | "%S23" | "%S24" => true,
            _ => false,
        })
    }

    /// Everything that runs besides the chart.
    #[inline(never)]
    pub(super) fn system(&mut self) {
        let unit = self.unit;
        let mut pre = self.before_pre();
        pre.extend(self.sections(&unit.pre));
        self.t.pre = self.work(pre);
        let post = self.sections(&unit.post);
        self.t.post = self.work(post);
        let mut services = self.freeze();
        let seen = self.words.hidden(0);
        services.extend(self.chart_bits(seen));
        self.t.services = self.work(services);
        let tail = self.tail(seen);
        self.t.tail = self.work(tail);
        let counts = (self.system_var("%SW20"), self.system_var("%SW21"));
        if counts != (None, None) {
            let mut or_hidden = |a: Option<Addr>| a.unwrap_or_else(|| self.words.hidden(0));
            self.t.counts = Some((or_hidden(counts.0), or_hidden(counts.1)));
        }
        if let Some(target) = unit.target {
            let flag = self.system_var("%S25").unwrap_or_else(|| self.words.hidden(0));
            self.t.limits = Some((flag, limits(target)));
        }
    }

    /// Sections one behind the other, a RETURN ending only its own. Those of a
    /// chart with a period run when it is due, those of an unused expansion never.
    fn sections(&mut self, bodies: &[Body]) -> Vec<Stmt> {
        let mut list = Vec::new();
        for body in bodies {
            if body.chart.is_some_and(|c| self.plan.chart(c).is_none()) {
                continue;
            }
            let period = body.chart.map_or(0, |c| self.period(c));
            let section = self.inline(period, &body.statements);
            list.push(match period {
                0 => section,
                _ => when(Expr::new(ExprKind::Due(period), body.at), vec![section]),
            });
        }
        list
    }

    /// `%S0` has set `%S21` before PRE begins.
    fn before_pre(&self) -> Vec<Stmt> {
        match (self.restarts, self.system_var("%S21")) {
            (Some((cold, _)), Some(init)) => vec![when(bit(cold), vec![set(init, true)])],
            _ => Vec::new(),
        }
    }

    /// The end of a scan. Set behind the service point, `%S0` stays for that of the
    /// next scan.
    fn tail(&self, seen: Addr) -> Vec<Stmt> {
        let Some((cold, warm)) = self.restarts else { return Vec::new() };
        let fall = set(cold, false);
        let cold = if self.fresh.is_some() { when(bit(seen), vec![fall]) } else { fall };
        vec![cold, set(warm, false)]
    }

    /// `FREEZECHART` takes effect here.
    fn freeze(&self) -> Vec<Stmt> {
        let holds = |f: &super::work::Freeze| store_word(Type::Bool, f.holds, bit(f.asked), NOWHERE);
        self.freezes.iter().flatten().map(holds).collect()
    }

    /// One of the bits that are set acts in a scan, the lowest: `%S21` (or `%S0`, which
    /// sets it): all charts to the initial situation; `%S22`: all steps off; `%S23`: no
    /// transition clears; `%S24`: macro-steps are emptied. The others wait.
    fn chart_bits(&self, seen: Addr) -> Vec<Stmt> {
        let (Some((cold, _)), Some(fresh)) = (self.restarts, self.fresh) else { return Vec::new() };
        let init = self.system_var("%S21");
        let asked = init.into_iter().fold(bit(cold), |e, init| e.gate(Gate::Or, bit(init), NOWHERE));
        let mut start = vec![request(Service::Start)];
        start.extend(self.free_tasks());
        let mut arms = vec![(bit(fresh).negated().gate(Gate::And, asked, NOWHERE), start)];
        if let Some(empty) = self.system_var("%S22") {
            let mut then: Vec<Stmt> =
                self.t.charts.iter().map(|c| request(Service::Clear(c.group))).collect();
            then.extend(self.free_tasks());
            then.push(set(empty, false));
            arms.push((bit(empty), then));
        }
        if let (Some(freeze), Some(stop)) = (self.system_var("%S23"), self.stop_all) {
            arms.push((bit(freeze), vec![set(stop, true)]));
        }
        if let Some(macros) = self.system_var("%S24") {
            arms.push((bit(macros), self.macro_bits(macros)));
        }
        let mut list = vec![store_word(Type::Bool, seen, bit(cold), NOWHERE)];
        list.extend(self.stop_all.map(|stop| set(stop, false)));
        list.push(Stmt { kind: StmtKind::If(arms, Vec::new()), at: NOWHERE });
        // The cold start has made the initial situation: its `%S21` takes no turn.
        list.extend([Some(fresh), init].into_iter().flatten().map(|word| set(word, false)));
        list
    }

    /// Every task is free.
    fn free_tasks(&self) -> Vec<Stmt> {
        let free = |owner: &Addr| store_word(Type::Lint, *owner, Expr::long(0, NOWHERE), NOWHERE);
        self.owners.iter().flatten().map(free).collect()
    }

    /// `%S24`: the macro-steps whose bits are set in `%SW22` … `%SW25` are emptied.
    fn macro_bits(&self, asked: Addr) -> Vec<Stmt> {
        let words = ["%SW22", "%SW23", "%SW24", "%SW25"].map(|name| self.system_var(name));
        let mut then = Vec::new();
        for (number, chart) in self.numbered_macro_steps() {
            let Some(word) = words.get((number / BITS) as usize).copied().flatten() else { continue };
            // Bit i of the word: (w div 2^i) mod 2, of w made positive.
            let long = |v| Expr::long(v, NOWHERE);
            let word = Expr::new(ExprKind::Word(Type::Int, word), NOWHERE);
            let positive = Expr::new(ExprKind::Convert(Type::Int, Type::Lint, Box::new(word)), NOWHERE)
                .arith(Arith::Add, Type::Lint, long(1 << BITS), NOWHERE);
            // Nothing is divided by 1: linters of printed code report that.
            let shifted = match number % BITS {
                0 => positive,
                bit => positive.arith(Arith::Div, Type::Lint, long(1 << bit), NOWHERE),
            };
            let marked = shifted.arith(Arith::Mod, Type::Lint, long(2), NOWHERE).compare(
                Cmp::Eq,
                Type::Lint,
                long(1),
                NOWHERE,
            );
            then.push(when(marked, self.empty(chart, NOWHERE)));
        }
        then.push(set(asked, false));
        then
    }

    /// Macro-steps called `3` or `M3`, the first of each number in each chart.
    fn numbered_macro_steps(&self) -> Vec<(u32, ChartId)> {
        let mut found: Vec<(u32, ChartId, ChartId)> = Vec::new();
        for (i, step) in self.unit.steps.iter().enumerate() {
            let StepSort::Macro(chart) = step.sort else { continue };
            let digits = step.name.strip_prefix(['M', 'm']).unwrap_or(&step.name);
            let Ok(number) = digits.parse::<u32>() else { continue };
            let runs = self.plan.expansion(self.unit, StepId(i as u32)).is_some();
            if runs && number < 4 * BITS && found.iter().all(|f| (f.0, f.1) != (number, step.chart)) {
                found.push((number, step.chart, chart));
            }
        }
        found.into_iter().map(|(number, _, expansion)| (number, expansion)).collect()
    }
}

/// The place of what no text says.
const NOWHERE: Span = Span { file: g7_model::FileId(0), start: 0, end: 0 };

fn bit(word: Addr) -> Expr {
    Expr::new(ExprKind::Word(Type::Bool, word), NOWHERE)
}

fn set(word: Addr, value: bool) -> Stmt {
    store_word(Type::Bool, word, Expr::truth(value, NOWHERE), NOWHERE)
}

fn request(service: Service) -> Stmt {
    Stmt { kind: StmtKind::Service(service), at: NOWHERE }
}

fn when(condition: Expr, then: Vec<Stmt>) -> Stmt {
    let at = condition.at;
    Stmt { kind: StmtKind::If(vec![(condition, then)], Vec::new()), at }
}

/// The sizes of the tables of the PLCs (TSX Micro and Premium, PL7 manual): steps
/// active and transitions valid at once.
fn limits(target: TargetPlc) -> Limits {
    match target {
        TargetPlc::Tsx3710 => Limits { active: 96, enabled: 192 },
        TargetPlc::Tsx3720 => Limits { active: 128, enabled: 256 },
        TargetPlc::Tsx57 => Limits { active: 250, enabled: 400 },
    }
}
