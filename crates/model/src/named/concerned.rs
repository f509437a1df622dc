//! Tells if a document has enumerations, bounds or names of types, so that `declare.rs` and `held.rs` must look at it.

use crate::visit::Visitor;
use crate::{Document, Expr, Item, Name, Order, Span, Stmt, ValueType, VarDecl};

/// True for a document that declares types, or in which something has bounds or names a type.
pub(super) fn is_concerned(document: &Document) -> bool {
    let limited = |v: &VarDecl| v.limits.is_some();
    let concerned = |i: &Item| match i {
        Item::Type(_) => true,
        Item::Var(v) => limited(v),
        Item::Chart(c) => c.vars().any(limited),
        Item::Composed(c) => c.members.iter().chain(&c.inouts).any(limited),
        _ => false,
    };
    document.items.iter().any(concerned) || has_value_type(document)
}

/// True if a parameter, a local variable or a result has bounds or names a type.
fn has_value_type(document: &Document) -> bool {
    let mut looking = Looking(false);
    looking.document(document);
    looking.0
}

/// Looks at types and passes over all else.
struct Looking(bool);

impl<'d> Visitor<'d> for Looking {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}

    fn value_type(&mut self, ty: &'d ValueType) {
        self.0 |= !ty.is_plain();
    }

    fn expr(&mut self, _: &'d Expr) {}

    fn statement(&mut self, _: &'d Stmt) {}
}
