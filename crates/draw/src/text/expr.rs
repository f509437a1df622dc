//! Expressions in the notation of GRAFCET: `·` for and, `+` for or, an overline for not, `[p > 3]`.

use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Operands, Path, UnaryOp, element_parts};

use crate::text::line::{Break, Line, Over};
use crate::text::{clean, duration};

/// The complement of an expression longer than this is written `¬(…)`, which can be broken.
const LONGEST_OVERLINE: usize = 48;

/// Sets an expression on one line.
pub(crate) fn set(e: &Expr) -> Line {
    let mut setter = Setter { line: Line::default(), fixed: 0 };
    setter.put(e, Level::Sum, 0);
    setter.line
}

/// Sets a receptivity; the one that is always true is written `1`.
pub(crate) fn receptivity(e: &Expr) -> Line {
    set(e)
}

/// How tightly an operator binds, from the loosest to the tightest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Sum,
    Exclusive,
    Product,
    Sign,
    Atom,
}

/// Builds a line.
pub(super) struct Setter {
    pub(super) line: Line,
    /// The number of enclosing overlines; the line has no break under an overline.
    fixed: u32,
}

impl Setter {
    pub(super) fn new() -> Setter {
        Setter { line: Line::default(), fixed: 0 }
    }

    pub(super) fn text(&mut self, text: &str) {
        self.line.text.push_str(text);
    }

    fn may_break(&mut self, depth: u32) {
        if self.fixed == 0 {
            self.line.breaks.push(Break { at: self.line.text.len(), depth });
        }
    }

    pub(super) fn expr(&mut self, e: &Expr, depth: u32) {
        self.put(e, Level::Sum, depth);
    }

    /// Writes an expression, in brackets if it binds more loosely than `least`.
    fn put(&mut self, e: &Expr, least: Level, depth: u32) {
        let level = level(e);
        if level < least {
            self.text("(");
            self.bare(e, depth + 1);
            self.text(")");
        } else {
            self.bare(e, depth);
        }
    }

    fn bare(&mut self, e: &Expr, depth: u32) {
        match &e.kind {
            ExprKind::Literal(l) => self.text(&literal(l)),
            ExprKind::Path(p) => self.text(&path(p)),
            ExprKind::Direct(d) => self.text(&format!("%{}", clean(d))),
            ExprKind::Unary(UnaryOp::Not, e) => self.complement(e, depth),
            ExprKind::Unary(op, e) => {
                self.text(match op {
                    UnaryOp::Rise => "↑",
                    UnaryOp::Fall => "↓",
                    UnaryOp::Neg | UnaryOp::Not => "−",
                });
                self.put(e, Level::Atom, depth + 1);
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, depth),
            ExprKind::Timer { t1, e, t2 } => {
                self.put(t1, Level::Atom, depth + 1);
                self.text("/");
                self.put(e, Level::Atom, depth + 1);
                if let Some(t2) = t2 {
                    self.text("/");
                    self.put(t2, Level::Atom, depth + 1);
                }
            }
            ExprKind::Call(p, args) => self.call(p, args, depth),
            ExprKind::Element(p, index, member) => {
                for (n, (names, index)) in element_parts(p, index).into_iter().enumerate() {
                    self.text(if n > 0 { "." } else { "" });
                    self.text(&path(&names));
                    if !index.is_empty() {
                        self.indexes(index.iter(), depth);
                    }
                }
                if let Some(member) = member {
                    self.text(&format!(".{}", clean(&member.text)));
                }
            }
            ExprKind::List(values) => self.indexes(values.iter().map(|(_, e)| e), depth),
            ExprKind::Bad => self.text("?"),
        }
    }

