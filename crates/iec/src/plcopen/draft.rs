//! The data of charts while they are built from drawings, and the builder itself.

use std::collections::{HashMap, HashSet};

use g7_model::{Block, Chart, ChartItem, ChartKind, Expr, Layout, Nanos, Stmt, StmtKind, VarDecl};

use super::bodies::{Callee, Coder, Place};
use super::graph::Graph;
use super::tree::{Xml, kids, tag, word};
use crate::nodes::{self, Taken, line};
use crate::xml::attr;

/// The result of one drawing.
#[derive(Default)]
pub(super) struct Made {
    pub(super) charts: Vec<Chart>,
    pub(super) layouts: Vec<Layout>,
}

/// The request to make a chart.
pub(super) struct Order<'a> {
    pub(super) kind: ChartKind,
    pub(super) name: String,
    /// The unit whose names the chart uses.
    pub(super) unit: usize,
    pub(super) body: Xml<'a>,
    /// The element that the chart describes: a POU, an action or a macro-step.
    pub(super) of: Xml<'a>,
    /// The chart evolves only while this is true.
    pub(super) guard: Option<Expr>,
    pub(super) vars: Vec<VarDecl>,
    pub(super) pre: Vec<Stmt>,
    pub(super) every: Option<Nanos>,
}

/// Makes charts of drawings.
pub(super) struct Maker<'c, 'r, 'p, 'a> {
    pub(super) coder: &'c mut Coder<'r, 'p, 'a>,
    /// The names of charts given so far.
    pub(super) charts: &'c mut Taken,
    /// True if the steps of the file name their actions without action blocks, as in CODESYS.
    pub(super) plain_actions: bool,
    /// The guards of called charts.
    pub(super) guards: &'c HashMap<Callee, Expr>,
    pub(super) made: Made,
}

/// A chart that is being built.
pub(super) struct Draft<'g, 'a> {
    pub(super) graph: &'g Graph<'a>,
    /// The names of steps in the document, by object.
    pub(super) names: HashMap<usize, String>,
    pub(super) place: Place,
    pub(super) guard: Option<Expr>,
    pub(super) unit: usize,
    /// Statements that run before the chart evolves.
    pub(super) pre: Vec<Stmt>,
    pub(super) items: Vec<ChartItem>,
    pub(super) labels: HashSet<String>,
}

/// Statements in braces.
pub(super) fn block(statements: Vec<Stmt>, at: g7_model::Span) -> Block {
    Block { locals: Vec::new(), statements, at: at.into() }
}

/// The parts of a guard that a condition does not have yet. A program may test for itself what CODESYS tests
/// anyway, as the files do that are written here.
pub(super) fn lacking(guard: &Expr, condition: &Expr) -> Option<Expr> {
    let there = nodes::conjuncts(condition);
    let missing = nodes::conjuncts(guard).into_iter().filter(|part| !there.contains(part));
    missing.cloned().reduce(|a, b| nodes::and(a, b, guard.at.0))
}

/// Statements that run only under a guard.
pub(super) fn guarded(guard: Option<&Expr>, statements: Vec<Stmt>, at: g7_model::Span) -> Vec<Stmt> {
    let tested = match statements.as_slice() {
        [Stmt { kind: StmtKind::If(arms, otherwise), .. }] if otherwise.is_empty() => match arms.as_slice() {
            [(condition, _)] => Some(condition),
            _ => None,
        },
        _ => None,
    };
    let guard = match tested {
        Some(condition) => guard.and_then(|g| lacking(g, condition)),
        None => guard.cloned(),
    };
    match guard {
        Some(guard) if !statements.is_empty() => {
            vec![nodes::when(guard.clone(), statements, Vec::new(), at)]
        }
        _ => statements,
    }
}

/// The attributes that CODESYS keeps with an element: identifier and value.
pub(super) fn kept(node: Xml) -> Vec<(String, String)> {
    let data = kids(node).filter(|n| tag(*n) == "addData").flat_map(|n| n.descendants());
    data.filter(|n| n.is_element() && tag(*n) == "attribute")
        .filter_map(|n| word(n, "guid").map(|g| (g.to_string(), line(&attr::content(n).text))))
        .collect()
}
