//! Gives each object of a chart its cell of the grid.
//!
//! A step and what follows it stand in one column, from top to bottom. The branches behind a step
//! or a transition stand side by side, each in columns of its own, and meet below all of them. A
//! transition whose step is drawn elsewhere has a jump. What cannot touch, because branches differ
//! in length, has a link.

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};

use super::plan::Plan;
use crate::controlexpert::read::Spot;

/// The deepest nesting of branches; those below it are drawn behind the others.
const DEEPEST: usize = 100;
/// The most transitions that are followed to find where branches meet. Beyond it they have jumps.
const MOST_WORK: usize = 4_000_000;

/// An object that a link begins or ends at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Step,
    Transition,
    ParBranch,
    ParJoint,
    AltBranch,
    AltJoint,
}

impl Kind {
    /// The name of its element.
    pub(super) fn word(self) -> &'static str {
        match self {
            Kind::Step => "step",
            Kind::Transition => "transition",
            Kind::ParBranch => "parBranch",
            Kind::ParJoint => "parJoint",
            Kind::AltBranch => "altBranch",
            Kind::AltJoint => "altJoint",
        }
    }
}

/// The beginning or end of branches. Its single line is at its left end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    pub(super) kind: Kind,
    pub(super) at: Spot,
    pub(super) width: i32,
}

/// A drawn line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) from: (Kind, Spot),
    pub(super) to: (Kind, Spot),
}

/// The cells of all objects.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub(super) steps: Vec<Spot>,
    pub(super) transitions: Vec<Spot>,
    pub(super) bars: Vec<Bar>,
    /// The steps that are jumped to.
    pub(super) jumps: Vec<(usize, Spot)>,
    pub(super) links: Vec<Link>,
    /// The first column that is free from top to bottom.
    pub(super) right: i32,
}

/// The grid of a chart.
pub(super) fn grid(plan: &Plan) -> Grid {
    let mut maker = Maker {
        plan,
        steps: vec![None; plan.steps()],
        transitions: vec![None; plan.transitions()],
        sets: vec![None; plan.sets()],
        bottoms: Vec::new(),
        held: vec![0; plan.steps()],
        waiting: BTreeMap::new(),
        waiting_sets: BTreeMap::new(),
        missing: (0..plan.transitions()).map(|t| plan.from(t).len()).collect(),
        ready: Vec::new(),
        left_work: MOST_WORK,
        grid: Grid::default(),
    };
    maker.all();
    let Maker { steps, transitions, mut grid, .. } = maker;
    grid.steps = steps.into_iter().map(Option::unwrap_or_default).collect();
    grid.transitions = transitions.into_iter().map(Option::unwrap_or_default).collect();
    grid
}

/// The next thing to draw, and its place.
#[derive(Clone, Copy, Debug)]
enum Next {
    Step(usize, Spot),
    Transition(usize, Spot),
    /// The steps that begin parallel branches.
    Set(usize, Spot),
}

/// A range of columns; the end is not included.
type Columns = (i32, i32);

struct Maker<'p> {
    plan: &'p Plan,
    steps: Vec<Option<Spot>>,
    transitions: Vec<Option<Spot>>,
    sets: Vec<Option<Spot>>,
    /// The last row of each column that is taken. The cell below a transition that waits, and below
    /// a step with nothing behind it, is taken: what stood there would touch.
    bottoms: Vec<i32>,
    /// For each step: how many branches that meet there are not drawn yet.
    held: Vec<u32>,
    /// Transitions that wait for their step to be drawn.
    waiting: BTreeMap<usize, Vec<usize>>,
    /// The same for each group of steps that begin parallel branches.
    waiting_sets: BTreeMap<usize, Vec<usize>>,
    /// For each transition: how many steps before it are not drawn yet.
    missing: Vec<usize>,
    /// Transitions that join branches, all of whose steps are drawn.
    ready: Vec<usize>,
    left_work: usize,
    grid: Grid,
}

fn below((x, y): Spot) -> Spot {
    (x, y + 1)
}

