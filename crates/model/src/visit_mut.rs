//! The visitor that changes a document: it sees every statement, expression and path, and may replace
//! them. `visit` is the one that only reads.

use crate::{
    Action, ActionKind, Block, Body, Chart, ChartItem, Document, Expr, ExprKind, Item, Name, Order, Path,
    PlantItem, Span, StepKind, Stmt, StmtKind, Target, Work,
};

/// How a variable is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Its value is used.
    Read,
    /// It gets a value.
    Write,
    /// A function block is called.
    Call,
}

/// Receives every statement, expression and path, inner ones first.
pub trait Visitor {
    /// A statement, after all within it.
    fn stmt(&mut self, _stmt: &mut Stmt) {}
    /// An expression, after its operands.
    fn expr(&mut self, _expr: &mut Expr) {}
    /// A name, and how it is used.
    fn path(&mut self, _path: &mut Path, _how: Use, _at: Span) {}
    /// The name of a chart in an order, or the name of the expansion of a macro-step.
    fn chart_name(&mut self, _name: &mut Name) {}
    /// True if the statements of bodies in other languages than Structured Text are visited as well.
    fn all_bodies(&self) -> bool {
        false
    }
}

/// Visits all of a document.
pub fn document(document: &mut Document, v: &mut impl Visitor) {
    document.items.iter_mut().for_each(|i| item(i, v));
}

/// Visits an item of a document.
pub fn item(item: &mut Item, v: &mut impl Visitor) {
    match item {
        Item::Chart(c) => chart(c, v),
        Item::Action(a) => body(&mut a.body, v),
        Item::Section(s) => stmts(&mut s.body.statements, v),
        Item::Pre(b, _) | Item::Post(b, _) => body(b, v),
        _ => {}
    }
}

/// Visits all of a chart except for the declarations of its variables.
pub fn chart(chart: &mut Chart, v: &mut impl Visitor) {
    for item in &mut chart.items {
        match item {
            ChartItem::Step(s) => {
                if let StepKind::Macro(expansion) = &mut s.kind {
                    v.chart_name(expansion);
                }
                s.actions.iter_mut().for_each(|a| action(a, v));
            }
            ChartItem::Transition(t) => {
                expr(&mut t.receptivity, v);
                t.on_clearing.iter_mut().for_each(|b| block(b, v));
            }
            ChartItem::Pre(b, _) | ChartItem::Post(b, _) => body(b, v),
            ChartItem::Action(a) => body(&mut a.body, v),
            ChartItem::Section(s) => block(&mut s.body, v),
            ChartItem::Var(_) => {}
        }
    }
}

fn action(action: &mut Action, v: &mut impl Visitor) {
    let at = action.at.0;
    match &mut action.kind {
        ActionKind::Qualified { time, target, condition, .. } => {
            time.iter_mut().chain(condition).for_each(|e| expr(e, v));
            match target {
                Target::Path(p) => v.path(p, Use::Write, at),
                Target::Element(element) => written(element, at, v),
                Target::Work(w) => work(w, v),
                Target::Direct(..) => {}
            }
        }
        ActionKind::OnEvent { event, work: w } => {
            expr(event, v);
            work(w, v);
        }
        ActionKind::EachScan { work: w, condition } => {
            work(w, v);
            condition.iter_mut().for_each(|e| expr(e, v));
        }
        ActionKind::Order(order) => {
            let (Order::Force(name, _)
            | Order::Enable(name)
            | Order::Mask(name)
            | Order::Call(name)
            | Order::Enclose(name)) = order;
            v.chart_name(name);
        }
        ActionKind::Comment(_) => {}
    }
}

fn work(work: &mut Work, v: &mut impl Visitor) {
    match work {
        Work::Single(s) => stmt(s, v),
        Work::Block(b) => block(b, v),
    }
}

fn body(body: &mut Body, v: &mut impl Visitor) {
    match body {
        Body::St(b) => block(b, v),
        Body::Other(_, _, b) if v.all_bodies() => block(b, v),
        Body::Other(..) => {}
    }
}

/// Visits the initial values of local variables, and the statements behind them.
pub fn block(block: &mut Block, v: &mut impl Visitor) {
    block.locals.iter_mut().filter_map(|l| l.init.as_mut()).for_each(|e| expr(e, v));
    stmts(&mut block.statements, v);
}

/// Visits a list of statements.
pub fn stmts(list: &mut [Stmt], v: &mut impl Visitor) {
    list.iter_mut().for_each(|s| stmt(s, v));
}

