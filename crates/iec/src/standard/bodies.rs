//! Rewrites expressions and statements with the names and forms of the standard.

use g7_model::codes;
use g7_model::{
    Arg, BinaryOp, Block, CaseArm, Expr, ExprKind, Literal, Name, Path, Said, Span, Stmt, StmtKind, Type,
    UnaryOp, VarDecl, VarKind, say,
};

use super::lower::Lower;
use crate::nodes;
use crate::scopes::{Ref, StepKey, VarKey};

/// The longest chain of constants that refer to constants.
pub(super) const MOST_CONSTANTS: usize = 20;
/// The deepest nesting of macro-steps.
const DEEPEST: usize = 20;

/// The context of a piece of code.
#[derive(Clone, Default)]
pub(super) struct At<'d> {
    /// The chart whose names the code uses; None for the file.
    pub(super) chart: Option<usize>,
    /// The program that contains the code; None for code of the file.
    pub(super) program: Option<usize>,
    /// The names of the block's own variables, with their new names.
    pub(super) locals: Vec<(Box<str>, String)>,
    /// True in the body of a function, which sees only its own names.
    pub(super) function: bool,
    /// The section whose body this is.
    pub(super) section: Option<&'d str>,
    /// True in the condition of an action. All of them are evaluated before any action and body of the scan.
    pub(super) condition: bool,
}

impl<'d> Lower<'d> {
    /// Rewrites an expression.
    pub(super) fn expr(&mut self, e: &Expr, at: &At<'d>) -> Expr {
        let span = e.at.0;
        let kind = match &e.kind {
            ExprKind::List(_) => {
                self.no_element(span);
                return e.clone();
            }
            ExprKind::Element(path, index, bit) => {
                let Some(array) = self.array(path, span, at) else { return e.clone() };
                let index = index.iter().map(|i| self.expr(i, at)).collect();
                ExprKind::Element(Box::new(array), index, bit.clone())
            }
            ExprKind::Literal(_) | ExprKind::Bad => return e.clone(),
            ExprKind::Path(path) => return self.value(path, span, at),
            ExprKind::Direct(address) => return self.direct(address, span, at),
            ExprKind::Unary(op @ (UnaryOp::Rise | UnaryOp::Fall), inner) => {
                return self.edge(*op == UnaryOp::Rise, inner, span, at);
            }
            ExprKind::Unary(op, inner) => ExprKind::Unary(*op, Box::new(self.expr(inner, at))),
            ExprKind::Binary(op, a, b) => {
                if let Some(e) = self.counted_time(*op, a, b, span, at) {
                    return e;
                }
                ExprKind::Binary(*op, Box::new(self.expr(a, at)), Box::new(self.expr(b, at)))
            }
            ExprKind::Timer { t1, e: inner, t2 } => {
                return self.timer(t1, inner, t2.as_deref(), span, at);
            }
            ExprKind::Call(path, args) => {
                let mut args = self.args(args, at);
                args.iter_mut().filter_map(|a| a.name.as_mut()).for_each(|n| self.parameter_name(path, n));
                ExprKind::Call(self.function_name(path), args)
            }
        };
        Expr { kind, at: e.at }
    }

    fn function_name(&self, path: &Path) -> Path {
        let span = path.names.first().map_or(Span::default(), |n| n.at.0);
        match path.names.as_slice() {
            [name] => match self.names.function(&name.text) {
                Some(own) => nodes::path(&[own], span),
                None => nodes::path(&[&name.text.to_ascii_uppercase()], span),
            },
            _ => path.clone(),
        }
    }

    /// The name that a parameter of a function of the file has there.
    fn parameter_name(&self, called: &Path, name: &mut Name) {
        if let [function] = called.names.as_slice()
            && let Some(own) = self.names.inner(&function.text, &name.text)
        {
            name.text = own.into();
        }
    }

    pub(super) fn args(&mut self, args: &[Arg], at: &At<'d>) -> Vec<Arg> {
        let one = |a: &Arg| {
            if a.writes() {
                self.writes(&a.value, at);
            }
            Arg { value: self.expr(&a.value, at), ..a.clone() }
        };
        args.iter().map(one).collect()
    }

