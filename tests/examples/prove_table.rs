//! `prove_table SECONDS FILE…`: asks every question of charts, and writes a table of the answers.
//!
//! Files may be charts, files of other tools and conformance cases, or folders of them. Each run that an answer
//! gives is repeated, and each proof by one layer is asked of the other: the last lines list every panic, every run
//! that does not repeat, every contradiction and every chart on which the time was overrun.
#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "a tool: it reads files and measures")]

use std::collections::BTreeMap;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use g7_model::ProfileName;
use g7_rig::Source;
use g7_rig::testing::plants;
use g7_tests::case;
use g7_verify::{
    Budget, Certificate, Claim, Evidence, Explicit, Layer, Model, Question, Satisfiability, Verdict, answer,
    ask, ask_with, replay,
};

/// The groups of questions, in the order of the columns.
const GROUPS: [&str; 13] = [
    "steps",
    "transitions",
    "actions",
    "outputs",
    "inputs",
    "deadlock",
    "conflict",
    "unsafe",
    "instability",
    "writes",
    "orders",
    "faults",
    "own",
];

fn group(claim: &Claim) -> usize {
    match claim {
        Claim::Active(_) => 0,
        Claim::Clears(_) => 1,
        Claim::Runs(_) => 2,
        Claim::On(_) => 3,
        Claim::Asked(_) => 4,
        Claim::NoDeadlock => 5,
        Claim::NoConflict => 6,
        Claim::NoUnsafe => 7,
        Claim::NoInstability => 8,
        Claim::NoOpposedWrites => 9,
        Claim::NoOpposedOrders => 10,
        Claim::NoFault => 11,
        _ => 12,
    }
}

/// Proved, refuted, not decided, by group.
type Counts = [[usize; 3]; GROUPS.len()];

/// A chart to be asked about.
struct Asked {
    name: String,
    source: Source,
    profile: Option<ProfileName>,
}

/// The answers on a chart.
struct Row {
    name: String,
    profile: &'static str,
    counts: Counts,
    seconds: f64,
    reasons: BTreeMap<String, usize>,
    wrong: Vec<String>,
}

/// The message of the last panic.
static PANIC: Mutex<String> = Mutex::new(String::new());

fn main() {
    let mut words = std::env::args().skip(1);
    let limit = words.next().and_then(|s| s.parse().ok()).map(Duration::from_secs_f64);
    let Some(limit) = limit else {
        eprintln!("prove_table SECONDS FILE…");
        std::process::exit(2);
    };
    std::panic::set_hook(Box::new(|info| {
        if let Ok(mut last) = PANIC.lock() {
            *last = info.to_string().replace('\n', " ");
        }
    }));
    println!("| chart | profile | {} | s |", GROUPS.join(" | "));
    println!("|---|---|{}---|", "---|".repeat(GROUPS.len()));
    let (mut total, mut seconds, mut wrong, mut charts) = (Counts::default(), 0.0, Vec::new(), 0);
    let (mut refused, mut reasons) = (Vec::new(), BTreeMap::<String, usize>::new());
    for path in words.flat_map(|p| case::files(Path::new(&p))) {
        for asked in sources(&path) {
            let rows = std::panic::catch_unwind(AssertUnwindSafe(|| rows(&asked, limit)));
            let rows = rows.unwrap_or_else(|_| {
                wrong.push(format!(
                    "{}: panic: {}",
                    asked.name,
                    PANIC.lock().map_or(String::new(), |p| p.clone())
                ));
                Vec::new()
            });
            if rows.is_empty() {
                refused.push(asked.name.clone());
            }
            for row in rows {
                println!("| {} | {} | {} | {:.2} |", row.name, row.profile, cells(&row.counts), row.seconds);
                for (sum, of) in total.iter_mut().zip(&row.counts) {
                    sum.iter_mut().zip(of).for_each(|(s, n)| *s += n);
                }
                row.reasons.into_iter().for_each(|(r, n)| *reasons.entry(r).or_default() += n);
                seconds += row.seconds;
                wrong.extend(row.wrong);
                charts += 1;
            }
        }
    }
    println!("| **{charts} charts** | | {} | {seconds:.1} |\n", cells(&total));
    println!("Each cell: proved / refuted / not decided.\n");
    let sum = |k: usize| total.iter().map(|c| c[k]).sum::<usize>();
    println!(
        "{} questions: {} proved, {} refuted, {} not decided.",
        (0..3).map(sum).sum::<usize>(),
        sum(0),
        sum(1),
        sum(2)
    );
    println!("\n{} files with an error in the text are not asked: {}\n", refused.len(), refused.join(", "));
    println!("Reasons of what is not decided:\n");
    reasons.iter().for_each(|(r, n)| println!("- {n}: {r}"));
    println!("\n{} findings:\n", wrong.len());
    wrong.iter().for_each(|w| println!("- {w}"));
}

