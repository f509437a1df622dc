//! Recordings: a list of changes for each signal. The submodules write them in several forms.

pub(crate) mod chronogram;
pub(crate) mod csv;
pub(crate) mod vcd;

mod changes;
mod value;

use g7_model::Nanos;

use changes::Changes;
pub use value::{Kind, Sample, Value};

/// A variable or step whose values are recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The group in which it is shown: `inputs`, `outputs`, `steps`, …
    pub group: &'static str,
    /// Its name.
    pub name: String,
    /// How its values are to be read.
    pub kind: Kind,
}

/// Changes of all signals together, and of one, for which a recording has room from the start.
const ROOM: usize = 1 << 16;
const MOST: usize = 256;

/// The changes of some signals over a span of time.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    signals: Vec<Signal>,
    changes: Vec<Changes>,
    start: Option<Nanos>,
    end: Nanos,
    /// Greatest number of changes kept for one signal; `None` keeps all.
    limit: Option<usize>,
}

impl Recording {
    /// An empty recording of these signals.
    pub fn new(signals: Vec<Signal>) -> Recording {
        let room = (ROOM / signals.len().max(1)).clamp(1, MOST);
        let changes = signals.iter().map(|_| Changes::new(room)).collect();
        Recording { signals, changes, start: None, end: Nanos::ZERO, limit: None }
    }

    /// Limits the number of changes kept for each signal, at least one; the oldest are dropped.
    #[must_use]
    pub fn with_limit(mut self, limit: usize) -> Recording {
        self.limit = Some(limit.max(1));
        self
    }

