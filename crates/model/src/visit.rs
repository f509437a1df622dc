//! The visitor of a document: it finds every place where a name may stand, in variables, charts,
//! actions, statements, expressions, plants and tests.
//!
//! The order is that of the text, because the meaning of a name may depend on the blocks around it.
//! `visit_mut` is the visitor that replaces names and expressions.

use std::slice::from_ref;

use crate::{
    Action, ActionKind, Arg, Block, Body, Chart, ChartItem, Composed, Document, Expr, ExprKind, Instance,
    InstanceNames, Item, Limits, Name, Order, Param, Path, PlantItem, PropertyKind, Span, Stmt, StmtKind,
    Target, TestStmt, TestStmtKind, ValueType, VarDecl, Work,
};

/// Receives every name of a document; the methods that visit an element visit all within it.
pub trait Visitor<'d> {
    /// A name, or several joined by dots.
    fn path(&mut self, names: &'d [Name]);

    /// A direct name such as `%X12`.
    fn direct(&mut self, text: &'d str, at: Span);

    /// An order to another chart.
    fn order(&mut self, order: &'d Order);

    /// A value that is written out.
    fn value(&mut self, _at: Span) {}

    /// The text of a body in another language than Structured Text.
    fn foreign(&mut self, _text: &'d str) {}

    /// From here on the variables of a block are visible.
    fn enter(&mut self, _block: &'d Block) {}

    /// From here on they are no longer visible.
    fn leave(&mut self) {}

    // Elements that contain others

    /// All items of a document.
    fn document(&mut self, document: &'d Document) {
        document.items.iter().for_each(|i| self.item(i));
    }

    /// An item of a file, except for the names that it declares.
    fn item(&mut self, item: &'d Item) {
        match item {
            Item::Var(v) => self.variable(v),
            Item::Chart(c) => self.chart(c),
            Item::Action(a) => self.body(&a.body),
            Item::Section(s) => self.block(&s.body),
            Item::Function(f) => {
                self.params(&f.params);
                self.value_type(&f.result);
                self.block(&f.body);
            }
            Item::Pre(b, _) | Item::Post(b, _) => self.body(b),
            Item::Plant(p) => p.items.iter().for_each(|i| self.plant_item(i)),
            Item::Test(t) => t.body.iter().for_each(|s| self.test(s)),
            Item::Prove(p) => self.property(&p.kind),
            Item::Instance(i) => self.instance(i),
            Item::Composed(c) => self.composed(c),
            Item::Type(t) => self.variable(t),
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Use(_) | Item::Layout(_) => {}
        }
    }

    /// The values of a declaration.
    fn variable(&mut self, v: &'d VarDecl) {
        self.exprs(v.array.iter().flat_map(|a| a.bounds()).chain(&v.init).chain(&v.safe));
        v.limits.iter().for_each(|l| self.limits(l));
    }

    /// The bounds of a type, or the numbers of values.
    fn limits(&mut self, limits: &'d Limits) {
        match limits {
            Limits::Range(least, most) => self.exprs([least, most]),
            Limits::Values(values) => self.exprs(values.iter().filter_map(|(_, number)| number.as_ref())),
            Limits::Of(_) => {}
        }
    }

    /// The type of a parameter, of a local variable or of a result.
    fn value_type(&mut self, ty: &'d ValueType) {
        ty.limits.iter().for_each(|l| self.limits(l));
    }

    /// Parameters with their types.
    fn params(&mut self, params: &'d [Param]) {
        params.iter().for_each(|p| self.value_type(&p.ty));
    }

    /// The values of the members of a type, and the statements of a function block.
    fn composed(&mut self, composed: &'d Composed) {
        composed.members.iter().for_each(|m| self.variable(m));
        composed.body.iter().for_each(|b| self.body(b));
    }

    /// The bounds and the values of parameters of instances.
    fn instance(&mut self, instance: &'d Instance) {
        if let InstanceNames::Range(least, most) = &instance.names {
            self.exprs([&**least, &**most]);
        }
        self.exprs(instance.args.iter().map(|a| &a.value));
    }

    /// All items of a chart, except for the names that they declare and the steps of transitions.
    fn chart(&mut self, chart: &'d Chart) {
        self.params(&chart.params);
        for item in &chart.items {
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

    /// An expression.
    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Literal(_) => self.value(e.at.0),
            ExprKind::Bad => {}
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
            ExprKind::Element(path, index, _) => {
                self.path(&path.names);
                self.exprs(index);
            }
            ExprKind::List(values) => self.exprs(values.iter().map(|(_, e)| e)),
        }
    }

    /// Several expressions.
    fn exprs(&mut self, list: impl IntoIterator<Item = &'d Expr>) {
        list.into_iter().for_each(|e| self.expr(e));
    }

    /// The name and the arguments of a call.
    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.path(&path.names);
        self.exprs(args.iter().map(|a| &a.value));
    }

    /// The work of an action.
    fn work(&mut self, work: &'d Work) {
        match work {
            Work::Single(s) => self.statement(s),
            Work::Block(b) => self.block(b),
        }
    }

    /// A body in any language.
    fn body(&mut self, body: &'d Body) {
        match body {
            Body::St(block) => self.block(block),
            Body::Other(_, text, _) => self.foreign(text),
        }
    }

    /// A block with its local variables.
    fn block(&mut self, block: &'d Block) {
        for local in &block.locals {
            self.value_type(&local.ty);
            self.exprs(&local.init);
        }
        self.enter(block);
        self.statements(&block.statements);
        self.leave();
    }

    /// Several statements.
    fn statements(&mut self, list: &'d [Stmt]) {
        list.iter().for_each(|s| self.statement(s));
    }

    /// A statement.
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

    /// An action of a step.
    fn action(&mut self, action: &'d Action) {
        match &action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                self.exprs(time);
                match target {
                    Target::Path(path) => self.path(&path.names),
                    Target::Element(element) => self.expr(element),
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

    /// A property.
    fn property(&mut self, kind: &'d PropertyKind) {
        kind.claims().for_each(|e| self.expr(e));
    }

    /// An item of a plant, except for the names that it declares.
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
                self.expr(&d.input);
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

    /// A statement of a test.
    fn test(&mut self, s: &'d TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => {
                for (target, e) in list {
                    self.expr(target);
                    self.expr(e);
                }
            }
            TestStmtKind::Pulse(target, _) | TestStmtKind::Release(target) => self.expr(target),
            TestStmtKind::Force(target, e) => {
                self.expr(target);
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
