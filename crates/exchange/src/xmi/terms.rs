//! Turns terms into expressions.

use g7_model::{BinaryOp, Expr, ExprKind, Literal, Nanos, Said, Span, UnaryOp, codes, say};

use super::naming::Names;
use super::read::{Plan, Thing, VarSort, kind};
use super::refs::Xml;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The largest height of an expression; the parser of .g7 accepts 500.
const HIGHEST: usize = 400;
/// The most terms of a file; the action of several steps counts for each.
pub(super) const MOST_TERMS: usize = 400_000;

/// Reads the terms of one chart.
pub(super) struct Terms<'p, 'a> {
    pub(super) plan: &'p Plan<'a>,
    pub(super) names: &'p Names,
    pub(super) report: &'p mut Report,
    /// The number of terms that may still be read.
    pub(super) left: &'p mut usize,
    /// The chart that contains the terms.
    pub(super) sheet: usize,
}

/// How a time condition delays its term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delay {
    None,
    /// `t1/e/t2`.
    Dependent(Nanos, Nanos),
    /// `t1/e`.
    Delayed(Nanos),
    /// `not (t1/e)`.
    Limited(Nanos),
}

impl<'a> Terms<'_, 'a> {
    /// The term in this feature of an element, if there is one.
    pub(super) fn of(&mut self, xml: Xml<'a>, feature: &str) -> Option<Expr> {
        let term = xml.children().find(|c| c.has_tag_name(feature))?;
        Some(self.read(term))
    }

    /// One term.
    pub(super) fn read(&mut self, xml: Xml<'a>) -> Expr {
        self.term(xml).0
    }

    /// A term, with its height.
    fn term(&mut self, xml: Xml<'a>) -> (Expr, usize) {
        let at = attr::head(xml);
        let span = self.report.span(&at);
        let Some(left) = self.left.checked_sub(1) else {
            let what =
                say!("the file has more than {MOST_TERMS} terms; an action counts for each of its steps");
            self.report.element(&codes::TOO_LARGE, "term", &at, what);
            return (bad(span), 1);
        };
        *self.left = left;
        let subterms: Vec<Xml> = xml.children().filter(|c| c.has_tag_name("subterm")).collect();
        let class = match kind(xml) {
            None if matches!(xml.tag_name().name(), "variable") => "Variable",
            class => class.unwrap_or(""),
        };
        let binary = |op| Some(Shape::Binary(op));
        let shape = match class {
            "Variable" => return (self.variable(xml), 1),
            "BooleanConstant" => return (self.boolean(xml), 1),
            "IntegerConstant" => return (self.integer(xml), 2),
            "And" => Some(Shape::Chain(BinaryOp::And)),
            "Or" => Some(Shape::Chain(BinaryOp::Or)),
            "Addition" => Some(Shape::Chain(BinaryOp::Add)),
            "Substraction" => binary(BinaryOp::Sub),
            "GreaterThan" => binary(BinaryOp::Gt),
            "LessThan" => binary(BinaryOp::Lt),
            "Equality" => Some(Shape::Equal),
            "Not" => Some(Shape::Unary(UnaryOp::Not)),
            "RisingEdge" => Some(Shape::Unary(UnaryOp::Rise)),
            "FallingEdge" => Some(Shape::Unary(UnaryOp::Fall)),
            _ => None,
        };
        let Some(shape) = shape else {
            let what = say!("a term of the class `{}`, which the meta-model does not have", shown(class));
            self.report.say(&codes::BAD_TEXT, &at, what);
            return (bad(span), 1);
        };
        let fits = match shape {
            Shape::Unary(_) => subterms.len() == 1,
            Shape::Binary(_) => subterms.len() == 2,
            Shape::Chain(_) | Shape::Equal => subterms.len() >= 2,
        };
        if !fits {
            let wanted =
                if matches!(shape, Shape::Unary(_)) { say!("one subterm") } else { say!("two subterms") };
            let what = say!("`{class}` takes {wanted} and has {}", subterms.len());
            self.report.say(&codes::BAD_TEXT, &at, what);
            return (bad(span), 1);
        }
        let parts: Vec<(Expr, usize)> = subterms.into_iter().map(|s| self.term(s)).collect();
        // Checked before it is built, because an expression that is too high could not even be
        // dropped.
        let height = parts.iter().map(|p| p.1).max().unwrap_or(0) + parts.len();
        if height > HIGHEST {
            self.report.say(&codes::TOO_DEEP, &at, say!("a term more than {HIGHEST} operators high"));
            return (bad(span), 1);
        }
        (shape.build(parts.into_iter().map(|p| p.0).collect(), span), height)
    }

    fn variable(&mut self, xml: Xml<'a>) -> Expr {
        let at = attr::head(xml);
        let span = self.report.span(&at);
        if xml.attribute("variableDeclaration").is_none() {
            self.report.say(&codes::BAD_TEXT, &at, say!("a variable in a term without its declaration"));
            return bad(span);
        }
        let Some((thing, place)) = self.plan.thing(xml, "variableDeclaration", self.report) else {
            return bad(span);
        };
        let Thing::Var(number) = thing else {
            let what = say!("a variable in a term means something that is no declaration");
            self.report.say(&codes::UNKNOWN_OBJECT, &place, what);
            return bad(span);
        };
        let Some(var) = self.plan.vars.get(number) else { return bad(span) };
        if var.sort != VarSort::Step {
            if let Some(timer) = self.names.timer(number, self.sheet, span) {
                return timer;
            }
            let path = self.names.path_of_var(self.plan, number, self.sheet, span);
            return Expr { kind: ExprKind::Path(path), at: span.into() };
        }
        match self.plan.thing(var.xml, "step", self.report) {
            Some((Thing::Step(sheet, step), _)) => self.names.activity((sheet, step), self.sheet, span),
            found => {
                if found.is_some() || var.xml.attribute("step").is_none() {
                    let what = say!("a variable for the activity of a step that names no step");
                    self.report.say(&codes::UNKNOWN_OBJECT, &attr::head(var.xml), what);
                }
                bad(span)
            }
        }
    }

    fn boolean(&mut self, xml: Xml) -> Expr {
        let span = self.report.span(&attr::head(xml));
        match xml.attribute("value").unwrap_or("false").trim() {
            "true" | "1" => literal(Literal::Bool(true), span),
            "false" | "0" => literal(Literal::Bool(false), span),
            other => self.bad_value(xml, other, say!("true or false")),
        }
    }

    fn integer(&mut self, xml: Xml) -> Expr {
        let span = self.report.span(&attr::head(xml));
        let text = xml.attribute("value").unwrap_or("0").trim();
        match text.parse::<i32>() {
            Ok(n) => {
                let expr = literal(Literal::Int(i128::from(n).abs(), None), span);
                if n >= 0 { expr } else { unary(UnaryOp::Neg, expr, span) }
            }
            Err(_) => self.bad_value(xml, text, say!("a whole number of 32 bits")),
        }
    }

    fn bad_value(&mut self, xml: Xml, value: &str, known: Said) -> Expr {
        let at = attr::text(xml, "value").map_or_else(|| attr::head(xml), |t| t.at);
        self.report.say(&codes::BAD_VALUE, &at, say!("the value `{}`; it is {known}", shown(value)));
        bad(self.report.span(&at))
    }

    /// The delay of a transition's or a continuous action's term.
    pub(super) fn delay(&mut self, xml: Xml) -> Delay {
        let unit = match xml.attribute("unit") {
            None | Some("s" | "second") => Nanos::SECOND,
            Some("ms" | "millisecond") => Nanos::MILLISECOND,
            Some(other) => {
                self.report.say(
                    &codes::BAD_VALUE,
                    &attr::head(xml),
                    say!("the unit `{}`; it is s or ms", shown(other)),
                );
                Nanos::MILLISECOND
            }
        };
        let t1 = self.time(xml, "delayTime", unit);
        let t2 = self.time(xml, "resetTime", unit);
        match xml.attribute("timeConditionType").unwrap_or("none") {
            "timeDependent" => Delay::Dependent(t1, t2),
            "timeDelayed" if t2 == Nanos::ZERO => Delay::Delayed(t1),
            // The generator of the same project passes both times to one block.
            "timeDelayed" => Delay::Dependent(t1, t2),
            "timeLimited" => {
                if t2 != Nanos::ZERO {
                    let what = say!("`resetTime` has no effect on what is limited in time; it is left out");
                    self.report.say(&codes::LEFT_OUT, &attr::head(xml), what);
                }
                Delay::Limited(t1)
            }
            "none" => {
                if t1 != Nanos::ZERO || t2 != Nanos::ZERO {
                    let what = say!("the times have no effect: `timeConditionType` is none");
                    self.report.say(&codes::LEFT_OUT, &attr::head(xml), what);
                }
                Delay::None
            }
            other => {
                let what =
                    say!("`timeConditionType` is `{}`, which the meta-model does not have", shown(other));
                self.report.say(&codes::BAD_VALUE, &attr::head(xml), what);
                Delay::None
            }
        }
    }

    fn time(&mut self, xml: Xml, name: &str, unit: Nanos) -> Nanos {
        let text = xml.attribute(name).unwrap_or("0").trim();
        match text.parse::<i32>() {
            Ok(n) if n >= 0 => unit * i64::from(n),
            _ => {
                let at = attr::text(xml, name).map_or_else(|| attr::head(xml), |t| t.at);
                let what = say!("`{name}` is `{}`; it is a whole number, not below 0", shown(text));
                self.report.say(&codes::BAD_VALUE, &at, what);
                Nanos::ZERO
            }
        }
    }
}

