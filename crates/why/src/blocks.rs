//! Why the control block of a variable changed its Q: which action began or ceased to act, which time was over
//! (SEMANTICS section 5). What the block gave is read from the run; here only the actions are found that explain it.

use g7_engine::{Addr, Contribution, INPUTS, StepId};
use g7_model::{Qualifier, Said, say};

use crate::Why;
use crate::answer::{Cause, Fact};
use crate::look::Part;
use crate::signal::{Pos, Signal};
use crate::trail::Trail;

/// Actions that are told where several began or ceased to act at once.
const ACTIONS: usize = 3;

/// Those make Q true when they come, those but when their time is over, and those give it for one scan.
const AT_ONCE: [Qualifier; 6] =
    [Qualifier::N, Qualifier::S, Qualifier::L, Qualifier::P, Qualifier::P1, Qualifier::SL];
const DELAYED: [Qualifier; 3] = [Qualifier::D, Qualifier::SD, Qualifier::DS];
const PULSES: [Qualifier; 3] = [Qualifier::P, Qualifier::P1, Qualifier::P0];
/// Those make Q false when they cease, and those when their time is over.
const ENDING: [Qualifier; 5] = [Qualifier::N, Qualifier::L, Qualifier::D, Qualifier::P, Qualifier::P1];
const LIMITED: [Qualifier; 2] = [Qualifier::L, Qualifier::SL];

/// An action on a variable, before and after a scan.
struct Input {
    step: StepId,
    row: Contribution,
    qualifier: Qualifier,
    was: bool,
    is: bool,
    /// The step became active within the scan.
    turned_on: bool,
    /// It became inactive within the scan.
    turned_off: bool,
}

impl Input {
    /// It began to act. A step that came and went within the scan gives its pulse alone.
    fn came(&self) -> bool {
        self.is && !self.was || self.turned_on && (self.is || self.qualifier == Qualifier::P1)
    }

    fn went(&self) -> bool {
        self.was && !self.is
    }

    fn is_of(&self, list: &[Qualifier]) -> bool {
        list.contains(&self.qualifier)
    }
}

