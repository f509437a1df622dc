//! The findings of the analysis, asked of the prover: which transitions never or always clear, and which steps
//! of a chart are active together. The corpus has 39 files of the meta-model; the analysis was made of 23.
//!
//! The analysis approximates: "never" and "always" claim something of all runs, the rest is what may be. So a
//! difference is explained in one of two ways, and by nothing else:
//!
//! - The analysis claims something of all runs, and a run that the engine repeats shows the contrary.
//! - It says that something may be, and the search and the solver prove, each by itself, that it is not. Where two
//!   steps are said to be active together, a search tells whether they are so between the passes of a search for
//!   stability: then the analysis means this, and the prover the end of a scan.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use g7_compile::Compiled;
use g7_model::{Chart, Document, FileId, Transition};
use g7_verify::{
    Answer, Asked, Budget, Claim, Evidence, Explicit, Explorer, Inputs, Layer, Limits, Model, Moment, Next,
    Question, Satisfiability, Verdict, Which, ask, replay,
};

use super::{REFUSED, SCANS, TOGETHER, values, waits, without_continuous, xmi};

/// Charts with more steps are asked about their transitions only: all pairs of their steps take minutes.
const STEPS: u32 = 30;

/// How a difference is explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Explained {
    /// A run shows the contrary of what the analysis claims of all runs.
    ByRun,
    /// Two steps are active together between two passes, and proved never to be so at the end of a scan.
    BetweenPasses,
    /// Something that may be by the analysis is proved never to be.
    ByProof,
}

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

fn budget() -> Budget<'static> {
    Budget { states: 3000, scans: 60_000, bytes: 256 << 20, stop: &|| false }
}

/// The answers to what a document asks: the clearing of each transition, then its properties.
fn answers(asked: &Asked) -> (Vec<Question>, Vec<Verdict>) {
    let mine = |q: &&Question| q.claim.is_own() || matches!(q.claim, Claim::Clears(_));
    let questions: Vec<Question> = asked.questions.iter().filter(mine).cloned().collect();
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = budget();
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

/// A finding that is asked, with our answer.
struct Asks<'a> {
    question: &'a Question,
    verdict: &'a Verdict,
    subject: String,
    /// The answer of the analysis: `Some` where this is a claim about all runs.
    of_all_runs: Option<bool>,
    /// The answer of the analysis, one of the two in any case.
    says: bool,
    steps: Option<(&'a str, &'a str)>,
}

/// A file's findings: explained differences, what is wrong, shared findings, and those that are not decided.
#[derive(Default)]
struct Outcome {
    explained: Vec<(String, Explained)>,
    wrong: Vec<String>,
    shared: usize,
    open: usize,
}

/// Asks what the analysis says of a file.
fn outcome(document: &Document, says: &Findings) -> Outcome {
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
    let mut outcome = Outcome::default();
    let (clears, others) = questions.split_at(questions.len() - own);
    for (question, verdict) in clears.iter().zip(&verdicts) {
        let Claim::Clears(rank) = question.claim else { continue };
        let Some(label) = name(&asked.compiled, rank) else { continue };
        let never = says.never.contains(&label);
        outcome.see(
            &document,
            &asked,
            Asks {
                question,
                verdict,
                subject: format!("{label} clears"),
                of_all_runs: never.then_some(false),
                says: !never,
                steps: None,
            },
        );
    }
    for ((about, question), verdict) in about.iter().zip(others).zip(verdicts.iter().skip(clears.len())) {
        let (subject, of_all_runs, says, steps) = match about {
            About::Waits(label) => (format!("{label} always clears"), Some(true), true, None),
            About::Together(a, b) => {
                let listed = says.together.get(a).is_some_and(|with| with.contains(b));
                (format!("{a} with {b}"), (!listed).then_some(false), listed, Some((&**a, &**b)))
            }
        };
        outcome.see(&document, &asked, Asks { question, verdict, subject, of_all_runs, says, steps });
    }
    outcome
}

