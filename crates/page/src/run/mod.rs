//! A chart at work: on the bench, in virtual time, watched by a page.
//!
//! ```text
//! start -> Run (rig::Bench, host::Runner, Recording) -> frame: what changed
//!            \-> past: back in time    lanes: chronogram    swap: on-line change
//! ```
//!
//! What must hold: time moves only by messages; a frame says no more than what
//! differs from the frame before; every scan is recorded.

mod frame;
mod lanes;
mod past;
mod start;
mod swap;

use std::collections::BTreeSet;
use std::sync::Arc;

use g7_engine::StepId;
use g7_host::{Kind, Recording, Runner, Start as Restart, Value};
use g7_model::Document;
use g7_rig::{Activity, Bench, Conflicts, Item, Role, values};

use crate::positions::Positions;
pub(crate) use frame::Frame;
use frame::Sent;
pub(crate) use lanes::Form;
use past::{Event, Past};
use start::Places;
pub(crate) use start::{Start, start};

/// Most scans that one message makes.
const SCANS: u32 = 20_000;
/// Most changes kept of a signal.
const KEPT: usize = 20_000;
/// Most changes kept of all signals together.
const KEPT_IN_ALL: usize = 2_000_000;

/// A recording of all signals of a bench, in bounded memory.
fn recording(bench: &Bench) -> Recording {
    let signals = bench.signals();
    let limit = (KEPT_IN_ALL / signals.len().max(1)).clamp(100, KEPT);
    Recording::new(signals).with_limit(limit)
}

/// A run.
pub(crate) struct Run {
    pub(crate) name: String,
    /// The file that it was started from.
    pub(crate) file: String,
    bench: Bench,
    /// The text it was compiled from.
    document: Arc<Document>,
    text: Arc<str>,
    positions: Arc<Positions>,
    /// As it was asked for.
    wish: Start,
    places: Places,
    runner: Runner,
    past: Past,
    /// An earlier scan that is looked at: the run as it stood, its number, its instant.
    viewed: Option<Viewed>,
    /// Virtual time asked for, nanoseconds.
    clock: i64,
    /// Time of the latest scan, nanoseconds.
    now: i64,
    recording: Recording,
    conflicts: Conflicts,
    notes: Vec<String>,
    /// Transitions cleared since the frame before, by index.
    cleared: BTreeSet<u32>,
    /// Steps and transitions at which a run stops.
    breaks: Breaks,
    /// Where it did.
    stopped: Option<String>,
    /// More time was asked for than could be run.
    late: bool,
    sent: Sent,
}

/// A scan of the past.
struct Viewed {
    runner: Runner,
    scans: u64,
    now: i64,
}

/// Where a run stops: indices of steps and transitions.
#[derive(Debug, Default)]
struct Breaks {
    steps: BTreeSet<u32>,
    transitions: BTreeSet<u32>,
}

impl Run {
    fn item(&self, signal: usize) -> Result<&Item, String> {
        self.bench.items.get(signal).ok_or_else(|| "there is no such signal".to_owned())
    }

    /// Moves the virtual time on, scan by scan, up to a stop.
    pub(crate) fn advance(&mut self, ms: f64, most: Option<u32>) -> Result<(), String> {
        self.only_now()?;
        let step = if ms.is_finite() { (ms.clamp(0.0, 1e12) * 1e6) as i64 } else { 0 };
        self.clock = self.clock.max(self.now).saturating_add(step);
        self.late = false;
        let most = most.unwrap_or(SCANS).min(SCANS);
        let mut made = 0;
        while self.runner.due() <= self.clock {
            if made >= most {
                (self.clock, self.late) = (self.now, true);
                break;
            }
            made += 1;
            if !self.scan() {
                self.clock = self.now;
                break;
            }
        }
        Ok(())
    }

    /// One scan, asked for by itself.
    pub(crate) fn one_scan(&mut self) -> Result<(), String> {
        self.only_now()?;
        self.scan();
        self.clock = self.now;
        Ok(())
    }

    /// Refuses while an earlier scan is looked at.
    fn only_now(&self) -> Result<(), String> {
        match self.viewed {
            Some(_) => Err("this is the past: come back to now, or go on from here".to_owned()),
            None => Ok(()),
        }
    }

