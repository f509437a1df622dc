//! The steps that the engine can reach in charts of the AGRAFE corpus are those
//! that the static analysis of the same project lists.
//!
//! The search is that of `g7-verify`: breadth first over scans, with the values of
//! the inputs that the situation asks for (all together while these are few, else
//! those of one reader after the other), with and without a long wait before. A
//! state that brings a new step, or a new value of a variable while a step is
//! active, goes first. Bounded by a number of scans; charts with counters have no end.
//!
//! `oracles/prover.rs` asks the prover what the analysis says of transitions and concurrent steps.
//! The corpus is found by `g7_peers::corpus`.
#![allow(clippy::disallowed_methods, reason = "the corpus is read")]

mod prover;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_engine::{Addr, Program, Subject, WatchId};
use g7_model::{
    ActionKind, Chart, ChartItem, Document, Expr, ExprKind, FileId, Item, Literal, Problem, Severity, Step,
    Target,
};
use g7_verify::{Explorer, Inputs, Limits, Moment, Next, Which};

/// A chart of the meta-model, as much of it as could be read.
fn xmi(bytes: &[u8]) -> (Document, Vec<Problem>) {
    let format = g7_exchange::named("xmi").expect("a format");
    format.read(bytes, FileId(0)).expect("a format that is read")
}

/// Scans of one chart.
const SCANS: usize = 40_000;
/// Inputs that are tried all together.
const TOGETHER: usize = 6;
/// Longer than all delays of the corpus, which are whole seconds.
const LONG: i64 = 60_000_000_000;

/// The verdict of the analysis on a file.
#[derive(Default)]
struct Says {
    /// The steps that it lists as reachable: `G1.12`.
    steps: BTreeSet<String>,
    /// The labels of the transitions that it says never clear: `T12`.
    never: BTreeSet<String>,
}

/// The verdicts of the analysis on each file.
fn oracles(corpus: &Path) -> BTreeMap<String, Says> {
    let text = std::fs::read_to_string(corpus.join("agrafe-oracles.json")).expect("the analysis");
    let all: serde_json::Value = serde_json::from_str(&text).expect("the oracles are JSON");
    let mut found = BTreeMap::new();
    for (file, says) in all.as_object().expect("files by name") {
        let entry: &mut Says = found.entry(file.clone()).or_default();
        let never = says["never_fires"].as_array().into_iter().flatten();
        entry.never.extend(never.filter_map(|t| t.as_str()).map(|t| format!("T{t}")));
        for partial in says["partials"].as_array().expect("a list of charts") {
            let chart = partial["dep"].as_str().expect("a name");
            for step in partial["reachable"].as_array().expect("a list of steps") {
                let number = step.as_str().expect("a step").trim_start_matches('s');
                entry.steps.insert(format!("{chart}.{number}"));
            }
        }
    }
    found
}

/// The steps that the engine reaches, and the scans that it took. The search ends
/// early when all steps that there are were reached.
fn reached(document: &Document, compiled: &Compiled) -> (BTreeSet<String>, usize) {
    let p = &compiled.program;
    let steps = p.tables().steps.len();
    let moves = Inputs::new(p, Which::Asked { together: TOGETHER }, values(document, compiled), waits(p));
    let mut explorer = Explorer::new(p, Limits { states: SCANS, scans: SCANS });
    // The values that decide what follows, beside the situation.
    let own = compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Internal);
    let mut telling: BTreeSet<Addr> = own.map(|v| v.addr).collect();
    telling.extend(p.tables().word_watches.iter().map(|(word, _)| *word));
    let (mut reached, mut met) = (BTreeSet::new(), BTreeSet::new());
    explorer.search(&moves, |state, moment| {
        // Behind every pass: transient steps are reached as well.
        let before = reached.len();
        reached.extend(state.active());
        if reached.len() == steps {
            return Next::Stop;
        }
        let mut new = reached.len() > before;
        if moment == Moment::End {
            for step in state.active() {
                for word in &telling {
                    new |= met.insert((step, *word, state.word(*word)));
                }
            }
        }
        if new { Next::Hurry } else { Next::Go }
    });
    let names = reached.iter().map(|s| compiled.symbols.step_path(*s).to_string()).collect();
    (names, explorer.scans())
}

/// The values of each input that are worth trying.
fn values(document: &Document, compiled: &Compiled) -> Vec<Vec<u64>> {
    let rows = compiled.program.tables().inputs;
    let constants = constants(document);
    let mut values = vec![Vec::new(); (rows.end - rows.start) as usize];
    for v in compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Input) {
        values[(v.addr.0 - rows.start) as usize] =
            if v.ty == g7_model::Type::Bool { vec![0, 1] } else { constants.clone() };
    }
    values
}

/// Where something waits, a scan at once and one after all delays.
fn waits(p: &Program) -> Vec<i64> {
    let timed = (0..p.tables().watches.len() as u32).any(|w| p.reads(Subject::Watch(WatchId(w))).time)
        || (0..p.tables().transitions.len() as u32).any(|t| p.reads(Subject::Transition(t)).time);
    if timed { vec![0, LONG] } else { vec![0] }
}

/// The numbers that a document compares with, and those beside them.
fn constants(document: &Document) -> Vec<u64> {
    let mut found = BTreeSet::from([0u64]);
    for t in document.charts().flat_map(Chart::transitions) {
        walk(&t.receptivity, &mut |e| {
            if let ExprKind::Literal(Literal::Int(n, _)) = &e.kind
                && let Ok(n) = i64::try_from(*n)
            {
                found.extend([n - 1, n, n + 1].map(|n| n as u64));
            }
        });
    }
    found.into_iter().collect()
}

