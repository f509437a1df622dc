//! Actions and control blocks of one chart.

use std::collections::BTreeMap;

use g7_engine::{ControlBlock, NONE, Num};
use g7_model::Type;

use crate::build::{Gen, memory, s, state};
use crate::chart::call;
use crate::facts::counts;
use crate::lets::drop_unused;
use crate::operations::differ;
use crate::places::{own, own_set};
use crate::tree::{Arm, Bin, Block, Expr, Field, Stmt, Struct, Ty};
use crate::vars::{Home, Shape, Slot, members};

impl Gen<'_> {
    /// Actions, events, conditions, control blocks.
    pub(crate) fn acts(&mut self) {
        self.actions();
        self.events();
        self.conditions();
        self.blocks();
    }

    fn actions(&mut self) {
        let t = self.t;
        let (late, sequential, defers) = (self.facts.late, self.facts.sequential, self.facts.defers);
        let mut at_once = vec![false; t.actions.len()];
        let mut deferred = at_once.clone();
        let mark = |all: &mut Vec<bool>, a: u32| {
            if let Some(m) = all.get_mut(a as usize) {
                *m = true;
            }
        };
        for a in &t.action_lists {
            if defers && !late {
                mark(&mut deferred, *a);
            }
            if !defers || late || sequential {
                mark(&mut at_once, *a);
            }
        }
        let clearings = t.transitions.iter().map(|t| t.on_clearing).filter(|a| *a != NONE);
        for a in clearings {
            mark(if defers && !sequential { &mut deferred } else { &mut at_once }, a);
        }
        for e in &t.events {
            mark(if defers { &mut deferred } else { &mut at_once }, e.action);
        }
        t.periodics.iter().for_each(|a| mark(&mut at_once, *a));
        t.blocks.iter().filter(|b| b.action != NONE).for_each(|b| mark(&mut at_once, b.action));
        let (mut run, mut defer, mut write) = (Vec::new(), Vec::new(), Vec::new());
        let mut written: BTreeMap<u32, Slot> = BTreeMap::new();
        for i in 0..t.actions.len() {
            let label = Expr::size(i);
            let note = self.action_note(i);
            if at_once.get(i) == Some(&true) {
                let name = format!("action_{i}");
                let body = self.action(i);
                self.function(&name, &note, vec![state()], body);
                let body = vec![Stmt::Do(Expr::call(name, vec![s()]))];
                run.push(Arm { label: label.clone(), note: note.clone(), body });
            }
            if deferred.get(i) == Some(&true) {
                let slots = self.written(i);
                let name = format!("deferred_{i}");
                let body = self.action_apart(i, &slots);
                self.function(&name, &note, vec![state()], body);
                let body = vec![Stmt::Do(Expr::call(name, vec![s()]))];
                defer.push(Arm { label: label.clone(), note: note.clone(), body });
                let writes = slots
                    .values()
                    .map(|slot| Stmt::Do(Expr::call(format!("write_{}", slot.field), vec![s()])));
                write.push(Arm { label, note, body: writes.collect() });
                written.extend(slots);
            }
        }
        self.choice("run_action", "Runs an action.", "action", run);
        self.choice("defer_action", "Runs an action; what it writes waits.", "action", defer);
        self.choice("write_action", "Writes what waits.", "action", write);
        self.waiting(&written);
    }

    /// An action as it stands in the chart.
    pub(crate) fn action_note(&self, i: usize) -> String {
        self.c.symbols.actions.get(i).map_or(String::new(), |a| self.text(a.at))
    }

    /// The statements of an action, with its condition and its period.
    fn action(&mut self, i: usize) -> Block {
        self.at_action(i);
        let list = self.bodies.action(i as u32);
        self.statements(&list)
    }

    /// The same on copies of what it writes.
    fn action_apart(&mut self, i: usize, slots: &BTreeMap<u32, Slot>) -> Block {
        self.at_action(i);
        let list = self.bodies.action_apart(i as u32);
        let mut all: Block = slots.values().flat_map(own_instance).collect();
        all.extend(self.statements(&list));
        // An action that always writes does not ask whether it has written.
        drop_unused(&mut all, None);
        all
    }

    fn at_action(&mut self, i: usize) {
        let body = self.t.actions.get(i).map_or(0, |a| a.body.start);
        self.at = self.c.symbols.place(body);
    }

    /// The variables that an action writes, those that last.
    fn written(&mut self, i: usize) -> BTreeMap<u32, Slot> {
        let Some(a) = self.t.actions.get(i).copied() else { return BTreeMap::new() };
        let written = self.bodies.written(a.body);
        let slots = written.into_iter().filter_map(|m| self.slot_of(m)).map(|(slot, _)| slot);
        slots.filter(|s| s.home != Home::Locals).map(|s| (s.start, s)).collect()
    }

    /// Where writes wait, and the functions that make them.
    fn waiting(&mut self, slots: &BTreeMap<u32, Slot>) {
        let field = |s: &Slot, ty: Ty| Field { name: s.field.clone(), ty, note: String::new(), kept: true };
        let next = slots.values().map(|s| field(s, s.ty())).collect();
        let wrote = slots.values().map(|s| field(s, flag_ty(s))).collect();
        let new = |name: &str, note: &str, fields| Struct {
            public: true,
            note: note.into(),
            name: name.into(),
            fields,
        };
        self.m.structs.push(new(
            "Next",
            "Values that stored actions have written, until the pass ends.",
            next,
        ));
        self.m.structs.push(new("Wrote", "Which of it was written.", wrote));
        for slot in slots.values() {
            let body = write_back(slot);
            self.function(&format!("write_{}", slot.field), "", vec![state()], body);
        }
    }

    fn events(&mut self) {
        let mut arms = Vec::new();
        for (i, e) in self.t.events.iter().enumerate() {
            let (value, fails) = self.value(e.event, Type::Bool, &format!("event_{i}"));
            let period = self.t.actions.get(e.action as usize).map_or(0, |a| a.period);
            let mut body = vec![Stmt::Let { mutable: false, name: "now".into(), ty: Ty::Bool, value }];
            let run = call("run_in_pass", Expr::size(e.action as usize));
            let mut c = Expr::name("now");
            if fails {
                c = s().field("fault").bin(Bin::Eq, Expr::size(0)).and(c);
            }
            body.push(Stmt::If(c, vec![run], Vec::new()));
            let note = self.action_note(e.action as usize);
            arms.push(Arm { label: Expr::size(i), note, body: Stmt::when(self.due(period), body) });
        }
        self.choice("event", "An action on event of an active step.", "row", arms);
    }

    fn conditions(&mut self) {
        let (places, full_rows) = (counts(self.t).0, self.full_rows());
        let mut arms = Vec::new();
        for (i, c) in self.t.contributions.iter().enumerate() {
            if c.condition.is_empty() && c.time.is_empty() {
                continue;
            }
            let (value, fails) = self.condition(c.condition, &format!("condition_{i}"));
            let leave = || {
                let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                Stmt::If(fault, vec![Stmt::Return(None)], Vec::new())
            };
            let now = || Expr::name("now");
            let mut body = vec![Stmt::Let { mutable: false, name: "now".into(), ty: Ty::Bool, value }];
            if fails {
                body.push(leave());
            }
            let mut inner = Block::new();
            let timed = [3u8, 4, 8, 9, 10].iter().position(|k| *k == c.input);
            let full = full_rows.get(c.block as usize).copied().flatten();
            if let (Some(k), Some(full), false) = (timed, full, c.time.is_empty()) {
                let (time, fails) = self.value(c.time, Type::Time, &format!("time_{i}"));
                let mut take =
                    vec![Stmt::Let { mutable: false, name: "time".into(), ty: Ty::I64, value: time }];
                if fails {
                    take.push(leave());
                }
                let slot = memory("block_time").at(Expr::size(full * 5 + k));
                take.push(Stmt::set(slot, Expr::name("time")));
                inner.push(Stmt::If(now(), take, Vec::new()));
            }
            let at = places.get(c.block as usize).copied().unwrap_or(0) + usize::from(c.input);
            let args = vec![s(), Expr::size(i), now(), Expr::size(at), Expr::size(c.block as usize)];
            inner.push(Stmt::Do(Expr::call("count_condition", args)));
            let differs = now().bin(Bin::Ne, memory("counted").at(Expr::size(i)));
            body.push(Stmt::If(differs, inner, Vec::new()));
            let pulse = c.input == 6 || c.input == 7;
            let wanted = if pulse { Expr::Bool(true) } else { Expr::name("pulses").not() };
            let name = self.c.symbols.blocks.get(c.block as usize).map_or("", |b| &b.name);
            let input = g7_engine::INPUTS.get(usize::from(c.input)).copied().unwrap_or("");
            let body = Stmt::when(wanted.and(self.due(c.period)), body);
            arms.push(Arm { label: Expr::size(i), note: format!("{input} {name}").trim().to_owned(), body });
        }
        let parameters = vec![state(), ("row".into(), Ty::Size), ("pulses".into(), Ty::Bool)];
        let body = vec![Stmt::Match(Expr::name("row"), arms)];
        self.function(
            "condition",
            "An input of a control block that has a condition or a time.",
            parameters,
            body,
        );
    }

    /// By control block: its row among those with memory.
    fn full_rows(&self) -> Vec<Option<usize>> {
        let mut next = 0;
        let row = |b: &ControlBlock| {
            let own = (!b.plain).then_some(next);
            next += usize::from(!b.plain);
            own
        };
        self.t.blocks.iter().map(row).collect()
    }

    fn blocks(&mut self) {
        let (places, full_rows) = (counts(self.t).0, self.full_rows());
        let mut arms = Vec::new();
        for (i, b) in self.t.blocks.iter().enumerate() {
            let again = |f: &str| Stmt::Do(Expr::call(f, vec![memory("blocks").passed(), Expr::size(i)]));
            let mut body = vec![again("bit_clear")];
            let (gate, fails) = self.condition(b.gate, &format!("gate_{i}"));
            let at = places.get(i).copied().unwrap_or(0);
            let mut gate_here = gate.clone();
            if !b.gate.is_empty() {
                body.push(Stmt::Let { mutable: false, name: "gate".into(), ty: Ty::Bool, value: gate });
                gate_here = Expr::name("gate");
                if fails {
                    let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                    body.push(Stmt::If(fault, vec![Stmt::Return(None)], Vec::new()));
                }
            }
            let q = || Expr::name("q");
            let let_q = |value| Stmt::Let { mutable: false, name: "q".into(), ty: Ty::Bool, value };
            let has =
                |k: usize| Expr::name("result").bin(Bin::BitAnd, Expr::size(k)).bin(Bin::Ne, Expr::size(0));
            match full_rows.get(i).copied().flatten() {
                None => {
                    let some = memory("counts").at(Expr::size(at)).bin(Bin::Ne, Expr::size(0));
                    body.push(let_q(some.and(gate_here)));
                    self.put(&mut body, i, b.output.0, q());
                    if b.action != NONE {
                        let run = vec![call("run_at_end", Expr::size(b.action as usize)), again("bit_set")];
                        body.push(Stmt::If(q(), run, Vec::new()));
                    }
                }
                Some(full) => {
                    let args = vec![s(), Expr::size(full), Expr::size(at), gate_here];
                    let bits = Ty::Int { signed: false, bits: 32 };
                    let value = Expr::call("control_block", args);
                    body.push(Stmt::Let { mutable: false, name: "result".into(), ty: bits, value });
                    if b.output.0 != NONE || (b.action != NONE) {
                        body.push(let_q(has(1)));
                    }
                    self.put(&mut body, i, b.output.0, q());
                    let mut live = has(4);
                    if b.action != NONE {
                        let run = call("run_at_end", Expr::size(b.action as usize));
                        body.push(Stmt::If(has(2), vec![run], Vec::new()));
                        live = q().bin(Bin::Or, live);
                    }
                    if b.gate.is_empty() {
                        body.push(Stmt::If(live, vec![again("bit_set")], Vec::new()));
                    }
                }
            }
            if !b.gate.is_empty() {
                body.push(again("bit_set"));
            }
            let note = self.c.symbols.blocks.get(i).map_or(String::new(), |b| b.name.to_string());
            arms.push(Arm { label: Expr::size(i), note, body: Stmt::when(self.due(b.period), body) });
        }
        self.choice("evaluate_block", "A control block.", "block", arms);
    }

    /// Writes Q where it has changed: between two changes the variable is free.
    fn put(&mut self, body: &mut Block, i: usize, output: u32, q: Expr) {
        if output == NONE {
            return;
        }
        let mut then = vec![Stmt::set(memory("written").at(Expr::size(i)), q.clone())];
        then.extend(self.assign(output, Type::Bool, |_| q.clone()));
        let differs = q.bin(Bin::Ne, memory("written").at(Expr::size(i)));
        body.push(Stmt::If(differs, then, Vec::new()));
    }
}

