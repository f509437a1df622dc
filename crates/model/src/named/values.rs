//! The types of parameters, local variables and results: each holds one value.

use std::collections::HashMap;

use super::declare::Types;
use crate::{
    Block, Expr, ExprKind, Function, Name, Param, Path, Problem, Stmt, StmtKind, ValueType, VarDecl, VarKind,
    codes, say,
};

impl Types<'_> {
    pub(super) fn params(&mut self, params: &mut [Param]) {
        let none = HashMap::new();
        params.iter_mut().for_each(|p| _ = self.value_type(&mut p.ty, &p.name, &none));
    }

    /// The types of a function. Its result begins with the value that its type gives.
    pub(super) fn function(&mut self, f: &mut Function) {
        self.params(&mut f.params);
        let usual = self.value_type(&mut f.result, &f.name, &HashMap::new());
        if let Some(value) = usual.filter(|e| !self.is_zero(e)) {
            let at = f.name.at;
            let target = Expr { kind: ExprKind::Path(Path { names: vec![f.name.clone()] }), at };
            f.body.statements.insert(0, Stmt { kind: StmtKind::Assign { target, value }, at });
        }
    }

    /// The types of the local variables of a block. Each begins with the value that its type gives.
    pub(super) fn locals(&mut self, block: &mut Block, inner: &HashMap<&str, i128>) {
        for local in &mut block.locals {
            let Some(name) = local.names.first().cloned() else { continue };
            let usual = self.value_type(&mut local.ty, &name, inner);
            local.init = local.init.take().or(usual);
        }
    }

    /// Replaces the name of a declared type, or checks written bounds. Returns the value that something of this type begins
    /// with, if the type gives one. An array or a structure is reported.
    fn value_type(&mut self, ty: &mut ValueType, name: &Name, inner: &HashMap<&str, i128>) -> Option<Expr> {
        if ty.is_plain() {
            return None;
        }
        let written = ty.of.clone();
        let mut decl = VarDecl::of_type(VarKind::Var, vec![name.clone()], ty, name.at);
        self.apply(&mut decl, inner);
        self.known_name(&mut decl);
        *ty = ValueType { base: decl.ty, of: None, limits: decl.limits };
        if decl.of.is_none() && decl.array.is_none() {
            return decl.init;
        }
        ty.limits = None;
        let (of, at) = written.map_or((name.text.clone(), name.at), |of| (of.text, of.at));
        let what = say!("`{of}` has several values; a parameter, a local variable or a result has one");
        let help = say!("give it the type of one value, or write a `function block`");
        self.problems.push(Problem::new(&codes::BAD_DECLARATION, at.0, what).help(help));
        None
    }
}
