//! Expressions, with the fewest parentheses that keep their meaning.

use super::Printer;
use crate::quote;
use g7_iec::constant;
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Name, Path, UnaryOp};

impl<'a> Printer<'a> {
    pub(super) fn expr(&mut self, e: &Expr) {
        if self.as_spelled(e.at.0) {
            return;
        }
        self.operand(e, 1);
    }

    /// Prints an expression whose operators all bind tighter than this one.
    pub(super) fn operand_above(&mut self, op: BinaryOp, e: &Expr) {
        self.operand(e, op.strength() + 1);
    }

    /// Prints an expression where an operand of at least this binding strength is needed.
    fn operand(&mut self, e: &Expr, least: u8) {
        let own = match &e.kind {
            ExprKind::Binary(op, ..) => op.strength(),
            _ => BinaryOp::TIGHTEST,
        };
        if own < least {
            self.in_parens(e);
        } else {
            self.bare(e);
        }
    }

    fn in_parens(&mut self, e: &Expr) {
        self.push("(");
        self.bare(e);
        self.push(")");
    }

    fn bare(&mut self, e: &Expr) {
        match &e.kind {
            ExprKind::Literal(l) => self.literal(l, e),
            ExprKind::Path(path) => self.path(path),
            ExprKind::Direct(name) => {
                self.push("%");
                self.push(name);
            }
            ExprKind::Unary(op, inner) => self.unary(*op, inner),
            ExprKind::Binary(op, left, right) => self.binary(*op, left, right),
            ExprKind::Timer { t1, e, t2 } => self.timer(t1, e, t2.as_deref()),
            ExprKind::Call(path, args) => match path.names.as_slice() {
                // Where an operand stands, an operator's word is the name of its function.
                [name] if BinaryOp::of_word(&name.text).is_some() => {
                    self.push(&name.text);
                    self.args(args);
                }
                _ => self.call(path, args),
            },
            ExprKind::Element(path, index, member) => {
                self.element(path, index);
                if let Some(member) = member {
                    self.push(".");
                    self.name(&member.text);
                }
            }
            ExprKind::List(values) => self.values(values),
            ExprKind::Bad => self.push("?"),
        }
    }

    fn unary(&mut self, op: UnaryOp, inner: &Expr) {
        let again = matches!(&inner.kind, ExprKind::Unary(UnaryOp::Not | UnaryOp::Rise | UnaryOp::Fall, _));
        self.push(op.sign());
        self.push(if op == UnaryOp::Not { " " } else { "" });
        if is_simple(inner) || op == UnaryOp::Not && again {
            self.bare(inner);
        } else {
            self.in_parens(inner);
        }
    }

    fn binary(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let own = op.strength();
        if op == BinaryOp::Div && ends_with_time(left) {
            self.in_parens(left);
        } else {
            self.operand(left, own);
        }
        self.push(" ");
        self.push(op.row().sign);
        self.push(" ");
        self.operand(right, own + 1);
    }

