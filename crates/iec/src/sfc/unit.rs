//! The content of a file before it becomes a document.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Composed, Expr, Name, Nanos, Path, Qualifier, Span, Stmt};

use crate::nodes::{self, Taken};
use crate::st::{Types, Variable};

/// The whole file.
#[derive(Debug, Default)]
pub(super) struct Source {
    pub(super) units: Vec<Unit>,
    pub(super) globals: Vec<Variable>,
    pub(super) tasks: Vec<Task>,
    pub(super) instances: Vec<Instance>,
    pub(super) resources: Vec<Resource>,
    pub(super) types: Types,
    /// The function blocks without a chart that are used.
    pub(super) blocks: Vec<Composed>,
    /// The global variables that these use.
    pub(super) externals: Vec<Variable>,
    /// Statements that run before all programs.
    pub(super) before: Vec<Stmt>,
}

/// The kinds of program organisation unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnitKind {
    Program,
    FunctionBlock,
    Function,
}

/// A program organisation unit.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub(super) kind: UnitKind,
    pub(super) name: Name,
    /// The result of a function, with its name.
    pub(super) result: Option<Variable>,
    pub(super) vars: Vec<Variable>,
    pub(super) parts: Vec<Part>,
    /// The statements of a unit without a chart.
    pub(super) body: Vec<Stmt>,
    /// Statements behind the charts that the unit calls.
    pub(super) behind: Vec<Stmt>,
    pub(super) body_at: Range<usize>,
    /// A pragma with statements of another language.
    pub(super) foreign: Option<Span>,
    pub(super) at: Span,
}

/// An element of a chart.
#[derive(Clone, Debug)]
pub(super) enum Part {
    Step { name: Name, initial: bool, associations: Vec<Association>, at: Span },
    Transition(Box<Transition>),
    Action { name: Name, body: Vec<Stmt>, at: Span },
}

#[derive(Clone, Debug)]
pub(super) struct Transition {
    pub(super) label: Option<Name>,
    pub(super) priority: Option<u32>,
    pub(super) from: Vec<Name>,
    pub(super) to: Vec<Name>,
    pub(super) receptivity: Expr,
    pub(super) at: Span,
}

/// An action of a step with its qualifier.
#[derive(Clone, Debug)]
pub(super) struct Association {
    pub(super) target: Expr,
    pub(super) qualifier: Qualifier,
    pub(super) time: Option<Expr>,
    pub(super) at: Span,
}

/// A resource of a configuration, with what it has of its own.
#[derive(Debug)]
pub(super) struct Resource {
    pub(super) name: Name,
    pub(super) globals: Vec<Variable>,
    pub(super) tasks: Vec<Task>,
    pub(super) instances: Vec<Instance>,
}

/// A task of a resource.
#[derive(Debug)]
pub(super) struct Task {
    pub(super) name: Name,
    /// How often it runs.
    pub(super) interval: Option<Nanos>,
}

/// A program that a resource runs.
#[derive(Debug)]
pub(super) struct Instance {
    pub(super) task: Option<Name>,
    pub(super) unit: Name,
    /// Variables of the program with the address or global variable that each is connected to.
    pub(super) links: Vec<(Name, Expr)>,
    pub(super) at: Span,
}

impl Source {
    /// The names of all units and variables.
    pub(super) fn names(&self) -> Taken {
        let mut taken = Taken::default();
        let variables = self.globals.iter().chain(self.units.iter().flat_map(|u| &u.vars));
        variables.flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
        self.units.iter().for_each(|u| _ = taken.take(&u.name.text));
        taken
    }
}

impl Unit {
    /// The names of its variables, and its own.
    pub(super) fn names(&self) -> Taken {
        let mut taken = Taken::default();
        self.vars.iter().flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
        taken.take(&self.name.text);
        taken
    }

    pub(super) fn is_chart(&self) -> bool {
        self.parts.iter().any(|p| matches!(p, Part::Step { .. } | Part::Transition(_)))
    }
}

/// Visits all statements and receptivities of a unit.
pub(super) fn each(unit: &mut Unit, v: &mut impl Visitor) {
    visit_mut::stmts(&mut unit.body, v);
    for part in &mut unit.parts {
        match part {
            Part::Action { body, .. } => visit_mut::stmts(body, v),
            Part::Transition(t) => visit_mut::expr(&mut t.receptivity, v),
            Part::Step { .. } => {}
        }
    }
}

/// Renames variables; the old names are in upper case.
pub(super) struct Renamed<'n>(pub(super) &'n HashMap<String, String>);

impl Visitor for Renamed<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        let Some(first) = path.names.first_mut() else { return };
        let (bare, index) = nodes::bare(&first.text);
        if let Some(own) = self.0.get(&bare.to_uppercase()) {
            first.text = format!("{own}{index}").into();
        }
    }
}

/// A name as it is compared.
pub(super) fn upper(name: &Name) -> String {
    name.text.to_uppercase()
}

/// The name of the function that an expression or a statement calls, in upper case.
pub(super) fn callee(path: &Path) -> Option<String> {
    match path.names.as_slice() {
        [name] => Some(upper(name)),
        _ => None,
    }
}
