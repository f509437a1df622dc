//! A run: the bench, the runner and the recording, and all that the user does to them.
//!
//! `start` makes it, `swap` changes its chart, `frame` and `lanes` show it; this file uses none of
//! them. While the user looks at an earlier scan, nothing changes the run.

use std::collections::BTreeSet;
use std::sync::Arc;

use g7_engine::StepId;
use g7_host::{Kind, Recording, Runner, Start as Restart, Value};
use g7_ide::Positions;
use g7_model::{Document, Language, Nanos, Said, say};
use g7_rig::{Activity, Bench, Conflicts, Item, Role};

use super::past::{self, Event, Past};
use super::places::Places;
use super::sent::Sent;
use super::times;
use super::wish::Start;

/// Greatest number of scans that one message makes.
const SCANS: u32 = 20_000;
/// Greatest number of changes kept for one signal.
const KEPT: usize = 20_000;
/// Greatest number of changes kept for all signals together.
const KEPT_IN_ALL: usize = 2_000_000;

/// A recording of all signals of a bench, in bounded memory.
pub(super) fn recording(bench: &Bench) -> Recording {
    let signals = bench.signals();
    let limit = (KEPT_IN_ALL / signals.len().max(1)).clamp(100, KEPT);
    Recording::new(signals).with_limit(limit)
}

/// A run.
pub(crate) struct Run {
    pub(crate) name: String,
    /// The file from which it was started.
    pub(crate) file: String,
    pub(super) bench: Bench,
    /// The document from which it was compiled.
    pub(super) document: Arc<Document>,
    pub(super) text: Arc<str>,
    /// The fingerprint of the text and of those that it uses.
    pub(super) hash: String,
    pub(super) positions: Arc<Positions>,
    /// The request that started it.
    pub(super) wish: Start,
    pub(super) places: Places,
    pub(super) runner: Runner,
    pub(super) past: Past,
    /// An earlier scan that the user looks at.
    pub(super) viewed: Option<Viewed>,
    /// The virtual time requested so far.
    pub(super) clock: Nanos,
    /// The instant of the latest scan.
    pub(super) now: Nanos,
    pub(super) recording: Recording,
    pub(super) conflicts: Conflicts,
    pub(super) notes: Vec<Said>,
    /// The language of its reader.
    pub(crate) language: Language,
    /// The numbers of the transitions cleared since the previous frame.
    pub(super) cleared: BTreeSet<u32>,
    /// The breakpoints.
    pub(super) breaks: Breaks,
    /// The id of the breakpoint at which the run stopped.
    pub(super) stopped: Option<String>,
    /// True if the run could not keep up with the requested time.
    pub(super) late: bool,
    pub(super) sent: Sent,
}

/// A scan of the past, and the run as it was then.
pub(super) struct Viewed {
    pub(super) runner: Runner,
    pub(super) scans: u64,
    pub(super) now: Nanos,
}

/// The breakpoints: numbers of steps and transitions.
#[derive(Debug, Default)]
pub(super) struct Breaks {
    steps: BTreeSet<u32>,
    transitions: BTreeSet<u32>,
}

impl Run {
    fn item(&self, signal: usize) -> Result<&Item, Said> {
        self.bench.items.get(signal).ok_or_else(|| say!("there is no such signal"))
    }

