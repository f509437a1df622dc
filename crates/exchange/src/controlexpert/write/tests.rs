//! Laws of the grid, on charts at random: what stands where, and what touches.

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::lay::{Grid, Kind, grid};
use super::plan::{Plan, Undrawn};
use crate::controlexpert::read::{
    BarNode, Condition, JumpNode, LinkNode, Sheet, Spot, StepNode, StepSort, TransitionNode,
};
use crate::flow::Ends;
use g7_iec::report::Report;

/// The plan of a chart whose first step is initial.
fn plan(steps: usize, transitions: &[(&[usize], &[usize])]) -> Result<Plan, Vec<Undrawn>> {
    let ends = transitions.iter().map(|(from, to)| Ends { from: from.to_vec(), to: to.to_vec() }).collect();
    let ranks: Vec<(u32, usize)> = (0..transitions.len()).map(|i| (u32::MAX, i)).collect();
    Plan::new(steps, ends, &ranks, vec![0])
}

/// Draws a chart as lines of text: `S0`, `T0`, `^` for a jump, in each cell; bars beside.
fn drawn(steps: usize, transitions: &[(&[usize], &[usize])]) -> Vec<String> {
    let grid = grid(&plan(steps, transitions).expect("a chart that has a drawing"));
    let mut cells: BTreeMap<(i32, i32), String> = BTreeMap::new();
    let mut put = |(x, y): Spot, text: String| {
        assert!(cells.insert((y, x), text).is_none(), "two objects in {x}, {y}");
    };
    grid.steps.iter().enumerate().for_each(|(i, s)| put(*s, format!("S{i}")));
    grid.transitions.iter().enumerate().for_each(|(i, s)| put(*s, format!("T{i}")));
    grid.jumps.iter().for_each(|(to, s)| put(*s, format!("^{to}")));
    let mut lines: Vec<String> = Vec::new();
    for ((y, x), text) in cells {
        let row = usize::try_from(y).expect("a row");
        lines.resize(lines.len().max(row + 1), String::new());
        let column = 3 * usize::try_from(x).expect("a column");
        let line = &mut lines[row];
        *line = format!("{line:<column$}{text}");
    }
    let mut beside: Vec<String> = Vec::new();
    for bar in &grid.bars {
        beside.push(format!("{} {},{} {}", bar.kind.word(), bar.at.0, bar.at.1, bar.width));
    }
    for link in &grid.links {
        let end = |(kind, (x, y)): (Kind, Spot)| format!("{} {x},{y}", kind.word());
        beside.push(format!("{} -> {}", end(link.from), end(link.to)));
    }
    beside.sort();
    lines.extend(beside);
    lines
}

#[test]
fn a_sequence_stands_in_one_column_and_jumps_back() {
    let lines = drawn(3, &[(&[0], &[1]), (&[1], &[2]), (&[2], &[0])]);
    assert_eq!(lines, ["S0", "T0", "S1", "T1", "S2", "T2", "^0"]);
}

#[test]
fn branches_of_one_length_meet_in_a_joint_below_them() {
    let lines = drawn(4, &[(&[0], &[1]), (&[0], &[2]), (&[1], &[3]), (&[2], &[3]), (&[3], &[0])]);
    let wanted = ["S0", "T0 T1", "S1 S2", "T2 T3", "S3", "T4", "^0", "altBranch 0,1 2", "altJoint 0,3 2"];
    assert_eq!(lines, wanted);
}

#[test]
fn branches_of_other_lengths_have_links_to_their_joint() {
    // 0 -> 1 -> 2 beside 0 -> 2.
    let lines = drawn(3, &[(&[0], &[1]), (&[0], &[2]), (&[1], &[2]), (&[2], &[0])]);
    let wanted = [
        "S0",
        "T0 T1",
        "S1",
        "T2",
        "",
        "",
        "",
        "S2",
        "T3",
        "^0",
        "altBranch 0,1 2",
        "altJoint 0,6 2",
        "transition 0,3 -> altJoint 0,6",
        "transition 1,1 -> altJoint 1,6",
    ];
    assert_eq!(lines, wanted);
}

#[test]
fn parallel_branches_begin_and_end_in_the_row_of_their_steps() {
    let lines = drawn(4, &[(&[0], &[1, 2]), (&[1, 2], &[3]), (&[3], &[0])]);
    let wanted = ["S0", "T0", "S1 S2", "T1", "S3", "T2", "^0", "parBranch 0,2 2", "parJoint 0,2 2"];
    assert_eq!(lines, wanted);
}

