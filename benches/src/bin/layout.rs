//! How long does the layout of a chart take, and does it grow with the chart?
//!
//! Prints ms for charts of random structure with as many transitions as steps and
//! more, without jumps and with twenty from anywhere to anywhere; beside it how
//! many links were broken, and the size of the drawing in u.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::fmt::Write as _;
use std::time::Instant;

use g7_draw::{Extent, Placement, Sizes, U, layout};
use g7_model::{Chart, FileId};

fn main() {
    let quick = std::env::args().any(|a| a == "--quick");
    println!("{:<30}{:>10}{:>10}{:>18}", "layout", "ms", "broken", "size in u");
    let sizes: &[usize] = if quick { &[50, 1000] } else { &[50, 200, 1000, 5000, 10_000] };
    for &steps in sizes {
        for jumps in [0, 20] {
            let document = Maker::chart(steps, jumps);
            let Some(chart) = document.charts().next() else { continue };
            let (ms, p) = measure(chart);
            let transitions = chart.transitions().count();
            let what = format!("{} steps, {transitions} transitions", chart.steps().count());
            let area = format!("{} x {}", p.area.w / U, p.area.h / U);
            println!("{what:<30}{ms:>10.2}{:>10}{area:>18}", p.connectors.len() / 2);
        }
    }
}

/// The best of some runs: others use the machine too.
fn measure(chart: &Chart) -> (f64, Placement) {
    let mut seed = Random(5);
    let mut extent = |half: i32, up: i32, down: i32| Extent {
        left: half,
        right: half + if seed.below(10) < 6 { 200 + seed.below(1500) as i32 } else { 0 },
        up,
        down,
    };
    let sizes = Sizes {
        steps: chart.steps().map(|_| extent(250, 0, 500)).collect(),
        transitions: chart.transitions().map(|_| extent(220, 70, 70)).collect(),
        connectors: chart.steps().map(|_| 300).collect(),
    };
    let mut best = f64::INFINITY;
    let mut placement = Placement::default();
    for _ in 0..7 {
        let start = Instant::now();
        placement = layout(chart, &sizes, &[]);
        best = best.min(start.elapsed().as_secs_f64() * 1000.0);
    }
    (best, placement)
}

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// A chart in the making.
struct Maker {
    random: Random,
    steps: usize,
    links: String,
}

impl Maker {
    /// Sequences of at most 250 steps in one loop, forks, alternatives, jumps.
    fn chart(steps: usize, jumps: usize) -> g7_model::Document {
        let mut m = Maker { random: Random(7), steps: 0, links: String::new() };
        let (first, mut last) = m.sequence(0, steps.min(250));
        while m.steps < steps {
            let (a, b) = m.sequence(0, (steps - m.steps).min(250));
            m.link(&[last], &[a]);
            last = b;
        }
        m.link(&[last], &[first]);
        for _ in 0..jumps {
            let (a, b) = (m.random.below(m.steps), m.random.below(m.steps));
            m.link(&[a], &[b]);
        }
        let mut text = String::from("chart G {\n  initial step 0\n");
        (1..m.steps).for_each(|n| {
            let _ = writeln!(text, "  step {n}");
        });
        text.push_str(&m.links);
        text.push_str("}\n");
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        assert!(problems.is_empty(), "{problems:?}");
        document
    }

    fn step(&mut self) -> usize {
        self.steps += 1;
        self.steps - 1
    }

    fn link(&mut self, from: &[usize], to: &[usize]) {
        let list = |steps: &[usize]| {
            let all: Vec<String> = steps.iter().map(ToString::to_string).collect();
            if all.len() == 1 { all.concat() } else { format!("({})", all.join(", ")) }
        };
        let _ = writeln!(self.links, "  {} -> {} when TRUE", list(from), list(to));
    }

    /// A sequence; its first and last step.
    fn sequence(&mut self, depth: usize, size: usize) -> (usize, usize) {
        let first = self.step();
        let (mut last, mut used) = (first, 1);
        while used < size {
            let chance = self.random.below(100);
            if depth >= 4 || chance >= 24 || size - used <= 6 {
                let next = self.step();
                self.link(&[last], &[next]);
                (last, used) = (next, used + 1);
                continue;
            }
            let count = 2 + self.random.below(2);
            let each = ((size - used) / count).min(8 + self.random.below(10)).max(2);
            let ends: Vec<_> = (0..count).map(|_| self.sequence(depth + 1, each)).collect();
            let (heads, tails): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
            let next = self.step();
            if chance < 12 {
                self.link(&[last], &heads);
                self.link(&tails, &[next]);
            } else {
                heads.iter().for_each(|h| self.link(&[last], &[*h]));
                tails.iter().for_each(|t| self.link(&[*t], &[next]));
            }
            (last, used) = (next, used + each * count + 1);
        }
        (first, last)
    }
}
