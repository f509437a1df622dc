//! `g7 prove --tests`: a small set of scenarios that reaches every step, transition, action and
//! branch that some run reaches.
//!
//! One search tells which elements some run reaches. Then a scenario goes on to the nearest
//! element that is left, and from there to the next, until none can be reached from where it is
//! (greedy: a small set, not always the smallest). What the engine shows on the way becomes the
//! expectations, for the author to confirm.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::ir::VarClass;
use g7_engine::{State, StepId, scan};
use g7_model::{BinaryOp, Expr, ExprKind, Holds, ProfileName, PropertyKind, Scenario, Span};
use g7_rig::testing::{Coverage, Sort};
use g7_rig::{Ask, Bench, Options, Source};
use g7_verify::{
    Asked, Budget, Claim, Evidence, From, Model, Move, Open, Query, Reached, Run, Verdict, reach,
};

use super::added;
use crate::failure::Failure;
use g7_rig::testing::script::{Script, activity, expr, not, path, value};

/// Scenarios with what they reach.
#[derive(Default)]
pub(super) struct Covering {
    /// The tests.
    pub(super) tests: Vec<Scenario>,
    /// The elements that they reach, as `g7 test --coverage` counts it.
    pub(super) coverage: Coverage,
    /// Why elements may be left over that some run reaches.
    pub(super) open: Option<Open>,
    /// Titles of scenarios that were left out, since `g7 test` shows another run.
    pub(super) unlike: Vec<String>,
}

pub(super) type Element = (Sort, Span);

/// The elements that the answers have shown.
#[derive(Default)]
pub(super) struct Known {
    /// Elements that no run reaches.
    never: BTreeSet<Element>,
    /// Runs that reach elements.
    runs: BTreeMap<Element, Run>,
}

impl Known {
    pub(super) fn of(asked: &Asked, answers: &[Option<Verdict>]) -> Known {
        let mut known = Known::default();
        for (q, answer) in asked.questions.iter().zip(answers) {
            let sorts: &[Sort] = match q.claim {
                Claim::Active(_) => &[Sort::Step],
                Claim::Clears(_) => &[Sort::Transition, Sort::Branch],
                Claim::Runs(_) => &[Sort::Action],
                _ => continue,
            };
            let elements = sorts.iter().map(|sort| (*sort, q.at));
            match answer {
                Some(Verdict::Refuted(_)) => known.never.extend(elements),
                Some(Verdict::Proved(Evidence::Run(run))) => {
                    known.runs.extend(elements.map(|e| (e, run.clone())));
                }
                _ => {}
            }
        }
        known
    }
}

/// Makes the scenarios of a file without errors. What is known is not searched again. The first
/// budget is for finding what is reached at all, the second one for all.
pub(super) fn cover(
    source: &Source,
    profile: Option<ProfileName>,
    known: &Known,
    budgets: [&Budget<'_>; 2],
) -> Result<Covering, Failure> {
    let assumed: Vec<Ask> = source
        .document
        .properties()
        .filter_map(|p| if let PropertyKind::Assume(e) = &p.kind { Some(e) } else { None })
        .map(|e| Ask { expr: e.clone(), of_plant: false })
        .collect();
    let options = Options { profile, plant: Some("none"), asks: &assumed, ..Options::default() };
    let Some(bench) = g7_rig::build(source, &options)?.0 else { return Ok(Covering::default()) };
    // The conditions that were asked stand last among the conditions of the program.
    let first = bench.compiled.queries.len().saturating_sub(assumed.len()) as u32;
    let assume = (first..).take(assumed.len()).map(Query).collect();
    let model = Model::new(&bench.compiled, assume);
    let coverage = Coverage::of(&bench, source);
    let search = Search { bench: &bench, coverage: &coverage, model: &model, budgets };
    let (tours, open) = search.tours(known);
    let tests: Vec<Scenario> =
        (1..).zip(&tours).map(|(number, tour)| scenario(&bench, &coverage, number, tour)).collect();
    let (_, outcomes, _) = added::run(source, &tests, profile)?;
    let fine = |title: &str| outcomes.iter().any(|o| o.title == title && o.defect.is_none());
    let (tests, unlike): (Vec<_>, Vec<_>) = tests.into_iter().partition(|t| fine(&t.title));
    let coverage = added::run(source, &tests, profile)?.2;
    Ok(Covering { tests, coverage, open, unlike: unlike.into_iter().map(|t| t.title.into()).collect() })
}

/// A scenario: its scans, and where it reaches something new, the number of scans before with
/// what it reaches from there on.
#[derive(Default)]
struct Tour {
    moves: Vec<Move>,
    legs: Vec<(usize, Vec<Element>)>,
}

struct Search<'a> {
    bench: &'a Bench,
    coverage: &'a Coverage,
    model: &'a Model<'a>,
    budgets: [&'a Budget<'a>; 2],
}

