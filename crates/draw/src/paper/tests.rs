//! The rules of sheets of paper: no symbol is cut or missing, and each end of a link names the sheet of the other.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Chart, Document, FileId};

use super::{Paper, Sheet, sheets};
use crate::{End, Options, Part, Rect};

/// A chart of so many steps in a row, with a branch at each tenth, a fork and a join over all of it, and a loop.
pub(crate) fn long(steps: usize) -> Document {
    let mut text = String::from("input a : BOOL\noutput m : BOOL\nchart Long {\n  initial step 0\n");
    for n in 1..=steps {
        let comment = if n % 7 == 0 { " \"waits for the part that comes\"" } else { "" };
        text.push_str(&format!("  step {n}{comment} {{ N m }}\n"));
    }
    let half = steps / 2;
    text.push_str(&format!("  0 -> (1, {half}) when a\n"));
    for n in 1..steps {
        if n + 1 != half {
            text.push_str(&format!("  {n} -> {} when ↑a and not X{n}\n", n + 1));
        }
        if n % 10 == 0 && n + 15 < half {
            text.push_str(&format!("  {n} -> {} when not a\n", n + 15));
        }
    }
    text.push_str(&format!("  ({}, {steps}) -> 0 when a\n}}\n", half - 1));
    text.push_str("layout Long {\n  comment \"look here\" at 30, 2\n}\n");
    g7_syntax::parse(&text, FileId(0)).0
}

/// A chart whose transitions join and part steps at random, near and far.
fn tangled(seed: u64, steps: usize) -> Document {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let mut text = String::from("input a : BOOL\noutput m : BOOL\nchart Tangled {\n  initial step 0\n");
    for n in 1..steps {
        let action = ["", " { N m }", " \"a remark of some length, which breaks\""][random(3)];
        text.push_str(&format!("  step {n}{action}\n"));
    }
    for n in 0..steps {
        let near = |k: usize| (n + k) % steps;
        let when = ["a", "↑a and not X0 or not a and X0 or ↓a", "5s/X0"][random(3)];
        let (from, to) = match random(8) {
            0 => (format!("({n}, {})", near(1 + random(4))), format!("{}", near(5))),
            1 => (format!("{n}"), format!("({}, {}, {})", near(1), near(2 + random(6)), random(steps))),
            2 => (format!("{n}"), format!("{}", random(steps))),
            _ => (format!("{n}"), format!("{}", near(1))),
        };
        text.push_str(&format!("  {from} -> {to} when {when}\n"));
    }
    g7_syntax::parse(&(text + "}\n"), FileId(0)).0
}

#[test]
fn random_charts_stand_on_sheets_without_a_cut() {
    let mut divided = 0;
    for seed in 1..=4 {
        let document = tangled(seed, 10 + 10 * seed as usize);
        let chart = document.charts().next().expect("a chart");
        for (name, paper) in Paper::ALL {
            let made = sheets(&document, chart, &Options::default(), &paper, 1);
            divided += usize::from(made.len() > 1);
            assert_eq!(faults(chart, &made, paper, 1), Vec::<String>::new(), "seed {seed} on {name}");
        }
    }
    assert!(divided > 6, "{divided}");
}

fn symbols(chart: &Chart) -> BTreeSet<String> {
    let steps = (0..chart.steps().count()).map(|n| format!("{:?}", End::Step(n as u32)));
    steps
        .chain((0..chart.transitions().count()).map(|n| format!("{:?}", End::Transition(n as u32))))
        .collect()
}

