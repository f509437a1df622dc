//! Draws chronograms: one lane for each signal, one below the other, over one time axis.

use g7_model::Nanos;

use crate::ink::{Ink, Picture};
use crate::svg::standalone;
use crate::text::{duration, shortened, width};
use crate::{Options, Point, Rect};

/// The recorded signals of a run over a span of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chronogram {
    /// The signals, from top to bottom.
    pub lanes: Vec<Lane>,
    /// First instant shown.
    pub from: Nanos,
    /// Last instant shown.
    pub to: Nanos,
}

/// One signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// The signal's name, written at the left.
    pub name: String,
    /// How the lane is drawn.
    pub kind: LaneKind,
    /// The changes of the value, ordered by time; each value holds until the next change.
    pub edges: Vec<Edge>,
}

/// How a signal is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneKind {
    /// A line with a low and a high level.
    Bool,
    /// A bar while the step is active.
    Step,
    /// A staircase between the least and the greatest value.
    Number,
    /// A box for each value, with the value written in it.
    Text,
}

/// One change of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The instant of the change.
    pub at: Nanos,
    /// The value as a number; a Boolean is 0 or 1.
    pub value: f64,
    /// The value as text, for the reader.
    pub show: String,
}

/// Usual width of the plot area.
const PLOT: i32 = 9000;
/// Height of a lane.
const LANE: i32 = 300;
/// Height of a waveform within its lane.
const WAVE: i32 = 180;
/// Size of signal names and axis labels.
const TEXT: i32 = 120;
/// Height of the time axis.
const AXIS: i32 = 260;
/// Greatest width of a signal name; longer names are shortened.
const NAME: i32 = 2600;

/// Draws a chronogram as an SVG file.
pub fn chronogram_svg(chronogram: &Chronogram, options: &Options) -> String {
    let (p, area) = chronogram_picture(chronogram, None);
    standalone(area, options, "chronogram", &p.svg())
}

/// Draws a chronogram so that it is as wide as given; without a width as wide as usual. Tells its box as well.
pub fn chronogram_picture(chronogram: &Chronogram, wide: Option<i32>) -> (Picture, Rect) {
    let most = wide.map_or(NAME, |wide| NAME.min(wide / 3));
    let names: Vec<String> = chronogram.lanes.iter().map(|l| shortened(&l.name, TEXT, most).0).collect();
    let left = names.iter().map(|n| width(n, TEXT)).max().unwrap_or(0) + 120;
    // The last time stands half over the right edge.
    let room = wide.map_or(PLOT, |wide| (wide - left - 300).max(1000));
    let to = chronogram.to.max(chronogram.from + Nanos::new(1));
    let plot = Plot { left, room, from: chronogram.from, to };
    let low = AXIS + LANE * i32::try_from(chronogram.lanes.len()).unwrap_or(i32::MAX / LANE - 1);
    let mut p = Picture::default();
    plot.axis(&mut p, low);
    for ((lane, name), i) in chronogram.lanes.iter().zip(&names).zip(0..) {
        let base = AXIS + LANE * i + (LANE + WAVE) / 2;
        p.text("g7-name", left - 120 - width(name, TEXT), base - WAVE / 2 + TEXT * 35 / 100, TEXT, name);
        plot.lane(&mut p, lane, base);
    }
    let area = p.area().unwrap_or_default().union(&Rect { x: 0, y: 0, w: left + room, h: low });
    (p, area)
}

/// The plot area and the span of time that it covers.
struct Plot {
    left: i32,
    /// Its width.
    room: i32,
    from: Nanos,
    to: Nanos,
}

impl Plot {
    /// The horizontal position of an instant; instants outside the span lie on its edge.
    fn x(&self, at: Nanos) -> i32 {
        let count = |time: Nanos| i128::from(time.count());
        let span = count(self.to) - count(self.from);
        let into = count(at.clamp(self.from, self.to)) - count(self.from);
        self.left + i32::try_from(into * i128::from(self.room) / span.max(1)).unwrap_or(self.room)
    }

    /// Draws the time axis: about ten grid lines at round times, each with its label.
    fn axis(&self, p: &mut Picture, low: i32) {
        let step = tick(self.to - self.from);
        let mut at = Nanos::new(self.from.count().div_euclid(step.count())) * step.count();
        while at <= self.to {
            if at >= self.from {
                let (x, text) = (self.x(at), duration(at));
                p.line("g7-grid", &[(x, AXIS - 60), (x, low)]);
                p.text("g7-note", x - width(&text, TEXT) / 2, AXIS - 110, TEXT, &text);
            }
            let Some(next) = at.checked_add(step) else { break };
            at = next;
        }
    }

    fn lane(&self, p: &mut Picture, lane: &Lane, base: i32) {
        p.line("g7-grid", &[(self.left, base), (self.left + self.room, base)]);
        let pieces = self.pieces(&lane.edges);
        match lane.kind {
            LaneKind::Bool => stair(p, &pieces, |e| if e.value == 0.0 { base } else { base - WAVE }),
            LaneKind::Step => {
                for (a, b, _) in pieces.iter().filter(|(_, _, e)| e.value != 0.0) {
                    p.rect("g7-active", *a, base - WAVE, (b - a).max(8), WAVE);
                }
            }
            LaneKind::Number => {
                let values = || pieces.iter().map(|(_, _, e)| e.value).filter(|v| v.is_finite());
                let (least, most) = values().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
                let height = |e: &Edge| match (e.value - least) / (most - least) {
                    part if part.is_finite() => base - (part * f64::from(WAVE)).round() as i32,
                    _ => base - WAVE / 2,
                };
                stair(p, &pieces, height);
                for (a, b, e) in &pieces {
                    let room = width(&e.show, 90) + 30;
                    let y = height(e) - 30;
                    if b - a > room {
                        p.text("g7-note", a + 25, y, 90, &e.show);
                    }
                }
            }
            LaneKind::Text => {
                for (a, b, e) in &pieces {
                    p.rect("g7-inner", *a, base - WAVE, b - a, WAVE);
                    let (text, _) = shortened(&e.show, 100, b - a - 60);
                    if width(&text, 100) + 60 <= b - a {
                        p.text("g7-note", a + 30, base - WAVE / 2 + 35, 100, &text);
                    }
                }
            }
        }
    }

