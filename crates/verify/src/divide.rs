//! A chart that consists of parts without influence on one another: the search need not combine their
//! states.
//!
//! ```text
//! equations -> divide -> Division -> parts.rs: one search for each part, all other inputs at rest
//! ```
//!
//! Memories of the equations (steps, variables, timers, ...) that a statement reads belong together with
//! the one that it writes; so do those that one condition of a question or assumption reads. What is left
//! apart evolves by itself: its content behind a scan follows from its content before it, its own inputs
//! and the time since. So all that one part can do is seen while the inputs of the others keep their
//! initial values, in runs of the whole chart.
//!
//! That needs more than separate memories, and the chart is not divided where it is not sure:
//!
//! - A fault stops all parts. With all inputs at rest, the chart must come to a state that a further scan
//!   does not change, without a fault and with all assumptions kept. Then a fault that is met in the
//!   search of a part is its own.
//! - Under search for stability a pass that one part needs is made by all. It must change nothing in a
//!   part that has come to rest: there must be no edge, no timer, and no receptivity or condition that writes.
//! - Where one part has no scan without a fault, or none that the assumptions allow, no part goes on. What a
//!   part can always do, all do only if that is excluded (`parts.rs`).
//! - Loops of code share the count of their rounds, and limits count the steps of all charts.

use std::collections::{BTreeMap, HashMap};

use g7_engine::{Addr, Op, Receptivity, StepId, Tables, scan};
use g7_equations::{Class, Equations, Expr, MemoryId, Options, Stmt, What, equations};

use crate::asked::Asking;
use crate::explore::Move;
use crate::look::{allowed, sides};
use crate::model::Model;
use crate::question::{Claim, Query, Question};
use crate::world::World;

/// Scans within which a chart must come to rest.
const REST: usize = 1000;

/// The parts that answer a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Who {
    /// This part alone.
    Part(usize),
    /// The claim holds if it holds for each part.
    Each,
    /// The claim holds if it holds for some part. If it does not, nothing is known.
    Some,
    /// It is not known.
    Nobody,
}

/// The parts of a chart, at least two.
#[derive(Debug)]
pub(crate) struct Division {
    /// For each part the places of its inputs, ascending.
    pub(crate) inputs: Vec<Vec<usize>>,
    /// For each question, in the order in which they were given.
    pub(crate) who: Vec<Who>,
}

/// Divides a chart about which these questions are asked.
pub(crate) fn divide(model: &Model<'_>, questions: &[&Question]) -> Option<Division> {
    let p = &model.compiled.program;
    if model.plant.is_some() || !is_simple(p.tables()) || !comes_to_rest(model) {
        return None;
    }
    let e = equations(model.compiled, Options { conflicts: true, runs: true, ..Options::default() });
    let mut ties = Ties { e: &e, root: (0..e.memories.len() as u32).collect(), simple: true };
    for section in e.sections() {
        ties.list(&section.body, &mut Vec::new());
    }
    let means = e.by_meaning();
    let inputs = inputs_of(model, &means);
    ties.readers(&Asking::new(p, model.codes()), &means, &inputs);
    for q in &model.assume {
        ties.conditions(&[*q]);
    }
    for q in questions {
        ties.conditions(&conditions(&q.claim));
    }
    if !ties.simple {
        return None;
    }
    let parts = ties.parts();
    let count = parts.values().max()? + 1;
    if count < 2 {
        return None;
    }
    let mut places = vec![Vec::new(); count];
    for (place, input) in inputs.iter().enumerate() {
        let part = input.and_then(|m| parts.get(&ties.find(m)));
        part.and_then(|k| places.get_mut(*k)).into_iter().for_each(|list| list.push(place));
    }
    let mut who_of = |claim: &Claim| {
        let read = ties.conditions(&conditions(claim));
        let part = |m: MemoryId| parts.get(&ties.find(m)).copied();
        who(model, claim, &means, part, read)
    };
    let who = questions.iter().map(|q| who_of(&q.claim)).collect();
    Some(Division { inputs: places, who })
}

