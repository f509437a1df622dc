//! The form of the equations: memories, expressions, statements, sections.
//!
//! # Invariants
//!
//! - An expression is total and changes nothing: it has a value in every state.
//!   Where an operation of the chart could have none, a statement before it asks
//!   [`Expr::Fails`] and ends the scan with a [`Stmt::Fault`].
//! - No memory holds an absolute time: clocks hold the time since something
//!   happened, and each scan adds [`What::Dt`] to those that run. [`What::Clock`] and
//!   [`What::Stamp`] are the exception; only [`crate::StepTimes::Stamps`] makes them.

use g7_engine::{Addr, Arith, Block, Builtin, Cmp, FaultKind, GroupId, StepId, WatchId};
use g7_model::{Span, Type};

/// A row of [`crate::Equations::memories`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MemoryId(pub u32);

/// How long a memory lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Set from outside before each scan.
    Input,
    /// Read from outside behind each scan; it keeps its value.
    Output,
    /// It keeps its value from scan to scan.
    Kept,
    /// It is set before it is read in each scan: no part of the state.
    Scratch,
    /// It never changes.
    Constant,
}

/// Parts of a control block (IEC 61131-3:2003, 2.6.4.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// An input at the evaluation before: place in [`g7_engine::INPUTS`].
    Before(u8),
    /// `S_FF`.
    Stored,
    /// `SD_FF`.
    StoredDelayed,
    /// `DS_FF`.
    DelayedStored,
    /// `SL_FF`.
    StoredLimited,
    /// The time that a timed input has: place in [`g7_engine::INPUTS`].
    Time(u8),
    /// The time for which the timer of an input has run.
    Clock(u8),
    /// Q without pulses, at the evaluation before.
    Level,
    /// Q as it was written last.
    Written,
    /// A pulse that was seen before the evolution: place in [`g7_engine::INPUTS`].
    Early(u8),
    /// Q in this scan.
    Q,
}

