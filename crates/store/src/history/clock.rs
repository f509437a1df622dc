//! The wall clock at times of the record.

/// A wall clock that differs by more than this from the one expected has jumped, in ms.
const JUMP: i64 = 500;

/// The wall clock beside the time of the record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Clock {
    /// From a time of the record on, in us: the wall clock then, in us since 1970, UTC.
    marks: Vec<(i64, i64)>,
}

impl Clock {
    /// Of marks in the order of time.
    pub(super) fn new(marks: Vec<(i64, i64)>) -> Clock {
        Clock { marks }
    }

    /// The marks: time of the record, wall clock; in us.
    pub fn marks(&self) -> &[(i64, i64)] {
        &self.marks
    }

    /// The wall clock at a time of the record, in us since 1970, UTC; before the first mark it is counted
    /// back from it.
    pub fn utc(&self, at: i64) -> i64 {
        let behind = self.marks.partition_point(|(mark, _)| *mark <= at);
        match self.marks.get(behind.saturating_sub(1)) {
            Some((mark, utc)) => utc.saturating_add(at.saturating_sub(*mark)),
            None => at,
        }
    }

    /// True if the wall clock is not the one that goes on from the marks.
    pub(super) fn parts(&self, at: i64, utc: i64) -> bool {
        self.marks.is_empty() || utc.abs_diff(self.utc(at)) > (JUMP * 1000).unsigned_abs()
    }

    /// Notes a wall clock; at the time of the last mark it takes its place.
    pub(super) fn add(&mut self, at: i64, utc: i64) {
        self.marks.retain(|(mark, _)| *mark < at);
        self.marks.push((at, utc));
    }

    /// The times of the record, within two of them, at which the wall clock showed a time between two
    /// others: several where it was set back.
    pub fn ranges(&self, within: (i64, i64), utc: (i64, i64)) -> Vec<(i64, i64)> {
        let ends = self.marks.iter().skip(1).map(|(mark, _)| mark.saturating_sub(1)).chain([i64::MAX]);
        let mut found = Vec::new();
        for (k, ((mark, shown), end)) in self.marks.iter().zip(ends).enumerate() {
            let begin = if k == 0 { i64::MIN } else { *mark };
            let at = |utc: i64| utc.saturating_sub(*shown).saturating_add(*mark);
            let from = begin.max(at(utc.0)).max(within.0);
            let to = end.min(at(utc.1)).min(within.1);
            if from <= to {
                found.push((from, to));
            }
        }
        found
    }
}
