//! Charts that users have: those of `examples/`, and some with the mix of the charts that people drew
//! with other tools.
//!
//! The mix was counted in 146 files that `g7 import` reads, of ten tools: 460 charts, 3272 steps, 3531
//! transitions. Of 100 steps 13 have N, 17 P1, 2 S or R, 3 an action of each scan, 4 an action with a
//! condition, 2 enclose a chart, 2 give a forcing order; one in 400 has L or D. Of 100 receptivities
//! 54 join several variables, 23 are one variable or its complement, 16 compare numbers, 6 are always
//! true, 1 reads a time; one in 700 is an edge.

#![allow(clippy::disallowed_methods, reason = "a bench reads its charts")]

use std::fmt::Write;
use std::path::Path;

use crate::rows::Drive;

const INPUTS: usize = 24;
const STEPS: usize = 15;

/// The name, the inputs and the text of each chart.
pub(crate) fn charts() -> Vec<(String, Drive, String)> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let example = |name: &str, drive: Drive, file: &str| {
        let path = examples.join(file);
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        (name.to_owned(), drive, text)
    };
    let mut charts = vec![
        example("bead sorter", Drive::Random, "bead-sorter/chart.g7"),
        // Sensors that contradict one another make it unstable.
        example("workcell", Drive::InTurn, "transport-workcell/improved.g7"),
    ];
    for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
        charts.push((format!("mix of 300 steps {profile}"), Drive::Random, mix(profile, 300)));
    }
    charts
}

/// Rings of 15 steps, which the inputs move. Enclosures and orders are those of IEC 60848, so only
/// its profile has them.
pub fn mix(profile: &str, steps: usize) -> String {
    let charts = steps.div_ceil(STEPS);
    let mut t = format!("profile {profile}\n\n");
    for i in 0..INPUTS {
        let _ = writeln!(t, "input I{i} : BOOL");
    }
    for i in 0..charts * STEPS {
        if i % 7 == 0 || i % 50 < 3 {
            let _ = writeln!(t, "output Q{i} : BOOL");
        }
    }
    for c in 0..charts {
        let _ = writeln!(t, "var n{c} : INT");
    }
    for c in 0..charts {
        let _ = writeln!(t, "\nchart G{c} {{");
        let enclosed = profile == "iec60848" && c % 3 == 2;
        for k in 0..STEPS {
            let i = c * STEPS + k;
            let encloses = profile == "iec60848" && c % 3 == 1 && k == 4 && c + 1 < charts;
            let word = match (k, enclosed) {
                (0, false) => "initial step",
                _ if encloses => "enclosing step",
                _ => "step",
            };
            let star = if k == 0 && enclosed { "*" } else { "" };
            let _ = write!(t, "  {word} {i}{star} {{ {}", actions(profile, c, i));
            if encloses {
                let _ = write!(t, " enclose G{}", c + 1);
            }
            if profile == "iec60848" && c % 3 == 0 && k == 7 && c + 3 < charts {
                let _ = write!(t, " force G{} := {{*}}", c + 3);
            }
            t.push_str(" }\n");
        }
        for k in 0..STEPS {
            let (i, to) = (c * STEPS + k, c * STEPS + (k + 1) % STEPS);
            let _ = writeln!(t, "  {i} -> {to} when {}", receptivity(profile, c, i));
        }
        t.push_str("}\n");
    }
    t
}

fn actions(profile: &str, chart: usize, i: usize) -> String {
    let mut actions = Vec::new();
    match i % 50 {
        0 => actions.push(format!("S Q{}", i + 1)),
        1 => actions.push(format!("R Q{i}")),
        2 if i / 50 < 3 && profile != "pl7" => actions.push(format!("D 5ms Q{i}")),
        10 => actions.push(format!("each scan: n{chart} := n{chart} mod 100")),
        _ => {}
    }
    if i.is_multiple_of(7) && i % 50 > 2 {
        let condition = if i.is_multiple_of(3) { format!(" if not I{}", i % INPUTS) } else { String::new() };
        actions.push(format!("N Q{i}{condition}"));
    }
    if i % 6 == 1 {
        actions.push(format!("P1 n{chart} := n{chart} + 1"));
    }
    actions.join(" ")
}

fn receptivity(profile: &str, chart: usize, i: usize) -> String {
    let input = |k: usize| format!("I{}", (i * 7 + k * 5) % INPUTS);
    // A ring that can go round without time is unstable there.
    if profile == "iec60848" && i.is_multiple_of(STEPS) {
        return format!("{} and X{i}.t >= 3ms", input(0));
    }
    match i * 29 % 50 {
        0..=26 => format!("{} and not {} or {}", input(0), input(1), input(2)),
        27..=32 => input(0),
        33..=38 => format!("not {}", input(0)),
        39..=45 => format!("n{chart} mod 10 >= {}", i % 3),
        46..=48 => "true".to_owned(),
        _ if i == 49 => format!("↑{}", input(0)),
        // Step times count scans there.
        _ if profile == "jgrafchart" => format!("X{i}.t >= 20"),
        _ => format!("X{i}.t >= 20ms"),
    }
}
