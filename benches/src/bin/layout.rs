//! Measures the layout of a chart, and how it grows with the chart.
//!
//! Prints ms for charts of random structure with at least as many transitions as steps, without
//! jumps and with twenty jumps between arbitrary steps; also the number of broken links, and the
//! size of the drawing in u.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::time::Instant;

use g7_draw::{Extent, Placement, Sizes, U, layout};
use g7_model::Chart;

#[path = "../../../crates/draw/tests/layout/maker.rs"]
mod maker;

use maker::{Random, random_chart};

fn main() {
    let quick = std::env::args().any(|a| a == "--quick");
    println!("{:<30}{:>10}{:>10}{:>18}", "layout", "ms", "broken", "size in u");
    let sizes: &[usize] = if quick { &[50, 1000] } else { &[50, 200, 1000, 5000, 10_000] };
    for &steps in sizes {
        for jumps in [0, 20] {
            let document = random_chart(7, steps, jumps, 250);
            let Some(chart) = document.charts().next() else { continue };
            let (ms, p) = measure(chart);
            let transitions = chart.transitions().count();
            let what = format!("{} steps, {transitions} transitions", chart.steps().count());
            let area = format!("{} x {}", p.area.w / U, p.area.h / U);
            println!("{what:<30}{ms:>10.2}{:>10}{area:>18}", p.connectors.len() / 2);
        }
    }
}

/// The best of several runs, because other programs use the machine too.
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