fn stmt(s: &mut Stmt, v: &mut impl Visitor) {
    let at = s.at.0;
    match &mut s.kind {
        StmtKind::Assign { target, value } => {
            written(target, at, v);
            expr(value, v);
        }
        StmtKind::Call(p, args) => {
            v.path(p, Use::Call, at);
            for arg in args {
                if arg.writes() {
                    written(&mut arg.value, at, v);
                } else {
                    expr(&mut arg.value, v);
                }
            }
        }
        StmtKind::If(arms, otherwise) => {
            for (condition, body) in arms {
                expr(condition, v);
                stmts(body, v);
            }
            stmts(otherwise, v);
        }
        StmtKind::Case(selector, arms, otherwise) => {
            expr(selector, v);
            arms.iter_mut().for_each(|a| stmts(&mut a.body, v));
            stmts(otherwise, v);
        }
        StmtKind::For { var, from, to, by, body } => {
            let mut path = Path { names: vec![var.clone()] };
            v.path(&mut path, Use::Write, at);
            if let [name] = path.names.as_slice() {
                *var = name.clone();
            }
            expr(from, v);
            expr(to, v);
            by.iter_mut().for_each(|e| expr(e, v));
            stmts(body, v);
        }
        StmtKind::While(condition, body) => {
            expr(condition, v);
            stmts(body, v);
        }
        StmtKind::Repeat(body, condition) => {
            stmts(body, v);
            expr(condition, v);
        }
        StmtKind::Exit | StmtKind::Return => {}
    }
    v.stmt(s);
}

/// The blocks of an item that stand in no other block.
pub fn blocks(item: &mut Item, f: &mut impl FnMut(&mut Block)) {
    match item {
        Item::Chart(c) => c.items.iter_mut().for_each(|i| blocks_of_chart(i, f)),
        Item::Action(a) => f(a.body.block_mut()),
        Item::Section(s) => f(&mut s.body),
        Item::Function(own) => f(&mut own.body),
        Item::Pre(b, _) | Item::Post(b, _) => f(b.block_mut()),
        Item::Composed(c) => c.body.iter_mut().for_each(|b| f(b.block_mut())),
        Item::Plant(p) => {
            for item in &mut p.items {
                match item {
                    PlantItem::On(_, b, _) | PlantItem::Each(b, _) => f(b),
                    PlantItem::Arrivals(a) => f(&mut a.body),
                    _ => {}
                }
            }
        }
        _ => {}
    }
}

fn blocks_of_chart(item: &mut ChartItem, f: &mut impl FnMut(&mut Block)) {
    match item {
        ChartItem::Step(s) => {
            for action in &mut s.actions {
                match &mut action.kind {
                    ActionKind::Qualified { target: Target::Work(Work::Block(b)), .. }
                    | ActionKind::OnEvent { work: Work::Block(b), .. }
                    | ActionKind::EachScan { work: Work::Block(b), .. } => f(b),
                    _ => {}
                }
            }
        }
        ChartItem::Transition(t) => t.on_clearing.iter_mut().for_each(f),
        ChartItem::Pre(b, _) | ChartItem::Post(b, _) => f(b.block_mut()),
        ChartItem::Action(a) => f(a.body.block_mut()),
        ChartItem::Section(s) => f(&mut s.body),
        ChartItem::Var(_) => {}
    }
}

/// The lists of statements within a statement, one level down.
pub fn lists(s: &mut Stmt, mut f: impl FnMut(&mut Vec<Stmt>)) {
    match &mut s.kind {
        StmtKind::If(arms, otherwise) => {
            arms.iter_mut().for_each(|(_, body)| f(body));
            f(otherwise);
        }
        StmtKind::Case(_, arms, otherwise) => {
            arms.iter_mut().for_each(|a| f(&mut a.body));
            f(otherwise);
        }
        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => f(body),
        StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return => {}
    }
}

/// Visits a variable, or an element of an array, that gets a value.
fn written(target: &mut Expr, at: Span, v: &mut impl Visitor) {
    match &mut target.kind {
        ExprKind::Path(p) => v.path(p, Use::Write, at),
        ExprKind::Element(p, index, _) => {
            v.path(p, Use::Write, at);
            index.iter_mut().for_each(|e| expr(e, v));
            v.expr(target);
        }
        _ => v.expr(target),
    }
}

/// Visits an expression.
pub fn expr(e: &mut Expr, v: &mut impl Visitor) {
    let at = e.at.0;
    match &mut e.kind {
        ExprKind::Path(p) => v.path(p, Use::Read, at),
        ExprKind::Unary(_, a) => expr(a, v),
        ExprKind::Binary(_, a, b) => {
            expr(a, v);
            expr(b, v);
        }
        ExprKind::Timer { t1, e, t2 } => {
            expr(t1, v);
            expr(e, v);
            t2.iter_mut().for_each(|t| expr(t, v));
        }
        ExprKind::Call(_, args) => args.iter_mut().for_each(|a| expr(&mut a.value, v)),
        ExprKind::Element(p, index, _) => {
            v.path(p, Use::Read, at);
            index.iter_mut().for_each(|e| expr(e, v));
        }
        ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| expr(e, v)),
        ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
    }
    v.expr(e);
}