    /// `3s/X2/1s` where the times are written ones, else `delay(…)`.
    fn timer(&mut self, t1: &Expr, e: &Expr, t2: Option<&Expr>) {
        if is_time(t1) && t2.is_none_or(is_time) {
            self.bare(t1);
            self.push("/");
            let plain = matches!(
                &e.kind,
                ExprKind::Path(_) | ExprKind::Element(..) | ExprKind::Direct(_) | ExprKind::Call(..)
            );
            if plain {
                self.bare(e);
            } else {
                self.in_parens(e);
            }
            if let Some(t2) = t2 {
                self.push("/");
                self.bare(t2);
            }
            return;
        }
        self.push("delay(");
        for (i, part) in [Some(t1), Some(e), t2].into_iter().flatten().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.expr(part);
        }
        self.push(")");
    }

    /// `[1, 2, 4(0)]`.
    fn values(&mut self, values: &[(u32, Expr)]) {
        self.push("[");
        for (i, (count, value)) in values.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            if *count == 1 {
                self.expr(value);
            } else {
                self.push(&format!("{count}("));
                self.expr(value);
                self.push(")");
            }
        }
        self.push("]");
    }

    pub(super) fn path(&mut self, path: &Path) {
        self.names_of_path(&path.names, false);
    }

    /// Names joined by dots; those of a call can have an index at their end.
    fn names_of_path(&mut self, names: &[Name], called: bool) {
        let number = |name: &Name| name.text.starts_with(|c: char| c.is_ascii_digit());
        for (i, name) in names.iter().enumerate() {
            self.push(if i > 0 { "." } else { "" });
            let indexed = match names.get(i + 1) {
                // A number behind the index would be read as that of a bit.
                Some(next) => i == 0 && !number(next),
                None => called,
            };
            if indexed && !number(name) {
                self.chart_name(&name.text);
            } else if i == 0 && number(name) {
                // A bare number would be read as a number, not as a name.
                self.push(&quote::quote(&name.text, '`'));
            } else {
                self.name(&name.text);
            }
        }
    }

    pub(super) fn call(&mut self, path: &Path, args: &[Arg]) {
        self.names_of_path(&path.names, true);
        self.args(args);
    }

    pub(super) fn args(&mut self, args: &[Arg]) {
        self.push("(");
        for (i, arg) in args.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            if let Some(name) = &arg.name {
                self.name(&name.text);
                self.push(if arg.output { " => " } else { " := " });
            }
            self.expr(&arg.value);
        }
        self.push(")");
    }

    fn literal(&mut self, literal: &Literal, e: &Expr) {
        if let Some(text) = self.as_written(literal, e) {
            self.out.push_str(text);
            return;
        }
        let text = match literal {
            Literal::Bool(true) => "TRUE".into(),
            Literal::Bool(false) => "FALSE".into(),
            Literal::Int(v, None) => v.to_string(),
            Literal::Int(v, Some(ty)) => format!("{ty}#{v}"),
            Literal::Real(text, None) => text.to_string(),
            Literal::Real(text, Some(ty)) => format!("{ty}#{text}"),
            Literal::Time(time) => time.to_string(),
            Literal::Moment(moment, time) => moment.literal(*time),
            Literal::Str(text) => constant::quote_st(text),
        };
        self.push(&text);
    }

    /// How the source spells a number, if that is this number.
    fn as_written(&self, literal: &Literal, e: &Expr) -> Option<&'a str> {
        let source = self.source.as_ref()?;
        let at = e.at.0;
        // Brackets around a number belong to its place, but not to the number.
        let text = source.text().get(at.start as usize..at.end as usize)?;
        let text = text.trim_matches(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | '[' | ']'));
        if !text.starts_with(|c: char| c.is_ascii_alphanumeric()) {
            return None;
        }
        let same = match literal {
            Literal::Int(v, None) => constant::integer(text).as_ref() == Ok(v),
            Literal::Int(_, Some(_)) | Literal::Real(_, Some(_)) | Literal::Moment(..) => {
                constant::typed(text).as_ref() == Ok(literal)
            }
            Literal::Real(v, None) => constant::real(text).as_ref() == Ok(v),
            Literal::Time(v) => constant::duration(text).as_ref() == Ok(v),
            Literal::Bool(_) | Literal::Str(_) => false,
        };
        same.then_some(text)
    }
}

/// True if a sign before it can only refer to all of it.
fn is_simple(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(Literal::Int(v, None)) => *v >= 0,
        ExprKind::Literal(Literal::Time(_)) => false,
        ExprKind::Literal(_)
        | ExprKind::Path(_)
        | ExprKind::Direct(_)
        | ExprKind::Call(..)
        | ExprKind::Element(..)
        | ExprKind::List(_)
        | ExprKind::Bad => true,
        ExprKind::Unary(..) | ExprKind::Binary(..) | ExprKind::Timer { .. } => false,
    }
}

fn is_time(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Literal(Literal::Time(_)))
}

/// True if a `/` after it would be read as that of a time operator.
fn ends_with_time(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(Literal::Time(_)) | ExprKind::Timer { .. } => true,
        ExprKind::Unary(_, inner) => ends_with_time(inner),
        ExprKind::Binary(_, _, right) => ends_with_time(right),
        _ => false,
    }
}
