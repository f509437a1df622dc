//! Every name that a document uses, as it is written.

use std::collections::HashSet;

use g7_model::{
    Action, ActionKind, Arg, Block, Body, Chart, ChartItem, Document, Expr, ExprKind, Item, Name, Order,
    Path, Plant, PlantItem, PropertyKind, Situation, Stmt, StmtKind, Target, TestStmt, TestStmtKind, VarDecl,
    Work,
};

/// All names outside of their own declarations; of bodies in other languages
/// every word.
pub(super) fn names(doc: &Document) -> HashSet<&str> {
    let mut n = Names::default();
    for item in &doc.items {
        match item {
            Item::Var(v) => n.variable(v),
            Item::Chart(c) => n.chart(c),
            Item::Action(a) => n.body(&a.body),
            Item::Section(s) => n.block(&s.body),
            Item::Function(f) => n.block(&f.body),
            Item::Pre(b, _) | Item::Post(b, _) => n.body(b),
            Item::Plant(p) => n.plant(p),
            Item::Test(t) => n.tests(&t.body),
            Item::Prove(p) => match &p.kind {
                PropertyKind::Always(e) | PropertyKind::Never(e) | PropertyKind::Reachable(e) => n.expr(e),
                PropertyKind::After(a, _, b) => {
                    n.expr(a);
                    n.expr(b);
                }
            },
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Layout(_) => {}
        }
    }
    n.found
}

#[derive(Default)]
struct Names<'d> {
    found: HashSet<&'d str>,
}

impl<'d> Names<'d> {
    fn name(&mut self, name: &'d Name) {
        self.found.insert(&name.text);
    }

    fn path(&mut self, path: &'d Path) {
        path.names.iter().for_each(|n| self.name(n));
    }

    fn variable(&mut self, v: &'d VarDecl) {
        self.some(&v.init);
        self.some(&v.safe);
    }

    fn some(&mut self, e: &'d Option<Expr>) {
        e.iter().for_each(|e| self.expr(e));
    }

