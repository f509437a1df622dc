//! The chart with every name resolved and every expression typed.
//!
//! `resolve` makes it from a `model::Document`, `check` judges it, and `lower` turns it into an
//! `engine::Program`. Parts that cannot be resolved are reported and left out. The rest is well
//! typed: both operands of a binary operator have one type, conversions are explicit, targets are
//! writable.

use std::sync::Arc;

use g7_engine::{Builtin, Rules};
use g7_model::{FbKind, Nanos, ProfileName, Qualifier, Span, TargetPlc, Type};

use crate::held::Held;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// As an index into the table.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// A row of [`Unit::vars`].
    VarId
    /// A row of [`Unit::charts`].
    ChartId
    /// A row of [`Unit::steps`].
    StepId
    /// A row of [`Unit::transitions`].
    TransitionId
    /// A row of [`Unit::bodies`].
    BodyId
    /// A row of [`Unit::sections`].
    SectionId
    /// A row of [`Unit::functions`].
    FunctionId
}

/// All of one document that runs.
#[derive(Clone, Debug, Default)]
pub struct Unit {
    /// The profile named by the document.
    pub profile: ProfileName,
    /// Its switches, with those set one by one.
    pub rules: Rules,
    /// The nominal scan time.
    pub cycle: Nanos,
    /// The PLC whose limits hold.
    pub target: Option<TargetPlc>,
    /// Inputs, outputs, variables, constants, instances, system bits.
    pub vars: Vec<Var>,
    /// Charts, expansions and tasks, in text order.
    pub charts: Vec<Chart>,
    /// Steps of all charts; those of a chart are contiguous, in text order.
    pub steps: Vec<Step>,
    /// Transitions of all charts; those of a chart are contiguous, in text order.
    pub transitions: Vec<Transition>,
    /// Named actions.
    pub bodies: Vec<Body>,
    /// Preliminary processing: one body for each section, in text order. RETURN ends its own
    /// section only.
    pub pre: Vec<Body>,
    /// Posterior processing, in the same form.
    pub post: Vec<Body>,
    /// Transition sections.
    pub sections: Vec<Section>,
    /// Functions.
    pub functions: Vec<Function>,
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VarClass {
    /// Copied in at the start of a scan.
    Input,
    /// Copied out at its end.
    Output,
    /// Of the chart's own.
    Internal,
    /// Local to a body or function: set anew at each run.
    Local,
    /// Never written.
    Const,
    /// A system bit or word (`%S21`); named with its `%`.
    System,
}

/// A variable.
#[derive(Clone, Debug)]
pub struct Var {
    /// Qualified name as users write it from elsewhere: `motor`, `Fill.count`.
    pub name: Box<str>,
    /// Its role.
    pub class: VarClass,
    /// Its type.
    pub ty: Type,
    /// The values that it can have, if it is of an enumeration or has bounds.
    pub held: Option<Arc<Held>>,
    /// Number of elements: 1, except for the tables of a plant.
    pub elements: u32,
    /// Initial value (one for all elements).
    pub init: Value,
    /// Initial values of the first elements, where they differ.
    pub table: Vec<Value>,
    /// Kept over a restart.
    pub retain: bool,
    /// Address or channel, as written.
    pub address: Option<Box<str>>,
    /// The channel carries the complement.
    pub inverted: bool,
    /// Value after a fault, of an output.
    pub safe: Value,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Declaration.
    pub at: Span,
}

/// A constant of one of the types; its type is stored next to it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// BOOL.
    Bool(bool),
    /// Any integer type, or TIME in nanoseconds.
    Int(i128),
    /// REAL or LREAL.
    Real(f64),
    /// STRING.
    Str(Box<str>),
}

