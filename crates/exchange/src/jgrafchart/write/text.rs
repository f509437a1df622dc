//! Prints expressions in JGrafchart's action language.
//!
//! In JGrafchart the context decides how an expression is evaluated, and values are converted
//! silently; in a document each conversion is written out. A conversion is therefore left to the
//! context if the context makes it, and refused if the context would make another one.

use g7_model::{BinaryOp, Expr, ExprKind, Literal, Place, Said, Type, UnaryOp, say};

use super::lookup::{Look, Meaning, Property, Thing};
use crate::jgrafchart::express::Sort;

/// The binding strength of an operator; the weakest comes first.
type Strength = u8;
const CHOICE: Strength = 0;
const OR: Strength = 1;
const AND: Strength = 2;
const EQUAL: Strength = 3;
const COMPARE: Strength = 4;
const SUM: Strength = 5;
const PRODUCT: Strength = 6;
const SIGN: Strength = 7;
const ATOM: Strength = 8;

/// The part that an expression cannot say, and its place.
pub(super) type Refused = (Place, Said);

/// Prints the expressions of a chart.
pub(super) struct Speech<'a, 'd> {
    pub(super) look: &'a mut Look<'d>,
    /// The chart that contains the expression.
    pub(super) chart: usize,
    /// The chart whose workspace will contain the text.
    pub(super) home: usize,
}

impl Speech<'_, '_> {
    /// A condition.
    pub(super) fn condition(&mut self, e: &Expr) -> Result<String, Refused> {
        self.say(e, Sort::Bool, CHOICE)
    }

    /// The value of a variable of this type.
    pub(super) fn value(&mut self, e: &Expr, ty: Type) -> Result<String, Refused> {
        self.say(e, Sort::of(ty), CHOICE)
    }

    fn say(&mut self, e: &Expr, wanted: Sort, least: Strength) -> Result<String, Refused> {
        let (text, strength) = self.form(e, wanted)?;
        Ok(if strength < least { format!("({text})") } else { text })
    }

    fn form(&mut self, e: &Expr, wanted: Sort) -> Result<(String, Strength), Refused> {
        let no = |what: Said| Err((e.at, what));
        match &e.kind {
            ExprKind::Literal(l) => literal(l, e.at),
            ExprKind::Path(path) => match self.look.path(self.chart, path) {
                Some(meaning) => Ok((self.name(meaning, e.at)?, ATOM)),
                None => Err((e.at, say!("what `{}` stands for", path.text()))),
            },
            ExprKind::Direct(address) => match self.look.direct(address) {
                Some(meaning) => Ok((self.name(meaning, e.at)?, ATOM)),
                None => Err((e.at, say!("`%{address}`"))),
            },
            ExprKind::Unary(op, inner) => self.unary(*op, inner, e.at, wanted),
            ExprKind::Binary(op, a, b) => self.binary(*op, (a, b), e.at, wanted),
            ExprKind::Timer { .. } => no(say!("a time operator")),
            ExprKind::Call(path, args) => {
                let values: Vec<&Expr> = args.iter().map(|a| &a.value).collect();
                if args.iter().any(|a| a.name.is_some()) {
                    return no(say!("a call with names for its inputs"));
                }
                self.call(&path.text().to_uppercase(), &values, e.at, wanted)
            }
            ExprKind::Element(..) | ExprKind::List(_) => no(say!("an element of an array")),
            ExprKind::Bad => no(say!("what could not be read")),
        }
    }

    fn name(&mut self, meaning: Meaning, at: Place) -> Result<String, Refused> {
        let (thing, end) = match meaning {
            Meaning::Var(var) => (Thing::Var(var), ""),
            Meaning::Step(step, Property::Active) => (Thing::Step(step), ".x"),
            Meaning::Step(step, Property::Scans) => (Thing::Step(step), ".t"),
            Meaning::Step(step, Property::Seconds) => (Thing::Step(step), ".s"),
        };
        match self.look.speak(self.home, thing) {
            Some(name) => Ok(format!("{name}{end}")),
            None => Err((at, say!("a name that means something else where it is used"))),
        }
    }

    fn unary(
        &mut self,
        op: UnaryOp,
        inner: &Expr,
        at: Place,
        wanted: Sort,
    ) -> Result<(String, Strength), Refused> {
        let sign = match op {
            UnaryOp::Not => "!",
            UnaryOp::Neg => {
                let text = self.say(inner, wanted.clamp(Sort::Int, Sort::Real), ATOM)?;
                return Ok((format!("-{text}"), SIGN));
            }
            UnaryOp::Rise => "/",
            UnaryOp::Fall => "\\",
        };
        let named = matches!(inner.kind, ExprKind::Path(_) | ExprKind::Direct(_));
        if op != UnaryOp::Not && !named {
            return Err((at, say!("an edge of what is no variable")));
        }
        Ok((format!("{sign}{}", self.say(inner, Sort::Bool, SIGN)?), SIGN))
    }