    /// The value of a path.
    pub(super) fn value(&mut self, path: &Path, span: Span, at: &At<'d>) -> Expr {
        if let Some((first, rest)) = path.names.split_first()
            && let Some((_, text)) = at.locals.iter().find(|(n, _)| **n == *first.text)
        {
            // Behind the name of a local variable stands the number of a bit, if anything.
            let parts = rest.iter().map(|n| &*n.text);
            return nodes::name(&std::iter::once(text.as_str()).chain(parts).collect::<Vec<_>>(), span);
        }
        self.note(path, false, at);
        match self.scopes.refer(at.chart, &path.names) {
            Some(Ref::Var(key)) if at.function => match self.constant_of(key, MOST_CONSTANTS) {
                Some(value) => value,
                None => self.nothing(span, say!("a function sees no variables but its own")),
            },
            Some(Ref::Var(key)) if at.condition && self.moved.contains(&key) => self.copy(key, span),
            Some(Ref::Var(key)) => self.variable(key, span, at),
            Some(Ref::Member(key, member)) if !at.function => {
                let ty = match self.scopes.decl(key).map(|d| d.ty) {
                    Some(Type::Fb(kind)) => kind.type_of(member),
                    _ => None,
                };
                named(&self.member(key, member, ty, span, at), span)
            }
            Some(Ref::Inner(key, rest)) if !at.function => self.inner(key, path, rest, span, at),
            Some(Ref::Bit(key, bit)) if !at.function => self.bit(key, bit, path, span, at),
            Some(Ref::Active(step)) if !at.function => self.active(step, span, at, 0),
            Some(Ref::Time(step)) if !at.function && self.scan_clock => self.counted(step, false, span, at),
            Some(Ref::Seconds(step)) if !at.function && self.scan_clock => self.counted(step, true, span, at),
            Some(Ref::Time(step)) if !at.function => self.time_of(step, span, at),
            Some(Ref::Section(_, section)) if at.section == Some(&*section.name.text) => {
                self.section_name(path, span, at)
            }
            Some(Ref::Section(chart, section)) if !at.function => {
                self.section_value(chart, section, span, at)
            }
            _ => self.nothing(span, say!("`{}` has no counterpart", path.text())),
        }
    }

    /// The name of an array, of which an element is meant.
    fn array(&mut self, path: &Path, span: Span, at: &At<'d>) -> Option<Path> {
        let Some(Ref::Var(_)) = self.scopes.refer(at.chart, &path.names) else {
            self.no_element(span);
            return None;
        };
        match self.value(path, span, at).kind {
            ExprKind::Path(path) => Some(path),
            _ => None,
        }
    }

    /// Notes what an assignment or an output of a call writes.
    fn writes(&mut self, target: &Expr, at: &At<'d>) {
        match &target.kind {
            ExprKind::Path(path) => self.note(path, true, at),
            ExprKind::Element(path, ..) => self.note(path, true, at),
            _ => {}
        }
        self.sets_step(target, at);
    }

    /// A bit of a variable, or of the copy that a condition reads.
    fn bit(&mut self, key: VarKey<'d>, bit: u8, path: &Path, span: Span, at: &At<'d>) -> Expr {
        let variable = match at.condition && self.moved.contains(&key) {
            true => self.copy(key, span),
            false => self.variable(key, span, at),
        };
        match &variable.kind {
            ExprKind::Path(Path { names }) if names.len() == 1 => {
                let name = names.first().map_or("", |n| &*n.text);
                nodes::name(&[name, &bit.to_string()], span)
            }
            _ => self.nothing(span, say!("`{}` has no counterpart", path.text())),
        }
    }

    /// Within its own body a section is a variable.
    fn section_name(&mut self, path: &Path, span: Span, at: &At<'d>) -> Expr {
        let name = path.names.last().map_or("", |n| &*n.text);
        let own = at.chart.and_then(|c| self.names.part(Some(c), name));
        let text = own.or_else(|| self.names.part(None, name)).unwrap_or(name).to_string();
        nodes::name(&[&text], span)
    }

    pub(super) fn variable(&mut self, key: VarKey<'d>, span: Span, at: &At<'d>) -> Expr {
        let names = self.var_names(key, at);
        named(&names, span)
    }