    /// `[i, j]`.
    fn indexes<'e>(&mut self, list: impl Iterator<Item = &'e Expr>, depth: u32) {
        for (i, e) in list.enumerate() {
            self.text(if i == 0 { "[" } else { ", " });
            self.put(e, Level::Sum, depth + 1);
        }
        self.text("]");
    }

    /// Writes the complement: an overline over the whole operand, one level above the overlines
    /// inside.
    fn complement(&mut self, e: &Expr, depth: u32) {
        let (from, first) = (self.line.text.len(), self.line.overs.len());
        let breaks = self.line.breaks.len();
        self.fixed += 1;
        self.put(e, Level::Sum, depth + 1);
        self.fixed -= 1;
        let to = self.line.text.len();
        let set = self.line.text.get(from..).unwrap_or("");
        if set.chars().count() > LONGEST_OVERLINE && self.fixed == 0 {
            self.line.text.truncate(from);
            self.line.overs.truncate(first);
            self.line.breaks.truncate(breaks);
            self.text("¬");
            let group = level(e) < Level::Atom || matches!(e.kind, ExprKind::Unary(..));
            self.text(if group { "(" } else { "" });
            self.bare(e, depth + 1);
            self.text(if group { ")" } else { "" });
            return;
        }
        let inside = self.line.overs.get(first..).unwrap_or(&[]);
        let level = 1 + inside.iter().map(|o| o.level).max().unwrap_or(0);
        self.line.overs.push(Over { from, to, level });
    }

    fn binary(&mut self, op: BinaryOp, a: &Expr, b: &Expr, depth: u32) {
        let row = op.row();
        match row.operands {
            Operands::Comparison => return self.comparison(op, a, b, depth),
            _ if op == BinaryOp::Pow => {
                self.put(a, Level::Atom, depth + 1);
                self.text(row.drawn);
                return self.put(b, Level::Atom, depth + 1);
            }
            Operands::Logic | Operands::Arithmetic => {}
        }
        let level = binary_level(op);
        // A product inside a sum is one level deeper.
        let inner = |e: &Expr| if is_chain(e, level) { depth } else { depth + 1 };
        self.put(a, level, inner(a));
        self.text(" ");
        self.may_break(depth);
        self.text(row.drawn);
        self.text(" ");
        let associative = !matches!(op, BinaryOp::Sub | BinaryOp::Div | BinaryOp::Mod) && !mixed(op, b);
        let least = if associative { level } else { next(level) };
        self.put(b, least, inner(b));
    }

    fn comparison(&mut self, op: BinaryOp, a: &Expr, b: &Expr, depth: u32) {
        self.text("[");
        self.put(a, Level::Sum, depth + 2);
        self.text(" ");
        self.text(op.row().drawn);
        self.text(" ");
        self.put(b, Level::Sum, depth + 2);
        self.text("]");
    }

    pub(super) fn call(&mut self, p: &Path, args: &[Arg], depth: u32) {
        self.text(&path(p));
        self.text("(");
        for (i, arg) in args.iter().enumerate() {
            if i > 0 {
                self.text(", ");
                self.may_break(depth + 2);
            }
            if let Some(name) = &arg.name {
                self.text(&clean(&name.text));
                self.text(if arg.output { " => " } else { " := " });
            }
            self.put(&arg.value, Level::Sum, depth + 3);
        }
        self.text(")");
    }
}

fn next(level: Level) -> Level {
    match level {
        Level::Sum => Level::Exclusive,
        Level::Exclusive => Level::Product,
        Level::Product => Level::Sign,
        Level::Sign | Level::Atom => Level::Atom,
    }
}

fn binary_level(op: BinaryOp) -> Level {
    match op {
        BinaryOp::Or | BinaryOp::Add | BinaryOp::Sub => Level::Sum,
        BinaryOp::Xor => Level::Exclusive,
        BinaryOp::Pow => Level::Sign,
        op if op.row().operands == Operands::Comparison => Level::Atom,
        _ => Level::Product,
    }
}

fn level(e: &Expr) -> Level {
    match &e.kind {
        ExprKind::Binary(op, ..) => binary_level(*op),
        // An overline binds what is under it.
        ExprKind::Unary(UnaryOp::Not, _) => Level::Atom,
        ExprKind::Unary(..) | ExprKind::Timer { .. } => Level::Sign,
        ExprKind::Literal(_)
        | ExprKind::Path(_)
        | ExprKind::Direct(_)
        | ExprKind::Call(..)
        | ExprKind::Element(..)
        | ExprKind::List(_)
        | ExprKind::Bad => Level::Atom,
    }
}

fn is_chain(e: &Expr, of: Level) -> bool {
    matches!(&e.kind, ExprKind::Binary(op, ..) if binary_level(*op) == of)
}

/// True if the right operand of `op` needs brackets although it binds equally: mixed arithmetic
/// operators are not associative.
fn mixed(op: BinaryOp, b: &Expr) -> bool {
    let ExprKind::Binary(inner, ..) = &b.kind else { return false };
    let logic = |op: BinaryOp| op.row().operands == Operands::Logic;
    *inner != op && !(logic(op) && logic(*inner))
}

/// A dotted name, as written.
pub(super) fn path(p: &Path) -> String {
    clean(&p.text())
}

fn literal(l: &Literal) -> String {
    match l {
        Literal::Bool(true) => "1".to_owned(),
        Literal::Bool(false) => "0".to_owned(),
        Literal::Int(n, None) => n.to_string().replace('-', "−"),
        Literal::Int(n, Some(ty)) => format!("{ty}#{n}"),
        Literal::Real(text, None) => clean(text),
        Literal::Real(text, Some(ty)) => format!("{ty}#{}", clean(text)),
        Literal::Time(time) => duration(*time),
        Literal::Moment(moment, time) => moment.literal(*time),
        Literal::Str(text) => format!("'{}'", clean(text)),
    }
}
