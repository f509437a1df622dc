//! Expressions: names become rows of the tables, and every node gets a type.
//!
//! `infer` finds the type that an expression has by itself; `value` gives it the type that its
//! place needs. A hint goes down only for functions whose result depends on the place (TRUNC, SQRT
//! of a literal).

use g7_model::{
    Arg, Expr as Written, ExprKind as Form, Literal, Path, Problem, Said, Span, Type, UnaryOp, codes, say,
};

use super::operator;
use super::refer::{Ref, Unit as TimeUnit};
use super::resolver::{Resolver, Role};
use super::scopes::Entity;
use super::types::Typed;
use super::{bits, constant};
use crate::ir::{Expr, ExprKind, Value, VarClass, VarId};

impl Resolver<'_, '_> {
    /// Resolves an expression of the type that is needed here.
    pub(super) fn value(&mut self, e: &Written, want: Type) -> Option<Expr> {
        let typed = self.infer(e, Some(want))?;
        self.coerce(typed, want)
    }

    /// A BOOL expression.
    pub(super) fn condition(&mut self, e: &Written) -> Option<Expr> {
        self.value(e, Type::Bool)
    }

    /// Resolves an expression of any type.
    pub(super) fn any_value(&mut self, e: &Written) -> Option<Expr> {
        let typed = self.infer(e, None)?;
        self.settle(typed)
    }

    /// Resolves an expression in its own type.
    pub(super) fn infer(&mut self, e: &Written, hint: Option<Type>) -> Option<Typed> {
        let at = e.at.0;
        match &e.kind {
            Form::Literal(l) => self.literal(l, at),
            Form::Path(p) => self.path(p, at),
            Form::Direct(text) => {
                let r = self.refer_direct(text, at)?;
                self.read(r, at)
            }
            Form::Unary(op, operand) => self.unary(*op, operand, hint, at),
            Form::Binary(..) => self.chain(e, hint),
            Form::Timer { t1, e, t2 } => self.timer(t1, e, t2.as_deref(), at),
            Form::Call(path, args) => self.call(path, args, hint, at),
            Form::Element(path, index, bit) => self.read_element(path, index, bit.as_deref(), at),
            // Only a declaration of an array has one, and the parser reads it nowhere else.
            Form::List(_) | Form::Bad => None,
        }
    }

    /// Resolves a chain of operators, `a or b or c …`, with a loop over the left operands, so that
    /// a long chain needs no stack.
    fn chain(&mut self, e: &Written, hint: Option<Type>) -> Option<Typed> {
        let Form::Binary(op, left, right) = &e.kind else { return None };
        if !matches!(left.kind, Form::Binary(..)) {
            let hint = hint.filter(|_| operator::keeps_type(*op));
            let a = self.infer(left, hint);
            let b = self.infer(right, hint);
            return self.combine(*op, a?, b?, e.at.0);
        }
        let mut rest = Vec::new();
        let (mut left, mut hint) = (e, hint);
        while let Form::Binary(op, l, r) = &left.kind {
            hint = hint.filter(|_| operator::keeps_type(*op));
            rest.push((*op, &**r, left.at.0, hint));
            left = l;
        }
        let mut result = self.infer(left, hint);
        while let Some((op, right, at, hint)) = rest.pop() {
            // The right side is resolved even if the left one failed, so that its problems are
            // reported too.
            let right = self.infer(right, hint);
            result = match (result, right) {
                (Some(a), Some(b)) => self.combine(op, a, b, at),
                _ => None,
            };
        }
        result
    }