    /// The name of a variable. A variable of another program becomes one of the file, or stands behind the name
    /// of its program.
    pub(super) fn var_names(&mut self, key: VarKey<'d>, at: &At) -> Vec<String> {
        let own = self.names.var(key.0, key.1).unwrap_or(key.1).to_string();
        let Some(chart) = key.0.filter(|c| self.program_of(*c) != at.program) else { return vec![own] };
        let block = self.scopes.decl(key).is_some_and(VarDecl::is_instance);
        match self.program_of(chart).and_then(|p| self.units.get(p)).filter(|_| !block) {
            Some(unit) => vec![unit.clone(), own],
            None => {
                self.wanted.insert(key);
                vec![own]
            }
        }
    }

    pub(super) fn nothing(&mut self, span: Span, what: Said) -> Expr {
        self.lost(span, what);
        nodes::boolean(false, span)
    }

    /// Tells of the activity of a step as the target of an assignment.
    fn sets_step(&mut self, target: &Expr, at: &At<'d>) {
        let step = match &target.kind {
            ExprKind::Path(path) => {
                let local = |n: &g7_model::Name| at.locals.iter().any(|(l, _)| **l == *n.text);
                let own = matches!(path.names.as_slice(), [one] if local(one));
                !own && matches!(self.scopes.refer(at.chart, &path.names), Some(Ref::Active(_)))
            }
            ExprKind::Direct(address) => {
                self.scopes.at(address).is_none() && self.scopes.direct_step(address).is_some()
            }
            _ => false,
        };
        if step {
            self.lost(
                target.at.0,
                say!(
                    "an assignment to the bit of a step changes the situation of a chart from outside, which IEC 61131-3 does not have; `g7 gen st` holds it"
                ),
            );
        }
    }

    fn direct(&mut self, address: &str, span: Span, at: &At<'d>) -> Expr {
        if let Some(key) = self.scopes.at(address) {
            return self.variable(key, span, at);
        }
        if let Some(Ref::Bit(key, bit)) = self.scopes.bit_at(address) {
            let path = nodes::path(&[&format!("%{address}")], span);
            return self.bit(key, bit, &path, span, at);
        }
        if let Some(step) = self.scopes.direct_step(address) {
            return self.active(step, span, at, 0);
        }
        if address.starts_with(['X', 'S']) {
            return self.nothing(span, say!("`%{address}` has no counterpart"));
        }
        nodes::expr(ExprKind::Direct(address.into()), span)
    }

    /// The activity of a step. A step of another program has a variable for this, which it drives.
    /// A macro-step is active while a step of its expansion is.
    pub(super) fn active(&mut self, step: StepKey, span: Span, at: &At, depth: usize) -> Expr {
        if let Some(inner) = self.scopes.expansion(step) {
            let mut any = nodes::boolean(false, span);
            if depth < DEEPEST {
                for (key, _) in self.scopes.steps_of(inner) {
                    let one = self.active(key, span, at, depth + 1);
                    any = nodes::or(any, one, span);
                }
            }
            return any;
        }
        match (self.program_of(step.0), at.program) {
            (None, _) => self.nothing(span, say!("a step of a chart that has no counterpart")),
            (own, here) if own == here => self.step_member(step, "X", span),
            _ => {
                let name = self.mirror(step, span);
                let is = nodes::name(&[&name], span);
                if !self.initial(step) {
                    return is;
                }
                // The step may be left in the first scan, so its action may never write the variable.
                let first = self.first(span);
                nodes::or(is, nodes::name(&[&first], span), span)
            }
        }
    }

    pub(super) fn time_of(&mut self, step: StepKey, span: Span, at: &At) -> Expr {
        let own = self.program_of(step.0).is_some() && self.program_of(step.0) == at.program;
        if !own || self.scopes.expansion(step).is_some() {
            return self.clock(step, span);
        }
        self.step_member(step, "T", span)
    }

    /// `Fill.X` or `Fill.T`, for which `Fill` has to mean the step alone.
    pub(super) fn step_member(&mut self, step: StepKey, member: &str, span: Span) -> Expr {
        if self.names.is_twin(step) {
            self.read_twins.insert(step);
        }
        nodes::name(&[self.names.step(step), member], span)
    }