/// Every part of an expression.
fn walk(e: &Expr, visit: &mut impl FnMut(&Expr)) {
    visit(e);
    match &e.kind {
        ExprKind::Unary(_, a) => walk(a, visit),
        ExprKind::Binary(_, a, b) => {
            walk(a, visit);
            walk(b, visit);
        }
        ExprKind::Timer { e, .. } => walk(e, visit),
        _ => {}
    }
}

/// Steps that the analysis lists and no evolution reaches.
///
/// In `stepReachability3` the transitions before step 2 and before step 5 clear
/// together, and step 5 stores 1 in `k`: `k < 1` is false when the transition
/// before step 3 is enabled for the first time. The analysis lets one of the two
/// go first.
const UNREACHED: &[(&str, &str)] =
    &[("testInstances_reachability/stepReachability3.grafcet", "GRAFCETChart.3")];

/// True if every transition that leads to a step never clears, as the analysis
/// says itself: it lists such steps as reachable all the same.
fn cut_off(document: &Document, step: &str, never: &BTreeSet<String>) -> bool {
    let Some((chart, name)) = step.split_once('.') else { return false };
    let chart = document.charts().filter(|c| &*c.name.text == chart);
    let mut before =
        chart.flat_map(Chart::transitions).filter(|t| t.to.iter().any(|n| &*n.text == name)).peekable();
    before.peek().is_some() && before.all(|t| t.label.as_ref().is_some_and(|l| never.contains(&*l.text)))
}

fn steps_of(item: &mut Item) -> Option<impl Iterator<Item = &mut Step>> {
    let Item::Chart(chart) = item else { return None };
    Some(chart.items.iter_mut().filter_map(|i| if let ChartItem::Step(s) = i { Some(s) } else { None }))
}

/// No condition of the meta-model reads an output, so continuous actions move nothing; some charts drive
/// and assign one output, which the checker refuses.
fn without_continuous(document: &mut Document) {
    let actions = document.items.iter_mut().filter_map(steps_of).flatten().map(|s| &mut s.actions);
    actions.for_each(|a| a.retain(|a| !is_continuous(&a.kind)));
}

fn is_continuous(kind: &ActionKind) -> bool {
    matches!(kind, ActionKind::Qualified { target: Target::Path(_), .. })
}

#[test]
fn reachable_steps_are_those_of_the_analysis() {
    let Some(corpus) = g7_peers::corpus("") else { return };
    let oracles = oracles(&corpus);
    let mut wrong = Vec::new();
    for (file, says) in &oracles {
        let wanted = &says.steps;
        let path = corpus.join("agrafe-xmi").join("Project-AGRAFE").join(file);
        let bytes = std::fs::read(&path).expect("a file of the corpus");
        let (mut document, _) = xmi(&bytes);
        without_continuous(&mut document);
        let (compiled, problems) = g7_compile::compile(&document);
        let Some(compiled) = compiled else {
            if !REFUSED.iter().any(|(end, _)| file.ends_with(end)) {
                wrong.push(format!("{file}: {problems:?}"));
            }
            continue;
        };
        let (found, scans) = reached(&document, &compiled);
        println!("{file}: {} of {} steps in {scans} scans", found.len(), wanted.len());
        let extra: Vec<_> = found.difference(wanted).collect();
        let missing: Vec<_> = wanted
            .difference(&found)
            .filter(|s| {
                !UNREACHED.contains(&(file.as_str(), s.as_str())) && !cut_off(&document, s, &says.never)
            })
            .collect();
        if !extra.is_empty() || !missing.is_empty() {
            wrong.push(format!("{file}: not listed {extra:?}, not reached {missing:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The charts in a folder and below.
fn charts(folder: &Path, all: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|e| e.path()) {
        if path.is_dir() {
            charts(&path, all);
        } else if path.extension().is_some_and(|e| e == "grafcet" || e == "ecore") {
            all.push(path);
        }
    }
}

/// The files of the corpus that the checker refuses, in the order of the paths, and why.
const REFUSED: &[(&str, &str)] = &[
    // Two outputs are driven by continuous actions and assigned by stored ones.
    ("grafcet.productionSystem.v1/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.v2/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.v3/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.modification1/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.modification10/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.modification2/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.modification4/productionSystem.grafcet", "G0306"),
    ("grafcet.productionSystem.modification6/productionSystem.grafcet", "G0306"),
    // The event of its stored action is `a and not a`: no edge.
    ("testInstances_transitions/flawedTransitions4.grafcet", "G0302"),
    // Actions write two inputs.
    ("oncon2025_faultySchumacher.grafcet", "G0214"),
];

#[test]
fn charts_of_the_corpus_are_checked() {
    let Some(corpus) = g7_peers::corpus("agrafe-xmi") else { return };
    let mut files = Vec::new();
    charts(&corpus, &mut files);
    files.sort();
    let mut refused = Vec::new();
    for file in &files {
        let bytes = std::fs::read(file).expect("a file of the corpus");
        let (document, _) = xmi(&bytes);
        let (_, problems) = g7_compile::compile(&document);
        let errors: BTreeSet<&str> =
            problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| p.code.id).collect();
        if !errors.is_empty() {
            refused.push((file.display().to_string(), errors));
        }
    }
    assert_eq!(refused.len(), REFUSED.len(), "{refused:?}");
    for ((file, errors), (end, wanted)) in refused.iter().zip(REFUSED) {
        assert!(file.ends_with(end), "{file}");
        assert_eq!(*errors, BTreeSet::from([*wanted]), "{file}");
    }
}
