//! Structured Text: statements, targets and blocks with their own variables.

use g7_model::{
    Arg, Block, CaseArm, Expr as Written, ExprKind as Form, Fix, Name, Path, Problem, Said, Span,
    Stmt as WrittenStmt, StmtKind as Statement, Type, Work, codes, say,
};

use super::refer::Ref;
use super::resolver::{Resolver, Role};
use super::scopes::Entity;
use crate::ir::{Expr, ExprKind, Service, Stmt, StmtKind, Target, Value, VarClass, VarId};

impl Resolver<'_, '_> {
    /// One statement or a block.
    pub(super) fn work(&mut self, work: &Work) -> Vec<Stmt> {
        match work {
            Work::Single(s) => self.statements(std::slice::from_ref(s)),
            Work::Block(b) => self.block(b, ""),
        }
    }

    /// A block; its variables are set again at the start of each run.
    pub(super) fn block(&mut self, block: &Block, owner: &str) -> Vec<Stmt> {
        let outer = (!block.locals.is_empty()).then(|| self.frame.locals.clone());
        let mut statements = Vec::new();
        for local in &block.locals {
            let value = match &local.init {
                // The value is resolved before the names of the variables are known, so it cannot
                // refer to them.
                Some(e) => self.value(e, local.ty.base),
                None => {
                    let kind = ExprKind::Const(super::resolver::zero(local.ty.base));
                    Some(Expr { kind, ty: local.ty.base, at: local.at.0 })
                }
            };
            for name in &local.names {
                let v = self.declare_local(name, local.ty.base, owner);
                if let (Some(v), Some(value)) = (v, &value) {
                    let kind = StmtKind::Assign(Target::Var(v), value.clone());
                    statements.push(Stmt { kind, at: name.at.0 });
                }
            }
        }
        if statements.is_empty() {
            statements = self.statements(&block.statements);
        } else {
            statements.append(&mut self.statements(&block.statements));
        }
        if let Some(outer) = outer {
            self.frame.locals = outer;
        }
        statements
    }

    fn declare_local(&mut self, name: &Name, ty: Type, owner: &str) -> Option<VarId> {
        if let Type::Fb(kind) = ty {
            let what = say!("a {} remembers; a local variable does not", kind);
            return self.report(
                Problem::new(&codes::BAD_DECLARATION, name.at.0, what)
                    .help(say!("declare the instance in the chart or in the file")),
            );
        }
        self.fitting_string(ty, name.at.0)?;
        let before = self.frame.locals.get(&name.text).and_then(|v| self.var(*v));
        if let Some(first) = before.map(|v| v.at) {
            self.defined_twice(name, first);
            return None;
        }
        let qualified =
            if owner.is_empty() { name.text.clone() } else { format!("{owner}.{}", name.text).into() };
        let v = self.add_var(qualified, VarClass::Local, ty, name.at.0);
        self.frame.locals.insert(name.text.clone(), v);
        Some(v)
    }

    /// The statements that could be resolved, in their order.
    pub(super) fn statements(&mut self, list: &[WrittenStmt]) -> Vec<Stmt> {
        let mut resolved = Vec::with_capacity(list.len());
        list.iter().for_each(|s| resolved.extend(self.statement(s)));
        resolved
    }

    fn statement(&mut self, s: &WrittenStmt) -> Option<Stmt> {
        let at = s.at.0;
        let kind = match &s.kind {
            Statement::Assign { target, value } => self.assignment(target, value)?,
            Statement::Call(path, args) => self.call_statement(path, args, at)?,
            Statement::If(arms, otherwise) => self.if_statement(arms, otherwise),
            Statement::Case(selector, arms, otherwise) => self.case(selector, arms, otherwise)?,
            Statement::For { var, from, to, by, body } => self.for_loop(var, from, to, by.as_ref(), body)?,
            Statement::While(condition, body) => {
                let condition = self.condition(condition);
                let body = self.loop_body(body);
                StmtKind::While(condition?, body)
            }
            Statement::Repeat(body, until) => {
                let body = self.loop_body(body);
                StmtKind::Repeat(body, self.condition(until)?)
            }
            Statement::Exit if self.frame.loops == 0 => {
                let problem = Problem::new(&codes::EXIT_OUTSIDE, at, say!("EXIT stands in no loop"));
                return self.report(problem.help(say!("RETURN leaves the whole body")));
            }
            Statement::Exit => StmtKind::Exit,
            Statement::Return => StmtKind::Return,
        };
        Some(Stmt { kind, at })
    }

