//! Executes statements of Structured Text.

use g7_model::{Arg, Block, CaseArm, Expr, ExprKind, Path, Stmt, StmtKind, Type, Work};

use super::bits;
use super::exec::{Exec, Frame, Slot};
use super::instances::chart_written;
use super::model::ScopeId;
use super::named::held;
use super::resolve::Ref;
use super::state::{Request, Timing};
use super::value::{Run, Typed, Value, bad};

/// How a statement ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Flow {
    Next,
    Exit,
    Return,
}

impl Exec<'_> {
    /// Runs a body that has local variables.
    pub(super) fn body(&mut self, scope: ScopeId, block: &Block) -> Run<()> {
        let mut frame = Frame::new();
        self.locals(scope, block, &mut frame)?;
        self.frames.push(frame);
        let ran = self.block(scope, &block.statements);
        self.frames.pop();
        ran.map(|_| ())
    }

    /// Runs an assignment, a call or a body.
    pub(super) fn work(&mut self, scope: ScopeId, work: &Work) -> Run<()> {
        match work {
            Work::Single(s) => self.statement(scope, s).map(|_| ()),
            Work::Block(b) => self.body(scope, b),
        }
    }

    pub(super) fn block(&mut self, scope: ScopeId, statements: &[Stmt]) -> Run<Flow> {
        for s in statements {
            let flow = self.statement(scope, s)?;
            if flow != Flow::Next {
                return Ok(flow);
            }
        }
        Ok(Flow::Next)
    }

    fn statement(&mut self, scope: ScopeId, s: &Stmt) -> Run<Flow> {
        match &s.kind {
            StmtKind::Assign { target, value } => {
                if self.copied_whole(scope, target, value)? {
                    return Ok(Flow::Next);
                }
                if let Some(copied) = self.copied(scope, target, value) {
                    return copied.map(|()| Flow::Next);
                }
                if let ExprKind::Element(path, index, bit) = &target.kind {
                    // The index is evaluated before the value.
                    let indexes = self.indexes(scope, index)?;
                    let value = self.eval(scope, value)?;
                    let element = self.element(scope, path, &indexes, bit.as_deref())?;
                    return self.put(Some(element), &value).map(|()| Flow::Next);
                }
                let value = self.eval(scope, value)?;
                self.assign(scope, target, &value)?;
                Ok(Flow::Next)
            }
            StmtKind::Call(path, args) => {
                self.call_statement(scope, path, args)?;
                Ok(Flow::Next)
            }
            StmtKind::If(branches, otherwise) => {
                for (condition, body) in branches {
                    if self.truth(scope, condition)? {
                        return self.block(scope, body);
                    }
                }
                self.block(scope, otherwise)
            }
            StmtKind::Case(selector, arms, otherwise) => {
                let value = self.eval(scope, selector)?.whole()?;
                for arm in arms {
                    if self.arm_holds(scope, arm, value)? {
                        return self.block(scope, &arm.body);
                    }
                }
                self.block(scope, otherwise)
            }
            StmtKind::For { var, from, to, by, body } => {
                let path = Path { names: vec![var.clone()] };
                let target = Expr { kind: ExprKind::Path(path), at: s.at };
                self.repeat_for(scope, &target, [from, to], by.as_ref(), body)
            }
            StmtKind::While(condition, body) => {
                while self.truth(scope, condition)? {
                    match self.block(scope, body)? {
                        Flow::Next => self.jump()?,
                        Flow::Exit => break,
                        Flow::Return => return Ok(Flow::Return),
                    }
                }
                Ok(Flow::Next)
            }
            StmtKind::Repeat(body, until) => loop {
                match self.block(scope, body)? {
                    Flow::Next => {}
                    Flow::Exit => return Ok(Flow::Next),
                    Flow::Return => return Ok(Flow::Return),
                }
                if self.truth(scope, until)? {
                    return Ok(Flow::Next);
                }
                self.jump()?;
            },
            StmtKind::Exit => Ok(Flow::Exit),
            StmtKind::Return => Ok(Flow::Return),
        }
    }

    fn arm_holds(&mut self, scope: ScopeId, arm: &CaseArm, value: i128) -> Run<bool> {
        for (low, high) in &arm.labels {
            let low = self.eval(scope, low)?.whole()?;
            let high = match high {
                Some(h) => self.eval(scope, h)?.whole()?,
                None => low,
            };
            if (low..=high).contains(&value) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Runs FOR: start, end and step are evaluated once, before the first iteration.
    fn repeat_for(
        &mut self,
        scope: ScopeId,
        target: &Expr,
        [from, to]: [&Expr; 2],
        by: Option<&Expr>,
        body: &[Stmt],
    ) -> Run<Flow> {
        let from = self.eval(scope, from)?;
        let to = self.eval(scope, to)?.whole()?;
        let by = match by {
            Some(e) => self.eval(scope, e)?.whole()?,
            None => 1,
        };
        self.assign(scope, target, &from)?;
        loop {
            let at = self.eval(scope, target)?.whole()?;
            if (by >= 0 && at > to) || (by < 0 && at < to) {
                return Ok(Flow::Next);
            }
            match self.block(scope, body)? {
                Flow::Next => {}
                Flow::Exit => return Ok(Flow::Next),
                Flow::Return => return Ok(Flow::Return),
            }
            let next = self.eval(scope, target)?.whole()? + by;
            self.assign(scope, target, &Typed { ty: None, v: Value::Int(next) })?;
            self.jump()?;
        }
    }

    pub(super) fn assign(&mut self, scope: ScopeId, target: &Expr, value: &Typed) -> Run<()> {
        let found = match &target.kind {
            ExprKind::Path(p) => {
                if let Some(done) = self.assign_local(p, value) {
                    return done;
                }
                let p = self.numbered(scope, p)?;
                self.resolve(scope, &p)
            }
            ExprKind::Direct(d) => self.m.resolve_direct(d),
            ExprKind::Element(path, index, bit) => {
                let indexes = self.indexes(scope, index)?;
                Some(self.element(scope, path, &indexes, bit.as_deref())?)
            }
            _ => None,
        };
        self.put(found, value)
    }

    fn put(&mut self, to: Option<Ref>, value: &Typed) -> Run<()> {
        match to {
            Some(Ref::Var(v)) => {
                self.s.vars[v] = held(self.m.vars[v].range, value.to(self.m.vars[v].ty)?)?;
                self.written.push(v);
                Ok(())
            }
            Some(Ref::Member(v, member)) => {
                self.written.push(v);
                let Value::Fb(f) = &mut self.s.vars[v] else { return bad("a member of no block") };
                set_member(f, &member, value)
            }
            Some(Ref::Bit(v, k)) => {
                self.written.push(v);
                let on = value.truth()?;
                let Value::Int(n) = &mut self.s.vars[v] else { return bad("a bit of no number") };
                *n = bits::replaced(self.m.vars[v].ty, *n, k, on);
                Ok(())
            }
            // `%X12 := TRUE` of PRE.
            Some(Ref::Active(step)) => {
                let set = value.to(Type::Bool)? == Value::Bool(true);
                self.s.requests.push(if set { Request::Set(step) } else { Request::Reset(step) });
                Ok(())
            }
            _ => bad("an assignment to nothing"),
        }
    }

    fn assign_local(&mut self, p: &Path, value: &Typed) -> Option<Run<()>> {
        let (first, rest) = p.names.split_first()?;
        let slot = self.frames.last_mut()?.get_mut(&*first.text)?;
        match (rest, &mut slot.value) {
            ([], _) => Some(slot.set(value)),
            ([member], Value::Fb(f)) => Some(set_member(f, &member.text, value)),
            ([k], Value::Int(n)) => {
                let k = k.text.parse().ok()?;
                Some(value.truth().map(|on| *n = bits::replaced(slot.ty, *n, k, on)))
            }
            _ => None,
        }
    }

    fn call_statement(&mut self, scope: ScopeId, path: &Path, args: &[Arg]) -> Run<()> {
        if self.call_own(scope, path, args)? {
            return Ok(());
        }
        if let Some(instance) = self.instance(scope, path) {
            return self.call_block(scope, instance, args);
        }
        match &*path.text().to_ascii_uppercase() {
            "RESET_XIT" => {
                let restart = Timing { since: self.s.now, since_scan: self.s.scan, kept: 0, kept_scans: 0 };
                self.s.timing.fill(restart);
                self.s.macro_timing.values_mut().for_each(|t| *t = restart);
                Ok(())
            }
            service @ ("INITCHART" | "CLEARCHART" | "FREEZECHART") => {
                let named = args.first().and_then(|a| chart_written(&a.value));
                let chart = named.and_then(|name| self.m.chart_named(scope, &name));
                let Some(chart) = chart else { return bad(format!("{service} of no chart")) };
                let request = match service {
                    "INITCHART" => Request::Init(chart),
                    "CLEARCHART" => Request::Clear(chart),
                    _ => match args.get(1) {
                        Some(arg) => Request::Freeze(chart, self.truth(scope, &arg.value)?),
                        None => return bad("FREEZECHART without its second argument"),
                    },
                };
                self.s.requests.push(request);
                Ok(())
            }
            service @ ("SETSTEP" | "RESETSTEP") => {
                let step = match args.first().map(|a| &a.value.kind) {
                    Some(ExprKind::Path(p)) => self.m.resolve_step(scope, p),
                    Some(ExprKind::Direct(d)) => match self.m.resolve_direct(d) {
                        Some(Ref::Active(step)) => Some(step),
                        _ => None,
                    },
                    _ => None,
                };
                let Some(step) = step else { return bad(format!("{service} of no step")) };
                let request = if service == "SETSTEP" { Request::Set(step) } else { Request::Reset(step) };
                self.s.requests.push(request);
                Ok(())
            }
            _ => self.call(scope, path, args).map(|_| ()),
        }
    }

    fn instance(&self, scope: ScopeId, path: &Path) -> Option<Instance> {
        if let [one] = &path.names[..]
            && let Some(Slot { ty: Type::Fb(_), .. }) = self.frames.last().and_then(|f| f.get(&*one.text))
        {
            return Some(Instance::Local(one.text.to_string()));
        }
        match self.resolve(scope, path)? {
            Ref::Var(v) if matches!(self.m.vars[v].ty, Type::Fb(_)) => Some(Instance::Var(v)),
            _ => None,
        }
    }

    fn slot(&mut self, instance: &Instance) -> Option<&mut Value> {
        match instance {
            Instance::Local(name) => self.frames.last_mut()?.get_mut(name).map(|l| &mut l.value),
            Instance::Var(v) => self.s.vars.get_mut(*v),
        }
    }

    fn call_block(&mut self, scope: ScopeId, instance: Instance, args: &[Arg]) -> Run<()> {
        let now = self.s.now;
        let mut inputs = Vec::new();
        for arg in args.iter().filter(|a| !a.output) {
            inputs.push(self.eval(scope, &arg.value)?);
        }
        if let Instance::Var(v) = instance {
            self.written.push(v);
        }
        let Some(Value::Fb(f)) = self.slot(&instance) else { return bad("a call of no block") };
        for (i, (arg, value)) in args.iter().filter(|a| !a.output).zip(&inputs).enumerate() {
            let by_place = f.kind.members().get(i).map_or("", |m| m.0);
            let name = arg.name.as_ref().map_or(by_place, |n| &*n.text).to_owned();
            set_member(f, &name, value)?;
        }
        f.call(now)?;
        let after = f.clone();
        for arg in args.iter().filter(|a| a.output) {
            let member = arg.name.as_ref().map_or("", |n| &*n.text);
            let Some(value) = after.get(member) else { return bad(format!("no output {member}")) };
            let ty = super::fb::FbState::member_type(after.kind, member);
            self.assign(scope, &arg.value, &Typed { ty, v: value.clone() })?;
        }
        Ok(())
    }
}

enum Instance {
    Local(String),
    Var(usize),
}

fn set_member(f: &mut super::fb::FbState, member: &str, value: &Typed) -> Run<()> {
    let Some(ty) = super::fb::FbState::member_type(f.kind, member) else {
        return bad(format!("{} has no {member}", f.kind.name()));
    };
    let value = value.to(ty)?;
    f.set(member, value)
}
