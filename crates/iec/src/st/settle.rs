//! Gives each name the spelling of its declaration.
//!
//! IEC 61131-3 ignores case, a .g7 document does not. An element of a structure or array is one
//! variable with a name such as `a[1]` or `s.x`.

use std::collections::HashMap;

use g7_model::{
    Action, ActionKind, Arg, Block, Body, Chart, ChartItem, Document, Expr, ExprKind, Item, Name, Path, Stmt,
    StmtKind, Target, Work,
};

/// Gives every name in a document the spelling of its declaration.
pub fn settle(document: &mut Document) {
    let mut file = Spelling::default();
    for item in &document.items {
        match item {
            Item::Var(v) => v.names.iter().for_each(|n| file.declare(n)),
            Item::Action(a) => file.declare(&a.name),
            Item::Section(s) => file.declare(&s.name),
            Item::Function(f) => file.declare(&f.name),
            Item::Chart(c) => file.declare(&c.name),
            _ => {}
        }
    }
    let mut steps = Spelling::default();
    for chart in document.charts() {
        chart.steps().for_each(|s| steps.declare(&s.name));
    }
    let charts: HashMap<String, (Spelling, Spelling)> =
        document.charts().map(|c| (upper(&c.name), of_chart(c))).collect();
    for item in &mut document.items {
        let mut settler = Settler { names: vec![&file], steps: vec![&steps] };
        match item {
            Item::Var(v) => v.init.iter_mut().for_each(|e| settler.expr(e)),
            Item::Action(a) => settler.body(&mut a.body),
            Item::Section(s) => settler.block(&mut s.body),
            Item::Function(f) => {
                let mut own = Spelling::default();
                own.declare(&f.name);
                f.params.iter().for_each(|p| own.declare(&p.name));
                f.body.locals.iter().flat_map(|l| &l.names).for_each(|n| own.declare(n));
                Settler { names: vec![&own, &file], steps: Vec::new() }.block(&mut f.body);
            }
            Item::Pre(body, _) | Item::Post(body, _) => settler.body(body),
            Item::Chart(c) => {
                if let Some((own, own_steps)) = charts.get(&upper(&c.name)) {
                    settler = Settler { names: vec![own, &file], steps: vec![own_steps, &steps] };
                }
                settler.chart(c);
            }
            _ => {}
        }
    }
}

fn upper(name: &Name) -> String {
    name.text.to_uppercase()
}

/// Declared names by their upper-case forms.
#[derive(Debug, Default)]
struct Spelling {
    names: HashMap<String, Box<str>>,
}

impl Spelling {
    fn declare(&mut self, name: &Name) {
        self.names.entry(upper(name)).or_insert_with(|| name.text.clone());
    }
}

/// The variables and actions of a chart, and its steps. They are separate because a step and a
/// variable may have the same name.
fn of_chart(chart: &Chart) -> (Spelling, Spelling) {
    let mut own = Spelling::default();
    let mut steps = Spelling::default();
    for item in &chart.items {
        match item {
            ChartItem::Var(v) => v.names.iter().for_each(|n| own.declare(n)),
            ChartItem::Action(a) => own.declare(&a.name),
            ChartItem::Section(s) => own.declare(&s.name),
            ChartItem::Step(s) => steps.declare(&s.name),
            ChartItem::Transition(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
        }
    }
    (own, steps)
}

struct Settler<'a> {
    /// The scopes of variables, actions, functions and charts, the innermost first.
    names: Vec<&'a Spelling>,
    steps: Vec<&'a Spelling>,
}

fn find<'a>(spellings: &[&'a Spelling], upper: &str) -> Option<&'a str> {
    spellings.iter().find_map(|s| s.names.get(upper)).map(|n| &**n)
}