    /// The value of a section: its condition.
    pub(super) fn section_value(
        &mut self,
        chart: Option<usize>,
        section: &'d g7_model::Section,
        span: Span,
        at: &At<'d>,
    ) -> Expr {
        if let [Stmt { kind: StmtKind::Assign { value, .. }, .. }] = section.body.statements.as_slice()
            && section.body.locals.is_empty()
        {
            let inner = At { chart: chart.or(at.chart), ..at.clone() };
            return self.expr(value, &inner);
        }
        let name = self.section_variable(chart, section);
        nodes::name(&[&name], span)
    }

    /// The time of an action: a literal or a variable. Any other expression is computed before the
    /// charts.
    pub(super) fn time(&mut self, e: &Expr, at: &At<'d>) -> Expr {
        let span = e.at.0;
        let name = matches!(e.kind, ExprKind::Path(_));
        if let Some(value) = self.folded(e, at.chart, MOST_CONSTANTS).filter(|_| !name) {
            return value;
        }
        if name {
            return self.expr(e, at);
        }
        let value = self.expr(e, &At { program: None, ..at.clone() });
        let name = self.fresh(None, "Duration", Type::Time, span);
        self.sections.push(nodes::assign(nodes::name(&[&name], span), value, span));
        nodes::name(&[&name], span)
    }

    /// An initial value; of an array a list of them, of an instance those of its parameters.
    pub(super) fn initial_value(&mut self, e: &Expr, chart: Option<usize>) -> Expr {
        let kind = match &e.kind {
            ExprKind::List(values) => {
                ExprKind::List(values.iter().map(|(times, e)| (*times, self.constant(e, chart))).collect())
            }
            ExprKind::Call(path, fields) if path.names.is_empty() => {
                let field = |f: &Arg| Arg { value: self.constant(&f.value, chart), ..f.clone() };
                ExprKind::Call(path.clone(), fields.iter().map(field).collect())
            }
            _ => return self.constant(e, chart),
        };
        Expr { kind, at: e.at }
    }

    /// An initial value, evaluated to one literal.
    pub(super) fn constant(&mut self, e: &Expr, chart: Option<usize>) -> Expr {
        match self.folded(e, chart, MOST_CONSTANTS) {
            Some(value) => value,
            None => {
                self.lost(e.at.0, say!("an initial value is one number, text or name of a constant there"));
                e.clone()
            }
        }
    }

    pub(super) fn constant_of(&self, key: VarKey<'d>, depth: usize) -> Option<Expr> {
        let decl = self.scopes.decl(key).filter(|d| d.kind == VarKind::Const)?;
        self.folded(decl.init.as_ref()?, key.0, depth.checked_sub(1)?)
    }

