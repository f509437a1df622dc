//! Turns JGrafchart's loosely typed expressions into typed ones.
//!
//! In JGrafchart the context of an expression decides how all of it is evaluated: as Boolean, whole
//! number, real number or string. Every value is converted to that kind (a whole number is true if
//! it is 1, a real number is truncated). Here types are strict, so each conversion is written out.
//! A comparison uses the widest type of its two sides.

use std::ops::Range;

use g7_model::codes;
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Name, Path, Place, Said, Span, Type, UnaryOp, say};

use super::naming::{Meaning, Names, Property};
use super::phrase::{Binary, Phrase, PhraseKind, Unary};
use super::sheet::Plan;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr::Text;

/// The kind of evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sort {
    Bool,
    Int,
    Real,
    Text,
}

impl Sort {
    pub(super) fn of(ty: Type) -> Sort {
        match ty {
            Type::Bool => Sort::Bool,
            Type::Real | Type::Lreal => Sort::Real,
            Type::String(_) => Sort::Text,
            _ => Sort::Int,
        }
    }
}

/// A typed expression and its type; `None` for a constant, which takes the type of the other
/// operand.
struct Typed {
    expr: Expr,
    ty: Option<Type>,
}

/// Converts the expressions of one text.
pub(super) struct Express<'a> {
    pub(super) plan: &'a Plan,
    pub(super) names: &'a Names,
    pub(super) report: &'a mut Report,
    /// The workspace of the text, where its names are looked up.
    pub(super) sheet: usize,
    /// The workspace whose chart will contain the expression.
    pub(super) home: usize,
    /// The text, to find places in the file.
    pub(super) text: &'a Text,
}

