//! The parts of conditions: what stands between AND, OR, XOR and NOT in the tree of a condition. Each has code of its
//! own beside the program, so that the engine gives its value in any state of the run.

use std::collections::BTreeMap;

use g7_compile::Compiled;
use g7_compile::tree::{Clock, Expr, ExprKind, Gate, Stmt, StmtKind, Target};
use g7_engine::{Addr, Code, Program, State, StepId, WatchId, eval};

use crate::signal::Signal;

/// Codes of parts, by the place of the part in the program's trees.
pub(crate) struct Parts {
    program: Option<Program>,
    codes: BTreeMap<usize, Code>,
}

/// Calls `f` with each part of a condition, from left to right.
pub(crate) fn each<'e>(e: &'e Expr, f: &mut dyn FnMut(&'e Expr)) {
    match &e.kind {
        ExprKind::Not(x) => each(x, f),
        ExprKind::Gate(_, a, b) => {
            each(a, f);
            each(b, f);
        }
        _ => f(e),
    }
}

/// The address of an expression within the trees of a program: it is the same as long as these stand.
fn key(e: &Expr) -> usize {
    std::ptr::from_ref(e).addr()
}

impl Parts {
    pub(crate) fn new(compiled: &Compiled) -> Parts {
        let mut found: Vec<&Expr> = Vec::new();
        for piece in compiled.pieces.iter() {
            if let g7_compile::tree::Piece::Value(e) = piece {
                each(e, &mut |part| found.push(part));
            }
        }
        found.retain(|e| read(e).is_none());
        let made = g7_compile::lower::with_parts(&compiled.program, found.iter().copied());
        // Its code runs on states of the first program.
        let fits = |program: &Program| {
            State::new(program).image().len() == State::new(&compiled.program).image().len()
        };
        match made {
            Some((program, codes)) if fits(&program) => {
                Parts { program: Some(program), codes: found.iter().map(|e| key(e)).zip(codes).collect() }
            }
            _ => Parts { program: None, codes: BTreeMap::new() },
        }
    }

    /// The value of a part in a state; `None` where its evaluation is a fault.
    pub(crate) fn value(&self, p: &Program, part: &Expr, state: &State) -> Option<bool> {
        if let Some(signal) = read(part) {
            return Some(signal.of(p, state) != 0);
        }
        let (program, code) = (self.program.as_ref()?, self.codes.get(&key(part))?);
        let mut state = state.clone();
        eval(program, &mut state, *code).ok().map(|word| word != 0)
    }

    /// The value of a condition in a state.
    pub(crate) fn holds(&self, p: &Program, e: &Expr, state: &State) -> Option<bool> {
        match &e.kind {
            ExprKind::Not(x) => self.holds(p, x, state).map(|v| !v),
            ExprKind::Gate(gate, a, b) => {
                let (a, b) = (self.holds(p, a, state), self.holds(p, b, state));
                match gate {
                    Gate::And if a == Some(false) || b == Some(false) => Some(false),
                    Gate::Or if a == Some(true) || b == Some(true) => Some(true),
                    Gate::And => Some(a? && b?),
                    Gate::Or => Some(a? || b?),
                    Gate::Xor => Some(a? != b?),
                }
            }
            _ => self.value(p, e, state),
        }
    }
}

/// The signal that a part is, if it is no more than one.
pub(crate) fn read(part: &Expr) -> Option<Signal> {
    match part.kind {
        ExprKind::Word(g7_model::Type::Bool, addr) => Some(Signal::Word(addr)),
        ExprKind::Active(step) => Some(Signal::Step(step)),
        ExprKind::GroupActive(group) => Some(Signal::Group(group)),
        ExprKind::Timer(watch) => Some(Signal::Timer(watch)),
        _ => None,
    }
}

/// On what the value of an expression depends.
#[derive(Default)]
pub(crate) struct Operands {
    pub(crate) signals: Vec<Signal>,
    /// The steps whose time it reads, and what else changes with the time alone.
    pub(crate) clocks: Vec<Signal>,
    /// The edges that it reads.
    pub(crate) edges: Vec<WatchId>,
}

/// Longest table whose elements are followed one by one.
const ELEMENTS: u32 = 64;

impl Operands {
    pub(crate) fn of(compiled: &Compiled, e: &Expr) -> Operands {
        let mut found = Operands::default();
        found.add(compiled, e, 0);
        found.signals.sort_unstable();
        found.signals.dedup();
        found
    }

