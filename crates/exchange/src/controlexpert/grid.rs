//! Finds out which objects touch.
//!
//! A chart is drawn on a grid with one object per cell. A line leads from an object to the object
//! in the cell below. The bar that begins branches is in the row of the objects below it and spans
//! the columns of the branches; the bar that ends them is in the row of the objects above it. The
//! single line of a bar is in the column of its stem.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use g7_model::{codes, say};

use super::read::{BarNode, Sheet, Spot};
use crate::flow::{Ends, Flow, Node};
use g7_iec::report::Report;

/// The most cells inspected for one chart.
const MOST_CELLS: usize = 1_000_000;

/// An object in a column.
#[derive(Clone, Copy, Debug)]
struct Item {
    node: Node,
    row: i32,
    /// True if it can be entered from above, false if it can be left below, in this column.
    above: bool,
    below: bool,
}

/// The objects of each column from top to bottom, with row and level.
type Columns = BTreeMap<i32, Vec<((i32, i32), Item)>>;

/// The ends of each transition of a chart.
pub(super) fn ends(sheet: &Sheet, report: &mut Report) -> Vec<Ends> {
    let mut flow = Flow::default();
    let spots = Spots::of(sheet);
    let columns = columns(sheet, &spots, report);
    for column in columns.values() {
        for pair in column.windows(2) {
            let [(_, above), (_, below)] = pair else { continue };
            if above.below && below.above && below.row - above.row <= 1 {
                flow.line(above.node, below.node, &place(sheet, below.node), report);
            }
        }
    }
    jumps(sheet, &spots, &columns, &mut flow, report);
    for link in &sheet.links {
        let from = spots.object(&link.from.0, link.from.1);
        let to = spots.object(&link.to.0, link.to.1);
        match (from, to) {
            (Some(from), Some(to)) => flow.line(from, to, &link.at, report),
            _ => {
                report.say(&codes::OPEN_LINK, &link.at, say!("a link from or to a cell where nothing stands"))
            }
        }
    }
    let places: Vec<Range<usize>> = sheet.transitions.iter().map(|t| t.at.clone()).collect();
    flow.ends(&places, report)
}

/// The objects of each column, from top to bottom.
fn columns(sheet: &Sheet, spots: &Spots, report: &mut Report) -> Columns {
    let mut columns = Columns::new();
    let mut left = MOST_CELLS;
    let mut put = |column: i32, level: i32, item: Item| {
        columns.entry(column).or_default().push(((item.row, level), item));
    };
    let whole = |node: Node, row: i32| Item { node, row, above: true, below: true };
    for (index, step) in sheet.steps.iter().enumerate() {
        put(step.spot.0, 1, whole(Node::Step(index), step.spot.1));
    }
    for (index, transition) in sheet.transitions.iter().enumerate() {
        put(transition.spot.0, 1, whole(Node::Transition(index), transition.spot.1));
    }
    for (index, bar) in sheet.bars.iter().enumerate() {
        let stem = bar.spot.0.saturating_add(bar.stem);
        let level = level(spots, bar);
        for column in bar.spot.0..bar.spot.0.saturating_add(bar.width) {
            let Some(rest) = left.checked_sub(1) else {
                report.element(
                    &codes::TOO_LARGE,
                    "branch",
                    &bar.at,
                    say!("the branches of the chart are too wide"),
                );
                break;
            };
            left = rest;
            let here = column == stem;
            let item = Item {
                node: Node::Bar(index),
                row: bar.spot.1,
                above: !bar.opens || here,
                below: bar.opens || here,
            };
            put(column, level, item);
        }
    }
    for column in columns.values_mut() {
        column.sort_by_key(|(key, _)| *key);
    }
    columns
}

/// The level of a bar: above the objects of its row (0) or below them (2). The object on its single
/// line (a transition for parallel branches, a step for alternative ones) may be in the same row.
fn level(spots: &Spots, bar: &BarNode) -> i32 {
    let stem = (bar.spot.0.saturating_add(bar.stem), bar.spot.1);
    let own =
        if bar.parallel { spots.transitions.contains_key(&stem) } else { spots.steps.contains_key(&stem) };
    if bar.opens == own { 2 } else { 0 }
}

