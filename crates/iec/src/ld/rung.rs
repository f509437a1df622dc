//! The rungs of a Ladder Diagram, after parsing.

use g7_model::{Arg, Expr, Name, Path, Span, Stmt, UnaryOp};

/// One rung.
#[derive(Clone, Debug)]
pub struct Rung {
    /// The label to which jumps lead.
    pub label: Option<Name>,
    /// The elements from left to right.
    pub elements: Vec<Element>,
    /// The place of the whole rung.
    pub at: Span,
}

/// An element of a rung.
#[derive(Clone, Debug)]
pub enum Element {
    /// `[a]`: power passes while the expression is true.
    Contact(Expr),
    /// A coil with its place.
    Coil(Coil, Span),
    /// `<t1(IN, PT := 5s).Q>`: power enters at the input without a value and leaves at the output.
    Block {
        /// The function or instance.
        path: Path,
        /// Its arguments.
        args: Vec<Arg>,
        /// The output where power leaves.
        output: Option<Name>,
        /// Its place.
        at: Span,
    },
    /// `{ … | … }`: parallel branches.
    Branch(Vec<Vec<Element>>, Span),
}

/// The effect of a coil.
#[derive(Clone, Debug)]
pub enum Coil {
    /// `(q)`, or complemented `(/q)`.
    Assign(Expr, bool),
    /// `(S q)`, `(R q)`.
    Latch(Expr, bool),
    /// `(P q)`, `(N q)`: true in the scan in which power appears or disappears.
    Edge(Expr, UnaryOp),
    /// `(n := n + 1)`: executed while there is power.
    Statement(Box<Stmt>),
    /// `(JMP name)`.
    Jump(Name),
    /// `(RET)`.
    Return,
}
