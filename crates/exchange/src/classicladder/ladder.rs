//! Translates rungs into Structured Text that executes in ClassicLadder's order: column by column,
//! each column from top to bottom.
//!
//! The power behind each element is kept as an expression until an element uses it. Its value is
//! stored in a variable `power_n` before a variable that the expression reads is written, and when
//! the expression becomes large.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use g7_model::{BinaryOp, CaseArm, Expr, Said, Span, Stmt, StmtKind, Type, codes, say};

use super::arith::{Arith, Helper};
use super::project::{Cell, Key, Plan, Rung, Section};
use super::tables::table_name;
use super::variables::{self, Vars, either, kind, reads};
use g7_iec::nodes::{self, and, assign, boolean, int, name, not, when};
use g7_iec::report::Report;

/// The most statements made from a project; sub-routines are copied to each call.
const MOST_STATEMENTS: usize = 50_000;
/// The most names in the power behind an element before it is stored.
const LONGEST_POWER: usize = 24;

/// The effect of an element.
pub(super) enum Deed {
    Do(Stmt),
    /// If this is true, the rung ends here and another rung follows.
    Jump(Expr, i64),
}

/// Translates rungs into statements.
pub(super) struct Ladder<'a, 'b> {
    pub(super) plan: &'b Plan,
    pub(super) vars: &'a mut Vars<'b>,
    pub(super) helpers: &'a mut BTreeSet<Helper>,
    pub(super) report: &'a mut Report,
    /// The sub-routines that are being copied.
    pub(super) open: Vec<i64>,
    /// The variables that keep the last value of edge contacts, by place in the file.
    pub(super) edges: BTreeMap<usize, String>,
    pub(super) left: usize,
}

/// A rung that is being translated.
pub(super) struct Board<'c> {
    pub(super) rung: &'c Rung,
    power: Vec<Vec<Option<Expr>>>,
    /// The current column.
    column: usize,
    pub(super) deeds: Vec<Deed>,
}

impl<'c> Board<'c> {
    pub(super) fn cell(&self, x: usize, y: usize) -> Option<&'c Cell> {
        self.rung.rows.get(y)?.get(x)
    }

    /// The power that reaches `(x, y)` from the left, along the vertical line there.
    pub(super) fn left(&self, x: usize, y: usize, at: Span) -> Expr {
        let Some(before) = x.checked_sub(1) else { return boolean(true, at) };
        let joined = |y: usize| self.cell(x, y).is_some_and(|c| c.joined);
        let mut top = y;
        while top > 0 && joined(top) {
            top -= 1;
        }
        let mut bottom = y;
        while joined(bottom + 1) {
            bottom += 1;
        }
        let column = self.power.get(before);
        let sources = (top..=bottom).filter_map(|row| column?.get(row)?.as_ref());
        sources.fold(None, |sum, p| Some(either(sum, p.clone(), at))).unwrap_or_else(|| boolean(false, at))
    }

    pub(super) fn give(&mut self, x: usize, y: usize, value: Expr) {
        if let Some(place) = self.power.get_mut(x).and_then(|column| column.get_mut(y)) {
            *place = Some(value);
        }
    }
}

fn operands(e: &Expr) -> usize {
    match &e.kind {
        g7_model::ExprKind::Unary(_, a) => operands(a),
        g7_model::ExprKind::Binary(_, a, b) => operands(a) + operands(b),
        _ => 1,
    }
}

