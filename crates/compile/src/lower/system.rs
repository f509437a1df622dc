//! PRE, POST, and the system bits and words of PL7 and Unity.
//!
//! They act at the service point between PRE and the evolution: what PRE asks
//! for happens in the same scan, what an action asks for in the next.

use g7_engine::{Addr, Arith, Cmp, Limits, Num, Op, Service};
use g7_model::{Span, TargetPlc};

use super::Lower;
use super::code::Buf;
use crate::ir::{Body, ChartId, StepId, StepSort, VarClass, VarId};

/// Macro-steps that a word of `%SW22` … `%SW25` has a bit for.
const BITS: u32 = 16;

impl Lower<'_> {
    /// The system bit or word of this name, where the unit has it.
    pub(super) fn system_var(&self, name: &str) -> Option<Addr> {
        let at = self.unit.vars.iter().position(|v| v.class == VarClass::System && &*v.name == name)?;
        Some(self.words.addr(VarId(at as u32)))
    }

    /// `%S23`, where something names it.
    pub(super) fn stop_bit(&self) -> Option<Addr> {
        let at = self.unit.vars.iter().position(|v| v.class == VarClass::System && &*v.name == "%S23")?;
        let named = self.uses.named.get(at).copied().unwrap_or(false);
        named.then(|| self.words.addr(VarId(at as u32)))
    }

    /// Everything that runs besides the chart.
    pub(super) fn system(&mut self) {
        let unit = self.unit;
        self.t.pre = self.sections(&unit.pre);
        self.t.post = self.sections(&unit.post);
        let mut services = self.buf(0);
        self.freeze(&mut services);
        self.chart_bits(&mut services);
        self.macro_bits(&mut services);
        self.t.services = self.place(services);
        let mut tail = self.buf(0);
        for name in ["%S0", "%S1"] {
            if let Some(bit) = self.system_var(name) {
                fall(&mut tail, bit);
            }
        }
        self.t.tail = self.place(tail);
        if let Some(first) = self.system_var("%S0")
            && let Some(word) = self.words.init.get_mut(first.0 as usize)
        {
            *word = 1; // TRUE in the first scan after a cold start
        }
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
    fn sections(&mut self, bodies: &[Body]) -> g7_engine::Code {
        let mut b = self.buf(0);
        for body in bodies {
            if body.chart.is_some_and(|c| self.plan.chart(c).is_none()) {
                continue;
            }
            b.period = body.chart.map_or(0, |c| self.period(c));
            if b.period == 0 {
                self.inline(&mut b, &body.statements);
                continue;
            }
            b.op(Op::Due(b.period), body.at);
            let skip = b.jump(Op::JumpUnless, body.at);
            self.inline(&mut b, &body.statements);
            b.land(skip);
        }
        self.place(b)
    }

    /// `FREEZECHART` takes effect here.
    fn freeze(&mut self, b: &mut Buf) {
        for freeze in self.freezes.iter().flatten() {
            b.op(Op::Load(freeze.asked), Span::default());
            b.op(Op::Store(freeze.holds), Span::default());
        }
    }

    /// `%S21`: all charts to their initial situation. `%S22`: all steps off.
    fn chart_bits(&mut self, b: &mut Buf) {
        let at = Span::default();
        let charts: Vec<g7_engine::GroupId> = self.t.charts.iter().map(|c| c.group).collect();
        for (name, to_initial) in [("%S21", true), ("%S22", false)] {
            let Some(bit) = self.system_var(name) else { continue };
            b.op(Op::Load(bit), at);
            let skip = b.jump(Op::JumpUnless, at);
            charts.iter().for_each(|g| b.op(Op::Service(Service::Clear(*g)), at));
            if to_initial {
                // What is asked to go off and to come on stays.
                self.t.initial.iter().for_each(|s| b.op(Op::Service(Service::Set(*s)), at));
            }
            self.owners.iter().flatten().for_each(|owner| fall(b, *owner));
            fall(b, bit);
            b.land(skip);
        }
    }

    /// `%S24`: the macro-steps whose bits are set in `%SW22` … `%SW25` are emptied.
    fn macro_bits(&mut self, b: &mut Buf) {
        let at = Span::default();
        let Some(bit) = self.system_var("%S24") else { return };
        b.op(Op::Load(bit), at);
        let skip = b.jump(Op::JumpUnless, at);
        let words = ["%SW22", "%SW23", "%SW24", "%SW25"].map(|name| self.system_var(name));
        for (number, chart) in self.numbered_macro_steps() {
            let Some(word) = words.get((number / BITS) as usize).copied().flatten() else { continue };
            // Bit i of the word: (w div 2^i) mod 2, of w made positive.
            b.op(Op::Load(word), at);
            b.op(Op::Push(1 << BITS), at);
            b.op(Op::Arith(Arith::Add, Num::I64), at);
            b.op(Op::Push(1 << (number % BITS)), at);
            b.op(Op::Arith(Arith::Div, Num::I64), at);
            b.op(Op::Push(2), at);
            b.op(Op::Arith(Arith::Mod, Num::I64), at);
            b.op(Op::Push(1), at);
            b.op(Op::Compare(Cmp::Eq, Num::I64), at);
            let next = b.jump(Op::JumpUnless, at);
            self.empty(b, chart, at);
            b.land(next);
        }
        fall(b, bit);
        b.land(skip);
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

fn fall(b: &mut Buf, bit: Addr) {
    b.op(Op::Push(0), Span::default());
    b.op(Op::Store(bit), Span::default());
}

/// What the tables of the PLCs hold (TSX Micro and Premium, PL7 manual): steps
/// active and transitions valid at once.
fn limits(target: TargetPlc) -> Limits {
    match target {
        TargetPlc::Tsx3710 => Limits { active: 96, enabled: 192 },
        TargetPlc::Tsx3720 => Limits { active: 128, enabled: 256 },
        TargetPlc::Tsx57 => Limits { active: 250, enabled: 400 },
    }
}