    fn literal(&mut self, l: &Literal, at: Span) -> Option<Typed> {
        match l {
            Literal::Bool(b) => Some(Typed::constant(Value::Bool(*b), Type::Bool, at)),
            Literal::Int(n, ty) => self.typed_literal(Typed::untyped(Value::Int(*n), at), *ty),
            Literal::Real(text, ty) => match text.parse::<f64>() {
                Ok(x) if x.is_finite() => self.typed_literal(Typed::untyped(Value::Real(x), at), *ty),
                _ => {
                    let what = say!("{} does not fit into LREAL", Said::foreign(text.as_ref()));
                    self.report(Problem::new(&codes::OUT_OF_RANGE, at, what))
                }
            },
            Literal::Time(time) => {
                Some(Typed::constant(Value::Int(i128::from(time.count())), Type::Time, at))
            }
            Literal::Moment(moment, time) => {
                Some(Typed::constant(Value::Int(i128::from(time.count())), Type::Moment(*moment), at))
            }
            Literal::Str(s) => {
                let Some(len) = u16::try_from(s.len()).ok().filter(|n| *n <= g7_engine::TEXT) else {
                    let what = say!("a text has at most {} bytes", g7_engine::TEXT);
                    return self.report(Problem::new(&codes::OUT_OF_RANGE, at, what));
                };
                Some(Typed::constant(Value::Str(s.clone()), Type::String(len.max(1)), at))
            }
        }
    }

    /// `INT#5`.
    fn typed_literal(&mut self, t: Typed, ty: Option<Type>) -> Option<Typed> {
        let Some(ty) = ty else { return Some(t) };
        self.coerce(t, ty).map(|expr| Typed { expr, literal: false })
    }

    fn path(&mut self, p: &Path, at: Span) -> Option<Typed> {
        if let (Role::Constant, [name]) = (self.frame.role, p.names.as_slice()) {
            self.not_yet_known(name)?;
        }
        let r = self.refer(&p.names)?;
        self.read(r, at)
    }

    /// Reports a constant that uses itself, or one that is declared later.
    fn not_yet_known(&mut self, name: &g7_model::Name) -> Option<()> {
        let Some(Entity::Var(v)) = self.entity(&name.text) else { return Some(()) };
        self.has_value(v, &name.text, name.at.0)
    }

    /// Reports a constant whose value is not known yet.
    pub(super) fn has_value(&mut self, v: VarId, name: &str, at: Span) -> Option<()> {
        if !self.pending.contains(&v) {
            return Some(());
        }
        let declared = self.var(v)?.at;
        let what = say!("`{name}` has no value yet");
        self.report(
            Problem::new(&codes::NOT_CONSTANT, at, what)
                .related(declared, say!("declared here"))
                .help(say!("constants get their values in the order of the text")),
        )
    }

    /// The value behind a reference.
    pub(super) fn read(&mut self, r: Ref, at: Span) -> Option<Typed> {
        if !self.may_read(r, at) {
            return None;
        }
        let scans = self.unit.rules.scan_clock;
        Some(match r {
            Ref::Var(v) => {
                let var = self.var(v)?;
                if var.class == VarClass::Const {
                    return Some(Typed::constant(var.init.clone(), var.ty, at));
                }
                Typed::of(ExprKind::Var(v), var.ty, at)
            }
            Ref::Member(v, m) => {
                let Type::Fb(kind) = self.var(v)?.ty else { return None };
                let ty = kind.members().get(usize::from(m))?.1;
                Typed::of(ExprKind::Member(v, m), ty, at)
            }
            Ref::Bit(v, bit) => return self.bit_of(v, bit, at),
            Ref::Active(s) => Typed::of(ExprKind::StepActive(s), Type::Bool, at),
            Ref::Time(s, TimeUnit::Clock) if scans => Typed::of(ExprKind::StepScans(s), Type::Int, at),
            Ref::Time(s, TimeUnit::Clock) => Typed::of(ExprKind::StepTime(s), Type::Time, at),
            Ref::Time(s, TimeUnit::Tenths) => Typed::of(ExprKind::StepTenths(s), Type::Int, at),
            Ref::Time(s, TimeUnit::Seconds) => Typed::of(ExprKind::StepSeconds(s), Type::Real, at),
        })
    }

    fn unary(&mut self, op: UnaryOp, operand: &Written, hint: Option<Type>, at: Span) -> Option<Typed> {
        match op {
            UnaryOp::Not => self.complement(operand, hint, at),
            UnaryOp::Neg => self.minus(operand, hint, at),
            UnaryOp::Rise | UnaryOp::Fall => {
                let allowed = self.allow_watch(say!("an edge"), at);
                let e = self.watched(operand)?;
                allowed?;
                let e = Box::new(e);
                let kind = if op == UnaryOp::Rise { ExprKind::Rise(e) } else { ExprKind::Fall(e) };
                Some(Typed::of(kind, Type::Bool, at))
            }
        }
    }

