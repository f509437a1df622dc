//! The clocks of a state: the words of its image whose values only matter between bounds.
//!
//! An image is a *shape*, in which those words have values that stand for many, and the values of the
//! clocks that run. A clock whose last bound is behind it, and a time that has stopped, stand in the shape
//! by their interval. A time that code reads in another way stays in the shape as it is, and is counted.
//!
//! The last word of an image is the memory of the claim (`monitor.rs`); that of [`Claim::Within`] is a
//! clock as well.

use g7_engine::{Elapsed, Program, Time};

use super::matrix::{From, Span};
use crate::model::Model;
use crate::monitor::IDLE;
use crate::question::Claim;

/// Most scans that a clock counts; one that goes on longer is counted as any other word.
const LONGEST: i64 = 1 << 40;

/// A word that is a clock.
enum Word {
    Time(Time),
    /// The memory of the claim, at this word.
    Memory(usize),
}

/// A clock of the charts or of the claim.
struct Clock {
    word: Word,
    /// Its time between two scans, in its own unit.
    unit: i64,
    /// The numbers of scans at which comparisons change, ascending.
    bounds: Vec<i64>,
}

/// The clocks of a model and one claim.
pub(crate) struct Clocks<'a> {
    p: &'a Program,
    list: Vec<Clock>,
}

/// An image without the values of its clocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    /// The image, with values that stand for those of the clocks.
    pub(crate) image: Vec<u64>,
    /// The clocks that run and have a bound before them, by their numbers.
    pub(crate) runs: Vec<usize>,
}

/// The end of a scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Moved {
    pub(crate) shape: Shape,
    /// For each clock of the new shape, where its value comes from.
    pub(crate) to: Vec<From>,
}

/// The state of a clock in an image, in scans.
enum Now {
    Off,
    /// Stopped, in its own unit.
    Still(i64),
    /// Running, in its own unit.
    Runs(i64),
}

impl Clock {
    /// The number of scans from which all are alike.
    fn last(&self) -> i64 {
        self.bounds.last().copied().unwrap_or(0)
    }

    fn now(&self, p: &Program, image: &[u64]) -> Now {
        match &self.word {
            Word::Memory(at) => match image.get(*at).copied().unwrap_or(IDLE) {
                IDLE => Now::Off,
                waited => Now::Runs(waited as i64 - 1),
            },
            Word::Time(time) => match time.elapsed(p, image) {
                Elapsed::Off => Now::Off,
                Elapsed::Still(v) => Now::Still(v),
                Elapsed::Runs(v) => Now::Runs(v),
            },
        }
    }

    fn put(&self, p: &Program, image: &mut [u64], elapsed: i64) {
        match &self.word {
            Word::Memory(at) => image.get_mut(*at).into_iter().for_each(|w| *w = elapsed as u64 + 1),
            Word::Time(time) => time.put(p, image, elapsed),
        }
    }

    /// The limits of the interval in which a number of scans lies.
    fn interval(&self, scans: i64) -> Span {
        let next = self.bounds.partition_point(|b| *b <= scans);
        let least = next.checked_sub(1).and_then(|i| self.bounds.get(i)).copied().unwrap_or(0);
        (least, self.bounds.get(next).map_or(i64::MAX / 8, |b| b - 1))
    }
}

impl<'a> Clocks<'a> {
    /// The clocks of a model; `memory` is the claim that remembers something, and its word.
    pub(crate) fn new(model: &Model<'a>, memory: Option<(&Claim, usize)>) -> Clocks<'a> {
        let p: &'a Program = &model.compiled.program;
        let mut list = Vec::new();
        for time in p.times().into_iter().flatten() {
            let unit = if time.scans { 1 } else { model.period };
            let fits = time.period % unit == 0;
            if let Some(bounds) = time.bounds.as_deref().filter(|_| fits).and_then(|b| in_scans(b, unit)) {
                list.push(Clock { word: Word::Time(time), unit, bounds });
            }
        }
        if let Some((Claim::Within { within, .. }, at)) = memory
            && let Some(bounds) = in_scans(&[within.saturating_add(1)], model.period)
        {
            list.push(Clock { word: Word::Memory(at), unit: model.period, bounds });
        }
        Clocks { p, list }
    }

    /// True if no word is a clock, so that states are as many as without.
    pub(crate) fn is_empty(&self) -> bool {
        self.list.iter().all(|c| c.bounds.is_empty())
    }

    /// The shape of an image in which no clock runs.
    pub(crate) fn start(&self, image: Vec<u64>) -> Option<Shape> {
        let none = Shape { image: image.clone(), runs: Vec::new() };
        self.moved(image, &none, &[]).map(|m| m.shape)
    }

    /// The image of a shape with these numbers of scans.
    pub(crate) fn image(&self, shape: &Shape, scans: &[i64], into: &mut Vec<u64>) {
        into.clone_from(&shape.image);
        for (clock, scans) in self.of(shape).zip(scans) {
            clock.put(self.p, into, scans.saturating_mul(clock.unit));
        }
    }

    fn of<'s>(&'s self, shape: &'s Shape) -> impl Iterator<Item = &'s Clock> + 's {
        shape.runs.iter().filter_map(|i| self.list.get(*i))
    }

