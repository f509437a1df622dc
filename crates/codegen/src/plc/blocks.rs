//! The end of a scan: control blocks with all their qualifiers, bodies, POST.

use std::collections::BTreeMap;

use g7_engine::{Contribution, NONE, StepId};

use super::form::{Ex, Section, St};
use super::plan::Plan;
use super::vars::Ty;

// Inputs, in the order of `g7_engine::INPUTS`.
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

/// Inputs of the blocks: by block and input, steps with their rows.
type Inputs = BTreeMap<(u32, u8), Vec<(u32, Contribution)>>;

impl Plan<'_> {
    fn inputs(&self) -> Inputs {
        let mut all = Inputs::new();
        for step in 0..self.t.steps.len() as u32 {
            let rows = self.extra(step).contributions;
            for i in rows.start..rows.end {
                let Some(c) = self.t.contributions.get(i as usize) else { break };
                all.entry((c.block, c.input)).or_default().push((step, *c));
            }
        }
        all
    }

    /// What comes in, without memories.
    fn input(&mut self, inputs: &Inputs, block: u32, input: u8) -> Ex {
        let rows = inputs.get(&(block, input)).cloned().unwrap_or_default();
        let parts: Vec<Ex> = rows
            .into_iter()
            .map(|(step, c)| {
                let x = self.active(step);
                let condition = self.judged(&c);
                x.and(condition)
            })
            .collect();
        Ex::any(parts)
    }

    /// A memory of a block.
    fn of_block(&mut self, block: u32, what: &str, ty: Ty) -> String {
        let base = self.block_name(block);
        let name = format!("{base}_{what}");
        self.declare(&name, ty.name(), "");
        name
    }

    fn block_name(&mut self, block: u32) -> String {
        let i = block as usize;
        while self.block_names.len() <= i {
            let k = self.block_names.len();
            let name = self.c.symbols.blocks.get(k).map_or(String::new(), |b| b.name.to_string());
            let own = if name.is_empty() { (k + 1).to_string() } else { name };
            let given = self.names.with("B", &own);
            self.block_names.push(given);
        }
        self.block_names.get(i).cloned().unwrap_or_default()
    }

    /// Initial steps that are left in the first scan have their pulses.
    pub(crate) fn early_pulses(&mut self) -> Section {
        let mut s = Section::new("Pulses of the initial steps");
        if !self.t.rules.late_actions {
            return s;
        }
        let inputs = self.inputs();
        for block in 0..self.t.blocks.len() as u32 {
            for input in [P1, P0] {
                let e = self.input(&inputs, block, input);
                if e.divides() {
                    self.cannot(0, "a pulse whose condition divides");
                }
                let first = Ex::var("FIRST").and(e);
                let (before, early) =
                    (self.before_name(block, input), self.of_block(block, "P1_EARLY", Ty::BOOL));
                if input == P1 {
                    s.set("", early, first.clone());
                }
                s.set("", before, first);
            }
        }
        s
    }

    fn before_name(&mut self, block: u32, input: u8) -> String {
        let input = g7_engine::INPUTS.get(usize::from(input)).copied().unwrap_or("");
        self.of_block(block, &format!("{input}_WAS"), Ty::BOOL)
    }

    /// All that comes behind the evolution.
    pub(crate) fn end_of_scan(&mut self) -> Vec<Section> {
        let mut out = Section::new("Outputs that follow one step");
        for (i, step) in self.t.steps.iter().enumerate() {
            if step.direct.0 != NONE {
                let x = self.active(i as u32);
                self.put(&mut out, step.direct.0, x, &format!("X{i}"));
            }
        }
        let early = self.t.rules.periodic_first;
        let mut sections = vec![out];
        let mut starts: BTreeMap<u32, Vec<Ex>> = BTreeMap::new();
        for step in 0..self.t.steps.len() as u32 {
            let rows = self.extra(step).periodics;
            for i in rows.start..rows.end {
                let Some(action) = self.t.periodics.get(i as usize).copied() else { break };
                let mut x = self.active(step);
                if early {
                    let name = self.step(StepId(step));
                    let before = format!("B_{name}");
                    self.declare(&before, "BOOL", "as the scan began");
                    self.begun.insert(before.clone(), name);
                    x = x.and(Ex::Var(before));
                }
                starts.entry(action).or_default().push(x);
            }
        }
        if early {
            let mut s = Section::new("Actions of each scan");
            for (action, when) in std::mem::take(&mut starts) {
                self.run(&mut s, action, Ex::any(when));
            }
            sections.push(s);
        }
        let mut s = Section::new("Control of the actions");
        let inputs = self.inputs();
        self.conditions_before(&mut s, &inputs);
        for block in 0..self.t.blocks.len() as u32 {
            let runs = self.block(&mut s, &inputs, block);
            if let Some((action, flag)) = runs {
                starts.entry(action).or_default().push(flag);
            }
        }
        sections.push(s);
        let mut late = Section::new("Bodies");
        let lists: Vec<u32> =
            if self.t.rules.late_actions { self.t.action_lists.clone() } else { Vec::new() };
        for action in lists {
            let flag = self.late_flag(action);
            let list = starts.entry(action).or_default();
            if !list.contains(&Ex::var(flag.clone())) {
                list.push(Ex::Var(flag));
            }
        }
        for (action, when) in &starts {
            self.run(&mut late, *action, Ex::any(when.iter().cloned()));
        }
        for (action, when) in &starts {
            let name = format!("L_{}", action + 1);
            if when.contains(&Ex::var(name.clone())) {
                late.assign("", name, Ex::Bool(false));
            }
        }
        sections.push(late);
        let mut post = Section::new("POST");
        for code in [self.t.post, self.t.tail] {
            let body = self.body(code);
            post.act("", Ex::Bool(true), body);
        }
        sections.push(post);
        sections
    }

    /// Gives a variable what drives it; where others write it as well, only a
    /// change of that.
    fn put(&mut self, s: &mut Section, output: u32, q: Ex, unique: &str) {
        let place = self.word(output);
        let starts_true = self.t.init.get(output as usize).copied().unwrap_or(0) != 0;
        match &place {
            Ex::Var(name) if !self.is_written(output) && !starts_true => s.assign("", name.clone(), q),
            _ => {
                let base = match &place {
                    Ex::Var(name) => name.clone(),
                    _ => unique.to_owned(),
                };
                let given = format!("GIVEN_{base}");
                self.declare(&given, "BOOL", "what was given last");
                let differs = q.clone().xor(Ex::var(given.clone()));
                s.act("", differs, vec![St::Assign(place, q.clone())]);
                s.assign("", given, q);
            }
        }
    }

    /// A control block; the action that it runs, and when.
    fn block(&mut self, s: &mut Section, inputs: &Inputs, block: u32) -> Option<(u32, Ex)> {
        let b = self.t.blocks.get(block as usize).copied()?;
        let title =
            self.c.symbols.blocks.get(block as usize).map_or(String::new(), |b| {
                if b.name.is_empty() { self.text(b.at) } else { b.name.to_string() }
            });
        let gate = self.condition(b.gate);
        if b.plain {
            let q = self.input(inputs, block, N).and(gate);
            if b.output.0 != NONE {
                self.put(s, b.output.0, q, &format!("B{block}"));
            }
            return None;
        }
        let at = s.rungs.len();
        let mut on = [const { Ex::Bool(false) }; 11];
        for (i, slot) in on.iter_mut().enumerate() {
            let e = self.input(inputs, block, i as u8);
            if e == Ex::Bool(false) {
                continue;
            }
            // What is looked at more than once has a memory.
            let used_once = matches!(i as u8, N | S);
            *slot = if used_once || matches!(e, Ex::Var(_)) {
                e
            } else {
                let input = g7_engine::INPUTS.get(i).copied().unwrap_or("");
                let name = self.of_block(block, input, Ty::BOOL);
                s.assign("", name.clone(), e);
                Ex::Var(name)
            };
        }
        let get = |i: u8| on.get(usize::from(i)).cloned().unwrap_or(Ex::Bool(false));
        let has = |i: u8| get(i) != Ex::Bool(false);
        let not_r = get(R).not();
        let mut parts = vec![get(N)];
        if has(S) {
            let name = self.of_block(block, "S_FF", Ty::BOOL);
            s.assign("", name.clone(), not_r.clone().and(get(S).or(Ex::var(name.clone()))));
            parts.push(Ex::Var(name));
        }
        let mut updates: Vec<(String, Ex)> = Vec::new();
        for i in [L, D, SD, DS, SL] {
            if !has(i) {
                continue;
            }
            let input = g7_engine::INPUTS.get(usize::from(i)).copied().unwrap_or("");
            let was = self.before_name(block, i);
            let e = if i == SD || i == SL {
                let name = self.of_block(block, &format!("{input}_FF"), Ty::BOOL);
                s.assign("", name.clone(), not_r.clone().and(get(i).or(Ex::var(name.clone()))));
                Ex::Var(name)
            } else {
                get(i)
            };
            let start = self.of_block(block, &format!("{input}_START"), Ty::TIME);
            let now = self.now();
            let comes = e.clone().and(Ex::var(was.clone()).not());
            let mut begin = vec![St::set(start.clone(), now.clone())];
            let time = self.time_of(inputs, block, i, &mut begin, s);
            s.act("", comes, begin);
            updates.push((was, e.clone()));
            let due = Ex::op(">=", Ex::op("-", now, Ex::Var(start)), time);
            match i {
                L | SL => parts.push(e.and(due.not())),
                DS => {
                    let name = self.of_block(block, "DS_FF", Ty::BOOL);
                    let set = e.and(due).or(Ex::var(name.clone()));
                    s.assign("", name.clone(), not_r.clone().and(set));
                    parts.push(Ex::Var(name));
                }
                _ => parts.push(e.and(due)),
            }
        }
        if has(P) {
            let was = self.before_name(block, P);
            parts.push(get(P).and(Ex::var(was.clone()).not()));
            updates.push((was, get(P)));
        }
        let level = Ex::all([not_r.clone(), gate.clone(), Ex::any(parts)]);
        let fine = not_r.and(gate);
        let mut pulses = Vec::new();
        if has(P1) {
            let was = self.before_name(block, P1);
            let mut e = get(P1).and(Ex::var(was.clone()).not());
            if self.t.rules.late_actions {
                e = e.or(Ex::var(self.of_block(block, "P1_EARLY", Ty::BOOL)));
            }
            pulses.push(fine.clone().and(e));
            updates.push((was, get(P1)));
        }
        if has(P0) {
            let was = self.before_name(block, P0);
            pulses.push(Ex::all([fine, get(P0).not(), Ex::var(was.clone())]));
            updates.push((was, get(P0)));
        }
        let mut q = Ex::any([level.clone()].into_iter().chain(pulses));
        let mut run = None;
        if b.action != NONE {
            let flag = self.of_block(block, "Q", Ty::BOOL);
            if self.t.rules.final_scan {
                let level_name = self.of_block(block, "A", Ty::BOOL);
                let was = self.of_block(block, "A_WAS", Ty::BOOL);
                s.assign("", was.clone(), Ex::var(level_name.clone()));
                s.assign("", level_name.clone(), level);
                let fell = Ex::var(was).and(Ex::Var(level_name).not());
                s.assign("runs once more after it has fallen", flag.clone(), q.clone().or(fell));
            } else {
                s.assign("", flag.clone(), q.clone());
                q = Ex::var(flag.clone());
            }
            run = Some((b.action, Ex::Var(flag)));
        }
        if b.output.0 != NONE {
            self.put(s, b.output.0, q, &format!("B{block}"));
        }
        for (was, e) in updates {
            s.assign("", was, e);
        }
        if has(P1) && self.t.rules.late_actions {
            let early = self.of_block(block, "P1_EARLY", Ty::BOOL);
            s.assign("", early, Ex::Bool(false));
        }
        if let Some(r) = s.rungs.get_mut(at)
            && r.note.is_empty()
        {
            r.note = title;
        }
        run
    }

    /// The time of a timed input: the constant, or a memory that takes it as the
    /// input comes true.
    fn time_of(
        &mut self,
        inputs: &Inputs,
        block: u32,
        input: u8,
        begin: &mut Vec<St>,
        s: &mut Section,
    ) -> Ex {
        let rows = inputs.get(&(block, input)).cloned().unwrap_or_default();
        let mut times: Vec<Ex> = Vec::new();
        for (_, c) in &rows {
            let e = if c.time.is_empty() { Ex::Time(0) } else { self.value(c.time, Ty::TIME) };
            times.push(e);
        }
        let all_same = times.windows(2).all(|w| w.first() == w.get(1));
        match times.first() {
            Some(e @ Ex::Time(_)) if all_same => return e.clone(),
            None => return Ex::Time(0),
            Some(_) => {}
        }
        if self.t.rules.stable {
            self.cannot(
                rows.first().map_or(0, |r| r.1.time.start),
                "a duration that is worked out, or several of one variable",
            );
        }
        let word = g7_engine::INPUTS.get(usize::from(input)).copied().unwrap_or("");
        let name = self.of_block(block, &format!("{word}_TIME"), Ty::TIME);
        if rows.len() == 1 {
            let takes = times.remove(0);
            if input == SD || input == SL {
                // The memory may be on already as the input comes again.
                let was = self.of_block(block, &format!("{word}_IN_WAS"), Ty::BOOL);
                let e = self.input(inputs, block, input);
                s.act("", e.clone().and(Ex::var(was.clone()).not()), vec![St::set(name.clone(), takes)]);
                s.assign("", was, e);
            } else {
                begin.push(St::set(name.clone(), takes));
            }
            return Ex::Var(name);
        }
        for (k, ((step, c), time)) in rows.iter().zip(times).enumerate() {
            let was = self.of_block(block, &format!("{word}_WAS_{}", k + 1), Ty::BOOL);
            let e = self.active(*step).and(self.judged(c));
            s.act("", e.clone().and(Ex::var(was.clone()).not()), vec![St::set(name.clone(), time)]);
            s.assign("", was, e);
        }
        Ex::Var(name)
    }

    /// Conditions see the variables before any block has written: those that
    /// read what one writes are judged first, and those that divide.
    fn conditions_before(&mut self, s: &mut Section, inputs: &Inputs) {
        let outputs: Vec<u32> = self.t.blocks.iter().map(|b| b.output.0).filter(|o| *o != NONE).collect();
        let outputs: Vec<Ex> = outputs.into_iter().map(|o| self.word(o)).collect();
        for c in inputs.values().flatten().map(|r| r.1) {
            let e = self.condition(c.condition);
            let touches = outputs.iter().any(|o| match o {
                Ex::Var(n) | Ex::Index(n, _) => e.reads(n),
                _ => false,
            });
            if (touches || e.divides()) && !self.judged.contains_key(&c.condition.start) {
                let n = (self.judged.len() + 1).to_string();
                let name = self.memory("BC", &n, Ty::BOOL, "a condition of an action");
                if e.divides() {
                    // Only where its step is active: its divisor may be zero otherwise.
                    let rows = inputs.values().flatten();
                    let own = rows.filter(|(_, o)| o.condition.start == c.condition.start);
                    let active = Ex::any(own.map(|(step, _)| self.active(*step)));
                    s.assign("", name.clone(), Ex::Bool(false));
                    s.act("", active, vec![St::set(name.clone(), e)]);
                } else {
                    s.assign("", name.clone(), e);
                }
                self.judged.insert(c.condition.start, name);
            }
        }
    }

    /// The condition of an input.
    fn judged(&mut self, c: &Contribution) -> Ex {
        match self.judged.get(&c.condition.start).filter(|_| !c.condition.is_empty()) {
            Some(name) => Ex::var(name.clone()),
            None => self.condition(c.condition),
        }
    }
}