    pub(crate) fn add(&mut self, compiled: &Compiled, e: &Expr, deep: u32) {
        let mut timers = Vec::new();
        e.visit(&mut |x| match &x.kind {
            ExprKind::Word(_, addr) => self.signals.push(Signal::Word(*addr)),
            ExprKind::Text(addr, cap) => {
                let words = 1 + u32::from(*cap).div_ceil(8);
                self.signals.extend((0..words).map(|i| Signal::Word(Addr(addr.0 + i))));
            }
            ExprKind::Element { base, len, .. } => {
                self.signals.extend((0..(*len).min(ELEMENTS)).map(|i| Signal::Word(Addr(base.0 + i))));
            }
            ExprKind::Active(step) | ExprKind::WasActive(step) => self.signals.push(Signal::Step(*step)),
            ExprKind::GroupActive(group) => self.signals.push(Signal::Group(*group)),
            ExprKind::Tenths(step) => self.clock(Signal::Step(*step)),
            ExprKind::Time(clock) => self.clock(match clock {
                Clock::Step(s) | Clock::StepAge(s) | Clock::StepScans(s) => Signal::Step(*s),
                Clock::Group(g) | Clock::GroupAge(g) | Clock::GroupScans(g) => Signal::Group(*g),
            }),
            ExprKind::Rise(watch) | ExprKind::Fall(watch) => self.edges.push(*watch),
            ExprKind::Timer(watch) => {
                self.signals.push(Signal::Timer(*watch));
                timers.push(*watch);
            }
            _ => {}
        });
        if deep < 8 {
            for watch in timers {
                if let Some(e) = watched(compiled, watch) {
                    self.add(compiled, e, deep + 1);
                }
            }
        }
    }

    fn clock(&mut self, of: Signal) {
        self.signals.push(of);
        self.clocks.push(of);
    }
}

/// The expression that a watch looks at.
pub(crate) fn watched(compiled: &Compiled, watch: WatchId) -> Option<&Expr> {
    let row = compiled.program.tables().watches.get(watch.0 as usize)?;
    compiled.condition(row.code)
}

/// A statement that writes a word, with the conditions round it.
pub(crate) struct Writing<'e> {
    pub(crate) at: g7_model::Span,
    /// The expressions of the value and of the conditions.
    pub(crate) reads: Vec<&'e Expr>,
}

/// The statements of a list that write a word.
pub(crate) fn writings<'e>(list: &'e [Stmt], addr: Addr) -> Vec<Writing<'e>> {
    let (mut found, mut round) = (Vec::new(), Vec::new());
    seek(list, addr, &mut round, &mut found);
    found
}

fn seek<'e>(list: &'e [Stmt], addr: Addr, round: &mut Vec<&'e Expr>, found: &mut Vec<Writing<'e>>) {
    let within = |from: Addr, words: u32| from.0 <= addr.0 && addr.0 - from.0 < words;
    for s in list {
        let writes = match &s.kind {
            StmtKind::Store(_, Target::Word(to), e) => within(*to, 1).then(|| vec![e]),
            StmtKind::Store(_, Target::Element(base, len, index), e) => {
                within(*base, *len).then(|| vec![index, e])
            }
            StmtKind::StoreText(to, cap, e) => within(*to, 1 + u32::from(*cap).div_ceil(8)).then(|| vec![e]),
            StmtKind::Fb(block, base) => within(*base, block.words()).then(Vec::new),
            StmtKind::If(arms, other) => {
                let before = round.len();
                for (condition, then) in arms {
                    round.push(condition);
                    seek(then, addr, round, found);
                }
                seek(other, addr, round, found);
                round.truncate(before);
                None
            }
            StmtKind::Loop(body, _) | StmtKind::Body(body) => {
                seek(body, addr, round, found);
                None
            }
            StmtKind::Evaluate(_)
            | StmtKind::LeaveUnless(_)
            | StmtKind::Leave
            | StmtKind::Return
            | StmtKind::Service(_) => None,
        };
        if let Some(mut reads) = writes {
            reads.extend(round.iter().copied());
            found.push(Writing { at: s.at, reads });
        }
        for e in stmt_exprs(s) {
            inner(e, addr, found);
        }
    }
}

/// The expressions of a statement itself.
fn stmt_exprs(s: &Stmt) -> Vec<&Expr> {
    match &s.kind {
        StmtKind::Store(_, _, e)
        | StmtKind::StoreText(_, _, e)
        | StmtKind::Evaluate(e)
        | StmtKind::LeaveUnless(e) => vec![e],
        StmtKind::If(arms, _) => arms.iter().map(|(e, _)| e).collect(),
        StmtKind::Loop(_, until) => until.iter().collect(),
        StmtKind::Body(_) | StmtKind::Leave | StmtKind::Return | StmtKind::Fb(..) | StmtKind::Service(_) => {
            Vec::new()
        }
    }
}

/// The statements in expressions: functions and sections written in place.
pub(crate) fn inner<'e>(e: &'e Expr, addr: Addr, found: &mut Vec<Writing<'e>>) {
    let mut lists: Vec<&'e [Stmt]> = Vec::new();
    placed(e, &mut lists);
    for list in lists {
        found.extend(writings(list, addr));
    }
}

/// The lists of statements that stand at the head of an expression or of its operands.
fn placed<'e>(e: &'e Expr, lists: &mut Vec<&'e [Stmt]>) {
    if let ExprKind::After(list, _) = &e.kind {
        lists.push(list);
    }
    e.operands(&mut |x| placed(x, lists));
}

/// The steps of a group.
pub(crate) fn steps_of(p: &Program, group: g7_engine::GroupId) -> impl Iterator<Item = StepId> {
    let rows = p.tables().groups.get(group.0 as usize).map(|g| g.steps).unwrap_or_default();
    (rows.start..rows.end).map(StepId)
}
