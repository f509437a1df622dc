//! Writes expressions as terms.

use g7_model::{BinaryOp, Expr, ExprKind, Literal, Nanos, Type, UnaryOp, codes, say};

use super::Writer;
use super::lookup::{Asked, Meaning};
use g7_iec::xml::element::Element;

/// The deepest term that is written; the reader accepts 100 nested elements.
const DEEPEST: usize = 90;

/// A term that was written.
pub(super) struct Term {
    pub(super) element: Element,
    /// The reference to its sort.
    sort: String,
    pub(super) ty: Type,
}

/// An operator of the meta-model.
struct Operator {
    class: &'static str,
    output: Type,
}

impl Writer<'_> {
    /// A receptivity or condition; its delay is written to the element that contains it.
    pub(super) fn timed(&mut self, e: &Expr, place: &str, holder: &mut Element) -> Option<Element> {
        let (timer, limited) = match &e.kind {
            ExprKind::Timer { .. } => (e, false),
            ExprKind::Unary(UnaryOp::Not, inner) if matches!(inner.kind, ExprKind::Timer { .. }) => {
                (&**inner, true)
            }
            _ => return self.condition(e, "term", place),
        };
        let ExprKind::Timer { t1, e: inner, t2 } = &timer.kind else { return None };
        let sort = match (limited, t2) {
            (false, None) => "timeDelayed",
            (false, Some(_)) => "timeDependent",
            (true, None) => "timeLimited",
            (true, Some(_)) => {
                self.cannot(e.at, say!("the complement of a time operator with two times"));
                return None;
            }
        };
        self.times(holder, sort, t1, t2.as_deref());
        self.condition(inner, "term", place)
    }

    /// Sets the times of a transition or action.
    pub(super) fn times(&mut self, holder: &mut Element, sort: &'static str, t1: &Expr, t2: Option<&Expr>) {
        let constant = |e: &Expr| match &e.kind {
            ExprKind::Literal(Literal::Time(time)) => Some(*time),
            _ => None,
        };
        let (Some(first), Some(second)) = (constant(t1), t2.map_or(Some(Nanos::ZERO), constant)) else {
            return self.cannot(t1.at, say!("a time that is computed"));
        };
        let in_units = |unit: Nanos| Some((first.whole(unit)?, second.whole(unit)?));
        let seconds = in_units(Nanos::SECOND);
        let fits = |n: &i64| (0..=i64::from(i32::MAX)).contains(n);
        let Some((first, second)) =
            seconds.or_else(|| in_units(Nanos::MILLISECOND)).filter(|(a, b)| fits(a) && fits(b))
        else {
            return self.cannot(t1.at, say!("a time that is no whole number of seconds or milliseconds"));
        };
        for (name, count) in [("delayTime", first), ("resetTime", second)] {
            if count != 0 {
                holder.set(name, &count.to_string());
            }
        }
        if seconds.is_none() {
            holder.set("unit", "ms");
        }
        holder.set("timeConditionType", sort);
    }

    /// A Boolean term.
    pub(super) fn condition(&mut self, e: &Expr, tag: &'static str, place: &str) -> Option<Element> {
        self.term(e, tag, place, 0).map(|t| t.element)
    }

    /// Writes a term; None if a problem has been reported.
    pub(super) fn term(&mut self, e: &Expr, tag: &'static str, place: &str, depth: usize) -> Option<Term> {
        if depth > DEEPEST {
            self.say(&codes::TOO_DEEP, e.at, say!("a term more than {DEEPEST} operators deep"));
            return None;
        }
        match &e.kind {
            ExprKind::Literal(value) => self.constant(e, value, tag, place),
            ExprKind::Path(path) => match self.look.path(self.sheet, path) {
                Some(meaning) => self.meaning(e, &meaning, tag, place, depth),
                None => {
                    self.cannot(e.at, say!("what `{}` stands for", path.text()));
                    None
                }
            },
            ExprKind::Element(..) | ExprKind::List(_) => {
                self.cannot(e.at, say!("an element of an array"));
                None
            }
            ExprKind::Direct(address) => match self.look.direct(address) {
                Some(meaning) => self.meaning(e, &meaning, tag, place, depth),
                None => {
                    self.cannot(e.at, say!("`%{address}`"));
                    None
                }
            },
            ExprKind::Unary(op, inner) => self.unary(e, *op, inner, tag, place, depth),
            ExprKind::Binary(op, a, b) => self.binary(e, *op, (a, b), tag, place, depth),
            ExprKind::Timer { t1, e: inner, t2 } => self.inner_timer(e, t1, inner, t2.is_some(), tag),
            ExprKind::Call(path, _) => {
                self.cannot(e.at, say!("a call of `{}`", path.text()));
                None
            }
            ExprKind::Bad => None,
        }
    }

    fn meaning(
        &mut self,
        e: &Expr,
        meaning: &Meaning,
        tag: &'static str,
        place: &str,
        depth: usize,
    ) -> Option<Term> {
        match meaning {
            Meaning::Const(value) => self.term(value, tag, place, depth + 1),
            Meaning::Var(reference, ty) => Some(self.variable_term(reference, *ty, tag)),
            Meaning::Step(node) if self.look.is_initialisable(*node) => {
                let reference = self.look.ask(Asked::Step(*node));
                Some(self.variable_term(&reference, Type::Bool, tag))
            }
            Meaning::Step(_) => {
                self.cannot(e.at, say!("the activity of a macro-step, entry or exit step as a term"));
                None
            }
        }
    }

    /// A time operator within a term. The meta-model has none; on the activity of a step, users of
    /// it declare a Boolean that is called like the operator.
    fn inner_timer(
        &mut self,
        e: &Expr,
        t1: &Expr,
        inner: &Expr,
        twice: bool,
        tag: &'static str,
    ) -> Option<Term> {
        let step = match &inner.kind {
            ExprKind::Path(path) => self.look.path(self.sheet, path),
            _ => None,
        };
        let name = match (&t1.kind, step) {
            (ExprKind::Literal(Literal::Time(time)), Some(Meaning::Step(node))) if !twice => {
                self.look.timed_name(*time, node)
            }
            _ => None,
        };
        let Some(name) = name else {
            self.cannot(e.at, say!("a time operator within a term"));
            return None;
        };
        let what = say!(
            "a time operator within a term: the meta-model has none; it is written as a Boolean `{name}`"
        );
        self.say(&codes::DIFFERENT, e.at, what);
        let reference = self.look.ask(Asked::Timed(name));
        Some(self.variable_term(&reference, Type::Bool, tag))
    }

    /// `<term xsi:type="terms:Variable" sort=… id=… variableDeclaration=…/>`.
    pub(super) fn variable_term(&mut self, reference: &str, ty: Type, tag: &'static str) -> Term {
        let mut element = Element::new(tag);
        // The variable of an action has only this class.
        if tag != "variable" {
            element.set("xsi:type", "terms:Variable");
        }
        let sort = format!("{reference}/@sort");
        element.set("sort", &sort);
        element.set("id", &self.id());
        element.set("variableDeclaration", reference);
        Term { element, sort, ty: if ty == Type::Bool { Type::Bool } else { Type::Dint } }
    }

    fn constant(&mut self, e: &Expr, value: &Literal, tag: &'static str, place: &str) -> Option<Term> {
        match value {
            Literal::Bool(b) => {
                Some(self.value("terms:BooleanConstant", Type::Bool, b.then(|| "true".into()), tag, place))
            }
            Literal::Int(n, _) => self.integer(e, *n, tag, place),
            Literal::Real(..) | Literal::Time(_) | Literal::Moment(..) | Literal::Str(_) => {
                self.cannot(e.at, say!("a constant that is neither Boolean nor a whole number"));
                None
            }
        }
    }

    fn integer(&mut self, e: &Expr, n: i128, tag: &'static str, place: &str) -> Option<Term> {
        if i32::try_from(n).is_err() {
            self.cannot(e.at, say!("a whole number of more than 32 bits"));
            return None;
        }
        let text = (n != 0).then(|| n.to_string());
        Some(self.value("terms:IntegerConstant", Type::Dint, text, tag, place))
    }

    /// Writes a constant; the default value of the meta-model is omitted.
    fn value(
        &mut self,
        class: &'static str,
        ty: Type,
        value: Option<String>,
        tag: &'static str,
        place: &str,
    ) -> Term {
        let mut term = self.operator(&Operator { class, output: ty }, Vec::new(), tag, place);
        if let Some(value) = value {
            term.element.set("value", &value);
        }
        term
    }

    fn unary(
        &mut self,
        e: &Expr,
        op: UnaryOp,
        inner: &Expr,
        tag: &'static str,
        place: &str,
        depth: usize,
    ) -> Option<Term> {
        let class = match (op, &inner.kind) {
            (UnaryOp::Not, _) => "terms:Not",
            (UnaryOp::Rise, _) => "terms:RisingEdge",
            (UnaryOp::Fall, _) => "terms:FallingEdge",
            (UnaryOp::Neg, ExprKind::Literal(Literal::Int(n, _))) => return self.integer(e, -n, tag, place),
            (UnaryOp::Neg, _) => {
                // `-e` is written as `0 - e`.
                let zero = Expr { kind: ExprKind::Literal(Literal::Int(0, None)), at: e.at };
                return self.binary(e, BinaryOp::Sub, (&zero, inner), tag, place, depth);
            }
        };
        let part = self.term(inner, "subterm", &format!("{place}/@subterm.0"), depth + 1)?;
        Some(self.operator(&Operator { class, output: Type::Bool }, vec![part], tag, place))
    }

    fn binary(
        &mut self,
        e: &Expr,
        op: BinaryOp,
        (a, b): (&Expr, &Expr),
        tag: &'static str,
        place: &str,
        depth: usize,
    ) -> Option<Term> {
        // `<>`, `<=` and `>=` are complements, as is XOR of an equality.
        let opposite = match op {
            BinaryOp::Ne | BinaryOp::Xor => Some(BinaryOp::Eq),
            BinaryOp::Le => Some(BinaryOp::Gt),
            BinaryOp::Ge => Some(BinaryOp::Lt),
            _ => None,
        };
        if let Some(opposite) = opposite {
            let inner =
                self.binary(e, opposite, (a, b), "subterm", &format!("{place}/@subterm.0"), depth + 1)?;
            let not = Operator { class: "terms:Not", output: Type::Bool };
            return Some(self.operator(&not, vec![inner], tag, place));
        }
        let first = self.term(a, "subterm", &format!("{place}/@subterm.0"), depth + 1);
        let second = self.term(b, "subterm", &format!("{place}/@subterm.1"), depth + 1);
        let (first, second) = (first?, second?);
        let boolean = first.ty == Type::Bool;
        let class = match op {
            BinaryOp::And | BinaryOp::Dot => "terms:And",
            BinaryOp::Mul if boolean => "terms:And",
            BinaryOp::Or => "terms:Or",
            BinaryOp::Add if boolean => "terms:Or",
            BinaryOp::Add => "terms:Addition",
            BinaryOp::Sub => "terms:Substraction",
            BinaryOp::Eq => "terms:Equality",
            BinaryOp::Gt => "terms:GreaterThan",
            BinaryOp::Lt => "terms:LessThan",
            BinaryOp::Mul | BinaryOp::Div | BinaryOp::Mod | BinaryOp::Pow => {
                self.cannot(e.at, say!("a product, quotient, remainder or power of numbers"));
                return None;
            }
            BinaryOp::Xor | BinaryOp::Ne | BinaryOp::Le | BinaryOp::Ge => return None,
        };
        let output =
            if matches!(class, "terms:Addition" | "terms:Substraction") { Type::Dint } else { Type::Bool };
        Some(self.operator(&Operator { class, output }, vec![first, second], tag, place))
    }

    fn operator(&mut self, operator: &Operator, parts: Vec<Term>, tag: &'static str, place: &str) -> Term {
        let sort = format!("{place}/@output");
        let mut element = Element::new(tag);
        element.set("xsi:type", operator.class);
        element.set("sort", &sort);
        element.set("id", &self.id());
        if !parts.is_empty() {
            let inputs: Vec<&str> = parts.iter().map(|p| &*p.sort).collect();
            element.set("input", &inputs.join(" "));
        }
        element.extend(parts.into_iter().map(|p| p.element));
        element.push(self.sort("output", operator.output));
        Term { element, sort, ty: operator.output }
    }
}
