//! Evaluates expressions recursively on the present state.

use std::collections::BTreeMap;

use g7_model::{
    Arg, BinaryOp, Expr, ExprKind, Function, Literal, Name, Operands, Path, StandardFunction, Type, UnaryOp,
    ValueType, VarDecl, VarKind,
};

use super::bits;
use super::builtin;
use super::composed::Running;
use super::model::{FILE, Model, ScopeId, StepId, VarId, is_name};
use super::named::{held, number_of};
use super::resolve::Ref;
use super::state::State;
use super::value::{NaiveFault, Run, Typed, Value, bad, binary, negate, zero};

/// The local variables of a running function, section or action body.
pub(super) type Frame = BTreeMap<String, Slot>;

/// A local variable.
#[derive(Clone)]
pub(super) struct Slot {
    pub(super) ty: Type,
    pub(super) value: Value,
    /// Its bounds.
    pub(super) range: Option<(i128, i128)>,
}

impl Slot {
    /// Gives it a value, or fails if its bounds forbid that.
    pub(super) fn set(&mut self, value: &Typed) -> Run<()> {
        self.value = held(self.range, value.to(self.ty)?)?;
        Ok(())
    }
}

/// Evaluates expressions and runs statements on a state.
pub(super) struct Exec<'a> {
    pub(super) m: &'a Model,
    pub(super) s: &'a mut State,
    pub(super) frames: Vec<Frame>,
    /// The function blocks whose bodies run, the innermost last.
    pub(super) running: Vec<Running>,
    /// The assigned variables, even if their value did not change.
    pub(super) written: Vec<VarId>,
}

/// Greatest number of loop iterations in a scan.
const WORK: u32 = 1_000_000;

