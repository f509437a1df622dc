//! The content of a file before it becomes a document.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Composed, Expr, Name, Nanos, Path, Qualifier, Span, Stmt};

use crate::nodes::Taken;
use crate::st::{Types, Variable};

/// The whole file.
#[derive(Debug, Default)]
pub(crate) struct Source {
    pub(crate) units: Vec<Unit>,
    pub(crate) globals: Vec<Variable>,
    pub(crate) tasks: Vec<Task>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) resources: Vec<Resource>,
    pub(crate) types: Types,
    /// The function blocks without a chart that are used.
    pub(crate) blocks: Vec<Composed>,
    /// The global variables that these use.
    pub(crate) externals: Vec<Variable>,
    /// Statements that run before all programs.
    pub(crate) before: Vec<Stmt>,
}

/// The kinds of program organisation unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnitKind {
    Program,
    FunctionBlock,
    Function,
}

/// A program organisation unit.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub(crate) kind: UnitKind,
    pub(crate) name: Name,
    /// The result of a function, with its name.
    pub(crate) result: Option<Variable>,
    pub(crate) vars: Vec<Variable>,
    pub(crate) parts: Vec<Part>,
    /// The statements of a unit without a chart.
    pub(crate) body: Vec<Stmt>,
    /// Statements before a program: they copy to its inputs what the configuration connects these with.
    pub(crate) before: Vec<Stmt>,
    /// Statements behind a program: they copy its outputs to what the configuration connects these with.
    pub(crate) after: Vec<Stmt>,
    /// Statements behind the charts that the unit calls.
    pub(crate) behind: Vec<Stmt>,
    pub(crate) body_at: Range<usize>,
    /// A pragma with statements of another language.
    pub(crate) foreign: Option<Span>,
    pub(crate) at: Span,
}

/// An element of a chart.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Step { name: Name, initial: bool, associations: Vec<Association>, at: Span },
    Transition(Box<Transition>),
    Action { name: Name, body: Vec<Stmt>, at: Span },
}

#[derive(Clone, Debug)]
pub(crate) struct Transition {
    pub(crate) label: Option<Name>,
    pub(crate) priority: Option<u32>,
    pub(crate) from: Vec<Name>,
    pub(crate) to: Vec<Name>,
    pub(crate) receptivity: Expr,
    pub(crate) at: Span,
}

/// An action of a step with its qualifier.
#[derive(Clone, Debug)]
pub(crate) struct Association {
    pub(crate) target: Expr,
    pub(crate) qualifier: Qualifier,
    pub(crate) time: Option<Expr>,
    pub(crate) at: Span,
}

/// A resource of a configuration, with what it has of its own.
#[derive(Debug)]
pub(crate) struct Resource {
    pub(crate) name: Name,
    pub(crate) globals: Vec<Variable>,
    pub(crate) tasks: Vec<Task>,
    pub(crate) instances: Vec<Instance>,
}

/// A task of a resource.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) name: Name,
    /// How often it runs.
    pub(crate) interval: Option<Nanos>,
}

/// A program that a resource runs.
#[derive(Debug)]
pub(crate) struct Instance {
    pub(crate) name: Name,
    pub(crate) task: Option<Name>,
    pub(crate) unit: Name,
    /// Variables of the program with the address or global variable that each is connected to.
    pub(crate) links: Vec<(Name, Expr)>,
    pub(crate) at: Span,
}

impl Source {
    /// The names of all units and variables.
    pub(crate) fn names(&self) -> Taken {
        let mut taken = Taken::default();
        let variables = self.globals.iter().chain(self.units.iter().flat_map(|u| &u.vars));
        variables.flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
        self.units.iter().for_each(|u| _ = taken.take(&u.name.text));
        taken
    }
}

impl Unit {
    /// A unit without variables and statements.
    pub(crate) fn new(kind: UnitKind, name: Name, at: Span) -> Unit {
        Unit {
            kind,
            name,
            result: None,
            vars: Vec::new(),
            parts: Vec::new(),
            body: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
            behind: Vec::new(),
            body_at: 0..0,
            foreign: None,
            at,
        }
    }

    /// The names of its variables, and its own.
    pub(crate) fn names(&self) -> Taken {
        let mut taken = Taken::default();
        self.vars.iter().flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
        taken.take(&self.name.text);
        taken
    }

    pub(crate) fn is_chart(&self) -> bool {
        self.parts.iter().any(|p| matches!(p, Part::Step { .. } | Part::Transition(_)))
    }
}

/// Visits all statements, receptivities and actions of a unit.
pub(crate) fn each(unit: &mut Unit, v: &mut impl Visitor) {
    [&mut unit.before, &mut unit.body, &mut unit.after]
        .into_iter()
        .for_each(|list| visit_mut::stmts(list, v));
    for part in &mut unit.parts {
        match part {
            Part::Action { body, .. } => visit_mut::stmts(body, v),
            Part::Transition(t) => visit_mut::expr(&mut t.receptivity, v),
            Part::Step { associations, .. } => {
                for a in associations {
                    visit_mut::expr(&mut a.target, v);
                    a.time.iter_mut().for_each(|t| visit_mut::expr(t, v));
                }
            }
        }
    }
}

/// Renames variables; the old names are in upper case.
pub(crate) struct Renamed<'n>(pub(crate) &'n HashMap<String, String>);

impl Visitor for Renamed<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        let Some(first) = path.names.first_mut() else { return };
        let (bare, index) = g7_model::bare(&first.text);
        if let Some(own) = self.0.get(&bare.to_uppercase()) {
            first.text = format!("{own}{index}").into();
        }
    }
}

/// A name as it is compared.
pub(crate) fn upper(name: &Name) -> String {
    name.text.to_uppercase()
}

/// The name of the function that an expression or a statement calls, in upper case.
pub(crate) fn callee(path: &Path) -> Option<String> {
    match path.names.as_slice() {
        [name] => Some(upper(name)),
        _ => None,
    }
}
