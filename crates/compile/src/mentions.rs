//! Through expressions, statements, actions, plants and tests, wherever a name
//! may stand.
//!
//! ```text
//! model::Document -> here -> references (what each name means)
//!                         -> check::named (which names are used at all)
//! ```
//!
//! The order is that of the text, so that what a name means may depend on the
//! blocks it stands in.

use std::slice::from_ref;

use g7_model::{
    Action, ActionKind, Arg, Block, Body, Expr, ExprKind, Name, Order, Path, PlantItem, PropertyKind, Span,
    Stmt, StmtKind, Target, TestStmt, TestStmtKind, Work,
};

/// Somebody who is told of every name.
pub(crate) trait Mentions<'d> {
    /// A name, or several joined by dots.
    fn path(&mut self, names: &'d [Name]);

    /// A direct name such as `%X12`.
    fn direct(&mut self, text: &'d str, at: Span);

    /// An order to another chart.
    fn order(&mut self, order: &'d Order);

    /// A body in another language than Structured Text.
    fn foreign(&mut self, _text: &'d str) {}

    /// The variables of a block hold from here.
    fn enter(&mut self, _block: &'d Block) {}

    /// They no longer do.
    fn leave(&mut self) {}

    // What stands within what

    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Literal(_) | ExprKind::Bad => {}
            ExprKind::Direct(text) => self.direct(text, e.at.0),
            ExprKind::Path(path) => self.path(&path.names),
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
            ExprKind::Call(path, args) => self.call(path, args),
        }
    }

    fn exprs(&mut self, list: impl IntoIterator<Item = &'d Expr>) {
        list.into_iter().for_each(|e| self.expr(e));
    }

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.path(&path.names);
        self.exprs(args.iter().map(|a| &a.value));
    }

    fn work(&mut self, work: &'d Work) {
        match work {
            Work::Single(s) => self.statement(s),
            Work::Block(b) => self.block(b),
        }
    }

    fn body(&mut self, body: &'d Body) {
        match body {
            Body::St(block) => self.block(block),
            Body::Other(_, text, _) => self.foreign(text),
        }
    }

    fn block(&mut self, block: &'d Block) {
        self.exprs(block.locals.iter().filter_map(|l| l.init.as_ref()));
        self.enter(block);
        self.statements(&block.statements);
        self.leave();
    }

    fn statements(&mut self, list: &'d [Stmt]) {
        list.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, s: &'d Stmt) {
        match &s.kind {
            StmtKind::Assign { target, value } => {
                self.expr(target);
                self.expr(value);
            }
            StmtKind::Call(path, args) => self.call(path, args),
            StmtKind::If(arms, rest) => {
                for (e, body) in arms {
                    self.expr(e);
                    self.statements(body);
                }
                self.statements(rest);
            }
            StmtKind::Case(e, arms, rest) => {
                self.expr(e);
                for arm in arms {
                    for (first, last) in &arm.labels {
                        self.expr(first);
                        self.exprs(last);
                    }
                    self.statements(&arm.body);
                }
                self.statements(rest);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.path(from_ref(var));
                self.expr(from);
                self.expr(to);
                self.exprs(by);
                self.statements(body);
            }
            StmtKind::While(e, body) => {
                self.expr(e);
                self.statements(body);
            }
            StmtKind::Repeat(body, e) => {
                self.statements(body);
                self.expr(e);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn action(&mut self, action: &'d Action) {
        match &action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                self.exprs(time);
                match target {
                    Target::Path(path) => self.path(&path.names),
                    Target::Direct(text, at) => self.direct(text, at.0),
                    Target::Work(work) => self.work(work),
                }
                self.exprs(condition);
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                self.exprs(condition);
            }
            ActionKind::Order(order) => self.order(order),
            ActionKind::Comment(_) => {}
        }
    }

    fn property(&mut self, kind: &'d PropertyKind) {
        match kind {
            PropertyKind::Always(e) | PropertyKind::Never(e) | PropertyKind::Reachable(e) => self.expr(e),
            PropertyKind::After(a, _, b) => {
                self.expr(a);
                self.expr(b);
            }
        }
    }

    /// Without the names that the item declares.
    fn plant_item(&mut self, item: &'d PlantItem) {
        match item {
            PlantItem::Const { value, .. } => self.expr(value),
            PlantItem::State(s) => {
                self.exprs(&s.init);
                self.exprs(s.limits.iter().flat_map(|(a, b)| [a, b]));
            }
            PlantItem::Rate(r) => {
                self.path(from_ref(&r.state));
                self.expr(&r.value);
                self.exprs(&r.when);
            }
            PlantItem::Drive(d) => {
                self.path(from_ref(&d.input));
                self.expr(&d.value);
            }
            PlantItem::On(e, block, _) => {
                self.expr(e);
                self.block(block);
            }
            PlantItem::Each(block, _) => self.block(block),
            PlantItem::Parts(p) => self.exprs(p.length.iter().chain(p.init.iter().flatten())),
            PlantItem::Arrivals(a) => {
                self.expr(&a.least);
                self.exprs(a.most.iter().chain(&a.when));
                self.block(&a.body);
            }
            PlantItem::View(v) => self.exprs(v.bindings.iter().map(|b| &b.value)),
        }
    }

    fn test(&mut self, s: &'d TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => {
                for (path, e) in list {
                    self.path(&path.names);
                    self.expr(e);
                }
            }
            TestStmtKind::Pulse(path, _) | TestStmtKind::Release(path) => self.path(&path.names),
            TestStmtKind::Force(path, e) => {
                self.path(&path.names);
                self.expr(e);
            }
            TestStmtKind::WaitUntil(e, _) => self.expr(e),
            TestStmtKind::Expect(list) => self.exprs(list),
            TestStmtKind::Always(list, body) => {
                self.exprs(list);
                body.iter().for_each(|s| self.test(s));
            }
            TestStmtKind::Repeat(_, body) => body.iter().for_each(|s| self.test(s)),
            TestStmtKind::Wait(_)
            | TestStmtKind::Scan(_)
            | TestStmtKind::ExpectFault(_)
            | TestStmtKind::Restart { .. }
            | TestStmtKind::Comment(_) => {}
        }
    }
}
