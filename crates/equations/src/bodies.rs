//! The code of a chart piece by piece, for printers whose evolution is not that
//! of the equations: the structured style, which walks over the active steps.
//!
//! # Invariants
//!
//! - A piece says the same here and in the equations: both come from `code.rs`.
//! - Activity of a group and the reset of all times stay what they stand for
//!   ([`What::GroupActive`], [`What::ResetTimes`]): the runtime keeps them.

use g7_compile::Compiled;
use g7_engine::{Addr, Code};
use g7_model::Type;

use crate::form::{Expr, Memory, MemoryId, Stmt};
use crate::make::Make;

/// The pieces of a chart's code.
pub struct Bodies<'a> {
    m: Make<'a>,
}

impl<'a> Bodies<'a> {
    /// Those of a compiled chart.
    pub fn new(compiled: &'a Compiled) -> Bodies<'a> {
        Bodies { m: Make::apart(compiled) }
    }

    /// A memory that some piece reads or writes.
    pub fn memory(&self, id: MemoryId) -> Option<&Memory> {
        self.m.of(id)
    }

    /// The memory in which a word of the chart's variables lies.
    pub fn word(&mut self, addr: Addr, ty: Type) -> MemoryId {
        self.m.word(addr, ty).0
    }

    /// The value of code: statements, then an expression. Empty code is TRUE.
    pub fn value(&mut self, code: Code) -> (Vec<Stmt>, Expr) {
        self.m.value(code)
    }

    /// The statements of a section.
    pub fn work(&mut self, code: Code) -> Vec<Stmt> {
        self.m.work(code)
    }

    /// An action (rank) where it runs, with its condition and its period.
    pub fn action(&mut self, action: u32) -> Vec<Stmt> {
        self.m.run(action)
    }

    /// The same where all actions of a pass read the values from before it: it
    /// works on copies, and what it wrote is noted in [`crate::What::Given`].
    pub fn action_apart(&mut self, action: u32) -> Vec<Stmt> {
        self.m.run_apart(action)
    }

    /// The lasting memories that code writes.
    pub fn written(&mut self, code: Code) -> Vec<MemoryId> {
        self.m.written(code)
    }
}
