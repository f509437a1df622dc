//! The walk through items and statements, in which values are replaced and assignments checked.

use super::held::Checker;
use super::scopes::{Admits, Around, Local};
use crate::{
    Action, ActionKind, Block, Body, CaseArm, ChartItem, Expr, ExprKind, Item, Name, Path, Stmt, StmtKind,
    Target, Work,
};

impl<'d> Checker<'d> {
    /// An item that is neither a variable nor a chart.
    pub(super) fn item(&mut self, item: &mut Item) {
        match item {
            Item::Action(a) => self.body(&mut a.body, None),
            Item::Section(s) => self.block(&mut s.body, None, &[]),
            Item::Pre(body, _) | Item::Post(body, _) => self.body(body, None),
            Item::Function(f) => {
                let params = f.params.iter().map(|p| (&p.name, &p.ty));
                let own = params.chain([(&f.name, &f.result)]);
                let own: Vec<Local<'d>> = own.map(|(name, ty)| self.scopes.local(name, ty)).collect();
                self.block(&mut f.body, None, &own);
            }
            Item::Prove(p) => {
                let around = Around { chart: None, locals: &[] };
                p.kind.claims_mut().into_iter().for_each(|e| self.plain(e, around));
            }
            _ => {}
        }
    }

    /// An item of a chart that is no variable.
    pub(super) fn chart_item(&mut self, item: &mut ChartItem, chart: &str) {
        let around = Around { chart: Some(chart), locals: &[] };
        match item {
            ChartItem::Step(s) => s.actions.iter_mut().for_each(|a| self.action(a, around)),
            ChartItem::Transition(t) => {
                self.plain(&mut t.receptivity, around);
                t.on_clearing.iter_mut().for_each(|b| self.block(b, Some(chart), &[]));
            }
            ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body, Some(chart)),
            ChartItem::Action(a) => self.body(&mut a.body, Some(chart)),
            ChartItem::Section(s) => self.block(&mut s.body, Some(chart), &[]),
            ChartItem::Var(_) => {}
        }
    }

    fn action(&mut self, action: &mut Action, around: Around<'_, 'd>) {
        match &mut action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter_mut().chain(condition).for_each(|e| self.plain(e, around));
                match target {
                    Target::Work(work) => self.work(work, around),
                    Target::Element(e) => self.written(e, around),
                    Target::Path(path) => {
                        let mut e =
                            Expr { kind: ExprKind::Path(Path { names: path.names.clone() }), at: action.at };
                        self.written(&mut e, around);
                    }
                    Target::Direct(..) => {}
                }
            }
            ActionKind::OnEvent { event, work } => {
                self.plain(event, around);
                self.work(work, around);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work, around);
                condition.iter_mut().for_each(|e| self.plain(e, around));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn work(&mut self, work: &mut Work, around: Around<'_, 'd>) {
        match work {
            Work::Block(block) => self.block(block, around.chart, &[]),
            Work::Single(s) => self.statement(s, around),
        }
    }

    fn body(&mut self, body: &mut Body, chart: Option<&str>) {
        match body {
            Body::St(block) => self.block(block, chart, &[]),
            Body::Other(_, _, block) => {
                let before = block.clone();
                self.block(block, chart, &[]);
                if *block != before {
                    // The text of the other language no longer says what the statements do.
                    *body = Body::St(std::mem::take(block));
                }
            }
        }
    }

    fn block(&mut self, block: &mut Block, chart: Option<&str>, hidden: &[Local<'d>]) {
        let own = block.locals.iter().flat_map(|l| l.names.iter().map(|n| self.scopes.local(n, &l.ty)));
        let locals: Vec<Local<'d>> = hidden.iter().cloned().chain(own).collect();
        for local in &mut block.locals {
            let Some(value) = &mut local.init else { continue };
            let admits = local.names.first().map(|n| self.scopes.local(n, &local.ty).admits());
            // The value cannot name the variables of its own block.
            self.given(value, admits.unwrap_or(Admits::All), Around { chart, locals: hidden });
        }
        let around = Around { chart, locals: &locals };
        self.statements(&mut block.statements, around);
    }

    fn statements(&mut self, list: &mut [Stmt], around: Around<'_, 'd>) {
        list.iter_mut().for_each(|s| self.statement(s, around));
    }

    fn statement(&mut self, s: &mut Stmt, around: Around<'_, 'd>) {
        match &mut s.kind {
            StmtKind::Assign { target, value } => self.assigned(target, value, around),
            StmtKind::Call(path, args) => {
                for arg in args {
                    let wanted = arg.name.as_ref().and_then(|n| self.scopes.parameter(path, n, around));
                    if arg.output {
                        self.written(&mut arg.value, around);
                    } else {
                        self.expect(&mut arg.value, wanted, around);
                    }
                }
            }
            StmtKind::If(arms, otherwise) => {
                for (condition, body) in arms {
                    self.plain(condition, around);
                    self.statements(body, around);
                }
                self.statements(otherwise, around);
            }
            StmtKind::Case(selector, arms, otherwise) => {
                self.case(selector, arms, around);
                self.statements(otherwise, around);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.loop_variable(var, around);
                [from, to].into_iter().chain(by).for_each(|e| self.plain(e, around));
                self.statements(body, around);
            }
            StmtKind::While(condition, body) | StmtKind::Repeat(body, condition) => {
                self.plain(condition, around);
                self.statements(body, around);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn case(&mut self, selector: &mut Expr, arms: &mut [CaseArm], around: Around<'_, 'd>) {
        let ty = self.typed(selector, around);
        for arm in arms {
            for (least, most) in &mut arm.labels {
                self.expect(least, ty, around);
                most.iter_mut().for_each(|e| self.expect(e, ty, around));
            }
            self.statements(&mut arm.body, around);
        }
    }

    fn loop_variable(&mut self, var: &Name, around: Around<'_, 'd>) {
        let path = Path { names: vec![var.clone()] };
        self.written(&mut Expr { kind: ExprKind::Path(path), at: var.at }, around);
    }
}