impl<'a> Exec<'a> {
    pub(super) fn new(m: &'a Model, s: &'a mut State) -> Exec<'a> {
        Exec { m, s, frames: Vec::new(), running: Vec::new(), written: Vec::new() }
    }

    pub(super) fn truth(&mut self, scope: ScopeId, e: &Expr) -> Run<bool> {
        self.eval(scope, e)?.truth()
    }

    pub(super) fn eval_for(&mut self, scope: ScopeId, e: &Expr, ty: Type) -> Run<Value> {
        self.eval(scope, e)?.to(ty)
    }

    pub(super) fn eval(&mut self, scope: ScopeId, e: &Expr) -> Run<Typed> {
        match &e.kind {
            ExprKind::Literal(l) => literal(l),
            ExprKind::Path(p) => self.path(scope, p),
            ExprKind::Direct(d) => match self.m.resolve_direct(d) {
                Some(r) => self.read(&r),
                None => bad(format!("%{d} is nothing")),
            },
            ExprKind::Unary(UnaryOp::Not, x) => {
                let x = self.eval(scope, x)?;
                bits::complement(&x).unwrap_or_else(|| Ok(Typed::bool(!x.truth()?)))
            }
            ExprKind::Unary(UnaryOp::Neg, x) => negate(&self.eval(scope, x)?),
            ExprKind::Unary(UnaryOp::Rise, _) => Ok(Typed::bool(self.edge(e).is_some_and(|(b, h)| !b && h))),
            ExprKind::Unary(UnaryOp::Fall, _) => Ok(Typed::bool(self.edge(e).is_some_and(|(b, h)| b && !h))),
            ExprKind::Binary(op, a, b) => {
                let a = self.eval(scope, a)?;
                if decides(*op, &a)? {
                    return Ok(Typed::bool(a.truth()?));
                }
                let b = self.eval(scope, b)?;
                binary(*op, &a, &b)
            }
            ExprKind::Timer { t1, e: watched, t2 } => match self.watched_step(scope, watched, t2.is_some()) {
                Some(step) => {
                    let t1 = self.eval(scope, t1)?.duration()?;
                    Ok(Typed::bool(self.s.is_active(self.m, step) && self.s.time(self.m, step) >= t1))
                }
                None => Ok(Typed::bool(self.s.timers.get(&key(e)).is_some_and(|t| t.q))),
            },
            ExprKind::Call(path, args) => self.call(scope, path, args),
            ExprKind::Element(path, index, bit) => {
                let indexes = self.indexes(scope, index)?;
                let element = self.element(scope, path, &indexes, bit.as_deref())?;
                self.read(&element)
            }
            ExprKind::List(_) => bad("a list of values"),
            ExprKind::Bad => bad("an unreadable expression"),
        }
    }

    /// The step of `t/X12` (decision 12): the operand is a step variable itself, and there is no
    /// second time.
    pub(super) fn watched_step(&self, scope: ScopeId, e: &Expr, second: bool) -> Option<StepId> {
        if second || !is_name(e) {
            return None;
        }
        let found = match &e.kind {
            ExprKind::Path(p) => self.resolve(scope, p),
            ExprKind::Direct(d) => self.m.resolve_direct(d),
            _ => None,
        };
        if let Some(Ref::Active(step)) = found { Some(step) } else { None }
    }

    fn edge(&self, e: &Expr) -> Option<(bool, bool)> {
        self.s.edges.get(&key(e)).map(|m| (m.before, m.here))
    }

    fn path(&mut self, scope: ScopeId, p: &Path) -> Run<Typed> {
        if let Some(local) = self.local(p) {
            return local;
        }
        let p = &self.numbered(scope, p)?;
        match self.resolve(scope, p) {
            Some(r) => self.read(&r),
            None => bad(format!("{} is nothing", p.text())),
        }
    }

    fn local(&self, p: &Path) -> Option<Run<Typed>> {
        let (first, rest) = p.names.split_first()?;
        let Slot { ty, value, .. } = self.frames.last()?.get(&*first.text)?;
        match (rest, value) {
            ([], _) => Some(Ok(Typed::of(*ty, value.clone()))),
            ([member], Value::Fb(f)) => Some(member_of(f, &member.text)),
            ([k], Value::Int(n)) => Some(Ok(Typed::bool(bits::bit(*n, k.text.parse().ok()?)))),
            _ => None,
        }
    }

    pub(super) fn read(&mut self, r: &Ref) -> Run<Typed> {
        Ok(match r {
            Ref::Var(v) => Typed::of(self.m.vars[*v].ty, self.s.vars[*v].clone()),
            Ref::Member(v, member) => match &self.s.vars[*v] {
                Value::Fb(f) => return member_of(f, member),
                _ => return bad("a member of no block"),
            },
            Ref::Bit(v, k) => match &self.s.vars[*v] {
                Value::Int(n) => Typed::bool(bits::bit(*n, *k)),
                _ => return bad("a bit of no number"),
            },
            Ref::Value(n) => Typed::int(*n),
            Ref::Active(step) => Typed::bool(self.s.is_active(self.m, *step)),
            Ref::Time(step) if self.m.rules.scan_clock => Typed::int(self.s.scans(self.m, *step).into()),
            Ref::Time(step) => Typed::time(self.s.time(self.m, *step)),
            Ref::Seconds(step) => {
                let seconds = self.s.scans(self.m, *step) as f64 * (self.m.cycle as f64 / 1e9);
                Typed::of(Type::Real, Value::Real(seconds as f32))
            }
            Ref::Tenths(step) => {
                let tenths = self.s.time(self.m, *step) / 100_000_000;
                Typed::int(tenths.clamp(0, 9999).into())
            }
            Ref::Section(scope, name) => {
                let key = (*scope, name.clone());
                Typed::bool(self.s.sections.get(&key).is_some_and(|b| *b))
            }
        })
    }

    /// Evaluates a receptivity. If it is the name of a transition section, the section runs; any
    /// other expression reads the section's last result.
    pub(super) fn receptivity(&mut self, scope: ScopeId, e: &Expr) -> Run<bool> {
        if let ExprKind::Path(p) = &e.kind
            && let Some(Ref::Section(s, name)) = self.resolve(scope, p)
        {
            let value = self.section(s, &name)?.truth()?;
            self.s.sections.insert((s, name), value);
            return Ok(value);
        }
        self.truth(scope, e)
    }

    fn section(&mut self, scope: ScopeId, name: &str) -> Run<Typed> {
        let Some(section) = self.m.scopes[scope].sections.get(name) else { return bad("no such section") };
        let mut frame =
            Frame::from([(name.to_owned(), Slot { ty: Type::Bool, value: Value::Bool(false), range: None })]);
        self.locals(scope, &section.body, &mut frame)?;
        self.frames.push(frame);
        let ran = self.block(scope, &section.body.statements);
        let frame = self.frames.pop().unwrap_or_default();
        ran?;
        Ok(Typed::bool(frame.get(name).is_some_and(|slot| slot.value == Value::Bool(true))))
    }

    pub(super) fn call(&mut self, scope: ScopeId, path: &Path, args: &[Arg]) -> Run<Typed> {
        let name = path.text();
        if let Some(function) = self.m.functions.get(&name) {
            return self.function(scope, function, args);
        }
        if let Some(result) = self.operated(scope, &name, args)? {
            return Ok(result);
        }
        let mut values = Vec::new();
        for arg in args {
            values.push(self.eval(scope, &arg.value)?);
        }
        match number_of(self.m, &name, &values) {
            Some(number) => Ok(number),
            None => builtin::call(&name, &values),
        }
    }

    /// The function of an operator; one of more than two values goes from one to the next.
    fn operated(&mut self, scope: ScopeId, name: &str, args: &[Arg]) -> Run<Option<Typed>> {
        let Some(op) = StandardFunction::operator(name) else { return Ok(None) };
        let [first, rest @ ..] = args else { return Ok(None) };
        let mut left = self.eval(scope, &first.value)?;
        let compares = op.row().operands == Operands::Comparison;
        for arg in rest {
            if compares {
                let right = self.eval(scope, &arg.value)?;
                if !binary(op, &left, &right)?.truth()? {
                    return Ok(Some(Typed::bool(false)));
                }
                left = right;
            } else if !decides(op, &left)? {
                let right = self.eval(scope, &arg.value)?;
                left = binary(op, &left, &right)?;
            }
        }
        Ok(Some(if compares { Typed::bool(true) } else { left }))
    }

    fn function(&mut self, scope: ScopeId, f: &Function, args: &[Arg]) -> Run<Typed> {
        let mut frame = Frame::new();
        for (i, param) in f.params.iter().enumerate() {
            let by_name = args.iter().find(|a| a.name.as_ref().is_some_and(|n| n.text == param.name.text));
            let by_place = args.get(i).filter(|a| a.name.is_none());
            let value = match by_name.or(by_place) {
                Some(arg) => Some(self.eval(scope, &arg.value)?),
                None => None,
            };
            let mut slot = self.slot_of(&param.name, &param.ty)?;
            if let Some(value) = value {
                slot.set(&value)?;
            }
            frame.insert(param.name.text.to_string(), slot);
        }
        let name = f.name.text.to_string();
        frame.insert(name.clone(), self.slot_of(&f.name, &f.result)?);
        self.locals(scope, &f.body, &mut frame)?;
        self.frames.push(frame);
        let ran = self.block(FILE, &f.body.statements);
        let mut frame = self.frames.pop().unwrap_or_default();
        ran?;
        match frame.remove(&name) {
            Some(slot) => Ok(Typed::of(slot.ty, slot.value)),
            None => bad("a function without result"),
        }
    }

    /// Declares the local variables of a block, with their initial values.
    pub(super) fn locals(&mut self, scope: ScopeId, block: &g7_model::Block, frame: &mut Frame) -> Run<()> {
        for local in &block.locals {
            let Some(first) = local.names.first() else { continue };
            let mut slot = self.slot_of(first, &local.ty)?;
            if let Some(e) = &local.init {
                self.frames.push(frame.clone());
                let value = self.eval(scope, e);
                self.frames.pop();
                slot.set(&value?)?;
            }
            for name in &local.names {
                frame.insert(name.text.to_string(), slot.clone());
            }
        }
        Ok(())
    }

    /// A new local variable of this type, with its initial value.
    fn slot_of(&mut self, name: &Name, ty: &ValueType) -> Run<Slot> {
        let own = self.m.with_type(&VarDecl::of_type(VarKind::Var, vec![name.clone()], ty, name.at));
        let range = self.m.range(FILE, &own);
        let mut slot = Slot { ty: own.ty, value: zero(own.ty), range };
        if let Some(e) = &own.init {
            // The value of a type names nothing of a body.
            let frames = std::mem::take(&mut self.frames);
            let value = self.eval(FILE, e);
            self.frames = frames;
            slot.set(&value?)?;
        }
        Ok(slot)
    }

    /// Counts one loop iteration.
    pub(super) fn jump(&mut self) -> Run<()> {
        self.s.work += 1;
        if self.s.work > WORK { Err(NaiveFault::Work) } else { Ok(()) }
    }
}

