//! Runs of statements that say the same of one row after the other, as loops.

use crate::tree::{Block, Expr, Stmt};

/// Statements from which on a loop is shorter to read.
const RUN: usize = 4;
/// The loop's variable.
const ROW: &str = "i";

/// The same statements; `number` gives the value of a name that stands for a row.
pub(crate) fn roll(block: Block, number: &dyn Fn(&str) -> Option<usize>) -> Block {
    let mut out = Block::new();
    let mut rest = block.as_slice();
    while let Some((first, behind)) = rest.split_first() {
        let run = behind.first().and_then(|second| Run::of(first, second, number));
        let length = run.as_ref().map_or(0, |run| run.length(rest, number));
        match run {
            Some(run) if length >= RUN => {
                let (from, to) = (Expr::size(run.from), Expr::size(run.from + length));
                out.push(Stmt::For(ROW.into(), from, to, vec![run.each]));
                rest = rest.get(length..).unwrap_or_default();
            }
            _ => {
                out.push(first.clone());
                rest = behind;
            }
        }
    }
    out
}

/// A statement with the loop's variable in place of its row.
struct Run {
    each: Stmt,
    from: usize,
}

impl Run {
    fn of(first: &Stmt, second: &Stmt, number: &dyn Fn(&str) -> Option<usize>) -> Option<Run> {
        let mut general = General { number, from: None };
        let each = general.stmt(first, second)?;
        Some(Run { each, from: general.from? })
    }

    /// How many statements from the first on are of the run.
    fn length(&self, list: &[Stmt], number: &dyn Fn(&str) -> Option<usize>) -> usize {
        let fits = |(k, s): &(usize, &Stmt)| {
            let mut general = General { number, from: Some(self.from + k) };
            general.is(&self.each, s)
        };
        list.iter().enumerate().take_while(fits).count()
    }
}

/// The comparison of two statements, row by row.
struct General<'n> {
    number: &'n dyn Fn(&str) -> Option<usize>,
    from: Option<usize>,
}

impl General<'_> {
    fn row(&self, e: &Expr) -> Option<usize> {
        match e {
            Expr::Int(n, _) => usize::try_from(*n).ok(),
            Expr::Name(name) => (self.number)(name),
            _ => None,
        }
    }

    /// A statement over the loop's variable that is `a` in one row and `b` in the next.
    fn stmt(&mut self, a: &Stmt, b: &Stmt) -> Option<Stmt> {
        match (a, b) {
            (Stmt::Assign(op, to, value), Stmt::Assign(op2, to2, value2)) if op == op2 => {
                Some(Stmt::Assign(*op, self.expr(to, to2)?, self.expr(value, value2)?))
            }
            (Stmt::If(c, then, other), Stmt::If(c2, then2, other2)) => {
                Some(Stmt::If(self.expr(c, c2)?, self.block(then, then2)?, self.block(other, other2)?))
            }
            _ => None,
        }
    }

    fn block(&mut self, a: &[Stmt], b: &[Stmt]) -> Option<Block> {
        if a.len() != b.len() {
            return None;
        }
        a.iter().zip(b).map(|(a, b)| self.stmt(a, b)).collect()
    }

    fn expr(&mut self, a: &Expr, b: &Expr) -> Option<Expr> {
        match (a, b) {
            _ if a == b => Some(a.clone()),
            (Expr::Index(of, i), Expr::Index(of2, j)) if of == of2 => {
                let (i, j) = (self.row(i)?, self.row(j)?);
                let is_next = j == i + 1 && *self.from.get_or_insert(i) == i;
                is_next.then(|| (**of).clone().at(Expr::name(ROW)))
            }
            (Expr::Un(op, x), Expr::Un(op2, y)) if op == op2 => Some(Expr::Un(*op, self.boxed(x, y)?)),
            (Expr::Bin(op, x, y), Expr::Bin(op2, x2, y2)) if op == op2 => {
                Some(Expr::Bin(*op, self.boxed(x, x2)?, self.boxed(y, y2)?))
            }
            _ => None,
        }
    }

    fn boxed(&mut self, a: &Expr, b: &Expr) -> Option<Box<Expr>> {
        self.expr(a, b).map(Box::new)
    }

    /// A statement is the general one in the row at hand.
    fn is(&mut self, each: &Stmt, s: &Stmt) -> bool {
        match (each, s) {
            (Stmt::Assign(op, to, value), Stmt::Assign(op2, to2, value2)) => {
                op == op2 && self.fits(to, to2) && self.fits(value, value2)
            }
            (Stmt::If(c, then, other), Stmt::If(c2, then2, other2)) => {
                self.fits(c, c2) && self.all(then, then2) && self.all(other, other2)
            }
            _ => false,
        }
    }

    fn all(&mut self, a: &[Stmt], b: &[Stmt]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| self.is(a, b))
    }

    fn fits(&mut self, each: &Expr, e: &Expr) -> bool {
        match (each, e) {
            (Expr::Index(of, i), Expr::Index(of2, j)) if **i == Expr::name(ROW) => {
                of == of2 && self.row(j) == self.from
            }
            (Expr::Un(op, x), Expr::Un(op2, y)) => op == op2 && self.fits(x, y),
            (Expr::Bin(op, x, y), Expr::Bin(op2, x2, y2)) => {
                op == op2 && self.fits(x, x2) && self.fits(y, y2)
            }
            _ => each == e,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lower(field: &str, row: Expr) -> Stmt {
        Stmt::set(Expr::name(field).at(row), Expr::Bool(false))
    }

    #[test]
    fn rows_that_follow_one_another_become_a_loop() {
        let number = |name: &str| name.strip_prefix("STEP_").and_then(|n| n.parse().ok());
        let rows =
            |range: std::ops::Range<usize>| range.map(|i| lower("on", Expr::name(format!("STEP_{i}"))));
        let loop_ = |from, to| {
            let each = vec![lower("on", Expr::name(ROW))];
            Stmt::For(ROW.into(), Expr::size(from), Expr::size(to), each)
        };
        assert_eq!(roll(rows(0..5).collect(), &number), [loop_(0, 5)]);
        assert_eq!(roll(rows(0..3).collect(), &number), rows(0..3).collect::<Block>());
        let gap: Block = rows(0..4).chain(rows(5..9)).collect();
        assert_eq!(roll(gap, &number), [loop_(0, 4), loop_(5, 9)]);
        let other: Block = rows(0..4).chain([lower("off", Expr::size(4))]).collect();
        assert_eq!(roll(other, &number), [loop_(0, 4), lower("off", Expr::size(4))]);
        // Two rows that go on at different distances are no run.
        let two = |i: usize, j: usize| {
            Stmt::set(Expr::name("a").at(Expr::size(i)), Expr::name("b").at(Expr::size(j)))
        };
        let apart: Block = (0..6).map(|i| two(i, i + 1)).collect();
        assert_eq!(roll(apart.clone(), &number), apart);
    }
}