#[test]
fn a_chart_without_a_drawing_is_told() {
    let told = |transitions: &[(&[usize], &[usize])]| plan(4, transitions).map(|_| ()).unwrap_err();
    assert_eq!(told(&[(&[], &[1])]), [Undrawn::Source(0)]);
    assert_eq!(told(&[(&[1], &[])]), [Undrawn::Sink(0)]);
    assert_eq!(told(&[(&[0], &[1, 2]), (&[1, 2], &[0]), (&[2], &[3])]), [Undrawn::Joined(1, 2)]);
    assert_eq!(told(&[(&[0], &[1, 2]), (&[3], &[2, 0])]), [Undrawn::Parted(1, 2)]);
}

/// The law: no two objects in one cell, each step with its transitions below it or below its branch,
/// and nothing else where something would touch.
fn sound(grid: &Grid) {
    let mut cells: BTreeSet<Spot> = BTreeSet::new();
    let jumps = grid.jumps.iter().map(|j| &j.1);
    for spot in grid.steps.iter().chain(&grid.transitions).chain(jumps) {
        assert!(spot.0 >= 0 && spot.1 >= 0 && spot.0 < grid.right, "{spot:?}\n{grid:#?}");
        assert!(cells.insert(*spot), "two objects in {spot:?}\n{grid:#?}");
    }
    let mut bars: BTreeSet<(bool, Spot)> = BTreeSet::new();
    for bar in &grid.bars {
        let opens = matches!(bar.kind, Kind::ParBranch | Kind::AltBranch);
        for column in bar.at.0..bar.at.0 + bar.width {
            assert!(
                bars.insert((opens, (column, bar.at.1))),
                "two bars in {column}, {}\n{grid:#?}",
                bar.at.1
            );
        }
    }
    for (_, spot) in &grid.jumps {
        let above = (spot.0, spot.1 - 1);
        assert!(grid.transitions.contains(&above), "a jump without a transition: {spot:?}\n{grid:#?}");
        assert!(!bars.contains(&(true, *spot)) && !bars.contains(&(false, *spot)), "{spot:?}\n{grid:#?}");
    }
}

/// The ends of each transition, as the lines of the drawing give them: this is worked out from the
/// rules of the grid alone, without the reader.
fn ends(grid: &Grid) -> Vec<(BTreeSet<usize>, BTreeSet<usize>)> {
    let step_at: BTreeMap<Spot, usize> = grid.steps.iter().enumerate().map(|(i, s)| (*s, i)).collect();
    let bar_at = |kinds: [Kind; 2], (x, y): Spot| {
        grid.bars
            .iter()
            .find(|b| kinds.contains(&b.kind) && b.at.1 == y && (b.at.0..b.at.0 + b.width).contains(&x))
    };
    let linked =
        |kind: Kind, spot: Spot| grid.links.iter().filter(move |l| l.from == (kind, spot)).map(|l| l.to);
    // All objects of a kind that stand or are linked above a joint.
    let above = |bar: &super::lay::Bar, of: Kind, spots: &[Spot]| -> BTreeSet<usize> {
        let inside = |s: &Spot| s.1 == bar.at.1 && (bar.at.0..bar.at.0 + bar.width).contains(&s.0);
        let by_link = |s: &Spot| linked(of, *s).any(|(k, to)| k == bar.kind && inside(&to));
        let all = spots.iter().enumerate().filter(|(_, s)| inside(s) || by_link(s));
        all.map(|(i, _)| i).collect()
    };
    let branch = |bar: &super::lay::Bar| -> BTreeSet<usize> {
        (bar.at.0..bar.at.0 + bar.width).filter_map(|c| step_at.get(&(c, bar.at.1)).copied()).collect()
    };
    let mut all = Vec::new();
    for spot in &grid.transitions {
        let up = (spot.0, spot.1 - 1);
        let mut from = BTreeSet::new();
        if let Some(bar) = bar_at([Kind::AltBranch, Kind::AltBranch], *spot) {
            from.extend(step_at.get(&(bar.at.0, bar.at.1 - 1)));
        } else if let Some(bar) = grid.bars.iter().find(|b| b.kind == Kind::ParJoint && b.at == up) {
            from.extend(above(bar, Kind::Step, &grid.steps));
        } else {
            from.extend(step_at.get(&up));
        }
        let down = (spot.0, spot.1 + 1);
        let mut to: BTreeSet<usize> = BTreeSet::new();
        to.extend(grid.jumps.iter().filter(|j| j.1 == down).map(|j| j.0));
        for (kind, there) in linked(Kind::Transition, *spot) {
            match kind {
                Kind::Step => to.extend(step_at.get(&there)),
                Kind::ParBranch => to.extend(bar_at([kind, kind], there).into_iter().flat_map(branch)),
                Kind::AltJoint => {
                    let bar = bar_at([kind, kind], there).expect("a joint");
                    to.extend(step_at.get(&(bar.at.0, bar.at.1 + 1)));
                }
                Kind::Transition | Kind::ParJoint | Kind::AltBranch => panic!("a link to {kind:?}"),
            }
        }
        if let Some(bar) = bar_at([Kind::AltJoint, Kind::AltJoint], *spot) {
            to.extend(step_at.get(&(bar.at.0, bar.at.1 + 1)));
        } else if let Some(bar) = grid.bars.iter().find(|b| b.kind == Kind::ParBranch && b.at == down) {
            to.extend(branch(bar));
        } else {
            to.extend(step_at.get(&down));
        }
        all.push((from, to));
    }
    all
}