    fn assignment(&mut self, target: &Written, value: &Written) -> Option<StmtKind> {
        if let Some(step) = self.step_bit(target) {
            return self.preset(step, target.at.0, value);
        }
        if let Some(kind) = self.whole_arrays(target, value) {
            return kind;
        }
        if let Some((v, bit)) = self.bit_target(target) {
            let value = self.value(value, Type::Bool)?;
            return self.assign_bit(v, bit, value, target.at.0);
        }
        if matches!(target.kind, Form::Element(_, _, Some(_))) {
            return self.infer(value, None).and(None);
        }
        match self.target(target) {
            Some((target, ty)) => Some(StmtKind::Assign(target, self.value(value, ty)?)),
            None => {
                let _ = self.infer(value, None);
                None
            }
        }
    }

    /// The bit of a variable that an assignment writes.
    fn bit_target(&mut self, target: &Written) -> Option<(VarId, u8)> {
        let r = match &target.kind {
            Form::Path(path) if path.names.len() > 1 => self.found(&path.names)?,
            Form::Direct(text) if text.contains(":X") => self.refer_direct(text, target.at.0)?,
            Form::Element(path, index, Some(bit)) => return self.element_bit(path, index, bit, target.at.0),
            _ => return None,
        };
        if let Ref::Bit(v, bit) = r { Some((v, bit)) } else { None }
    }

    /// The step of `%X12` where PRE writes it.
    fn step_bit(&mut self, target: &Written) -> Option<crate::ir::StepId> {
        match &target.kind {
            Form::Direct(text) if self.frame.pre => match self.known_direct_step(text)? {
                Ref::Active(step) => Some(step),
                _ => None,
            },
            _ => None,
        }
    }

    /// `%X12 := TRUE` and `%X12 := FALSE` of PRE, as PL7 presets a chart: SET and RESET of a
    /// step bit, and no other assignment (PL7 reference manual, preliminary processing).
    fn preset(&mut self, step: crate::ir::StepId, at: Span, value: &Written) -> Option<StmtKind> {
        let value = self.value(value, Type::Bool)?;
        let refused = |what: Said| Problem::new(&codes::NOT_WRITABLE, at, what);
        if self.expansion(step).is_some() {
            let problem = refused(say!("the activity of a macro-step cannot be assigned"));
            return self.report(problem.help(say!("set a step of its expansion, as in `%X3.IN := TRUE`")));
        }
        match value.kind {
            ExprKind::Const(Value::Bool(true)) => Some(StmtKind::Service(Service::SetStep(step))),
            ExprKind::Const(Value::Bool(false)) => Some(StmtKind::Service(Service::ResetStep(step))),
            _ => {
                let problem = refused(say!("a step is set or reset, it does not follow a value"));
                self.report(problem.help(say!("write `IF … THEN %X12 := TRUE END_IF`")))
            }
        }
    }

    fn if_statement(&mut self, arms: &[(Written, Vec<WrittenStmt>)], otherwise: &[WrittenStmt]) -> StmtKind {
        let mut resolved = Vec::new();
        for (condition, body) in arms {
            let condition = self.condition(condition);
            let body = self.statements(body);
            if let Some(c) = condition {
                resolved.push((c, body));
            }
        }
        StmtKind::If(resolved, self.statements(otherwise))
    }

    fn loop_body(&mut self, body: &[WrittenStmt]) -> Vec<Stmt> {
        self.frame.loops += 1;
        let body = self.statements(body);
        self.frame.loops -= 1;
        body
    }

    fn for_loop(
        &mut self,
        var: &Name,
        from: &Written,
        to: &Written,
        by: Option<&Written>,
        body: &[WrittenStmt],
    ) -> Option<StmtKind> {
        let looped = self.loop_variable(var);
        let ty = looped.map_or(Type::Lint, |(_, ty)| ty);
        let from = self.value(from, ty);
        let to = self.value(to, ty);
        let by = by.map(|by| self.value(by, ty));
        if let Some(Some(Expr { kind: ExprKind::Const(Value::Int(0)), at, .. })) = &by {
            let problem = Problem::new(&codes::OUT_OF_RANGE, *at, say!("a loop by 0 never ends"));
            self.problems.push(problem);
        }
        let body = self.loop_body(body);
        let by = match by {
            Some(by) => Some(by?),
            None => None,
        };
        Some(StmtKind::For { var: looped?.0, from: from?, to: to?, by, body })
    }

