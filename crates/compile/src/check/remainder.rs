//! Finds divisions of two whole numbers, both written out, that lose a remainder: `7/2` is 3.
//!
//! Divisions of variables are left alone: there the whole quotient is what one mostly wants.

use g7_model::visit::Visitor;
use g7_model::{BinaryOp, Document, Expr, ExprKind, Fix, Literal, Name, Order, Problem, Span, codes, say};

pub(super) fn check(doc: &Document, problems: &mut Vec<Problem>) {
    Divisions { problems }.document(doc);
}

struct Divisions<'p> {
    problems: &'p mut Vec<Problem>,
}

impl<'d> Visitor<'d> for Divisions<'_> {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}

    #[inline(never)]
    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Binary(op, a, b) => {
                if let (
                    BinaryOp::Div,
                    ExprKind::Literal(Literal::Int(x, _)),
                    ExprKind::Literal(Literal::Int(y, _)),
                ) = (op, &a.kind, &b.kind)
                    && x.checked_rem(*y).is_some_and(|r| r != 0)
                {
                    let (whole, rest) = (x / y, x % y);
                    let what =
                        say!("this division of whole numbers is {whole}, and its remainder {rest} is lost");
                    let help = say!("write `{x}.0 / {y}.0` for the fraction, or `{whole}`");
                    let fix = Fix::likely(say!("write `{x}.0 / {y}.0`"), e.at.0, format!("{x}.0 / {y}.0"));
                    self.problems
                        .push(Problem::new(&codes::REMAINDER_LOST, e.at.0, what).help(help).fix(fix));
                }
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Timer { t1, e, t2 } => {
                self.expr(t1);
                self.expr(e);
                t2.iter().for_each(|t| self.expr(t));
            }
            ExprKind::Call(_, args) => self.exprs(args.iter().map(|a| &a.value)),
            ExprKind::Element(_, index, _) => self.exprs(index),
            ExprKind::List(values) => self.exprs(values.iter().map(|(_, e)| e)),
            ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        }
    }
}
