//! The past of a run: a tape, with a mark at every so many scans, from which the scans behind it are made again.
//!
//! Between two marks stands a set of the words and steps that changed, so that the last change of a signal is found
//! without the scans in which it stood still. The number of marks is bounded; a longer run has them farther apart.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

use g7_engine::{Program, State, StepId, WatchId};
use g7_host::{Divergence, Player, Tape};
use g7_model::Nanos;

use crate::look::Look;
use crate::signal::{Pos, Signal};

/// Most words of all marks together.
const ROOM: usize = 1 << 23;
/// Least number of scans between two marks.
const EVERY: usize = 64;
/// Most scans that are kept pass by pass.
const LOOKS: usize = 64;

struct Mark {
    player: Player,
    /// The variables, then the steps, then the timers that change from this mark to the next one, a bit each.
    moved: Box<[u64]>,
}

/// A run that can be looked at.
pub(crate) struct Past<'a> {
    pub(crate) program: &'a Program,
    tape: &'a Tape,
    every: usize,
    marks: Vec<Mark>,
    times: Vec<Nanos>,
    looks: RefCell<BTreeMap<usize, Rc<Look>>>,
    /// Scans that were made again for answers.
    again: Cell<u64>,
}

impl<'a> Past<'a> {
    /// Makes the run of a tape again, and sets the marks.
    pub(crate) fn new(program: &'a Program, tape: &'a Tape) -> Result<Past<'a>, Divergence> {
        let mut player = Player::new(program);
        let size = 4 * player.state().image().len() + 64;
        let room = (ROOM / size).clamp(8, 1 << 12);
        let every = tape.scans().div_ceil(room).max(EVERY);
        let words = program.tables().init.len();
        let steps = program.tables().steps.len();
        let bits = (words + steps + program.tables().watches.len()).div_ceil(64);
        let timers = (0..).map(WatchId).zip(&program.tables().watches);
        let mut timers: Vec<(WatchId, bool)> =
            timers.filter(|(_, w)| w.times.is_some()).map(|(id, _)| (id, false)).collect();
        let mut past = Past {
            program,
            tape,
            every,
            marks: Vec::new(),
            times: Vec::new(),
            looks: RefCell::default(),
            again: Cell::new(0),
        };
        let mut before: Vec<u64> = player.state().words().to_vec();
        let mut active: Vec<StepId> = Vec::new();
        loop {
            if player.scans().is_multiple_of(every) {
                past.marks.push(Mark { player: player.clone(), moved: vec![0; bits].into_boxed_slice() });
            }
            if player.prepare(tape, program).is_none() {
                break;
            }
            player.scan(tape, program)?;
            past.times.push(player.now());
            let Some(mark) = past.marks.last_mut() else { break };
            let mut set = |bit: usize| {
                if let Some(word) = mark.moved.get_mut(bit / 64) {
                    *word |= 1 << (bit % 64);
                }
            };
            let now = player.state().words();
            if before != now {
                let changed = before.iter().zip(now).enumerate().filter(|(_, (a, b))| a != b);
                changed.for_each(|(i, _)| set(i));
                before.copy_from_slice(now);
            }
            if !player.state().active().eq(active.iter().copied()) {
                let next: Vec<StepId> = player.state().active().collect();
                let turned = next.iter().filter(|s| !active.contains(s));
                let turned = turned.chain(active.iter().filter(|s| !next.contains(s)));
                turned.for_each(|s| set(words + s.0 as usize));
                active = next;
            }
            for (id, was) in &mut timers {
                let now = player.state().timer(program, *id);
                if now != *was {
                    set(words + steps + id.0 as usize);
                    *was = now;
                }
            }
        }
        Ok(past)
    }

    /// The number of scans that answers have made again so far.
    pub(crate) fn again(&self) -> u64 {
        self.again.get()
    }

    fn scan(&self, player: &mut Player) -> Option<()> {
        self.again.set(self.again.get() + 1);
        player.scan(self.tape, self.program).ok()
    }

    /// The number of scans.
    pub(crate) fn scans(&self) -> usize {
        self.times.len()
    }

    /// The instant of a scan.
    pub(crate) fn time(&self, scan: usize) -> Nanos {
        self.times.get(scan).copied().unwrap_or_default()
    }

    /// The last scan at or before an instant.
    pub(crate) fn scan_at(&self, now: Nanos) -> Option<usize> {
        self.times.partition_point(|t| *t <= now).checked_sub(1)
    }

    /// The state behind a scan.
    pub(crate) fn behind(&self, scan: usize) -> State {
        let mut player = self.before(scan);
        self.scan(&mut player);
        player.state().clone()
    }

    /// The place on the tape before a scan; what is written from outside before it is not written yet.
    fn before(&self, scan: usize) -> Player {
        let mark = self.marks.get(scan / self.every).or(self.marks.last());
        let mut player = mark.map_or_else(|| Player::new(self.program), |m| m.player.clone());
        while player.scans() < scan {
            self.scan(&mut player);
        }
        player
    }

    /// A scan, pass by pass.
    pub(crate) fn look(&self, scan: usize) -> Rc<Look> {
        if let Some(look) = self.looks.borrow().get(&scan) {
            return look.clone();
        }
        let look = Rc::new(Look::new(self.program, self.tape, self.before(scan)));
        let mut looks = self.looks.borrow_mut();
        if looks.len() >= LOOKS {
            looks.pop_first();
        }
        looks.insert(scan, look.clone());
        look
    }

    /// The moment behind a scan.
    pub(crate) fn end(&self, scan: usize) -> Pos {
        Pos { scan, stage: self.look(scan).stages.len().saturating_sub(1) }
    }

    /// The last moment, at or before this one, at which one of these changed.
    pub(crate) fn last_change(&self, signals: &[Signal], pos: Pos) -> Option<Pos> {
        let look = self.look(pos.scan);
        for stage in (0..=pos.stage.min(look.stages.len().saturating_sub(1))).rev() {
            if signals.iter().any(|s| look.changes(self.program, *s, stage)) {
                return Some(Pos { scan: pos.scan, stage });
            }
        }
        let mut end = pos.scan;
        while end > 0 {
            // The scans from the last mark before `end` up to it.
            let first = (end - 1) / self.every * self.every;
            let mark = self.marks.get(first / self.every)?;
            if signals.iter().any(|s| self.may_move(mark, *s))
                && let Some(scan) = self.last_of(mark, signals, end)
            {
                let look = self.look(scan);
                let changed = |stage: &usize| signals.iter().any(|s| look.changes(self.program, *s, *stage));
                let stage = (0..look.stages.len()).rev().find(changed)?;
                return Some(Pos { scan, stage });
            }
            end = first;
        }
        None
    }

    /// False if a signal stands still from a mark to the next one.
    fn may_move(&self, mark: &Mark, signal: Signal) -> bool {
        let t = self.program.tables();
        let (words, steps) = (t.init.len(), t.steps.len());
        let bit = |at: usize| mark.moved.get(at / 64).is_none_or(|w| w & (1 << (at % 64)) != 0);
        match signal {
            Signal::Word(addr) => bit(addr.0 as usize),
            Signal::Step(step) => bit(words + step.0 as usize),
            Signal::Group(group) => t
                .groups
                .get(group.0 as usize)
                .is_some_and(|g| (g.steps.start..g.steps.end).any(|step| bit(words + step as usize))),
            Signal::Timer(watch) => bit(words + steps + watch.0 as usize),
        }
    }

    /// The last scan before `end`, from a mark on, behind which a signal had another value than before it.
    fn last_of(&self, mark: &Mark, signals: &[Signal], end: usize) -> Option<usize> {
        let mut player = mark.player.clone();
        let values = |s: &State| -> Vec<u64> { signals.iter().map(|x| x.of(self.program, s)).collect() };
        let (mut before, mut found) = (values(player.state()), None);
        while player.scans() < end {
            let scan = player.scans();
            self.scan(&mut player)?;
            let now = values(player.state());
            if now != before {
                found = Some(scan);
            }
            before = now;
        }
        found
    }
}