/// True if the left operand decides, so that the right one is not evaluated (decision 23).
fn decides(op: BinaryOp, left: &Typed) -> Run<bool> {
    // A literal may stand for a bit string.
    if left.ty != Some(Type::Bool) {
        return Ok(false);
    }
    match op {
        BinaryOp::Or | BinaryOp::Add => left.truth(),
        BinaryOp::And | BinaryOp::Dot | BinaryOp::Mul => left.truth().map(|b| !b),
        _ => Ok(false),
    }
}

/// The key of an expression's memories: its address in the model.
pub(super) fn key(e: &Expr) -> usize {
    std::ptr::from_ref(e) as usize
}

fn member_of(f: &super::fb::FbState, member: &str) -> Run<Typed> {
    match (super::fb::FbState::member_type(f.kind, member), f.get(member)) {
        (Some(ty), Some(v)) => Ok(Typed::of(ty, v.clone())),
        _ => bad(format!("{} has no {member}", f.kind.name())),
    }
}

pub(super) fn literal(l: &Literal) -> Run<Typed> {
    let (ty, plain) = match l {
        Literal::Bool(b) => return Ok(Typed::bool(*b)),
        Literal::Time(t) => return Ok(Typed::time(t.count())),
        Literal::Moment(moment, t) => return Ok(Typed::of(Type::Moment(*moment), Value::Time(t.count()))),
        Literal::Str(s) => return Ok(Typed::of(Type::String(u16::MAX), Value::Str(s.to_string()))),
        Literal::Int(n, ty) => (*ty, Value::Int(*n)),
        Literal::Real(text, Some(Type::Real)) => match text.parse() {
            Ok(x) => return Ok(Typed::of(Type::Real, Value::Real(x))),
            Err(_) => return bad(format!("{text} is no number")),
        },
        Literal::Real(text, ty) => match text.parse() {
            Ok(x) => (*ty, Value::Lreal(x)),
            Err(_) => return bad(format!("{text} is no number")),
        },
    };
    let literal = Typed { ty: None, v: plain };
    match ty {
        Some(t) => Ok(Typed::of(t, literal.to(t)?)),
        None => Ok(literal),
    }
}
