//! Actions of steps, and the Structured Text inside them.

use crate::{Arg, Expr, Name, Path, Place, Qualifier, ValueType};

/// One action of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    /// Its effect and its time.
    pub kind: ActionKind,
    /// Where it stands.
    pub at: Place,
}

/// The kinds of action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ActionKind {
    /// `N motor`, `L 5s lamp`, `P1 n := n + 1`, `N motor if a`.
    Qualified {
        /// The qualifier.
        qualifier: Qualifier,
        /// Its time, for L, D, SD, DS, SL.
        time: Option<Expr>,
        /// A Boolean variable, a named action or a body.
        target: Target,
        /// `if …`: the assignation condition.
        condition: Option<Expr>,
    },
    /// `on ↑e: …` (IEC 60848:2013, 4.8.3: stored action on event).
    OnEvent {
        /// The event, with an edge in it.
        event: Expr,
        /// The statements that run.
        work: Work,
    },
    /// `each scan: …`, while the step is active.
    EachScan {
        /// The statements that run.
        work: Work,
        /// `if …`.
        condition: Option<Expr>,
    },
    /// `force`, `enable`, `mask`, `call`, `enclose`.
    Order(Order),
    /// A comment to be drawn.
    Comment(Box<str>),
}

/// An order that a step gives to another chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// A forcing order (IEC 60848:2013, 7.3).
    Force(Name, Situation),
    /// The named chart evolves only while some step enables it.
    Enable(Name),
    /// The continuous actions of a chart, or one output, are held back.
    Mask(Name),
    /// The task is run; the transitions behind the step wait for its exit step.
    Call(Name),
    /// The chart is enclosed by this step (IEC 60848:2013, 7.4).
    Enclose(Name),
}

/// The situation that a forcing order imposes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Situation {
    /// `INIT`: the initial situation.
    Init,
    /// `{*}`: the present situation (freeze).
    Current,
    /// `{…}`: only these steps; `{}` no step.
    Steps(Vec<Name>),
}

/// The object of a qualifier.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A Boolean variable or a named action.
    Path(Path),
    /// An element of an array, [`crate::ExprKind::Element`].
    Element(Box<Expr>),
    /// `%Q0.1`, without the `%`.
    Direct(Box<str>, Place),
    /// An assignment or a block, an action without a name.
    Work(Work),
}

/// One statement, or a block in braces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Work {
    /// One assignment or call, written without braces.
    Single(Box<Stmt>),
    /// `{ … }`.
    Block(Block),
}

impl Work {
    /// The statements.
    pub fn statements(&self) -> &[Stmt] {
        match self {
            Work::Single(s) => std::slice::from_ref(s),
            Work::Block(b) => &b.statements,
        }
    }
}

/// `{ var …; statements }`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block {
    /// The local variables (in functions, actions and sections only).
    pub locals: Vec<Local>,
    /// The statements.
    pub statements: Vec<Stmt>,
    /// The braces and all between.
    pub at: Place,
}

/// A local variable; it takes its initial value at each run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Local {
    /// The names declared together.
    pub names: Vec<Name>,
    /// Their type.
    pub ty: ValueType,
    /// Initial value; that of the type when absent.
    pub init: Option<Expr>,
    /// Where it stands.
    pub at: Place,
}

/// The language of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyLang {
    /// Instruction List.
    Il,
    /// Ladder Diagram, as text.
    Ld,
}

/// The body of a named action or of a PRE or POST section.
///
/// Two bodies in another language are equal when their texts are: the statements follow from these.
#[derive(Clone, Debug, Eq)]
pub enum Body {
    /// Structured Text.
    St(Block),
    /// Another language: the text between the braces, and the statements that it stands for.
    Other(BodyLang, Box<str>, Block),
}

impl PartialEq for Body {
    fn eq(&self, other: &Body) -> bool {
        match (self, other) {
            (Body::St(a), Body::St(b)) => a == b,
            (Body::Other(lang, text, _), Body::Other(lang2, text2, _)) => lang == lang2 && text == text2,
            (Body::St(_), Body::Other(..)) | (Body::Other(..), Body::St(_)) => false,
        }
    }
}

impl Body {
    /// The statements of the body, in Structured Text.
    pub fn block(&self) -> &Block {
        match self {
            Body::St(block) | Body::Other(_, _, block) => block,
        }
    }

    /// The same, to be changed. The text of another language stays as it is.
    pub fn block_mut(&mut self) -> &mut Block {
        match self {
            Body::St(block) | Body::Other(_, _, block) => block,
        }
    }
}

impl Stmt {
    /// The lists of statements within this one, one level down.
    pub fn lists(&self) -> Vec<&[Stmt]> {
        match &self.kind {
            StmtKind::If(arms, otherwise) => arms.iter().map(|a| &*a.1).chain([&**otherwise]).collect(),
            StmtKind::Case(_, arms, otherwise) => {
                arms.iter().map(|a| &*a.body).chain([&**otherwise]).collect()
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => vec![body],
            StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return => Vec::new(),
        }
    }

    /// True for RETURN, and for a statement with one within it.
    pub fn returns(&self) -> bool {
        self.kind == StmtKind::Return || self.lists().into_iter().flatten().any(Stmt::returns)
    }

    /// True for a loop.
    pub fn is_loop(&self) -> bool {
        matches!(self.kind, StmtKind::For { .. } | StmtKind::While(..) | StmtKind::Repeat(..))
    }
}

/// A statement of Structured Text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stmt {
    /// Its kind.
    pub kind: StmtKind,
    /// Where it stands.
    pub at: Place,
}

/// The statements of Structured Text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StmtKind {
    /// `target := value`; the target is a path, an element of an array or a direct name.
    Assign {
        /// A `Path`, `Element` or `Direct` expression.
        target: Expr,
        /// The value.
        value: Expr,
    },
    /// `c1(CU := x)`, `INITCHART(G1)`, `Belt.enter(1)`.
    Call(Path, Vec<Arg>),
    /// Conditions with their statements, then ELSE.
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    /// CASE selector, arms, ELSE.
    Case(Expr, Vec<CaseArm>, Vec<Stmt>),
    /// FOR.
    For {
        /// The loop variable.
        var: Name,
        /// Its first value.
        from: Expr,
        /// Its last value.
        to: Expr,
        /// The step, 1 when absent.
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
}

/// One arm of a CASE.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseArm {
    /// Single values, or ranges with both ends included.
    pub labels: Vec<(Expr, Option<Expr>)>,
    /// The statements.
    pub body: Vec<Stmt>,
}
