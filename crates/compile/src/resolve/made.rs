//! Functions that the compiler makes at their first call: what a standard function does is written as statements, so that no
//! later stage knows of it (decisions 57 and 65).

use g7_engine::Builtin;
use g7_model::{Span, Type};

use super::resolver::Resolver;
use crate::ir::{
    BinaryOp, Expr, ExprKind, Function, FunctionId, Stmt, StmtKind, Target, Value, VarClass, VarId,
};

impl Resolver<'_, '_> {
    /// The function of this name with one input, made if it is not there yet. `body` gets the input and assigns the result. The
    /// name has an `@`, which no name of an author has.
    pub(super) fn made(
        &mut self,
        name: &str,
        (from, to): (Type, Type),
        at: Span,
        body: impl FnOnce(&mut Self, VarId, VarId) -> Vec<(VarId, Expr)>,
    ) -> FunctionId {
        if let Some(known) = self.unit.functions.iter().position(|f| *f.name == *name) {
            return FunctionId(known as u32);
        }
        let input = self.local(&format!("{name}.IN"), from, at);
        let result = self.local(name, to, at);
        let assigned = body(self, input, result);
        let statement = |(v, value)| Stmt { kind: StmtKind::Assign(Target::Var(v), value), at };
        let statements = assigned.into_iter().map(statement).collect();
        let id = FunctionId(self.unit.functions.len() as u32);
        self.scopes.params.push(vec!["IN"]);
        self.unit.functions.push(Function { name: name.into(), params: vec![input], result, statements, at });
        id
    }

    /// A variable of such a function.
    pub(super) fn local(&mut self, name: &str, ty: Type, at: Span) -> VarId {
        self.add_var(name.into(), VarClass::Local, ty, at)
    }
}

/// A whole number, a bit string or a duration.
pub(super) fn constant(n: i128, ty: Type, at: Span) -> Expr {
    Expr { kind: ExprKind::Const(Value::Int(n)), ty, at }
}

/// An operator; both operands have one type.
pub(super) fn binary(op: BinaryOp, a: Expr, b: Expr, ty: Type, at: Span) -> Expr {
    Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), ty, at }
}

/// A comparison with a number.
pub(super) fn compare(op: BinaryOp, a: Expr, n: i128, at: Span) -> Expr {
    let b = constant(n, a.ty, at);
    binary(op, a, b, Type::Bool, at)
}

/// SEL: the first value, or the second one where the condition is true.
pub(super) fn choice(condition: Expr, no: Expr, yes: Expr, at: Span) -> Expr {
    let ty = no.ty;
    Expr { kind: ExprKind::Builtin(Builtin::Sel, vec![condition, no, yes]), ty, at }
}

/// The value, or the fault `range` where the condition is true: of the inputs 0 and 1 of a MUX the third is chosen.
pub(super) fn unless(wrong: Expr, value: Expr, at: Span) -> Expr {
    let long = |n: i128| constant(n, Type::Lint, at);
    let chosen = choice(wrong, long(0), long(2), at);
    let (ty, zero) = (value.ty, constant(0, value.ty, at));
    Expr { kind: ExprKind::Builtin(Builtin::Mux, vec![chosen, value, zero]), ty, at }
}
