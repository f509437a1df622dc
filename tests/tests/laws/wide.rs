//! The behaviour of a chart does not depend on how many others are beside it: seventy equal charts,
//! more than a word has bits, each behave like a single one.

use std::fmt::Write as _;

use g7_compile::{Compiled, compile_as};
use g7_engine::{State, WatchId, scan};
use g7_model::{FileId, ProfileName};

/// More than the bits of a word.
const WIDE: usize = 70;

/// Charts with stored, continuous, timed and periodic actions, an edge and a convergence.
fn text(charts: usize) -> String {
    let mut text = "input a, b : BOOL\n".to_owned();
    for i in 0..charts {
        let _ = write!(
            text,
            "output q{i}, r{i}, d{i} : BOOL\nvar n{i}, m{i}, k{i} : INT\n\
             chart G{i} {{\n  initial step 1 {{\n    N q{i}\n    each scan: n{i} := n{i} + 1\n    P0 k{i} := k{i} + 1\n  }}\n\
             step 2 {{\n    P1 m{i} := m{i} + 1\n    D 20ms d{i}\n    each scan: n{i} := n{i} + 10\n  }}\n\
             step 3 {{ S r{i} }}\n  1 -> (2, 3) when ↑a\n  (2, 3) -> 1 when b\n}}\n"
        );
    }
    text
}

fn compiled(charts: usize, profile: ProfileName) -> Compiled {
    let (document, problems) = g7_syntax::parse(&text(charts), FileId::default());
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile_as(&document, profile);
    compiled.unwrap_or_else(|| panic!("{problems:?}"))
}

/// The values of a chart's variables, and its steps.
fn seen(c: &Compiled, s: &State, chart: usize) -> Vec<u64> {
    let names = ["q", "r", "d", "n", "m", "k"].map(|v| format!("{v}{chart}"));
    let word = |name: &String| {
        let v = c.symbols.variables.iter().find(|v| v.name.as_ref() == name.as_str());
        s.word(v.unwrap_or_else(|| panic!("{name}")).addr)
    };
    let steps = s.active().filter(|step| c.symbols.step_path(*step).starts_with(&format!("G{chart}.")));
    names.iter().map(word).chain(steps.map(|step| u64::from(step.0) - 3 * chart as u64)).collect()
}

#[test]
fn seventy_charts_do_each_what_one_does() {
    let rows = [(0, 0), (0, 0), (1, 0), (1, 0), (0, 0), (0, 0), (0, 1), (0, 0), (1, 0), (0, 1), (0, 0)];
    for profile in ProfileName::ALL {
        let (one, many) = (compiled(1, profile), compiled(WIDE, profile));
        let (mut alone, mut wide) = (State::new(&one.program), State::new(&many.program));
        let (mut all, mut ran) = (Vec::new(), 0);
        for (k, (a, b)) in rows.into_iter().enumerate() {
            let now = k as i64 * 10_000_000;
            scan(&one.program, &mut alone, &[a, b], now).expect("no fault");
            scan(&many.program, &mut wide, &[a, b], now).expect("no fault");
            let wanted = seen(&one, &alone, 0);
            assert_eq!(wide.ran().len(), WIDE * alone.ran().len(), "{}, scan {k}", profile.name());
            ran += alone.ran().len();
            for chart in 0..WIDE {
                assert_eq!(seen(&many, &wide, chart), wanted, "{}, scan {k}, chart {chart}", profile.name());
            }
            all.push(wanted);
        }
        // The chart completed two cycles, and every action was executed, most of them repeatedly.
        assert!(ran > rows.len(), "{}: {ran}", profile.name());
        let last = all.last().expect("rows");
        assert_eq!(last.get(5), Some(&2), "{}: {all:?}", profile.name());
        assert!((0..5).all(|v| all.iter().any(|row| row[v] != 0)), "{}: {all:?}", profile.name());
    }
}

#[test]
fn the_output_of_a_timer_can_be_read() {
    let text = "input a : BOOL\noutput q : BOOL\nchart G { initial step 1 { N q if 30ms/a } }\n";
    let (document, _) = g7_syntax::parse(text, FileId::default());
    let c = compile_as(&document, ProfileName::Iec60848).0.expect("a chart");
    let mut s = State::new(&c.program);
    let mut seen = Vec::new();
    for (a, now) in [(0, 0), (1, 10), (1, 30), (1, 40), (1, 50), (0, 60)] {
        scan(&c.program, &mut s, &[a], now * 1_000_000).expect("no fault");
        seen.push(s.timer(&c.program, WatchId(0)));
    }
    assert_eq!(seen, [false, false, false, true, true, false]);
}