impl<'b> Ladder<'_, 'b> {
    /// Translates a section into statements.
    pub(super) fn section(&mut self, section: &'b Section) -> Vec<Stmt> {
        if section.first < 0
            || (section.first == section.last && !self.plan.rungs.contains_key(&section.first))
        {
            return Vec::new();
        }
        let order = self.order(section);
        let mut written: Vec<(i64, Vec<Deed>, i64)> = Vec::new();
        for &number in &order {
            let Some(rung) = self.plan.rungs.get(&number) else { continue };
            let deeds = self.rung(rung);
            written.push((number, deeds, if number == section.last { -1 } else { rung.next }));
        }
        let jumps = written.iter().any(|(_, deeds, _)| deeds.iter().any(|d| matches!(d, Deed::Jump(..))));
        if jumps {
            return self.loop_of(section, written);
        }
        let deeds = written.into_iter().flat_map(|(_, deeds, _)| deeds);
        deeds.filter_map(|d| if let Deed::Do(stmt) = d { Some(stmt) } else { None }).collect()
    }

    /// The rungs that a section can reach: first those in sequence, then the targets of jumps.
    fn order(&mut self, section: &Section) -> Vec<i64> {
        let mut order = Vec::new();
        let mut seen = BTreeSet::new();
        let mut waiting = vec![section.first];
        while let Some(start) = waiting.pop() {
            let mut here = start;
            loop {
                if !seen.insert(here) {
                    break;
                }
                let Some(rung) = self.plan.rungs.get(&here) else {
                    let what = say!("there is no rung {here}; the section `{}` ends there", section.name);
                    self.report.say(&codes::BAD_LINK, &section.at, what);
                    break;
                };
                order.push(here);
                let jumps = rung.rows.iter().flatten().filter(|c| c.kind == 54);
                waiting.extend(jumps.map(|c| i64::from(c.var.1)).rev());
                if here == section.last || rung.next < 0 {
                    break;
                }
                if seen.contains(&rung.next) && waiting.is_empty() && start == section.first {
                    let what = say!("the rungs of the section `{}` go round in a circle", section.name);
                    self.report.say(&codes::BAD_LINK, &rung.at, what);
                }
                here = rung.next;
            }
        }
        order
    }

    /// A section with jumps becomes a loop over the number of the rung.
    fn loop_of(&mut self, section: &Section, rungs: Vec<(i64, Vec<Deed>, i64)>) -> Vec<Stmt> {
        let at = self.report.span(&section.at);
        let here = self.vars.own("rung", Type::Dint, at);
        let go = |to: i64| assign(name(&[&here], at), int(to.into(), at), at);
        let known: BTreeSet<i64> = rungs.iter().map(|(n, ..)| *n).collect();
        let arms = rungs
            .into_iter()
            .map(|(number, deeds, next)| {
                let last = go(if known.contains(&next) { next } else { -1 });
                let mut body = vec![last];
                for deed in deeds.into_iter().rev() {
                    match deed {
                        Deed::Do(stmt) => body.insert(0, stmt),
                        Deed::Jump(condition, to) => body = vec![when(condition, vec![go(to)], body, at)],
                    }
                }
                CaseArm { labels: vec![(int(number.into(), at), None)], body }
            })
            .collect();
        let choice = Stmt { kind: StmtKind::Case(name(&[&here], at), arms, Vec::new()), at: at.into() };
        let going = nodes::binary(BinaryOp::Ge, name(&[&here], at), int(0, at), at);
        let around = Stmt { kind: StmtKind::While(going, vec![choice]), at: at.into() };
        vec![go(section.first), around]
    }

    fn rung(&mut self, rung: &'b Rung) -> Vec<Deed> {
        let width = rung.rows.iter().map(Vec::len).max().unwrap_or(0);
        let power = vec![vec![None; rung.rows.len() + 4]; width];
        let mut board = Board { rung, power, column: 0, deeds: Vec::new() };
        for x in 0..width {
            board.column = x;
            for y in 0..rung.rows.len() {
                let Some(cell) = board.cell(x, y) else { continue };
                if self.left == 0 {
                    let what =
                        say!("more statements than are read; sub-routines are written out at each call");
                    self.report.element(&codes::TOO_LARGE, "rung", &cell.at, what);
                    return board.deeds;
                }
                self.element(&mut board, cell, x, y);
            }
        }
        board.deeds
    }

    /// Appends a statement.
    pub(super) fn put(&mut self, board: &mut Board, stmt: Stmt) {
        self.left = self.left.saturating_sub(1);
        board.deeds.push(Deed::Do(stmt));
    }

    /// Appends a statement that writes these names. Power that reads one of them is stored first.
    pub(super) fn write(&mut self, board: &mut Board, names: &[String], stmt: Stmt) {
        self.keep(board, |used| names.iter().any(|n| used.contains(n)));
        self.put(board, stmt);
    }

    fn keep(&mut self, board: &mut Board, touched: impl Fn(&BTreeSet<String>) -> bool) {
        // Nothing reads the power further to the left any more.
        for x in board.column.saturating_sub(4)..board.power.len() {
            for y in 0..board.power.first().map_or(0, Vec::len) {
                let power = board.power.get(x).and_then(|c| c.get(y)).cloned().flatten();
                let Some(power) = power else { continue };
                let mut used = BTreeSet::new();
                reads(&power, &mut used);
                if touched(&used) {
                    let stored = self.store(board, power);
                    board.give(x, y, stored);
                }
            }
        }
    }

    /// Stores a value in a new variable.
    fn store(&mut self, board: &mut Board, value: Expr) -> Expr {
        let at = value.at.0;
        let variable = self.vars.own("power", Type::Bool, at);
        self.put(board, assign(name(&[&variable], at), value, at));
        name(&[&variable], at)
    }

    /// Passes power on; a large expression is stored.
    pub(super) fn pass(&mut self, board: &mut Board, x: usize, y: usize, value: Expr) {
        let value = if operands(&value) > LONGEST_POWER { self.store(board, value) } else { value };
        board.give(x, y, value);
    }

    fn element(&mut self, board: &mut Board, cell: &Cell, x: usize, y: usize) {
        let at = self.report.span(&cell.at);
        if cell.index.is_some() && !matches!(cell.kind, 0..=2 | 9 | 50..=53 | 99) {
            let what = say!(
                "an element of this kind on a variable by index, from {} on",
                Said::foreign(variables::title(cell.var))
            );
            self.report.say(&codes::NOT_CARRIED, &cell.at, what);
            return;
        }
        match cell.kind {
            0 | 99 => {}
            1..=4 => {
                let left = board.left(x, y, at);
                let contact = self.contact(board, cell, at);
                self.pass(board, x, y, and(left, contact, at));
            }
            9 => {
                let left = board.left(x, y, at);
                self.pass(board, x, y, left);
            }
            10..=14 => self.block(board, cell, x, y),
            20 => {
                let left = if x < 2 { boolean(x == 2, at) } else { board.left(x - 2, y, at) };
                let Some((text, place)) = self.expression(cell) else { return };
                let read = Arith::new(&text, &place, self.vars, self.helpers, self.report).compare();
                let holds = read.unwrap_or_else(|| nodes::bad(at));
                self.pass(board, x, y, and(left, holds, at));
            }
            50..=53 => self.coil(board, cell, x, y),
            54 => {
                let left = board.left(x, y, at);
                if nodes::truth(&left) != Some(false) {
                    self.left = self.left.saturating_sub(1);
                    board.deeds.push(Deed::Jump(left, i64::from(cell.var.1)));
                }
            }
            55 => self.call(board, cell, x, y),
            60 => self.operate(board, cell, x, y),
            kind => {
                let what = say!("an element of kind {kind} of a rung is not known");
                self.report.say(&codes::NOT_CARRIED, &cell.at, what);
            }
        }
    }

    /// The state of a contact. An edge contact keeps the value of the previous run.
    fn contact(&mut self, board: &mut Board, cell: &Cell, at: Span) -> Expr {
        let value = match cell.index {
            Some(index) => self.vars.indexed(cell.var, index, &cell.at, self.report),
            None => self.vars.boolean(cell.var, &cell.at, self.report),
        };
        match cell.kind {
            1 => value,
            2 => not(value, at),
            kind => {
                let old = match self.edges.get(&cell.at.start) {
                    Some(old) => old.clone(),
                    None => self.vars.own("before", Type::Bool, at),
                };
                self.edges.insert(cell.at.start, old.clone());
                let edge = self.vars.own("edge", Type::Bool, at);
                let changed = variables::changed(value.clone(), &old, kind == 3, at);
                self.put(board, assign(name(&[&edge], at), changed, at));
                self.put(board, assign(name(&[&old], at), value, at));
                name(&[&edge], at)
            }
        }
    }

    /// The text of a compare or operate box.
    fn expression(&mut self, cell: &Cell) -> Option<(String, Range<usize>)> {
        let found = self.plan.expressions.get(&cell.var.1).filter(|(text, _)| !text.starts_with('#'));
        if found.is_none() {
            let what = say!("the box has no expression: there is none of number {}", cell.var.1);
            self.report.say(&codes::LEFT_OUT, &cell.at, what);
        }
        found.cloned()
    }

    fn coil(&mut self, board: &mut Board, cell: &Cell, x: usize, y: usize) {
        let at = self.report.span(&cell.at);
        let left = board.left(x, y, at);
        let number = |e: Expr| {
            if cell.var.0 < kind::FIRST_WORD { e } else { nodes::call("BOOL_TO_DINT", vec![e], at) }
        };
        let value = number(match cell.kind {
            50 => left.clone(),
            51 => not(left.clone(), at),
            kind => boolean(kind == 52, at),
        });
        let written = match cell.index {
            Some(index) => self.vars.indexed_target(cell.var, index, &value, &cell.at, self.report),
            None => self.vars.target(cell.var, &cell.at, self.report).map(|target| {
                let mut names = written(&target);
                names.extend(table_name(cell.var.0));
                (assign(target, value, at), names)
            }),
        };
        let Some((stmt, names)) = written else { return };
        let stmt = if cell.kind >= 52 { when(left, vec![stmt], Vec::new(), at) } else { stmt };
        self.write(board, &names, stmt);
    }

    fn operate(&mut self, board: &mut Board, cell: &Cell, x: usize, y: usize) {
        let at = self.report.span(&cell.at);
        let left = if x < 2 { boolean(false, at) } else { board.left(x - 2, y, at) };
        let Some((text, place)) = self.expression(cell) else { return };
        let read = Arith::new(&text, &place, self.vars, self.helpers, self.report).operate();
        let Some((stmt, names)) = read else { return };
        match nodes::truth(&left) {
            Some(false) => {}
            Some(true) => self.write(board, &names, stmt),
            None => self.write(board, &names, when(left, vec![stmt], Vec::new(), at)),
        }
    }

    /// Copies a sub-routine to the place of its call.
    fn call(&mut self, board: &mut Board, cell: &Cell, x: usize, y: usize) {
        let at = self.report.span(&cell.at);
        let left = board.left(x, y, at);
        let number = i64::from(cell.var.1);
        let found = self.plan.sections.iter().find(|s| s.routine == Some(number) && !s.sequential);
        let Some(section) = found else {
            let what = say!("there is no sub-routine {number}; the call does nothing");
            self.report.say(&codes::LEFT_OUT, &cell.at, what);
            return;
        };
        if self.open.contains(&number) {
            let what = say!("the sub-routine {number} calls itself");
            self.report.say(&codes::NOT_CARRIED, &cell.at, what);
            return;
        }
        self.open.push(number);
        let body = self.section(section);
        self.open.pop();
        // A sub-routine may write any variable.
        self.keep(board, |used| used.iter().any(|n| !n.starts_with("power_")));
        self.put(board, when(left, body, Vec::new(), at));
    }
}

/// The names that an assignment writes.
fn written(target: &Expr) -> Vec<String> {
    let mut names = BTreeSet::new();
    reads(target, &mut names);
    names.into_iter().collect()
}

impl<'a, 'b> Ladder<'a, 'b> {
    pub(super) fn new(
        plan: &'b Plan,
        vars: &'a mut Vars<'b>,
        helpers: &'a mut BTreeSet<Helper>,
        report: &'a mut Report,
    ) -> Self {
        let edges = BTreeMap::new();
        Ladder { plan, vars, helpers, report, open: Vec::new(), edges, left: MOST_STATEMENTS }
    }

    /// The variable of a transition.
    pub(super) fn condition(&mut self, key: Key, at: &Range<usize>) -> Expr {
        self.vars.boolean(key, at, self.report)
    }
}
