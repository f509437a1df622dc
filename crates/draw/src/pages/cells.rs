//! Gives each symbol its cell: sequences run down a column, branches take further columns to the
//! right, and what does not fit continues at the top of another column.

use std::collections::HashMap;

use g7_model::{Chart, StepKind};

use crate::End;

/// Number of columns of a page.
pub(super) const COLUMNS: u32 = 11;
/// Number of lines of steps of a page.
pub(super) const LINES: u32 = 6;

/// The cell of a step, or of a transition under that line of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Cell {
    /// The page, from 0.
    pub(crate) page: u32,
    /// The line of steps, from 0.
    pub(crate) line: u32,
    /// The column, from 0.
    pub(crate) column: u32,
}

/// The links of a chart as numbers, and the cell of each symbol.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    pub(crate) steps: Vec<Cell>,
    pub(crate) transitions: Vec<Cell>,
    /// The preceding steps of each transition.
    pub(crate) from: Vec<Vec<u32>>,
    /// The succeeding steps of each transition.
    pub(crate) to: Vec<Vec<u32>>,
    /// The transitions that follow each step.
    pub(crate) behind: Vec<Vec<u32>>,
    /// The number of pages.
    pub(crate) pages: u32,
    /// Every symbol once, in the order in which a reader follows the sequences.
    pub(crate) order: Vec<End>,
}

/// A symbol that waits for its place.
enum Open {
    /// A transition; it goes beside the other transitions of its step.
    Branch(u32, Cell),
    /// A step; it goes beside the other succeeding steps of its transition.
    Parallel(u32, Cell),
}

struct Placing {
    cells: Cells,
    step_at: Vec<Option<Cell>>,
    transition_at: Vec<Option<Cell>>,
    /// The first free column of each page.
    free: Vec<u32>,
    open: Vec<Open>,
}

/// Gives every symbol of a chart a cell.
pub(crate) fn cells(chart: &Chart) -> Cells {
    let numbers: HashMap<&str, u32> = chart.steps().map(|s| &*s.name.text).zip(0..).collect();
    let known = |names: &[g7_model::Name]| {
        let mut list: Vec<u32> = Vec::new();
        for n in names.iter().filter_map(|n| numbers.get(&*n.text)) {
            if !list.contains(n) {
                list.push(*n);
            }
        }
        list
    };
    let from: Vec<Vec<u32>> = chart.transitions().map(|t| known(&t.from)).collect();
    let to: Vec<Vec<u32>> = chart.transitions().map(|t| known(&t.to)).collect();
    let count = chart.steps().count();
    let mut behind = vec![Vec::new(); count];
    for (t, from) in (0..).zip(&from) {
        for s in from {
            if let Some(list) = behind.get_mut(*s as usize) {
                list.push(t);
            }
        }
    }
    let (step_at, transition_at) = (vec![None; count], vec![None; from.len()]);
    let cells = Cells { from, to, behind, ..Cells::default() };
    let mut placing = Placing { cells, step_at, transition_at, free: Vec::new(), open: Vec::new() };
    let starts = |s: &g7_model::Step| s.initial || s.linked || s.kind == StepKind::Entry;
    let first = (0..).zip(chart.steps()).filter(|(_, s)| starts(s)).map(|(n, _)| n);
    for s in first.collect::<Vec<u32>>() {
        placing.root(s);
    }
    for t in 0..placing.transition_at.len() as u32 {
        if placing.cells.from.get(t as usize).is_some_and(Vec::is_empty) {
            let top = placing.top(0);
            placing.transition(t, top);
            placing.drain();
        }
    }
    for s in 0..count as u32 {
        placing.root(s);
    }
    placing.finish()
}

impl Placing {
    fn root(&mut self, s: u32) {
        if self.step_at.get(s as usize).is_some_and(Option::is_none) {
            let top = self.top(self.free.len().saturating_sub(1) as u32);
            self.run(s, top);
            self.drain();
        }
    }

    /// Places the waiting branches, the innermost first, so that none crosses another.
    fn drain(&mut self) {
        while let Some(open) = self.open.pop() {
            match open {
                Open::Branch(t, beside) => {
                    if self.transition_at.get(t as usize).is_some_and(Option::is_none) {
                        let at = self.beside(beside.page, beside.line);
                        self.transition(t, at);
                    }
                }
                Open::Parallel(s, above) => {
                    if self.step_at.get(s as usize).is_some_and(Option::is_none) {
                        let at = match above.line + 1 {
                            line if line < LINES => self.beside(above.page, line),
                            _ => self.overleaf(above.page),
                        };
                        self.run(s, at);
                    }
                }
            }
        }
    }

    /// The top of a free column, on this page or on a new one.
    fn top(&mut self, page: u32) -> Cell {
        self.beside(page, 0)
    }

