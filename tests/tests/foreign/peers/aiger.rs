//! ABC and rIC3 answer the questions of charts as the prover does, each run as short as theirs.

use std::collections::BTreeMap;

use g7_model::{Document, ProfileName};
use g7_peers::checkers::{Abc, Ric3, Said, one_of};
use g7_tests::generate::sample;
use g7_verify::{
    Asked, Budget, Evidence, Exported, Layer, Model, Row, Satisfiability, Verdict, ask, exported, replay,
};

/// Random charts of each profile.
const CHARTS: u64 = 3;
/// Every so many questions rIC3 is asked one: each needs a process of its own.
const STRIDE: usize = 40;
/// Seconds that rIC3 has for each.
const ASKED: u32 = 2;
/// Seconds for the questions of a chart.
const SECONDS: u32 = 20;

/// Charts with their names.
fn charts() -> Vec<(String, Document)> {
    let mut list = Vec::new();
    for profile in ProfileName::ALL {
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            list.push((format!("{} seed {seed}", profile.name()), sample.document));
        }
    }
    list
}

/// A chart with our answers, and the file for the others.
struct Chart {
    name: String,
    asked: Asked,
    ours: Vec<Verdict>,
    exported: Exported,
}

fn chart((name, document): (String, Document)) -> Option<Chart> {
    let asked = ask(&document, None).0?;
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 3000, scans: 60_000, bytes: 256 << 20, stop: &|| false };
    let mut ours = vec![None; asked.questions.len()];
    Satisfiability { turns: 3 }.answer(&model, &asked.questions, &mut ours, &budget);
    let exported = exported(&model, &asked.questions);
    let ours = ours.into_iter().map(|a| a.expect("each question has an answer")).collect();
    Some(Chart { name, asked, ours, exported })
}

/// The answers to one question, counted by what they are.
type Tally = BTreeMap<(&'static str, &'static str), usize>;

fn word(said: &Said) -> &'static str {
    match said {
        Said::Never => "never",
        Said::Reached(_) => "reached",
        Said::Open => "open",
    }
}

/// Compares our answer with what a checker said of the two signals of a question.
fn compare(
    chart: &Chart,
    i: usize,
    row: &Row,
    said: [&Said; 2],
    exact: bool,
) -> (&'static str, &'static str) {
    let claim = &chart.asked.questions[i].claim;
    let at =
        || format!("{}: {claim:?}: {:?}, but the checker says {said:?}; {row:?}", chart.name, chart.ours[i]);
    match (&chart.ours[i], said) {
        (Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)), [bad, _]) => {
            let model = Model::new(&chart.asked.compiled, chart.asked.assume.clone());
            assert!(replay(&model, claim, run), "{}", at());
            match bad {
                Said::Reached(steps) if exact => assert_eq!(*steps, run.moves.len(), "{}", at()),
                Said::Reached(_) | Said::Open => {}
                Said::Never => panic!("{}", at()),
            }
            ("a run", word(bad))
        }
        (Verdict::Proved(_) | Verdict::Refuted(_), [bad, unsure]) => {
            let reached = [bad, unsure].iter().any(|s| matches!(s, Said::Reached(_)));
            assert!(!reached, "{}", at());
            ("a proof", if *bad == Said::Never { word(unsure) } else { "open" })
        }
        // A run that the engine does not repeat must have a reason.
        (Verdict::Open(open), [bad, unsure]) => {
            assert!(open.reason != g7_verify::Reason::NotRepeated, "{}", at());
            ("open", if *bad == Said::Never { word(unsure) } else { word(bad) })
        }
    }
}

#[test]
fn checkers_of_aiger_files_agree() {
    let (abc, ric3) = (Abc::find(), Ric3::find());
    if abc.is_none() && ric3.is_none() {
        return;
    }
    let charts: Vec<Chart> = charts().into_iter().filter_map(chart).collect();
    let rows = |c: &Chart| -> Vec<(usize, Row)> {
        c.exported.rows.iter().enumerate().filter_map(|(i, r)| r.clone().ok().map(|r| (i, r))).collect()
    };
    if let Some(abc) = abc {
        let files: Vec<Vec<u8>> = charts.iter().map(|c| c.exported.file.clone()).collect();
        let mut tally = Tally::new();
        for (chart, said) in charts.iter().zip(abc.ask(&files, SECONDS)) {
            for (i, row) in rows(chart) {
                let pair = [&said[row.bad], &said[row.unsure]];
                *tally.entry(compare(chart, i, &row, pair, true)).or_default() += 1;
            }
        }
        println!("prover, ABC: {tally:?}");
        let of = |ours, theirs| tally.get(&(ours, theirs)).copied().unwrap_or(0);
        assert!(of("a proof", "never") > 30 && of("a run", "reached") > 30, "{tally:?}");
    }
    if let Some(ric3) = ric3 {
        let mut tally = Tally::new();
        let all = charts.iter().flat_map(|c| rows(c).into_iter().map(move |(i, row)| (c, i, row)));
        for (chart, i, row) in all.step_by(STRIDE) {
            let said = [row.bad, row.unsure].map(|k| ric3.ask(&one_of(&chart.exported.file, k), ASKED));
            *tally.entry(compare(chart, i, &row, [&said[0], &said[1]], false)).or_default() += 1;
        }
        println!("prover, rIC3: {tally:?}");
    }
}
