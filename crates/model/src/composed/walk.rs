//! The walk through a document, in which declarations, statements and expressions are replaced.

use super::base::{Composition, Env};
use super::paths::one_name;
use crate::{
    Action, ActionKind, Block, Body, Chart, ChartItem, Document, Expr, ExprKind, Item, Name, Path, Problem,
    Said, Stmt, StmtKind, Target, Work, codes, say,
};

impl<'d> Composition<'d> {
    /// Replaces the structures and function blocks of a document. Returns the problems of types and calls as well.
    pub(super) fn document(mut self, document: &'d Document) -> (Document, Vec<Problem>) {
        let made = self.walked(document);
        self.unused(document);
        (made, self.problems)
    }

    /// The same; the problems stay here.
    pub(super) fn walked(&mut self, document: &'d Document) -> Document {
        let mut items = Vec::new();
        for item in &document.items {
            self.item(item, &mut items);
        }
        Document { items, notes: document.notes.clone() }
    }

    fn item(&mut self, item: &'d Item, items: &mut Vec<Item>) {
        let outside = Env::outside();
        match item {
            Item::Composed(_) => {}
            Item::Var(v) => {
                items.extend(self.declared(v.clone(), &outside).into_iter().map(Item::Var));
                items.extend(self.charts_of(v, None, &outside));
            }
            Item::Chart(c) if c.block.is_some() => {}
            Item::Layout(l) if self.is_of_block(&l.chart.text) => {}
            Item::Chart(c) => {
                let env = Env::of(Some(&c.name.text));
                items.push(Item::Chart(self.chart(c, &c.name, &env)));
                for v in c.vars() {
                    items.extend(self.charts_of(v, Some(&c.name), &env));
                }
            }
            other => {
                let mut own = other.clone();
                match &mut own {
                    Item::Action(a) => self.body_of(&mut a.body, &outside),
                    Item::Section(s) => {
                        self.block(&mut s.body, &outside, Some(say!("a transition section")));
                    }
                    Item::Pre(body, _) | Item::Post(body, _) => self.body_of(body, &outside),
                    Item::Prove(p) => p.kind.claims_mut().into_iter().for_each(|e| self.expr(e, &outside)),
                    _ => {}
                }
                items.push(own);
            }
        }
    }

    /// A chart with plain names, those of `env`; `name` is its own.
    pub(super) fn chart(&mut self, chart: &'d Chart, name: &Name, env: &Env<'_, 'd>) -> Chart {
        let mut items = Vec::new();
        for item in &chart.items {
            if let ChartItem::Var(v) = item {
                let declared = self.declared(v.clone(), env);
                items.extend(declared.into_iter().map(ChartItem::Var));
                continue;
            }
            let mut own = item.clone();
            match &mut own {
                ChartItem::Step(s) => s.actions.iter_mut().for_each(|a| self.action(a, env)),
                ChartItem::Transition(t) => {
                    self.expr(&mut t.receptivity, env);
                    t.on_clearing.iter_mut().for_each(|b| self.block(b, env, None));
                }
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body_of(body, env),
                ChartItem::Action(a) => self.body_of(&mut a.body, env),
                ChartItem::Section(s) => self.block(&mut s.body, env, Some(say!("a transition section"))),
                ChartItem::Var(_) => {}
            }
            items.push(own);
        }
        let mut made = Chart {
            kind: chart.kind,
            name: name.clone(),
            params: chart.params.clone(),
            block: None,
            comment: chart.comment.clone(),
            every: chart.every,
            items,
            at: chart.at,
        };
        self.chart_names(&mut made, env);
        made
    }

