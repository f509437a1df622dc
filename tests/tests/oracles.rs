//! The steps that the engine can reach in charts of the AGRAFE corpus are those
//! that the static analysis of the same project lists.
//!
//! Breadth first over scans: in each situation, all values of the inputs that its
//! transitions and events read (all together while these are few, else those of
//! one transition after the other), with and without a long wait before. A state
//! that brings a new step, or a new value of a variable while a step is active,
//! goes first. Bounded by a number of scans; charts with counters have no end.
//!
//! The corpus stands at `G7_CORPUS`, else `../shared/corpus` beside the repository.
#![allow(clippy::disallowed_methods, reason = "the corpus is read")]

use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use std::path::{Path, PathBuf};

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_engine::{Addr, State, StepId, begin, finish, pass};
use g7_exchange::Format;
use g7_model::{
    ActionKind, Chart, ChartItem, Document, Expr, ExprKind, FileId, Item, Literal, Severity, Step, Stmt,
    StmtKind, Target, UnaryOp,
};

/// Scans of one chart.
const SCANS: usize = 40_000;
/// Passes after which a scan counts as one that never rests.
const PASSES: usize = 60;
/// Inputs that are tried all together.
const TOGETHER: usize = 6;
/// Longer than all delays of the corpus, which are whole seconds.
const LONG: i64 = 60_000_000_000;
/// Shorter than them.
const SHORT: i64 = 1_000_000;

fn corpus() -> PathBuf {
    match std::env::var_os("G7_CORPUS") {
        Some(path) => PathBuf::from(path),
        None => [env!("CARGO_MANIFEST_DIR"), "..", "..", "shared", "corpus"].iter().collect(),
    }
}

/// What the analysis says of a file.
#[derive(Default)]
struct Says {
    /// The steps that it lists as reachable: `G1.12`.
    steps: BTreeSet<String>,
    /// The labels of the transitions that it says never clear: `T12`.
    never: BTreeSet<String>,
}

/// What the analysis says of each file.
fn oracles(corpus: &Path) -> Option<BTreeMap<String, Says>> {
    let text = std::fs::read_to_string(corpus.join("agrafe-oracles.json")).ok()?;
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
    Some(found)
}

/// An input with the values that are worth trying.
#[derive(Clone, Debug)]
struct Choice {
    word: usize,
    values: Vec<u64>,
}

/// What reads inputs while some steps are active: a transition or an event.
struct Reader {
    needs: Vec<StepId>,
    inputs: Vec<usize>,
}

struct Explorer<'c> {
    compiled: &'c Compiled,
    choices: Vec<Choice>,
    readers: Vec<Reader>,
    timed: bool,
    /// The words that decide what follows: those of the charts' own variables, and
    /// inputs whose edges or delays are asked for.
    telling: Vec<Addr>,
    reached: BTreeSet<StepId>,
    /// Each step with each value that a variable had while it was active.
    met: HashSet<(StepId, Addr, u64)>,
    seen: HashSet<(Vec<StepId>, Vec<u64>, Vec<bool>)>,
    queue: VecDeque<State>,
    scans: usize,
}