    /// For each clock of a shape, the intervals that meet a span.
    pub(crate) fn intervals(&self, shape: &Shape, clock: usize, (least, most): Span) -> Vec<Span> {
        let Some(clock) = shape.runs.get(clock).and_then(|i| self.list.get(*i)) else { return Vec::new() };
        let mut found = vec![clock.interval(least)];
        while let Some((_, end)) = found.last().copied().filter(|(_, end)| *end < most) {
            found.push(clock.interval(end + 1));
        }
        found
    }

    /// The shape of the image behind a scan, and the origin of its clocks. In the image before it, of the
    /// shape `from`, the clocks have become `scans` by the time of the scan. `None` where a clock has
    /// become something else than 0, itself, or at rest.
    pub(crate) fn moved(&self, mut image: Vec<u64>, from: &Shape, scans: &[i64]) -> Option<Moved> {
        let (mut runs, mut to) = (Vec::new(), Vec::new());
        for (i, clock) in self.list.iter().enumerate() {
            match clock.now(self.p, &image) {
                Now::Off => {}
                Now::Still(v) => clock.put(self.p, &mut image, self.stopped(clock, v)),
                Now::Runs(v) => {
                    let old = from.runs.iter().position(|r| *r == i);
                    let before = old.and_then(|o| scans.get(o)).copied();
                    let stands = self.is_over(clock, &from.image);
                    let origin = match (v, old, before) {
                        (0, ..) => Some(From::Zero),
                        (v, Some(old), Some(n)) if same(clock, v, n) => Some(From::Old(old)),
                        (1.., None, _) if stands => None,
                        _ => return None,
                    };
                    let n = match origin {
                        Some(From::Zero) => 0,
                        Some(From::Old(_)) => before.unwrap_or(0),
                        None => clock.last(),
                    };
                    if n < clock.last() {
                        runs.push(i);
                        to.extend(origin);
                        clock.put(self.p, &mut image, 0);
                    } else {
                        clock.put(self.p, &mut image, clock.last().saturating_mul(clock.unit));
                    }
                }
            }
            if let Word::Time(time) = &clock.word {
                time.smooth(self.p, &mut image);
            }
        }
        Some(Moved { shape: Shape { image, runs }, to })
    }

    /// The value that stands for all at which a time may have stopped in the same interval.
    fn stopped(&self, clock: &Clock, value: i64) -> i64 {
        let Word::Time(time) = &clock.word else { return value };
        let bounds = time.bounds.as_deref().unwrap_or(&[]);
        let below = bounds.partition_point(|b| *b <= value);
        below.checked_sub(1).and_then(|i| bounds.get(i)).copied().unwrap_or(0)
    }

    /// True if a clock ran in a shape beyond its last bound.
    fn is_over(&self, clock: &Clock, image: &[u64]) -> bool {
        matches!(clock.now(self.p, image), Now::Runs(v) if v >= clock.last().saturating_mul(clock.unit))
    }
}

/// True if a time is that of so many scans, or both are beyond all bounds.
fn same(clock: &Clock, value: i64, scans: i64) -> bool {
    let whole = scans.saturating_mul(clock.unit);
    let Word::Time(time) = &clock.word else { return value == whole };
    let last = time.bounds.as_deref().and_then(<[i64]>::last).copied().unwrap_or(0);
    value == whole || value >= last && whole >= last
}

/// The least numbers of scans that reach bounds; `None` where one is too far.
fn in_scans(bounds: &[i64], unit: i64) -> Option<Vec<i64>> {
    let up = |b: &i64| b / unit + i64::from(b % unit != 0);
    let mut scans: Vec<i64> = bounds.iter().map(up).collect();
    scans.dedup();
    scans
        .last()
        .is_none_or(|n| *n <= LONGEST && n.checked_mul(unit.saturating_mul(4)).is_some())
        .then_some(scans)
}