    pub(super) fn folded(&self, e: &Expr, chart: Option<usize>, depth: usize) -> Option<Expr> {
        match &e.kind {
            ExprKind::Literal(_) => Some(e.clone()),
            ExprKind::Unary(UnaryOp::Neg, inner) => {
                let inner = self.folded(inner, chart, depth)?;
                match inner.kind {
                    ExprKind::Literal(Literal::Int(n, ty)) => Some(whole(n.checked_neg()?, ty, e.at.0)),
                    ExprKind::Literal(_) => Some(nodes::unary(UnaryOp::Neg, inner, e.at.0)),
                    _ => None,
                }
            }
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.folded(a, chart, depth)?, self.folded(b, chart, depth)?);
                computed(*op, &signed(&a)?, &signed(&b)?, e.at.0)
            }
            ExprKind::Path(path) => match self.scopes.refer(chart, &path.names)? {
                Ref::Var(key) => self.constant_of(key, depth),
                _ => None,
            },
            _ => None,
        }
    }

    /// Rewrites statements.
    pub(super) fn stmts(&mut self, list: &[Stmt], at: &At<'d>) -> Vec<Stmt> {
        list.iter().map(|s| self.stmt(s, at)).collect()
    }

    /// Rewrites a block. Its own variables become variables of the program that are reset in each run; the name of
    /// `owner`, if it has one, begins theirs.
    pub(super) fn block(&mut self, block: &Block, at: &At<'d>, owner: &str) -> Vec<Stmt> {
        let mut inner = at.clone();
        let mut list = Vec::new();
        for local in &block.locals {
            for name in &local.names {
                let wish =
                    if owner.is_empty() { name.text.to_string() } else { format!("{owner}_{}", name.text) };
                let text = self.fresh(at.program, &wish, local.ty.base, name.at.0);
                let init = match &local.init {
                    Some(e) => self.expr(e, at),
                    None => Expr::zero(local.ty.base, name.at),
                };
                list.push(nodes::assign(nodes::name(&[&text], name.at.0), init, name.at.0));
                inner.locals.push((name.text.clone(), text));
            }
        }
        list.extend(self.stmts(&block.statements, &inner));
        list
    }

    fn stmt(&mut self, stmt: &Stmt, at: &At<'d>) -> Stmt {
        let kind = match &stmt.kind {
            StmtKind::Assign { target, value } => {
                self.writes(target, at);
                StmtKind::Assign { target: self.expr(target, at), value: self.expr(value, at) }
            }
            StmtKind::Call(path, args) => return self.invoked(path, args, stmt.at.0, at),
            StmtKind::If(arms, otherwise) => {
                let arms = arms.iter().map(|(c, body)| (self.expr(c, at), self.stmts(body, at))).collect();
                StmtKind::If(arms, self.stmts(otherwise, at))
            }
            StmtKind::Case(selector, arms, otherwise) => {
                let selector = self.expr(selector, at);
                let arms = arms.iter().map(|a| self.arm(a, at)).collect();
                StmtKind::Case(selector, arms, self.stmts(otherwise, at))
            }
            StmtKind::For { var, from, to, by, body } => {
                let path = Path { names: vec![var.clone()] };
                self.note(&path, true, at);
                let name = match self.value(&path, var.at.0, at).kind {
                    ExprKind::Path(path) if path.names.len() > 1 => {
                        let what = say!("FOR counts in a variable of another program");
                        self.lost(var.at.0, what);
                        None
                    }
                    ExprKind::Path(path) => path.names.first().cloned(),
                    _ => None,
                };
                StmtKind::For {
                    var: name.unwrap_or_else(|| var.clone()),
                    from: self.expr(from, at),
                    to: self.expr(to, at),
                    by: by.as_ref().map(|b| self.expr(b, at)),
                    body: self.stmts(body, at),
                }
            }
            StmtKind::While(c, body) => StmtKind::While(self.expr(c, at), self.stmts(body, at)),
            StmtKind::Repeat(body, c) => StmtKind::Repeat(self.stmts(body, at), self.expr(c, at)),
            StmtKind::Exit => StmtKind::Exit,
            StmtKind::Return => StmtKind::Return,
        };
        Stmt { kind, at: stmt.at }
    }

    fn arm(&mut self, arm: &CaseArm, at: &At<'d>) -> CaseArm {
        let label = |l: &mut Self, e: &Expr| match l.folded(e, at.chart, MOST_CONSTANTS) {
            Some(value) => value,
            None => l.expr(e, at),
        };
        let labels = arm
            .labels
            .iter()
            .map(|(from, to)| (label(self, from), to.as_ref().map(|t| label(self, t))))
            .collect();
        CaseArm { labels, body: self.stmts(&arm.body, at) }
    }

    /// A call of a function block. Other calls have no counterpart.
    fn invoked(&mut self, path: &Path, args: &[Arg], span: Span, at: &At<'d>) -> Stmt {
        if let Some(call) = self.own_call(path, args, span, at) {
            return call;
        }
        if let Some(Ref::Var(key)) = self.scopes.refer(at.chart, &path.names)
            && let Some(Type::Fb(kind)) = self.scopes.decl(key).map(|d| d.ty)
            && !at.function
        {
            self.note(path, true, at);
            let name = self.var_names(key, at).join(".");
            let inputs: Vec<&str> = kind.members().iter().filter(|m| m.2).map(|m| m.0).collect();
            let mut args = self.args(args, at);
            for (arg, place) in args.iter_mut().zip(inputs.iter().map(Some).chain(std::iter::repeat(None))) {
                let given = arg.name.as_ref().map(|n| n.text.to_ascii_uppercase());
                let text = match given.as_deref() {
                    Some("RESET") => "R",
                    Some("LOAD") => "LD",
                    Some(other) => other,
                    None => place.copied().unwrap_or(""),
                };
                arg.name = Some(Name::new(text, arg.value.at.0));
            }
            return Stmt { kind: StmtKind::Call(nodes::path(&[&name], span), args), at: span.into() };
        }
        self.lost(span, no_call(&path.text()));
        nodes::when(nodes::boolean(false, span), Vec::new(), Vec::new(), span)
    }

    /// Records who reads and who writes a variable.
    pub(super) fn note(&mut self, path: &Path, writes: bool, at: &At<'d>) {
        let Some(program) = at.program else { return };
        if let Some(Ref::Var(key) | Ref::Member(key, _) | Ref::Inner(key, _) | Ref::Bit(key, _)) =
            self.scopes.refer(at.chart, &path.names)
        {
            let uses = if writes { &mut self.written } else { &mut self.read };
            uses.insert((key, program));
        }
    }

    /// Reports an element for which there is no single variable.
    pub(super) fn no_element(&mut self, span: Span) {
        self.lost(span, say!("an element of an array by an index that is not written as a number"));
    }

    pub(super) fn lost(&mut self, span: Span, what: Said) {
        self.problems.push(g7_model::Problem::new(&codes::NOT_CARRIED, span, what));
    }

    pub(super) fn differs(&mut self, span: Span, what: Said) {
        self.problems.push(g7_model::Problem::new(&codes::DIFFERENT, span, what));
    }
}

