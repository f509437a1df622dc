//! A recording drawn with characters: one lane for each signal over a common time axis.

use g7_model::Nanos;

use super::{Kind, Recording, Signal, Value};

/// The width of a chronogram and the span of time that it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Number of columns of a lane, without the label.
    pub columns: usize,
    /// First instant shown.
    pub from: Nanos,
    /// Last instant shown.
    pub to: Nanos,
    /// Last instant at which values are known; columns after it stay blank.
    pub until: Nanos,
}

/// The lane of one signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lane {
    /// The number of the signal in the recording.
    pub signal: usize,
    /// The signal's name, shortened if it is long.
    pub label: String,
    /// One character for each column.
    pub cells: String,
    /// Text after the lane: the last value, or the range of a curve.
    pub note: String,
}

/// The lanes and their axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chronogram {
    /// The lanes, in the order in which the signals were asked for.
    pub lanes: Vec<Lane>,
    /// Marks and times, one character for each column.
    pub axis: String,
}

const LABEL: usize = 24;
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

impl Chronogram {
    /// Draws the chosen signals.
    pub fn new(recording: &Recording, which: impl IntoIterator<Item = usize>, style: Style) -> Chronogram {
        let grid = Grid::new(style);
        let mut lanes: Vec<Lane> = which
            .into_iter()
            .filter_map(|i| recording.signals().get(i).map(|s| lane(recording, i, s, &grid)))
            .collect();
        let known = (0..grid.columns).take_while(|c| grid.instant(*c) <= style.until).count();
        for lane in lanes.iter_mut().filter(|_| known < grid.columns) {
            let cells = lane.cells.chars().take(known);
            lane.cells = cells.chain(std::iter::repeat_n(' ', grid.columns - known)).collect();
        }
        Chronogram { lanes, axis: grid.axis() }
    }

    /// Number of columns that the labels need.
    pub fn label_width(&self) -> usize {
        self.lanes.iter().map(|l| l.label.chars().count()).max().unwrap_or(0)
    }
}

impl std::fmt::Display for Chronogram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let width = self.label_width();
        for lane in &self.lanes {
            let line = format!("{:>width$} {} {}", lane.label, lane.cells, lane.note);
            writeln!(f, "{}", line.trim_end())?;
        }
        writeln!(f, "{:>width$} {}", "", self.axis.trim_end())
    }
}

/// The division of time into columns.
struct Grid {
    from: Nanos,
    span: i128,
    columns: usize,
}

impl Grid {
    fn new(style: Style) -> Grid {
        let span = i128::from(style.to.count()) - i128::from(style.from.count());
        Grid { from: style.from, span: span.max(1), columns: style.columns.max(1) }
    }

    /// The first instant of a column.
    fn instant(&self, column: usize) -> Nanos {
        let at = i128::from(self.from.count()) + self.span * column as i128 / self.columns as i128;
        i64::try_from(at).map_or(Nanos::MAX, Nanos::new)
    }

    /// The column of an instant; the last column includes the end of the span.
    fn column(&self, instant: Nanos) -> Option<usize> {
        let offset = i128::from(instant.count()) - i128::from(self.from.count());
        if offset < 0 || offset > self.span {
            return None;
        }
        // Rounded up, because `instant` rounds down and `column(instant(c))` must be `c`.
        let c = (offset * self.columns as i128 + self.columns as i128 - 1) / self.span;
        let mut c = usize::try_from(c).unwrap_or(0).min(self.columns - 1);
        while c > 0 && self.instant(c) > instant {
            c -= 1;
        }
        Some(c)
    }

    fn axis(&self) -> String {
        let mut cells = vec![' '; self.columns];
        let step = self.tick();
        let first = i128::from(self.from.count()).div_euclid(step) * step;
        let mut free = 0;
        for k in 0..=self.columns as i128 {
            let Ok(at) = i64::try_from(first + k * step).map(Nanos::new) else { break };
            let Some(column) = self.column(at) else { continue };
            let label: Vec<char> = std::iter::once('|').chain(at.plain().chars()).collect();
            if column >= free && column + label.len() <= self.columns {
                free = column + label.len() + 1;
                cells.splice(column..column + label.len(), label);
            }
        }
        cells.into_iter().collect()
    }

    /// A round interval between marks that leaves room for their labels.
    fn tick(&self) -> i128 {
        let least = (self.span * 12 / self.columns as i128).max(1);
        let seconds = [10, 15, 20, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 21600, 43200, 86400];
        let small = (0..10).flat_map(|p| [1, 2, 5].map(|m| m * 10i128.pow(p)));
        let small = small.take_while(|t| *t < 10_000_000_000);
        let large = seconds.into_iter().map(|s: i128| s * 1_000_000_000);
        small
            .chain(large)
            .find(|t| *t >= least)
            .unwrap_or_else(|| least.div_euclid(86_400_000_000_000).max(1) * 86_400_000_000_000)
    }
}

