//! Elements with a variable index: of a table, and of variables that follow one another.
//!
//! It stands beside `code`, which makes expressions and statements and calls it. `within` comes first: it leaves the
//! fault `range` for an index outside of its bounds, so that the other functions need not look at them.

use g7_engine::{Addr, Cmp, FaultKind};
use g7_model::{Span, Type};

use crate::code::Body;
use crate::form::{Expr, Stmt};

impl Body<'_, '_> {
    /// The index, behind a check that it is from 0 to below the length.
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

    /// The value of one of several variables; the index is less than their number. It is copied by a row of IF, since
    /// not every language has MUX.
    pub(crate) fn choice(&mut self, ty: Type, base: Addr, len: u32, index: &Expr) -> Expr {
        let chosen = self.m.temporary(ty);
        for k in 0..len {
            let value = self.read(ty, Addr(base.0 + k));
            let here = index.clone().compare(Cmp::Eq, Type::Lint, Expr::long(k.into()));
            self.out.extend(Stmt::when(here, vec![Stmt::Set(chosen, value)]));
        }
        Expr::Read(chosen)
    }

    /// Writes one of several variables; the index is less than their number.
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