    fn loop_variable(&mut self, var: &Name) -> Option<(VarId, Type)> {
        let r = self.refer(std::slice::from_ref(var))?;
        let (target, ty) = self.writable(r, var.at.0)?;
        match target {
            Target::Var(v) if ty.is_integer() => Some((v, ty)),
            _ => {
                let what = say!("a FOR loop counts in a whole number; `{}` is {ty}", var.text);
                self.report(Problem::new(&codes::WRONG_TYPE, var.at.0, what))
            }
        }
    }

    fn case(&mut self, selector: &Written, arms: &[CaseArm], otherwise: &[WrittenStmt]) -> Option<StmtKind> {
        let selector = self.any_value(selector).and_then(|e| self.selector(e));
        let ty = selector.as_ref().map_or(Type::Lint, |e| e.ty);
        let mut ranges = Vec::new();
        let mut resolved = Vec::new();
        for arm in arms {
            let mut labels = Vec::new();
            for (first, last) in &arm.labels {
                if let Some(range) = self.label(first, last.as_ref(), ty) {
                    labels.push((range.0, range.1));
                    ranges.push(range);
                }
            }
            resolved.push((labels, self.statements(&arm.body)));
        }
        self.overlaps(ranges);
        let otherwise = self.statements(otherwise);
        let selector = super::types::converted(selector?, Type::Lint);
        Some(StmtKind::Case(selector, resolved, otherwise))
    }

    fn selector(&mut self, e: Expr) -> Option<Expr> {
        let e = match e.ty.unsigned() {
            Some(number) => super::types::converted(e, number),
            None => e,
        };
        if e.ty.is_integer() && e.ty != Type::Ulint {
            return Some(e);
        }
        let what = say!("CASE selects by a whole number up to LINT; this is {}", e.ty);
        let problem = Problem::new(&codes::WRONG_TYPE, e.at, what);
        self.report(match e.ty {
            Type::Bool => problem.help(say!("use IF for a BOOL")),
            _ => problem,
        })
    }

    fn label(&mut self, first: &Written, last: Option<&Written>, ty: Type) -> Option<(i64, i64, Span)> {
        let low = self.label_value(first, ty);
        let high = last.map(|e| self.label_value(e, ty));
        let at = last.map_or(first.at.0, |l| first.at.0.to(l.at.0));
        let low = low?;
        let high = match high {
            Some(h) => h?,
            None => low,
        };
        if low > high {
            let what = say!("the range {low} .. {high} holds nothing");
            let order = say!("write {high} .. {low}");
            let fix = Fix::likely(order.clone(), at, format!("{high}..{low}"));
            return self.report(Problem::new(&codes::EMPTY_RANGE, at, what).help(order).fix(fix));
        }
        Some((low, high, at))
    }

    fn label_value(&mut self, e: &Written, ty: Type) -> Option<i64> {
        let role = std::mem::replace(&mut self.frame.role, Role::Constant);
        let value = self.value(e, ty);
        self.frame.role = role;
        let value = value?;
        match value.kind {
            ExprKind::Const(Value::Int(n)) => i64::try_from(n).ok(),
            _ => {
                self.report(Problem::new(&codes::NOT_CONSTANT, value.at, say!("a label must be a constant")))
            }
        }
    }

    /// Reports labels that overlap: for the common values only the first arm can run.
    fn overlaps(&mut self, mut ranges: Vec<(i64, i64, Span)>) {
        ranges.sort_by_key(|r| (r.0, r.2));
        let mut widest: Option<(i64, Span)> = None;
        for (low, high, at) in ranges {
            if let Some((end, before)) = widest.filter(|(end, _)| *end >= low) {
                let (first, second) = if before < at { (before, at) } else { (at, before) };
                let shared = if low == end.min(high) {
                    say!("{low} is selected twice")
                } else {
                    say!("{low} .. {} is selected twice", end.min(high))
                };
                self.problems.push(
                    Problem::new(&codes::LABELS_OVERLAP, second, shared)
                        .related(first, say!("this arm runs")),
                );
            }
            if widest.is_none_or(|(end, _)| high > end) {
                widest = Some((high, at));
            }
        }
    }

