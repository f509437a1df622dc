//! Code as trees of words, steps and watches: what `lower` makes of typed
//! expressions and statements before it writes them as instructions.
//!
//! ```text
//! ir::Expr, ir::Stmt -> tree::Expr, tree::Stmt -> engine::Op (the engine)
//!                                              -> equations (code, proof)
//! ```
//!
//! Everything that depends on the profile, on macro-steps, tasks or orders is
//! settled here: both readers see the same words, steps and watches.

use g7_engine::{Addr, Arith, Block, Builtin, Cmp, GroupId, Service, StepId, WatchId};
use g7_model::{Holds, Span, Type};

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Its form.
    pub kind: ExprKind,
    /// The place to name in a fault.
    pub at: Span,
}

/// A clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Time since activation of a step (TIME), where step times count nanoseconds.
    Step(StepId),
    /// The same where step times count scans.
    StepAge(StepId),
    /// Scans since activation of a step (LINT).
    StepScans(StepId),
    /// Time since a group of steps became active (TIME), where step times count nanoseconds.
    Group(GroupId),
    /// The same where step times count scans.
    GroupAge(GroupId),
    /// Scans since a group of steps became active (LINT).
    GroupScans(GroupId),
}

/// The operators between two BOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// AND; the right operand is not evaluated where the left one is FALSE.
    And,
    /// OR; the right operand is not evaluated where the left one is TRUE.
    Or,
    /// Exclusive OR.
    Xor,
}

/// The forms of an expression. Texts are values of their own.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// A number, as a word of its type.
    Const(Type, u64),
    /// A text that stands in the variable area, of so many bytes at most.
    Text(Addr, u16),
    /// A word.
    Word(Type, Addr),
    /// An element of a table; a fault outside of it.
    Element {
        /// Type of the elements.
        ty: Type,
        /// First word.
        base: Addr,
        /// Number of elements.
        len: u32,
        /// From 0 (LINT).
        index: Box<Expr>,
    },
    /// Activity of a step.
    Active(StepId),
    /// Activity of a step as the pass began.
    WasActive(StepId),
    /// Some step of the group is active.
    GroupActive(GroupId),
    /// A time or a number of scans.
    Time(Clock),
    /// Time since activation in units of 100 ms, from 0 to 9999 (INT).
    Tenths(StepId),
    /// The watched expression rose in this pass.
    Rise(WatchId),
    /// It fell in this pass.
    Fall(WatchId),
    /// Output of a timer.
    Timer(WatchId),
    /// The period is due in this scan.
    Due(u32),
    /// BOOL complement.
    Not(Box<Expr>),
    /// Between two BOOL.
    Gate(Gate, Box<Expr>, Box<Expr>),
    /// Minus; overflow is a fault.
    Neg(Type, Box<Expr>),
    /// Arithmetic between two numbers of one type; overflow and division by zero are faults.
    Arith(Arith, Type, Box<Expr>, Box<Expr>),
    /// Comparison of two numbers of one type.
    Compare(Cmp, Type, Box<Expr>, Box<Expr>),
    /// Comparison of two texts, by bytes.
    CompareText(Cmp, Box<Expr>, Box<Expr>),
    /// From the first type to the second; out of range is a fault, except where [`transfers`] is
    /// true.
    Convert(Type, Type, Box<Expr>),
    /// Toward zero, from a real type to an integer type; out of range is a fault.
    Trunc(Type, Type, Box<Expr>),
    /// A function of numbers, all of one type; of SEL and MUX, the type of what they choose from;
    /// of a shift, that of its bits.
    Call(Builtin, Type, Vec<Expr>),
    /// A function of texts. LEN and FIND give an INT; the others give a text,
    /// worked out at `to` and cut at `cap` bytes.
    TextCall {
        /// The function.
        function: Builtin,
        /// Its arguments.
        args: Vec<Expr>,
        /// First word of the result.
        to: Addr,
        /// Bytes that the result can hold.
        cap: u16,
    },
    /// A number as text.
    ToText {
        /// Type of the number.
        from: Type,
        /// First word of the result.
        to: Addr,
        /// Bytes that the result can hold.
        cap: u16,
        /// The number.
        value: Box<Expr>,
    },
    /// A text as a number; a text that cannot be read is a fault.
    FromText(Type, Box<Expr>),
    /// Time since the scan before (TIME).
    ScanTime,
    /// A random number from the generator of this word (LREAL).
    Random(Addr),
    /// Statements first, then a value: a function or section written in place.
    After(Vec<Stmt>, Box<Expr>),
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Stmt {
    /// Its form.
    pub kind: StmtKind,
    /// The place to name in a fault.
    pub at: Span,
}