/// The meaning of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum What {
    /// A variable of the chart, or what the compiler keeps beside them, by its
    /// first word.
    Variable(Addr),
    /// The time for which a timer block has run, by the block's first word.
    BlockClock(Addr),
    /// Time since the scan before; set from outside.
    Dt,
    /// The first scan has begun.
    Started,
    /// This is the first pass of a scan.
    Opening,
    /// The pass changed a step or a variable.
    Changed,
    /// A step changed before the evolution.
    Stepped,
    /// Loops gone round in this scan.
    Work,
    /// Activity of a step.
    Step(StepId),
    /// Its activity behind the change in hand.
    Next(StepId),
    /// Its activity as the pass began.
    Was(StepId),
    /// It is to be activated.
    On(StepId),
    /// It is to be deactivated.
    Off(StepId),
    /// It was left in this pass, an enclosing step that clears in turn.
    Left(StepId),
    /// It was entered in this pass, an enclosing step that clears in turn.
    Came(StepId),
    /// Time since its latest activation.
    StepTime(StepId),
    /// Scans since its latest activation.
    StepScans(StepId),
    /// Time since the start; under the scan clock, the number of scans.
    Clock,
    /// While a step is active, [`What::Clock`] when its time was 0; else its time.
    Stamp(StepId),
    /// Some step of a group was active before the change in hand.
    GroupWas(GroupId),
    /// Time since a group became active.
    GroupTime(GroupId),
    /// Scans since a group became active.
    GroupScans(GroupId),
    /// A watched expression.
    Watched(WatchId),
    /// Its value as the pass before began.
    WatchedBefore(WatchId),
    /// It rose in this pass.
    Rise(WatchId),
    /// It fell in this pass.
    Fall(WatchId),
    /// The output of a timer.
    Timer(WatchId),
    /// Time since the condition of a timer changed.
    TimerClock(WatchId),
    /// Time until a period is due.
    Until(u32),
    /// A period is due in this scan.
    Due(u32),
    /// The receptivity of a transition (rank), where it has a memory of its own.
    Receptivity(u32),
    /// A transition is clearable.
    Clearable(u32),
    /// A transition clears.
    Clears(u32),
    /// A transition of this step has been found clearable.
    Settled(StepId),
    /// A transition that clears has taken this step.
    Taken(StepId),
    /// The transitions of a chart do not clear in this pass.
    Blocked(u32),
    /// A forcing order is given.
    Asks(u32),
    /// A forcing order is the first of those on its chart.
    Imposes(u32),
    /// Two forcing orders disagree.
    Disagree(u32),
    /// An action (rank) runs in this pass.
    Runs(u32),
    /// An action (rank) runs at the end of the scan.
    Late(u32),
    /// An action (rank) has run in this scan, of [`crate::Options::runs`].
    Ran(u32),
    /// An action of each scan had its step active before the evolution.
    Periodic(u32),
    /// The copy of a memory that one of the actions of a pass works on.
    Own(MemoryId),
    /// That action has written it.
    OwnWrote(MemoryId),
    /// The value that the actions of a pass give a memory.
    Given(MemoryId),
    /// An action of the pass has written it.
    Wrote(MemoryId),
    /// Two actions of one pass have given a memory different values in this scan.
    Conflict(MemoryId),
    /// A memory as the pass began.
    Begun(MemoryId),
    /// The condition of an action's qualifier holds: row of the contributions.
    Condition(u32),
    /// Part of a control block.
    Control(u32, Part),
    /// All charts are to take the situation of the start.
    RequestStart,
    /// A group is to take its initial situation.
    RequestInit(GroupId),
    /// A group is to be cleared.
    RequestClear(GroupId),
    /// A step is to be set.
    RequestSet(StepId),
    /// A step is to be reset.
    RequestReset(StepId),
    /// A transition was enabled before the evolution.
    Enabled(u32),
    /// Number of steps active, then also activated and deactivated, in this scan.
    StepCount,
    /// Number of transitions enabled, then also enabled anew and no more.
    TransitionCount,
    /// Some step of a group is active; of [`crate::Bodies`] alone.
    GroupActive(GroupId),
    /// Set where all step times are to become 0; of [`crate::Bodies`] alone.
    ResetTimes,
    /// RETURN has been reached.
    Returned(u32),
    /// A value that is needed further on.
    Temporary(u32),
}

/// A memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    /// Its meaning.
    pub what: What,
    /// How long it lasts.
    pub class: Class,
    /// Its type; of a table, that of its elements.
    pub ty: Type,
    /// Number of elements; 1 but for tables.
    pub elements: u32,
    /// The words it starts with: one an element; of a text, those of the engine.
    pub init: Box<[u64]>,
    /// It keeps its value over a restart.
    pub retain: bool,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expr {
    /// A number, as the engine's word for it.
    Const(Type, u64),
    /// A text.
    Text(Box<str>),
    /// A memory.
    Read(MemoryId),
    /// An element of a table, by an index that lies within it (LINT).
    Element(MemoryId, Box<Expr>),
    /// BOOL complement.
    Not(Box<Expr>),
    /// All hold.
    And(Vec<Expr>),
    /// One holds.
    Or(Vec<Expr>),
    /// Exclusive or of two BOOL.
    Xor(Box<Expr>, Box<Expr>),
    /// Minus, in the type; 0 where it has no place.
    Neg(Type, Box<Expr>),
    /// Arithmetic, in the type; 64 bits wrap. What else has no value gives 0.
    Arith(Arith, Type, Box<Expr>, Box<Expr>),
    /// Comparison of two values of the type.
    Compare(Cmp, Type, Box<Expr>, Box<Expr>),
    /// Two values of the type have different words: as `<>`, except that NaN
    /// does not differ from itself, and 0.0 differs from -0.0.
    Differs(Type, Box<Expr>, Box<Expr>),
    /// From the first type to the second; numbers to texts and back as well.
    /// 0 where it has no place there.
    Convert(Type, Type, Box<Expr>),
    /// Toward zero, from a real type to an integer type.
    Trunc(Type, Type, Box<Expr>),
    /// A standard function; the type is that of its value.
    Call(Builtin, Type, Vec<Expr>),
    /// A random number from a generator's word (LREAL).
    Random(Box<Expr>),
    /// The outermost operation of an expression has no value: overflow, division
    /// by zero, out of range.
    Fails(Box<Expr>),
}