fn lane(recording: &Recording, index: usize, signal: &Signal, grid: &Grid) -> Lane {
    let end = i64::try_from(i128::from(grid.from.count()) + grid.span).map_or(Nanos::MAX, Nanos::new);
    let last = recording.value_at(index, end).map_or_else(String::new, |v| v.show(signal.kind));
    let last = last.chars().map(visible).collect();
    let changes = recording.changes(index).filter(|(at, _)| *at >= grid.from && *at <= end).count();
    let (cells, note) = match signal.kind {
        Kind::Bool => (logic(recording, index, grid), String::new()),
        Kind::Real | Kind::Lreal => curve(recording, index, signal.kind, grid),
        Kind::Int { .. } | Kind::Time | Kind::Moment(_) if changes > grid.columns / 5 => {
            curve(recording, index, signal.kind, grid)
        }
        Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Text => {
            (bus(recording, index, signal.kind, grid), last)
        }
    };
    Lane { signal: index, label: shorten(&signal.name, LABEL), cells, note }
}

/// Draws a BOOL as `▁▁╱▔▔╲▁`; `╳` marks a column in which it changes more than once.
fn logic(recording: &Recording, index: usize, grid: &Grid) -> String {
    let mut edges: Vec<(u32, bool)> = vec![(0, false); grid.columns];
    for (at, value) in recording.changes(index).skip(1) {
        if let Some(cell) = grid.column(at).and_then(|c| edges.get_mut(c)) {
            *cell = (cell.0 + 1, value.word() != 0);
        }
    }
    let cell = |(column, (count, to)): (usize, (u32, bool))| match (count, to) {
        (0, _) => match recording.value_at(index, grid.instant(column)) {
            Some(v) if v.word() != 0 => '▔',
            Some(_) => '▁',
            None => first_later(recording, index, grid, column),
        },
        (1, true) => '╱',
        (1, false) => '╲',
        _ => '╳',
    };
    edges.into_iter().enumerate().map(cell).collect()
}

/// The character for the column in which the recording begins; columns before it are blank.
fn first_later(recording: &Recording, index: usize, grid: &Grid, column: usize) -> char {
    match recording.changes(index).next() {
        Some((at, value)) if grid.column(at) == Some(column) => {
            if value.word() != 0 {
                '▔'
            } else {
                '▁'
            }
        }
        _ => ' ',
    }
}

/// Draws a number as bars between the least and the greatest value shown.
fn curve(recording: &Recording, index: usize, kind: Kind, grid: &Grid) -> (String, String) {
    let values: Vec<Option<f64>> = (0..grid.columns)
        .map(|c| recording.value_at(index, grid.instant(c + 1) - Nanos::new(1)).map(|v| v.number(kind)))
        .collect();
    let finite = || values.iter().flatten().copied().filter(|x| x.is_finite());
    let (least, most) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let bar = |x: f64| {
        if !x.is_finite() {
            return '?';
        }
        let part = if most > least { (x - least) / (most - least) } else { 0.0 };
        BARS.get((part * 7.0).round() as usize).copied().unwrap_or('█')
    };
    let cells = values.iter().map(|x| x.map_or(' ', bar)).collect();
    let show = |x: f64| ((x * 1000.0).round() / 1000.0).to_string();
    let note = if least > most {
        String::new()
    } else if least == most {
        show(least)
    } else {
        format!("{} .. {}", show(least), show(most))
    };
    (cells, note)
}

/// Draws values as `0····│1····│2`: each value stands after the bar at which it begins.
fn bus(recording: &Recording, index: usize, kind: Kind, grid: &Grid) -> String {
    let mut cells = vec!['·'; grid.columns];
    let mut starts: Vec<(usize, Option<Value>, bool)> =
        vec![(0, recording.value_at(index, grid.from), false)];
    for (n, (at, value)) in recording.changes(index).enumerate() {
        let shown = at > grid.from || (n == 0 && at == grid.from);
        if let Some(column) = grid.column(at).filter(|_| shown) {
            starts.push((column, Some(value), n > 0));
        }
    }
    for (n, (column, value, bar)) in starts.iter().enumerate() {
        let end = starts.get(n + 1).map_or(grid.columns, |next| next.0);
        let blank = if value.is_some() { '·' } else { ' ' };
        if let Some(run) = cells.get_mut(*column..end) {
            run.fill(blank);
        }
        let mut text: Vec<char> = if *bar { vec!['│'] } else { Vec::new() };
        text.extend(value.as_ref().map_or_else(String::new, |v| v.show(kind)).chars().map(visible));
        if text.len() > end.saturating_sub(*column) {
            text.truncate(usize::from(*bar));
        }
        for (cell, c) in cells.iter_mut().skip(*column).zip(text) {
            *cell = c;
        }
    }
    cells.into_iter().collect()
}