fn cells(counts: &Counts) -> String {
    let cell =
        |[p, r, o]: &[usize; 3]| if p + r + o == 0 { "–".to_owned() } else { format!("{p}/{r}/{o}") };
    counts.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

/// The charts of a file: of a conformance case one for each profile of its traces.
fn sources(path: &Path) -> Vec<Asked> {
    let Ok(bytes) = std::fs::read(path) else { return Vec::new() };
    let name: PathBuf = path.components().rev().take(3).collect::<Vec<_>>().into_iter().rev().collect();
    let name = name.display().to_string();
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if ending == "md" {
        let text = String::from_utf8_lossy(&bytes);
        let Ok(case) = case::read(&text) else { return Vec::new() };
        let own = name.split('/').find_map(|part| case::profile_named(part).ok());
        let mut profiles: Vec<Option<ProfileName>> = case.traces.iter().map(|t| t.profile.or(own)).collect();
        profiles.dedup();
        let one = |profile| Asked {
            name: name.clone(),
            source: Source::new("case.g7", case.chart.clone().into_bytes(), 0),
            profile,
        };
        return profiles.into_iter().map(one).collect();
    }
    let read = ending == "g7" || g7_exchange::recognise(&name, &bytes).is_some_and(|f| f.is_read());
    if !read {
        return Vec::new();
    }
    let source = Source::new(&name, bytes, 0);
    vec![Asked { name, source, profile: None }]
}

/// The rows of a chart: by itself, and with each plant that its properties name.
fn rows(asked: &Asked, limit: Duration) -> Vec<Row> {
    let mut rows = Vec::new();
    let source = &asked.source;
    if source.has_errors() {
        return rows;
    }
    let own = source.document.profile().map(|p| p.name).unwrap_or_default();
    let profile = asked.profile.filter(|p| *p != own);
    let word = profile.unwrap_or(own).name();
    if let Some(all) = ask(&source.document, profile).0 {
        let model = Model::new(&all.compiled, all.assume.clone());
        rows.push(row(asked.name.clone(), word, &model, &all.questions, limit));
    }
    for plant in plants(&source.document) {
        if let Ok((Some(closed), _)) = ask_with(source, profile, plant, false) {
            let name = format!("{} with {plant}", asked.name);
            rows.push(row(name, word, &closed.model(), &closed.questions, limit));
        }
    }
    rows
}

fn row(
    name: String,
    profile: &'static str,
    model: &Model<'_>,
    questions: &[Question],
    limit: Duration,
) -> Row {
    let mut answers = vec![None; questions.len()];
    let begun = Instant::now();
    let stop = || begun.elapsed() > limit;
    let budget = Budget { states: 20_000_000, scans: usize::MAX, bytes: 512 << 20, stop: &stop };
    answer(model, questions, &mut answers, &budget);
    let seconds = begun.elapsed();
    let mut row = Row {
        name,
        profile,
        counts: Counts::default(),
        seconds: seconds.as_secs_f64(),
        reasons: BTreeMap::new(),
        wrong: Vec::new(),
    };
    let mut find = |what: String| row.wrong.push(format!("{} ({profile}): {what}", row.name));
    if seconds > limit * 2 + Duration::from_secs(1) {
        find(format!("{:.1} s, of {:.1} allowed", seconds.as_secs_f64(), limit.as_secs_f64()));
    }
    let others = others(model, questions, &answers);
    for (i, (q, a)) in questions.iter().zip(&answers).enumerate() {
        let column = match a {
            Some(Verdict::Proved(_)) => 0,
            Some(Verdict::Refuted(_)) => 1,
            _ => 2,
        };
        row.counts[group(&q.claim)][column] += 1;
        match a {
            Some(Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run))) => {
                let repeats = replay(model, &q.claim, run);
                (!repeats).then(|| find(format!("{:?}: the run does not repeat", q.claim)));
            }
            Some(Verdict::Open(open)) => {
                if open.reason == g7_verify::Reason::NotRepeated {
                    find(format!("{:?}: a run is not repeated", q.claim));
                }
                *row.reasons.entry(g7_verify::words::why(&open.reason)[0].clone()).or_default() += 1;
            }
            _ => {}
        }
        if let (Some(Some(a)), Some(Some(b))) = (answers.get(i).map(word), others.get(i).map(word))
            && a != b
        {
            find(format!("{:?}: {a} by one layer, {b} by the other", q.claim));
        }
    }
    row
}

fn word(v: &Option<Verdict>) -> Option<&'static str> {
    match v {
        Some(Verdict::Proved(_)) => Some("proved"),
        Some(Verdict::Refuted(_)) => Some("refuted"),
        _ => None,
    }
}

/// The answers of the layer that did not answer first: proofs by the solver are asked of a short search, those
/// by the search of the solver.
fn others(model: &Model<'_>, questions: &[Question], answers: &[Option<Verdict>]) -> Vec<Option<Verdict>> {
    let begun = Instant::now();
    let stop = || begun.elapsed() > Duration::from_secs(2);
    let budget = Budget { states: 20_000, scans: 50_000, bytes: 256 << 20, stop: &stop };
    let by_search = |a: &Option<Verdict>| match a {
        Some(Verdict::Proved(Evidence::Certificate(c)) | Verdict::Refuted(Evidence::Certificate(c))) => {
            Some(matches!(c, Certificate::Search { .. }))
        }
        _ => None,
    };
    let mut found = vec![None; questions.len()];
    for (layer, searched) in [(&Explicit as &dyn Layer, false), (&Satisfiability { turns: 3 }, true)] {
        let mine: Vec<usize> =
            (0..questions.len()).filter(|i| by_search(&answers[*i]) == Some(searched)).collect();
        let some: Vec<Question> = mine.iter().map(|i| questions[*i].clone()).collect();
        let mut own = vec![None; some.len()];
        layer.answer(model, &some, &mut own, &budget);
        mine.iter().zip(own).for_each(|(i, a)| found[*i] = a);
    }
    found
}