/// Tells what is wrong with the sheets of a chart, which begin with a number.
fn faults(chart: &Chart, made: &[Sheet], paper: Paper, first: usize) -> Vec<String> {
    let mut faults = Vec::new();
    let [w, h] = paper.room();
    let mut pages: BTreeMap<String, usize> = BTreeMap::new();
    for (number, sheet) in (first..).zip(made) {
        for s in &sheet.symbols {
            if pages.insert(format!("{s:?}"), number).is_some() {
                faults.push(format!("{s:?} stands on two sheets"));
            }
        }
        let area = sheet.drawing.area;
        let on_paper = |n: i32| i64::from(n) * i64::from(sheet.scale) / 1000;
        if on_paper(area.w) > i64::from(w) || on_paper(area.h) > i64::from(h) {
            faults.push(format!("sheet {number} is full: {area:?} at {}", sheet.scale));
        }
        for item in &sheet.drawing.items {
            if item.area.union(&area) != area {
                faults.push(format!("{:?} is cut on sheet {number}", item.part));
            }
        }
        let drawn = |of: &dyn Fn(&Part) -> Option<End>| {
            sheet
                .drawing
                .items
                .iter()
                .filter_map(|i| of(&i.part))
                .map(|e| format!("{e:?}"))
                .collect::<BTreeSet<_>>()
        };
        let symbol = |p: &Part| match p {
            Part::Step { step, .. } => Some(End::Step(*step)),
            Part::Transition { transition, .. } => Some(End::Transition(*transition)),
            _ => None,
        };
        let own: BTreeSet<String> = sheet.symbols.iter().map(|s| format!("{s:?}")).collect();
        if drawn(&symbol) != own {
            faults.push(format!("sheet {number} draws other symbols than it has"));
        }
        overlaps(sheet, number, &mut faults);
    }
    if pages.keys().cloned().collect::<BTreeSet<_>>() != symbols(chart) {
        faults.push("a symbol has no sheet".to_owned());
    }
    // A link between two sheets has one end on each, and each end names the sheet of the other.
    let mut ends: BTreeMap<String, Vec<(bool, usize, usize)>> = BTreeMap::new();
    for (number, sheet) in (first..).zip(made) {
        for a in &sheet.away {
            let link = format!("{:?} to {:?}", a.from, a.to);
            ends.entry(link).or_default().push((a.leaving, number, a.page));
            let label = crate::symbols::connector_label(&a.name, Some(a.page as u32));
            let shown = sheet
                .drawing
                .items
                .iter()
                .any(|i| i.picture.svg().contains(&crate::ink::escape(label.trim())));
            if !shown {
                faults.push(format!("sheet {number} does not say {label}"));
            }
            let other = if a.leaving { a.to } else { a.from };
            if pages.get(&format!("{other:?}")) != Some(&a.page) {
                faults.push(format!("{label} on sheet {number} is wrong"));
            }
        }
    }
    for (link, mut two) in ends {
        two.sort_unstable();
        match two.as_slice() {
            [(false, here, there), (true, of, to)] if here == to && there == of => {}
            _ => faults.push(format!("{link}: {two:?}")),
        }
    }
    faults
}

/// Symbols that lie over each other.
fn overlaps(sheet: &Sheet, number: usize, faults: &mut Vec<String>) {
    let box_of = |p: &Part| match p {
        Part::Step { square, .. } => Some(*square),
        Part::Transition { bar, .. } => Some(*bar),
        _ => None,
    };
    let boxes: Vec<Rect> = sheet.drawing.items.iter().filter_map(|i| box_of(&i.part)).collect();
    for (k, a) in boxes.iter().enumerate() {
        if boxes.iter().skip(k + 1).any(|b| a.overlaps(b)) {
            faults.push(format!("symbols overlap on sheet {number}: {a:?}"));
        }
    }
}

#[test]
fn a_long_chart_stands_on_sheets_without_a_cut() {
    for steps in [40, 120, 492] {
        let document = long(steps);
        let chart = document.charts().next().expect("a chart");
        for (name, paper) in Paper::ALL {
            let made = sheets(&document, chart, &Options::default(), &paper, 3);
            assert!(made.len() > 1 || steps < 100, "{steps} steps on {name}");
            assert_eq!(faults(chart, &made, paper, 3), Vec::<String>::new(), "{steps} steps on {name}");
            assert!(made.iter().all(|s| (900..=1000).contains(&s.scale)), "{name} is legible");
            let notes = made.iter().flat_map(|s| &s.drawing.items);
            let notes = notes.filter(|i| matches!(i.part, Part::Comment { .. })).count();
            assert_eq!(notes, 1, "the comment of the layout section stands on one sheet");
        }
    }
}

#[test]
fn a_chart_that_fits_stands_on_one_sheet_as_it_is_laid_out() {
    let document = g7_syntax::parse(
        "input a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when not a\n}\n\
         layout G {\n  step 1 at 0, 0\n  step 2 at 3, 12\n}\n",
        FileId(0),
    )
    .0;
    let chart = document.charts().next().expect("a chart");
    let made = sheets(&document, chart, &Options::default(), &Paper::default(), 1);
    assert_eq!(made.len(), 1);
    assert_eq!(made[0].drawing, crate::draw(&document, chart, &Options::default()));
    assert!(made[0].away.is_empty());
}

#[test]
fn a_symbol_larger_than_a_sheet_is_smaller_on_its_own() {
    let actions: String = (0..300).map(|n| format!("    P1 n := {n}\n")).collect();
    let text = format!(
        "input a : BOOL\nvar n : INT\nchart G {{\n  initial step 1\n  step 2 {{\n{actions}  }}\n  step 3\n\
         1 -> 2 when a\n  2 -> 3 when a\n  3 -> 1 when a\n}}\n"
    );
    let document = g7_syntax::parse(&text, FileId(0)).0;
    let chart = document.charts().next().expect("a chart");
    let paper = Paper::default();
    let made = sheets(&document, chart, &Options::default(), &paper, 1);
    assert_eq!(faults(chart, &made, paper, 1), Vec::<String>::new());
    assert!(made.iter().any(|s| s.scale < 900) && made.iter().any(|s| s.scale >= 900));
}

#[test]
fn the_same_chart_gives_the_same_sheets() {
    let document = long(200);
    let chart = document.charts().next().expect("a chart");
    let make = || sheets(&document, chart, &Options::default(), &Paper::default(), 1);
    assert_eq!(make(), make());
}