fn visible(c: char) -> char {
    if c.is_control() { '␀' } else { c }
}

fn shorten(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.chars().map(visible).collect();
    }
    name.chars().take(most - 1).map(visible).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sample, write_text};

    fn one(kind: Kind, samples: &[(i64, Value)], columns: usize, to: i64) -> Lane {
        let mut r = Recording::new(vec![Signal { group: "inputs", name: "a".into(), kind }]);
        for (at, value) in samples {
            let text = write_text(&value.show(kind), 4);
            let sample = if kind == Kind::Text { Sample::Text(&text) } else { Sample::Word(value.word()) };
            r.sample(Nanos::new(*at), [sample]);
        }
        let mut drawn = Chronogram::new(&r, [0], style(columns, 0, to, to));
        drawn.lanes.remove(0)
    }

    fn style(columns: usize, from: i64, to: i64, until: i64) -> Style {
        Style { columns, from: Nanos::new(from), to: Nanos::new(to), until: Nanos::new(until) }
    }

    fn words(values: &[(i64, u64)]) -> Vec<(i64, Value)> {
        values.iter().map(|(t, w)| (*t, Value::Word(*w))).collect()
    }

    #[test]
    fn a_level_has_slopes_where_it_changes() {
        let samples = words(&[(0, 0), (20, 1), (60, 0), (80, 1), (85, 0)]);
        assert_eq!(one(Kind::Bool, &samples, 10, 100).cells, "▁▁╱▔▔▔╲▁╳▁");
    }

    #[test]
    fn what_is_not_known_yet_is_blank() {
        let mut r = Recording::new(vec![Signal { group: "", name: "a".into(), kind: Kind::Bool }]);
        r.sample(Nanos::ZERO, [Sample::Word(1)]);
        assert_eq!(Chronogram::new(&r, [0], style(10, 0, 100, 40)).lanes[0].cells, "▔▔▔▔▔     ");
    }

    #[test]
    fn before_the_first_sample_there_is_nothing() {
        assert_eq!(one(Kind::Bool, &words(&[(50, 1)]), 10, 100).cells, "     ▔▔▔▔▔");
    }

    #[test]
    fn a_counter_shows_its_values_where_they_fit() {
        let kind = Kind::Int { bits: 16, signed: true };
        let lane = one(kind, &words(&[(0, 0), (50, 1), (100, 12), (105, 13), (110, 7)]), 40, 200);
        assert_eq!(lane.cells, "0·········│1········│││7················");
        assert_eq!(lane.note, "7");
    }

    #[test]
    fn text_never_breaks_its_line() {
        let samples = [(0, Value::Text("a\nb".into())), (50, Value::Text("c\td".into()))];
        let lane = one(Kind::Text, &samples, 20, 100);
        assert_eq!((lane.cells.as_str(), lane.note.as_str()), ("a␀b·······│c␀d······", "c␀d"));
    }

    #[test]
    fn a_curve_runs_from_least_to_greatest() {
        let samples: Vec<_> = (0..8).map(|i| (i * 10, Value::Word((i as f64).to_bits()))).collect();
        let lane = one(Kind::Lreal, &samples, 8, 80);
        assert_eq!((lane.cells.as_str(), lane.note.as_str()), ("▁▂▃▄▅▆▇█", "0 .. 7"));
    }

    #[test]
    fn the_axis_has_round_times_that_do_not_collide() {
        let r = Recording::new(Vec::new());
        let axis = Chronogram::new(&r, [], style(60, 0, 60_000_000_000, 0)).axis;
        assert_eq!(axis, format!("{:60}", "|0s            |15s           |30s           |45s"));
    }

    #[test]
    fn extremes_of_time_and_width_do_no_harm() {
        for (columns, from, to) in [(0, 0, 0), (1, 5, 5), (3, i64::MIN, i64::MAX), (80, 7, 3)] {
            let mut r = Recording::new(vec![Signal { group: "", name: "a".into(), kind: Kind::Bool }]);
            r.sample(Nanos::new(5), [Sample::Word(1)]);
            let drawn = Chronogram::new(&r, [0, 7], style(columns, from, to, to));
            assert_eq!(drawn.lanes.len(), 1, "a signal that is not there has no lane");
            assert_eq!(drawn.lanes[0].cells.chars().count(), columns.max(1));
        }
    }
}