impl Outcome {
    fn see(&mut self, document: &Document, asked: &Asked, finding: Asks<'_>) {
        match holds(finding.verdict) {
            None => self.open += 1,
            Some(ours) if ours == finding.says => self.shared += 1,
            Some(ours) => match explained(document, asked, &finding, ours) {
                Some(why) => self.explained.push((finding.subject, why)),
                None => self.wrong.push(format!("{}: {:?}", finding.subject, finding.verdict)),
            },
        }
    }
}

/// The explanation of a difference. Runs were repeated by the caller.
fn explained(document: &Document, asked: &Asked, finding: &Asks<'_>, ours: bool) -> Option<Explained> {
    match (finding.verdict, finding.of_all_runs) {
        (Verdict::Proved(Evidence::Run(_)) | Verdict::Refuted(Evidence::Run(_)), Some(claimed)) => {
            (claimed != ours).then_some(Explained::ByRun)
        }
        (Verdict::Refuted(Evidence::Certificate(_)), None) => {
            let model = Model::new(&asked.compiled, asked.assume.clone());
            let both = [&Explicit as &dyn Layer, &Satisfiability { turns: 12 }].iter().all(|layer| {
                let mut answers = [None];
                layer.answer(&model, std::slice::from_ref(finding.question), &mut answers, &budget());
                matches!(&answers, [Some(Verdict::Refuted(Evidence::Certificate(_)))])
            });
            let passes =
                || finding.steps.is_some_and(|steps| between_passes(document, &asked.compiled, steps));
            both.then(|| if passes() { Explained::BetweenPasses } else { Explained::ByProof })
        }
        _ => None,
    }
}

/// Two steps are active together behind some pass of a scan.
fn between_passes(document: &Document, compiled: &Compiled, steps: (&str, &str)) -> bool {
    let p = &compiled.program;
    let moves = Inputs::new(p, Which::Asked { together: TOGETHER }, values(document, compiled), waits(p));
    let mut explorer = Explorer::new(p, Limits { states: SCANS, scans: SCANS });
    let found = explorer.search(&moves, |state, moment| {
        let active = |name: &str| {
            let path = |s| compiled.symbols.step_path(s).to_string();
            state.active().any(|s| path(s).rsplit_once('.').is_some_and(|(_, last)| last == name))
        };
        Next::from(moment == Moment::Pass && active(steps.0) && active(steps.1))
    });
    matches!(found, Answer::Found(_))
}

fn name(compiled: &Compiled, rank: u32) -> Option<String> {
    compiled.symbols.label(rank).map(|l| l.trim_start_matches('T').to_owned())
}

#[test]
fn findings_of_the_analysis_are_those_of_the_prover() {
    let Some(corpus) = g7_peers::corpus("") else { return };
    let (mut wrong, mut kinds) = (Vec::new(), BTreeMap::<Explained, usize>::new());
    let (mut shared, mut open) = (0, 0);
    for (file, says) in findings(&corpus) {
        let path = corpus.join("agrafe-xmi").join("Project-AGRAFE").join(&file);
        let (mut document, _) = xmi(&std::fs::read(&path).expect("a file of the corpus"));
        without_continuous(&mut document);
        if g7_compile::compile(&document).0.is_none() {
            assert!(REFUSED.iter().any(|(end, _)| file.ends_with(end)), "{file}");
            continue;
        }
        let found = outcome(&document, &says);
        println!("{file}: {} shared, {} not decided", found.shared, found.open);
        for (subject, why) in found.explained {
            println!("  {subject}: {why:?}");
            *kinds.entry(why).or_default() += 1;
        }
        (shared, open) = (shared + found.shared, open + found.open);
        wrong.extend(found.wrong.into_iter().map(|w| format!("{file}: {w}")));
    }
    println!("{shared} findings are shared, {open} are not decided, the others: {kinds:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let differ = kinds.values().sum::<usize>();
    assert!(differ > 0 && shared > 4 * differ && shared > open, "{shared}, {open}, {kinds:?}");
}