/// The role of a chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChartRole {
    /// A chart of its own.
    Chart,
    /// Expansion of this macro-step.
    Expansion(StepId),
    /// An expansion that no macro-step uses; it never runs.
    Unused,
    /// A task.
    Task,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its name.
    pub name: Box<str>,
    /// The name of the chart in traces: `G`, for an expansion `G.M3`.
    pub path: Box<str>,
    /// Its role.
    pub role: ChartRole,
    /// The period of its evolutions; without one it evolves in every scan.
    pub every: Option<Nanos>,
    /// Its steps: `first..end` of [`Unit::steps`].
    pub steps: std::ops::Range<u32>,
    /// Its transitions: `first..end` of [`Unit::transitions`].
    pub transitions: std::ops::Range<u32>,
    /// Entry step of an expansion or task.
    pub entry: Option<StepId>,
    /// Exit step of an expansion or task.
    pub exit: Option<StepId>,
    /// The step that encloses it.
    pub enclosed_by: Option<StepId>,
    /// Its name in the text.
    pub at: Span,
}

/// The kind of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepSort {
    /// Plain, entry or exit step.
    Plain,
    /// Macro-step with its expansion.
    Macro(ChartId),
    /// Encloses these charts.
    Enclosing(Vec<ChartId>),
}

/// A step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its name in its chart.
    pub name: Box<str>,
    /// Its chart.
    pub chart: ChartId,
    /// Its kind.
    pub sort: StepSort,
    /// Active in the initial situation.
    pub initial: bool,
    /// Carries the activation link.
    pub linked: bool,
    /// Its actions, in text order.
    pub actions: Vec<Action>,
    /// Tasks it calls.
    pub calls: Vec<(ChartId, Span)>,
    /// Its name in the text.
    pub at: Span,
}

/// A transition.
#[derive(Clone, Debug)]
pub struct Transition {
    /// Its label, if any.
    pub label: Option<Box<str>>,
    /// Its chart.
    pub chart: ChartId,
    /// Preceding steps, macro-steps as themselves.
    pub from: Vec<StepId>,
    /// Succeeding steps, macro-steps as themselves.
    pub to: Vec<StepId>,
    /// BOOL.
    pub receptivity: Expr,
    /// As written, 1 first.
    pub priority: Option<u32>,
    /// Stored action on clearing.
    pub on_clearing: Vec<Stmt>,
    /// The whole transition in the text.
    pub at: Span,
}

/// An action of a step.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its effect and its time.
    pub kind: ActionKind,
    /// Where it stands.
    pub at: Span,
}

/// The kinds of action.
#[derive(Clone, Debug)]
pub enum ActionKind {
    /// A qualifier on a Boolean variable.
    Variable {
        /// The qualifier.
        qualifier: Qualifier,
        /// TIME, for the timed ones.
        time: Option<Expr>,
        /// BOOL.
        var: VarId,
        /// BOOL.
        condition: Option<Expr>,
    },
    /// A qualifier on a named action.
    Named {
        /// The qualifier.
        qualifier: Qualifier,
        /// TIME, for the timed ones.
        time: Option<Expr>,
        /// The named action.
        body: BodyId,
        /// BOOL.
        condition: Option<Expr>,
    },
    /// A qualifier on an assignment or block.
    Work {
        /// The qualifier.
        qualifier: Qualifier,
        /// TIME, for the timed ones.
        time: Option<Expr>,
        /// The statements that run.
        work: Vec<Stmt>,
        /// BOOL.
        condition: Option<Expr>,
    },
    /// Stored action on event.
    OnEvent {
        /// BOOL, with an edge in it.
        event: Expr,
        /// The statements that run.
        work: Vec<Stmt>,
    },
    /// Each scan while the step is active.
    EachScan {
        /// The statements that run.
        work: Vec<Stmt>,
        /// BOOL.
        condition: Option<Expr>,
    },
    /// Forcing order.
    Force(ChartId, Situation),
    /// The chart evolves only while some step enables it.
    Enable(ChartId),
    /// Continuous actions of the chart are held back.
    MaskChart(ChartId),
    /// The output is held back.
    MaskVar(VarId),
}

/// A situation to be forced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Situation {
    /// `INIT`.
    Init,
    /// `{*}`.
    Current,
    /// `{…}`; empty for `{}`.
    Steps(Vec<StepId>),
}