    /// Advances the virtual time, scan by scan, until a breakpoint is met or `goes_on` says no.
    pub(crate) fn advance(
        &mut self,
        ms: f64,
        most: Option<u32>,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<(), Said> {
        self.only_now()?;
        self.clock = self.clock.max(self.now) + times::time(ms).max(Nanos::ZERO);
        self.late = false;
        let most = most.unwrap_or(SCANS).min(SCANS);
        let mut made = 0;
        while self.runner.due() <= self.clock {
            if made >= most || (made > 0 && !goes_on()) {
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

    /// Makes a single scan.
    pub(crate) fn one_scan(&mut self) -> Result<(), Said> {
        self.only_now()?;
        self.scan();
        self.clock = self.now;
        Ok(())
    }

    /// Refuses changes while the user looks at an earlier scan.
    pub(super) fn only_now(&self) -> Result<(), Said> {
        match self.viewed {
            Some(_) => Err(say!("this is the past: come back to now, or go on from here")),
            None => Ok(()),
        }
    }

    /// Makes one scan; returns false if the run stops after it.
    pub(super) fn scan(&mut self) -> bool {
        if self.runner.halt().is_some() {
            return false;
        }
        let before = (!self.breaks.steps.is_empty()).then(|| self.active());
        self.now = self.runner.due();
        self.clock = self.clock.max(self.now);
        // A scan that is executed pass by pass was announced at its first pass.
        if !self.runner.is_within_scan() {
            self.past.before_scan(&self.runner);
        }
        let done = self.runner.scan();
        self.seen(before.as_ref());
        done.is_ok() && self.stopped.is_none()
    }

    /// Makes one pass of the next scan.
    pub(crate) fn pass(&mut self) -> Result<(), Said> {
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

    /// Records the results of a scan.
    fn seen(&mut self, before: Option<&BTreeSet<u32>>) {
        self.recording.sample(self.now, self.bench.sample(&self.runner));
        self.notes.extend(self.conflicts.of(&self.bench, &self.runner));
        let cleared: Vec<u32> =
            self.runner.state().cleared().iter().filter_map(|rank| self.places.transition(*rank)).collect();
        self.stopped = self.stop_of(&cleared, before);
        self.cleared.extend(cleared);
    }

    /// The breakpoint that a scan met, if any.
    fn stop_of(&self, cleared: &[u32], before: Option<&BTreeSet<u32>>) -> Option<String> {
        if let Some(at) = cleared.iter().find(|t| self.breaks.transitions.contains(t)) {
            return self.places.transition_id(*at);
        }
        let before = before?;
        let mut came = self.active();
        came.retain(|s| !before.contains(s));
        // A step that was active only within the scan, or was activated again, counts too.
        came.extend(self.entered());
        let at = came.into_iter().find(|s| self.breaks.steps.contains(s))?;
        self.places.step_id(at)
    }

    /// The numbers of the steps after the transitions cleared in the latest scan.
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

    /// The numbers of the active steps and macro-steps.
    pub(super) fn active(&self) -> BTreeSet<u32> {
        let state = self.watched().shown();
        (0u32..)
            .zip(&self.bench.steps)
            .filter(|(_, s)| self.bench.is_active(state, s))
            .map(|(i, _)| i)
            .collect()
    }

    /// Sets an input, a variable or a state of the plant once.
    pub(crate) fn set(&mut self, signal: usize, value: &str) -> Result<(), Said> {
        let item = self.settable(signal)?;
        let value = item.read(value)?;
        self.put(signal, &value)
    }

    /// Inverts a BOOL.
    pub(crate) fn toggle(&mut self, signal: usize) -> Result<(), Said> {
        let item = self.settable(signal)?;
        if item.kind != Kind::Bool {
            return Err(say!("`{}` is not a BOOL, so it cannot be inverted", item.name));
        }
        let now = match item.role {
            Role::Input(index) => self.runner.input(index),
            Role::Output | Role::Variable | Role::Plant => self.bench.value(&self.runner, item).word(),
        };
        self.put(signal, &Value::Word(u64::from(now == 0)))
    }

    fn settable(&self, signal: usize) -> Result<&Item, Said> {
        let item = self.item(signal)?;
        match item.role {
            Role::Output => Err(say!("`{}` is an output: the chart sets it; it can be forced", item.name)),
            Role::Input(_) if self.bench.is_driven(&self.runner, item) => {
                Err(say!("`{}` is driven by the plant; it can be forced", item.name))
            }
            Role::Input(_) | Role::Variable | Role::Plant => Ok(item),
        }
    }

    fn put(&mut self, signal: usize, value: &Value) -> Result<(), Said> {
        self.only_now()?;
        self.come(Event::Set(signal, value.clone()));
        Ok(())
    }

    /// Records an event from outside and executes it.
    pub(super) fn come(&mut self, event: Event) {
        self.past.note(&self.runner, event.clone());
        past::apply(&self.bench, &mut self.runner, &event);
    }

    /// Forces a signal to a value.
    pub(crate) fn force(&mut self, signal: usize, value: &str) -> Result<(), Said> {
        self.only_now()?;
        let item = self.item(signal)?;
        if item.role == Role::Plant {
            return Err(say!("`{}` is a state of the plant: it can be set, not forced", item.name));
        }
        let value = item.read(value)?;
        self.come(Event::Force(signal, value));
        Ok(())
    }

    /// Releases a signal.
    pub(crate) fn release(&mut self, signal: usize) -> Result<(), Said> {
        self.only_now()?;
        self.item(signal)?;
        self.come(Event::Release(signal));
        Ok(())
    }

    /// Releases all signals.
    pub(crate) fn release_all(&mut self) -> Result<(), Said> {
        self.only_now()?;
        let held =
            |i: &usize| self.bench.items.get(*i).is_some_and(|it| self.bench.is_forced(&self.runner, it));
        let held: Vec<usize> = (0..self.bench.items.len()).filter(held).collect();
        held.into_iter().for_each(|i| self.come(Event::Release(i)));
        Ok(())
    }

    /// Restarts the charts and makes the first scan.
    pub(crate) fn restart(&mut self, warm: bool) -> Result<(), Said> {
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

    /// Shows the run as it was at an instant.
    pub(crate) fn seek(&mut self, ms: f64) -> Result<(), Said> {
        let instant = times::time(ms).max(self.past.begin());
        let found = self.past.at(&self.bench, instant);
        let (runner, scans) = found.ok_or_else(|| say!("nothing was recorded yet"))?;
        let back = i64::try_from(scans).unwrap_or(1).saturating_sub(1);
        let now = self.past.begin() + runner.period() * back;
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

    /// Returns to the present; with `here`, the scan that is shown becomes the present, and
    /// everything after it is dropped.
    pub(crate) fn live(&mut self, here: bool) {
        let Some(viewed) = self.viewed.take() else { return };
        if here {
            self.past.cut(viewed.scans);
            self.recording.truncate(viewed.now);
            (self.runner, self.now, self.clock) = (viewed.runner, viewed.now, viewed.now);
        }
    }

    /// The run that is shown: the present one, or that of an earlier scan.
    pub(super) fn watched(&self) -> &Runner {
        self.viewed.as_ref().map_or(&self.runner, |v| &v.runner)
    }

    /// Sets the breakpoints; all others are removed.
    pub(crate) fn set_breaks(&mut self, ids: &[String]) {
        self.breaks = Breaks::default();
        for id in ids {
            self.breaks.steps.extend(self.places.steps_of(id));
            self.breaks.transitions.extend(self.places.transitions_of(id));
        }
    }

    /// The ids of the breakpoints.
    pub(crate) fn break_ids(&self) -> Vec<String> {
        let steps = self.breaks.steps.iter().filter_map(|s| self.places.step_id(*s));
        let mut ids: Vec<String> = steps
            .chain(self.breaks.transitions.iter().filter_map(|t| self.places.transition_id(*t)))
            .collect();
        // The steps of all instances have one id.
        let mut told = BTreeSet::new();
        ids.retain(|id| told.insert(id.clone()));
        ids
    }
}
