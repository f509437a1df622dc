//! Makes pieces of a document, each with the place in the author's text that it comes from.

use g7_model::{
    Arg, BinaryOp, Expr, ExprKind, Literal, Name, Path, Place, Stmt, StmtKind, Type, UnaryOp, VarDecl,
    VarKind,
};

/// Makes nodes that all stand at one place.
#[derive(Clone, Copy)]
pub(super) struct At(pub(super) Place);

impl At {
    pub(super) fn name(self, text: &str) -> Name {
        Name { text: text.into(), at: self.0 }
    }

    pub(super) fn expr(self, kind: ExprKind) -> Expr {
        Expr { kind, at: self.0 }
    }

    /// A variable by its full name with its dots. An author cannot write such a name, so it never
    /// collides with one of theirs.
    pub(super) fn var(self, name: &str) -> Expr {
        self.expr(ExprKind::Path(Path { names: vec![self.name(name)] }))
    }

    pub(super) fn int(self, value: i128) -> Expr {
        self.expr(ExprKind::Literal(Literal::Int(value, None)))
    }

    pub(super) fn bool(self, value: bool) -> Expr {
        self.expr(ExprKind::Literal(Literal::Bool(value)))
    }

    pub(super) fn real(self, text: &str) -> Expr {
        self.expr(ExprKind::Literal(Literal::Real(text.into(), None)))
    }

    pub(super) fn binary(self, op: BinaryOp, a: Expr, b: Expr) -> Expr {
        self.expr(ExprKind::Binary(op, Box::new(a), Box::new(b)))
    }

    pub(super) fn not(self, e: Expr) -> Expr {
        self.expr(ExprKind::Unary(UnaryOp::Not, Box::new(e)))
    }

    /// A function by its name, arguments by position.
    pub(super) fn call(self, function: &str, args: Vec<Expr>) -> Expr {
        let args = args.into_iter().map(|value| Arg::input(None, value)).collect();
        self.expr(ExprKind::Call(Path { names: vec![self.name(function)] }, args))
    }

    pub(super) fn stmt(self, kind: StmtKind) -> Stmt {
        Stmt { kind, at: self.0 }
    }

    pub(super) fn assign(self, name: &str, value: Expr) -> Stmt {
        self.stmt(StmtKind::Assign { target: self.var(name), value })
    }

    pub(super) fn when(self, condition: Expr, then: Vec<Stmt>) -> Stmt {
        self.stmt(StmtKind::If(vec![(condition, then)], Vec::new()))
    }

    pub(super) fn zero(self, ty: Type) -> Expr {
        Expr::zero(ty, self.0)
    }

    pub(super) fn declare(self, kind: VarKind, name: &str, ty: Type, init: Option<Expr>) -> VarDecl {
        VarDecl { init, ..VarDecl::new(kind, vec![self.name(name)], ty, self.0) }
    }
}