    /// `not e`, of a BOOL or a bit string.
    pub(super) fn complement(&mut self, operand: &Written, hint: Option<Type>, at: Span) -> Option<Typed> {
        let t = self.infer(operand, hint)?;
        if t.expr.ty.is_bits() {
            return Some(bits::complement(t.expr, at));
        }
        let e = self.coerce(t, Type::Bool)?;
        Some(match e.kind {
            ExprKind::Const(Value::Bool(b)) => Typed::constant(Value::Bool(!b), Type::Bool, at),
            _ => Typed::of(ExprKind::Not(Box::new(e)), Type::Bool, at),
        })
    }

    fn minus(&mut self, operand: &Written, hint: Option<Type>, at: Span) -> Option<Typed> {
        let t = self.infer(operand, hint)?;
        let ty = t.expr.ty;
        if t.literal {
            let negated = match t.value()? {
                Value::Int(n) => Value::Int(n.checked_neg()?),
                Value::Real(x) => Value::Real(-x),
                Value::Bool(_) | Value::Str(_) => return None,
            };
            return Some(Typed::untyped(negated, at));
        }
        let signed = ty.bounds().is_none_or(|(least, _)| least < 0);
        if !(ty.is_number() || ty == Type::Time) || !signed {
            let problem = Problem::new(&codes::WRONG_OPERANDS, at, say!("{ty} has no minus sign"));
            return self.report(match ty {
                Type::Bool => problem.help(say!("the complement is written `not`")),
                _ if ty.is_number() => problem.help(say!("convert it first, as in `-{ty}_TO_DINT(…)`")),
                _ => problem,
            });
        }
        if let Some(v) = t.value() {
            match constant::negate(ty, v) {
                Ok(Some(v)) => return Some(Typed::constant(v, ty, at)),
                Ok(None) => {}
                Err(fault) => return self.constant_fault(fault, ty, at),
            }
        }
        Some(Typed::of(ExprKind::Neg(Box::new(t.expr)), ty, at))
    }

    fn timer(&mut self, t1: &Written, e: &Written, t2: Option<&Written>, at: Span) -> Option<Typed> {
        let allowed = self.allow_watch(say!("a delay"), at);
        let t1 = self.within_watch(|r| r.value(t1, Type::Time));
        let e = self.watched(e);
        let t2 = match t2 {
            Some(t) => Some(self.within_watch(|r| r.value(t, Type::Time))?),
            None => None,
        };
        allowed?;
        let kind = ExprKind::Timer { t1: Box::new(t1?), e: Box::new(e?), t2: t2.map(Box::new) };
        Some(Typed::of(kind, Type::Bool, at))
    }

    /// A BOOL that is evaluated in every pass, outside of any body.
    pub(super) fn watched(&mut self, e: &Written) -> Option<Expr> {
        self.within_watch(|r| r.condition(e))
    }

    fn within_watch<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.frame.watched, true);
        let result = read(self);
        self.frame.watched = outer;
        result
    }

    /// Edges and delays need a memory of the scan before, which some code does not have.
    fn allow_watch(&mut self, what: Said, at: Span) -> Option<()> {
        let place = match self.frame.role {
            Role::Code | Role::Section(_) => return Some(()),
            Role::Function(_) => say!("a function"),
            Role::Query => say!("a test or a question"),
            Role::Constant => say!("a constant"),
        };
        let problem = Problem::new(&codes::NOT_HERE, at, say!("{what} cannot stand in {place}"));
        self.report(match self.frame.role {
            Role::Function(_) => problem.help(say!("a function remembers nothing; pass the value in")),
            _ => problem,
        })
    }

    /// Resolves the arguments of a call that failed, so that their problems are reported too.
    pub(super) fn read_all(&mut self, args: &[Arg]) {
        for a in args.iter().filter(|a| !a.output) {
            let _ = self.infer(&a.value, None);
        }
    }
}