/// The same as the reader finds it in a file with these cells.
fn read_back(grid: &Grid) -> Vec<(BTreeSet<usize>, BTreeSet<usize>)> {
    let mut report = Report::new(g7_model::FileId(0));
    let step = |(number, spot): (usize, &Spot)| StepNode {
        name: format!("S{number}"),
        sort: StepSort::Plain,
        spot: *spot,
        actions: Vec::new(),
        delay: None,
        comment: String::new(),
        at: 0..0,
    };
    let transition = |spot: &Spot| TransitionNode {
        spot: *spot,
        condition: Condition::None,
        inverted: false,
        comment: String::new(),
        at: 0..0,
    };
    let bar = |bar: &super::lay::Bar| BarNode {
        opens: matches!(bar.kind, Kind::ParBranch | Kind::AltBranch),
        parallel: matches!(bar.kind, Kind::ParBranch | Kind::ParJoint),
        spot: bar.at,
        width: bar.width,
        stem: 0,
        at: 0..0,
    };
    let jump = |(to, spot): &(usize, Spot)| JumpNode { to: format!("S{to}"), spot: *spot, at: 0..0 };
    let end = |(kind, spot): (Kind, Spot)| (kind.word().to_string(), spot);
    let link = |link: &super::lay::Link| LinkNode { from: end(link.from), to: end(link.to), at: 0..0 };
    let sheet = Sheet {
        steps: grid.steps.iter().enumerate().map(step).collect(),
        transitions: grid.transitions.iter().map(transition).collect(),
        bars: grid.bars.iter().map(bar).collect(),
        jumps: grid.jumps.iter().map(jump).collect(),
        links: grid.links.iter().map(link).collect(),
        ..Sheet::default()
    };
    let ends = crate::controlexpert::grid::ends(&sheet, &mut report);
    let problems = report.finish();
    assert!(problems.is_empty(), "{problems:#?}\n{grid:#?}");
    let set = |list: Vec<usize>| list.into_iter().collect::<BTreeSet<usize>>();
    ends.into_iter().map(|e| (set(e.from), set(e.to))).collect()
}

/// Transitions, each with the steps before and behind it.
type Arcs = Vec<(Vec<usize>, Vec<usize>)>;

/// Transitions at random between a few steps.
fn charts() -> impl Strategy<Value = (usize, Arcs)> {
    (2usize..14).prop_flat_map(|steps| {
        let some = || prop_oneof![5 => proptest::collection::btree_set(0..steps, 1), 1 => proptest::collection::btree_set(0..steps, 2..4)];
        let list = |set: BTreeSet<usize>| set.into_iter().collect::<Vec<_>>();
        let transition = (some(), some()).prop_map(move |(a, b)| (list(a), list(b)));
        (Just(steps), proptest::collection::vec(transition, 1..24))
    })
}

/// The chart without the transitions that have no place.
fn drawable(steps: usize, mut transitions: Arcs) -> (Plan, Arcs) {
    loop {
        let list: Vec<(&[usize], &[usize])> = transitions.iter().map(|(a, b)| (&**a, &**b)).collect();
        match plan(steps, &list) {
            Ok(plan) => return (plan, transitions),
            Err(wrong) => match wrong[0] {
                Undrawn::Source(t) | Undrawn::Sink(t) | Undrawn::Joined(t, _) | Undrawn::Parted(t, _) => {
                    transitions.remove(t);
                }
            },
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_chart_has_its_transitions_between_its_steps((steps, transitions) in charts()) {
        let (plan, transitions) = drawable(steps, transitions);
        let grid = grid(&plan);
        sound(&grid);
        let set = |list: &Vec<usize>| list.iter().copied().collect::<BTreeSet<usize>>();
        let wanted: Vec<_> = transitions.iter().map(|(a, b)| (set(a), set(b))).collect();
        prop_assert_eq!(&ends(&grid), &wanted, "{:#?}", grid);
        prop_assert_eq!(read_back(&grid), wanted, "{:#?}", grid);
        // Of the transitions behind a step, the first one stands on the left.
        for step in 0..steps {
            let columns: Vec<i32> = plan.out(step).iter().filter_map(|t| grid.transitions.get(*t)).map(|s| s.0).collect();
            prop_assert!(columns.is_sorted(), "{:#?}", grid);
        }
    }
}