    /// Takes the values of all signals at an instant, in the order of the signals. Only changed
    /// values are stored; a later sample at the same instant replaces the earlier one.
    pub fn sample<'a>(&mut self, now: Nanos, values: impl IntoIterator<Item = Sample<'a>>) {
        self.start.get_or_insert(now);
        self.end = self.end.max(now);
        let limit = self.limit.unwrap_or(usize::MAX);
        let mut changes = self.changes.iter_mut();
        values.into_iter().for_each(|value| {
            if let Some(list) = changes.next()
                && !list.ends_with(&value)
            {
                list.add(now, value.words(), limit);
            }
        });
    }

    /// The recorded signals.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// The changes of a signal, ordered by time.
    pub fn changes(&self, signal: usize) -> impl DoubleEndedIterator<Item = (Nanos, Value)> {
        let list = self.changes.get(signal);
        (0..self.count(signal)).filter_map(move |i| Some(list?.get(i, self.kind(signal))))
    }

    fn kind(&self, signal: usize) -> Kind {
        self.signals.get(signal).map_or(Kind::Bool, |s| s.kind)
    }

    /// The number of changes stored for a signal, its first value included.
    pub fn count(&self, signal: usize) -> usize {
        self.changes.get(signal).map_or(0, Changes::len)
    }

    /// The value of a signal at an instant; `None` before its first value.
    pub fn value_at(&self, signal: usize, instant: Nanos) -> Option<Value> {
        let list = self.changes.get(signal)?;
        let at = list.until(instant).checked_sub(1)?;
        Some(list.get(at, self.kind(signal)).1)
    }

    /// Instant of the first sample; 0 if there is none.
    pub fn start(&self) -> Nanos {
        self.start.unwrap_or_default()
    }

    /// Instant of the last sample.
    pub fn end(&self) -> Nanos {
        self.end
    }

    /// Drops all changes after an instant.
    pub fn truncate(&mut self, instant: Nanos) {
        for list in &mut self.changes {
            list.truncate(list.until(instant));
        }
        self.end = self.end.min(instant);
    }

    /// Copies the changes of a signal from another recording.
    pub fn adopt(&mut self, signal: usize, from: &Recording, other: usize) {
        if let (Some(to), Some(list)) = (self.changes.get_mut(signal), from.changes.get(other)) {
            to.clone_from(list);
            self.start = Some(self.start.unwrap_or(from.start()).min(from.start()));
            self.end = self.end.max(from.end);
        }
    }

    /// A recording of some of the signals, limited to a span of time.
    #[must_use]
    pub fn part(&self, signals: &[usize], from: Nanos, to: Nanos) -> Recording {
        let (from, to) = (from.max(self.start()), to.min(self.end));
        let there = || signals.iter().filter_map(|i| Some((self.signals.get(*i)?, self.changes.get(*i)?)));
        Recording {
            changes: there().map(|(_, list)| list.part(from, to)).collect(),
            signals: there().map(|(s, _)| s.clone()).collect(),
            start: Some(from),
            end: to.max(from),
            limit: None,
        }
    }

    /// All instants at which a signal changed, ascending and without repetition.
    pub fn instants(&self) -> Vec<Nanos> {
        let mut all: Vec<Nanos> = self.changes.iter().flat_map(Changes::instants).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(count: i64) -> Nanos {
        Nanos::new(count)
    }

    fn bool_signal(name: &str) -> Signal {
        Signal { group: "inputs", name: name.to_owned(), kind: Kind::Bool }
    }

    #[test]
    fn only_changes_are_kept_and_values_between_them_found() {
        let mut r = Recording::new(vec![bool_signal("a")]);
        for (t, v) in [(0, 0), (10, 0), (20, 1), (30, 1), (40, 0)] {
            r.sample(at(t), [Sample::Word(v)]);
        }
        assert_eq!(r.count(0), 3);
        assert_eq!(r.instants(), [0, 20, 40].map(at));
        assert_eq!(r.value_at(0, at(39)), Some(Value::Word(1)));
        assert_eq!(r.value_at(0, at(-1)), None);
        assert_eq!((r.start(), r.end()), (at(0), at(40)));
    }

    #[test]
    fn a_second_sample_of_an_instant_replaces_the_first() {
        let mut r = Recording::new(vec![bool_signal("a")]);
        r.sample(at(0), [Sample::Word(0)]);
        r.sample(at(5), [Sample::Word(1)]);
        r.sample(at(5), [Sample::Word(0)]);
        assert_eq!(r.count(0), 1, "at 5 nothing differs from before");
    }

    #[test]
    fn the_limit_drops_the_oldest() {
        let mut r = Recording::new(vec![bool_signal("a")]).with_limit(2);
        for t in 0..5 {
            r.sample(at(t), [Sample::Word((t % 2) as u64)]);
        }
        assert_eq!(r.changes(0).map(|c| c.0).collect::<Vec<_>>(), [3, 4].map(at));
    }

    #[test]
    fn a_part_begins_with_the_values_that_stand_there() {
        let mut r = Recording::new(vec![bool_signal("a"), bool_signal("b")]);
        for (t, a, b) in [(0, 0, 1), (10, 1, 1), (20, 0, 0), (30, 1, 0)] {
            r.sample(at(t), [Sample::Word(a), Sample::Word(b)]);
        }
        let part = r.part(&[1, 0, 7], at(15), at(25));
        assert_eq!(part.signals().iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["b", "a"]);
        let of = |i| part.changes(i).map(|(t, v)| (t.count(), v.word())).collect::<Vec<_>>();
        assert_eq!((of(0), of(1)), (vec![(15, 1), (20, 0)], vec![(15, 1), (20, 0)]));
        assert_eq!((part.start(), part.end()), (at(15), at(25)));
        r.truncate(at(10));
        assert_eq!((r.count(0), r.count(1), r.end()), (2, 1, at(10)));
        let mut other = Recording::new(vec![bool_signal("b")]);
        other.adopt(0, &r, 1);
        assert_eq!(other.value_at(0, at(10)), Some(Value::Word(1)));
    }

    #[test]
    fn texts_are_kept_as_they_were_and_may_become_longer() {
        let text = || vec![Signal { group: "plant", name: "t".to_owned(), kind: Kind::Text }];
        let mut r = Recording::new(text()).with_limit(3);
        for (t, words, show) in
            [(0, 3, "ab"), (1, 3, "ab"), (2, 3, "a quick fox"), (3, 4, "a quick fox jumps"), (4, 2, "b")]
        {
            let given = crate::write_text(show, words);
            r.sample(at(t), [Sample::Text(&given)]);
            r.sample(at(t), [Sample::Text(&given)]);
            assert_eq!(r.value_at(0, at(t)), Some(Value::Text(show.into())));
        }
        let texts: Vec<String> = r.changes(0).map(|(_, v)| v.show(Kind::Text)).collect();
        assert_eq!(texts, ["a quick fox", "a quick fox jumps", "b"]);
        assert_eq!(r.instants(), [2, 3, 4].map(at));
        r.sample(at(5), [Sample::Text(&crate::write_text("b", 4))]);
        assert_eq!(r.instants(), [2, 3, 4].map(at), "the same text in more words");
    }

    #[test]
    fn a_part_before_the_first_value_and_one_turned_round() {
        let mut r = Recording::new(vec![bool_signal("a")]);
        for (t, v) in [(10, 1), (20, 0), (30, 1)] {
            r.sample(at(t), [Sample::Word(v)]);
        }
        let of = |from: i64, to: i64| -> Vec<(i64, u64)> {
            r.part(&[0], at(from), at(to)).changes(0).map(|(t, v)| (t.count(), v.word())).collect()
        };
        assert_eq!(of(0, 15), [(10, 1)], "it begins with the recording");
        assert_eq!(of(20, 30), [(20, 0), (30, 1)]);
        assert_eq!(of(25, 5), [(25, 0)]);
    }

    #[test]
    fn values_read_by_their_kind() {
        let int = Kind::Int { bits: 16, signed: true };
        assert_eq!(Value::Word(-3i64 as u64).show(int), "-3");
        assert_eq!(Value::Word(2.5f64.to_bits()).show(Kind::Lreal), "2.5");
        assert_eq!(Value::Word(u64::from(0.1f32.to_bits())).show(Kind::Real), "0.1");
        assert_eq!(Value::Text("hi".into()).show(Kind::Text), "hi");
    }
}