impl<'c> Explorer<'c> {
    fn new(document: &Document, compiled: &'c Compiled) -> Explorer<'c> {
        let constants = constants(document);
        let from = compiled.program.tables().inputs.start;
        let mut choices = Vec::new();
        let mut names = BTreeMap::new();
        for v in compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Input) {
            names.insert(v.name.to_string(), choices.len());
            let values = if v.ty == g7_model::Type::Bool { vec![0, 1] } else { constants.clone() };
            choices.push(Choice { word: (v.addr.0 - from) as usize, values });
        }
        let own = compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Internal);
        let mut explorer = Explorer {
            telling: own.map(|v| v.addr).collect(),
            compiled,
            choices,
            readers: Vec::new(),
            timed: false,
            reached: BTreeSet::new(),
            met: HashSet::new(),
            seen: HashSet::new(),
            queue: VecDeque::new(),
            scans: 0,
        };
        for chart in document.charts() {
            explorer.read(chart, &names);
        }
        explorer
    }

    /// Notes which inputs the transitions and events of a chart read.
    fn read(&mut self, chart: &Chart, names: &BTreeMap<String, usize>) {
        let id = |step: &str| self.compiled.symbols.step(&format!("{}.{step}", chart.name.text));
        let mut readers = Vec::new();
        let mut timed = false;
        let mut remembered = BTreeSet::new();
        let of = |e: &Expr| {
            let mut inputs = BTreeSet::new();
            walk(e, &mut |e| {
                if let ExprKind::Path(path) = &e.kind {
                    inputs.extend(names.get(&path.text()).copied());
                }
            });
            inputs
        };
        let mut note = |needs: Vec<StepId>, e: &Expr| {
            let inputs = of(e);
            walk(e, &mut |e| match &e.kind {
                ExprKind::Timer { .. } => {
                    timed = true;
                    remembered.extend(of(e));
                }
                ExprKind::Unary(UnaryOp::Rise | UnaryOp::Fall, _) => remembered.extend(of(e)),
                _ => {}
            });
            readers.push(Reader { needs, inputs: inputs.into_iter().collect() });
        };
        for t in chart.transitions() {
            note(t.from.iter().filter_map(|n| id(&n.text)).collect(), &t.receptivity);
        }
        for step in chart.steps() {
            for action in &step.actions {
                match &action.kind {
                    ActionKind::OnEvent { event, .. } => {
                        note(id(&step.name.text).into_iter().collect(), event)
                    }
                    ActionKind::Qualified { target: Target::Work(work), .. } => {
                        for Stmt { kind, .. } in work.statements() {
                            if let StmtKind::Assign { value, .. } = kind {
                                note(id(&step.name.text).into_iter().collect(), value);
                            }
                        }
                    }
                    _ => {}
                }
            }
        }
        let from = self.compiled.program.tables().inputs.start;
        let words = remembered.iter().filter_map(|i| self.choices.get(*i));
        self.telling.extend(words.map(|c| Addr(from + c.word as u32)));
        self.readers.extend(readers);
        self.timed |= timed;
    }

    /// Explores; ends early when these steps, and all there are, were reached.
    fn run(&mut self) {
        let program = &self.compiled.program;
        let inputs = vec![0; self.input_words()];
        self.step(&State::new(program), &inputs, 0);
        while let Some(state) = self.queue.pop_front() {
            if self.reached.len() == program.tables().steps.len() || self.scans >= SCANS {
                return;
            }
            for inputs in self.moves(&state) {
                self.step(&state, &inputs, SHORT);
                if self.timed {
                    self.step(&state, &inputs, LONG);
                }
            }
        }
    }

    fn input_words(&self) -> usize {
        let inputs = self.compiled.program.tables().inputs;
        (inputs.end - inputs.start) as usize
    }

    /// The inputs worth trying in a state.
    fn moves(&self, state: &State) -> Vec<Vec<u64>> {
        let from = self.compiled.program.tables().inputs.start;
        let now: Vec<u64> = (0..self.input_words()).map(|i| state.word(Addr(from + i as u32))).collect();
        let enabled = || self.readers.iter().filter(|r| r.needs.iter().all(|s| state.is_active(*s)));
        let all: BTreeSet<usize> = enabled().flat_map(|r| r.inputs.iter().copied()).collect();
        let mut moves = BTreeSet::new();
        if all.len() <= TOGETHER {
            self.combine(&all.into_iter().collect::<Vec<_>>(), now, &mut moves);
        } else {
            for reader in enabled() {
                self.combine(&reader.inputs, now.clone(), &mut moves);
            }
        }
        moves.into_iter().collect()
    }

    /// All values of some inputs, the others as they are.
    fn combine(&self, inputs: &[usize], now: Vec<u64>, moves: &mut BTreeSet<Vec<u64>>) {
        let mut found = vec![now];
        for choice in inputs.iter().filter_map(|i| self.choices.get(*i)) {
            found = found
                .into_iter()
                .flat_map(|old| {
                    choice.values.iter().map(move |value| {
                        let mut new = old.clone();
                        new[choice.word] = *value;
                        new
                    })
                })
                .collect();
        }
        moves.extend(found);
    }

    /// One scan, pass by pass: transient steps are reached as well.
    fn step(&mut self, state: &State, inputs: &[u64], wait: i64) {
        let program = &self.compiled.program;
        let mut next = state.clone();
        self.scans += 1;
        let before = self.reached.len();
        if begin(program, &mut next, inputs, state.now() + wait).is_err() {
            return;
        }
        self.reached.extend(next.active());
        let mut rests = false;
        for _ in 0..PASSES {
            let Ok(changed) = pass(program, &mut next) else { return };
            self.reached.extend(next.active());
            if !changed {
                rests = true;
                break;
            }
        }
        if !rests || finish(program, &mut next).is_err() {
            return;
        }
        // Times are left out: a timer runs, or has run out after a long wait.
        let timers = (0..program.tables().watches.len() as u32)
            .map(|w| next.timer(program, g7_engine::WatchId(w)))
            .collect();
        let told: Vec<u64> = self.telling.iter().map(|a| next.word(*a)).collect();
        let mut new = self.reached.len() > before;
        for step in next.active() {
            for (addr, value) in self.telling.iter().zip(&told) {
                new |= self.met.insert((step, *addr, *value));
            }
        }
        if self.seen.insert((next.active().collect(), told, timers)) {
            if new {
                self.queue.push_front(next);
            } else {
                self.queue.push_back(next);
            }
        }
    }

    fn names(&self) -> BTreeSet<String> {
        self.reached.iter().map(|s| self.compiled.symbols.step_path(*s).to_string()).collect()
    }
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