impl Search<'_> {
    /// Scenarios that reach everything, and why there may be more to reach. The first ones begin as
    /// tests do; one that begins with other inputs is used only for what these do not reach.
    fn tours(&self, known: &Known) -> (Vec<Tour>, Option<Open>) {
        let [first_budget, budget] = self.budgets;
        let mut left = elements(self.coverage);
        left.retain(|e| !known.never.contains(e));
        let (mut tours, mut open) = (Vec::new(), None);
        for from in [From::Rest, From::Start] {
            let first = self.reach(first_budget, from, &left, left.len());
            let mut mine: BTreeMap<Element, Run> = BTreeMap::new();
            for (number, run) in first.runs {
                mine.extend(left.iter().nth(number).map(|e| (*e, run)));
            }
            if matches!(from, From::Start) {
                let there = known.runs.iter().filter(|(e, _)| left.contains(e));
                mine.extend(there.map(|(e, run)| (*e, run.clone())));
            }
            left.retain(|e| !mine.contains_key(e));
            open = first.open.filter(|_| !left.is_empty());
            while !mine.is_empty() {
                let before = mine.len();
                tours.push(self.tour(from, &mut mine));
                // The budget ends the search for the next leg; then the first run serves.
                if mine.len() == before {
                    tours.pop();
                    let Some((_, run)) = mine.pop_first() else { break };
                    let mut tour = Tour::default();
                    self.go_on(&mut tour, run.moves, &mut mine);
                    tours.push(tour);
                    open = open.or_else(|| stopped(budget));
                }
            }
            if left.is_empty() {
                break;
            }
        }
        (tours, open)
    }

    /// Goes from one element to the next, always the nearest that is left.
    fn tour(&self, from: From<'_>, left: &mut BTreeMap<Element, Run>) -> Tour {
        let mut tour = Tour::default();
        while !left.is_empty() {
            let from = if tour.moves.is_empty() { from } else { From::Behind(&tour.moves) };
            let found = self.reach(self.budgets[1], from, &left.keys().copied().collect(), 1);
            let Some(next) = found.runs.into_values().min_by_key(|run| run.moves.len()) else { break };
            self.go_on(&mut tour, next.moves, left);
        }
        tour
    }

    /// Adds scans to a scenario; what they reach is left no more.
    fn go_on(&self, tour: &mut Tour, moves: Vec<Move>, left: &mut BTreeMap<Element, Run>) {
        let before = tour.moves.len();
        tour.moves.extend(moves);
        let mut new = Vec::new();
        repeat(self.bench, &tour.moves, |number, state| {
            if number >= before {
                for e in self.coverage.reached(self.bench, state) {
                    if left.remove(&e).is_some() {
                        new.push(e);
                    }
                }
            }
        });
        tour.legs.push((before, new));
    }

    /// The nearest scans with so many of the elements; each has its place among them as its number.
    fn reach(&self, budget: &Budget<'_>, from: From<'_>, left: &BTreeSet<Element>, count: usize) -> Reached {
        let numbers: BTreeMap<&Element, usize> = left.iter().zip(0..).collect();
        let mut see = |state: &mut State| {
            let reached = self.coverage.reached(self.bench, state);
            reached.iter().filter_map(|e| numbers.get(e).copied()).collect()
        };
        reach(self.model, budget, from, count, &mut see)
    }
}