    /// The target of an assignment, with its type.
    pub(super) fn target(&mut self, e: &Written) -> Option<(Target, Type)> {
        let at = e.at.0;
        let r = match &e.kind {
            Form::Path(p) => match p.names.as_slice() {
                [name] => self.own_output(name).or_else(|| self.refer(&p.names))?,
                names => self.refer(names)?,
            },
            Form::Direct(text) => self.refer_direct(text, at)?,
            Form::Element(path, index, None) => return self.element_target(path, index, at),
            Form::Element(..) => {
                let what = say!("a bit cannot be written here");
                return self.report(Problem::new(&codes::NOT_WRITABLE, at, what));
            }
            Form::Bad => return None,
            _ => {
                let what = say!("only a variable can be assigned");
                return self.report(Problem::new(&codes::NOT_WRITABLE, at, what));
            }
        };
        self.writable(r, at)
    }

    /// The output of the section at hand.
    fn own_output(&self, name: &Name) -> Option<Ref> {
        match (self.frame.role, self.entity(&name.text)) {
            (Role::Section(own), Some(Entity::Section(s))) if s == own => {
                self.unit.sections.get(s.index()).map(|s| Ref::Var(s.output))
            }
            _ => None,
        }
    }

    /// A reference as a target; reports a problem if it is read-only here.
    pub(super) fn writable(&mut self, r: Ref, at: Span) -> Option<(Target, Type)> {
        match r {
            Ref::Var(v) => {
                let (class, ty) = self.var(v).map(|v| (v.class, v.ty))?;
                if let Type::Fb(kind) = ty {
                    let what = say!("an instance of {} cannot be assigned", kind);
                    return self.report(
                        Problem::new(&codes::NOT_WRITABLE, at, what)
                            .help(say!("call it, or assign one of its inputs")),
                    );
                }
                self.may_write(v, class, at)?;
                Some((Target::Var(v), ty))
            }
            Ref::Member(v, m) => {
                let Type::Fb(kind) = self.var(v)?.ty else { return None };
                let (name, ty, input) = *kind.members().get(usize::from(m))?;
                if !input {
                    let what = say!("`{name}` is an output of the {}", kind);
                    return self.report(Problem::new(&codes::NOT_WRITABLE, at, what));
                }
                self.may_write(v, VarClass::Internal, at)?;
                Some((Target::Member(v, m), ty))
            }
            Ref::Bit(v, bit) => self.no_bit_here(v, bit, at),
            Ref::Active(_) | Ref::Time(..) => {
                let problem =
                    Problem::new(&codes::NOT_WRITABLE, at, say!("the state of a step cannot be assigned"));
                self.report(problem.help(say!(
                    "transitions, forcing orders and SETSTEP change it, and in PRE `%X12 := TRUE` or `FALSE`"
                )))
            }
        }
    }

    /// Checks that this code may write this variable; reports a problem if not.
    pub(super) fn may_write(&mut self, v: VarId, class: VarClass, at: Span) -> Option<()> {
        let name = self.var(v).map(|v| v.name.clone())?;
        let refused = |what: Said| Problem::new(&codes::NOT_WRITABLE, at, say!("`{name}` is {what}"));
        let declared = self.var(v).map(|v| v.at)?;
        match class {
            VarClass::Input => {
                let problem = refused(say!("an input")).related(declared, say!("declared here"));
                return self
                    .report(problem.help(say!("inputs come from outside; write an `output` or a `var`")));
            }
            VarClass::Const => {
                let problem = refused(say!("a constant")).related(declared, say!("declared here"));
                return self.report(problem.help(say!("declare it as `var` if it is to change")));
            }
            VarClass::System if super::system::kept_by_system(&name) => {
                return self.report(refused(say!("kept by the system")));
            }
            VarClass::Output | VarClass::Internal | VarClass::Local | VarClass::System => {}
        }
        match self.frame.role {
            Role::Function(f) => {
                let input = self.unit.functions.get(f.index()).is_some_and(|f| f.params.contains(&v));
                if input {
                    return self.report(refused(say!("an input of the function")));
                }
                if class != VarClass::Local {
                    let problem = refused(say!("not the function's own"));
                    return self.report(problem.help(say!("a function only computes its result")));
                }
            }
            Role::Section(s) => {
                let own = self.unit.sections.get(s.index()).map(|s| s.output) == Some(v);
                if !own && class != VarClass::Local {
                    let problem = refused(say!("not the output of this transition section"));
                    return self
                        .report(problem.help(say!("a section assigns only the BOOL that has its name")));
                }
            }
            Role::Code | Role::Query | Role::Constant => {
                if self.scopes.section_outputs.contains(&v) {
                    let problem = refused(say!("the output of a transition section"));
                    return self.report(problem.related(declared, say!("only this section assigns it")));
                }
            }
        }
        Some(())
    }

