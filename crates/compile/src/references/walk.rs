//! Through the whole document, name by name.

use std::collections::HashSet;

use g7_model::{
    Action, ActionKind, Arg, Block, Body, Chart, ChartItem, Document, Expr, ExprKind, Item, Name, Order,
    Path, Placed, Plant, PlantItem, PropertyKind, Situation, Span, Step, StepKind, Stmt, StmtKind, Target,
    TestStmt, TestStmtKind, Transition, VarDecl, Work,
};

use super::{Definition, Use, Written};
use crate::ir::ChartId;
use crate::resolve::{Tracer, resolve_open};

/// Every name with what it refers to.
pub(super) fn uses(doc: &Document) -> Vec<Use> {
    let (mut unit, mut scopes, _) = resolve_open(doc, None);
    let tracer = Tracer::new(&mut unit, &mut scopes);
    let mut walk = Walk { tracer, locals: Vec::new(), plant: None, uses: Vec::new() };
    let mut charts = 0;
    for item in &doc.items {
        if let Item::Chart(chart) = item {
            walk.tracer.enter(Some(ChartId(charts)));
            walk.chart(chart);
            walk.tracer.enter(None);
            charts += 1;
        } else {
            walk.item(doc, item);
        }
    }
    walk.uses
}

struct Walk<'u, 'd> {
    tracer: Tracer<'u, 'd>,
    locals: Vec<HashSet<&'d str>>,
    /// The plant whose names hide those of the charts, with those names.
    plant: Option<(&'d Plant, HashSet<&'d str>)>,
    uses: Vec<Use>,
}