impl Express<'_> {
    /// The expression as a condition.
    pub(super) fn condition(&mut self, phrase: &Phrase) -> Expr {
        self.phrase(phrase, Sort::Bool).expr
    }

    /// The expression as the value of a variable of this type.
    pub(super) fn value(&mut self, phrase: &Phrase, ty: Type) -> Expr {
        let typed = self.phrase(phrase, Sort::of(ty));
        if ty == Type::Real && typed.ty == Some(Type::Lreal) {
            let at = typed.expr.at;
            return call("LREAL_TO_REAL", vec![typed.expr], at.0);
        }
        typed.expr
    }

    pub(super) fn span(&self, part: &Range<usize>) -> Span {
        self.report.span(&self.text.place(part))
    }

    /// The meaning of a dotted name in this text; unknown names are reported.
    pub(super) fn find(&mut self, names: &[String], at: &Range<usize>) -> Meaning<'_> {
        let path: Vec<&str> = names.iter().map(String::as_str).collect();
        let meaning = self.names.find(self.plan, self.sheet, &path);
        let what = match &meaning {
            Meaning::Var(..) | Meaning::Step(..) => return meaning,
            Meaning::Stranger(tag) => {
                say!("`{}` is a `{tag}`, which is not carried over", shown(&path.join(".")))
            }
            Meaning::NoPart => say!("there is no `{}`", shown(&path.join("."))),
            Meaning::Nothing => say!("`{}` is the name of nothing in the file", shown(&path.join("."))),
        };
        let code = match meaning {
            Meaning::Stranger(_) => &codes::NOT_CARRIED,
            _ => &codes::UNKNOWN_OBJECT,
        };
        self.report.say(code, &self.text.place(at), what);
        meaning
    }

    /// A variable, as named in the document from this workspace.
    pub(super) fn var_path(&self, sheet: usize, var: usize, at: Span) -> Path {
        let name =
            self.plan.sheets.get(sheet).and_then(|s| s.vars.get(var)).map_or("", |v| v.name.text.as_str());
        let mut names = Vec::new();
        if sheet != self.home && !self.names.is_of_file(sheet, var) {
            names.push(Name::new(self.names.chart(sheet), at));
        }
        names.push(Name::new(super::naming::writable(name), at));
        Path { names }
    }

    fn step_path(&self, sheet: usize, step: usize, property: Property, at: Span) -> Path {
        let mut names = Vec::new();
        if sheet != self.home {
            names.push(Name::new(self.names.chart(sheet), at));
        }
        names.push(Name::new(self.names.step(sheet, step), at));
        names.push(Name::new(property.word(), at));
        Path { names }
    }

    fn var_type(&self, sheet: usize, var: usize) -> Type {
        self.plan.sheets.get(sheet).and_then(|s| s.vars.get(var)).map_or(Type::Bool, |v| v.ty)
    }

    /// The sort of an expression without context; `None` for `0` and `1`, which fit any.
    fn sort(&self, phrase: &Phrase) -> Option<Sort> {
        match &phrase.kind {
            PhraseKind::Int(0 | 1) | PhraseKind::Call(_) => None,
            PhraseKind::Int(_) => Some(Sort::Int),
            PhraseKind::Real(_) => Some(Sort::Real),
            PhraseKind::Str(_) => Some(Sort::Text),
            PhraseKind::Name(names) => {
                let path: Vec<&str> = names.iter().map(String::as_str).collect();
                match self.names.find(self.plan, self.sheet, &path) {
                    Meaning::Var(sheet, var) => Some(Sort::of(self.var_type(sheet, var))),
                    Meaning::Step(_, _, Property::Active) => Some(Sort::Bool),
                    Meaning::Step(_, _, Property::Scans) => Some(Sort::Int),
                    Meaning::Step(_, _, Property::Seconds) => Some(Sort::Real),
                    Meaning::Stranger(_) | Meaning::NoPart | Meaning::Nothing => None,
                }
            }
            PhraseKind::Unary(Unary::Minus, e) => Some(self.sort(e).map_or(Sort::Int, |s| s.max(Sort::Int))),
            PhraseKind::Unary(Unary::Not | Unary::Rise | Unary::Fall, _) => Some(Sort::Bool),
            PhraseKind::Binary(operator, a, b) => match operator {
                Binary::Add | Binary::Sub | Binary::Mul | Binary::Div => {
                    Some(self.sort(a).max(self.sort(b)).map_or(Sort::Int, |s| s.max(Sort::Int)))
                }
                Binary::Mod => Some(Sort::Int),
                _ => Some(Sort::Bool),
            },
            PhraseKind::Choice(_, a, b) => self.sort(a).max(self.sort(b)),
        }
    }

    fn phrase(&mut self, phrase: &Phrase, wanted: Sort) -> Typed {
        let at = self.span(&phrase.at);
        match &phrase.kind {
            PhraseKind::Int(n) => self.whole(*n, wanted, phrase, at),
            PhraseKind::Real(r) => real(*r, wanted, at),
            PhraseKind::Str(text) => constant(text_value(text, wanted), at),
            PhraseKind::Name(names) => self.name(names, phrase, wanted, at),
            PhraseKind::Call(names) => {
                let what =
                    say!("`{}` is a function or method that is not known here", shown(&names.join(".")));
                self.report.say(&codes::UNKNOWN_FUNCTION, &self.text.place(&phrase.at), what);
                bad(at)
            }
            PhraseKind::Unary(Unary::Minus, e) => self.minus(e, wanted, at),
            PhraseKind::Unary(operator, e) => {
                let operator = match operator {
                    Unary::Rise => UnaryOp::Rise,
                    Unary::Fall => UnaryOp::Fall,
                    Unary::Not | Unary::Minus => UnaryOp::Not,
                };
                let operand = self.phrase(e, Sort::Bool).expr;
                let expr = Expr { kind: ExprKind::Unary(operator, Box::new(operand)), at: at.into() };
                self.convert(Typed { expr, ty: Some(Type::Bool) }, wanted, at)
            }
            PhraseKind::Binary(operator, a, b) => self.binary(*operator, (a, b), wanted, at),
            PhraseKind::Choice(condition, yes, no) => {
                let condition = self.phrase(condition, Sort::Bool).expr;
                let (yes, no) = (self.phrase(yes, wanted), self.phrase(no, wanted));
                let ty = wider(yes.ty, no.ty);
                Typed { expr: call("SEL", vec![condition, no.expr, yes.expr], at), ty }
            }
        }
    }

    fn whole(&mut self, n: i64, wanted: Sort, phrase: &Phrase, at: Span) -> Typed {
        if i32::try_from(n).is_err() {
            let what = say!("{n} is larger than JGrafchart's whole numbers, which have 32 bits");
            self.report.say(&codes::BAD_VALUE, &self.text.place(&phrase.at), what);
            return bad(at);
        }
        constant(
            match wanted {
                Sort::Bool => Literal::Bool(n == 1),
                Sort::Int => Literal::Int(n.into(), None),
                Sort::Real => Literal::Real(format!("{n}.0").into(), None),
                Sort::Text => Literal::Str(n.to_string().into()),
            },
            at,
        )
    }

    fn name(&mut self, names: &[String], phrase: &Phrase, wanted: Sort, at: Span) -> Typed {
        let (path, ty) = match self.find(names, &phrase.at) {
            Meaning::Var(sheet, var) => (self.var_path(sheet, var, at), self.var_type(sheet, var)),
            Meaning::Step(sheet, step, property) => {
                let ty = match property {
                    Property::Active => Type::Bool,
                    Property::Scans => Type::Int,
                    Property::Seconds => Type::Real,
                };
                (self.step_path(sheet, step, property, at), ty)
            }
            Meaning::Stranger(_) | Meaning::NoPart | Meaning::Nothing => return bad(at),
        };
        let expr = Expr { kind: ExprKind::Path(path), at: at.into() };
        self.convert(Typed { expr, ty: Some(ty) }, wanted, at)
    }

    fn minus(&mut self, operand: &Phrase, wanted: Sort, at: Span) -> Typed {
        let own = self.sort(operand).map_or(Sort::Int, |s| s.clamp(Sort::Int, Sort::Real));
        let sort = if matches!(wanted, Sort::Int | Sort::Real) { wanted } else { own };
        let inner = self.phrase(operand, sort);
        let inner = self.counted(inner);
        let expr = Expr { kind: ExprKind::Unary(UnaryOp::Neg, Box::new(inner.expr)), at: at.into() };
        let ty = if wanted == sort { inner.ty } else { inner.ty.or(Some(constant_type(sort))) };
        self.convert(Typed { expr, ty }, wanted, at)
    }

    fn binary(&mut self, operator: Binary, (a, b): (&Phrase, &Phrase), wanted: Sort, at: Span) -> Typed {
        let (op, sort, logic) = match operator {
            Binary::Or => (BinaryOp::Or, Sort::Bool, true),
            Binary::And => (BinaryOp::And, Sort::Bool, true),
            Binary::Eq => (BinaryOp::Eq, self.common(a, b, true), true),
            Binary::Ne => (BinaryOp::Ne, self.common(a, b, true), true),
            Binary::Lt => (BinaryOp::Lt, self.common(a, b, false), true),
            Binary::Gt => (BinaryOp::Gt, self.common(a, b, false), true),
            Binary::Le => (BinaryOp::Le, self.common(a, b, false), true),
            Binary::Ge => (BinaryOp::Ge, self.common(a, b, false), true),
            Binary::Add => (BinaryOp::Add, self.arithmetic(a, b, wanted), false),
            Binary::Sub => (BinaryOp::Sub, self.arithmetic(a, b, wanted), false),
            Binary::Mul => (BinaryOp::Mul, self.arithmetic(a, b, wanted), false),
            Binary::Div => (BinaryOp::Div, self.arithmetic(a, b, wanted), false),
            Binary::Mod => (BinaryOp::Mod, Sort::Int, false),
        };
        if sort == Sort::Text && !logic && operator != Binary::Add {
            let what = say!("texts can be joined by `+` and compared, nothing else");
            self.report.say(&codes::BAD_TEXT, &self.text.place(&(a.at.start..b.at.end)), what);
            return bad(at);
        }
        let (mut left, mut right) = (self.phrase(a, sort), self.phrase(b, sort));
        if sort == Sort::Text && operator == Binary::Add {
            let expr = call("CONCAT", vec![left.expr, right.expr], at);
            return self.convert(Typed { expr, ty: Some(Type::String(0)) }, wanted, at);
        }
        if !logic || beyond_scans(&left, &right) {
            (left, right) = (self.counted(left), self.counted(right));
        }
        if sort == Sort::Real {
            (left, right) = as_real(left, right);
        }
        let ty =
            if logic { Some(Type::Bool) } else { wider(left.ty, right.ty).or(Some(constant_type(sort))) };
        let expr =
            Expr { kind: ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr)), at: at.into() };
        self.convert(Typed { expr, ty }, wanted, at)
    }

    /// The sort of a comparison: the widest of its sides.
    fn common(&self, a: &Phrase, b: &Phrase, equality: bool) -> Sort {
        let wide = self.sort(a).max(self.sort(b)).unwrap_or(Sort::Int);
        if equality { wide } else { wide.max(Sort::Int) }
    }

    /// The sort of a sum or product: the wanted one if it is a number.
    fn arithmetic(&self, a: &Phrase, b: &Phrase, wanted: Sort) -> Sort {
        match wanted {
            Sort::Int | Sort::Real => wanted,
            Sort::Text | Sort::Bool => self.sort(a).max(self.sort(b)).unwrap_or(Sort::Int).max(Sort::Int),
        }
    }

    /// A count of scans, as wide as JGrafchart's whole numbers.
    fn counted(&self, typed: Typed) -> Typed {
        if typed.ty != Some(Type::Int) {
            return typed;
        }
        let at = typed.expr.at.0;
        Typed { expr: call("INT_TO_DINT", vec![typed.expr], at), ty: Some(Type::Dint) }
    }

    /// The conversion that JGrafchart makes implicitly.
    fn convert(&mut self, typed: Typed, wanted: Sort, at: Span) -> Typed {
        let Some(ty) = typed.ty else { return typed };
        let from = Sort::of(ty);
        if matches!(typed.expr.kind, ExprKind::Bad) || from == wanted {
            return typed;
        }
        let e = typed.expr;
        let source = if matches!(ty, Type::String(_)) { "STRING".to_string() } else { ty.to_string() };
        let to = |name: &str, e: Expr, ty: Type| Typed {
            expr: call(&format!("{source}_TO_{name}"), vec![e], at),
            ty: Some(ty),
        };
        match (from, wanted) {
            (Sort::Bool, Sort::Int) => to("DINT", e, Type::Dint),
            (Sort::Bool, Sort::Real) => to("LREAL", e, Type::Lreal),
            (Sort::Bool, Sort::Text) => {
                let zero = constant(Literal::Str("0".into()), at).expr;
                let one = constant(Literal::Str("1".into()), at).expr;
                Typed { expr: call("SEL", vec![e, zero, one], at), ty: Some(Type::String(0)) }
            }
            (Sort::Int, Sort::Bool) => equals(e, Literal::Int(1, None), at),
            (Sort::Real, Sort::Bool) => equals(call("TRUNC", vec![e], at), Literal::Int(1, None), at),
            (Sort::Text, Sort::Bool) => equals(e, Literal::Str("1".into()), at),
            (Sort::Real, Sort::Int) => Typed { expr: call("TRUNC", vec![e], at), ty: Some(Type::Dint) },
            (Sort::Int | Sort::Real, Sort::Text) => {
                self.loose(at, say!("a number becomes a text; its digits may differ from JGrafchart's"));
                to("STRING", e, Type::String(0))
            }
            (Sort::Text, Sort::Int) => {
                self.loose(at, say!("a text becomes a number; one that is no number stops the chart, not 0"));
                to("DINT", e, Type::Dint)
            }
            (Sort::Text, Sort::Real) => {
                self.loose(at, say!("a text becomes a number; one that is no number stops the chart, not 0"));
                to("LREAL", e, Type::Lreal)
            }
            // A whole number is widened implicitly. Where two whole numbers meet, `as_real` has
            // handled them.
            _ => Typed { expr: e, ty: Some(ty) },
        }
    }

    fn loose(&mut self, at: Span, what: Said) {
        self.report.put(g7_model::Problem::new(&codes::DIFFERENT, at, what));
    }
}