/// The flags that tell what of a variable was written.
fn flag_ty(slot: &Slot) -> Ty {
    let many = |n: usize| Ty::Array(Box::new(Ty::Bool), n);
    match slot.shape {
        Shape::One(_) | Shape::Text(_) => Ty::Bool,
        Shape::Many(_, n) | Shape::Texts(_, n) => many(n as usize),
        Shape::Fb(kind) => many(members(kind).len()),
    }
}

/// The copy of a function block that an action works on, and what tells of each of
/// its words that it was written.
fn own_instance(slot: &Slot) -> Block {
    if !matches!(slot.shape, Shape::Fb(_)) {
        return Block::new();
    }
    let zero = Expr::call("zeroed", Vec::new());
    vec![
        Stmt::Let { mutable: true, name: own(slot), ty: slot.ty(), value: slot.place() },
        Stmt::Let { mutable: true, name: own_set(slot), ty: flag_ty(slot), value: zero },
    ]
}

/// `next` and `wrote` of a variable.
fn waits(slot: &Slot) -> (Expr, Expr) {
    (s().field("next").field(slot.field.clone()), s().field("wrote").field(slot.field.clone()))
}

fn write_back(slot: &Slot) -> Block {
    let (next, wrote) = waits(slot);
    let place = slot.place();
    let changed = || Stmt::set(s().field("changed"), Expr::Bool(true));
    let one = |n: Num, place: Expr, next: Expr| {
        Stmt::when(differ(n, place.clone(), next.clone()), vec![Stmt::set(place, next), changed()])
    };
    let when_wrote = |wrote: Expr, inner: Block| {
        let mut all = vec![Stmt::set(wrote.clone(), Expr::Bool(false))];
        all.extend(inner);
        Stmt::when(wrote, all)
    };
    let bytes = |cap: u16, place: Expr, next: Expr| {
        let j = || Expr::name("j");
        let inner = one(Num::U8, place.at(j()), next.at(j()));
        vec![Stmt::For("j".into(), Expr::size(0), Expr::size(usize::from(cap) + 2), inner)]
    };
    let i = || Expr::name("i");
    match slot.shape {
        Shape::One(n) => when_wrote(wrote, one(n, place, next)),
        Shape::Text(cap) => when_wrote(wrote, bytes(cap, place, next)),
        Shape::Many(n, len) => {
            let inner = when_wrote(wrote.at(i()), one(n, place.at(i()), next.at(i())));
            vec![Stmt::For("i".into(), Expr::size(0), Expr::size(len as usize), inner)]
        }
        Shape::Texts(cap, len) => {
            let inner = when_wrote(wrote.at(i()), bytes(cap, place.at(i()), next.at(i())));
            vec![Stmt::For("i".into(), Expr::size(0), Expr::size(len as usize), inner)]
        }
        Shape::Fb(kind) => {
            let mut all = Block::new();
            for (k, (name, n)) in members(kind).iter().enumerate() {
                let inner = one(*n, place.clone().field(*name), next.clone().field(*name));
                all.extend(when_wrote(wrote.clone().at(Expr::size(k)), inner));
            }
            all
        }
    }
}