impl Delay {
    /// The term with its delay.
    pub(super) fn around(self, e: Expr, span: Span) -> Expr {
        let timer = |t1: Nanos, t2: Option<Nanos>, e: Expr| Expr {
            kind: ExprKind::Timer {
                t1: Box::new(literal(Literal::Time(t1), span)),
                e: Box::new(e),
                t2: t2.map(|t| Box::new(literal(Literal::Time(t), span))),
            },
            at: span.into(),
        };
        match self {
            Delay::None => e,
            Delay::Dependent(t1, t2) => timer(t1, Some(t2), e),
            Delay::Delayed(t1) => timer(t1, None, e),
            Delay::Limited(t1) => unary(UnaryOp::Not, timer(t1, None, e), span),
        }
    }
}

/// The way to combine subterms.
#[derive(Clone, Copy)]
enum Shape {
    Unary(UnaryOp),
    Binary(BinaryOp),
    /// Two or more.
    Chain(BinaryOp),
    /// Each equal to the next.
    Equal,
}

impl Shape {
    fn build(self, parts: Vec<Expr>, span: Span) -> Expr {
        let join = |op, a: Expr, b: Expr| {
            let kind = ExprKind::Binary(op, Box::new(a), Box::new(b));
            Expr { kind, at: span.into() }
        };
        let whole = match self {
            Shape::Unary(op) => parts.into_iter().next().map(|e| unary(op, e, span)),
            Shape::Binary(op) | Shape::Chain(op) => parts.into_iter().reduce(|a, b| join(op, a, b)),
            Shape::Equal => {
                let next: Vec<Expr> = parts.iter().skip(1).cloned().collect();
                let pairs = parts.into_iter().zip(next).map(|(a, b)| join(BinaryOp::Eq, a, b));
                pairs.reduce(|a, b| join(BinaryOp::And, a, b))
            }
        };
        whole.unwrap_or_else(|| bad(span))
    }
}

/// Stands for a term that could not be read; a problem has been reported.
pub(super) fn bad(span: Span) -> Expr {
    Expr { kind: ExprKind::Bad, at: span.into() }
}

pub(super) fn literal(value: Literal, span: Span) -> Expr {
    Expr { kind: ExprKind::Literal(value), at: span.into() }
}

fn unary(op: UnaryOp, e: Expr, span: Span) -> Expr {
    Expr { kind: ExprKind::Unary(op, Box::new(e)), at: span.into() }
}