    /// For each value that is visible: where it begins, where it ends, and the change itself.
    fn pieces<'a>(&self, edges: &'a [Edge]) -> Vec<(i32, i32, &'a Edge)> {
        let ends = edges.iter().skip(1).map(|e| e.at).chain(std::iter::once(self.to));
        let seen = edges.iter().zip(ends).filter(|(e, end)| *end > self.from && e.at <= self.to);
        seen.map(|(e, end)| (self.x(e.at), self.x(end), e)).collect()
    }
}

/// Draws a staircase line through the heights of the values.
fn stair(p: &mut Picture, pieces: &[(i32, i32, &Edge)], height: impl Fn(&Edge) -> i32) {
    let mut points: Vec<Point> = Vec::new();
    for (a, b, e) in pieces {
        let y = height(e);
        if points.last().is_some_and(|l| l.y == y && l.x == *a) {
            points.pop();
        } else {
            points.push(Point { x: *a, y });
        }
        points.push(Point { x: *b, y });
    }
    if points.len() > 1 {
        p.ink.push(Ink::Line("g7-wave", points));
    }
}

/// A round interval that divides the span into about ten parts.
fn tick(span: Nanos) -> Nanos {
    let long = [1, 2, 5, 10, 15, 30, 60, 120, 360, 720, 1440].map(|m| Nanos::MINUTE * m);
    let longest = Nanos::SECOND * 30;
    let mut short = Nanos::new(1);
    while short <= longest {
        for step in [short, short * 2, short * 5] {
            if span.count_of(step) <= 12 && step <= longest {
                return step;
            }
        }
        short = short * 10;
    }
    long.into_iter().find(|step| span.count_of(*step) <= 12).unwrap_or(span / 10 + Nanos::new(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: Nanos = Nanos::SECOND;

    fn edge(at: Nanos, value: f64) -> Edge {
        Edge { at, value, show: value.to_string() }
    }

    fn one(kind: LaneKind, edges: Vec<Edge>) -> String {
        let lanes = vec![Lane { name: "a<b".to_owned(), kind, edges }];
        let c = Chronogram { lanes, from: Nanos::ZERO, to: S * 10 };
        chronogram_svg(&c, &Options { font: false, ..Options::default() })
    }

    #[test]
    fn a_boolean_rises_and_falls_where_its_edges_are() {
        let svg = one(LaneKind::Bool, vec![edge(Nanos::ZERO, 0.0), edge(S * 2, 1.0), edge(S * 4, 0.0)]);
        // 10 s are 900 px wide; the waveform is 18 px high.
        let wave = svg.split("g7-wave\" d=\"").nth(1).and_then(|s| s.split('"').next()).expect("a wave");
        let x0: f64 = wave[1..].split(' ').next().and_then(|n| n.parse().ok()).expect("its start");
        assert!(wave.contains(&format!("H{}V", x0 + 180.0)), "{wave}");
        assert!(wave.contains(&format!("H{}V", x0 + 360.0)), "{wave}");
        assert!(wave.ends_with(&format!("H{}", x0 + 900.0)), "{wave}");
        assert!(svg.contains("a&lt;b") && svg.contains(">2s<"));
    }

    #[test]
    fn a_step_is_a_bar_for_each_time_it_is_active() {
        let edges = vec![edge(Nanos::ZERO, 1.0), edge(S, 0.0), edge(S * 5, 1.0)];
        let svg = one(LaneKind::Step, edges);
        assert_eq!(svg.matches("class=\"g7-active\"").count(), 2);
        assert!(svg.contains("width=\"90\"") && svg.contains("width=\"450\""));
    }

    #[test]
    fn nothing_to_show_and_numbers_without_measure_are_no_fault() {
        let c = Chronogram { lanes: Vec::new(), from: Nanos::new(i64::MIN), to: Nanos::MAX };
        assert!(chronogram_svg(&c, &Options::default()).starts_with("<svg"));
        let svg = one(
            LaneKind::Number,
            vec![edge(Nanos::new(-5), f64::NAN), edge(S, f64::INFINITY), edge(S * 2, 1.0)],
        );
        assert!(svg.contains("g7-wave") && !svg.contains("NaN\""));
        assert!(one(LaneKind::Text, Vec::new()).starts_with("<svg"));
    }

    #[test]
    fn the_axis_has_round_times() {
        for (span, step) in
            [(S * 10, S), (S * 100, S * 10), (S * 600, S * 60), (S, S / 10), (S * 3600, S * 300)]
        {
            assert_eq!(tick(span), step, "{span}");
        }
        assert!(tick(Nanos::MAX) > Nanos::ZERO && tick(Nanos::ZERO) == Nanos::new(1));
    }
}
