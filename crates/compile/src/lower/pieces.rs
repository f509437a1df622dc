//! Pieces of code at their places in the table.
//!
//! A piece is written by `emit` with jumps counted from its own start; here they
//! are counted from the start of the table. The tree of each piece is kept beside
//! it, by its first instruction.

use g7_engine::{Code, Op, Program};

use super::emit::Buf;
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
        let code = append(&mut self.t.code, &b.ops);
        self.places.extend_from_slice(&b.places);
        b.clear();
        self.buf = b;
        if !code.is_empty() {
            self.pieces.push((code.start, piece));
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

/// Moves instructions, whose jumps are counted from their own start, to the end of a table.
fn append(table: &mut Vec<Op>, ops: &[Op]) -> Code {
    let start = table.len() as u32;
    table.extend(ops.iter().map(|op| match *op {
        Op::Jump(to) => Op::Jump(to + start),
        Op::JumpUnless(to) => Op::JumpUnless(to + start),
        other => other,
    }));
    Code { start, end: table.len() as u32 }
}

/// The same program with further code, a piece for each expression, for `engine::eval`. The expressions are those of
/// the program's own code or parts of them, so both programs have states of one form: the code runs on a state of the
/// first. `None` where the engine does not take so much code.
pub fn with_parts<'e>(
    program: &Program,
    parts: impl Iterator<Item = &'e Expr>,
) -> Option<(Program, Vec<Code>)> {
    let (mut tables, mut buf) = (program.tables().clone(), Buf::default());
    let mut place = |part: &Expr| {
        buf.clear();
        buf.expr(part);
        append(&mut tables.code, &buf.ops)
    };
    let codes = parts.map(&mut place).collect();
    Some((Program::new(tables).ok()?, codes))
}
