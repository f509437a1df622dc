//! The prover beside other model checkers on the same charts, in one run: seconds, memory, ratios.
//!
//! ```text
//! charts.rs (a chart as text, as Promela) -> row in a process of its own (seconds, peak memory)
//!                                         -> AIGER file -> ABC, rIC3
//!                                         -> Spin, Stateright (cells.rs)
//! ```
//!
//! A row runs in a process of its own, so that its peak memory is its own. A checker that is absent has a dash; an
//! answer that was not found within the time has the time with `>`. Times of others are of the whole call, but for
//! Spin: that of the search, without its compiler.

#[cfg(feature = "stateright")]
mod cells;
mod charts;

use std::process::Command;
use std::time::{Duration, Instant};

use g7_model::FileId;
use g7_peers::checkers::{Abc, Ric3, Said, Spin, one_of};
use g7_verify::{
    Budget, Claim, Evidence, Explicit, Layer, Model, Question, Satisfiability, Verdict, answer, ask,
    exported, replay,
};

/// Seconds for each answer.
const SECONDS: u64 = 120;

/// The layers that a row measures.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Layers {
    Search,
    Solver,
    All,
}

/// A chart with what is asked of it.
struct Row {
    name: &'static str,
    text: String,
    layers: Layers,
    wants: fn(&Claim) -> bool,
    /// The model of Spin.
    promela: Option<String>,
    /// Cells, for Stateright.
    cells: Option<usize>,
}

