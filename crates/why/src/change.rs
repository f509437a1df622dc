//! Why a signal changed: a step by a clearing, an order, an enclosure or a service; a macro-step by its steps; a timer
//! by its time; an input by itself. A clearing goes back to whichever came last, the step before it or the part of its
//! receptivity.

use g7_engine::{GroupId, NONE, Rows, Situation, StepId, WatchId};
use g7_model::{Nanos, Span, say};

use crate::Why;
use crate::answer::{Cause, Fact};
use crate::look::{Look, Part};
use crate::parts::steps_of;
use crate::reason::Decisive;
use crate::signal::{Pos, Signal};
use crate::text::{at, truth};
use crate::trail::{Event, Trail, Way};

/// Steps of a macro-step whose changes are told.
const STEPS: usize = 2;

impl Why<'_> {
    /// The sentence about a change that a moment brought, with its causes where they are followed.
    pub(crate) fn event(&self, signal: Signal, pos: Pos, follow: bool, trail: &mut Trail) -> Cause {
        let cause = self.told(signal, pos);
        self.followed(cause, (Event::Changed(signal), pos), follow, trail, |trail| {
            self.behind(signal, pos, trail)
        })
    }

    /// A sentence about an event with its causes, where they are followed and were not told before.
    fn followed(
        &self,
        mut cause: Cause,
        (event, pos): (Event, Pos),
        follow: bool,
        trail: &mut Trail,
        behind: impl FnOnce(&mut Trail) -> Vec<Cause>,
    ) -> Cause {
        match follow.then(|| trail.enter(event, pos)) {
            Some(Way::On) => {
                let causes = behind(trail);
                trail.leave();
                cause.because(causes)
            }
            Some(Way::Bound) => cause.because([self.bound(pos)]),
            None | Some(Way::Told | Way::Short) => {
                cause.aside = true;
                cause
            }
        }
    }

    fn bound(&self, pos: Pos) -> Cause {
        Cause::new(say!("the causes before this are not followed"), Fact::Bound, self.time(pos), [])
    }

    pub(crate) fn time(&self, pos: Pos) -> Nanos {
        self.past.time(pos.scan)
    }

    /// The bare sentence about a change.
    fn told(&self, signal: Signal, pos: Pos) -> Cause {
        let (p, look) = (self.past.program, self.past.look(pos.scan));
        let (now, after) = (self.time(pos), look.after(pos.stage));
        let then = at(now);
        let on = signal.of(p, after) != 0;
        let (said, fact, place) = match signal {
            Signal::Word(addr) => {
                let (name, value) = (self.names.word(addr), self.names.value(addr, after));
                let word = after.word(addr);
                let place = self.names.word_place(addr);
                if self.is_input(signal) {
                    (say!("the input `{name}` became {value} at {then}"), Fact::Input(addr, word), place)
                } else {
                    (say!("`{name}` became {value} at {then}"), Fact::Word(addr, word), place)
                }
            }
            Signal::Step(step) => {
                let name = self.names.step(step);
                let said = if on {
                    say!("step `{name}` became active at {then}")
                } else {
                    say!("step `{name}` became inactive at {then}")
                };
                (said, Fact::Step(step, on), self.names.symbols().step_place(step))
            }
            Signal::Group(group) => {
                let (name, place) = self.names.group(group);
                let said = if on {
                    say!("`{name}` became active at {then}")
                } else {
                    say!("`{name}` became inactive at {then}")
                };
                (said, Fact::Group(group, on), place)
            }
            Signal::Timer(watch) => {
                let (text, place) = self.names.timer_text(watch);
                (say!("`{text}` became {} at {then}", truth(on)), Fact::Part(on), place)
            }
        };
        Cause::new(said, fact, now, [place])
    }

    /// The sentence about a signal that never changed.
    pub(crate) fn since_start(&self, signal: Signal, follow: bool) -> Cause {
        let look = self.past.look(0);
        let on = signal.of(self.past.program, look.before(0)) != 0;
        let (said, place) = match signal {
            Signal::Word(addr) => {
                let (name, value) = (self.names.word(addr), self.names.value(addr, look.before(0)));
                let said = if self.is_input(signal) {
                    say!("the input `{name}` is {value} since the start")
                } else {
                    say!("`{name}` is {value} since the start")
                };
                (said, self.names.word_place(addr))
            }
            Signal::Step(step) => {
                let said = say!("step `{}` was never active", self.names.step(step));
                (said, self.names.symbols().step_place(step))
            }
            Signal::Group(group) => {
                let (name, place) = self.names.group(group);
                (say!("`{name}` was never active"), place)
            }
            Signal::Timer(watch) => {
                let (text, place) = self.names.timer_text(watch);
                (say!("`{text}` is {} since the start", truth(on)), place)
            }
        };
        let mut cause = Cause::new(said, Fact::Start, self.past.time(0), [place]);
        cause.aside = !follow;
        cause
    }

    pub(crate) fn is_input(&self, signal: Signal) -> bool {
        let rows = self.past.program.tables().inputs;
        matches!(signal, Signal::Word(addr) if (rows.start..rows.end).contains(&addr.0))
    }

    /// The causes of a change.
    fn behind(&self, signal: Signal, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let look = self.past.look(pos.scan);
        let part = look.stages.get(pos.stage).map(|s| s.part);
        if part == Some(Part::Outside) {
            let said = say!("it came from outside: set, forced or restarted");
            return vec![Cause::new(said, Fact::Outside, self.time(pos), [])];
        }
        match signal {
            Signal::Word(_) if self.is_input(signal) && part == Some(Part::Begin) => Vec::new(),
            Signal::Word(addr) => self.writers(addr, pos, trail),
            Signal::Step(step) => vec![self.mover(step, pos, &look, trail)],
            Signal::Group(group) => self.of_group(group, pos, &look, trail),
            Signal::Timer(watch) => self.of_timer(watch, pos, trail),
        }
    }

    /// The steps that made a macro-step active, or that left it last.
    fn of_group(&self, group: GroupId, pos: Pos, look: &Look, trail: &mut Trail) -> Vec<Cause> {
        let p = self.past.program;
        let turned: Vec<StepId> = steps_of(p, group)
            .filter(|s| self.names.symbols().is_listed(*s) && look.changes(p, Signal::Step(*s), pos.stage))
            .take(STEPS)
            .collect();
        turned.into_iter().map(|s| self.event(Signal::Step(s), pos, true, trail)).collect()
    }

    /// A timer follows its operand at once, or after a time.
    fn of_timer(&self, watch: WatchId, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let operands = self.seen_by(watch).signals;
        let change = self.past.last_change(&operands, pos);
        let at_once = change.is_some_and(|c| c.scan == pos.scan);
        let standing: Vec<Cause> = match change {
            Some(change) => {
                let look = self.past.look(change.scan);
                let moved = operands.iter().filter(|s| look.changes(self.past.program, **s, change.stage));
                moved.take(STEPS).map(|s| self.event(*s, change, at_once, trail)).collect()
            }
            None => operands.iter().take(STEPS).map(|s| self.since_start(*s, false)).collect(),
        };
        if at_once {
            return standing;
        }
        let (text, place) = self.names.timer_text(watch);
        let said = say!("the time of `{text}` was over at {}", at(self.time(pos)));
        let mut standing = standing;
        standing.iter_mut().for_each(|c| c.aside = true);
        vec![Cause::new(said, Fact::Time, self.time(pos), [place]).because(standing)]
    }

    /// The clearing, order, enclosure or service that activated or deactivated a step.
    fn mover(&self, step: StepId, pos: Pos, look: &Look, trail: &mut Trail) -> Cause {
        let p = self.past.program;
        let t = p.tables();
        let on = look.after(pos.stage).is_active(step);
        let arcs = |rows: Rows| t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
        let stage = look.stages.get(pos.stage);
        let cleared = stage.map_or(&[][..], |s| &s.cleared);
        let moves = |rank: &&u32| {
            let Some(row) = t.transitions.get(**rank as usize) else { return false };
            if on {
                row.to == step || arcs(row.more_to).contains(&step)
            } else {
                row.from == step || arcs(row.more_from).contains(&step) || t.drops.contains(&(**rank, step))
            }
        };
        if let Some(rank) = cleared.iter().find(moves) {
            return self.clearing(*rank, pos, true, trail);
        }
        if stage.map(|s| s.part) == Some(Part::Begin) {
            let place = [self.names.symbols().step_place(step)];
            let (said, fact) = if look.first && on && t.initial.contains(&step) {
                (say!("it is an initial step (rule 1)"), Fact::Start)
            } else {
                (say!("a service of the system changed the situation"), Fact::Order)
            };
            return Cause::new(said, fact, self.time(pos), place);
        }
        let chart = t.steps.get(step.0 as usize).map(|s| s.chart);
        let imposes = |s: &Situation| match s {
            Situation::Steps(rows) => arcs(*rows).contains(&step) == on,
            Situation::Current => false,
        };
        let forces = t.orders.iter().find(|o| {
            Some(o.chart) == chart && imposes(&o.situation) && look.before(pos.stage).is_active(o.step)
        });
        if let Some(order) = forces {
            let name = self.names.step(order.step);
            let said = say!("the forcing order of step `{name}` imposes the situation");
            let cause =
                Cause::new(said, Fact::Order, self.time(pos), [self.names.symbols().step_place(order.step)]);
            let gave =
                self.earlier(pos).map(|before| self.standing(Signal::Step(order.step), before, true, trail));
            return cause.because(gave);
        }
        self.enclosing(step, on, pos, look, trail)
    }

    /// The enclosing step that brought a step along.
    fn enclosing(&self, step: StepId, on: bool, pos: Pos, look: &Look, trail: &mut Trail) -> Cause {
        let p = self.past.program;
        let t = p.tables();
        let brings = |outer: &StepId| {
            let row = t.steps.get(outer.0 as usize).and_then(|s| t.extras.get(s.extra as usize));
            let Some(extra) = row.filter(|_| look.changes(p, Signal::Step(*outer), pos.stage)) else {
                return false;
            };
            if on {
                t.arcs
                    .get(extra.links.start as usize..extra.links.end as usize)
                    .unwrap_or(&[])
                    .contains(&step)
            } else {
                let groups = t.group_lists.get(extra.encloses.start as usize..extra.encloses.end as usize);
                groups.unwrap_or(&[]).iter().any(|g| steps_of(p, *g).any(|s| s == step))
            }
        };
        let Some(outer) = (0..t.steps.len() as u32).map(StepId).find(brings) else {
            let said = say!("the rules of the profile changed the situation");
            return Cause::new(said, Fact::Order, self.time(pos), []);
        };
        let name = self.names.step(outer);
        let said = if on {
            say!("the enclosing step `{name}` activates it")
        } else {
            say!("the enclosing step `{name}` no longer encloses it")
        };
        let cause = Cause::new(said, Fact::Order, self.time(pos), [self.names.symbols().step_place(outer)]);
        cause.because([self.event(Signal::Step(outer), pos, true, trail)])
    }

    /// A transition that cleared, and what made it clear last: a step before it, or its receptivity.
    pub(crate) fn clearing(&self, rank: u32, pos: Pos, follow: bool, trail: &mut Trail) -> Cause {
        let then = at(self.time(pos));
        let said = say!("the transition `{}` cleared at {then}", self.names.transition(rank));
        let place = self.names.symbols().transition_place(rank);
        let cause = Cause::new(said, Fact::Cleared(rank), self.time(pos), [place]);
        self.followed(cause, (Event::Cleared(rank), pos), follow, trail, |trail| {
            self.behind_clearing(rank, pos, trail)
        })
    }

    fn behind_clearing(&self, rank: u32, pos: Pos, trail: &mut Trail) -> Vec<Cause> {
        let look = self.past.look(pos.scan);
        let before = self.earlier(pos).unwrap_or(pos);
        let receptivity = self.names.receptivity(rank);
        let state = look.stages.get(pos.stage).and_then(|s| s.judged.as_ref());
        let parts: Vec<Decisive<'_>> = match (&receptivity, state) {
            (Some(e), Some(state)) => self.decisive(e, state, before),
            _ => Vec::new(),
        };
        let steps: Vec<(StepId, Option<Pos>)> = self
            .preceding(rank)
            .into_iter()
            .map(|s| (s, self.past.last_change(&[Signal::Step(s)], before)))
            .collect();
        // The initial situation precedes what the first scan reads (rule 1).
        let later = steps.iter().map(|(_, pos)| pos.filter(|pos| !self.is_begin(*pos)));
        let enabled = later.max().flatten();
        let came = parts.iter().filter(|d| d.last).map(|d| d.since.pos()).max().flatten();
        // A time that is over is later than what happened as the scan began.
        let by_step = !steps.is_empty() && (parts.is_empty() || enabled >= came && enabled.is_some());
        let mut causes: Vec<Cause> = Vec::new();
        for d in &parts {
            causes.push(self.part(d, before, !by_step && d.last, trail));
        }
        for (step, since) in &steps {
            let last = by_step && since.filter(|pos| !self.is_begin(*pos)) == enabled;
            causes.push(match since {
                Some(since) => self.event(Signal::Step(*step), *since, last, trail),
                None => self.since_start(Signal::Step(*step), last),
            });
        }
        // First what is followed; a step that its own receptivity reads is told once.
        causes.sort_by_key(|c| c.aside);
        let mut told: Vec<(Fact, Nanos)> = Vec::new();
        causes.retain(|c| {
            let known = told.contains(&(c.fact, c.now));
            told.push((c.fact, c.now));
            !(known && c.aside && matches!(c.fact, Fact::Step(..)))
        });
        causes
    }

    /// True for the moment at which a run begins with its initial situation.
    fn is_begin(&self, pos: Pos) -> bool {
        let look = self.past.look(pos.scan);
        look.first && look.stages.get(pos.stage).is_some_and(|s| s.part == Part::Begin)
    }

    /// The steps that precede a transition.
    pub(crate) fn preceding(&self, rank: u32) -> Vec<StepId> {
        let t = self.past.program.tables();
        let Some(row) = t.transitions.get(rank as usize) else { return Vec::new() };
        let more = t.arcs.get(row.more_from.start as usize..row.more_from.end as usize).unwrap_or(&[]);
        let first = (row.from.0 != NONE).then_some(row.from);
        first.into_iter().chain(more.iter().copied()).collect()
    }

    /// The place of an action (rank), if a line of the text stands for it.
    pub(crate) fn action_place(&self, action: u32) -> Span {
        self.names
            .symbols()
            .actions
            .get(action as usize)
            .filter(|a| !a.hidden)
            .map(|a| a.at)
            .unwrap_or_default()
    }
}