    fn action(&mut self, action: &mut Action, env: &Env<'_, 'd>) {
        match &mut action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter_mut().chain(condition).for_each(|e| self.expr(e, env));
                self.action_target(target, action.at.0, env);
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event, env);
                self.work(work, env);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work, env);
                condition.iter_mut().for_each(|e| self.expr(e, env));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn action_target(&mut self, target: &mut Target, at: crate::Span, env: &Env<'_, 'd>) {
        let mut e = match target {
            Target::Path(path) => {
                let kind = ExprKind::Path(Path { names: std::mem::take(&mut path.names) });
                Expr { kind, at: at.into() }
            }
            Target::Element(element) => (**element).clone(),
            Target::Work(work) => return self.work(work, env),
            Target::Direct(..) => return,
        };
        self.no_member_of_kept(&e, env);
        self.target(&mut e, env);
        *target = match e.kind {
            ExprKind::Path(path) => Target::Path(path),
            _ => Target::Element(Box::new(e)),
        };
    }

    fn work(&mut self, work: &mut Work, env: &Env<'_, 'd>) {
        match work {
            Work::Block(block) => self.block(block, env, None),
            Work::Single(s) => {
                let at = s.at;
                let list = self.statements(vec![(**s).clone()], env);
                *work = match <[Stmt; 1]>::try_from(list) {
                    Ok([only]) if matches!(only.kind, StmtKind::Assign { .. } | StmtKind::Call(..)) => {
                        Work::Single(Box::new(only))
                    }
                    Ok(one) => Work::Block(Block { locals: Vec::new(), statements: one.into(), at }),
                    Err(statements) => Work::Block(Block { locals: Vec::new(), statements, at }),
                };
            }
        }
    }

    fn body_of(&mut self, body: &mut Body, env: &Env<'_, 'd>) {
        match body {
            Body::St(block) => self.block(block, env, None),
            Body::Other(_, _, block) => {
                let before = block.clone();
                self.block(block, env, None);
                if *block != before {
                    // The text of the other language no longer says what the statements do.
                    *body = Body::St(std::mem::take(block));
                }
            }
        }
    }

    fn block(&mut self, block: &mut Block, env: &Env<'_, 'd>, uncallable: Option<Said>) {
        let locals = block.locals.iter().flat_map(|l| &l.names).map(|n| n.text.clone()).collect();
        let env = env.within(locals, uncallable);
        block.locals.iter_mut().filter_map(|l| l.init.as_mut()).for_each(|e| self.expr(e, &env));
        block.statements = self.statements(std::mem::take(&mut block.statements), &env);
    }

    /// Replaces names and calls in statements.
    pub(super) fn statements(&mut self, list: Vec<Stmt>, env: &Env<'_, 'd>) -> Vec<Stmt> {
        list.into_iter().flat_map(|s| self.statement(s, env)).collect()
    }

    fn statement(&mut self, s: Stmt, env: &Env<'_, 'd>) -> Vec<Stmt> {
        let at = s.at;
        let inside = matches!(env, Env::Block { .. });
        if inside && !self.takes(1, at.0) {
            return Vec::new();
        }
        let kind = match s.kind {
            StmtKind::Call(path, args) => return self.call(path, args, at, env),
            StmtKind::Assign { target, value } => return self.assignment(target, value, at, env),
            StmtKind::If(arms, otherwise) => {
                let arm = |(mut c, body)| {
                    self.expr(&mut c, env);
                    (c, self.statements(body, env))
                };
                let arms = arms.into_iter().map(arm).collect();
                StmtKind::If(arms, self.statements(otherwise, env))
            }
            StmtKind::Case(mut selector, mut arms, otherwise) => {
                self.expr(&mut selector, env);
                for arm in &mut arms {
                    for (from, to) in &mut arm.labels {
                        self.expr(from, env);
                        to.iter_mut().for_each(|e| self.expr(e, env));
                    }
                    arm.body = self.statements(std::mem::take(&mut arm.body), env);
                }
                StmtKind::Case(selector, arms, self.statements(otherwise, env))
            }
            StmtKind::For { mut var, mut from, mut to, mut by, body } => {
                let upward = by.as_ref().is_none_or(|e| e.kind.whole().is_some_and(|n| n > 0));
                let bounds = (self.whole(&from, env).filter(|_| upward), self.whole(&to, env));
                let written = var.clone();
                let mut name = Expr { kind: ExprKind::Path(Path { names: vec![var.clone()] }), at: var.at };
                self.no_member_of_kept(&name, env);
                self.target(&mut name, env);
                match one_name(name.kind) {
                    Some(plain) => var = plain,
                    None => {
                        let what = say!("the variable of a loop is no element of an array");
                        self.once(Problem::new(&codes::WRONG_KIND, var.at.0, what));
                    }
                }
                [&mut from, &mut to].into_iter().chain(&mut by).for_each(|e| self.expr(e, env));
                self.enter_loop(&written, bounds.0, bounds.1, &body);
                let body = self.statements(body, env);
                self.leave_loop();
                StmtKind::For { var, from, to, by, body }
            }
            StmtKind::While(mut condition, body) => {
                self.expr(&mut condition, env);
                StmtKind::While(condition, self.statements(body, env))
            }
            StmtKind::Repeat(body, mut condition) => {
                let body = self.statements(body, env);
                self.expr(&mut condition, env);
                StmtKind::Repeat(body, condition)
            }
            kind @ (StmtKind::Exit | StmtKind::Return) => kind,
        };
        vec![Stmt { kind, at }]
    }

    fn assignment(
        &mut self,
        mut target: Expr,
        mut value: Expr,
        at: crate::Place,
        env: &Env<'_, 'd>,
    ) -> Vec<Stmt> {
        if self.is_structure(&target, env) && self.is_structure(&value, env) {
            return self.copy(&target, &value, at, env);
        }
        self.target(&mut target, env);
        self.expr(&mut value, env);
        vec![Stmt { kind: StmtKind::Assign { target, value }, at }]
    }

    /// Reports function blocks without instances: nobody looks into their bodies.
    fn unused(&mut self, document: &Document) {
        for item in &document.items {
            let Item::Composed(c) = item else { continue };
            let name = &c.name.text;
            if !c.block || self.used.contains(&**name) || name.is_empty() || self.wrong.contains(&**name) {
                continue;
            }
            let what = say!("the function block `{name}` has no instance, so it never runs");
            let problem = Problem::new(&codes::CHART_UNUSED, c.name.at.0, what);
            self.problems.push(problem.help(say!("write `var name : {name}`")));
        }
    }
}