impl Maker<'_> {
    fn all(&mut self) {
        let mut right = 0;
        for step in self.plan.roots() {
            if self.is_drawn(step) {
                continue;
            }
            let next = match self.plan.set_of(step) {
                Some(set) if self.spot_of_set(set).is_none() => Next::Set(set, (right, 0)),
                _ => Next::Step(step, (right, 0)),
            };
            right = self.run(Some(next), (right, right + 1), 0);
            // All that still waits is drawn now, because nothing that it waits for will come.
            right = self.run(None, (0, right), 0);
        }
        self.grid.right = right;
    }

    fn spot(&self, step: usize) -> Option<Spot> {
        self.steps.get(step).copied().flatten()
    }

    fn is_drawn(&self, step: usize) -> bool {
        self.spot(step).is_some()
    }

    fn spot_of_set(&self, set: usize) -> Option<Spot> {
        self.sets.get(set).copied().flatten()
    }

    fn spot_of_transition(&self, transition: usize) -> Option<Spot> {
        self.transitions.get(transition).copied().flatten()
    }

    /// Takes the cells of a column down to a row.
    fn take(&mut self, (x, y): Spot) {
        let Ok(column) = usize::try_from(x) else { return };
        if self.bottoms.len() <= column {
            self.bottoms.resize(column + 1, -1);
        }
        self.bottoms.get_mut(column).into_iter().for_each(|bottom| *bottom = y.max(*bottom));
    }

    fn bottom(&self, column: i32) -> i32 {
        usize::try_from(column).ok().and_then(|c| self.bottoms.get(c)).copied().unwrap_or(-1)
    }

    /// The last row that is taken in some columns.
    fn lowest(&self, (left, right): Columns) -> i32 {
        (left..right).map(|c| self.bottom(c)).max().unwrap_or(-1)
    }

    /// Draws in some columns: a chain, then what its branches come together in. Returns the first
    /// column that is free.
    fn run(&mut self, mut next: Option<Next>, (left, mut right): Columns, depth: usize) -> i32 {
        let last = next.is_none();
        let mut own = Vec::new();
        loop {
            if last {
                own = self.waiting.keys().copied().collect();
            }
            let Some(now) = next.take().or_else(|| self.together((left, right), &mut own, last)) else {
                break;
            };
            next = match now {
                Next::Step(step, at) => {
                    right = right.max(at.0 + 1);
                    self.put_step(step, at);
                    self.behind(step, at, &mut right, &mut own, depth)
                }
                Next::Transition(transition, at) => {
                    right = right.max(at.0 + 1);
                    self.put_transition(transition, at);
                    self.after(transition, at, depth)
                }
                Next::Set(set, at) => {
                    right = right.max(self.branches(set, at, depth));
                    None
                }
            };
        }
        if !last {
            own.into_iter().for_each(|step| self.release(step));
        }
        right
    }

    fn release(&mut self, step: usize) {
        self.held.get_mut(step).into_iter().for_each(|h| *h = h.saturating_sub(1));
    }

    fn put_step(&mut self, step: usize, at: Spot) {
        self.steps.get_mut(step).into_iter().for_each(|s| *s = Some(at));
        self.take(at);
        for transition in self.waiting.remove(&step).unwrap_or_default() {
            self.jump(step, transition);
        }
        for transition in self.plan.out(step) {
            let Some(missing) = self.missing.get_mut(*transition) else { continue };
            *missing = missing.saturating_sub(1);
            if *missing == 0 && self.plan.from(*transition).len() > 1 {
                self.ready.push(*transition);
            }
        }
    }

    fn put_transition(&mut self, transition: usize, at: Spot) {
        self.transitions.get_mut(transition).into_iter().for_each(|t| *t = Some(at));
        self.take(at);
    }

    /// A jump below a transition.
    fn jump(&mut self, step: usize, transition: usize) {
        let Some(at) = self.spot_of_transition(transition) else { return };
        self.grid.jumps.push((step, below(at)));
        self.take(below(at));
    }

    /// Draws below a step, or says what is drawn there next.
    fn behind(
        &mut self,
        step: usize,
        at: Spot,
        right: &mut i32,
        own: &mut Vec<usize>,
        depth: usize,
    ) -> Option<Next> {
        let plan = self.plan;
        match plan.out(step) {
            [only] if plan.from(*only).len() == 1 => return Some(Next::Transition(*only, below(at))),
            [] | [_] => self.take(below(at)),
            several => *right = self.alternatives(several, below(at), *right, own, depth),
        }
        None
    }

    /// The branches behind a step, side by side.
    fn alternatives(
        &mut self,
        list: &[usize],
        at: Spot,
        right: i32,
        own: &mut Vec<usize>,
        depth: usize,
    ) -> i32 {
        self.hold(list, own);
        let (mut column, mut last) = (at.0, at.0);
        for transition in list {
            last = column;
            let next = Next::Transition(*transition, (column, at.1));
            column = self.run(Some(next), (column, column + 1), depth + 1);
        }
        self.bar(Kind::AltBranch, at, last);
        right.max(column)
    }

    /// The branches behind a transition, side by side.
    fn branches(&mut self, set: usize, at: Spot, depth: usize) -> i32 {
        let plan = self.plan;
        self.sets.get_mut(set).into_iter().for_each(|s| *s = Some(at));
        for transition in self.waiting_sets.remove(&set).unwrap_or_default() {
            self.link_to_set(transition, at);
        }
        let (mut column, mut last) = (at.0, at.0);
        for step in plan.set(set) {
            last = column;
            column = self.run(Some(Next::Step(*step, (column, at.1))), (column, column + 1), depth + 1);
        }
        self.bar(Kind::ParBranch, at, last);
        column
    }

    fn bar(&mut self, kind: Kind, at: Spot, last: i32) {
        self.grid.bars.push(Bar { kind, at, width: last - at.0 + 1 });
        (at.0..=last).for_each(|column| self.take((column, at.1)));
    }

    fn link_to_set(&mut self, transition: usize, at: Spot) {
        let Some(from) = self.spot_of_transition(transition) else { return };
        self.grid.links.push(Link { from: (Kind::Transition, from), to: (Kind::ParBranch, at) });
    }

    /// Draws below a transition, or says what is drawn there next.
    fn after(&mut self, transition: usize, at: Spot, depth: usize) -> Option<Next> {
        if let Some(set) = self.plan.set_behind(transition) {
            match self.spot_of_set(set) {
                None if depth < DEEPEST => return Some(Next::Set(set, below(at))),
                None => self.waiting_sets.entry(set).or_default().push(transition),
                Some(there) => self.link_to_set(transition, there),
            }
            self.take(below(at));
            return None;
        }
        let step = *self.plan.to(transition).first()?;
        if self.is_drawn(step) || self.plan.set_of(step).is_some() {
            self.jump(step, transition);
            return None;
        }
        if depth < DEEPEST && self.held.get(step) == Some(&0) {
            return Some(Next::Step(step, below(at)));
        }
        self.waiting.entry(step).or_default().push(transition);
        self.take(below(at));
        None
    }

    /// The thing in which branches of some columns come together: a joint of parallel branches, then the
    /// steps for which transitions wait (`own`), and at the very end (`last`) all that waits.
    fn together(&mut self, columns: Columns, own: &mut Vec<usize>, last: bool) -> Option<Next> {
        let inside = |maker: &Self, t: &usize| {
            let spots = maker.plan.from(*t).iter().filter_map(|s| maker.spot(*s));
            spots.into_iter().all(|(x, _)| (columns.0..columns.1).contains(&x))
        };
        if let Some(place) = self.ready.iter().position(|t| inside(self, t)) {
            let transition = self.ready.remove(place);
            return Some(self.join(transition, columns.1));
        }
        while let Some(place) = self.next_meeting(own) {
            let step = own.remove(place);
            if !last {
                self.release(step);
            }
            if let Some(waiting) = self.waiting.remove(&step).filter(|w| !w.is_empty()) {
                return Some(self.meet(step, &waiting, columns.1));
            }
        }
        let (set, _) = self.waiting_sets.first_key_value().filter(|_| last)?;
        Some(Next::Set(*set, (columns.0, self.lowest(columns) + 1)))
    }

    /// The step that is drawn first of those where branches meet: one to which all ways are drawn.
    fn next_meeting(&self, own: &[usize]) -> Option<usize> {
        let waits = |step: &usize| self.waiting.contains_key(step);
        let whole = |step: &usize| {
            waits(step) && self.plan.into(*step).iter().all(|t| self.spot_of_transition(*t).is_some())
        };
        own.iter().position(whole).or_else(|| own.iter().position(waits))
    }

    /// The transition that joins parallel branches, below their joint.
    fn join(&mut self, transition: usize, right: i32) -> Next {
        let steps = self.plan.from(transition);
        let spots: Vec<Spot> = steps.iter().filter_map(|s| self.spot(*s)).collect();
        let at = self.joint(Kind::ParJoint, Kind::Step, &spots, right);
        Next::Transition(transition, below(at))
    }

    /// A step below the transitions that wait for it.
    fn meet(&mut self, step: usize, waiting: &[usize], right: i32) -> Next {
        let spots: Vec<Spot> = waiting.iter().filter_map(|t| self.spot_of_transition(*t)).collect();
        let [only] = spots.as_slice() else {
            let at = self.joint(Kind::AltJoint, Kind::Transition, &spots, right);
            return Next::Step(step, below(at));
        };
        if self.lowest((only.0, right)) <= only.1 + 1 {
            return Next::Step(step, below(*only));
        }
        let at = (only.0, self.lowest((only.0, right)) + 1);
        self.grid.links.push(Link { from: (Kind::Transition, *only), to: (Kind::Step, at) });
        Next::Step(step, at)
    }

    /// A bar below some objects: directly below them if they stand in one row, and nothing else
    /// would touch it, otherwise below all that is there, with links.
    fn joint(&mut self, kind: Kind, of: Kind, spots: &[Spot], right: i32) -> Spot {
        let left = spots.iter().map(|s| s.0).min().unwrap_or(0);
        let last = spots.iter().map(|s| s.0).max().unwrap_or(0);
        let row = spots.iter().map(|s| s.1).max().unwrap_or(0);
        let touched: BTreeSet<i32> = spots.iter().map(|s| s.0).collect();
        let fits = |column: i32| match touched.contains(&column) {
            false if column < last => self.bottom(column) < row - 1,
            _ => self.bottom(column) <= row + 1,
        };
        if spots.iter().all(|s| s.1 == row) && (left..right).all(fits) {
            self.bar(kind, (left, row), last);
            return (left, row);
        }
        let at = (left, self.lowest((left, right)) + 2);
        self.bar(kind, at, last);
        let links = spots.iter().map(|s| Link { from: (of, *s), to: (kind, (s.0, at.1)) });
        self.grid.links.extend(links);
        at
    }

    /// Holds the steps where branches meet until all of these are drawn.
    fn hold(&mut self, list: &[usize], own: &mut Vec<usize>) {
        let plan = self.plan;
        // The branch that reaches each step first.
        let mut branch: HashMap<usize, usize> = HashMap::new();
        let mut queue: VecDeque<(usize, usize)> = list.iter().copied().zip(0..).collect();
        while let Some((transition, number)) = queue.pop_front() {
            let Some(left) = self.left_work.checked_sub(1) else { return };
            self.left_work = left;
            for step in plan.to(transition) {
                if self.is_drawn(*step) {
                    continue;
                }
                let first = *branch.entry(*step).or_insert_with(|| {
                    queue.extend(plan.out(*step).iter().map(|t| (*t, number)));
                    number
                });
                if first != number
                    && plan.set_of(*step).is_none()
                    && let Some(held) = self.held.get_mut(*step).filter(|h| **h == 0)
                {
                    *held += 1;
                    own.push(*step);
                }
            }
        }
    }
}