/// The reason why a call stands for nothing there.
fn no_call(called: &str) -> Said {
    match called.to_ascii_uppercase().as_str() {
        "INITCHART" => say!(
            "a call of `INITCHART` puts a chart into its initial steps in the midst of a scan, which a chart of IEC 61131-3 cannot: it has a form for CODESYS alone, `IF SFCReset THEN INITCHART(G) END_IF` in the `pre` of `G`; `g7 gen st` holds it everywhere"
        ),
        "CLEARCHART" | "FREEZECHART" | "SETSTEP" | "RESETSTEP" => say!(
            "a call of `{called}` changes the situation of a chart from outside, which IEC 61131-3 does not have; `g7 gen st` holds it"
        ),
        _ => say!("a call of `{called}` has no counterpart"),
    }
}

pub(super) fn named(names: &[String], span: Span) -> Expr {
    nodes::name(&names.iter().map(String::as_str).collect::<Vec<_>>(), span)
}

/// A whole number with its sign.
fn whole(n: i128, ty: Option<Type>, span: Span) -> Expr {
    match (n < 0, ty) {
        (true, None) => nodes::int(n, span),
        _ => nodes::expr(ExprKind::Literal(Literal::Int(n, ty)), span),
    }
}

/// The literal with its sign.
fn signed(e: &Expr) -> Option<Literal> {
    match &e.kind {
        ExprKind::Literal(l) => Some(l.clone()),
        ExprKind::Unary(UnaryOp::Neg, inner) => match inner.kind {
            ExprKind::Literal(Literal::Int(n, ty)) => Some(Literal::Int(n.checked_neg()?, ty)),
            ExprKind::Literal(Literal::Time(t)) => Some(Literal::Time(t.checked_neg()?)),
            _ => None,
        },
        _ => None,
    }
}

/// The value of sums and products of whole numbers and of times.
fn computed(op: BinaryOp, a: &Literal, b: &Literal, span: Span) -> Option<Expr> {
    match (a, b) {
        (Literal::Int(x, tx), Literal::Int(y, ty)) => {
            let value = match op {
                BinaryOp::Add => x.checked_add(*y),
                BinaryOp::Sub => x.checked_sub(*y),
                BinaryOp::Mul => x.checked_mul(*y),
                _ => None,
            };
            Some(whole(value?, tx.or(*ty), span))
        }
        (Literal::Time(x), Literal::Time(y)) if op == BinaryOp::Add => {
            Some(nodes::time(x.checked_add(*y)?, span))
        }
        (Literal::Time(x), Literal::Time(y)) if op == BinaryOp::Sub => {
            Some(nodes::time(x.checked_sub(*y)?, span))
        }
        (Literal::Time(t), Literal::Int(n, _)) | (Literal::Int(n, _), Literal::Time(t))
            if op == BinaryOp::Mul =>
        {
            Some(nodes::time(t.checked_mul(i64::try_from(*n).ok()?)?, span))
        }
        _ => None,
    }
}