    fn binary(
        &mut self,
        op: BinaryOp,
        (a, b): (&Expr, &Expr),
        at: Place,
        wanted: Sort,
    ) -> Result<(String, Strength), Refused> {
        let logic = |s: &mut Self, sign: &str, strength, sort| {
            let left = s.say(a, sort, strength)?;
            let right = s.say(b, sort, strength + 1)?;
            Ok((format!("{left} {sign} {right}"), strength))
        };
        let boolean = wanted == Sort::Bool && self.sort(a) == Some(Sort::Bool);
        match op {
            BinaryOp::And | BinaryOp::Dot => logic(self, "&", AND, Sort::Bool),
            BinaryOp::Or => logic(self, "|", OR, Sort::Bool),
            BinaryOp::Mul if boolean => logic(self, "&", AND, Sort::Bool),
            BinaryOp::Add if boolean => logic(self, "|", OR, Sort::Bool),
            BinaryOp::Xor => logic(self, "!=", EQUAL, Sort::Bool),
            BinaryOp::Eq | BinaryOp::Ne => {
                if op == BinaryOp::Eq
                    && let Some(text) = self.truth_of_real(a, b)?
                {
                    return Ok((text, ATOM));
                }
                let sort = self.common(a, b, at)?;
                logic(self, if op == BinaryOp::Eq { "==" } else { "!=" }, EQUAL, sort)
            }
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                let sort = self.common(a, b, at)?;
                let sign = match op {
                    BinaryOp::Lt => "<",
                    BinaryOp::Le => "<=",
                    BinaryOp::Gt => ">",
                    _ => ">=",
                };
                logic(self, sign, COMPARE, sort)
            }
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div => {
                let own = self.sort(a).max(self.sort(b)).unwrap_or(Sort::Int);
                let made = self.made(a).max(self.made(b)).unwrap_or(Sort::Int);
                if made == Sort::Int && wanted == Sort::Real && op == BinaryOp::Div {
                    return Err((at, say!("a division of whole numbers among real ones")));
                }
                let sort = if wanted == Sort::Real { Sort::Real } else { own };
                match op {
                    BinaryOp::Add => logic(self, "+", SUM, sort),
                    BinaryOp::Sub => logic(self, "-", SUM, sort),
                    BinaryOp::Mul => logic(self, "*", PRODUCT, sort),
                    _ => logic(self, "/", PRODUCT, sort),
                }
            }
            BinaryOp::Mod => logic(self, "%", PRODUCT, Sort::Int),
            BinaryOp::Pow => Err((at, say!("a power"))),
        }
    }

    /// `TRUNC(r) = 1` is the truth of a real number in JGrafchart.
    fn truth_of_real(&mut self, a: &Expr, b: &Expr) -> Result<Option<String>, Refused> {
        let (ExprKind::Call(path, args), ExprKind::Literal(Literal::Int(1, None))) = (&a.kind, &b.kind)
        else {
            return Ok(None);
        };
        match &args[..] {
            [arg] if path.text() == "TRUNC" && is_leaf(&arg.value) => {
                self.say(&arg.value, Sort::Real, ATOM).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// The sort in which JGrafchart compares: the widest of the two sides.
    fn common(&self, a: &Expr, b: &Expr, at: Place) -> Result<Sort, Refused> {
        let sort = self.sort(a).max(self.sort(b)).unwrap_or(Sort::Int);
        if self.made(a).max(self.made(b)).is_some_and(|made| made != sort) {
            let what = say!("a comparison of numbers that are converted otherwise there");
            return Err((at, what));
        }
        Ok(sort)
    }

    fn call(
        &mut self,
        name: &str,
        args: &[&Expr],
        at: Place,
        wanted: Sort,
    ) -> Result<(String, Strength), Refused> {
        let no = || Err((at, say!("the function `{name}`")));
        match (name, args) {
            ("SEL", [condition, no, yes]) => {
                let condition = self.say(condition, Sort::Bool, OR)?;
                let (yes, no) = (self.say(yes, wanted, OR)?, self.say(no, wanted, OR)?);
                Ok((format!("{condition} ? {yes} : {no}"), CHOICE))
            }
            ("CONCAT", [a, b]) => {
                let (a, b) = (self.say(a, Sort::Text, SUM)?, self.say(b, Sort::Text, PRODUCT)?);
                Ok((format!("{a} + {b}"), SUM))
            }
            ("TRUNC", [e]) if wanted == Sort::Int && is_leaf(e) => self.form(e, Sort::Real),
            (conversion, [e]) => {
                let Some((from, to)) = conversion.split_once("_TO_") else { return no() };
                let (Some(from), Some(to)) = (sort_of_word(from), sort_of_word(to)) else { return no() };
                let fits = to == wanted || (to == Sort::Int && wanted == Sort::Real);
                // Whole to whole and real to real is no conversion in JGrafchart, and others come
                // with the context. But one real operand makes the whole expression real.
                let whole_in_real = from == Sort::Int && wanted == Sort::Real && !is_leaf(e);
                let cut = from == Sort::Real && to == Sort::Int;
                let shown = to != Sort::Text || self.made(e) == self.sort(e);
                if !fits || whole_in_real || cut || !shown { no() } else { self.form(e, from) }
            }
            _ => no(),
        }
    }

    /// The sort of an expression in JGrafchart without context; `None` for `0` and `1`, which fit
    /// any.
    fn sort(&self, e: &Expr) -> Option<Sort> {
        match &e.kind {
            ExprKind::Literal(Literal::Int(0 | 1, _) | Literal::Bool(_)) => None,
            ExprKind::Literal(Literal::Int(..)) => Some(Sort::Int),
            ExprKind::Literal(Literal::Real(..)) => Some(Sort::Real),
            ExprKind::Literal(Literal::Str(_)) => Some(Sort::Text),
            ExprKind::Literal(Literal::Time(_) | Literal::Moment(..))
            | ExprKind::Element(..)
            | ExprKind::List(_)
            | ExprKind::Bad => None,
            ExprKind::Path(path) => self.look.path(self.chart, path).and_then(|m| self.sort_of(m)),
            ExprKind::Direct(address) => self.look.direct(address).and_then(|m| self.sort_of(m)),
            ExprKind::Unary(UnaryOp::Neg, e) => self.sort(e).or(Some(Sort::Int)),
            ExprKind::Unary(..) | ExprKind::Timer { .. } => Some(Sort::Bool),
            ExprKind::Binary(op, a, b) => match op {
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Mod => {
                    self.sort(a).max(self.sort(b)).or(Some(Sort::Int))
                }
                _ => Some(Sort::Bool),
            },
            ExprKind::Call(path, args) => match (&*path.text().to_uppercase(), &args[..]) {
                ("CONCAT", _) => Some(Sort::Text),
                ("SEL", [_, a, b]) => self.sort(&a.value).max(self.sort(&b.value)),
                (conversion, [e]) => match conversion.split_once("_TO_") {
                    // The text shows the sort from which the value is converted.
                    Some((from, _)) => sort_of_word(from),
                    None => self.sort(&e.value),
                },
                _ => None,
            },
        }
    }

    /// The sort of an expression in the document, where conversions are written out.
    fn made(&self, e: &Expr) -> Option<Sort> {
        match &e.kind {
            ExprKind::Unary(UnaryOp::Neg, e) => self.made(e).or(Some(Sort::Int)),
            ExprKind::Binary(
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Mod,
                a,
                b,
            ) => self.made(a).max(self.made(b)).or(Some(Sort::Int)),
            ExprKind::Call(path, args) => match (&*path.text().to_uppercase(), &args[..]) {
                ("TRUNC", _) => Some(Sort::Int),
                ("SEL", [_, a, b]) => self.made(&a.value).max(self.made(&b.value)),
                (conversion, _) => match conversion.split_once("_TO_") {
                    Some((_, to)) => sort_of_word(to),
                    None => self.sort(e),
                },
            },
            _ => self.sort(e),
        }
    }

    fn sort_of(&self, meaning: Meaning) -> Option<Sort> {
        Some(match meaning {
            Meaning::Var(var) => Sort::of(self.look.decl(var)?.ty),
            Meaning::Step(_, Property::Active) => Sort::Bool,
            Meaning::Step(_, Property::Scans) => Sort::Int,
            Meaning::Step(_, Property::Seconds) => Sort::Real,
        })
    }
}

fn is_leaf(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Path(_) | ExprKind::Direct(_))
}

fn sort_of_word(word: &str) -> Option<Sort> {
    Some(match word {
        "BOOL" => Sort::Bool,
        "SINT" | "INT" | "DINT" | "USINT" | "UINT" => Sort::Int,
        "REAL" | "LREAL" => Sort::Real,
        "STRING" => Sort::Text,
        _ => return None,
    })
}

fn literal(l: &Literal, at: Place) -> Result<(String, Strength), Refused> {
    Ok(match l {
        Literal::Bool(b) => (u8::from(*b).to_string(), ATOM),
        Literal::Int(n, _) => match i32::try_from(*n) {
            Ok(n) if n >= 0 => (n.to_string(), ATOM),
            Ok(n) => (n.to_string(), SIGN),
            Err(_) => return Err((at, say!("{n}, which is larger than 32 bits"))),
        },
        Literal::Real(text, _) => (text.to_string(), ATOM),
        Literal::Time(_) => return Err((at, say!("a duration"))),
        Literal::Moment(..) => return Err((at, say!("a date or a time of day"))),
        Literal::Str(text) => (quoted(text), ATOM),
    })
}

/// A string in quotes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