fn rows() -> Vec<Row> {
    let own = |c: &Claim| c.is_own();
    let ends = |c: &Claim| *c == Claim::NoInstability;
    let row = |name, text, layers, wants| Row { name, text, layers, wants, promela: None, cells: None };
    let cells = |name, count| Row {
        promela: Some(charts::promela(count, false)),
        cells: Some(count),
        ..row(name, charts::cells(count), Layers::Search, own)
    };
    let mut rows = vec![
        cells("states: P = 6, any inputs at once", 6),
        cells("states: P = 8, any inputs at once", 8),
        cells("states: P = 10, any inputs at once", 10),
        row("mutual exclusion, P = 10", charts::cells(10), Layers::Solver, own),
        row("mutual exclusion, P = 50", charts::cells(50), Layers::Solver, own),
        row("no deadlock, ring of 10", charts::ring(10), Layers::Solver, own),
        row("no deadlock, ring of 50", charts::ring(50), Layers::Solver, own),
        row("equivalence, 10 cells", charts::equal(10), Layers::Solver, own),
        row("equivalence, 50 cells", charts::equal(50), Layers::Solver, own),
        row("transients end, 10", charts::transients(10, false), Layers::Solver, ends),
        row("transients end, 20", charts::transients(20, false), Layers::Solver, ends),
        row("endless transient found, 10", charts::transients(10, true), Layers::Solver, ends),
        row("endless transient found, 20", charts::transients(20, true), Layers::Solver, ends),
    ];
    for (name, ticks) in [("timers, D = 10", 10), ("timers, D = 100", 100), ("timers, D = 1000", 1000)] {
        rows.push(row(name, charts::timers(ticks), Layers::All, own));
    }
    rows
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let Some(name) = words.first().and_then(|w| w.strip_prefix("row:")) {
        if let Some(row) = rows().into_iter().find(|r| r.name == name) {
            println!("{}", one(&row));
        }
        return;
    }
    let chosen = |r: &Row| words.is_empty() || words.iter().any(|w| r.name.contains(w.as_str()));
    let (abc, ric3, spin) = (Abc::find(), Ric3::find(), Spin::find());
    println!("| | G7: answer, s, MiB | ABC | rIC3 | Spin | Stateright |\n|---|---|---|---|---|---|");
    for row in rows().into_iter().filter(chosen) {
        let own = Command::new(std::env::current_exe().expect("this program"))
            .arg(format!("row:{}", row.name))
            .output();
        let own = own.map_or(String::new(), |o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
        let seconds = own.split(", ").nth(1).and_then(|s| s.parse::<f64>().ok()).unwrap_or(f64::NAN);
        let file = (row.layers != Layers::Search).then(|| aiger(&row)).flatten();
        let beside = |time: Option<(f64, bool)>| match time {
            None => "–".to_owned(),
            Some((s, true)) => format!("{s:.2} ({:.1}×)", seconds / s),
            Some((s, false)) => format!("> {s:.0}"),
        };
        let of_abc = abc.as_ref().zip(file.as_ref()).map(|(abc, file)| {
            timed(|| {
                let said = abc.ask(std::slice::from_ref(file), SECONDS as u32);
                said.iter().flatten().all(|s| *s != Said::Open)
            })
        });
        let of_ric3 = ric3.as_ref().zip(file.as_ref()).map(|(ric3, file)| {
            timed(|| (0..bad(file)).all(|k| ric3.ask(&one_of(file, k), SECONDS as u32) != Said::Open))
        });
        let of_spin = spin.as_ref().zip(row.promela.as_ref()).map(|(spin, model)| {
            let searched = spin.search(model, &[], 5_000_000, SECONDS as u32);
            searched.map_or((SECONDS as f64, false), |s| (s.seconds, s.errors == 0))
        });
        let of_stateright = row.cells.and_then(stateright);
        println!(
            "| {} | {own} | {} | {} | {} | {} |",
            row.name,
            beside(of_abc),
            beside(of_ric3),
            beside(of_spin),
            beside(of_stateright)
        );
    }
    println!("\nIn brackets: the time of G7 divided by that of the other; below 1, G7 is faster.");
}

fn timed(work: impl FnOnce() -> bool) -> (f64, bool) {
    let begun = Instant::now();
    let done = work();
    (begun.elapsed().as_secs_f64(), done)
}

#[cfg(feature = "stateright")]
fn stateright(count: usize) -> Option<(f64, bool)> {
    Some(timed(|| cells::search(count, Duration::from_secs(SECONDS)) == Some(21usize.pow(count as u32 / 2))))
}

#[cfg(not(feature = "stateright"))]
fn stateright(_: usize) -> Option<(f64, bool)> {
    None
}

/// The number of bad signals of an AIGER file.
fn bad(file: &[u8]) -> usize {
    let header = String::from_utf8_lossy(file.split(|b| *b == b'\n').next().unwrap_or(&[])).into_owned();
    header.split(' ').nth(6).and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// The chart, compiled, with the questions that are measured.
fn asked(row: &Row) -> (g7_verify::Asked, Vec<Question>) {
    let (document, problems) = g7_syntax::parse(&row.text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (asked, problems) = ask(&document, None);
    let asked = asked.unwrap_or_else(|| panic!("{problems:?}"));
    let mine = asked.questions.iter().filter(|q| (row.wants)(&q.claim)).cloned().collect();
    (asked, mine)
}

fn aiger(row: &Row) -> Option<Vec<u8>> {
    let (asked, mine) = asked(row);
    let exported = exported(&Model::new(&asked.compiled, asked.assume.clone()), &mine);
    exported.rows.iter().all(Result::is_ok).then_some(exported.file)
}

/// The answer of G7, its seconds and its peak memory.
fn one(row: &Row) -> String {
    let (asked, mine) = asked(row);
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let begun = Instant::now();
    let stop = || begun.elapsed() > Duration::from_secs(SECONDS);
    let budget = Budget { states: usize::MAX, scans: usize::MAX, bytes: 8 << 30, stop: &stop };
    let mut answers = vec![None; mine.len()];
    match row.layers {
        Layers::Search => Explicit.answer(&model, &mine, &mut answers, &budget),
        Layers::Solver => Satisfiability::default().answer(&model, &mine, &mut answers, &budget),
        Layers::All => answer(&model, &mine, &mut answers, &budget),
    }
    let seconds = begun.elapsed().as_secs_f64();
    let mut words: Vec<&str> = Vec::new();
    for (q, a) in mine.iter().zip(&answers) {
        let repeats = |e: &Evidence| match e {
            Evidence::Run(run) => replay(&model, &q.claim, run),
            Evidence::Certificate(_) => true,
        };
        words.push(match a {
            Some(Verdict::Proved(e)) if repeats(e) => "proved",
            Some(Verdict::Refuted(e)) if repeats(e) => "refuted",
            Some(Verdict::Open(_)) | None => "open",
            Some(Verdict::Proved(_) | Verdict::Refuted(_)) => "WRONG",
        });
    }
    words.sort_unstable();
    words.dedup();
    format!("{}, {seconds:.3}, {}", words.join(" and "), peak())
}

/// The peak memory of this process, MiB.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) / 1024
}
