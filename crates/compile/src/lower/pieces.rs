//! Pieces of code at their places in the table.
//!
//! A piece is written by `emit` with jumps counted from its own start; here they
//! are counted from the start of the table. The tree of each piece is kept beside
//! it, by its first instruction.

use g7_engine::{Code, Op};

use super::work::Lower;
use crate::tree::{Expr, Piece, Stmt};

impl Lower<'_> {
    /// The code of an expression.
    pub(super) fn value(&mut self, e: Expr) -> Code {
        self.place(Piece::Value(e))
    }

    /// The code of statements; empty where there are none.
    pub(super) fn work(&mut self, list: Vec<Stmt>) -> Code {
        self.place(Piece::Work(list))
    }

    /// Writes a piece at the end of the table.
    fn place(&mut self, piece: Piece) -> Code {
        let mut b = std::mem::take(&mut self.buf);
        b.piece(&piece);
        let start = self.t.code.len() as u32;
        self.t.code.extend(b.ops.iter().map(|op| match *op {
            Op::Jump(to) => Op::Jump(to + start),
            Op::JumpUnless(to) => Op::JumpUnless(to + start),
            other => other,
        }));
        self.places.extend_from_slice(&b.places);
        b.clear();
        self.buf = b;
        let code = Code { start, end: self.t.code.len() as u32 };
        if !code.is_empty() {
            self.pieces.push((start, piece));
        }
        code
    }

    /// The instructions of an expression alone, to compare it with others.
    pub(super) fn ops(&mut self, e: &Expr) -> Vec<Op> {
        self.buf.expr(e);
        let ops = self.buf.ops.clone();
        self.buf.clear();
        ops
    }
}