/// A jump leads from the object above it to its step.
fn jumps(sheet: &Sheet, spots: &Spots, columns: &Columns, flow: &mut Flow, report: &mut Report) {
    for jump in &sheet.jumps {
        let to = spots.names.get(&jump.to.to_uppercase()).copied();
        let column = columns.get(&jump.spot.0);
        let above = column.and_then(|c| {
            let before = c.partition_point(|(key, _)| *key < (jump.spot.1, 1));
            c.get(before.checked_sub(1)?)
        });
        let from = above.filter(|(_, item)| item.below && jump.spot.1 - item.row <= 1);
        match (from, to) {
            (Some((_, item)), Some(step)) => flow.line(item.node, Node::Step(step), &jump.at, report),
            (None, Some(_)) => report.say(&codes::OPEN_LINK, &jump.at, say!("a jump with nothing above it")),
            (_, None) => {
                let what = say!("a jump to `{}`, a step that is not there", g7_iec::nodes::line(&jump.to));
                report.say(&codes::BAD_LINK, &jump.at, what);
            }
        }
    }
}

/// The objects by cell (the first one if several share a cell), and steps by name in upper case.
struct Spots {
    steps: HashMap<Spot, usize>,
    transitions: HashMap<Spot, usize>,
    bars: HashMap<(Spot, &'static str), usize>,
    names: HashMap<String, usize>,
}

impl Spots {
    fn of(sheet: &Sheet) -> Spots {
        // From the last to the first, so that the first one stays.
        let steps = || sheet.steps.iter().enumerate().rev();
        Spots {
            steps: steps().map(|(i, s)| (s.spot, i)).collect(),
            transitions: sheet.transitions.iter().enumerate().rev().map(|(i, t)| (t.spot, i)).collect(),
            bars: bars(sheet),
            names: steps().map(|(i, s)| (s.name.to_uppercase(), i)).collect(),
        }
    }

    /// The object of a kind in a cell.
    fn object(&self, kind: &str, spot: Spot) -> Option<Node> {
        match kind {
            "step" | "initialStep" | "macroStep" | "inStep" | "outStep" => {
                self.steps.get(&spot).copied().map(Node::Step)
            }
            "transition" => self.transitions.get(&spot).copied().map(Node::Transition),
            _ => {
                let kind = BARS.iter().find(|word| **word == kind)?;
                self.bars.get(&(spot, *kind)).copied().map(Node::Bar)
            }
        }
    }
}

/// The kinds of bars.
const BARS: [&str; 4] = ["altBranch", "altJoint", "parBranch", "parJoint"];

fn kind_of(bar: &BarNode) -> &'static str {
    match (bar.parallel, bar.opens) {
        (false, true) => "altBranch",
        (false, false) => "altJoint",
        (true, true) => "parBranch",
        (true, false) => "parJoint",
    }
}

/// The bars of each kind by each cell that they span; a link may end at any column. The first cell of
/// a bar goes before the others of another one.
fn bars(sheet: &Sheet) -> HashMap<(Spot, &'static str), usize> {
    let numbered = || sheet.bars.iter().enumerate().rev();
    let mut left = MOST_CELLS;
    let mut cells = HashMap::new();
    for (index, bar) in numbered() {
        let width = usize::try_from(bar.width).unwrap_or(1).min(left);
        left -= width;
        let columns = (bar.spot.0..).take(width);
        cells.extend(columns.map(|column| (((column, bar.spot.1), kind_of(bar)), index)));
    }
    cells.extend(numbered().map(|(index, bar)| ((bar.spot, kind_of(bar)), index)));
    cells
}

fn place(sheet: &Sheet, node: Node) -> Range<usize> {
    let found = match node {
        Node::Step(i) => sheet.steps.get(i).map(|s| s.at.clone()),
        Node::Transition(i) => sheet.transitions.get(i).map(|t| t.at.clone()),
        Node::Bar(i) => sheet.bars.get(i).map(|b| b.at.clone()),
    };
    found.unwrap_or_default()
}
