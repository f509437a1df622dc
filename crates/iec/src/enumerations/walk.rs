//! The walk through a document that gives each value and each variable of an enumeration the form for its place, and finds
//! the enumerations that have a use for which there is no form.

use g7_model::{
    Action, ActionKind, Arg, Block, Body, CaseArm, Chart, ChartItem, Document, Expr, ExprKind, Function,
    Item, Limits, Name, Path, Stmt, StmtKind, Target, VarDecl, Work,
};

use super::values::{Kind, Walker, Wanted};
use crate::variables::{Home, of_value};

impl Walker<'_> {
    pub(super) fn document(&mut self, document: &mut Document) {
        for item in &mut document.items {
            self.home = Home::File;
            match item {
                Item::Var(v) => self.declaration(v),
                Item::Action(a) => self.body(&mut a.body),
                Item::Section(s) => self.block(&mut s.body),
                Item::Pre(body, _) | Item::Post(body, _) => self.body(body),
                Item::Function(f) => self.function(f),
                Item::Composed(c) => {
                    self.home = Home::Block(c.name.text.clone());
                    c.members.iter_mut().chain(&mut c.inouts).for_each(|v| self.declaration(v));
                    c.body.iter_mut().for_each(|b| self.body(b));
                }
                Item::Chart(c) => self.chart(c),
                _ => {}
            }
        }
    }

    fn function(&mut self, f: &mut Function) {
        let own = f.params.iter().map(|p| (&p.name, &p.ty)).chain([(&f.name, &f.result)]);
        self.locals = own.map(|(name, ty)| (name.text.clone(), of_value(ty))).collect();
        self.block(&mut f.body);
        self.locals.clear();
    }

    fn chart(&mut self, chart: &mut Chart) {
        self.home = Home::Chart(chart.name.text.clone());
        for item in &mut chart.items {
            match item {
                ChartItem::Var(v) => self.declaration(v),
                ChartItem::Step(s) => s.actions.iter_mut().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    self.plain(&mut t.receptivity);
                    t.on_clearing.iter_mut().for_each(|b| self.block(b));
                }
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body),
                ChartItem::Action(a) => self.body(&mut a.body),
                ChartItem::Section(s) => self.block(&mut s.body),
            }
        }
    }

    fn action(&mut self, action: &mut Action) {
        match &mut action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter_mut().chain(condition).for_each(|e| self.plain(e));
                match target {
                    Target::Work(work) => self.work(work),
                    Target::Element(e) => {
                        let found = self.driven(e);
                        self.used(found.of(), action.at.0);
                    }
                    Target::Path(path) => {
                        let found = self.variable(&path.names);
                        self.used(found.of(), action.at.0);
                    }
                    Target::Direct(name, _) => {
                        let found = self.table.at_address(name);
                        self.used(found, action.at.0);
                    }
                }
            }
            ActionKind::OnEvent { event, work } => {
                self.plain(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                condition.iter_mut().for_each(|e| self.plain(e));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn work(&mut self, work: &mut Work) {
        match work {
            Work::Single(stmt) => self.statement(stmt),
            Work::Block(block) => self.block(block),
        }
    }

    fn body(&mut self, body: &mut Body) {
        if let Body::St(block) = body {
            self.block(block);
        }
    }

    fn block(&mut self, block: &mut Block) {
        let before = self.locals.clone();
        for local in &mut block.locals {
            let wanted = self.kind(&of_value(&local.ty));
            local.init.iter_mut().for_each(|e| self.given(e, wanted));
        }
        for local in &block.locals {
            let named = |n: &Name| (n.text.clone(), of_value(&local.ty));
            self.locals.extend(local.names.iter().map(named));
        }
        self.statements(&mut block.statements);
        self.locals = before;
    }

    // Declarations

    fn declaration(&mut self, decl: &mut VarDecl) {
        for (low, high) in decl.array.iter_mut().flat_map(|a| &mut a.dimensions) {
            self.expect(low, Wanted::Written);
            self.expect(high, Wanted::Written);
        }
        let mut of = None;
        match decl.limits.as_deref_mut() {
            Some(Limits::Range(least, most)) => {
                self.expect(least, Wanted::Written);
                self.expect(most, Wanted::Written);
            }
            Some(Limits::Of(name)) => of = self.table.place(&name.text),
            _ => {}
        }
        let block = decl.of.as_ref().map(|of| of.text.clone());
        decl.init.iter_mut().for_each(|e| self.initial(e, of, block.as_deref()));
    }

    /// An initial value of a variable, or of one that is of a structure or function block.
    fn initial(&mut self, e: &mut Expr, of: Option<usize>, block: Option<&str>) {
        match &mut e.kind {
            ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| self.initial(e, of, block)),
            ExprKind::Call(path, args) if path.names.is_empty() => {
                for arg in args {
                    let home = block.map(|b| Home::Block(b.into()));
                    let member = home.zip(arg.name.clone()).and_then(|(home, name)| {
                        let found = self.variables.declared(&home, &[name])?;
                        Some((found.of.as_deref().and_then(|of| self.table.place(of)), found.block.clone()))
                    });
                    let (of, block) = member.unwrap_or_default();
                    self.initial(&mut arg.value, of, block.as_deref());
                }
            }
            _ => self.expect_near(e, self.wanted(of, Wanted::Written), of),
        }
    }

    // Statements

    fn statements(&mut self, list: &mut [Stmt]) {
        list.iter_mut().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, s: &mut Stmt) {
        let at = s.at.0;
        match &mut s.kind {
            StmtKind::Assign { target, value } => self.assign(target, value),
            StmtKind::Call(path, args) => {
                for (place, arg) in args.iter_mut().enumerate() {
                    self.argument(path, place, arg);
                }
            }
            StmtKind::If(arms, otherwise) => {
                for (condition, body) in arms {
                    self.plain(condition);
                    self.statements(body);
                }
                self.statements(otherwise);
            }
            StmtKind::Case(selector, arms, otherwise) => {
                self.case(selector, arms);
                self.statements(otherwise);
            }
            StmtKind::For { var, from, to, by, body } => {
                let found = self.variable(std::slice::from_ref(var));
                self.used(found.of(), at);
                [from, to].into_iter().chain(by).for_each(|e| self.plain(e));
                self.statements(body);
            }
            StmtKind::While(condition, body) | StmtKind::Repeat(body, condition) => {
                self.plain(condition);
                self.statements(body);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn assign(&mut self, target: &mut Expr, value: &mut Expr) {
        let to = self.driven(target);
        self.given(value, to);
    }

    /// The value that a variable or a parameter gets.
    pub(super) fn given(&mut self, value: &mut Expr, to: Kind) {
        if !matches!(to, Kind::Array(_)) {
            return self.expect_near(value, self.wanted(to.of(), Wanted::Plain), to.hint());
        }
        // An array is copied as a whole; no call can stand round its elements.
        let from = self.typed(value, None);
        if from != to {
            self.used(to.of(), value.at.0);
            self.used(from.of(), value.at.0);
        }
    }

    /// A variable or an element that gets a value. A bit of a variable of an enumeration makes this one a number.
    fn driven(&mut self, target: &mut Expr) -> Kind {
        let at = target.at.0;
        match &mut target.kind {
            ExprKind::Path(path) => {
                let found = self.variable(&path.names);
                self.bit(&path.names, at);
                found
            }
            ExprKind::Element(path, index, bit) => {
                index.iter_mut().for_each(|e| self.plain(e));
                self.element(path, bit.is_some(), at)
            }
            ExprKind::Direct(text) => {
                let found = self.table.at_address(text);
                self.used(found, at);
                Kind::Other
            }
            _ => Kind::Other,
        }
    }

    fn argument(&mut self, called: &Path, place: usize, arg: &mut Arg) {
        let at = arg.value.at.0;
        let parameter = match &arg.name {
            _ if self.is_local(&called.names) => None,
            Some(name) => self.variables.parameter(&self.home, called, &name.text),
            None => self.variables.input(&self.home, called, place),
        };
        let inout = parameter.is_some_and(|p| p.inout);
        let wanted = parameter.map_or(Kind::Other, |p| self.kind(p));
        if !arg.output && !inout {
            return self.given(&mut arg.value, wanted);
        }
        let to = self.driven(&mut arg.value);
        if to != wanted {
            self.used(to.of(), at);
            self.used(wanted.of(), at);
        }
    }

    fn case(&mut self, selector: &mut Expr, arms: &mut [CaseArm]) {
        let kind = self.typed(selector, None);
        let ranges = arms.iter().flat_map(|a| &a.labels).any(|(_, most)| most.is_some());
        let mut kinds = Vec::new();
        for (least, most) in arms.iter_mut().flat_map(|a| &mut a.labels) {
            for e in [Some(least), most.as_mut()].into_iter().flatten() {
                kinds.push(self.typed(e, kind.hint()));
            }
        }
        let own = kind.of().filter(|own| !ranges && kinds.iter().all(|k| self.fits(*k, *own)));
        self.agree(selector, kind, own.map_or(Wanted::Plain, Wanted::Of));
        let mut kinds = kinds.into_iter();
        for arm in arms {
            for (least, most) in &mut arm.labels {
                for e in [Some(least), most.as_mut()].into_iter().flatten() {
                    let kind = kinds.next().unwrap_or(Kind::Other);
                    self.agree(e, kind, own.map_or(Wanted::Written, Wanted::Of));
                }
            }
            self.statements(&mut arm.body);
        }
    }
}
