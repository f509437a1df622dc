//! The rows of the table of scans: charts with one feature each, at several sizes, and the charts
//! that users have. `bin/rows.rs` measures them.
//!
//! A chart is a ring of steps with one token (`par`: many rings of ten), whose transitions wait for
//! GO. While it waits, GO is false and the input T, which only some rows read, changes in each scan.

use std::fmt::Write;

use crate::mix;

/// One row: a chart and how its inputs change.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name in the tables, without tabs.
    pub name: String,
    /// The chart as .g7 text.
    pub text: String,
    /// How the inputs change while the chart moves.
    pub drive: Drive,
}

/// How the inputs change while a chart moves. A scan takes 1 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// GO is true.
    Steady,
    /// GO changes in each scan.
    Pulses,
    /// Any input may change, one in each scan.
    Random,
    /// One input is true, in each scan the next one.
    InTurn,
}

impl Drive {
    /// Sets the BOOL inputs for the scan `k`, GO being the first and T the second. `random` is the
    /// state of the generator.
    pub fn set(self, inputs: &mut [u64], k: u64, moving: bool, random: &mut u64) {
        if self == Drive::Random && moving {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let i = (*random >> 33) as usize % inputs.len().max(1);
            if let Some(input) = inputs.get_mut(i) {
                *input ^= 1;
            }
            return;
        }
        if self == Drive::InTurn && moving {
            let n = inputs.len().max(1) as u64;
            (0..).zip(inputs).for_each(|(i, input)| *input = u64::from(i == k % n));
            return;
        }
        if let [go, rest @ ..] = inputs {
            *go = match (moving, self) {
                (false, _) => 0,
                (true, Drive::Pulses) => k & 1,
                (true, _) => 1,
            };
            if let [t, ..] = rest {
                *t = if moving { 0 } else { k & 1 };
            }
        }
    }
}

/// The features of a ring.
#[derive(Clone, Copy, Debug, Default)]
struct Ring<'a> {
    profile: &'a str,
    /// Receptivity of each transition; `@` stands for its preceding step. `GO` by default.
    receptivity: &'a str,
    /// The same of every other transition, where it differs. Under `iec60848` a ring whose transitions
    /// all wait for the same would be unstable.
    odd: &'a str,
    /// Actions of each step; `@` stands for the step. `N Q@` by default.
    actions: &'a str,
    /// Charts and declarations beside it.
    beside: &'a str,
    /// Steps in a ring; one ring by default.
    each: usize,
    /// More inputs, which nothing reads.
    inputs: usize,
}

impl Ring<'_> {
    fn text(&self, steps: usize) -> String {
        fn or<'t>(text: &'t str, default: &'t str) -> &'t str {
            if text.is_empty() { default } else { text }
        }
        let each = if self.each == 0 { steps } else { self.each };
        let mut t = format!("profile {}\n\ninput GO, T : BOOL\n", or(self.profile, "iec61131"));
        for i in 0..self.inputs {
            let _ = writeln!(t, "input I{i} : BOOL");
        }
        for i in 0..steps {
            let _ = writeln!(t, "output Q{i} : BOOL");
        }
        let beside =
            self.beside.split_once("---").map_or(("", self.beside), |(declared, charts)| (declared, charts));
        let _ = writeln!(t, "{}\nchart Main {{", beside.0);
        for i in 0..steps {
            let word = if i % each == 0 { "initial step" } else { "step" };
            let actions = or(self.actions, "N Q@").replace('@', &i.to_string());
            let _ = writeln!(t, "  {word} {i} {{ {actions} }}");
        }
        for i in 0..steps {
            let to = i / each * each + (i + 1) % each;
            let receptivity = or(if i % 2 == 1 { self.odd } else { "" }, or(self.receptivity, "GO"))
                .replace('@', &i.to_string());
            let _ = writeln!(t, "  {i} -> {to} when {receptivity}");
        }
        let _ = writeln!(t, "}}\n{}", beside.1);
        t
    }
}