    fn call_statement(&mut self, path: &Path, args: &[Arg], at: Span) -> Option<StmtKind> {
        if let Some(kind) = self.instance_call(path, args) {
            return kind;
        }
        if let [name] = path.names.as_slice()
            && self.entity(&name.text).is_none()
            && let Some(kind) = self.service(name, args, at)
        {
            return kind.map(StmtKind::Service);
        }
        // A function called as a statement: its arguments are checked, its result is lost.
        self.call(path, args, None, at)?;
        let what = say!("nothing takes the result of `{}`", path.text());
        self.report(Problem::new(&codes::WRONG_KIND, at, what).help(say!("assign it: `n := …`")))
    }

    /// The call of a function block; the outer `None` means that the path names none.
    #[allow(clippy::option_option, reason = "no instance, or an instance called wrongly")]
    fn instance_call(&mut self, path: &Path, args: &[Arg]) -> Option<Option<StmtKind>> {
        let last = path.names.last()?;
        let Some(Entity::Var(v)) = self.named(&path.names) else { return None };
        let Type::Fb(kind) = self.var(v)?.ty else { return None };
        Some(self.fb_call(v, kind, last, args))
    }

    /// A service of the controller; the outer `None` means that the name is not one.
    #[allow(clippy::option_option, reason = "no service, or a service called wrongly")]
    fn service(&mut self, name: &Name, args: &[Arg], at: Span) -> Option<Option<Service>> {
        let wanted = match name.text.to_ascii_uppercase().as_str() {
            "INITCHART" | "CLEARCHART" | "SETSTEP" | "RESETSTEP" => 1,
            "FREEZECHART" => 2,
            "RESET_XIT" => 0,
            _ => return None,
        };
        Some(self.service_call(name, wanted, args, at))
    }

    fn service_call(&mut self, name: &Name, wanted: usize, args: &[Arg], at: Span) -> Option<Service> {
        if self.frame.role != Role::Code {
            let what = say!("the service `{}` cannot be called here", name.text);
            return self.report(
                Problem::new(&codes::NOT_HERE, name.at.0, what)
                    .help(say!("call it in an action or a PRE section")),
            );
        }
        if args.len() != wanted || args.iter().any(|a| a.name.is_some()) {
            let what = say!("`{}` takes {wanted} arguments by position", name.text);
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        }
        let first = args.first().map(|a| &a.value);
        match name.text.to_ascii_uppercase().as_str() {
            "INITCHART" => self.chart_argument(first?).map(Service::InitChart),
            "CLEARCHART" => self.chart_argument(first?).map(Service::ClearChart),
            "SETSTEP" => self.step_argument(first?).map(Service::SetStep),
            "RESETSTEP" => self.step_argument(first?).map(Service::ResetStep),
            "FREEZECHART" => {
                let chart = self.chart_argument(first?);
                let freeze = self.condition(&args.get(1)?.value);
                Some(Service::FreezeChart(chart?, Box::new(freeze?)))
            }
            _ => Some(Service::ResetTimes),
        }
    }

    fn chart_argument(&mut self, e: &Written) -> Option<crate::ir::ChartId> {
        if let Form::Path(p) = &e.kind
            && let [name] = p.names.as_slice()
        {
            return self.chart_named(name);
        }
        self.report(Problem::new(&codes::WRONG_ARGUMENTS, e.at.0, say!("the name of a chart is needed here")))
    }

    fn step_argument(&mut self, e: &Written) -> Option<crate::ir::StepId> {
        let r = match &e.kind {
            Form::Path(p) => self.refer(&p.names)?,
            Form::Direct(text) => self.refer_direct(text, e.at.0)?,
            _ => return self.no_step(e.at.0),
        };
        match r {
            Ref::Active(s) => Some(s),
            _ => self.no_step(e.at.0),
        }
    }

    fn no_step<T>(&mut self, at: Span) -> Option<T> {
        let what = say!("a step is needed here");
        self.report(
            Problem::new(&codes::WRONG_ARGUMENTS, at, what).help(say!("write its activity, as in `G.X12`")),
        )
    }
}
