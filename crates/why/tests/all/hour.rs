//! Answers about an hour of the bead sorter: how much of it they make again, and how long they take once the recording is loaded.

use std::path::Path;
use std::time::{Duration, Instant};

use g7_model::Nanos;
use g7_rig::{Options, Source, question};
use g7_why::{Question, Why};

/// Most scans of the hour that one answer may make again: a fiftieth. The times are printed, since they depend on the
/// machine (`cargo test -p g7-why hour -- --nocapture`).
const AGAIN: u64 = 360_000 / 50;

#[test]
fn an_answer_about_an_hour_makes_little_of_it_again() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/bead-sorter/chart.g7");
    let source = Source::new("chart.g7", std::fs::read(path).expect("the bead sorter"), 0);
    let (bench, _) = g7_rig::build(&source, &Options::default()).expect("its plant is there");
    let bench = bench.expect("it compiles");
    let mut runner = bench.runner(0).with_tape();
    while runner.due() <= Nanos::HOUR {
        runner.scan().expect("no fault");
    }
    let tape = runner.tape().expect("a tape");
    let begun = Instant::now();
    let why = Why::new(&bench.compiled, tape).expect("the run comes again");
    println!("{} scans loaded in {:?}", tape.scans(), begun.elapsed());
    let mut names: Vec<String> = bench.items.iter().map(|i| i.name.clone()).collect();
    names.extend(bench.steps.iter().map(g7_rig::StepItem::activity));
    let mut questions: Vec<(String, Question)> =
        names.into_iter().filter_map(|name| question(&bench, &name).ok().map(|q| (name, q))).collect();
    questions.push(("scan".to_owned(), Question::Scan));
    let ranks = 0..bench.compiled.symbols.transitions();
    questions.extend(ranks.map(|r| (format!("transition {r}"), Question::Transition(r))));
    let (mut slowest, mut most) = ((Duration::ZERO, String::new()), 0);
    let count = questions.len();
    for (name, question) in questions {
        for now in [Nanos::HOUR, Nanos::MINUTE * 31] {
            let (begun, before) = (Instant::now(), why.again());
            let cause = why.ask(question, now).expect("there is a scan");
            let took = begun.elapsed();
            let again = why.again() - before;
            assert!(again < AGAIN, "{name}: {again} scans: {}", cause.said);
            most = most.max(again);
            if took > slowest.0 {
                slowest = (took, format!("{name}: {}", cause.said));
            }
        }
    }
    println!("{count} questions, at most {most} scans; the slowest took {:?}: {}", slowest.0, slowest.1);
}
