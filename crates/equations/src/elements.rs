//! Elements that the run chooses: of a table, and of variables that follow one another.
//!
//! It stands beside `code`, which makes expressions and statements. An index is within its bounds behind
//! `within`, else the fault `range` is left.

use g7_engine::{Addr, Cmp, FaultKind};
use g7_model::{Span, Type};

use crate::code::Body;
use crate::form::{Expr, Stmt};

impl Body<'_, '_> {
    pub(crate) fn within(&mut self, index: Expr, len: u32, at: Span) -> Expr {
        if let Expr::Const(_, v) = index
            && v < u64::from(len)
        {
            return index;
        }
        let index = self.simple(index, Type::Lint);
        let below = index.clone().compare(Cmp::Lt, Type::Lint, Expr::long(0));
        let above = index.clone().compare(Cmp::Ge, Type::Lint, Expr::long(len.into()));
        self.fault(below.or(above), FaultKind::Range, at);
        index
    }

    /// One of several variables, by an index within their number. Statements choose it, since not every
    /// language has a function that does.
    pub(crate) fn choice(&mut self, ty: Type, base: Addr, len: u32, index: &Expr) -> Expr {
        let chosen = self.m.temporary(ty);
        for k in 0..len {
            let value = self.read(ty, Addr(base.0 + k));
            let here = index.clone().compare(Cmp::Eq, Type::Lint, Expr::long(k.into()));
            self.out.extend(Stmt::when(here, vec![Stmt::Set(chosen, value)]));
        }
        Expr::Read(chosen)
    }

    /// Writes one of several variables, by an index within their number.
    pub(crate) fn store_chosen(&mut self, ty: Type, base: Addr, len: u32, index: Expr, value: Expr) {
        let value = self.simple(value, ty);
        for k in 0..len {
            let (memory, _) = self.m.word(Addr(base.0 + k), ty);
            let before = self.out.len();
            self.store(memory, None, value.clone());
            let then = self.out.split_off(before);
            let chosen = index.clone().compare(Cmp::Eq, Type::Lint, Expr::long(k.into()));
            self.out.extend(Stmt::when(chosen, then));
        }
    }
}