/// The subject of a statement, for comments and messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum About {
    /// Nothing of the text.
    #[default]
    Nothing,
    /// A step.
    Step(StepId),
    /// A transition (rank).
    Transition(u32),
    /// An action (rank).
    Action(u32),
    /// A control block.
    Block(u32),
    /// A watched expression.
    Watch(WatchId),
    /// A forcing order.
    Order(u32),
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Stmt {
    /// A value into a memory of its type; a text is cut at a character.
    Set(MemoryId, Expr),
    /// A value into an element of a table, by an index that lies within it (LINT).
    SetElement(MemoryId, Expr, Expr),
    /// The first list where the condition holds, else the second.
    If(Expr, Vec<Stmt>, Vec<Stmt>),
    /// Repeats until [`Stmt::Exit`].
    Loop(Vec<Stmt>),
    /// Leaves the innermost loop.
    Exit,
    /// Ends the scan: outputs to their safe values, no further scan.
    Fault(FaultKind, Span),
    /// Runs a function block on its memories, in the order of the engine's words;
    /// of a timer, its clock stands in place of the start.
    Call(Block, Vec<MemoryId>),
    /// The statements that follow are about this.
    About(About),
}

/// Statements with a heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Their common purpose.
    pub title: &'static str,
    /// The statements.
    pub body: Vec<Stmt>,
}

/// Operands up to which a list is looked through for one that it has already.
const SHORT: usize = 16;

impl Expr {
    /// TRUE or FALSE.
    pub fn truth(value: bool) -> Expr {
        Expr::Const(Type::Bool, u64::from(value))
    }

    /// A LINT.
    pub fn long(value: i64) -> Expr {
        Expr::Const(Type::Lint, value as u64)
    }

    /// A TIME in nanoseconds.
    pub fn time(nanos: i64) -> Expr {
        Expr::Const(Type::Time, nanos as u64)
    }

    /// Its truth, where it is a constant.
    pub fn known(&self) -> Option<bool> {
        match self {
            Expr::Const(Type::Bool, v) => Some(*v != 0),
            _ => None,
        }
    }

    /// Its complement.
    #[must_use]
    pub fn negated(self) -> Expr {
        match self {
            Expr::Const(Type::Bool, v) => Expr::truth(v == 0),
            Expr::Not(e) => *e,
            other => Expr::Not(Box::new(other)),
        }
    }

    /// With another condition.
    #[must_use]
    pub fn and(self, other: Expr) -> Expr {
        Expr::all([self, other])
    }

    /// Or another condition.
    #[must_use]
    pub fn or(self, other: Expr) -> Expr {
        Expr::any([self, other])
    }

    /// All hold; short where something is known.
    pub fn all(parts: impl IntoIterator<Item = Expr>) -> Expr {
        Expr::list(parts, true)
    }

    /// One holds; short where something is known.
    pub fn any(parts: impl IntoIterator<Item = Expr>) -> Expr {
        Expr::list(parts, false)
    }

    fn list(parts: impl IntoIterator<Item = Expr>, and: bool) -> Expr {
        let mut list: Vec<Expr> = Vec::new();
        let mut add = |e: Expr| {
            if list.len() > SHORT || !list.contains(&e) {
                list.push(e);
            }
        };
        for part in parts {
            match part {
                Expr::Const(Type::Bool, v) if (v != 0) == and => {}
                Expr::Const(Type::Bool, _) => return part,
                Expr::And(inner) if and => inner.into_iter().for_each(&mut add),
                Expr::Or(inner) if !and => inner.into_iter().for_each(&mut add),
                other => add(other),
            }
        }
        match list.len() {
            0 => Expr::truth(and),
            1 => list.remove(0),
            _ if and => Expr::And(list),
            _ => Expr::Or(list),
        }
    }

