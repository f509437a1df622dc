//! The checker's warnings are true: on random charts no step reported as unreachable becomes
//! active, no receptivity reported as never true clears, and branches that clear together were
//! reported.
//!
//! `G7_CHARTS=5000 G7_SEED=7 cargo test -p g7-tests --test house warnings` runs longer.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::ir::StepId;
use g7_compile::{Compiled, compile};
use g7_engine::{State, scan};
use g7_model::{ChartItem, Document, Item, Problem, ProfileName, Span, codes};
use g7_tests::generate::{Event, Sample, sample};
use g7_tests::naive::Value;

/// Number of scans of one chart.
const LENGTH: usize = 60;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

/// The events of a chart during its script.
#[derive(Default)]
struct Ran {
    /// The steps that were active, by the places of their names.
    active: BTreeSet<Span>,
    /// The transitions that cleared.
    cleared: BTreeSet<Span>,
    /// The transitions that cleared in one scan, by rank.
    together: Vec<Vec<u32>>,
}

fn run(compiled: &Compiled, sample: &Sample) -> Ran {
    let (program, symbols) = (&compiled.program, &compiled.symbols);
    let mut state = State::new(program);
    let range = program.tables().inputs;
    let mut inputs = state.words()[range.start as usize..range.end as usize].to_vec();
    let mut ran = Ran::default();
    for event in &sample.script {
        let Event::Scan { now, inputs: changes } = event else { continue };
        for (name, value) in changes {
            let at = symbols.variable(name).expect("an input").addr.0 - range.start;
            inputs[at as usize] = match value {
                Value::Bool(b) => u64::from(*b),
                Value::Int(n) => *n as u64,
                Value::Real(x) => x.to_bits().into(),
                other => panic!("an input of the value {other:?}"),
            };
        }
        let ended = scan(program, &mut state, &inputs, *now);
        ran.active.extend(state.active().map(|s| symbols.step_place(s)));
        let written = |r: &&u32| symbols.is_written(**r);
        let cleared: Vec<u32> = state.cleared().iter().filter(written).copied().collect();
        ran.cleared.extend(cleared.iter().map(|r| symbols.transition_place(*r)));
        ran.together.push(cleared);
        if ended.is_err() {
            break;
        }
    }
    ran
}

fn within(inner: Span, outer: Span) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

fn set(steps: &[StepId]) -> BTreeSet<StepId> {
    steps.iter().copied().collect()
}

/// The wrong warnings for a sample.
fn mistakes(compiled: &Compiled, problems: &[Problem], ran: &Ran) -> Vec<String> {
    let mut wrong = Vec::new();
    let unit = &compiled.unit;
    let of = |code| problems.iter().filter(move |p| std::ptr::eq(p.code, code)).map(|p| p.at);
    for at in of(&codes::UNREACHABLE).filter(|at| ran.active.contains(at)) {
        wrong.push(format!("the step at {} is reached", at.start));
    }
    for at in of(&codes::NEVER_STARTS) {
        let chart = unit.charts.iter().find(|c| c.at == at).expect("a chart");
        let mut steps = (chart.steps.start..chart.steps.end).filter_map(|s| unit.steps.get(s as usize));
        if steps.any(|s| ran.active.contains(&s.at)) {
            wrong.push(format!("chart {} has started", chart.name));
        }
    }
    for at in of(&codes::NEVER_CLEARS) {
        if let Some(t) = ran.cleared.iter().find(|t| within(at, **t)) {
            wrong.push(format!("the transition at {} clears", t.start));
        }
    }
    if !unit.rules.stable && unit.rules.multi_token {
        let named: BTreeSet<Span> = of(&codes::CONFLICT).collect();
        let rows: BTreeMap<Span, usize> =
            unit.transitions.iter().enumerate().map(|(i, t)| (t.at, i)).collect();
        for ranks in &ran.together {
            let mut list: Vec<usize> = ranks
                .iter()
                .filter_map(|r| rows.get(&compiled.symbols.transition_place(*r)).copied())
                .collect();
            list.sort_unstable();
            for (k, b) in list.iter().enumerate() {
                for a in &list[..k] {
                    let (a, b) = (&unit.transitions[*a], &unit.transitions[*b]);
                    let shared = a.from.iter().any(|s| b.from.contains(s));
                    // Two transitions with the same ends lead to the same situation.
                    let alike = set(&a.from) == set(&b.from) && set(&a.to) == set(&b.to);
                    if shared && !alike && !named.contains(&b.receptivity.at) {
                        wrong.push(format!("{} and {} clear together", a.at.start, b.at.start));
                    }
                }
            }
        }
    }
    wrong
}

fn text(sample: &Sample) -> String {
    g7_syntax::print(&sample.document, None)
}

/// Removes every n-th transition, so that some steps become unreachable.
fn thin(document: &mut Document, every: usize) {
    let mut count = 0;
    for item in &mut document.items {
        let Item::Chart(chart) = item else { continue };
        chart.items.retain(|i| {
            count += usize::from(matches!(i, ChartItem::Transition(_)));
            !matches!(i, ChartItem::Transition(_)) || count % every != 0
        });
    }
}

fn look(profile: ProfileName) {
    let first = number("G7_SEED", 1);
    let (mut shapes, mut conflicts, mut nevers) = (0, 0, 0);
    for seed in first..first + number("G7_CHARTS", 400) {
        let mut sample = sample(seed, profile, LENGTH).expect("a random chart can be read");
        if seed % 2 == 0 {
            thin(&mut sample.document, 2 + seed as usize % 3);
        }
        let (compiled, problems) = compile(&sample.document);
        let compiled = compiled.expect("a random chart compiles");
        let wrong = mistakes(&compiled, &problems, &run(&compiled, &sample));
        assert!(wrong.is_empty(), "{} seed {seed}: {wrong:?}\n{}", profile.name(), text(&sample));
        let count = |code| problems.iter().filter(|p| std::ptr::eq(p.code, code)).count();
        shapes += count(&codes::UNREACHABLE) + count(&codes::NEVER_STARTS);
        conflicts += count(&codes::CONFLICT);
        nevers += count(&codes::NEVER_CLEARS);
    }
    println!("{}: {shapes} out of reach, {conflicts} conflicts, {nevers} never true", profile.name());
    assert!(shapes > 0 && nevers > 0, "nothing was out of reach or never true: nothing was tried");
}

#[test]
fn iec60848() {
    look(ProfileName::Iec60848);
}

#[test]
fn iec61131() {
    look(ProfileName::Iec61131);
}

#[test]
fn pl7() {
    look(ProfileName::Pl7);
}

#[test]
fn unity() {
    look(ProfileName::Unity);
}

#[test]
fn jgrafchart() {
    look(ProfileName::Jgrafchart);
}
