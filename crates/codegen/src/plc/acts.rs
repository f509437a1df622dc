//! Actions: stored ones within a pass, bodies at the end of a scan.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use g7_engine::{NONE, Rows};

use super::form::{Ex, Rung, Section, St, What};
use super::plan::Plan;
use super::vars::{Shape, Ty};

/// What starts a stored action.
#[derive(Clone, Debug)]
pub(crate) enum Start {
    Comes(u32),
    Goes(u32),
    When(Ex),
}

impl Plan<'_> {
    pub(crate) fn action_list(&self, rows: Rows) -> Vec<u32> {
        self.t.action_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]).to_vec()
    }

    /// The condition and the statements of an action.
    pub(crate) fn action(&mut self, action: u32) -> (Ex, Vec<St>) {
        let Some(a) = self.t.actions.get(action as usize).copied() else {
            return (Ex::Bool(false), Vec::new());
        };
        (self.condition(a.condition), self.body(a.body))
    }

    pub(crate) fn action_note(&self, action: u32) -> String {
        self.c.symbols.actions.get(action as usize).map_or(String::new(), |a| self.text(a.at))
    }

    /// Runs an action where something starts it.
    pub(crate) fn run(&mut self, s: &mut Section, action: u32, when: Ex) {
        let (c, body) = self.action(action);
        let note = self.action_note(action);
        conditional(s, note, when, c, body);
    }

    /// The memory "runs at the end of the scan".
    pub(crate) fn late_flag(&mut self, action: u32) -> String {
        let name = format!("L_{}", action + 1);
        self.declare(&name, "BOOL", "runs at the end of the scan");
        name
    }

    /// Stored actions on event of the steps.
    fn events(&mut self) -> Vec<(u32, Start)> {
        let mut all = Vec::new();
        for step in 0..self.t.steps.len() as u32 {
            let rows = self.extra(step).events;
            for i in rows.start..rows.end {
                let Some(e) = self.t.events.get(i as usize).copied() else { break };
                let event = self.condition(e.event);
                if event.divides() {
                    self.cannot(e.event.start, "an event that divides");
                }
                let when = self.active(step).and(event);
                all.push((e.action, Start::When(when)));
            }
        }
        all
    }

    pub(crate) fn event_runs(&mut self) -> Vec<(u32, Ex)> {
        let all = self.events();
        let mut all: Vec<(u32, Ex)> = all
            .into_iter()
            .filter_map(|(a, s)| if let Start::When(e) = s { Some((a, e)) } else { None })
            .collect();
        all.sort_by_key(|r| r.0);
        all
    }

    /// All stored actions of a pass with what starts them.
    pub(crate) fn stored_runs(&mut self) -> Vec<(u32, Start)> {
        let mut all = self.events();
        for (i, t) in self.t.transitions.iter().enumerate() {
            if t.on_clearing != NONE {
                let e = Ex::Var(self.transitions.get(i).cloned().unwrap_or_default());
                all.push((t.on_clearing, Start::When(e)));
            }
        }
        if !self.t.rules.late_actions {
            all.extend(self.lists());
        }
        all
    }

    fn lists(&self) -> Vec<(u32, Start)> {
        let mut all = Vec::new();
        for step in 0..self.t.steps.len() as u32 {
            let e = self.extra(step);
            all.extend(self.action_list(e.off).into_iter().map(|a| (a, Start::Goes(step))));
            all.extend(self.action_list(e.on).into_iter().map(|a| (a, Start::Comes(step))));
        }
        all
    }

    pub(crate) fn resolved(&self, runs: &[(u32, Start)], come: &HashMap<u32, (Ex, Ex)>) -> Vec<(u32, Ex)> {
        let runs = runs.iter().filter_map(|(a, start)| {
            let e = match start {
                Start::Comes(step) => come.get(step)?.0.clone(),
                Start::Goes(step) => come.get(step)?.1.clone(),
                Start::When(e) => e.clone(),
            };
            Some((*a, e))
        });
        runs.collect()
    }

    /// The lists of steps that come and go, where they run at the end.
    pub(crate) fn late_runs(&self, come: &HashMap<u32, (Ex, Ex)>) -> Vec<(u32, Ex)> {
        if self.t.rules.late_actions { self.resolved(&self.lists(), come) } else { Vec::new() }
    }

    /// The variables of the chart that rungs write.
    pub(crate) fn written(&mut self, rungs: &[Rung]) -> Vec<(String, Ty)> {
        let mut found = BTreeMap::new();
        let mut other = false;
        for r in rungs {
            if let What::Do(_, body) = &r.what {
                each_write(body, &mut |place| match place {
                    Some(Ex::Var(name)) => {
                        found.insert(name.clone(), ());
                    }
                    _ => other = true,
                });
            }
        }
        if other {
            self.cannot(
                0,
                "tables and function blocks that stored actions change within a search for stability",
            );
        }
        found.into_keys().filter_map(|n| self.lasting(&n).map(|ty| (n, ty))).collect()
    }

    /// The type of a variable that lasts beyond the code that writes it.
    fn lasting(&self, name: &str) -> Option<Ty> {
        let end = if self.t.locals.is_empty() { u32::MAX } else { self.t.locals.start };
        let slot = self.vars.slots.values().find(|s| s.name == name);
        if let Some(slot) = slot {
            return match slot.shape {
                Shape::One(ty) if slot.start < end => Some(ty),
                _ => None,
            };
        }
        self.hidden_at(name)
            .filter(|addr| *addr < end)
            .map(|addr| self.hidden.get(&addr).copied().unwrap_or(Ty::LINT))
    }

    /// Stored actions that all read the values before the pass: what they write
    /// waits in variables of its own.
    pub(crate) fn parallel(&mut self, s: &mut Section, mut runs: Vec<(u32, Ex)>) {
        runs.sort_by_key(|r| r.0);
        let mut bodies = Section::default();
        for (action, when) in runs {
            let (c, body) = self.action(action);
            let body = self.waiting(action, body);
            let note = self.action_note(action);
            conditional(&mut bodies, note, when, c, body);
        }
        let copies = self.nexts.clone().into_iter();
        s.act(
            "",
            Ex::Bool(true),
            copies.map(|(name, _)| St::set(format!("NX_{name}"), Ex::Var(name))).collect(),
        );
        s.rungs.extend(bodies.rungs);
    }

    /// A body whose writes wait.
    fn waiting(&mut self, action: u32, body: Vec<St>) -> Vec<St> {
        let mut names = BTreeSet::new();
        let mut other = false;
        each_write(&body, &mut |place| match place {
            Some(Ex::Var(name)) => {
                names.insert(name.clone());
            }
            _ => other = true,
        });
        if other {
            let at = self.t.actions.get(action as usize).map_or(0, |a| a.body.start);
            self.cannot(at, "tables and function blocks that actions change at one moment");
        }
        let mut own = BTreeMap::new();
        let mut before = Vec::new();
        let alone = matches!(body.as_slice(), [St::Assign(..)]);
        for name in names {
            let Some(ty) = self.lasting(&name) else { continue };
            self.nexts.insert(name.clone(), ty);
            self.declare(&format!("NX_{name}"), ty.name(), "what stored actions write");
            if !alone && reads(&body, &name) {
                let copy = self.memory("OWN", &name, ty, "");
                before.push(St::set(copy.clone(), Ex::var(name.clone())));
                own.insert(name, copy);
            }
        }
        let nexts = self.nexts.clone();
        before.extend(body.into_iter().flat_map(|s| wait(s, &nexts, &own)));
        before
    }

    /// What waited is written.
    pub(crate) fn take_next(&mut self, s: &mut Section, first: Option<Ex>) {
        for (name, ty) in std::mem::take(&mut self.nexts) {
            let next = Ex::Var(format!("NX_{name}"));
            if self.t.rules.stable && first.is_none() {
                let (a, b) = (Ex::var(name.clone()), next.clone());
                let differs = if ty == Ty::BOOL { a.xor(b) } else { Ex::op("<>", a, b) };
                s.set("", "CHANGED", differs);
            }
            match (&first, ty == Ty::BOOL) {
                (None, true) => s.assign("", name, next),
                (when, _) => {
                    let when = when.clone().unwrap_or(Ex::Bool(true));
                    s.act("", when, vec![St::set(name, next)]);
                }
            }
        }
    }
}