    /// The top of a column on a later page: the columns of this page are kept for its branches.
    fn overleaf(&mut self, page: u32) -> Cell {
        let last = (self.free.len() as u32).saturating_sub(1);
        if last == page {
            self.free.push(0);
        }
        self.beside((self.free.len() as u32).saturating_sub(1), 0)
    }

    /// A free column at a line; if there is none, the top of a column on the last or on a new page.
    fn beside(&mut self, page: u32, line: u32) -> Cell {
        let last = (self.free.len() as u32).saturating_sub(1);
        for (page, line) in [(page, line), (last, 0)] {
            if let Some(column) = self.free.get_mut(page as usize)
                && *column < COLUMNS
            {
                *column += 1;
                return Cell { page, line, column: *column - 1 };
            }
        }
        self.free.push(1);
        Cell { page: self.free.len() as u32 - 1, line: 0, column: 0 }
    }

    /// Places a step and what follows down its column.
    fn run(&mut self, step: u32, at: Cell) {
        let mut next = Some((step, at));
        while let Some((s, at)) = next {
            let Some(place) = self.step_at.get_mut(s as usize) else { return };
            *place = Some(at);
            self.cells.order.push(End::Step(s));
            next = self.behind(s, at).and_then(|(t, at)| self.follow(t, at));
        }
    }

    /// Places a transition and what follows it.
    fn transition(&mut self, t: u32, at: Cell) {
        if let Some(place) = self.transition_at.get_mut(t as usize) {
            *place = Some(at);
            self.cells.order.push(End::Transition(t));
        }
        if let Some((s, at)) = self.follow(t, at) {
            self.run(s, at);
        }
    }

    /// Places the transition that continues the column of a step; the other transitions wait.
    fn behind(&mut self, s: u32, at: Cell) -> Option<(u32, Cell)> {
        let behind = self.cells.behind.get(s as usize).cloned().unwrap_or_default();
        let mut down = None;
        let mut waiting = Vec::new();
        for t in behind {
            if self.transition_at.get(t as usize).is_none_or(Option::is_some) {
                continue;
            }
            let from = self.cells.from.get(t as usize).cloned().unwrap_or_default();
            let placed: Option<Vec<Cell>> =
                from.iter().map(|s| self.step_at.get(*s as usize).copied().flatten()).collect();
            // A transition with several preceding steps is placed when the last of them has its
            // place.
            let Some(placed) = placed else { continue };
            let place = if placed.iter().all(|c| c.page == at.page) { joined(&placed) } else { Some(at) };
            match place {
                Some(cell) if down.is_none() && !self.taken(cell) => {
                    self.transition_at[t as usize] = Some(cell);
                    self.cells.order.push(End::Transition(t));
                    down = Some((t, cell));
                }
                _ => waiting.push(t),
            }
        }
        self.open.extend(waiting.into_iter().rev().map(|t| Open::Branch(t, at)));
        down
    }

    fn taken(&self, cell: Cell) -> bool {
        self.transition_at.contains(&Some(cell))
    }

    /// Places the step that continues the column of a transition; the other steps wait.
    fn follow(&mut self, t: u32, at: Cell) -> Option<(u32, Cell)> {
        let to = self.cells.to.get(t as usize).cloned().unwrap_or_default();
        let mut open = to.into_iter().filter(|s| self.step_at.get(*s as usize).is_some_and(Option::is_none));
        let first = open.next();
        let others: Vec<u32> = open.collect();
        self.open.extend(others.into_iter().rev().map(|s| Open::Parallel(s, at)));
        let first = first?;
        let cell = match at.line + 1 {
            line if line < LINES => Cell { line, ..at },
            _ => self.overleaf(at.page),
        };
        Some((first, cell))
    }

    fn finish(mut self) -> Cells {
        // A transition some of whose preceding steps were never placed goes beside the first of
        // them.
        for t in 0..self.transition_at.len() {
            if self.transition_at[t].is_none() {
                let cell = self.top(self.free.len().saturating_sub(1) as u32);
                self.transition_at[t] = Some(cell);
                self.cells.order.push(End::Transition(t as u32));
            }
        }
        self.cells.pages = self.free.len() as u32;
        let cell = |c: Option<Cell>| c.unwrap_or(Cell { page: 0, line: 0, column: 0 });
        self.cells.steps = self.step_at.into_iter().map(cell).collect();
        self.cells.transitions = self.transition_at.into_iter().map(cell).collect();
        self.cells
    }
}

/// Where the steps of one page meet: under the lowest one, in the column of the leftmost.
fn joined(from: &[Cell]) -> Option<Cell> {
    let line = from.iter().map(|c| c.line).max()?;
    let column = from.iter().map(|c| c.column).min()?;
    Some(Cell { page: from.first()?.page, line, column })
}