    fn args(&mut self, args: &'d [Arg]) {
        args.iter().for_each(|a| self.expr(&a.value));
    }

    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Literal(_) | ExprKind::Bad => {}
            ExprKind::Direct(text) => {
                self.found.insert(text);
            }
            ExprKind::Path(p) => self.path(p),
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Binary(_, a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.expr(t1);
                self.expr(e);
                t2.iter().for_each(|t| self.expr(t));
            }
            ExprKind::Call(p, args) => {
                self.path(p);
                self.args(args);
            }
        }
    }

    fn block(&mut self, b: &'d Block) {
        b.locals.iter().for_each(|l| self.some(&l.init));
        self.stmts(&b.statements);
    }

    fn body(&mut self, b: &'d Body) {
        match b {
            Body::St(b) => self.block(b),
            Body::Other(_, text, _) => {
                let word = |c: char| c.is_alphanumeric() || c == '_';
                self.found.extend(text.split(|c| !word(c)));
            }
        }
    }

    fn stmts(&mut self, list: &'d [Stmt]) {
        for s in list {
            match &s.kind {
                StmtKind::Assign { target, value } => {
                    self.expr(target);
                    self.expr(value);
                }
                StmtKind::Call(p, args) => {
                    self.path(p);
                    self.args(args);
                }
                StmtKind::If(arms, rest) => {
                    for (e, body) in arms {
                        self.expr(e);
                        self.stmts(body);
                    }
                    self.stmts(rest);
                }
                StmtKind::Case(e, arms, rest) => {
                    self.expr(e);
                    for arm in arms {
                        for (from, to) in &arm.labels {
                            self.expr(from);
                            self.some(to);
                        }
                        self.stmts(&arm.body);
                    }
                    self.stmts(rest);
                }
                StmtKind::For { var, from, to, by, body } => {
                    self.name(var);
                    self.expr(from);
                    self.expr(to);
                    self.some(by);
                    self.stmts(body);
                }
                StmtKind::While(e, body) | StmtKind::Repeat(body, e) => {
                    self.expr(e);
                    self.stmts(body);
                }
                StmtKind::Exit | StmtKind::Return => {}
            }
        }
    }

    fn work(&mut self, w: &'d Work) {
        match w {
            Work::Single(s) => self.stmts(std::slice::from_ref(s)),
            Work::Block(b) => self.block(b),
        }
    }

    fn action(&mut self, a: &'d Action) {
        match &a.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                self.some(time);
                self.some(condition);
                match target {
                    Target::Path(p) => self.path(p),
                    Target::Direct(text, _) => {
                        self.found.insert(text);
                    }
                    Target::Work(w) => self.work(w),
                }
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                self.some(condition);
            }
            ActionKind::Order(o) => match o {
                Order::Force(n, s) => {
                    self.name(n);
                    if let Situation::Steps(list) = s {
                        list.iter().for_each(|n| self.name(n));
                    }
                }
                Order::Enable(n) | Order::Mask(n) | Order::Call(n) | Order::Enclose(n) => self.name(n),
            },
            ActionKind::Comment(_) => {}
        }
    }

    fn chart(&mut self, c: &'d Chart) {
        for item in &c.items {
            match item {
                ChartItem::Var(v) => self.variable(v),
                ChartItem::Step(s) => s.actions.iter().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    self.expr(&t.receptivity);
                    t.on_clearing.iter().for_each(|b| self.block(b));
                }
                ChartItem::Pre(b, _) | ChartItem::Post(b, _) => self.body(b),
                ChartItem::Action(a) => self.body(&a.body),
                ChartItem::Section(s) => self.block(&s.body),
            }
        }
    }

    fn plant(&mut self, p: &'d Plant) {
        for item in &p.items {
            match item {
                PlantItem::Const { value, .. } => self.expr(value),
                PlantItem::State(s) => {
                    self.some(&s.init);
                    if let Some((a, b)) = &s.limits {
                        self.expr(a);
                        self.expr(b);
                    }
                }
                PlantItem::Rate(r) => {
                    self.name(&r.state);
                    self.expr(&r.value);
                    self.some(&r.when);
                }
                PlantItem::Drive(d) => {
                    self.name(&d.input);
                    self.expr(&d.value);
                }
                PlantItem::On(e, b, _) => {
                    self.expr(e);
                    self.block(b);
                }
                PlantItem::Each(b, _) => self.block(b),
                PlantItem::Parts(p) => {
                    self.some(&p.length);
                    p.init.iter().flatten().for_each(|e| self.expr(e));
                }
                PlantItem::Arrivals(a) => {
                    self.expr(&a.least);
                    self.some(&a.most);
                    self.some(&a.when);
                    self.block(&a.body);
                }
                PlantItem::View(v) => v.bindings.iter().for_each(|b| self.expr(&b.value)),
            }
        }
    }

    fn tests(&mut self, list: &'d [TestStmt]) {
        for s in list {
            match &s.kind {
                TestStmtKind::Set(all) => {
                    for (p, e) in all {
                        self.path(p);
                        self.expr(e);
                    }
                }
                TestStmtKind::Pulse(p, _) | TestStmtKind::Release(p) => self.path(p),
                TestStmtKind::Force(p, e) => {
                    self.path(p);
                    self.expr(e);
                }
                TestStmtKind::WaitUntil(e, _) => self.expr(e),
                TestStmtKind::Expect(list) => list.iter().for_each(|e| self.expr(e)),
                TestStmtKind::Always(list, body) => {
                    list.iter().for_each(|e| self.expr(e));
                    self.tests(body);
                }
                TestStmtKind::Repeat(_, body) => self.tests(body),
                TestStmtKind::Wait(_)
                | TestStmtKind::Scan(_)
                | TestStmtKind::ExpectFault(_)
                | TestStmtKind::Restart { .. }
                | TestStmtKind::Comment(_) => {}
            }
        }
    }
}