/// Why there may be fewer scenarios, if the search for them was stopped.
fn stopped(budget: &Budget<'_>) -> Option<Open> {
    (budget.stop)().then(Open::default)
}

/// All that a test can reach.
fn elements(coverage: &Coverage) -> BTreeSet<Element> {
    let sorts = Sort::ALL.into_iter().zip(coverage.sorts());
    sorts.flat_map(|(sort, (_, rows))| rows.keys().map(move |at| (sort, *at))).collect()
}

/// Repeats a run; `see` is shown each scan.
fn repeat(bench: &Bench, moves: &[Move], mut see: impl FnMut(usize, &mut State)) {
    let p = &bench.compiled.program;
    let mut s = State::new(p);
    for (number, m) in moves.iter().enumerate() {
        let now = s.now().saturating_add(m.wait);
        if scan(p, &mut s, &m.inputs, now).is_err() {
            break;
        }
        see(number, &mut s);
    }
}

/// The elements in words, `step 2, transition 1 -> 2`; a branch has the name of its transition.
fn names(coverage: &Coverage, elements: &[Element]) -> String {
    let of = |(sort, at): &Element| {
        let sorts = coverage.sorts();
        let (word, rows) = match sort {
            Sort::Step => ("step", sorts[0].1),
            Sort::Transition => ("transition", sorts[1].1),
            Sort::Action => ("action", sorts[2].1),
            Sort::Branch => return None,
        };
        rows.get(at).map(|row| format!("{word} {}", row.name))
    };
    elements.iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

/// A tour as a test: behind each scan what has changed is expected.
fn scenario(bench: &Bench, coverage: &Coverage, number: usize, tour: &Tour) -> Scenario {
    let mut script = Script::new(bench);
    let mut shown = Shown::new(bench);
    repeat(bench, &tour.moves, |scan, state| {
        if let Some((_, new)) = tour.legs.iter().find(|(before, _)| *before == scan) {
            let names = names(coverage, new);
            if !names.is_empty() {
                script.comment(&format!("reaches {names}"));
            }
        }
        if let Some(m) = tour.moves.get(scan) {
            script.scan(&m.inputs);
            script.expect(shown.changes(bench, state));
        }
    });
    script.end(&format!("scenario {number}"))
}

/// The situation and outputs that were expected last.
struct Shown {
    active: BTreeSet<StepId>,
    outputs: Vec<Vec<u64>>,
}

impl Shown {
    fn new(bench: &Bench) -> Shown {
        let state = State::new(&bench.compiled.program);
        Shown { active: BTreeSet::new(), outputs: outputs(bench).map(|v| v.value(&state).to_vec()).collect() }
    }

    /// The values that are not as they were: steps in the order of the program, then outputs.
    fn changes(&mut self, bench: &Bench, state: &State) -> Vec<Expr> {
        let symbols = &bench.compiled.symbols;
        let active: BTreeSet<StepId> = state.active().filter(|s| symbols.is_listed(*s)).collect();
        let new = active.difference(&self.active).filter_map(|s| activity(bench, *s));
        let old = self.active.difference(&active).filter_map(|s| activity(bench, *s)).map(not);
        let mut found: Vec<Expr> = new.chain(old).collect();
        self.active = active;
        for (v, shown) in outputs(bench).zip(&mut self.outputs) {
            let now = v.value(state);
            if now != shown.as_slice() {
                found.push(match v.ty.holds() {
                    Some(Holds::Truth) if now.first() == Some(&0) => not(path(&v.name)),
                    Some(Holds::Truth) => path(&v.name),
                    _ => {
                        let (left, right) = (Box::new(path(&v.name)), Box::new(value(v.ty, now)));
                        expr(ExprKind::Binary(BinaryOp::Eq, left, right))
                    }
                });
                *shown = now.to_vec();
            }
        }
        found
    }
}

/// The outputs that have one value each.
fn outputs(bench: &Bench) -> impl Iterator<Item = &g7_compile::symbols::Variable> {
    bench.compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Output && v.elements == 1)
}
