//! Lays out random charts with structure, random charts without structure, and extreme charts.

use std::fmt::Write as _;

use g7_draw::{Extent, Sizes, layout};
use g7_model::{Chart, Document, FileId};
use g7_syntax::parse;

use crate::charts::random_sizes;
use crate::geometry::faults;
use crate::maker::{Random, random_chart};

fn document(text: &str) -> Document {
    let (document, problems) = parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    document
}

pub(crate) fn chart_of(body: &str) -> Document {
    document(&format!("chart G {{\n{body}}}\n"))
}

/// A chart without any structure: random links between random steps.
fn wild_chart(seed: u64) -> Document {
    let mut random = Random(seed);
    let steps = 1 + random.below(12);
    let mut body = String::new();
    for n in 0..steps {
        let initial = if random.below(4) == 0 { "initial " } else { "" };
        let _ = writeln!(body, "  {initial}step {n}");
    }
    for _ in 0..random.below(14) {
        let some = |random: &mut Random| {
            let mut all: Vec<usize> =
                (0..random.below(3).max(random.below(2))).map(|_| random.below(steps)).collect();
            all.sort_unstable();
            all.dedup();
            let all: Vec<String> = all.iter().map(ToString::to_string).collect();
            if all.len() == 1 { all.concat() } else { format!("({})", all.join(", ")) }
        };
        let (from, to) = (some(&mut random), some(&mut random));
        let _ = writeln!(body, "  {from} -> {to} when TRUE");
    }
    chart_of(&body)
}

fn fine(what: &str, document: &Document, random: &mut Random) {
    for chart in document.charts() {
        let sizes = random_sizes(chart, random);
        let found = faults(chart, &sizes, &layout(chart, &sizes, &[]));
        assert!(found.is_empty(), "{what}: {found:#?}\n{}", g7_syntax::print(document, None));
    }
}

#[test]
fn structured_charts_have_no_faults() {
    for seed in 0..600 {
        let mut random = Random(seed);
        let size = 2 + random.below(80);
        fine(&format!("seed {seed}"), &random_chart(seed, size, 0, size), &mut random);
    }
}

#[test]
fn charts_with_jumps_have_no_faults() {
    for seed in 0..600 {
        let mut random = Random(seed);
        let (size, jumps) = (2 + random.below(80), 1 + random.below(12));
        fine(&format!("seed {seed}"), &random_chart(seed, size, jumps, size), &mut random);
    }
}

#[test]
fn charts_without_structure_have_no_faults() {
    for seed in 0..3000 {
        fine(&format!("seed {seed}"), &wild_chart(seed), &mut Random(seed));
    }
}

pub(crate) fn only(document: &Document) -> &Chart {
    document.charts().next().expect("a chart")
}

#[test]
fn a_jump_into_a_branch_breaks_one_link() {
    let body = "initial step 1 step 2 step 3 step 4 step 5 step 6 step 7\n\
                1 -> 2 when TRUE 1 -> 3 when TRUE 2 -> 4 when TRUE 4 -> 6 when TRUE\n\
                3 -> 5 when TRUE 5 -> 6 when TRUE 6 -> 7 when TRUE 3 -> 4 when FALSE 7 -> 1 when TRUE\n";
    let document = chart_of(body);
    let chart = only(&document);
    let sizes = random_sizes(chart, &mut Random(1));
    assert_eq!(layout(chart, &sizes, &[]).connectors.len(), 2);
}

#[test]
fn charts_without_jumps_break_few_links() {
    for seed in 0..20 {
        let document = random_chart(seed, 40, 0, 40);
        let chart = only(&document);
        let plain = Sizes {
            steps: chart.steps().map(|_| Extent { left: 250, right: 250, up: 0, down: 500 }).collect(),
            transitions: chart
                .transitions()
                .map(|_| Extent { left: 220, right: 400, up: 70, down: 70 })
                .collect(),
            connectors: vec![200; chart.steps().count()],
        };
        if chart.steps().filter(|s| s.initial).count() > 1 {
            continue;
        }
        let p = layout(chart, &plain, &[]);
        let back_inside = p.connectors.len() / 2;
        assert!(back_inside * 10 <= p.links.len(), "seed {seed}: {back_inside} broken");
    }
}

#[test]
fn extremes_are_laid_out() {
    let mut deep = String::from("initial step 0\n");
    for n in 0..5_000 {
        let a = n * 3;
        let _ = writeln!(deep, "step {} step {} step {}", a + 1, a + 2, a + 3);
        let _ = writeln!(deep, "{a} -> ({}, {}) when TRUE", a + 1, a + 2);
    }
    let mut wide = String::from("initial step 0\nstep last\n");
    for n in 1..5_000 {
        let _ = writeln!(wide, "step {n}\n0 -> {n} when TRUE {n} -> last when TRUE");
    }
    let mut nested = String::from("initial step 0\n");
    for n in 0..2_000 {
        let _ = writeln!(nested, "step a{n} step b{n}");
        let from = if n == 0 { "0".to_owned() } else { format!("a{}", n - 1) };
        let _ = writeln!(nested, "{from} -> a{n} when TRUE {from} -> b{n} when FALSE b{n} -> 0 when TRUE");
    }
    let mut many = String::new();
    (0..3_000).for_each(|n| {
        let _ = writeln!(many, "step {n}");
    });
    for (what, body) in
        [("empty", ""), ("deep", &deep), ("wide", &wide), ("nested", &nested), ("many", &many)]
    {
        let document = chart_of(body);
        fine(what, &document, &mut Random(1));
    }
}
