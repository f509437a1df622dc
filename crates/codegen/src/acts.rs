//! Actions and control blocks of one chart.

use std::collections::BTreeMap;

use g7_engine::{NONE, Num, Op};

use crate::build::{Gen, memory, s, state};
use crate::chart::call;
use crate::facts::counts;
use crate::flow::{Deferred, Flow};
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
            let note = self.c.symbols.actions.get(i).map_or(String::new(), |a| self.text(a.at));
            if at_once.get(i) == Some(&true) {
                let name = format!("action_{i}");
                let body = self.action(i, None);
                self.function(&name, &note, vec![state()], body);
                let body = vec![Stmt::Do(Expr::call(name, vec![s()]))];
                run.push(Arm { label: label.clone(), note: note.clone(), body });
            }
            if deferred.get(i) == Some(&true) {
                let slots = self.written(i);
                let name = format!("deferred_{i}");
                let body = self.action(i, Some(&slots));
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

    /// An action where its period is due and its condition holds.
    fn action(&mut self, i: usize, deferred: Option<&BTreeMap<u32, Slot>>) -> Block {
        let Some(a) = self.t.actions.get(i).copied() else { return Block::new() };
        let (condition, fails) = self.condition(a.condition, &format!("condition_of_action_{i}"));
        let mut flow = Flow::new(self, a.body, None);
        if let Some(slots) = deferred {
            let own = slots.values().map(|s| (s.start, format!("own_{}", s.field)));
            flow.deferred = Some(Deferred { own: own.collect() });
        }
        let mut body = flow.body();
        if let Some(slots) = deferred {
            let sure: Vec<Sure> = slots.values().map(|s| make_direct(&mut body, s)).collect();
            let each = || slots.values().zip(&sure);
            let copies: Block = each().flat_map(|(s, sure)| own_copy(s, *sure)).collect();
            let back: Block = each().flat_map(|(s, sure)| give_back(s, *sure != Sure::No)).collect();
            body = [copies, body, back].concat();
        }
        let mut all = Block::new();
        if fails {
            let name = "holds".to_owned();
            all.push(Stmt::Let { mutable: false, name: name.clone(), ty: Ty::Bool, value: condition });
            let fine = s().field("fault").bin(Bin::Eq, Expr::size(0));
            all.extend(Stmt::when(fine.and(Expr::Name(name)), body));
        } else {
            all.extend(Stmt::when(condition, body));
        }
        Stmt::when(self.due(a.period), all)
    }

    /// The variables that an action writes, those that last.
    fn written(&mut self, i: usize) -> BTreeMap<u32, Slot> {
        let mut all = BTreeMap::new();
        let Some(a) = self.t.actions.get(i).copied() else { return all };
        let code = self.t.code.get(a.body.start as usize..a.body.end as usize).unwrap_or(&[]);
        for op in code {
            let addr = match *op {
                Op::Store(a) | Op::Random(a) => a,
                Op::StoreAt { base, .. } | Op::Fb(_, base) => base,
                Op::StoreText { to, .. } | Op::Text { to, .. } | Op::ToText { to, .. } => to,
                _ => continue,
            };
            self.reveal(addr.0);
            if let Some(slot) = self.vars.slot(addr.0).filter(|s| s.home != Home::Locals) {
                all.insert(slot.start, slot.clone());
            }
        }
        all
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
        self.m.structs.push(new("Next", "What stored actions have written, until the pass ends.", next));
        self.m.structs.push(new("Wrote", "Which of it was written.", wrote));
        for slot in slots.values() {
            let body = write_back(slot);
            self.function(&format!("write_{}", slot.field), "", vec![state()], body);
        }
    }

    fn events(&mut self) {
        let mut arms = Vec::new();
        for (i, e) in self.t.events.iter().enumerate() {
            let (value, fails) = self.value(e.event, Num::Bool, &format!("event_{i}"));
            let period = self.t.actions.get(e.action as usize).map_or(0, |a| a.period);
            let mut body = vec![Stmt::Let { mutable: false, name: "now".into(), ty: Ty::Bool, value }];
            let run = call("run_in_pass", Expr::size(e.action as usize));
            let mut c = Expr::name("now");
            if fails {
                c = s().field("fault").bin(Bin::Eq, Expr::size(0)).and(c);
            }
            body.push(Stmt::If(c, vec![run], Vec::new()));
            let note =
                self.c.symbols.actions.get(e.action as usize).map_or(String::new(), |a| self.text(a.at));
            arms.push(Arm { label: Expr::size(i), note, body: Stmt::when(self.due(period), body) });
        }
        self.choice("event", "An action on event of an active step.", "row", arms);
    }

    fn conditions(&mut self) {
        let places = counts(self.t).0;
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
            let full = self.full_row(c.block);
            if let (Some(k), Some(full), false) = (timed, full, c.time.is_empty()) {
                let (time, fails) = self.value(c.time, Num::I64, &format!("time_{i}"));
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

    /// The row of a block among those with memory.
    fn full_row(&self, block: u32) -> Option<usize> {
        let all = self.t.blocks.get(..block as usize)?;
        let this = self.t.blocks.get(block as usize)?;
        (!this.plain).then(|| all.iter().filter(|b| !b.plain).count())
    }

    fn blocks(&mut self) {
        let places = counts(self.t).0;
        let (mut arms, mut line) = (Vec::new(), Block::new());
        for (i, b) in self.t.blocks.iter().enumerate() {
            if self.is_equation(i as u32) {
                let equation = self.equation(i, b);
                line.extend(equation);
                continue;
            }
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
            match self.full_row(i as u32) {
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
            let wanted = Expr::call("bit", vec![Expr::Ref(false, Box::new(memory("blocks"))), Expr::size(i)]);
            let mut look = vec![call("evaluate_block", Expr::size(i))];
            if fails {
                let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                look.push(Stmt::If(fault, vec![Stmt::Return(None)], Vec::new()));
            }
            line.extend(Stmt::when(wanted, look));
        }
        self.choice("evaluate_block", "A control block.", "block", arms);
        self.function("control_blocks", "Outputs and control blocks, in order.", vec![state()], line);
    }

    /// Writes Q where it has changed: between two changes the variable is free.
    pub(crate) fn put(&mut self, body: &mut Block, i: usize, output: u32, q: Expr) {
        if output == NONE {
            return;
        }
        let mut then = vec![Stmt::set(memory("written").at(Expr::size(i)), q.clone())];
        then.extend(self.assign(output, |_| q.clone()));
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

fn own_copy(slot: &Slot, sure: Sure) -> Block {
    if sure == Sure::Begins {
        return Block::new();
    }
    let own = format!("own_{}", slot.field);
    let zero = match flag_ty(slot) {
        Ty::Bool => Expr::Bool(false),
        _ => Expr::call("zeroed", Vec::new()),
    };
    let flag = Stmt::Let { mutable: true, name: format!("{own}_set"), ty: flag_ty(slot), value: zero };
    let copy = Stmt::Let { mutable: true, name: own, ty: slot.ty(), value: slot.place() };
    if sure == Sure::No { vec![copy, flag] } else { vec![copy] }
}

/// `next` and `wrote` of a variable.
fn waits(slot: &Slot) -> (Expr, Expr) {
    (s().field("next").field(slot.field.clone()), s().field("wrote").field(slot.field.clone()))
}

/// Whether an expression or what is in it has one of two names.
fn mentions(s: &Stmt, names: [&str; 2]) -> bool {
    let mut found = false;
    s.walk(&mut |e| found |= matches!(e, Expr::Name(n) if names.contains(&n.as_str())));
    found
}

/// Takes assignments to a name away, at every depth.
fn without(body: &mut Block, name: &str) {
    body.retain(|s| !matches!(s, Stmt::Assign(None, Expr::Name(n), _) if n == name));
    for s in body {
        match s {
            Stmt::If(_, a, b) => {
                without(a, name);
                without(b, name);
            }
            Stmt::While(_, inner) | Stmt::For(_, _, _, inner) => without(inner, name),
            _ => {}
        }
    }
}

/// How often a name is assigned to.
fn assigned(body: &Block, name: &str) -> usize {
    let one = |s: &Stmt| match s {
        Stmt::Assign(_, Expr::Name(n), _) => usize::from(n == name),
        Stmt::If(_, a, b) => assigned(a, name) + assigned(b, name),
        Stmt::While(_, inner) | Stmt::For(_, _, _, inner) => assigned(inner, name),
        _ => 0,
    };
    body.iter().map(one).sum()
}

/// Whether an action writes a variable in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sure {
    /// It may, or may not.
    No,
    /// It does.
    Writes,
    /// It does, before it reads it: its copy begins with that.
    Begins,
}

/// Leaves away the flag where the variable is written in any case, and the copy
/// where it is not read before.
fn make_direct(body: &mut Block, slot: &Slot) -> Sure {
    let own = format!("own_{}", slot.field);
    let flag = format!("{own}_set");
    let sets = |s: &Stmt| matches!(s, Stmt::Assign(None, Expr::Name(n), _) if *n == flag);
    if !matches!(slot.shape, Shape::One(_) | Shape::Text(_)) || !body.iter().any(sets) {
        return Sure::No;
    }
    without(body, &flag);
    let Some(at) = body.iter().position(|s| mentions(s, [&own, &flag])) else { return Sure::Writes };
    let value = match body.get(at) {
        Some(Stmt::Assign(None, Expr::Name(n), value)) if *n == own => value.clone(),
        _ => return Sure::Writes,
    };
    if mentions(&Stmt::Do(value.clone()), [&own, &flag]) {
        return Sure::Writes;
    }
    let mutable = assigned(body, &own) > 1;
    if let Some(s) = body.get_mut(at) {
        *s = Stmt::Let { mutable, name: own, ty: slot.ty(), value };
    }
    Sure::Begins
}

fn give_back(slot: &Slot, direct: bool) -> Block {
    let own = Expr::name(format!("own_{}", slot.field));
    let flag = if direct { Expr::Bool(true) } else { Expr::name(format!("own_{}_set", slot.field)) };
    let (next, wrote) = waits(slot);
    let both =
        |next: Expr, own: Expr, wrote: Expr| vec![Stmt::set(next, own), Stmt::set(wrote, Expr::Bool(true))];
    match slot.shape {
        Shape::One(_) | Shape::Text(_) => Stmt::when(flag, both(next, own, wrote)),
        Shape::Many(_, n) | Shape::Texts(_, n) => {
            let i = || Expr::name("i");
            let inner = Stmt::when(flag.at(i()), both(next.at(i()), own.at(i()), wrote.at(i())));
            vec![Stmt::For("i".into(), Expr::size(0), Expr::size(n as usize), inner)]
        }
        Shape::Fb(kind) => {
            let mut all = Block::new();
            for (k, (name, _)) in members(kind).iter().enumerate() {
                let k = Expr::size(k);
                let inner =
                    both(next.clone().field(*name), own.clone().field(*name), wrote.clone().at(k.clone()));
                all.extend(Stmt::when(flag.clone().at(k), inner));
            }
            all
        }
    }
}

/// Whether two numbers differ; what is no number is like itself.
pub(crate) fn differ(n: Num, a: Expr, b: Expr) -> Expr {
    let differs = a.clone().bin(Bin::Ne, b.clone());
    if !crate::values::is_real(n) {
        return differs;
    }
    let number = |e: Expr| e.clone().bin(Bin::Eq, e);
    differs.and(number(a).bin(Bin::Or, number(b)))
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