/// Whether every transition that leads to a step never clears, as the analysis
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

fn is_continuous(kind: &ActionKind) -> bool {
    matches!(kind, ActionKind::Qualified { target: Target::Path(_), .. })
}

#[test]
fn reachable_steps_are_those_of_the_analysis() {
    let corpus = corpus();
    let Some(oracles) = oracles(&corpus) else {
        println!("skipped: no corpus");
        return;
    };
    let mut wrong = Vec::new();
    for (file, says) in &oracles {
        let wanted = &says.steps;
        let path = corpus.join("agrafe-xmi").join("Project-AGRAFE").join(file);
        let bytes = std::fs::read(&path).expect("a file of the corpus");
        let (mut document, _) = g7_exchange::import(Format::Xmi, &bytes, FileId(0));
        let actions = document.items.iter_mut().filter_map(steps_of).flatten().map(|s| &mut s.actions);
        // No condition of the meta-model reads an output, so these move nothing;
        // some charts drive and assign one output, which the checker refuses.
        actions.for_each(|a| a.retain(|a| !is_continuous(&a.kind)));
        let (compiled, problems) = g7_compile::compile(&document);
        let Some(compiled) = compiled else {
            if !REFUSED.iter().any(|(end, _)| file.ends_with(end)) {
                wrong.push(format!("{file}: {problems:?}"));
            }
            continue;
        };
        let mut explorer = Explorer::new(&document, &compiled);
        explorer.run();
        let found = explorer.names();
        println!("{file}: {} of {} steps in {} scans", found.len(), wanted.len(), explorer.scans);
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

/// What the checker refuses in the corpus, in the order of the paths, and why.
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
    let mut files = Vec::new();
    charts(&corpus().join("agrafe-xmi"), &mut files);
    files.sort();
    if files.is_empty() {
        println!("skipped: no corpus");
        return;
    }
    let mut refused = Vec::new();
    for file in &files {
        let bytes = std::fs::read(file).expect("a file of the corpus");
        let (document, _) = g7_exchange::import(Format::Xmi, &bytes, FileId(0));
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