/// Where a number is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A word.
    Word(Addr),
    /// An element of a table, by an index from 0 (LINT); a fault outside of it.
    Element(Addr, u32, Expr),
}

/// The forms of a statement.
#[derive(Clone, Debug, PartialEq)]
pub enum StmtKind {
    /// A number into a word or element of its type. The index of an element is
    /// evaluated before the number.
    Store(Type, Target, Expr),
    /// A text into a variable of so many bytes, cut at a character.
    StoreText(Addr, u16, Expr),
    /// Evaluates an expression for its faults alone.
    Evaluate(Expr),
    /// The statements of the first condition that holds, else the others.
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    /// Repeats until it is left, or until the condition holds behind the statements.
    Loop(Vec<Stmt>, Option<Expr>),
    /// Leaves the innermost loop unless the condition holds.
    LeaveUnless(Expr),
    /// Leaves the innermost loop.
    Leave,
    /// Statements that RETURN leaves.
    Body(Vec<Stmt>),
    /// Leaves the innermost body, or all of the code.
    Return,
    /// Runs a function block on its words.
    Fb(Block, Addr),
    /// A request to the service point.
    Service(Service),
}

/// The effect of one piece of code.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// It gives a value.
    Value(Expr),
    /// It does something.
    Work(Vec<Stmt>),
}

impl Expr {
    /// An expression at a place.
    pub fn new(kind: ExprKind, at: Span) -> Expr {
        Expr { kind, at }
    }

    /// TRUE or FALSE.
    pub fn truth(value: bool, at: Span) -> Expr {
        Expr::new(ExprKind::Const(Type::Bool, u64::from(value)), at)
    }

    /// A LINT.
    pub fn long(value: i64, at: Span) -> Expr {
        Expr::new(ExprKind::Const(Type::Lint, value as u64), at)
    }

    /// Its complement.
    #[must_use]
    pub fn negated(self) -> Expr {
        let at = self.at;
        Expr::new(ExprKind::Not(Box::new(self)), at)
    }

    /// With another BOOL.
    #[must_use]
    pub fn gate(self, gate: Gate, other: Expr, at: Span) -> Expr {
        Expr::new(ExprKind::Gate(gate, Box::new(self), Box::new(other)), at)
    }

    /// Arithmetic with another number of its type.
    #[must_use]
    pub fn arith(self, op: Arith, ty: Type, other: Expr, at: Span) -> Expr {
        Expr::new(ExprKind::Arith(op, ty, Box::new(self), Box::new(other)), at)
    }

    /// Compared with another number of its type.
    #[must_use]
    pub fn compare(self, op: Cmp, ty: Type, other: Expr, at: Span) -> Expr {
        Expr::new(ExprKind::Compare(op, ty, Box::new(self), Box::new(other)), at)
    }

    /// The type of its value.
    pub fn ty(&self) -> Type {
        match &self.kind {
            ExprKind::Const(ty, _)
            | ExprKind::Word(ty, _)
            | ExprKind::Element { ty, .. }
            | ExprKind::Neg(ty, _)
            | ExprKind::Arith(_, ty, _, _)
            | ExprKind::Convert(_, ty, _)
            | ExprKind::Trunc(_, ty, _)
            | ExprKind::Call(_, ty, _)
            | ExprKind::FromText(ty, _) => *ty,
            ExprKind::Time(Clock::StepScans(_) | Clock::GroupScans(_)) => Type::Lint,
            ExprKind::Time(_) | ExprKind::ScanTime => Type::Time,
            ExprKind::Tenths(_) => Type::Int,
            ExprKind::Random(_) => Type::Lreal,
            ExprKind::Active(_)
            | ExprKind::WasActive(_)
            | ExprKind::GroupActive(_)
            | ExprKind::Rise(_)
            | ExprKind::Fall(_)
            | ExprKind::Timer(_)
            | ExprKind::Due(_)
            | ExprKind::Not(_)
            | ExprKind::Gate(..)
            | ExprKind::Compare(..)
            | ExprKind::CompareText(..) => Type::Bool,
            ExprKind::TextCall { function: Builtin::Len | Builtin::Find, .. } => Type::Int,
            ExprKind::Text(_, cap) | ExprKind::TextCall { cap, .. } | ExprKind::ToText { cap, .. } => {
                Type::String(*cap)
            }
            ExprKind::After(_, e) => e.ty(),
        }
    }