/// True if no table joins all charts, and a pass more changes nothing in what has come to rest.
fn is_simple(t: &Tables) -> bool {
    let writes = |op: &Op| {
        matches!(
            op,
            Op::Store(_)
                | Op::StoreAt { .. }
                | Op::StoreText { .. }
                | Op::Text { .. }
                | Op::ToText { .. }
                | Op::Fb(..)
                | Op::Random(_)
                | Op::Service(_)
        )
    };
    let judges = t.transitions.iter().filter_map(|tr| match tr.receptivity {
        Receptivity::Code(code) => Some(code),
        _ => None,
    });
    // Code that runs in each pass. A pass counts as one without a change even where such code writes a variable.
    let asked = judges.chain(t.events.iter().map(|e| e.event)).chain(t.actions.iter().map(|a| a.condition));
    let mut codes = asked.filter_map(|c| t.code.get(c.start as usize..c.end as usize)).flatten();
    t.counts.is_none()
        && t.limits.is_none()
        && (!t.rules.stable || t.watches.is_empty() && !codes.any(writes))
}

/// True if the chart comes to rest while all inputs keep their initial values.
pub(crate) fn comes_to_rest(model: &Model<'_>) -> bool {
    let p = &model.compiled.program;
    let (mut world, mut before, mut image) = (World::new(model), Vec::new(), Vec::new());
    let inputs: Vec<u64> = model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0)).collect();
    for k in 0..REST {
        let m = Move { inputs: inputs.clone(), wait: if k == 0 { 0 } else { model.period } };
        let now = world.charts.now().saturating_add(m.wait);
        if !model.assume.is_empty() && !allowed(model, &mut world.clone(), &m, now) {
            return false;
        }
        let Ok(report) = scan(p, &mut world.charts, &m.inputs, now) else { return false };
        world.image(&mut image);
        if image == before && report.cleared == 0 {
            return true;
        }
        std::mem::swap(&mut image, &mut before);
    }
    false
}

/// For each word of the inputs, its memory.
fn inputs_of(model: &Model<'_>, means: &HashMap<What, MemoryId>) -> Vec<Option<MemoryId>> {
    let first = model.compiled.program.tables().inputs.start;
    let mut memory = None;
    let each = (0..model.inputs.len() as u32).map(|place| {
        // Further words of a table or a text belong to the memory before them.
        memory = means.get(&What::Variable(Addr(first + place))).copied().or(memory);
        memory
    });
    each.collect()
}

/// The conditions of a claim.
fn conditions(claim: &Claim) -> Vec<Query> {
    match claim {
        Claim::Always(q) | Claim::Never(q) | Claim::Reachable(q) => vec![*q],
        Claim::AtMost(_, list) => list.clone(),
        Claim::Within { cause, effect, .. } | Claim::LeadsTo { cause, effect } => vec![*cause, *effect],
        Claim::Until { from, to, holds } => vec![*from, *to, *holds],
        Claim::Between { from, to, never } => vec![*from, *to, *never],
        _ => Vec::new(),
    }
}

/// The parts that answer a claim.
fn who(
    model: &Model<'_>,
    claim: &Claim,
    means: &HashMap<What, MemoryId>,
    part: impl Fn(MemoryId) -> Option<usize>,
    read: Option<MemoryId>,
) -> Who {
    let by = |m: Option<MemoryId>| m.and_then(&part).map_or(Who::Nobody, Who::Part);
    let of = |what: What| by(means.get(&what).copied());
    match claim {
        Claim::Active(step) => of(What::Step(*step)),
        Claim::Clears(rank) => {
            let (from, to) = sides(model.compiled.program.tables(), *rank);
            from.iter().chain(&to).next().map_or(Who::Nobody, |s| of(What::Step(StepId(*s))))
        }
        Claim::Runs(rank) => of(What::Ran(*rank)),
        Claim::On(addr) | Claim::Asked(addr) => of(What::Variable(*addr)),
        Claim::NoConflict
        | Claim::NoUnsafe
        | Claim::NoInstability
        | Claim::NoOpposedWrites
        | Claim::NoOpposedOrders
        | Claim::NoFault => Who::Each,
        // A part that always goes on keeps the chart from coming to an end.
        Claim::NoDeadlock => Who::Some,
        // All that its conditions read is in one part.
        _ => by(read),
    }
}