/// A named action, or a PRE or POST section.
#[derive(Clone, Debug)]
pub struct Body {
    /// Qualified name.
    pub name: Box<str>,
    /// The chart it stands in; `None` outside of all charts.
    pub chart: Option<ChartId>,
    /// Its statements.
    pub statements: Vec<Stmt>,
    /// Its name in the text.
    pub at: Span,
}

/// A transition section.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its name.
    pub name: Box<str>,
    /// Its BOOL output.
    pub output: VarId,
    /// Runs when the receptivity of the transition is evaluated.
    pub statements: Vec<Stmt>,
    /// Its name in the text.
    pub at: Span,
}

/// A function.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: Box<str>,
    /// Its inputs, as local variables.
    pub params: Vec<VarId>,
    /// Its result, a local variable, zero at each call.
    pub result: VarId,
    /// Its statements; they begin with the assignments that set its locals.
    pub statements: Vec<Stmt>,
    /// Its name in the text.
    pub at: Span,
}

/// A typed expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// Its kind.
    pub kind: ExprKind,
    /// Type of its value.
    pub ty: Type,
    /// Where it stands.
    pub at: Span,
}

/// The forms of a typed expression.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A constant.
    Const(Value),
    /// The value of a variable.
    Var(VarId),
    /// One of several variables, by an index from 0 (LINT) in each dimension.
    Element(Elements, Vec<Expr>),
    /// Member of a function block instance, by its place in `FbKind::members`.
    Member(VarId, u8),
    /// Activity of a step; of a macro-step, `XM`.
    StepActive(StepId),
    /// Time since activation (TIME).
    StepTime(StepId),
    /// The same in units of 100 ms, at most 9999 (INT).
    StepTenths(StepId),
    /// Scans since activation (INT, held at 32767).
    StepScans(StepId),
    /// Scans since activation times the nominal scan time, in seconds (REAL).
    StepSeconds(StepId),
    /// BOOL complement.
    Not(Box<Expr>),
    /// Minus.
    Neg(Box<Expr>),
    /// Rising edge.
    Rise(Box<Expr>),
    /// Falling edge.
    Fall(Box<Expr>),
    /// Both operands have one type; in `*` and `/` of a TIME the right one is LINT or LREAL.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `t1/e/t2`.
    Timer {
        /// TIME.
        t1: Box<Expr>,
        /// BOOL.
        e: Box<Expr>,
        /// TIME.
        t2: Option<Box<Expr>>,
    },
    /// Converts the operand to the type of this expression. TIME counts as its nanoseconds (LINT);
    /// a separate factor scales it for `TIME_TO_DINT`.
    Convert(Box<Expr>),
    /// TRUNC: a real toward zero, to the integer type of this expression.
    Trunc(Box<Expr>),
    /// A standard function.
    Builtin(Builtin, Vec<Expr>),
    /// A function of the document.
    Call(FunctionId, Vec<Expr>),
    /// A transition section: runs it and gives its output.
    Section(SectionId),
    /// Time since the scan before (TIME); plants only.
    ScanTime,
    /// A random number, at least 0 and below 1 (LREAL); plants only.
    Random,
}

impl Expr {
    /// Its operands, in their order.
    pub fn operands(&self) -> impl Iterator<Item = &Expr> {
        let (few, many): ([Option<&Expr>; 3], &[Expr]) = match &self.kind {
            ExprKind::Const(_)
            | ExprKind::Var(_)
            | ExprKind::Member(..)
            | ExprKind::StepActive(_)
            | ExprKind::StepTime(_)
            | ExprKind::StepTenths(_)
            | ExprKind::StepScans(_)
            | ExprKind::StepSeconds(_)
            | ExprKind::Section(_)
            | ExprKind::ScanTime
            | ExprKind::Random => ([None; 3], &[]),
            ExprKind::Not(a)
            | ExprKind::Neg(a)
            | ExprKind::Rise(a)
            | ExprKind::Fall(a)
            | ExprKind::Convert(a)
            | ExprKind::Trunc(a) => ([Some(a), None, None], &[]),
            ExprKind::Binary(_, a, b) => ([Some(a), Some(b), None], &[]),
            ExprKind::Timer { t1, e, t2 } => ([Some(t1), Some(e), t2.as_deref()], &[]),
            ExprKind::Element(_, args) | ExprKind::Builtin(_, args) | ExprKind::Call(_, args) => {
                ([None; 3], args)
            }
        };
        few.into_iter().flatten().chain(many)
    }
}

