//! The findings of the analysis, asked of the prover: which transitions never or always clear, and which steps
//! of a chart are active together.
//!
//! The analysis approximates: what it says can be may not be. A difference must stand in [`DIFFERENCES`]; where
//! the prover says that something happens, its run is repeated here.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use g7_compile::Compiled;
use g7_model::{Chart, Document, FileId, Transition};
use g7_verify::{
    Asked, Budget, Claim, Evidence, Explicit, Layer, Model, Question, Satisfiability, Verdict, ask, replay,
};

use super::{REFUSED, without_continuous, xmi};

/// Charts with more steps are asked about their transitions only: all pairs of their steps take minutes.
const STEPS: u32 = 30;

/// Findings of the analysis that the prover does not share: file, subject, and why.
const DIFFERENCES: &[(&str, &str, &str)] = &[
    ("productionSystem.grafcet", "11 always", INPUT),
    ("productionSystem.grafcet", "21 always", OTHER),
    ("productionSystem.grafcet", "401 always", OTHER),
    ("productionSystem.grafcet", "501 always", OTHER),
    ("productionSystem.grafcet", "505 always", INPUT),
    ("productionSystem.grafcet", "601 always", OTHER),
    ("productionSystem.grafcet", "603 always", INPUT),
    ("productionSystem.grafcet", "617 always", INPUT),
    ("productionSystem.grafcet", "619 always", INPUT),
    ("productionSystem.grafcet", "621 always", INPUT),
    ("conflictingActions10.grafcet", "3 with 5", PASSED),
    ("conflictingActions8.grafcet", "1 with 4", PASSED),
    ("conflictingActions8.grafcet", "2 with 3", PASSED),
    ("conflictingActions8.grafcet", "2 with 4", PASSED),
    ("sitReachability1.grafcet", "2 with 3", PASSED),
    ("sitReachability1.grafcet", "2 with 5", PASSED),
    ("sitReachability1.grafcet", "3 with 4", PASSED),
    ("sitReachability3.grafcet", "2 with 3", PASSED),
    ("sitReachability3.grafcet", "2 with 5", PASSED),
    ("sitReachability3.grafcet", "3 with 4", PASSED),
    ("stepReachability3.grafcet", "1 with 4", PASSED),
    ("stepReachability3.grafcet", "1 with 5", PASSED),
    ("stepReachability3.grafcet", "2 with 4", PASSED),
    ("stepReachability3.grafcet", "3 with 4", PASSED),
    ("stepReachability3.grafcet", "3 with 5", PASSED),
    (
        "hierarchicalConflict1.grafcet",
        "21 never",
        "The chart is enclosed by one step and forced by another: the analysis looks at each by itself, and while it is only forced nothing clears.",
    ),
    (
        "stepReachability3.grafcet",
        "2 never",
        "Step 5 stores `k := 1` in the pass that activates step 2, so `k < 1` is never true there.",
    ),
];

const INPUT: &str =
    "An input is in the receptivity: while it says no, the step stays. The analysis takes it for true.";
const OTHER: &str =
    "The receptivity is the activity of a step of another chart, which need not be active then.";
const PASSED: &str = "Both clear, or clear on, in one search for stability: no scan ends there. The analysis clears one after the other.";

/// The findings on a file.
#[derive(Default)]
struct Findings {
    always: BTreeSet<String>,
    never: BTreeSet<String>,
    together: BTreeMap<String, BTreeSet<String>>,
}

fn findings(corpus: &Path) -> BTreeMap<String, Findings> {
    let text = std::fs::read_to_string(corpus.join("agrafe-oracles.json")).expect("the analysis");
    let all: serde_json::Value = serde_json::from_str(&text).expect("the oracles are JSON");
    let strings = |v: &serde_json::Value| -> BTreeSet<String> {
        let list = v.as_array().into_iter().flatten().filter_map(|s| s.as_str());
        list.map(|s| s.trim_start_matches('s').to_owned()).collect()
    };
    let one = |(file, says): (&String, &serde_json::Value)| {
        let rows = says["concurrent"].as_object().into_iter().flatten();
        let together = rows.map(|(step, with)| (step.trim_start_matches('s').to_owned(), strings(with)));
        let (always, never) = (strings(&says["always_fires"]), strings(&says["never_fires"]));
        (file.clone(), Findings { always, never, together: together.collect() })
    };
    all.as_object().expect("files by name").iter().map(one).collect()
}

/// A property with what it is about.
enum About {
    /// Two steps of a chart are active at the end of a scan.
    Together(String, String),
    /// All steps before a transition are active at the end of a scan, so it is enabled and did not clear.
    Waits(String),
}

fn active(chart: &Chart, step: &str) -> String {
    if step.parse::<u32>().is_ok() {
        format!("{}.X{step}", chart.name.text)
    } else {
        format!("{}.{step}.X", chart.name.text)
    }
}

fn label(t: &Transition) -> Option<&str> {
    t.label.as_ref().map(|l| l.text.trim_start_matches('T'))
}

