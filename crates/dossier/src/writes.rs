//! The places at which a name is written: as the target of an assignment, of a qualifier or of an output of a call, and
//! where a function block is called, which changes it.

use std::collections::HashSet;

use g7_model::visit::Visitor;
use g7_model::{
    Action, ActionKind, Arg, Document, Expr, ExprKind, Name, Order, Path, Span, Stmt, StmtKind, Target,
    TestStmt, TestStmtKind,
};

/// Finds the names that are written.
#[derive(Default)]
struct Writes {
    found: HashSet<Span>,
}

/// The places of all names that are written.
pub(crate) fn writes(document: &Document) -> HashSet<Span> {
    let mut all = Writes::default();
    all.document(document);
    all.found
}

impl Writes {
    fn names(&mut self, names: &[Name]) {
        self.found.extend(names.iter().map(|n| n.at.0));
    }

    fn target(&mut self, e: &Expr) {
        match &e.kind {
            ExprKind::Path(path) => self.names(&path.names),
            ExprKind::Element(path, ..) => self.names(&path.names),
            ExprKind::Direct(_) => {
                self.found.insert(e.at.0);
            }
            _ => {}
        }
    }
}

impl<'d> Visitor<'d> for Writes {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, order: &'d Order) {
        if let Order::Mask(name) = order {
            self.names(std::slice::from_ref(name));
        }
    }

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.names(&path.names);
        for arg in args {
            if arg.output {
                self.target(&arg.value);
            }
            self.expr(&arg.value);
        }
    }

    fn statement(&mut self, s: &'d Stmt) {
        match &s.kind {
            StmtKind::Assign { target, .. } => self.target(target),
            StmtKind::For { var, .. } => self.names(std::slice::from_ref(var)),
            _ => {}
        }
        Walk(self).statement(s);
    }

    fn action(&mut self, action: &'d Action) {
        if let ActionKind::Qualified { target, .. } = &action.kind {
            match target {
                Target::Path(path) => self.names(&path.names),
                Target::Element(element) => self.target(element),
                Target::Direct(_, at) => {
                    self.found.insert(at.0);
                }
                Target::Work(_) => {}
            }
        }
        Walk(self).action(action);
    }

    fn test(&mut self, s: &'d TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => list.iter().for_each(|(target, _)| self.target(target)),
            TestStmtKind::Pulse(target, _)
            | TestStmtKind::Force(target, _)
            | TestStmtKind::Release(target) => {
                self.target(target);
            }
            TestStmtKind::Always(_, body) | TestStmtKind::Repeat(_, body) => {
                body.iter().for_each(|s| self.test(s));
            }
            _ => {}
        }
    }
}

/// Visits what is inside of an element whose own names [`Writes`] has already found.
struct Walk<'w>(&'w mut Writes);

impl<'d> Visitor<'d> for Walk<'_> {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, order: &'d Order) {
        self.0.order(order);
    }

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.0.call(path, args);
    }

    fn statements(&mut self, list: &'d [Stmt]) {
        list.iter().for_each(|s| self.0.statement(s));
    }

    fn work(&mut self, work: &'d g7_model::Work) {
        work.statements().iter().for_each(|s| self.0.statement(s));
    }
}
