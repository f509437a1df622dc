//! Timers, monostables and counters of a rung.

use g7_model::{BinaryOp, Expr, Span, Type, codes, say};

use super::ladder::{Board, Ladder};
use super::project::Cell;
use super::variables::kind;
use g7_iec::nodes::{self, and, assign, binary, int, invoke, name, not, path, when};

/// The highest value of a counter; the next value is 0.
const FULL: i128 = 9999;

impl Ladder<'_, '_> {
    /// An element of two columns: its inputs are one column before it.
    pub(super) fn block(&mut self, board: &mut Board, cell: &Cell, x: usize, y: usize) {
        let Some(before) = x.checked_sub(1) else {
            self.report.say(&codes::BAD_VALUE, &cell.at, say!("a block without room for its inputs"));
            return;
        };
        match cell.kind {
            10 => self.timer(board, cell, (before, y)),
            11 => self.standard(board, cell, (before, y), (kind::MONOSTABLE_RUNNING, cell.var.1)),
            12 => self.counter(board, cell, (before, y)),
            13 => self.standard(board, cell, (before, y), (kind::IEC_DONE, cell.var.1)),
            _ => self.report.say(
                &codes::NOT_CARRIED,
                &cell.at,
                say!("a register (FIFO or LIFO) has no counterpart"),
            ),
        }
    }

    /// The old timer counts down while both inputs are on. If the second input is on whenever the
    /// first is, it is an on-delay.
    fn timer(&mut self, board: &mut Board, cell: &Cell, (before, y): (usize, usize)) {
        let at = self.report.span(&cell.at);
        let enable = board.left(before, y, at);
        let control = board.left(before, y + 1, at);
        if nodes::truth(&control) != Some(true) && control != enable {
            let what = say!("a timer whose second input holds it; it runs on here");
            self.report.say(&codes::NOT_CARRIED, &cell.at, what);
        }
        self.standard(board, cell, (before, y), (kind::TIMER_DONE, cell.var.1));
        let running = self.vars.boolean((kind::TIMER_RUNNING, cell.var.1), &cell.at, self.report);
        self.pass(board, before + 1, y + 1, running);
    }

    /// On-delay, off-delay and pulse timers: the function blocks of the standard.
    fn standard(&mut self, board: &mut Board, cell: &Cell, (before, y): (usize, usize), key: (u16, u32)) {
        let at = self.report.span(&cell.at);
        let input = board.left(before, y, at);
        let letters = match key.0 {
            kind::TIMER_DONE => "T",
            kind::MONOSTABLE_RUNNING => "M",
            _ => "TM",
        };
        let ty = self.vars.timer_kind(key);
        let block = self.vars.block(letters, key.1, ty, &cell.at, self.report);
        let preset = self.vars.preset_time(key, &cell.at, self.report);
        let call = invoke(path(&[&block], at), vec![("IN", input), ("PT", preset)], at);
        self.write(board, std::slice::from_ref(&block), call);
        self.pass(board, before + 1, y, name(&[&block, "Q"], at));
    }

    /// Four inputs: reset, preset, up, down; three outputs: empty, done, full.
    fn counter(&mut self, board: &mut Board, cell: &Cell, (before, y): (usize, usize)) {
        let at = self.report.span(&cell.at);
        let number = cell.var.1;
        let value = self.vars.counter_part((kind::COUNTER_VALUE, number), &cell.at, self.report);
        let preset = self.vars.counter_part((kind::COUNTER_PRESET, number), &cell.at, self.report);
        let mut part = |suffix: &str, ty: Type| {
            let part = format!("C{number}_{suffix}");
            self.vars.part(&part, ty, 0, at);
            part
        };
        let (old, up, down) = (part("old", Type::Dint), part("up", Type::Bool), part("down", Type::Bool));
        let (done, empty, full) = (part("D", Type::Bool), part("E", Type::Bool), part("F", Type::Bool));
        let v = || name(&[&value], at);
        let set = |to: Expr| vec![assign(name(&[&old], at), v(), at), assign(v(), to, at)];
        let count = |op, limit: i128, around: i128| {
            let next = binary(op, v(), int(1, at), at);
            let past = binary(if limit > 0 { BinaryOp::Gt } else { BinaryOp::Lt }, v(), int(limit, at), at);
            let mut body = set(next);
            body.push(when(past, vec![assign(v(), int(around, at), at)], Vec::new(), at));
            body
        };
        let inputs: Vec<Expr> = (0..4).map(|n| board.left(before, y + n, at)).collect();
        let [reset, load, rise, fall] =
            <[Expr; 4]>::try_from(inputs).unwrap_or_else(|_| [0; 4].map(|_| nodes::bad(at)));
        let fresh = |e: &Expr, old: &str| and(e.clone(), not(name(&[old], at), at), at);
        let statements = vec![
            when(fresh(&rise, &up), count(BinaryOp::Add, FULL, 0), Vec::new(), at),
            when(fresh(&fall, &down), count(BinaryOp::Sub, 0, FULL), Vec::new(), at),
            when(load, set(name(&[&preset], at)), Vec::new(), at),
            when(reset, set(int(0, at)), Vec::new(), at),
            assign(name(&[&up], at), rise, at),
            assign(name(&[&down], at), fall, at),
            assign(name(&[&done], at), binary(BinaryOp::Eq, v(), name(&[&preset], at), at), at),
            assign(name(&[&empty], at), both(&value, FULL, &old, 0, at), at),
            assign(name(&[&full], at), both(&value, 0, &old, FULL, at), at),
        ];
        let names = [value.clone(), old.clone(), done.clone(), empty.clone(), full.clone()];
        for stmt in statements {
            self.write(board, &names, stmt);
        }
        for (n, part) in [empty, done, full].iter().enumerate() {
            self.pass(board, before + 1, y + n, name(&[part], at));
        }
    }
}

/// `value = a and old = b`.
fn both(value: &str, a: i128, old: &str, b: i128, at: Span) -> Expr {
    let is = |n: &str, to| binary(BinaryOp::Eq, name(&[n], at), int(to, at), at);
    and(is(value, a), is(old, b), at)
}
