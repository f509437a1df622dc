//! A call of the instance that an index chooses: a CASE with the call of each instance.
//!
//! In an arm the index has one value. So the index of another array that follows from it (`order[i]` beside
//! `control[i]`) is a number there.

use super::base::{Composition, Loop};
use crate::visit_mut::{self, Use, Visitor};
use crate::{Arg, BinaryOp, Expr, ExprKind, Index, Literal, Name, Path, Span, Stmt, StmtKind, instance_of};

/// A variable with a value.
#[derive(Clone, Copy)]
pub(super) struct Known<'n> {
    name: &'n str,
    value: i128,
}

impl<'n> Known<'n> {
    /// Solves an index for its variable: if the index `i + 1` has the value 3, `i` is 2.
    pub(super) fn of(index: &'n Expr, value: i128) -> Option<Known<'n>> {
        match &index.kind {
            ExprKind::Path(path) => match path.names.as_slice() {
                [name] => Some(Known { name: &name.text, value }),
                _ => None,
            },
            ExprKind::Binary(BinaryOp::Add, a, b) => Known::of(a, value.checked_sub(b.kind.whole()?)?),
            ExprKind::Binary(BinaryOp::Sub, a, b) => Known::of(a, value.checked_add(b.kind.whole()?)?),
            _ => None,
        }
    }

    /// The arguments with numbers for the indexes that follow from the value.
    pub(super) fn arguments(self, args: &[Arg]) -> Vec<Arg> {
        let mut args = args.to_vec();
        for arg in &mut args {
            if let ExprKind::Path(path) = &mut arg.value.kind {
                self.path(path);
            }
            visit_mut::expr(&mut arg.value, &mut Fixed(self));
        }
        args
    }

    fn path(self, path: &mut Path) {
        for name in &mut path.names {
            let Some((bare, Index::Parameter(parameter, added))) = instance_of(&name.text) else { continue };
            if parameter == self.name {
                let number = self.value + i128::from(added);
                *name = Name { text: format!("{bare}[{number}]").into(), at: name.at };
            }
        }
    }

    fn index(self, e: &Expr) -> Option<i128> {
        match &e.kind {
            ExprKind::Path(path) => match path.names.as_slice() {
                [name] if *name.text == *self.name => Some(self.value),
                _ => None,
            },
            ExprKind::Binary(BinaryOp::Add, a, b) => self.index(a)?.checked_add(b.kind.whole()?),
            ExprKind::Binary(BinaryOp::Sub, a, b) => self.index(a)?.checked_sub(b.kind.whole()?),
            _ => None,
        }
    }
}

/// Puts numbers in the place of indexes.
struct Fixed<'n>(Known<'n>);

impl Visitor for Fixed<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        self.0.path(path);
    }

    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Element(_, index, _) = &mut e.kind else { return };
        for i in index {
            if let Some(n) = self.0.index(i) {
                i.kind = ExprKind::Literal(Literal::Int(n, None));
            }
        }
    }
}

impl Composition<'_> {
    /// Begins the statements of a FOR, whose first and last values are known if it is an ordinary one.
    pub(super) fn enter_loop(&mut self, var: &Name, from: Option<i128>, to: Option<i128>, body: &[Stmt]) {
        let (least, most) = match (from, to) {
            (Some(from), Some(to)) if !body.iter().any(|s| assigns(s, &var.text)) => (from, to),
            _ => (i128::MIN, i128::MAX),
        };
        self.loops.push(Loop { name: var.text.clone(), least, most });
    }

    /// Ends them.
    pub(super) fn leave_loop(&mut self) {
        self.loops.pop();
    }

    /// True if an index that is not known is within these bounds all the same: it is the variable of a FOR.
    pub(super) fn stays_within(&self, index: &Expr, least: i128, most: i128) -> bool {
        let (Some(low), Some(high)) = (Known::of(index, least), Known::of(index, most)) else { return false };
        let inner = self.loops.iter().rev().find(|l| *l.name == *low.name);
        inner.is_some_and(|l| low.value <= l.least && l.most <= high.value)
    }
}

/// True if a statement may give a variable a value.
fn assigns(s: &Stmt, name: &str) -> bool {
    let within = |list: &[Stmt]| list.iter().any(|s| assigns(s, name));
    let is =
        |e: &Expr| matches!(&e.kind, ExprKind::Path(p) if p.names.first().is_some_and(|n| &*n.text == name));
    match &s.kind {
        StmtKind::Assign { target, .. } => is(target),
        // A parameter may stand for the variable.
        StmtKind::Call(_, args) => args.iter().any(|a| is(&a.value)),
        StmtKind::If(arms, otherwise) => arms.iter().any(|(_, body)| within(body)) || within(otherwise),
        StmtKind::Case(_, arms, otherwise) => arms.iter().any(|a| within(&a.body)) || within(otherwise),
        StmtKind::For { var, body, .. } => &*var.text == name || within(body),
        StmtKind::While(_, body) | StmtKind::Repeat(body, _) => within(body),
        StmtKind::Exit | StmtKind::Return => false,
    }
}