    /// One scan; whether the run goes on behind it.
    fn scan(&mut self) -> bool {
        if self.runner.halt().is_some() {
            return false;
        }
        let before = (!self.breaks.steps.is_empty()).then(|| self.active());
        self.now = self.runner.due();
        self.clock = self.clock.max(self.now);
        // One that is looked at pass by pass has begun already.
        if !self.runner.is_within_scan() {
            self.past.before_scan(&self.runner);
        }
        let done = self.runner.scan();
        self.seen(before.as_ref());
        done.is_ok() && self.stopped.is_none()
    }

    /// One pass of the scan that is due.
    pub(crate) fn pass(&mut self) -> Result<(), String> {
        self.only_now()?;
        if self.runner.halt().is_some() {
            return Ok(());
        }
        let begun = self.runner.is_within_scan();
        if !begun {
            self.past.before_scan(&self.runner);
        }
        let before = (!self.breaks.steps.is_empty()).then(|| self.active());
        let due = self.runner.due();
        if self.runner.pass().unwrap_or(true) {
            self.now = due;
            self.clock = due;
            self.seen(before.as_ref());
        }
        Ok(())
    }

    /// Takes in what a scan did.
    fn seen(&mut self, before: Option<&BTreeSet<u32>>) {
        self.recording.sample(self.now, self.bench.sample(&self.runner));
        self.notes.extend(self.conflicts.of(&self.bench, &self.runner));
        let cleared: Vec<u32> =
            self.runner.state().cleared().iter().filter_map(|rank| self.places.transition(*rank)).collect();
        self.stopped = self.stop_of(&cleared, before);
        self.cleared.extend(cleared);
    }

    /// The breakpoint that a scan met.
    fn stop_of(&self, cleared: &[u32], before: Option<&BTreeSet<u32>>) -> Option<String> {
        if let Some(at) = cleared.iter().find(|t| self.breaks.transitions.contains(t)) {
            return self.places.transition_id(*at);
        }
        let before = before?;
        let mut came = self.active();
        came.retain(|s| !before.contains(s));
        // Steps that were active only within the scan, or again, came on as well.
        came.extend(self.entered());
        let at = came.into_iter().find(|s| self.breaks.steps.contains(s))?;
        self.places.step_id(at)
    }

    /// The steps behind the transitions cleared in the latest scan, by index.
    fn entered(&self) -> BTreeSet<u32> {
        let tables = self.runner.program().tables();
        let rows = self.runner.state().cleared().iter().filter_map(|r| tables.transitions.get(*r as usize));
        let steps = rows.flat_map(|t| {
            let more = tables.arcs.get(t.more_to.start as usize..t.more_to.end as usize).unwrap_or(&[]);
            std::iter::once(t.to).chain(more.iter().copied())
        });
        steps.filter_map(|s| self.index_of(s)).collect()
    }

    fn index_of(&self, step: StepId) -> Option<u32> {
        let at = self.bench.steps.iter().position(|s| s.id == Activity::Step(step))?;
        u32::try_from(at).ok()
    }

    /// The active steps and macro-steps, by index.
    fn active(&self) -> BTreeSet<u32> {
        let state = self.watched().shown();
        (0u32..)
            .zip(&self.bench.steps)
            .filter(|(_, s)| self.bench.is_active(state, s))
            .map(|(i, _)| i)
            .collect()
    }

    /// Sets an input, a variable or a state of the plant, once.
    pub(crate) fn set(&mut self, signal: usize, value: &str) -> Result<(), String> {
        let item = self.settable(signal)?;
        let value = values::read(value, item.kind)?;
        self.put(signal, &value)
    }

    /// TRUE becomes FALSE, and FALSE TRUE.
    pub(crate) fn toggle(&mut self, signal: usize) -> Result<(), String> {
        let item = self.settable(signal)?;
        if item.kind != Kind::Bool {
            return Err(format!("`{}` is no BOOL: it cannot be toggled", item.name));
        }
        let now = match item.role {
            Role::Input(index) => self.runner.input(index),
            Role::Output | Role::Variable | Role::Plant => self.bench.value(&self.runner, item).word(),
        };
        self.put(signal, &Value::Word(u64::from(now == 0)))
    }

    fn settable(&self, signal: usize) -> Result<&Item, String> {
        let item = self.item(signal)?;
        match item.role {
            Role::Output => Err(format!("`{}` is an output: the chart sets it; it can be forced", item.name)),
            Role::Input(_) if self.bench.is_driven(&self.runner, item) => {
                Err(format!("`{}` is driven by the plant; it can be forced", item.name))
            }
            Role::Input(_) | Role::Variable | Role::Plant => Ok(item),
        }
    }

