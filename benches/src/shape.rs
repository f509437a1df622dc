//! The charts for the measurements, as .g7 text and as textual SFC.
//!
//! Every transition waits for one input GO; every step i has one action `N Qi`.

use std::fmt::Write;

/// A family of charts and its size in steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One loop with one active step.
    Linear(usize),
    /// Loops of 10 steps with one active step each.
    Par(usize),
    /// One step, then a selection of n/10 branches with 9 steps each; one step is active.
    Alt(usize),
    /// One AND divergence into n/10 branches with 9 steps each, and one convergence.
    AndFork(usize),
}

/// Transitions: preceding steps, succeeding steps, rank among its alternatives (from 1).
type Arcs = Vec<(Vec<usize>, Vec<usize>, usize)>;

impl Shape {
    /// The name in the table of results.
    pub fn name(self) -> String {
        match self {
            Shape::Linear(n) => format!("linear {n}"),
            Shape::Par(n) => format!("par {n}"),
            Shape::Alt(n) => format!("alt {n}"),
            Shape::AndFork(n) => format!("andfork {n}"),
        }
    }

    /// Steps, initial steps and transitions.
    fn build(self) -> (usize, Vec<usize>, Arcs) {
        let ring = |from: usize, len: usize| -> Arcs {
            (0..len).map(|i| (vec![from + i], vec![from + (i + 1) % len], 1)).collect()
        };
        match self {
            Shape::Linear(n) => (n, vec![0], ring(0, n)),
            Shape::Par(n) => (
                n / 10 * 10,
                (0..n / 10).map(|l| l * 10).collect(),
                (0..n / 10).flat_map(|l| ring(l * 10, 10)).collect(),
            ),
            Shape::Alt(n) => {
                let branches = n / 10;
                let mut arcs = Vec::new();
                for b in 0..branches {
                    let first = 1 + 9 * b;
                    arcs.push((vec![0], vec![first], b + 1));
                    arcs.extend((first..first + 8).map(|i| (vec![i], vec![i + 1], 1)));
                    arcs.push((vec![first + 8], vec![0], 1));
                }
                (1 + 9 * branches, vec![0], arcs)
            }
            Shape::AndFork(n) => {
                let branches = n / 10;
                let firsts: Vec<usize> = (0..branches).map(|b| 1 + 9 * b).collect();
                let mut arcs = vec![(vec![0], firsts.clone(), 1)];
                for first in &firsts {
                    arcs.extend((*first..first + 8).map(|i| (vec![i], vec![i + 1], 1)));
                }
                arcs.push((firsts.iter().map(|f| f + 8).collect(), vec![0], 1));
                (1 + 9 * branches, vec![0], arcs)
            }
        }
    }

    /// The chart as .g7 text under `iec61131`.
    pub fn g7(self) -> String {
        let (steps, initial, arcs) = self.build();
        let mut t = String::from("profile iec61131\n\ninput GO : BOOL\n");
        for i in 0..steps {
            let _ = writeln!(t, "output Q{i} : BOOL");
        }
        t.push_str("\nchart Main {\n");
        let mut first = initial.iter().peekable();
        for i in 0..steps {
            let word = if first.next_if_eq(&&i).is_some() { "initial step" } else { "step" };
            let _ = writeln!(t, "  {word} {i} {{ N Q{i} }}");
        }
        for (from, to, _) in &arcs {
            let _ = writeln!(t, "  {} -> {} when GO", list(from, ""), list(to, ""));
        }
        t.push_str("}\n");
        t
    }

    /// The chart as textual SFC of IEC 61131-3, for matiec.
    ///
    /// There, only one step may be initial, so an additional step and transition start the loops of
    /// `par`; see [`Shape::forks`].
    pub fn st(self) -> String {
        let (steps, initial, arcs) = self.build();
        let mut t = String::from("PROGRAM chart\n VAR_INPUT GO : BOOL; END_VAR\n VAR_OUTPUT\n");
        for i in 0..steps {
            let _ = writeln!(t, "  Q{i} : BOOL;");
        }
        t.push_str(" END_VAR\n");
        if self.forks() {
            t.push_str(" INITIAL_STEP Start: END_STEP\n");
        }
        for i in 0..steps {
            let word = if !self.forks() && initial == [i] { "INITIAL_STEP" } else { "STEP" };
            let _ = writeln!(t, " {word} S{i}: Q{i}(N); END_STEP");
        }
        if self.forks() {
            let _ = writeln!(t, " TRANSITION FROM Start TO {} := TRUE; END_TRANSITION", list(&initial, "S"));
        }
        for (from, to, place) in &arcs {
            let (from, to) = (list(from, "S"), list(to, "S"));
            let _ =
                writeln!(t, " TRANSITION (PRIORITY := {place}) FROM {from} TO {to} := GO; END_TRANSITION");
        }
        t.push_str(
            "END_PROGRAM\nCONFIGURATION conf\n RESOURCE res ON PLC\n  TASK t(INTERVAL := T#1ms, PRIORITY := 0);\n  \
             PROGRAM p WITH t : chart;\n END_RESOURCE\nEND_CONFIGURATION\n",
        );
        t
    }

    /// True if the textual SFC needs a first transition that starts several loops.
    pub fn forks(self) -> bool {
        self.build().1.len() > 1
    }

    /// The number of its steps.
    pub fn steps(self) -> usize {
        self.build().0
    }
}

fn list(steps: &[usize], prefix: &str) -> String {
    match steps {
        [one] => format!("{prefix}{one}"),
        many => {
            let names: Vec<String> = many.iter().map(|s| format!("{prefix}{s}")).collect();
            format!("({})", names.join(", "))
        }
    }
}