/// Statements under two conditions. The second is judged only where the first
/// holds if it divides: its divisor may be zero.
fn conditional(s: &mut Section, note: String, when: Ex, c: Ex, body: Vec<St>) {
    if c.divides() {
        s.act(note, when, St::when(c, body));
    } else {
        s.act(note, when.and(c), body);
    }
}

/// Every place that is written, and `None` for the call of an instance.
fn each_write(body: &[St], f: &mut dyn FnMut(Option<&Ex>)) {
    for s in body {
        match s {
            St::Assign(place, _) => f(Some(place)),
            St::If(_, a, b) => {
                each_write(a, f);
                each_write(b, f);
            }
            St::Loop(a) => each_write(a, f),
            St::Exit => {}
            St::Call(..) => f(None),
        }
    }
}

fn reads(body: &[St], name: &str) -> bool {
    body.iter().any(|s| match s {
        St::Assign(_, e) => e.reads(name),
        St::If(c, a, b) => c.reads(name) || reads(a, name) || reads(b, name),
        St::Loop(a) => reads(a, name),
        St::Exit => false,
        St::Call(_, inputs) => inputs.iter().any(|(_, e)| e.reads(name)),
    })
}

/// A statement that reads the action's own copies and writes what waits.
fn wait(s: St, nexts: &BTreeMap<String, Ty>, own: &BTreeMap<String, String>) -> Vec<St> {
    let list = |l: Vec<St>| l.into_iter().flat_map(|s| wait(s, nexts, own)).collect();
    match s {
        St::Assign(Ex::Var(name), e) if nexts.contains_key(&name) => {
            let e = renamed(e, own);
            let next = format!("NX_{name}");
            match own.get(&name) {
                Some(copy) => {
                    vec![St::set(copy.clone(), e), St::set(next, Ex::Var(copy.clone()))]
                }
                None => vec![St::set(next, e)],
            }
        }
        St::Assign(place, e) => vec![St::Assign(place, renamed(e, own))],
        St::If(c, a, b) => vec![St::If(renamed(c, own), list(a), list(b))],
        St::Loop(a) => vec![St::Loop(list(a))],
        St::Exit => vec![St::Exit],
        St::Call(n, inputs) => {
            vec![St::Call(n, inputs.into_iter().map(|(i, e)| (i, renamed(e, own))).collect())]
        }
    }
}

fn renamed(e: Ex, own: &BTreeMap<String, String>) -> Ex {
    let again = |e: Box<Ex>| Box::new(renamed(*e, own));
    let list = |l: Vec<Ex>| l.into_iter().map(|e| renamed(e, own)).collect();
    match e {
        Ex::Var(name) => Ex::Var(own.get(&name).cloned().unwrap_or(name)),
        Ex::Index(name, i) => Ex::Index(name, again(i)),
        Ex::Not(e) => Ex::Not(again(e)),
        Ex::Neg(e) => Ex::Neg(again(e)),
        Ex::And(l) => Ex::And(list(l)),
        Ex::Or(l) => Ex::Or(list(l)),
        Ex::Xor(a, b) => Ex::Xor(again(a), again(b)),
        Ex::Op(sign, a, b) => Ex::Op(sign, again(a), again(b)),
        Ex::Call(name, l) => Ex::Call(name, list(l)),
        plain @ (Ex::Bool(_) | Ex::Int(_) | Ex::Real(_) | Ex::Time(_)) => plain,
    }
}
