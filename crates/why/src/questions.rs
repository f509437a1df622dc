//! The four questions: what a scan did, why a step is active, why a transition does not clear, why a variable has its
//! value.

use g7_engine::{Addr, State, StepId, enabled};
use g7_model::{Said, say};

use crate::answer::{Cause, Fact};
use crate::look::{Look, Part, Stage};
use crate::signal::{Pos, Signal};
use crate::text::at;
use crate::trail::Trail;
use crate::{Question, Why};

/// Most sentences of one kind in the answer about a scan.
const MANY: usize = 40;
/// Transitions that lead to a step, of which the answer about it tells.
const LEADING: usize = 2;

impl Why<'_> {
    pub(crate) fn answer(&self, question: Question, scan: usize) -> Cause {
        let end = self.past.end(scan);
        let trail = &mut Trail::whole();
        match question {
            Question::Scan => self.scan(scan),
            Question::Step(step) => self.step(step, end, trail),
            Question::Group(group) => self.standing(Signal::Group(group), end, true, trail),
            Question::Transition(rank) => self.transition(rank, scan, trail),
            Question::Variable(addr, words) => self.variable(addr, words, end, trail),
        }
    }

    /// Why a step is active; why it is not, with the enabled transitions that lead to it and do not clear.
    fn step(&self, step: StepId, end: Pos, trail: &mut Trail) -> Cause {
        let standing = self.standing(Signal::Step(step), end, true, trail);
        let look = self.past.look(end.scan);
        if look.after(end.stage).is_active(step) {
            return standing;
        }
        let (name, place) = (self.names.step(step), self.names.symbols().step_place(step));
        let said = say!("step `{name}` is not active at {}", at(self.time(end)));
        let mut cause =
            Cause::new(said, Fact::Step(step, false), self.time(end), [place]).because([standing]);
        if let Some((stage, state)) = judging(&look) {
            let enabled = |rank: &u32| self.preceding(*rank).iter().all(|s| state.is_active(*s));
            let leading = self.leading(step).into_iter().filter(enabled).filter(|r| !clears(&look, *r));
            for rank in leading.take(LEADING) {
                let waits = self.waits(rank, end.scan);
                let waits_for = self.waits_for(rank, Pos { scan: end.scan, stage }, state, trail);
                cause.causes.push(waits.because(waits_for));
            }
        }
        cause
    }

    /// The transitions of the text that lead to a step.
    fn leading(&self, step: StepId) -> Vec<u32> {
        let t = self.past.program.tables();
        let more = |rows: g7_engine::Rows| t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
        let rows = (0..).zip(&t.transitions);
        let rows = rows.filter(|(_, row)| row.to == step || more(row.more_to).contains(&step));
        rows.map(|(rank, _)| rank).filter(|rank| self.names.symbols().is_written(*rank)).collect()
    }

    /// The sentence about a transition that does not clear in a scan.
    fn waits(&self, rank: u32, scan: usize) -> Cause {
        let now = self.past.time(scan);
        let said = say!("the transition `{}` does not clear at {}", self.names.transition(rank), at(now));
        Cause::new(said, Fact::Waits(rank), now, [self.names.symbols().transition_place(rank)])
    }

    /// The last change of a variable, of whichever of its words changed last.
    fn variable(&self, addr: Addr, words: u32, end: Pos, trail: &mut Trail) -> Cause {
        let signals: Vec<Signal> = (0..words.max(1)).map(|i| Signal::Word(Addr(addr.0 + i))).collect();
        let Some(change) = self.past.last_change(&signals, end) else {
            return self.since_start(Signal::Word(addr), true);
        };
        let look = self.past.look(change.scan);
        let moved = signals.iter().find(|s| look.changes(self.past.program, **s, change.stage));
        self.event(moved.copied().unwrap_or(Signal::Word(addr)), change, true, trail)
    }

    /// Why a transition does not clear in a scan, or why it clears.
    fn transition(&self, rank: u32, scan: usize, trail: &mut Trail) -> Cause {
        let look = self.past.look(scan);
        if let Some(stage) = look.stages.iter().rposition(|s| s.cleared.contains(&rank)) {
            return self.clearing(rank, Pos { scan, stage }, true, trail);
        }
        let now = self.past.time(scan);
        let cause = self.waits(rank, scan);
        let Some((stage, state)) = judging(&look) else {
            let said = say!("a fault stopped the program: nothing clears");
            return cause.because([Cause::new(said, Fact::Fault, now, [])]);
        };
        let pos = Pos { scan, stage };
        cause.because(self.waits_for(rank, pos, state, trail))
    }

    /// The reasons that keep a transition from clearing in a pass.
    fn waits_for(&self, rank: u32, pos: Pos, state: &State, trail: &mut Trail) -> Vec<Cause> {
        let before = self.earlier(pos).unwrap_or(pos);
        let off: Vec<StepId> = self.preceding(rank).into_iter().filter(|s| !state.is_active(*s)).collect();
        let mut causes: Vec<Cause> =
            off.iter().map(|s| self.standing(Signal::Step(*s), before, true, trail)).collect();
        let row = self.past.program.tables().transitions.get(rank as usize);
        if row.is_some_and(|t| state.is_blocked(t.chart)) {
            let said = say!("its chart stands still: an order acts on it, or its period is not due");
            causes.push(Cause::new(said, Fact::Order, self.time(pos), []));
        }
        let receptivity = self.names.receptivity(rank);
        let false_one =
            receptivity.as_ref().filter(|e| self.parts.holds(self.past.program, e, state) == Some(false));
        if let Some(e) = false_one {
            let parts = self.decisive(e, state, before);
            causes.extend(parts.iter().map(|d| self.part(d, before, off.is_empty(), trail)));
        }
        if causes.is_empty() {
            let text = receptivity.as_ref().map_or_else(|| "TRUE".to_owned(), |e| self.names.expr(e));
            let place = self.names.symbols().transition_place(rank);
            let taken = self.taken(rank, pos);
            let said = match taken {
                Some(other) => say!(
                    "the transition `{}` has priority and cleared in its place",
                    self.names.transition(other)
                ),
                None => {
                    say!("it is enabled, and its receptivity `{text}` is TRUE: it clears in the next scan")
                }
            };
            causes.push(Cause::new(said, Fact::Order, self.time(pos), [place]));
        }
        causes
    }

    /// A transition that cleared in a pass and has a preceding step in common with this one.
    fn taken(&self, rank: u32, pos: Pos) -> Option<u32> {
        let mine = self.preceding(rank);
        let look = self.past.look(pos.scan);
        let mut cleared = look.stages.iter().flat_map(|s| &s.cleared).copied();
        cleared.find(|other| self.preceding(*other).iter().any(|s| mine.contains(s)))
    }

    /// The answer about a scan, part by part.
    fn scan(&self, scan: usize) -> Cause {
        let look = self.past.look(scan);
        let now = self.past.time(scan);
        let said = say!("scan {} at {}", scan + 1, at(now));
        let mut parts = Vec::new();
        for (stage, row) in look.stages.iter().enumerate() {
            let pos = Pos { scan, stage };
            let (said, mut causes) = match row.part {
                Part::Outside => (say!("before the scan"), Vec::new()),
                Part::Begin => (say!("as the scan begins"), Vec::new()),
                Part::Pass(number) => (say!("pass {number}"), self.judgements(&look, row, pos)),
                Part::Finish => (say!("at the end of the scan"), Vec::new()),
            };
            causes.extend(self.changes(&look, pos));
            if !causes.is_empty() {
                parts.push(Cause::new(said, Fact::Scan, now, []).because(causes));
            }
        }
        if look.fault {
            let said = say!("a fault stopped the program: the outputs took their safe values");
            parts.push(Cause::new(said, Fact::Fault, now, []));
        }
        let quiet = !parts.iter().any(|p| p.causes.iter().any(|c| !matches!(c.fact, Fact::Waits(_))));
        if quiet && !look.fault {
            parts.insert(0, Cause::new(say!("nothing changed in this scan"), Fact::Scan, now, []));
        }
        Cause::new(said, Fact::Scan, now, []).because(parts)
    }

    /// The transitions that were enabled as a pass judged them: those that cleared, and those that did not.
    fn judgements(&self, look: &Look, row: &Stage, pos: Pos) -> Vec<Cause> {
        let (p, now) = (self.past.program, self.time(pos));
        let mut ranks = Vec::new();
        let first = look.stages.get(pos.stage.saturating_sub(1)).map(|s| &s.after);
        if let Some(state) = first {
            enabled(p, state, |rank, _| ranks.push(rank)).ok();
        }
        let unlisted: Vec<u32> = row.cleared.iter().copied().filter(|r| !ranks.contains(r)).collect();
        ranks.extend(unlisted);
        ranks.retain(|r| self.names.symbols().is_written(*r));
        ranks.sort_unstable();
        ranks.sort_by_key(|r| !row.cleared.contains(r));
        ranks.truncate(MANY);
        let mut found = Vec::new();
        for rank in ranks {
            let name = self.names.transition(rank);
            let place = self.names.symbols().transition_place(rank);
            let mut trail = Trail::short(0);
            if row.cleared.contains(&rank) {
                let said = say!(
                    "the transition `{name}` is enabled and its receptivity is TRUE: it clears (rule 2)"
                );
                let parts = self.reasons(rank, row, pos, &mut trail);
                found.push(Cause::new(said, Fact::Cleared(rank), now, [place]).because(parts));
            } else {
                let said = say!("the transition `{name}` is enabled and does not clear");
                let state = row.judged.as_ref().unwrap_or(&row.after);
                let why = self.waits_for(rank, pos, state, &mut trail);
                found.push(Cause::new(said, Fact::Waits(rank), now, [place]).because(why));
            }
        }
        found
    }

    /// The parts that make the receptivity of a cleared transition TRUE.
    fn reasons(&self, rank: u32, row: &Stage, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let before = self.earlier(pos).unwrap_or(pos);
        let Some((e, state)) = self.names.receptivity(rank).zip(row.judged.as_ref()) else {
            return Vec::new();
        };
        self.decisive(&e, state, before).iter().map(|d| self.part(d, before, false, trail)).collect()
    }

    /// The steps and variables that a part of a scan changed, each with what did it.
    fn changes(&self, look: &Look, pos: Pos) -> Vec<Cause> {
        let (p, s) = (self.past.program, self.names.symbols());
        let steps = (0..s.steps()).map(StepId).filter(|id| s.is_listed(*id)).map(Signal::Step);
        let locals = p.tables().locals;
        let own = s
            .variables
            .iter()
            .filter(|v| v.ty.holds().is_some() && !(locals.start..locals.end).contains(&v.addr.0));
        // A text is told once, by the first of its words that changed.
        let words = own.filter_map(|v| {
            let mut words = (v.addr.0..v.addr.0.saturating_add(v.words())).map(|a| Signal::Word(Addr(a)));
            words.find(|signal| look.changes(p, *signal, pos.stage))
        });
        let mut signals: Vec<Signal> =
            steps.filter(|signal| look.changes(p, *signal, pos.stage)).chain(words).collect();
        let left = signals.len().saturating_sub(MANY);
        signals.truncate(MANY);
        let mut found: Vec<Cause> =
            signals.into_iter().map(|signal| self.event(signal, pos, true, &mut Trail::short(1))).collect();
        if left > 0 {
            let said: Said = say!("{left} more changes");
            found.push(Cause::new(said, Fact::Bound, self.time(pos), []));
        }
        found
    }
}

/// True if a transition clears in a scan.
fn clears(look: &Look, rank: u32) -> bool {
    look.stages.iter().any(|s| s.cleared.contains(&rank))
}

/// The last pass of a scan, and the state in which it judged the transitions.
fn judging(look: &Look) -> Option<(usize, &State)> {
    let stages = look.stages.iter().enumerate().rev();
    stages.filter_map(|(at, s)| Some((at, s.judged.as_ref()?))).next()
}