impl<'d> Walk<'_, 'd> {
    fn add(&mut self, at: Span, definition: Definition, written: Written) {
        self.uses.push(Use { at, definition, written, before: 0 });
    }

    fn name(&mut self, name: &Name, definition: Option<Definition>, written: Written) {
        if let Some(definition) = definition {
            self.add(name.at.0, definition, written);
        }
    }

    // The file

    fn item(&mut self, doc: &'d Document, item: &'d Item) {
        match item {
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Chart(_) => {}
            Item::Var(v) => self.variable(None, v),
            Item::Action(a) => self.named(None, a),
            Item::Section(s) => self.section(None, s),
            Item::Function(f) => {
                self.name(&f.name, Some(Definition::Function(f.name.text.to_string())), Written::Declared);
                let mut own: HashSet<&str> = f.params.iter().map(|p| &*p.name.text).collect();
                own.insert(&f.name.text);
                self.locals.push(own);
                self.block(&f.body);
                self.locals.pop();
            }
            Item::Pre(body, _) | Item::Post(body, _) => self.body(body),
            Item::Plant(p) => self.plant(p),
            Item::Test(t) => {
                let plant = t.plant.as_ref().and_then(|n| plant_named(doc, &n.text));
                if let (Some(name), Some(p)) = (&t.plant, plant) {
                    self.name(name, Some(Definition::Plant(p.name.text.to_string())), Written::Name);
                }
                // A condition is put to the plant where the plant has the name.
                self.plant = plant.map(|p| (p, plant_names(p)));
                t.body.iter().for_each(|s| self.test(s));
                self.plant = None;
            }
            Item::Prove(p) => match &p.kind {
                PropertyKind::Always(e) | PropertyKind::Never(e) | PropertyKind::Reachable(e) => self.expr(e),
                PropertyKind::After(a, _, b) => {
                    self.expr(a);
                    self.expr(b);
                }
            },
            Item::Layout(l) => {
                let chart = self.tracer.chart(&l.chart.text);
                self.name(&l.chart, chart, Written::Name);
                for place in &l.places {
                    match &place.what {
                        Placed::Step(name) => {
                            let step = self.tracer.step_of(&l.chart.text, &name.text);
                            self.name(name, step, Written::Name);
                        }
                        Placed::Transition(label) => {
                            let (chart, text) = (l.chart.text.to_string(), label.text.to_string());
                            let def = Definition::Transition { chart, label: text };
                            self.name(label, Some(def), Written::Name);
                        }
                        Placed::TransitionNumber(_) | Placed::Comment(_) => {}
                    }
                }
            }
        }
    }

    fn variable(&mut self, chart: Option<&str>, v: &'d VarDecl) {
        for name in &v.names {
            let def = Definition::Variable { chart: chart.map(str::to_owned), name: name.text.to_string() };
            self.add(name.at.0, def, Written::Declared);
        }
        v.init.iter().chain(&v.safe).for_each(|e| self.expr(e));
    }

    fn named(&mut self, chart: Option<&str>, a: &'d g7_model::NamedAction) {
        let def = Definition::Action { chart: chart.map(str::to_owned), name: a.name.text.to_string() };
        self.add(a.name.at.0, def, Written::Declared);
        self.body(&a.body);
    }

    fn section(&mut self, chart: Option<&str>, s: &'d g7_model::Section) {
        let def = Definition::Section { chart: chart.map(str::to_owned), name: s.name.text.to_string() };
        self.add(s.name.at.0, def, Written::Declared);
        self.block(&s.body);
    }

    // Charts

    fn chart(&mut self, chart: &'d Chart) {
        let home = chart.name.text.to_string();
        self.add(chart.name.at.0, Definition::Chart(home.clone()), Written::Declared);
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => self.variable(Some(&home), v),
                ChartItem::Step(s) => self.step(&home, s),
                ChartItem::Transition(t) => self.transition(&home, t),
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body),
                ChartItem::Action(a) => self.named(Some(&home), a),
                ChartItem::Section(s) => self.section(Some(&home), s),
            }
        }
    }

    fn step(&mut self, chart: &str, step: &'d Step) {
        let def = Definition::Step { chart: chart.to_owned(), name: step.name.text.to_string() };
        self.add(step.name.at.0, def, Written::Declared);
        if let StepKind::Macro(expansion) = &step.kind {
            let chart = self.tracer.chart(&expansion.text);
            self.name(expansion, chart, Written::Name);
        }
        step.actions.iter().for_each(|a| self.action(a));
    }

    fn transition(&mut self, chart: &str, t: &'d Transition) {
        if let Some(label) = &t.label {
            let def = Definition::Transition { chart: chart.to_owned(), label: label.text.to_string() };
            self.add(label.at.0, def, Written::Declared);
        }
        // In a chain the steps before are those of the transition before it.
        let before: &[Name] = if t.chained { &[] } else { &t.from };
        for name in before.iter().chain(&t.to) {
            let step = self.tracer.own_step(&name.text);
            self.name(name, step, Written::Step);
        }
        self.expr(&t.receptivity);
        t.on_clearing.iter().for_each(|b| self.block(b));
    }

    fn action(&mut self, action: &'d Action) {
        match &action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter().for_each(|e| self.expr(e));
                match target {
                    Target::Path(path) => self.path(path),
                    Target::Direct(text, at) => self.direct(text, at.0),
                    Target::Work(work) => self.work(work),
                }
                condition.iter().for_each(|e| self.expr(e));
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                condition.iter().for_each(|e| self.expr(e));
            }
            ActionKind::Order(order) => self.order(order),
            ActionKind::Comment(_) => {}
        }
    }

    fn order(&mut self, order: &'d Order) {
        let name = match order {
            Order::Force(name, situation) => {
                if let Situation::Steps(steps) = situation {
                    for step in steps {
                        let def = self.tracer.step_of(&name.text, &step.text);
                        self.name(step, def, Written::Step);
                    }
                }
                name
            }
            Order::Enable(name) | Order::Mask(name) | Order::Call(name) | Order::Enclose(name) => name,
        };
        let chart = self.tracer.chart(&name.text);
        let output = matches!(order, Order::Mask(_)) && chart.is_none();
        if output {
            let def = self.tracer.path(std::slice::from_ref(name), &self.locals).into_iter().next();
            return self.name(name, def.map(|d| d.1), Written::Name);
        }
        self.name(name, chart, Written::Name);
    }

    // Structured Text

    fn work(&mut self, work: &'d Work) {
        match work {
            Work::Single(s) => self.statement(s),
            Work::Block(b) => self.block(b),
        }
    }

    fn body(&mut self, body: &'d Body) {
        if let Body::St(block) = body {
            self.block(block);
        }
    }

    fn block(&mut self, block: &'d Block) {
        for local in &block.locals {
            local.init.iter().for_each(|e| self.expr(e));
        }
        let own = block.locals.iter().flat_map(|l| &l.names).map(|n| &*n.text).collect();
        self.locals.push(own);
        self.statements(&block.statements);
        self.locals.pop();
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
                        last.iter().for_each(|e| self.expr(e));
                    }
                    self.statements(&arm.body);
                }
                self.statements(rest);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.names(std::slice::from_ref(var));
                self.expr(from);
                self.expr(to);
                by.iter().for_each(|e| self.expr(e));
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

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.path(path);
        args.iter().for_each(|a| self.expr(&a.value));
    }

    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Literal(_) | ExprKind::Bad => {}
            ExprKind::Path(path) => self.path(path),
            ExprKind::Direct(text) => self.direct(text, e.at.0),
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

    fn direct(&mut self, text: &str, at: Span) {
        for (_, def, _) in self.tracer.direct(text) {
            self.add(at, def, Written::Direct);
        }
    }

    fn path(&mut self, path: &Path) {
        self.names(&path.names);
    }

    fn names(&mut self, names: &[Name]) {
        let local = |w: &Self, n: &Name| w.locals.iter().any(|l| l.contains(&*n.text));
        let of_plant = match (names.first(), &self.plant) {
            (Some(first), Some((p, own))) if own.contains(&*first.text) && !local(self, first) => {
                let plant = p.name.text.to_string();
                Some((first.at.0, Definition::PlantItem { plant, name: first.text.to_string() }))
            }
            _ => None,
        };
        let only = names.len() == 1;
        if let Some((at, def)) = of_plant {
            return self.add(at, def, Written::Path { first: true, only });
        }
        for (k, definition, before) in self.tracer.path(names, &self.locals) {
            if let Some(name) = names.get(k) {
                let written = Written::Path { first: k == 0, only };
                self.uses.push(Use { at: name.at.0, definition, written, before });
            }
        }
    }

    // Plants and tests

    fn plant(&mut self, plant: &'d Plant) {
        let home = plant.name.text.to_string();
        self.add(plant.name.at.0, Definition::Plant(home.clone()), Written::Declared);
        let own = |n: &Name| Definition::PlantItem { plant: home.clone(), name: n.text.to_string() };
        self.plant = Some((plant, plant_names(plant)));
        for item in &plant.items {
            match item {
                PlantItem::Const { names, value, .. } => {
                    names.iter().for_each(|n| self.add(n.at.0, own(n), Written::Declared));
                    self.expr(value);
                }
                PlantItem::State(s) => {
                    s.names.iter().for_each(|n| self.add(n.at.0, own(n), Written::Declared));
                    s.init.iter().for_each(|e| self.expr(e));
                    s.limits.iter().flat_map(|(a, b)| [a, b]).for_each(|e| self.expr(e));
                }
                PlantItem::Rate(r) => {
                    self.names(std::slice::from_ref(&r.state));
                    self.expr(&r.value);
                    r.when.iter().for_each(|e| self.expr(e));
                }
                PlantItem::Drive(x) => {
                    self.names(std::slice::from_ref(&x.input));
                    self.expr(&x.value);
                }
                PlantItem::On(e, block, _) => {
                    self.expr(e);
                    self.block(block);
                }
                PlantItem::Each(block, _) => self.block(block),
                PlantItem::Parts(p) => {
                    self.add(p.name.at.0, own(&p.name), Written::Declared);
                    p.length.iter().chain(p.init.iter().flatten()).for_each(|e| self.expr(e));
                }
                PlantItem::Arrivals(a) => {
                    self.add(a.name.at.0, own(&a.name), Written::Declared);
                    self.expr(&a.least);
                    a.most.iter().chain(&a.when).for_each(|e| self.expr(e));
                    self.block(&a.body);
                }
                PlantItem::View(v) => v.bindings.iter().for_each(|b| self.expr(&b.value)),
            }
        }
        self.plant = None;
    }

    fn test(&mut self, s: &'d TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => {
                for (path, e) in list {
                    self.path(path);
                    self.expr(e);
                }
            }
            TestStmtKind::Pulse(path, _) | TestStmtKind::Release(path) => self.path(path),
            TestStmtKind::WaitUntil(e, _) => self.expr(e),
            TestStmtKind::Expect(list) => list.iter().for_each(|e| self.expr(e)),
            TestStmtKind::Always(list, body) => {
                list.iter().for_each(|e| self.expr(e));
                body.iter().for_each(|s| self.test(s));
            }
            TestStmtKind::Force(path, e) => {
                self.path(path);
                self.expr(e);
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

fn plant_named<'d>(doc: &'d Document, name: &str) -> Option<&'d Plant> {
    doc.items.iter().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *name => Some(p),
        _ => None,
    })
}

/// The names that a plant declares itself.
fn plant_names(plant: &Plant) -> HashSet<&str> {
    let mut names = HashSet::new();
    for item in &plant.items {
        match item {
            PlantItem::Const { names: list, .. } => names.extend(list.iter().map(|n| &*n.text)),
            PlantItem::State(s) => names.extend(s.names.iter().map(|n| &*n.text)),
            PlantItem::Parts(p) => {
                names.insert(&*p.name.text);
            }
            PlantItem::Arrivals(a) => {
                names.insert(&*a.name.text);
            }
            PlantItem::Rate(_)
            | PlantItem::Drive(_)
            | PlantItem::On(..)
            | PlantItem::Each(..)
            | PlantItem::View(_) => {}
        }
    }
    names
}