    fn put(&mut self, signal: usize, value: &Value) -> Result<(), String> {
        self.only_now()?;
        self.come(Event::Set(signal, value.clone()));
        Ok(())
    }

    /// Something comes in: it is noted, and done.
    fn come(&mut self, event: Event) {
        self.past.note(&self.runner, event.clone());
        past::apply(&self.bench, &mut self.runner, &event);
    }

    /// Holds a signal at a value.
    pub(crate) fn force(&mut self, signal: usize, value: &str) -> Result<(), String> {
        self.only_now()?;
        let item = self.item(signal)?;
        if item.role == Role::Plant {
            return Err(format!("`{}` is a state of the plant: it can be set, not forced", item.name));
        }
        let value = values::read(value, item.kind)?;
        self.come(Event::Force(signal, value));
        Ok(())
    }

    /// Lets go of a signal.
    pub(crate) fn release(&mut self, signal: usize) -> Result<(), String> {
        self.only_now()?;
        self.item(signal)?;
        self.come(Event::Release(signal));
        Ok(())
    }

    /// Lets go of all of them.
    pub(crate) fn release_all(&mut self) -> Result<(), String> {
        self.only_now()?;
        let held =
            |i: &usize| self.bench.items.get(*i).is_some_and(|it| self.bench.is_forced(&self.runner, it));
        let held: Vec<usize> = (0..self.bench.items.len()).filter(held).collect();
        held.into_iter().for_each(|i| self.come(Event::Release(i)));
        Ok(())
    }

    /// Starts the charts anew, with their first scan.
    pub(crate) fn restart(&mut self, warm: bool) -> Result<(), String> {
        self.only_now()?;
        if self.runner.is_within_scan() {
            self.scan();
        }
        self.come(Event::Restart(if warm { Restart::Warm } else { Restart::Cold }));
        self.stopped = None;
        self.conflicts = Conflicts::default();
        self.scan();
        self.clock = self.now;
        Ok(())
    }

    /// Looks at the run as it stood at an instant.
    pub(crate) fn seek(&mut self, ms: f64) -> Result<(), String> {
        let instant = lanes::ns(ms).max(self.past.begin());
        let found = self.past.at(&self.bench, instant);
        let (runner, scans) = found.ok_or("nothing was recorded yet")?;
        let back = i64::try_from(scans).unwrap_or(1).saturating_sub(1).saturating_mul(runner.period());
        let now = self.past.begin().saturating_add(back);
        let last = self.past.is_last(scans);
        self.cleared.clear();
        if last {
            self.viewed = None;
            return Ok(());
        }
        self.cleared.extend(runner.state().cleared().iter().filter_map(|rank| self.places.transition(*rank)));
        self.viewed = Some(Viewed { runner, scans, now });
        Ok(())
    }

    /// Comes back to now; or takes the scan looked at for now, and forgets what
    /// came behind it.
    pub(crate) fn live(&mut self, here: bool) {
        let Some(viewed) = self.viewed.take() else { return };
        if here {
            self.past.cut(viewed.scans);
            self.recording.truncate(viewed.now);
            (self.runner, self.now, self.clock) = (viewed.runner, viewed.now, viewed.now);
        }
    }

    /// The run that is looked at.
    fn watched(&self) -> &Runner {
        self.viewed.as_ref().map_or(&self.runner, |v| &v.runner)
    }

    /// Stops at these steps and transitions, and at no others.
    pub(crate) fn set_breaks(&mut self, ids: &[String]) {
        self.breaks = Breaks::default();
        for id in ids {
            if let Some(step) = self.places.step(id) {
                self.breaks.steps.insert(step);
            } else if let Some(transition) = self.places.transition_of(id) {
                self.breaks.transitions.insert(transition);
            }
        }
    }

    /// Where it stops, by id.
    pub(crate) fn break_ids(&self) -> Vec<String> {
        let steps = self.breaks.steps.iter().filter_map(|s| self.places.step_id(*s));
        steps.chain(self.breaks.transitions.iter().filter_map(|t| self.places.transition_id(*t))).collect()
    }

    /// What a page is told of it.
    pub(crate) fn frame(&mut self, full: bool, times: bool) -> Frame {
        frame::frame(self, full, times)
    }
}