    /// Exclusive or.
    #[must_use]
    pub fn xor(self, other: Expr) -> Expr {
        match (self.known(), other.known()) {
            (Some(b), _) => {
                if b {
                    other.negated()
                } else {
                    other
                }
            }
            (_, Some(b)) => {
                if b {
                    self.negated()
                } else {
                    self
                }
            }
            (None, None) => Expr::Xor(Box::new(self), Box::new(other)),
        }
    }

    /// Arithmetic with another number of the type.
    #[must_use]
    pub fn arith(self, op: Arith, ty: Type, other: Expr) -> Expr {
        Expr::Arith(op, ty, Box::new(self), Box::new(other))
    }

    /// Compared with another value of the type.
    #[must_use]
    pub fn compare(self, op: Cmp, ty: Type, other: Expr) -> Expr {
        Expr::Compare(op, ty, Box::new(self), Box::new(other))
    }

    /// Its operation has no value.
    #[must_use]
    pub fn fails(self) -> Expr {
        Expr::Fails(Box::new(self))
    }

    /// Visits this expression and all within it.
    pub fn visit(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        match self {
            Expr::Const(..) | Expr::Text(_) | Expr::Read(_) => {}
            Expr::Element(_, e)
            | Expr::Not(e)
            | Expr::Neg(_, e)
            | Expr::Convert(_, _, e)
            | Expr::Trunc(_, _, e)
            | Expr::Random(e)
            | Expr::Fails(e) => e.visit(f),
            Expr::And(list) | Expr::Or(list) | Expr::Call(_, _, list) => list.iter().for_each(|e| e.visit(f)),
            Expr::Xor(a, b)
            | Expr::Arith(_, _, a, b)
            | Expr::Compare(_, _, a, b)
            | Expr::Differs(_, a, b) => {
                a.visit(f);
                b.visit(f);
            }
        }
    }

    /// Reads this memory.
    pub fn reads(&self, memory: MemoryId) -> bool {
        let mut found = false;
        self.visit(&mut |e| found |= matches!(e, Expr::Read(m) | Expr::Element(m, _) if *m == memory));
        found
    }
}

impl Stmt {
    /// Statements where a condition holds; those alone where it is known.
    pub fn when(condition: Expr, then: Vec<Stmt>) -> Vec<Stmt> {
        match condition.known() {
            Some(true) => then,
            Some(false) => Vec::new(),
            None if then.is_empty() => then,
            None => vec![Stmt::If(condition, then, Vec::new())],
        }
    }

    /// Visits this statement and all within it.
    pub fn visit(&self, f: &mut dyn FnMut(&Stmt)) {
        f(self);
        match self {
            Stmt::If(_, a, b) => a.iter().chain(b).for_each(|s| s.visit(f)),
            Stmt::Loop(a) => a.iter().for_each(|s| s.visit(f)),
            Stmt::Set(..)
            | Stmt::SetElement(..)
            | Stmt::Exit
            | Stmt::Fault(..)
            | Stmt::Call(..)
            | Stmt::About(_) => {}
        }
    }

    /// Visits the expressions that stand in this statement itself.
    pub fn expressions(&self, f: &mut dyn FnMut(&Expr)) {
        match self {
            Stmt::Set(_, e) | Stmt::If(e, _, _) => f(e),
            Stmt::SetElement(_, index, e) => {
                f(index);
                f(e);
            }
            Stmt::Loop(_) | Stmt::Exit | Stmt::Fault(..) | Stmt::Call(..) | Stmt::About(_) => {}
        }
    }
}

impl Section {
    /// A section without statements.
    pub fn new(title: &'static str) -> Section {
        Section { title, body: Vec::new() }
    }
}
