//! Random gestures on random charts: what a gesture does not concern stays where it is, unless it must give way
//! (decision 74). A symbol is concerned if the gesture makes it, names it, or changes its links.

use std::collections::{BTreeMap, BTreeSet};

use g7_draw::{Extent, Point, Sizes, layout};
use g7_edit::{Branching, Gesture, ItemId, Part, Sort, Source, apply};
use g7_model::{Chart, Document, FileId};
use g7_syntax::Tree;

#[path = "../../draw/tests/layout/maker.rs"]
mod maker;

use maker::{Random, random_chart};

fn only(document: &Document) -> &Chart {
    document.charts().next().expect("a chart")
}

/// All steps of one size and all transitions of another.
fn sizes(chart: &Chart) -> Sizes {
    let step = Extent { left: 250, right: 250, up: 0, down: 500 };
    let transition = Extent { left: 220, right: 250, up: 50, down: 50 };
    Sizes {
        steps: chart.steps().map(|_| step).collect(),
        transitions: chart.transitions().map(|_| transition).collect(),
        connectors: vec![200; chart.steps().count()],
    }
}

/// The text of a random chart. Each receptivity is another one and names its transition.
fn text(seed: u64, random: &mut Random) -> String {
    let size = 4 + random.below(14);
    let text = g7_syntax::print(&random_chart(seed, size, 0, size), None);
    let parts = text.split("when TRUE").enumerate();
    parts.map(|(n, part)| if n == 0 { part.to_owned() } else { format!("when r{n}{part}") }).collect()
}

/// A symbol: where it stands, and its links.
#[derive(Debug)]
struct Symbol {
    at: Point,
    before: BTreeSet<String>,
    behind: BTreeSet<String>,
}

/// The symbols of a chart by the names of steps and the receptivities of transitions.
fn symbols(tree: &Tree) -> BTreeMap<String, Symbol> {
    let chart = only(&tree.document);
    let places = layout(chart, &sizes(chart), &[]);
    let mut all = BTreeMap::new();
    for (s, at) in chart.steps().zip(places.steps) {
        let own = Symbol { at, before: BTreeSet::new(), behind: BTreeSet::new() };
        all.insert(s.name.text.to_string(), own);
    }
    for (t, at) in chart.transitions().zip(places.transitions) {
        let name = tree.text.get(t.receptivity.at.0.bytes()).expect("a receptivity").to_owned();
        for step in &t.from {
            all.get_mut(&*step.text).expect("a step").behind.insert(name.clone());
        }
        for step in &t.to {
            all.get_mut(&*step.text).expect("a step").before.insert(name.clone());
        }
        let names = |list: &[g7_model::Name]| list.iter().map(|n| n.text.to_string()).collect();
        all.insert(name, Symbol { at, before: names(&t.from), behind: names(&t.to) });
    }
    all
}

/// The symbols to which ways lead from one of them that do not pass another one.
fn ways<'a>(all: &'a BTreeMap<String, Symbol>, from: &'a str, without: &str) -> BTreeSet<&'a str> {
    let (mut seen, mut stack) = (BTreeSet::new(), vec![from]);
    while let Some(n) = stack.pop() {
        let behind = all[n].behind.iter().map(String::as_str);
        stack.extend(behind.filter(|n| *n != without && seen.insert(*n)));
    }
    seen
}

/// The name of the symbol that an id names in the text before.
fn name(tree: &Tree, id: &ItemId) -> String {
    let receptivity =
        |n: usize| only(&tree.document).transitions().nth(n).map(|t| t.receptivity.at.0.bytes());
    match &id.part {
        Part::Step(step) => step.clone(),
        Part::Transition(n) => {
            receptivity(*n).and_then(|at| tree.text.get(at)).unwrap_or_default().to_owned()
        }
        _ => String::new(),
    }
}

fn read(text: String) -> Tree {
    Tree::read(text, FileId(0))
}

fn run(tree: &Tree, gesture: &Gesture) -> Option<Tree> {
    let source = Source {
        text: &tree.text,
        document: &tree.document,
        problems: &tree.problems,
        marks: Some(&tree.marks),
    };
    apply(&source, gesture).ok()?.read.map(|t| *t)
}

/// Two of the symbols that stay and have passed each other: in a column, or in a row.
fn passed(before: &BTreeMap<String, Symbol>, after: &BTreeMap<String, Symbol>) -> Option<String> {
    let same = |a: &Symbol, b: &Symbol| a.before == b.before && a.behind == b.behind;
    let still: Vec<(&String, Point, Point)> =
        before.iter().filter_map(|(n, a)| Some((n, a.at, after.get(n).filter(|b| same(a, b))?.at))).collect();
    for (a, was, is) in &still {
        for (b, other, moved) in &still {
            if was.x == other.x && was.y < other.y && is.y >= moved.y {
                return Some(format!("{a} stood above {b}"));
            }
            if was.y == other.y && was.x < other.x && is.x >= moved.x {
                return Some(format!("{a} stood at the left of {b}"));
            }
        }
    }
    None
}

