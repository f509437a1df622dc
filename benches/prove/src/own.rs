//! G7's answer to a row, with the file that says the same to others.

use std::time::{Duration, Instant};

use g7_model::FileId;
use g7_verify::{
    Asked, Budget, Compare, Equality, Evidence, Layer, Model, Question, Satisfiability, Tried, Tries,
    Verdict, Visited, answer, ask, compare, exported, miter, replay, visit, visit_bits, visit_sets,
};

use crate::charts;
use crate::rows::{By, Layers, Row, Task};

/// The answer, its seconds and the peak memory of this process, MiB.
pub fn answered(row: &Row, limit: u32) -> String {
    let begun = Instant::now();
    let stop = move || begun.elapsed() > Duration::from_secs(limit.into());
    let budget = Budget { states: usize::MAX, scans: usize::MAX, bytes: 8 << 30, stop: &stop };
    let (word, seconds) = match &row.task {
        Task::States { cells, tried, by } => states(*cells, *tried, *by, &budget),
        Task::Claims { text, layers, wants } => claims(text, *layers, *wants, &budget),
        Task::Compare(texts) => beside(texts, &budget),
    };
    format!("{word}, {seconds:.3}, {}", peak())
}

/// Asks nothing else of the chart; its questions are those of the file and of every chart.
fn read(text: &str) -> Asked {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (asked, problems) = ask(&document, None);
    asked.unwrap_or_else(|| panic!("{problems:?}"))
}

/// The states that cells have: 21 each pair, 5 one that is alone.
pub fn all(cells: usize) -> u128 {
    21u128.pow(cells as u32 / 2) * if cells % 2 == 1 { 5 } else { 1 }
}

fn states(cells: usize, tried: Tried, by: By, budget: &Budget<'_>) -> (String, f64) {
    let profile = if tried == Tried::One { "iec60848" } else { "iec61131" };
    let asked = read(&charts::cells(cells, profile));
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let begun = Instant::now();
    let tries = if tried == Tried::One { Tries::One } else { Tries::All };
    let whole = |seen: Visited| seen.open.is_none().then_some(seen.states as u128);
    let seen = match by {
        By::Engine => whole(visit(&model, budget, tried)),
        By::Bits(threads) => visit_bits(&model, budget, tries, threads).and_then(whole),
        By::Sets => visit_sets(&model, budget, tries, 1 << 21).filter(|s| s.is_whole).and_then(|s| s.states),
    };
    let seconds = begun.elapsed().as_secs_f64();
    // One state more is that before the first scan.
    let word = match seen.map(|n| n - 1) {
        None => "open".to_owned(),
        Some(n) if n == all(cells) => "all".to_owned(),
        Some(n) => format!("WRONG: {n}"),
    };
    (word, seconds)
}

fn claims(
    text: &str,
    layers: Layers,
    wants: fn(&g7_verify::Claim) -> bool,
    budget: &Budget<'_>,
) -> (String, f64) {
    let asked = read(text);
    let mine = wanted(&asked, wants);
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let mut answers = vec![None; mine.len()];
    let begun = Instant::now();
    match layers {
        Layers::Solver => Satisfiability::default().answer(&model, &mine, &mut answers, budget),
        Layers::All => answer(&model, &mine, &mut answers, budget),
    }
    let seconds = begun.elapsed().as_secs_f64();
    let repeats = |q: &Question, e: &Evidence| match e {
        Evidence::Run(run) => replay(&model, &q.claim, run),
        Evidence::Certificate(_) => true,
    };
    let word = |(q, a): (&Question, &Option<Verdict>)| match a {
        Some(Verdict::Proved(e)) if repeats(q, e) => "proved",
        Some(Verdict::Refuted(e)) if repeats(q, e) => "refuted",
        Some(Verdict::Open(_)) | None => "open",
        Some(Verdict::Proved(_) | Verdict::Refuted(_)) => "WRONG",
    };
    (one_word(mine.iter().zip(&answers).map(word).collect()), seconds)
}

/// Words of several answers, each once.
pub fn one_word(mut words: Vec<&str>) -> String {
    words.sort_unstable();
    words.dedup();
    words.join(" and ")
}

fn wanted(asked: &Asked, wants: fn(&g7_verify::Claim) -> bool) -> Vec<Question> {
    asked.questions.iter().filter(|q| wants(&q.claim)).cloned().collect()
}

fn beside(texts: &[String; 2], budget: &Budget<'_>) -> (String, f64) {
    let [a, b] = [read(&texts[0]), read(&texts[1])];
    let what = Compare {
        charts: [&a.compiled, &b.compiled],
        assume: [a.assume.clone(), b.assume.clone()],
        situations: false,
    };
    let begun = Instant::now();
    let word = match compare(&what, budget) {
        Equality::Equal(_) => "proved",
        Equality::Apart { .. } => "refuted",
        Equality::Open(_) => "open",
        Equality::Unlike(_) => "WRONG",
    };
    (word.to_owned(), begun.elapsed().as_secs_f64())
}

/// A file for other checkers, with the bad signals of each question: a run that shows the first refutes it; where
/// none shows the second, it is proved.
pub struct Aiger {
    pub file: Vec<u8>,
    pub signals: Vec<(usize, Option<usize>)>,
}

/// The file of a row, if it has questions that can be written so.
pub fn aiger(row: &Row) -> Option<Aiger> {
    match &row.task {
        Task::States { .. } => None,
        Task::Claims { text, wants, .. } => {
            let asked = read(text);
            let exported =
                exported(&Model::new(&asked.compiled, asked.assume.clone()), &wanted(&asked, *wants));
            let signals = exported.rows.iter().map(|r| r.as_ref().ok().map(|r| (r.bad, Some(r.unsure))));
            Some(Aiger { signals: signals.collect::<Option<_>>()?, file: exported.file })
        }
        Task::Compare(texts) => {
            let [a, b] = [read(&texts[0]), read(&texts[1])];
            let charts = [&a.compiled, &b.compiled];
            let file =
                miter(&Compare { charts, assume: [Vec::new(), Vec::new()], situations: false }).ok()?;
            let unsure = (g7_peers::checkers::bad_signals(&file) > 1).then_some(1);
            Some(Aiger { file, signals: vec![(0, unsure)] })
        }
    }
}

/// The peak memory of this process, MiB.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) / 1024
}