    /// Calls `f` with the expressions from which this one is made, from left to right; with none of its statements.
    pub fn operands<'e>(&'e self, f: &mut dyn FnMut(&'e Expr)) {
        match &self.kind {
            ExprKind::Const(..)
            | ExprKind::Text(..)
            | ExprKind::Word(..)
            | ExprKind::Active(_)
            | ExprKind::WasActive(_)
            | ExprKind::GroupActive(_)
            | ExprKind::Time(_)
            | ExprKind::Tenths(_)
            | ExprKind::Rise(_)
            | ExprKind::Fall(_)
            | ExprKind::Timer(_)
            | ExprKind::Due(_)
            | ExprKind::ScanTime
            | ExprKind::Random(_) => {}
            ExprKind::Element { index: e, .. }
            | ExprKind::Not(e)
            | ExprKind::Neg(_, e)
            | ExprKind::Convert(_, _, e)
            | ExprKind::Trunc(_, _, e)
            | ExprKind::ToText { value: e, .. }
            | ExprKind::FromText(_, e)
            | ExprKind::After(_, e) => f(e),
            ExprKind::Gate(_, a, b)
            | ExprKind::Arith(_, _, a, b)
            | ExprKind::Compare(_, _, a, b)
            | ExprKind::CompareText(_, a, b) => {
                f(a);
                f(b);
            }
            ExprKind::Call(_, _, args) | ExprKind::TextCall { args, .. } => args.iter().for_each(f),
        }
    }

    /// Visits this expression and all within it, those in statements too.
    pub fn visit(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        if let ExprKind::After(list, _) = &self.kind {
            visit_all(list, f);
        }
        self.operands(&mut |e| e.visit(f));
    }

    /// Its evaluation can end in a fault or change something, so that it matters
    /// whether it is evaluated at all.
    pub fn has_effect(&self) -> bool {
        let mut found = false;
        self.visit(&mut |e| {
            found |= match &e.kind {
                ExprKind::Element { .. }
                | ExprKind::FromText(..)
                | ExprKind::After(..)
                | ExprKind::Random(_)
                | ExprKind::Call(Builtin::Mux, ..) => true,
                ExprKind::Call(f, _, args) if f.shifts() => {
                    // A written N is not negative: the resolver has seen to it.
                    !matches!(args.last().map(|n| &n.kind), Some(ExprKind::Const(..)))
                }
                ExprKind::Neg(n, _) | ExprKind::Call(Builtin::Abs, n, _) => !n.is_real(),
                ExprKind::Arith(op, n, ..) => !n.is_real() || matches!(op, Arith::Div | Arith::Mod),
                ExprKind::Convert(from, to, _) => narrows(*from, *to),
                ExprKind::Trunc(..) => true,
                ExprKind::TextCall { function, .. } => {
                    !matches!(function, Builtin::Len | Builtin::Find | Builtin::Concat)
                }
                _ => false,
            };
        });
        found
    }
}

/// Visits every expression in statements.
pub fn visit_all(list: &[Stmt], f: &mut dyn FnMut(&Expr)) {
    for s in list {
        match &s.kind {
            StmtKind::Store(_, target, e) => {
                if let Target::Element(_, _, index) = target {
                    index.visit(f);
                }
                e.visit(f);
            }
            StmtKind::StoreText(_, _, e) | StmtKind::Evaluate(e) | StmtKind::LeaveUnless(e) => e.visit(f),
            StmtKind::If(arms, other) => {
                for (condition, then) in arms {
                    condition.visit(f);
                    visit_all(then, f);
                }
                visit_all(other, f);
            }
            StmtKind::Loop(body, until) => {
                visit_all(body, f);
                if let Some(e) = until {
                    e.visit(f);
                }
            }
            StmtKind::Body(body) => visit_all(body, f),
            StmtKind::Leave | StmtKind::Return | StmtKind::Fb(..) | StmtKind::Service(_) => {}
        }
    }
}

/// The bits of a type of whole numbers, and true if it has a sign. BOOL is one bit, TIME counts nanoseconds.
fn shape(ty: Type) -> (u8, bool) {
    let row = ty.elementary().filter(|_| ty.is_integer() || ty.is_bits() || ty == Type::Bool);
    row.map_or((64, true), |row| (row.bits, row.holds == Holds::Signed))
}

/// True if a conversion takes the lowest bits: between bit strings, and between these and whole
/// numbers (IEC 61131-3:2013, 6.6.2.5.2).
pub fn transfers(from: Type, to: Type) -> bool {
    let whole = |ty: Type| ty.is_bits() || ty.is_integer();
    (from.is_bits() || to.is_bits()) && whole(from) && whole(to)
}

/// Some value of the first type has no place in the second.
pub fn narrows(from: Type, to: Type) -> bool {
    if to == Type::Bool || to.is_real() || transfers(from, to) {
        return false; // not zero; rounded; cut
    }
    if from.is_real() {
        return true;
    }
    let ((from, from_signed), (to, to_signed)) = (shape(from), shape(to));
    match (from_signed, to_signed) {
        (true, false) => true,
        (false, true) => to <= from,
        _ => to < from,
    }
}