/// The symbols that were there before and have another place. A transition that leads elsewhere may have one.
fn moved(before: &BTreeMap<String, Symbol>, after: &BTreeMap<String, Symbol>) -> Vec<String> {
    let led = |n: &str, a: &Symbol, b: &Symbol| {
        n.starts_with('r') && (&a.before, &a.behind) != (&b.before, &b.behind)
    };
    let other = |(n, a): (&String, &Symbol)| {
        after.get(n).filter(|b| b.at != a.at && !led(n, a, b)).map(|_| n.clone())
    };
    before.iter().filter_map(other).collect()
}

/// The step at which a chart begins.
fn first(tree: &Tree) -> String {
    let chart = only(&tree.document);
    let step = chart.steps().find(|s| s.initial).or_else(|| chart.steps().next());
    step.map(|s| s.name.text.to_string()).expect("a step")
}

#[test]
fn a_sequence_without_a_way_in_stays_where_it_was() {
    let mut cut = 0;
    for seed in 0..800 {
        let mut random = Random(seed * 7 + 1);
        let tree = read(text(seed, &mut random));
        let chart = only(&tree.document);
        let step = |r: &mut Random| {
            let n = r.below(chart.steps().count());
            ItemId::step("G", &*chart.steps().nth(n).expect("a step").name.text)
        };
        let id = match random.below(2) {
            0 => step(&mut random),
            _ => ItemId::transition("G", random.below(chart.transitions().count())),
        };
        let before = symbols(&tree);
        let (begin, gone) = (first(&tree), name(&tree, &id));
        let left = ways(&before, &begin, &gone);
        // Transitions that go with a step take their columns along.
        let columns = if gone.starts_with('r') { 1 } else { before[&gone].behind.len() };
        // Where other ways lead past it, its branch is laid out anew.
        if columns > 1 || gone == begin || left.contains(&*begin) || before[&begin].before.len() != 1 {
            continue;
        }
        let Some(after) = run(&tree, &Gesture::Delete { ids: vec![id], heal: false }) else { continue };
        let now = symbols(&after);
        let adrift = now.keys().any(|n| *n != begin && !left.contains(&**n));
        if !adrift {
            continue;
        }
        let found = moved(&before, &now);
        assert!(
            found.is_empty(),
            "seed {seed}: without {gone}, moved {found:?}\n{}\n{}",
            tree.text,
            after.text
        );
        cut += 1;
    }
    assert!(cut > 100, "only {cut} gestures");
}

#[test]
fn nothing_that_stays_passes_another() {
    let (mut made, mut passing) = (0, Vec::new());
    for seed in 0..1500 {
        let mut random = Random(seed * 11 + 5);
        let tree = read(text(seed, &mut random));
        let chart = only(&tree.document);
        let nth = random.below(chart.steps().count());
        let step = ItemId::step("G", &*chart.steps().nth(nth).expect("a step").name.text);
        let transition = ItemId::transition("G", random.below(chart.transitions().count()));
        let any = if random.below(2) == 0 { step.clone() } else { transition.clone() };
        let gesture = match random.below(8) {
            0 => Gesture::Next { id: any },
            1 => Gesture::Before { id: any },
            2 => Gesture::Branch { id: step.clone(), how: Branching::Or },
            3 => Gesture::Branch { id: transition, how: Branching::And },
            4 => Gesture::Kind { id: step.clone(), kind: Sort::Enclosing },
            5 => Gesture::AddStep { chart: "G".into(), at: None, kind: None },
            6 => Gesture::Receptivity { id: transition, text: "other".into() },
            _ => Gesture::Delete { ids: vec![step.clone()], heal: true },
        };
        let begin = first(&tree);
        if matches!(gesture, Gesture::Delete { .. }) && name(&tree, &step) == begin {
            continue;
        }
        let Some(after) = run(&tree, &gesture) else { continue };
        let (before, after_all) = (symbols(&tree), symbols(&after));
        assert_eq!(before[&begin].at, after_all[&begin].at, "the beginning stays: seed {seed}, {gesture:?}");
        if matches!(gesture, Gesture::Kind { .. } | Gesture::AddStep { .. } | Gesture::Receptivity { .. }) {
            let found = moved(&before, &after_all);
            assert!(found.is_empty(), "seed {seed}: {gesture:?} moved {found:?}\n{}", tree.text);
        }
        made += 1;
        passing.extend(passed(&before, &after_all).map(|p| format!("seed {seed}: {gesture:?}: {p}")));
    }
    assert!(made > 1000, "only {made} gestures");
    // Of two ways back the short one goes up at the left; which one that is can change.
    assert!(passing.len() * 100 < made, "{made} gestures: {passing:#?}");
    assert!(!passing.iter().any(|p| p.contains("above")), "{passing:#?}");
}