/// Operators between operands; `And`, `Or` and `Xor` join values of type BOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    /// OR.
    Or,
    /// XOR.
    Xor,
    /// AND.
    And,
    /// `=`.
    Eq,
    /// `<>`.
    Ne,
    /// `<`.
    Lt,
    /// `<=`.
    Le,
    /// `>`.
    Gt,
    /// `>=`.
    Ge,
    /// `+`.
    Add,
    /// `-`.
    Sub,
    /// `*`.
    Mul,
    /// `/`.
    Div,
    /// `mod`.
    Mod,
    /// `**`, of LREAL.
    Pow,
}

/// The target of an assignment.
#[derive(Clone, Debug)]
pub enum Target {
    /// A variable.
    Var(VarId),
    /// One of several variables, by an index from 0 (LINT) in each dimension.
    Element(Elements, Vec<Expr>),
    /// An input member of an instance.
    Member(VarId, u8),
}

/// The elements of an array: variables that follow one another, the last index counting fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Elements {
    /// The first one.
    pub first: VarId,
    /// The number of indexes of each dimension.
    pub counts: Box<[u32]>,
}

impl Elements {
    /// Their number.
    pub fn count(&self) -> u32 {
        self.counts.iter().product()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = VarId> + use<> {
        (self.first.0..self.first.0 + self.count()).map(VarId)
    }
}

/// A statement.
#[derive(Clone, Debug)]
pub struct Stmt {
    /// Its kind.
    pub kind: StmtKind,
    /// Where it stands.
    pub at: Span,
}

/// The ranges of an arm of CASE, ends included, and its statements.
pub type CaseArm = (Vec<(i64, i64)>, Vec<Stmt>);

/// The statements.
#[derive(Clone, Debug)]
pub enum StmtKind {
    /// `target := value`, of one type (STRING lengths may differ).
    Assign(Target, Expr),
    /// A call of a function block instance.
    Fb {
        /// The instance.
        var: VarId,
        /// Its kind.
        kind: FbKind,
        /// Inputs given, by member.
        inputs: Vec<(u8, Expr)>,
        /// Outputs taken, by member.
        outputs: Vec<(u8, Target)>,
    },
    /// Conditions with their statements, then ELSE.
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    /// Selector (an integer type, widened to LINT), arms of inclusive ranges, ELSE.
    Case(Expr, Vec<CaseArm>, Vec<Stmt>),
    /// FOR; all of the variable's type.
    For {
        /// The loop variable.
        var: VarId,
        /// First value.
        from: Expr,
        /// Last value.
        to: Expr,
        /// Step.
        by: Option<Expr>,
        /// The repeated statements.
        body: Vec<Stmt>,
    },
    /// WHILE.
    While(Expr, Vec<Stmt>),
    /// REPEAT … UNTIL.
    Repeat(Vec<Stmt>, Expr),
    /// Leaves the innermost loop.
    Exit,
    /// Leaves the body.
    Return,
    /// A service of the controller.
    Service(Service),
}

/// The special services (SEMANTICS section 6).
#[derive(Clone, Debug)]
pub enum Service {
    /// `INITCHART(G)`.
    InitChart(ChartId),
    /// `CLEARCHART(G)`.
    ClearChart(ChartId),
    /// `FREEZECHART(G, b)`.
    FreezeChart(ChartId, Box<Expr>),
    /// `SETSTEP(G.X12)`.
    SetStep(StepId),
    /// `RESETSTEP(G.X12)`.
    ResetStep(StepId),
    /// `RESET_XIT()`.
    ResetTimes,
}