/// Charts without an active step, each with one feature that is not used.
const UNUSED: [(&str, &str); 6] = [
    ("P1", "var n : INT\n---chart Idle {\n  step A\n  step B { P1 n := n + 1 }\n  A -> B when T\n}"),
    (
        "macro-step",
        "chart Idle {\n  step A\n  macro M = Inner\n  A -> M when T\n}\n\
         macrochart Inner {\n  entry step E\n  exit step S\n  E -> S when GO\n}",
    ),
    (
        "enclosure",
        "chart Idle {\n  step A\n  enclosing step B { enclose Inner }\n  A -> B when T\n}\n\
         chart Inner {\n  step C*\n  step D\n  C -> D when GO\n}",
    ),
    (
        "order",
        "chart Idle {\n  step A\n  step B { force Other := {*} }\n  A -> B when T\n}\n\
         chart Other {\n  step C\n  step D\n  C -> D when T\n}",
    ),
    ("edge", "chart Idle {\n  step A\n  step B\n  A -> B when ↑I0\n}"),
    ("timer", "chart Idle {\n  step A\n  step B\n  A -> B when 1s/A.X\n}"),
];

/// The features that each step of a ring has: name, drive, ring.
fn features() -> Vec<(&'static str, Drive, Ring<'static>)> {
    let ring = Ring::default();
    vec![
        ("expression", Drive::Steady, Ring { receptivity: "GO and not T", ..ring }),
        ("step time", Drive::Steady, Ring { receptivity: "GO and X@.t >= 1ms", ..ring }),
        ("timer", Drive::Steady, Ring { receptivity: "GO and 1ms/X@", ..ring }),
        ("S and R", Drive::Steady, Ring { actions: "S Q@ R Q0", ..ring }),
        ("D", Drive::Steady, Ring { actions: "D 1ms Q@", ..ring }),
        ("L", Drive::Steady, Ring { actions: "L 1ms Q@", ..ring }),
        ("P1", Drive::Steady, Ring { actions: "P1 n := n + 1", beside: "var n : DINT\n---", ..ring }),
        ("edge", Drive::Pulses, Ring { receptivity: "↑GO", ..ring }),
        ("condition", Drive::Steady, Ring { actions: "N Q@ if not T", ..ring }),
    ]
}

/// All rows, small ones first.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut row = |name: String, drive: Drive, text: String| rows.push(Row { name, text, drive });
    for profile in ["iec61131", "iec60848", "pl7", "unity", "jgrafchart"] {
        for n in [10, 100, 1000, 10_000] {
            if n == 1000 || matches!(profile, "iec61131" | "iec60848") {
                let (odd, drive) = match profile {
                    "iec60848" => ("not GO", Drive::Pulses),
                    _ => ("", Drive::Steady),
                };
                let ring = Ring { profile, odd, ..Ring::default() };
                row(format!("linear {n} {profile}"), drive, ring.text(n));
            }
        }
    }
    for (name, beside) in UNUSED {
        let ring = Ring { beside, inputs: 1, ..Ring::default() };
        row(format!("linear 100, one {name} unused"), Drive::Steady, ring.text(100));
    }
    for (name, drive, ring) in features() {
        for n in [10, 100, 1000, 10_000] {
            row(format!("{name} {n}"), drive, ring.text(n));
        }
    }
    let par = Ring { each: 10, ..Ring::default() };
    for (name, ring) in [
        ("par", par),
        ("par, expressions", Ring { receptivity: "GO and not T", ..par }),
        ("par, conditions", Ring { actions: "N Q@ if not T", ..par }),
    ] {
        for n in [100, 1000] {
            row(format!("{name} {n}"), Drive::Steady, ring.text(n));
        }
    }
    row("1000 inputs".into(), Drive::Steady, Ring { inputs: 998, ..Ring::default() }.text(100));
    for (name, drive, text) in mix::charts() {
        row(name, drive, text);
    }
    rows
}