/// Memories that belong together.
struct Ties<'e> {
    e: &'e Equations,
    /// For each memory another one of its part, or itself.
    root: Vec<u32>,
    simple: bool,
}

impl Ties<'_> {
    fn find(&self, m: MemoryId) -> u32 {
        let mut at = m.0;
        while let Some(up) = self.root.get(at as usize).copied().filter(|up| *up != at) {
            at = up;
        }
        at
    }

    fn tie(&mut self, a: MemoryId, b: MemoryId) {
        let (a, b) = (self.find(a), self.find(b));
        // The lesser one stays, and the path is made short for what was asked.
        if let Some(up) = self.root.get_mut(a.max(b) as usize) {
            *up = a.min(b);
        }
    }

    fn tie_all(&mut self, list: &[MemoryId]) {
        if let Some((first, rest)) = list.split_first() {
            rest.iter().for_each(|m| self.tie(*first, *m));
        }
    }

    fn list(&mut self, body: &[Stmt], under: &mut Vec<MemoryId>) {
        for s in body {
            match s {
                Stmt::Set(m, value) => self.set(*m, &[value], under),
                Stmt::SetElement(m, index, value) => self.set(*m, &[index, value], under),
                Stmt::If(condition, then, other) => {
                    let depth = under.len();
                    self.reads(condition, under);
                    self.list(then, under);
                    self.list(other, under);
                    under.truncate(depth);
                }
                Stmt::Call(_, memories) => {
                    let all: Vec<MemoryId> = memories.iter().chain(under.iter()).copied().collect();
                    self.tie_all(&all);
                }
                Stmt::Loop(_) | Stmt::Exit => self.simple = false,
                Stmt::Fault(..) => {
                    let all = under.clone();
                    self.tie_all(&all);
                }
                Stmt::About(_) => {}
            }
        }
    }

    fn set(&mut self, m: MemoryId, values: &[&Expr], under: &[MemoryId]) {
        match self.e.memory(m).map(|m| m.what) {
            // That some part has changed makes a pass for all.
            Some(What::Changed | What::Opening | What::Started) => return,
            Some(What::Work) => self.simple = false,
            _ => {}
        }
        let mut all = Vec::new();
        values.iter().for_each(|v| self.reads(v, &mut all));
        all.extend_from_slice(under);
        if self.e.memory(m).is_some_and(|m| m.what == What::Stepped) {
            // Without a service, the start alone changes steps before the evolution, in all parts.
            self.simple &= all.is_empty();
            return;
        }
        all.push(m);
        self.tie_all(&all);
    }

    /// Appends the memories that an expression reads and that may differ from run to run.
    fn reads(&mut self, e: &Expr, into: &mut Vec<MemoryId>) {
        let (equations, mut simple) = (self.e, self.simple);
        e.visit(&mut |e| {
            let (Expr::Read(m) | Expr::Element(m, _)) = e else { return };
            let Some(memory) = equations.memory(*m) else { return };
            match memory.what {
                // Code that runs once a scan comes to each part in the same pass.
                What::Dt | What::Started | What::Opening | What::Stepped => {}
                What::Changed | What::Work => simple = false,
                _ if memory.class == Class::Constant => {}
                _ => into.push(*m),
            }
        });
        self.simple = simple;
    }

    /// Ties what conditions read together; gives one of these memories.
    fn conditions(&mut self, list: &[Query]) -> Option<MemoryId> {
        let mut all = Vec::new();
        for (before, value) in list.iter().filter_map(|q| self.e.questions.get(q.0 as usize)) {
            self.list(before, &mut Vec::new());
            self.reads(value, &mut all);
        }
        self.tie_all(&all);
        all.first().copied()
    }

    /// Ties steps and inputs as the search for inputs that matter does.
    fn readers(&mut self, asking: &Asking, means: &HashMap<What, MemoryId>, inputs: &[Option<MemoryId>]) {
        asking.each(|steps, read| {
            let steps = steps.filter_map(|s| means.get(&What::Step(StepId(s))).copied());
            let read = read.filter_map(|i| inputs.get(i).copied().flatten());
            let all: Vec<MemoryId> = steps.chain(read).collect();
            self.tie_all(&all);
        });
    }

    /// The number of the part of each root. All that has to do with no step is one part.
    fn parts(&self) -> BTreeMap<u32, usize> {
        let mut parts = BTreeMap::new();
        let all = || (0u32..).map(MemoryId).zip(&self.e.memories);
        for (m, _) in all().filter(|(_, m)| matches!(m.what, What::Step(_))) {
            let next = parts.len();
            parts.entry(self.find(m)).or_insert(next);
        }
        let rest = parts.len();
        for (m, memory) in all() {
            if matches!(memory.class, Class::Input | Class::Output | Class::Kept)
                && !matches!(
                    memory.what,
                    What::Dt | What::Started | What::Opening | What::Changed | What::Stepped
                )
            {
                parts.entry(self.find(m)).or_insert(rest);
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::{Who, divide};
    use crate::{Model, ask};

    /// The number of parts, and for each of the author's questions the part that answers it.
    fn parts(text: &str) -> Option<(usize, Vec<Who>)> {
        let (document, problems) = g7_syntax::parse(text, Default::default());
        assert!(problems.is_empty(), "{problems:?}");
        let (asked, problems) = ask(&document, None);
        let asked = asked.unwrap_or_else(|| panic!("{problems:?}"));
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let mine: Vec<_> = asked.questions.iter().filter(|q| q.claim.is_own()).collect();
        divide(&model, &mine).map(|d| (d.inputs.len(), d.who))
    }

    const APART: &str = "input a, b : BOOL\noutput q, r : BOOL\n\
        chart G { initial step 1 step 2 { N q } 1 -> 2 when a 2 -> 1 when not a }\n\
        chart H { initial step 11 step 12 { N r } 11 -> 12 when WHEN 12 -> 11 when not b }\n";

    fn chart(profile: &str, when: &str, more: &str) -> String {
        format!("profile {profile}\n{}{more}", APART.replace("WHEN", when))
    }

    #[test]
    fn charts_without_influence_are_parts() {
        for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
            let found = parts(&chart(profile, "b", "prove never X2 and q\nprove never X12\n"));
            assert_eq!(found, Some((2, vec![Who::Part(0), Who::Part(1)])), "{profile}");
        }
    }

    #[test]
    fn what_reads_the_other_is_no_part() {
        for when in ["b and X2", "b and q", "b and not a"] {
            assert_eq!(parts(&chart("iec60848", when, "")), None, "{when}");
        }
        assert_eq!(parts(&chart("iec60848", "b", "prove never X2 and X12\n")), None);
        assert_eq!(parts(&chart("iec60848", "b", "assume not (a and b)\n")), None);
        // All inputs at rest do not keep it.
        assert_eq!(parts(&chart("iec60848", "b", "assume b\n")), None);
        assert!(parts(&chart("iec60848", "b", "assume not a\n")).is_some());
    }

    #[test]
    fn an_edge_under_search_for_stability_keeps_a_chart_whole() {
        // A pass that the one chart needs ends the edge on which the other waits.
        assert_eq!(parts(&chart("iec60848", "not ↑b and b", "")), None);
        assert!(parts(&chart("iec60848", "b", "")).is_some());
        assert!(parts(&chart("iec61131", "not ↑b and b", "")).is_some());
    }

    #[test]
    fn pulses_of_the_start_keep_nothing_together_but_those_of_a_service_do() {
        let pulses = |profile: &str, pre: &str| {
            let text = chart(profile, "b", "").replace("{ N q }", "{ P1 q }").replace("{ N r }", "{ P0 r }");
            parts(&text.replacen("chart G", &format!("{pre}\nchart G"), 1)).map(|(count, _)| count)
        };
        assert_eq!(pulses("iec61131", ""), Some(2));
        assert_eq!(pulses("unity", ""), Some(2));
        assert_eq!(pulses("unity", "pre { IF a THEN INITCHART(G); END_IF }"), None);
    }

    #[test]
    fn a_chart_that_does_not_come_to_rest_stays_whole() {
        assert_eq!(parts(&chart("iec61131", "true", "").replace("not b", "true")), None);
    }
}