impl Settler<'_> {
    fn name(&self, name: &mut Name) {
        if let Some(text) = find(&self.names, &upper(name)) {
            name.text = text.into();
        }
    }

    fn step(&self, name: &mut Name) {
        if let Some(text) = find(&self.steps, &upper(name)) {
            name.text = text.into();
        }
    }

    /// Settles `Step.X` and `Step.T`, perhaps preceded by the name of a chart.
    fn step_path(&self, path: &mut Path) -> bool {
        let (chart, step, member) = match path.names.as_mut_slice() {
            [step, member] => (None, step, member),
            [chart, step, member] => (Some(chart), step, member),
            _ => return false,
        };
        let capital = upper(member);
        if !matches!(capital.as_str(), "X" | "T") || find(&self.steps, &upper(step)).is_none() {
            return false;
        }
        chart.into_iter().for_each(|c| self.name(c));
        self.step(step);
        member.text = capital.into();
        true
    }

    /// Joins elements of structures and arrays into one name, and drops the list of globals before
    /// a name.
    fn path(&self, path: &mut Path) {
        if self.step_path(path) {
            return;
        }
        for from in 0..path.names.len().min(3) {
            let rest = path.names.get(from..).unwrap_or(&[]);
            let found = (1..=rest.len().min(8)).rev().find_map(|n| {
                let joined: Vec<String> = rest.iter().take(n).map(upper).collect();
                find(&self.names, &joined.join(".")).map(|text| (n, text.to_string()))
            });
            let Some((n, text)) = found else { continue };
            let Some(first) = rest.first() else { return };
            let name = Name { text: text.into(), at: first.at };
            let behind: Vec<Name> = rest.iter().skip(n).cloned().collect();
            path.names = std::iter::once(name).chain(behind).collect();
            return;
        }
    }

    fn chart(&self, chart: &mut Chart) {
        for item in &mut chart.items {
            match item {
                ChartItem::Var(v) => v.init.iter_mut().for_each(|e| self.expr(e)),
                ChartItem::Step(s) => s.actions.iter_mut().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    t.from.iter_mut().chain(&mut t.to).for_each(|n| self.step(n));
                    self.expr(&mut t.receptivity);
                    t.on_clearing.iter_mut().for_each(|b| self.block(b));
                }
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body),
                ChartItem::Action(a) => self.body(&mut a.body),
                ChartItem::Section(s) => self.block(&mut s.body),
            }
        }
    }

    fn action(&self, action: &mut Action) {
        match &mut action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter_mut().chain(condition).for_each(|e| self.expr(e));
                match target {
                    Target::Path(path) => self.path(path),
                    Target::Work(work) => self.work(work),
                    Target::Element(element) => self.expr(element),
                    Target::Direct(..) => {}
                }
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                condition.iter_mut().for_each(|e| self.expr(e));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn work(&self, work: &mut Work) {
        match work {
            Work::Single(stmt) => self.stmt(stmt),
            Work::Block(block) => self.block(block),
        }
    }

    fn body(&self, body: &mut Body) {
        if let Body::St(block) = body {
            self.block(block);
        }
    }

    fn block(&self, block: &mut Block) {
        block.locals.iter_mut().filter_map(|l| l.init.as_mut()).for_each(|e| self.expr(e));
        self.stmts(&mut block.statements);
    }

    fn stmts(&self, list: &mut [Stmt]) {
        list.iter_mut().for_each(|s| self.stmt(s));
    }

    fn stmt(&self, stmt: &mut Stmt) {
        match &mut stmt.kind {
            StmtKind::Assign { target, value } => {
                self.expr(target);
                self.expr(value);
            }
            StmtKind::Call(path, args) => {
                self.path(path);
                self.args(args);
            }
            StmtKind::If(arms, otherwise) => {
                for (condition, body) in arms {
                    self.expr(condition);
                    self.stmts(body);
                }
                self.stmts(otherwise);
            }
            StmtKind::Case(selector, arms, otherwise) => {
                self.expr(selector);
                for arm in arms {
                    for (from, to) in &mut arm.labels {
                        self.expr(from);
                        to.iter_mut().for_each(|e| self.expr(e));
                    }
                    self.stmts(&mut arm.body);
                }
                self.stmts(otherwise);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.name(var);
                self.expr(from);
                self.expr(to);
                by.iter_mut().for_each(|e| self.expr(e));
                self.stmts(body);
            }
            StmtKind::While(condition, body) => {
                self.expr(condition);
                self.stmts(body);
            }
            StmtKind::Repeat(body, condition) => {
                self.stmts(body);
                self.expr(condition);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn args(&self, args: &mut [Arg]) {
        for arg in args {
            self.expr(&mut arg.value);
        }
    }

    fn expr(&self, e: &mut Expr) {
        match &mut e.kind {
            ExprKind::Path(path) => self.path(path),
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Binary(_, a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.expr(t1);
                self.expr(e);
                t2.iter_mut().for_each(|t| self.expr(t));
            }
            ExprKind::Call(path, args) => {
                self.function(path);
                self.args(args);
            }
            ExprKind::Element(path, index, _) => {
                self.path(path);
                index.iter_mut().for_each(|e| self.expr(e));
            }
            ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| self.expr(e)),
            ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        }
    }

    /// Settles a declared function, or a standard one in upper case.
    fn function(&self, path: &mut Path) {
        let [name] = path.names.as_mut_slice() else { return self.path(path) };
        let capitals = upper(name);
        if let Some(text) = find(&self.names, &capitals) {
            name.text = text.into();
        } else {
            name.text = capitals.into();
        }
    }
}