/// True if a count of scans meets a constant that does not fit its 16 bits.
fn beyond_scans(left: &Typed, right: &Typed) -> bool {
    let wide = |t: &Typed| match &t.expr.kind {
        ExprKind::Literal(Literal::Int(n, _)) => i16::try_from(*n).is_err(),
        _ => false,
    };
    wide(left) || wide(right)
}

/// Makes one side a real number if neither side has a real type, so that `1 / n` gives a fraction
/// where a real number is wanted.
fn as_real(left: Typed, right: Typed) -> (Typed, Typed) {
    let real = |t: &Typed| t.ty.is_some_and(Type::is_real);
    if real(&left) || real(&right) {
        return (left, right);
    }
    if left.ty.is_some() { (widened(left), right) } else { (left, widened(right)) }
}

fn widened(typed: Typed) -> Typed {
    let Some(ty) = typed.ty.filter(|t| t.is_integer()) else { return typed };
    let at = typed.expr.at.0;
    Typed { expr: call(&format!("{ty}_TO_LREAL"), vec![typed.expr], at), ty: Some(Type::Lreal) }
}

/// The type of a result of two operands; a constant takes the type of the other.
fn wider(a: Option<Type>, b: Option<Type>) -> Option<Type> {
    let rank = |ty: Type| match ty {
        Type::Lreal => 4,
        Type::Real => 3,
        Type::Dint => 2,
        Type::Int => 1,
        _ => 0,
    };
    match (a, b) {
        (Some(a), Some(b)) => Some(if rank(a) >= rank(b) { a } else { b }),
        (some, None) | (None, some) => some,
    }
}

