//! Control blocks (IEC 61131-3:2003, 2.6.4.5; SEMANTICS section 5): the inputs of
//! all the actions that name one variable or body, and Q.

use std::collections::BTreeSet;

use g7_engine::{Addr, Cmp, Contribution, NONE};
use g7_model::Type;

use crate::form::{About, Class, Expr, MemoryId, Part, Section, Stmt, What};
use crate::make::{Make, lower, raise};

// Places in `g7_engine::INPUTS`.
const N: u8 = 0;
const S: u8 = 1;
const R: u8 = 2;
const L: u8 = 3;
const D: u8 = 4;
const P: u8 = 5;
const P1: u8 = 6;
const P0: u8 = 7;
const SD: u8 = 8;
const DS: u8 = 9;
const SL: u8 = 10;

impl Make<'_> {
    fn contribution(&self, row: u32) -> Option<Contribution> {
        self.t.contributions.get(row as usize).copied()
    }

    /// The inputs of a step's actions that have a condition or a time.
    pub(crate) fn conditional(&self, step: u32) -> Vec<u32> {
        let rows = self.extra(step).contributions;
        let has = |row: &u32| {
            self.contribution(*row).is_some_and(|c| !c.condition.is_empty() || !c.time.is_empty())
        };
        (rows.start..rows.end).filter(has).collect()
    }

    /// An input of a block: some action with this qualifier gives it.
    fn input(&mut self, block: u32, input: u8) -> Expr {
        let mut any = Vec::new();
        for step in self.steps() {
            let rows = self.extra(step).contributions;
            for row in rows.start..rows.end {
                let Some(c) = self.contribution(row).filter(|c| c.block == block && c.input == input) else {
                    continue;
                };
                let direct = c.condition.is_empty() && c.time.is_empty();
                any.push(if direct {
                    self.active(step)
                } else {
                    Expr::Read(self.kept(What::Condition(row)))
                });
            }
        }
        Expr::any(any)
    }

    /// By block: the inputs that come in.
    fn inputs(&self) -> Vec<BTreeSet<u8>> {
        let mut all = vec![BTreeSet::new(); self.t.blocks.len()];
        for c in &self.t.contributions {
            if let Some(set) = all.get_mut(c.block as usize) {
                set.insert(c.input);
            }
        }
        all
    }

    /// Looks at the conditions of the active steps' actions, those of some inputs.
    fn conditions(&mut self, of: impl Fn(u8) -> bool) -> Vec<Stmt> {
        let mut list = Vec::new();
        for step in self.steps() {
            for row in self.conditional(step) {
                let Some(c) = self.contribution(row).filter(|c| of(c.input)) else { continue };
                let to = self.kept(What::Condition(row));
                let looks = self.due(c.period).and(self.active(step));
                let (mut then, holds) = self.condition(c.condition);
                if !c.time.is_empty() {
                    let now = self.flag(What::Temporary(0));
                    then.push(Stmt::Set(now, holds));
                    let (mut sample, time) = self.value(c.time);
                    let kept = self.part(c.block, Part::Time(c.input), Type::Time);
                    sample.push(Stmt::Set(kept, time));
                    then.extend(Stmt::when(Expr::Read(now).and(Expr::Read(to).negated()), sample));
                    then.push(Stmt::Set(to, Expr::Read(now)));
                } else {
                    then.push(Stmt::Set(to, holds));
                }
                list.extend(Stmt::when(looks, then));
            }
        }
        list
    }

    fn part(&mut self, block: u32, part: Part, ty: Type) -> MemoryId {
        let class = match part {
            Part::Early(_) | Part::Q => Class::Scratch,
            _ => Class::Kept,
        };
        self.memory(What::Control(block, part), class, ty)
    }

    fn bit(&mut self, block: u32, part: Part) -> MemoryId {
        self.part(block, part, Type::Bool)
    }

    /// No pulse has been seen before the evolution yet.
    pub(crate) fn no_early_pulses(&mut self) -> Vec<Stmt> {
        let flags: Vec<MemoryId> = self
            .memories
            .iter()
            .enumerate()
            .filter(|(_, m)| matches!(m.what, What::Control(_, Part::Early(_))))
            .map(|(i, _)| MemoryId(i as u32))
            .collect();
        flags.into_iter().map(lower).collect()
    }

    /// Shows P1 and P0 the situation before the evolution, where the start or a
    /// service made it: a step that is left in the same scan has its pulses.
    pub(crate) fn early_pulses(&mut self) -> Section {
        let mut s = Section::new("Pulses of the situation before the evolution");
        let inputs = self.inputs();
        let mut list = self.conditions(|i| i == P1 || i == P0);
        for (i, b) in (0u32..).zip(&self.t.blocks) {
            let mut then = Vec::new();
            for (input, rises) in [(P1, true), (P0, false)] {
                if b.plain || !inputs.get(i as usize).is_some_and(|set| set.contains(&input)) {
                    continue;
                }
                let on = self.input(i, input);
                let (before, early) = (self.bit(i, Part::Before(input)), self.bit(i, Part::Early(input)));
                let was = Expr::Read(before);
                let pulse = if rises { on.clone().and(was.negated()) } else { was.and(on.clone().negated()) };
                then.extend(raise(early, pulse));
                then.push(Stmt::Set(before, on));
            }
            let due = self.due(b.period);
            list.extend(Stmt::when(due, then));
        }
        if !list.is_empty() {
            let stepped = self.flag(What::Stepped);
            s.body = vec![Stmt::If(Expr::Read(stepped), list, Vec::new())];
        }
        s
    }

    /// Conditions, blocks and what they drive, at the end of the scan.
    pub(crate) fn control(&mut self) -> Vec<Section> {
        let mut conditions = Section::new("Conditions of qualifiers");
        conditions.body = self.conditions(|_| true);
        let mut blocks = Section::new("Outputs and actions by their qualifiers");
        let inputs = self.inputs();
        for i in 0..self.t.blocks.len() as u32 {
            let set = inputs.get(i as usize).cloned().unwrap_or_default();
            blocks.body.push(Stmt::About(About::Block(i)));
            let list = self.block(i, &set);
            blocks.body.extend(list);
        }
        vec![conditions, blocks]
    }

    fn block(&mut self, i: u32, inputs: &BTreeSet<u8>) -> Vec<Stmt> {
        let Some(b) = self.t.blocks.get(i as usize).copied() else { return Vec::new() };
        let due = self.due(b.period);
        let (mut list, gate) = self.condition(b.gate);
        if b.plain {
            let q = self.input(i, N).and(gate);
            let written = self.drive(i, q, b);
            list.extend(written);
            return Stmt::when(due, list);
        }
        let evaluated = self.full(i, inputs, gate, b);
        list.extend(evaluated);
        Stmt::when(due, list)
    }

    /// Q into its variable where it has changed: between two changes the variable
    /// is free.
    fn drive(&mut self, i: u32, q: Expr, b: g7_engine::ControlBlock) -> Vec<Stmt> {
        if b.output.0 == NONE {
            return Vec::new();
        }
        let (output, _) = self.word(b.output, Type::Bool);
        if self.drives_alone(b.output, output) {
            return vec![Stmt::Set(output, q)];
        }
        let written = self.bit(i, Part::Written);
        let now = self.bit(i, Part::Q);
        let differs = Expr::Read(now).xor(Expr::Read(written));
        let then = vec![Stmt::Set(written, Expr::Read(now)), Stmt::Set(output, Expr::Read(now))];
        vec![Stmt::Set(now, q), Stmt::If(differs, then, Vec::new())]
    }

    /// Nothing but this block writes the output, so that writing it in each scan
    /// is the same as writing it where it changes.
    fn drives_alone(&self, word: Addr, output: MemoryId) -> bool {
        let alone = self.of(output).is_some_and(|m| m.class == Class::Output && m.init.first() == Some(&0));
        alone && !self.written_by_code.contains(&output) && self.has_one_driver(word)
    }

    fn full(&mut self, i: u32, inputs: &BTreeSet<u8>, gate: Expr, b: g7_engine::ControlBlock) -> Vec<Stmt> {
        let mut list = Vec::new();
        let mut on = Vec::new();
        for k in 0..11u8 {
            let e = if inputs.contains(&k) { self.input(i, k) } else { Expr::truth(false) };
            on.push(match e {
                Expr::Const(..) | Expr::Read(_) => e,
                e => {
                    let t = self.temporary(Type::Bool);
                    list.push(Stmt::Set(t, e));
                    Expr::Read(t)
                }
            });
        }
        let at = |k: u8| on.get(usize::from(k)).cloned().unwrap_or_else(|| Expr::truth(false));
        let free = at(R).negated();
        // Q is held back by R and by what masks it; so are the pulses.
        let gate = match gate {
            Expr::Const(..) | Expr::Read(_) => gate,
            e => {
                let t = self.temporary(Type::Bool);
                list.push(Stmt::Set(t, e));
                Expr::Read(t)
            }
        };
        let mut parts = vec![at(N)];
        if inputs.contains(&S) {
            parts.push(self.flip_flop(i, Part::Stored, at(S), &free, &mut list));
        }
        if inputs.contains(&L) {
            let done = self.timer(i, L, at(L), None, &mut list);
            parts.push(at(L).and(done.negated()));
        }
        if inputs.contains(&D) {
            parts.push(self.timer(i, D, at(D), None, &mut list));
        }
        if inputs.contains(&SD) {
            let before = Expr::Read(self.bit(i, Part::StoredDelayed));
            let was = self.keep(before, &mut list);
            let ff = self.flip_flop(i, Part::StoredDelayed, at(SD), &free, &mut list);
            parts.push(self.timer(i, SD, ff, Some(was), &mut list));
        }
        if inputs.contains(&DS) {
            let done = self.timer(i, DS, at(DS), None, &mut list);
            parts.push(self.flip_flop(i, Part::DelayedStored, done, &free, &mut list));
        }
        if inputs.contains(&SL) {
            let before = Expr::Read(self.bit(i, Part::StoredLimited));
            let was = self.keep(before, &mut list);
            let ff = self.flip_flop(i, Part::StoredLimited, at(SL), &free, &mut list);
            let done = self.timer(i, SL, ff.clone(), Some(was), &mut list);
            parts.push(ff.and(done.negated()));
        }
        if inputs.contains(&P) {
            let before = Expr::Read(self.bit(i, Part::Before(P)));
            parts.push(at(P).and(before.negated()));
        }
        let level = self.keep(Expr::all([free.clone(), gate.clone(), Expr::any(parts)]), &mut list);
        let mut q = vec![level.clone()];
        for (k, rises) in [(P1, true), (P0, false)] {
            if !inputs.contains(&k) {
                continue;
            }
            let before = Expr::Read(self.bit(i, Part::Before(k)));
            let early = self.known(What::Control(i, Part::Early(k))).map(Expr::Read);
            let edge = if rises { at(k).and(before.negated()) } else { at(k).negated().and(before) };
            let pulse = edge.or(early.unwrap_or_else(|| Expr::truth(false)));
            q.push(Expr::all([pulse, free.clone(), gate.clone()]));
        }
        let q = self.keep(Expr::any(q), &mut list);
        for k in [P, P1, P0, L, D, DS] {
            if inputs.contains(&k) {
                let before = self.bit(i, Part::Before(k));
                list.push(Stmt::Set(before, at(k)));
            }
        }
        list.extend(self.drive(i, q.clone(), b));
        if b.action != NONE {
            let mut runs = q;
            if self.t.rules.final_scan {
                let before = self.bit(i, Part::Level);
                runs = runs.or(Expr::Read(before).and(level.clone().negated()));
                let late = self.late(b.action);
                list.extend(raise(late, runs));
                list.push(Stmt::Set(before, level));
                return list;
            }
            let late = self.late(b.action);
            list.extend(raise(late, runs));
        }
        list
    }

    fn keep(&mut self, e: Expr, list: &mut Vec<Stmt>) -> Expr {
        if e.known().is_some() {
            return e;
        }
        let t = self.temporary(Type::Bool);
        list.push(Stmt::Set(t, e));
        Expr::Read(t)
    }

    /// A memory that is set, and reset by R.
    fn flip_flop(&mut self, i: u32, part: Part, set: Expr, free: &Expr, list: &mut Vec<Stmt>) -> Expr {
        let ff = self.bit(i, part);
        list.push(Stmt::Set(ff, free.clone().and(set.or(Expr::Read(ff)))));
        Expr::Read(ff)
    }

    /// An on-delay timer; its input at the evaluation before is that of the
    /// qualifier, or the one given.
    fn timer(&mut self, i: u32, k: u8, input: Expr, before: Option<Expr>, list: &mut Vec<Stmt>) -> Expr {
        let before = before.unwrap_or_else(|| Expr::Read(self.bit(i, Part::Before(k))));
        let clock = self.part(i, Part::Clock(k), Type::Time);
        let time = self.part(i, Part::Time(k), Type::Time);
        let running = match k {
            SD => self.bit(i, Part::StoredDelayed),
            SL => self.bit(i, Part::StoredLimited),
            _ => self.bit(i, Part::Before(k)),
        };
        self.runs(clock, Expr::Read(running));
        let starts = input.clone().and(before.negated()).or(input.clone().negated());
        list.extend(Stmt::when(starts, vec![Stmt::Set(clock, Expr::time(0))]));
        input.and(Expr::Read(clock).compare(Cmp::Ge, Type::Time, Expr::Read(time)))
    }
}
