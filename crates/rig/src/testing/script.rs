//! Runs as the statements of a test.
//!
//! A test begins with a scan in which all inputs have their initial values, a run with any
//! values: where they differ, they are set and the charts are started anew (`restart cold`).

use g7_engine::StepId;
use g7_host::read_text;
use g7_model::{
    BinaryOp, Expr, ExprKind, Holds, Literal, Name, Nanos, Path, Place, Scenario, TestStmt, TestStmtKind,
    Type, UnaryOp,
};

use crate::{Activity, Bench, Item, Role};

/// Scans from which on a time is written in the place of their number.
const MANY: u32 = 10;

/// The statements of a test that is being made.
pub struct Script<'b> {
    bench: &'b Bench,
    /// The present value of each input word.
    inputs: Vec<u64>,
    body: Vec<TestStmt>,
    begun: bool,
}

impl<'b> Script<'b> {
    /// A test of the charts on a bench, without statements.
    pub fn new(bench: &'b Bench) -> Script<'b> {
        let t = bench.compiled.program.tables();
        let inputs = t.init.get(t.inputs.start as usize..t.inputs.end as usize).unwrap_or(&[]).to_vec();
        Script { bench, inputs, body: Vec::new(), begun: false }
    }

    /// The next scan of the run, with these input words.
    pub fn scan(&mut self, inputs: &[u64]) {
        let puts = self.puts(inputs);
        self.inputs = inputs.to_vec();
        match (std::mem::replace(&mut self.begun, true), puts.is_empty()) {
            (false, true) => {}
            (false, false) => {
                self.add(TestStmtKind::Set(puts));
                self.add(TestStmtKind::Restart { cold: true });
            }
            (true, false) => self.add(TestStmtKind::Set(puts)),
            (true, true) => match self.body.last_mut().map(|s| &mut s.kind) {
                Some(TestStmtKind::Scan(n)) => *n += 1,
                _ => self.add(TestStmtKind::Scan(1)),
            },
        }
    }

    /// Conditions that must be true now.
    pub fn expect(&mut self, conditions: Vec<Expr>) {
        if !conditions.is_empty() {
            self.add(TestStmtKind::Expect(conditions));
        }
    }

    /// Scans until a condition is true.
    pub fn wait_until(&mut self, e: Expr, within: Option<Nanos>) {
        self.add(TestStmtKind::WaitUntil(e, within));
    }

    /// A comment for the reader.
    pub fn comment(&mut self, text: &str) {
        self.add(TestStmtKind::Comment(text.into()));
    }

    fn add(&mut self, kind: TestStmtKind) {
        self.body.push(TestStmt { kind, at: Place::default() });
    }

    /// The test. Many scans in a row are written as the time that they take.
    pub fn end(mut self, title: &str) -> Scenario {
        for s in &mut self.body {
            if let TestStmtKind::Scan(n) = s.kind
                && n >= MANY
                && let Some(time) = self.bench.period.checked_mul(i64::from(n))
            {
                s.kind = TestStmtKind::Wait(time);
            }
        }
        let plant = self.bench.plant.as_ref();
        let plant = plant.map(|p| Name { text: p.name.as_str().into(), at: Place::default() });
        Scenario { title: title.into(), plant, seed: None, body: self.body, at: Place::default() }
    }

    fn is_driven(&self, input: u32) -> bool {
        let plant = self.bench.plant.as_ref();
        plant.is_some_and(|p| p.coupling.to_charts.iter().any(|(_, to)| *to == input))
    }

    /// The values that must be set to bring the inputs to these values; the plant sets those that it drives.
    fn puts(&self, inputs: &[u64]) -> Vec<(Expr, Expr)> {
        let words = |all: &[u64], item: &Item, first: u32| {
            let from = first as usize;
            all.get(from..from + item.words as usize).unwrap_or(&[]).to_vec()
        };
        let items = self.bench.items.iter().filter_map(|i| match i.role {
            Role::Input(first) if !self.is_driven(first) => {
                Some((i, words(inputs, i, first), words(&self.inputs, i, first)))
            }
            _ => None,
        });
        items
            .filter(|(_, new, old)| new != old)
            .map(|(i, new, _)| (path(&i.name), value(i.ty, &new)))
            .collect()
    }
}

/// An expression without a place.
pub fn expr(kind: ExprKind) -> Expr {
    Expr { kind, at: Place::default() }
}

/// A name as the language writes it outside of all charts.
pub fn path(name: &str) -> Expr {
    let names = name.split('.').map(|n| Name { text: n.into(), at: Place::default() }).collect();
    expr(ExprKind::Path(Path { names }))
}

/// The opposite of a condition.
pub fn not(e: Expr) -> Expr {
    match e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => *inner,
        _ => expr(ExprKind::Unary(UnaryOp::Not, Box::new(e))),
    }
}

/// The expressions joined by an operator; `None` without any.
pub fn join(op: BinaryOp, list: impl IntoIterator<Item = Expr>) -> Option<Expr> {
    list.into_iter().reduce(|a, b| expr(ExprKind::Binary(op, Box::new(a), Box::new(b))))
}

/// The activity of a step: `X12`, `G.X12`, `Fill.X`.
pub fn activity(bench: &Bench, step: StepId) -> Option<Expr> {
    let item = bench.steps.iter().find(|s| s.id == Activity::Step(step))?;
    Some(path(&item.activity()))
}

/// A value as a literal.
pub fn value(ty: Type, words: &[u64]) -> Expr {
    let word = words.first().copied().unwrap_or(0);
    let real = |text: String| Literal::Real(text.into(), None);
    expr(ExprKind::Literal(match ty.holds() {
        Some(Holds::Truth) | None => Literal::Bool(word != 0),
        Some(Holds::Signed) => Literal::Int(i128::from(word as i64), None),
        Some(Holds::Unsigned | Holds::Bits) => Literal::Int(i128::from(word), None),
        Some(Holds::Real) if ty == Type::Real => real(format!("{:?}", f32::from_bits(word as u32))),
        Some(Holds::Real) => real(format!("{:?}", f64::from_bits(word))),
        Some(Holds::Moment(moment)) => Literal::Moment(moment, Nanos::new(word as i64)),
        Some(Holds::Time) => Literal::Time(Nanos::new(word as i64)),
        Some(Holds::Text) => Literal::Str(read_text(words, 0).into()),
    }))
}