/// The type of arithmetic on constants alone.
fn constant_type(sort: Sort) -> Type {
    match sort {
        Sort::Bool => Type::Bool,
        Sort::Int => Type::Dint,
        Sort::Real => Type::Lreal,
        Sort::Text => Type::String(0),
    }
}

fn real(r: f64, wanted: Sort, at: Span) -> Typed {
    let whole = r.trunc();
    constant(
        match wanted {
            Sort::Bool => Literal::Bool(whole == 1.0),
            // The cast of JGrafchart: beyond 32 bits the nearest whole number.
            Sort::Int => Literal::Int(i128::from(whole as i32), None),
            Sort::Real => Literal::Real(written(r).into(), None),
            Sort::Text => Literal::Str(format!("{r:?}").into()),
        },
        at,
    )
}

/// A string as another sort; a text that is not a number counts as 0.
fn text_value(text: &str, wanted: Sort) -> Literal {
    match wanted {
        Sort::Bool => Literal::Bool(text == "1"),
        Sort::Int => Literal::Int(text.parse::<u32>().unwrap_or(0).into(), None),
        Sort::Real => {
            let value = text.parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0).unwrap_or(0.0);
            Literal::Real(written(value).into(), None)
        }
        Sort::Text => Literal::Str(text.into()),
    }
}

/// A real number in the spelling of the language, always with a point.
pub(super) fn written(r: f64) -> String {
    let text = format!("{r:?}");
    match text.split_once('e') {
        Some((digits, power)) if !digits.contains('.') => format!("{digits}.0e{power}"),
        _ => text,
    }
}

fn constant(literal: Literal, at: Span) -> Typed {
    Typed { expr: Expr { kind: ExprKind::Literal(literal), at: at.into() }, ty: None }
}

fn bad(at: Span) -> Typed {
    Typed { expr: Expr { kind: ExprKind::Bad, at: at.into() }, ty: None }
}

fn equals(left: Expr, right: Literal, at: Span) -> Typed {
    let right = Box::new(constant(right, at).expr);
    let expr = Expr { kind: ExprKind::Binary(BinaryOp::Eq, Box::new(left), right), at: at.into() };
    Typed { expr, ty: Some(Type::Bool) }
}

fn call(name: &str, values: Vec<Expr>, at: Span) -> Expr {
    let path = Path { names: vec![Name::new(name, at)] };
    let args = values.into_iter().map(|value| Arg::input(None, value)).collect();
    Expr { kind: ExprKind::Call(path, args), at: Place(at) }
}