/// The properties to be asked, and their text.
fn properties(document: &Document, steps: u32, says: &Findings) -> (Vec<About>, String) {
    let (mut about, mut text) = (Vec::new(), String::new());
    for chart in document.charts() {
        for t in chart.transitions().filter(|t| !t.from.is_empty()) {
            let Some(label) = label(t).filter(|l| says.always.contains(*l)) else { continue };
            let from: Vec<String> = t.from.iter().map(|s| active(chart, &s.text)).collect();
            text += &format!("prove never {}\n", from.join(" and "));
            about.push(About::Waits(label.to_owned()));
        }
        let names: Vec<&str> = chart.steps().map(|s| &*s.name.text).collect();
        for (i, a) in names.iter().enumerate().filter(|_| steps <= STEPS) {
            for b in names.iter().skip(i + 1) {
                text += &format!("prove reachable {} and {}\n", active(chart, a), active(chart, b));
                about.push(About::Together((*a).to_owned(), (*b).to_owned()));
            }
        }
    }
    (about, text)
}

/// The answers to what a document asks: the clearing of each transition, then its properties.
fn answers(asked: &Asked) -> (Vec<Question>, Vec<Verdict>) {
    let mine = |q: &&Question| q.claim.is_own() || matches!(q.claim, Claim::Clears(_));
    let questions: Vec<Question> = asked.questions.iter().filter(mine).cloned().collect();
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 3000, scans: 60_000, bytes: 256 << 20, stop: &|| false };
    let mut answers = vec![None; questions.len()];
    Explicit.answer(&model, &questions, &mut answers, &budget);
    Satisfiability { turns: 8 }.answer(&model, &questions, &mut answers, &budget);
    for (q, a) in questions.iter().zip(&answers) {
        if let Some(Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run))) = a {
            assert!(replay(&model, &q.claim, run), "{:?}", q.claim);
        }
    }
    (questions, answers.into_iter().map(|a| a.expect("each question has an answer")).collect())
}

/// `Some` where it is decided.
fn holds(v: &Verdict) -> Option<bool> {
    match v {
        Verdict::Proved(_) => Some(true),
        Verdict::Refuted(_) => Some(false),
        Verdict::Open(_) => None,
    }
}

/// The differences on one file, each with our word, and the number of findings that are shared and not decided.
fn differences(document: &Document, says: &Findings) -> (Vec<(String, &'static str)>, usize, usize) {
    let compiled = g7_compile::compile(document).0.expect("it was compiled before");
    let (about, text) = properties(document, compiled.symbols.steps(), says);
    let mut document = document.clone();
    let (parsed, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    document.items.extend(parsed.items);
    let (asked, problems) = ask(&document, None);
    let asked = asked.unwrap_or_else(|| panic!("{problems:?}\n{text}"));
    let (questions, verdicts) = answers(&asked);
    let own = questions.iter().filter(|q| q.claim.is_own()).count();
    assert_eq!(own, about.len());
    let (mut found, mut shared, mut open) = (Vec::new(), 0, 0);
    let mut see = |subject: String, listed: bool, ours: Option<bool>, word: [&'static str; 2]| match ours {
        None => open += 1,
        Some(ours) if ours == listed => shared += 1,
        Some(ours) => found.push((subject, word[usize::from(ours)])),
    };
    let clears = questions.iter().zip(&verdicts).take(questions.len() - own);
    for (q, v) in clears {
        let Claim::Clears(rank) = q.claim else { continue };
        let Some(label) = name(&asked.compiled, rank) else { continue };
        let never = says.never.contains(&label);
        see(format!("{label} never"), never, holds(v).map(|h| !h), ["a run clears it", "it never clears"]);
    }
    for (about, v) in about.iter().zip(verdicts.iter().skip(questions.len() - own)) {
        match about {
            About::Waits(label) => {
                see(format!("{label} always"), true, holds(v), ["a run lets it wait", "it never waits"]);
            }
            About::Together(a, b) => {
                let listed = says.together.get(a).is_some_and(|with| with.contains(b));
                let word = ["no run has both", "a run has both"];
                see(format!("{a} with {b}"), listed, holds(v), word);
            }
        }
    }
    (found, shared, open)
}

fn name(compiled: &Compiled, rank: u32) -> Option<String> {
    compiled.symbols.label(rank).map(|l| l.trim_start_matches('T').to_owned())
}

#[test]
fn findings_of_the_analysis_are_those_of_the_prover() {
    let Some(corpus) = g7_peers::corpus("") else { return };
    let (mut wrong, mut listed) = (Vec::new(), BTreeSet::new());
    let (mut shared, mut open) = (0, 0);
    for (file, says) in findings(&corpus) {
        let path = corpus.join("agrafe-xmi").join("Project-AGRAFE").join(&file);
        let (mut document, _) = xmi(&std::fs::read(&path).expect("a file of the corpus"));
        without_continuous(&mut document);
        if g7_compile::compile(&document).0.is_none() {
            assert!(REFUSED.iter().any(|(end, _)| file.ends_with(end)), "{file}");
            continue;
        }
        let (found, same, left) = differences(&document, &says);
        println!("{file}: {same} shared, {} differ, {left} not decided", found.len());
        (shared, open) = (shared + same, open + left);
        for (subject, ours) in found {
            match DIFFERENCES.iter().find(|(f, s, _)| file.ends_with(f) && *s == subject) {
                Some(row) => _ = listed.insert(row),
                None => wrong.push(format!("{file}: {subject}: {ours}")),
            }
        }
    }
    println!("{shared} findings are shared, {} differ, {open} are not decided", listed.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(listed.len(), DIFFERENCES.len(), "each difference that is listed is met");
}