impl Why<'_> {
    /// The actions that explain why a block wrote a variable at the end of a scan.
    pub(crate) fn by_block(&self, addr: Addr, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let t = self.past.program.tables();
        let blocks = (0..).zip(&t.blocks).filter(|(_, b)| b.output == addr);
        let blocks: Vec<u32> = blocks.map(|(i, _)| i).collect();
        let q = self.past.look(pos.scan).after(pos.stage).word(addr) != 0;
        let found: Vec<Cause> = blocks.iter().flat_map(|b| self.explained(*b, q, pos, trail)).collect();
        if found.is_empty() && !blocks.is_empty() {
            let said = say!("its actions, taken together, changed its value");
            return vec![Cause::new(said, Fact::Code, self.time(pos), [self.names.word_place(addr)])];
        }
        found
    }

    /// The moment behind which the conditions of a block are asked: the end of the evolution; where the block is
    /// written as its step is left, that pass.
    fn evolved(&self, pos: Pos) -> Pos {
        let look = self.past.look(pos.scan);
        let at_end = look.stages.get(pos.stage).is_some_and(|s| s.part == Part::Finish);
        if at_end { self.earlier(pos).unwrap_or(pos) } else { pos }
    }

    fn explained(&self, block: u32, q: bool, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let inputs = self.inputs(block, pos);
        let chosen: Vec<(&Input, bool)> = if q { rose(&inputs) } else { fell(&inputs) };
        let mut found = Vec::new();
        for (input, timed) in chosen.into_iter().take(ACTIONS) {
            found.push(if timed {
                self.over(input, q, pos, trail)
            } else {
                self.acting(input, q, pos, trail)
            });
        }
        if found.is_empty() {
            found.extend(self.gated(block, pos, trail));
        }
        found
    }

    /// The actions on a block.
    fn inputs(&self, block: u32, pos: Pos) -> Vec<Input> {
        let (p, look) = (self.past.program, self.past.look(pos.scan));
        let before = look.before(0);
        let now = look.after(self.evolved(pos).stage);
        let holds = |row: &Contribution, state| match self.compiled.condition(row.condition) {
            Some(e) => self.parts.holds(p, e, state).unwrap_or(false),
            None => true,
        };
        let of = |(step, row): &(StepId, Contribution)| {
            let input = INPUTS.get(row.input as usize)?;
            let turned = |on: bool| {
                (0..look.stages.len()).any(|stage| {
                    look.changes(p, Signal::Step(*step), stage) && look.after(stage).is_active(*step) == on
                })
            };
            Some(Input {
                step: *step,
                row: *row,
                qualifier: Qualifier::named(input)?,
                was: before.is_active(*step) && holds(row, before),
                is: now.is_active(*step) && holds(row, now),
                turned_on: turned(true),
                turned_off: turned(false),
            })
        };
        self.owners.inputs(block).iter().filter_map(of).collect()
    }

    /// The sentence about an action that began or ceased to act, and why: its step, or its condition.
    fn acting(&self, input: &Input, q: bool, pos: Pos, trail: &mut Trail) -> Cause {
        let on = if input.qualifier == Qualifier::R { !q } else { q };
        // P0 acts as its step is left.
        let cause = self.acts(input.qualifier, input.step, on, pos);
        let before = self.evolved(pos);
        let step = self.past.last_change(&[Signal::Step(input.step)], before);
        let look = self.past.look(pos.scan);
        let state = look.after(before.stage);
        let mut parts = Vec::new();
        if let Some(e) = self.compiled.condition(input.row.condition)
            && state.is_active(input.step)
        {
            parts = self.decisive(e, state, before);
        }
        let came = parts.iter().filter(|d| d.last).map(|d| d.since.pos()).max().flatten();
        let by_step = parts.is_empty() || step >= came;
        let mut causes: Vec<Cause> =
            parts.iter().map(|d| self.part(d, before, !by_step && d.last, trail)).collect();
        causes.push(match step {
            Some(step) => self.event(Signal::Step(input.step), step, by_step, trail),
            None => self.since_start(Signal::Step(input.step), by_step),
        });
        causes.sort_by_key(|c| c.aside);
        cause.because(causes)
    }

    /// The sentence about an action whose time was over.
    fn over(&self, input: &Input, q: bool, pos: Pos, trail: &mut Trail) -> Cause {
        let (qualifier, name) = (Said::foreign(input.qualifier.name()), self.names.step(input.step));
        let said = if input.is_of(&PULSES) {
            say!("the pulse of the action {qualifier} of step `{name}` was over")
        } else if q {
            say!("the delay of the action {qualifier} of step `{name}` was over")
        } else {
            say!("the time of the action {qualifier} of step `{name}` was over")
        };
        let place = self.names.symbols().step_place(input.step);
        let before = self.evolved(pos);
        let step = self.standing(Signal::Step(input.step), before, false, trail);
        Cause::new(said, Fact::Time, self.time(pos), [place]).because([step])
    }

    /// A condition that holds a block back, where it has one.
    fn gated(&self, block: u32, pos: Pos, trail: &mut Trail) -> Option<Cause> {
        let row = self.past.program.tables().blocks.get(block as usize)?;
        let e = self.compiled.condition(row.gate)?;
        let look = self.past.look(pos.scan);
        let before = self.evolved(pos);
        let parts = self.decisive(e, look.after(before.stage), before);
        let said = say!("the condition that masks it changed");
        let causes: Vec<Cause> = parts.iter().map(|d| self.part(d, before, d.last, trail)).collect();
        Some(Cause::new(said, Fact::Code, self.time(pos), [e.at]).because(causes))
    }
}

/// The actions that make Q true, each with true where a time did it.
fn rose(inputs: &[Input]) -> Vec<(&Input, bool)> {
    let now: Vec<(&Input, bool)> = inputs
        .iter()
        .filter(|i| i.came() && i.is_of(&AT_ONCE) || i.qualifier == Qualifier::P0 && i.turned_off)
        .map(|i| (i, false))
        .collect();
    if !now.is_empty() {
        return now;
    }
    let late: Vec<(&Input, bool)> = inputs.iter().filter(|i| i.is_of(&DELAYED)).map(|i| (i, true)).collect();
    let acting: Vec<(&Input, bool)> = late.iter().filter(|(i, _)| i.is).copied().collect();
    if !acting.is_empty() {
        return acting;
    }
    let freed: Vec<(&Input, bool)> =
        inputs.iter().filter(|i| i.qualifier == Qualifier::R && i.went()).map(|i| (i, false)).collect();
    if freed.is_empty() { late } else { freed }
}

/// The actions that make Q false.
fn fell(inputs: &[Input]) -> Vec<(&Input, bool)> {
    let reset: Vec<(&Input, bool)> =
        inputs.iter().filter(|i| i.qualifier == Qualifier::R && i.is).map(|i| (i, false)).collect();
    if !reset.is_empty() {
        return reset;
    }
    let ended = |i: &&Input| i.went() && i.is_of(&ENDING);
    let ended: Vec<(&Input, bool)> = inputs.iter().filter(ended).map(|i| (i, false)).collect();
    if !ended.is_empty() {
        return ended;
    }
    let over = |i: &&Input| i.is_of(&LIMITED) || i.is_of(&PULSES);
    let acting: Vec<(&Input, bool)> = inputs.iter().filter(|i| over(i) && i.is).map(|i| (i, true)).collect();
    if !acting.is_empty() {
        return acting;
    }
    inputs.iter().filter(over).map(|i| (i, true)).collect()
}
