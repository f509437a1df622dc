//! Who gave a variable its value in a part of a scan: an action with its step, a control block, PRE or POST, a section
//! at a transition. Where several pieces of code may have written, each of them is told.

use g7_compile::tree::{Expr, Piece};
use g7_engine::{Addr, Code, NONE, StepId};
use g7_model::{Qualifier, Said, Span, say};

use crate::Why;
use crate::answer::{Cause, Fact};
use crate::look::{Look, Part};
use crate::owners::Moment;
use crate::parts::{Operands, Writing, inner, writings};
use crate::signal::{Pos, Signal};
use crate::trail::Trail;

/// Pieces of code that are told where several may have written.
const WRITERS: usize = 3;
/// Operands of an assignment whose changes are followed.
const OPERANDS: usize = 2;

impl Why<'_> {
    /// Who wrote a word in a part of a scan.
    pub(crate) fn writers(&self, addr: Addr, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let look = self.past.look(pos.scan);
        let Some(stage) = look.stages.get(pos.stage) else { return Vec::new() };
        let t = self.past.program.tables();
        let is_output = (t.outputs.start..t.outputs.end).contains(&addr.0);
        if stage.part == Part::Finish && look.fault && is_output {
            let said = say!("a fault stopped the program: the outputs took their safe values");
            return vec![Cause::new(said, Fact::Fault, self.time(pos), [])];
        }
        let mut found = Vec::new();
        if stage.part == Part::Finish {
            found.extend(self.by_code(say!("POST writes it"), t.post, addr, pos, trail));
            found.extend(self.by_code(say!("code of the system writes it"), t.tail, addr, pos, trail));
        }
        for action in stage.ran.iter().rev() {
            if found.len() < WRITERS {
                found.extend(self.by_action(*action, addr, pos, trail));
            }
        }
        found.extend(self.direct(addr, pos, &look, trail));
        if stage.part == Part::Finish && found.len() < WRITERS
            || found.is_empty() && stage.part != Part::Begin
        {
            found.extend(self.by_block(addr, pos, trail));
        }
        if stage.part == Part::Begin {
            found.extend(self.by_code(say!("PRE writes it"), t.pre, addr, pos, trail));
            found.extend(self.by_code(say!("code of the system writes it"), t.services, addr, pos, trail));
        }
        if found.is_empty() {
            found.extend(self.by_section(addr, pos));
        }
        if found.is_empty() {
            found.push(Cause::new(say!("the system keeps it"), Fact::Code, self.time(pos), []));
        }
        found.truncate(WRITERS);
        found
    }

    /// An output that follows one step.
    fn direct(&self, addr: Addr, pos: Pos, look: &Look, trail: &mut Trail) -> Option<Cause> {
        let p = self.past.program;
        let rows = (0..).map(StepId).zip(&p.tables().steps);
        let mut rows = rows.filter(|(_, row)| row.direct == addr && addr.0 != NONE);
        let (step, _) = rows.find(|(s, _)| look.changes(p, Signal::Step(*s), pos.stage))?;
        let on = look.after(pos.stage).is_active(step);
        let cause = self.acts(Qualifier::N, step, on, pos);
        Some(cause.because([self.event(Signal::Step(step), pos, true, trail)]))
    }

    /// The sentence about a continuous action that begins or ends to act.
    pub(crate) fn acts(&self, qualifier: Qualifier, step: StepId, on: bool, pos: Pos) -> Cause {
        let (qualifier, name) = (Said::foreign(qualifier.name()), self.names.step(step));
        let said = if on {
            say!("the action {qualifier} of step `{name}` acts on it")
        } else {
            say!("the action {qualifier} of step `{name}` no longer acts on it")
        };
        Cause::new(said, Fact::Code, self.time(pos), [self.names.symbols().step_place(step)])
    }

    /// The statements of a code that write a word.
    fn written(&self, code: Code, addr: Addr) -> Vec<Writing<'_>> {
        match self.compiled.pieces.get(code) {
            Some(Piece::Work(list)) => writings(list, addr),
            Some(Piece::Value(e)) => {
                let mut found = Vec::new();
                inner(e, addr, &mut found);
                found
            }
            None => Vec::new(),
        }
    }

    /// Code that runs in each scan: what it reads made the change.
    fn by_code(&self, said: Said, code: Code, addr: Addr, pos: Pos, trail: &mut Trail) -> Option<Cause> {
        let writings = self.written(code, addr);
        let first = writings.first()?;
        let cause = Cause::new(said, Fact::Code, self.time(pos), [first.at]);
        Some(cause.because(self.read_by(&writings, addr, pos, trail)))
    }

    /// The operands of assignments that changed last, in this scan or the one before.
    fn read_by(&self, writings: &[Writing<'_>], addr: Addr, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let mut operands = Operands::default();
        let reads = writings.iter().flat_map(|w| &w.reads);
        reads.for_each(|e: &&Expr| operands.add(self.compiled, e, 0));
        for watch in operands.edges.clone() {
            operands.signals.extend(self.seen_by(watch).signals);
        }
        operands.signals.sort_unstable();
        operands.signals.dedup();
        operands.signals.retain(|s| *s != Signal::Word(addr));
        let Some(change) = self.past.last_change(&operands.signals, pos).filter(|c| c.scan + 1 >= pos.scan)
        else {
            return Vec::new();
        };
        let look = self.past.look(change.scan);
        let moved = operands.signals.iter().filter(|s| look.changes(self.past.program, **s, change.stage));
        let moved: Vec<Signal> = moved.take(OPERANDS).copied().collect();
        moved.into_iter().map(|s| self.event(s, change, true, trail)).collect()
    }

    /// An action that ran, at the moment that made it run.
    fn by_action(&self, action: u32, addr: Addr, pos: Pos, trail: &mut Trail) -> Option<Cause> {
        let row = self.past.program.tables().actions.get(action as usize)?;
        let writings = self.written(row.body, addr);
        let first = writings.first()?;
        let places = [first.at, self.action_place(action)];
        let look = self.past.look(pos.scan);
        let moments = self.owners.moments(action);
        let fits = moments.iter().find(|m| self.fits(**m, pos, &look)).or(moments.first());
        let Some(moment) = fits else {
            let cause = Cause::new(say!("an action writes it"), Fact::Code, self.time(pos), places);
            return Some(cause);
        };
        let (said, causes) = self.at_moment(*moment, pos, &look, trail);
        let mut causes = causes;
        if matches!(moment, Moment::EachScan(_) | Moment::Block(_)) {
            let read = self.read_by(&writings, addr, pos, trail);
            if !read.is_empty() {
                causes.iter_mut().for_each(|c| {
                    c.aside = true;
                    c.causes.clear();
                });
                causes.splice(0..0, read);
            }
        }
        Some(Cause::new(said, Fact::Code, self.time(pos), places).because(causes))
    }

    /// The cleared transition of a pass that leads to a step or away from it.
    fn crossed(&self, step: StepId, leads: bool, pos: Pos, look: &Look) -> Option<u32> {
        let t = self.past.program.tables();
        let arcs = |rows: g7_engine::Rows| t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
        look.stages.get(pos.stage)?.cleared.iter().copied().find(|rank| {
            t.transitions.get(*rank as usize).is_some_and(|row| {
                let (end, more) = if leads { (row.to, row.more_to) } else { (row.from, row.more_from) };
                end == step || arcs(more).contains(&step)
            })
        })
    }

    /// True if a moment came in a part of a scan.
    fn fits(&self, moment: Moment, pos: Pos, look: &Look) -> bool {
        let p = self.past.program;
        let turned = |step, on| {
            look.changes(p, Signal::Step(step), pos.stage) && look.after(pos.stage).is_active(step) == on
        };
        match moment {
            Moment::Activation(step) => turned(step, true) || self.crossed(step, true, pos, look).is_some(),
            Moment::Deactivation(step) => {
                turned(step, false) || self.crossed(step, false, pos, look).is_some()
            }
            Moment::Event(step, code) => {
                let state = look.stages.get(pos.stage).and_then(|s| s.judged.as_ref());
                let holds = |state| self.compiled.condition(code).and_then(|e| self.parts.holds(p, e, state));
                look.before(pos.stage).is_active(step) && state.is_none_or(|s| holds(s) != Some(false))
            }
            Moment::Clearing(rank) => look.stages.get(pos.stage).is_some_and(|s| s.cleared.contains(&rank)),
            Moment::EachScan(step) => look.after(pos.stage).is_active(step),
            Moment::Block(_) => true,
        }
    }

    /// The sentence about a moment, and why it came.
    fn at_moment(&self, moment: Moment, pos: Pos, look: &Look, trail: &mut Trail) -> (Said, Vec<Cause>) {
        let p = self.past.program;
        let turn = |why: &Self, step: StepId, leads: bool, trail: &mut Trail| {
            if look.changes(p, Signal::Step(step), pos.stage) {
                return vec![why.event(Signal::Step(step), pos, true, trail)];
            }
            // It was left and entered at once, so its activity did not change.
            why.crossed(step, leads, pos, look)
                .map(|rank| why.clearing(rank, pos, true, trail))
                .into_iter()
                .collect()
        };
        match moment {
            Moment::Activation(step) => {
                let said = say!("an action on activation of step `{}` wrote it", self.names.step(step));
                (said, turn(self, step, true, trail))
            }
            Moment::Deactivation(step) => {
                let said = say!("an action on deactivation of step `{}` wrote it", self.names.step(step));
                (said, turn(self, step, false, trail))
            }
            Moment::Event(step, code) => {
                let said = say!("an action on event of step `{}` wrote it", self.names.step(step));
                (said, self.by_event(step, code, pos, look, trail))
            }
            Moment::Clearing(rank) => {
                let name = self.names.transition(rank);
                let said = say!("an action on clearing of the transition `{name}` wrote it");
                (said, vec![self.clearing(rank, pos, true, trail)])
            }
            Moment::EachScan(step) => {
                let said = say!("an action of each scan of step `{}` wrote it", self.names.step(step));
                (said, vec![self.standing(Signal::Step(step), pos, self.began(step, pos), trail)])
            }
            Moment::Block(block) => {
                let steps =
                    self.owners.inputs(block).iter().filter(|(s, _)| look.after(pos.stage).is_active(*s));
                let steps: Vec<StepId> = steps.map(|(s, _)| *s).take(OPERANDS).collect();
                let name = self.names.symbols().blocks.get(block as usize).map_or("", |b| &b.name);
                let said = match (name, steps.first()) {
                    ("", Some(step)) => say!("a body of step `{}` wrote it", self.names.step(*step)),
                    ("", None) => say!("an action writes it"),
                    (name, _) => say!("the action `{name}` wrote it"),
                };
                let causes = steps
                    .iter()
                    .map(|s| self.standing(Signal::Step(*s), pos, self.began(*s, pos), trail))
                    .collect();
                (said, causes)
            }
        }
    }

    /// True if a step changed in this scan.
    fn began(&self, step: StepId, pos: Pos) -> bool {
        self.past.last_change(&[Signal::Step(step)], pos).is_some_and(|c| c.scan == pos.scan)
    }

    /// Why an event came while its step was active.
    fn by_event(&self, step: StepId, code: Code, pos: Pos, look: &Look, trail: &mut Trail) -> Vec<Cause> {
        let before = self.earlier(pos).unwrap_or(pos);
        let mut causes = Vec::new();
        let state = look.stages.get(pos.stage).and_then(|s| s.judged.as_ref());
        if let Some((e, state)) = self.compiled.condition(code).zip(state) {
            let parts = self.decisive(e, state, before);
            causes.extend(parts.iter().map(|d| self.part(d, before, d.last, trail)));
        }
        causes.push(self.standing(Signal::Step(step), before, false, trail));
        causes
    }

    /// Code at a transition that writes a word.
    fn by_section(&self, addr: Addr, pos: Pos) -> Option<Cause> {
        let t = self.past.program.tables();
        let writes = |code: Code| self.written(code, addr).first().map(|w| w.at);
        let at_transition = (0..).zip(&t.transitions).find_map(|(rank, row)| match row.receptivity {
            g7_engine::Receptivity::Code(code) => Some((rank, writes(code)?)),
            _ => None,
        });
        if let Some((rank, place)) = at_transition {
            let said = say!("code at the transition `{}` writes it", self.names.transition(rank));
            return Some(Cause::new(said, Fact::Code, self.time(pos), [place]));
        }
        // Not known which piece ran: all that write it are named by their places.
        let places: Vec<Span> = t.actions.iter().filter_map(|a| writes(a.body)).take(WRITERS).collect();
        let said = say!("one of these actions wrote it");
        (!places.is_empty()).then(|| Cause::new(said, Fact::Code, self.time(pos), places))
    }
}
