//! Two things that matiec does not take as they stand: the time of a step that a transition reads before the step is
//! written, and outputs in the call of a block.
//!
//! `control.rs` asks for both. A block that counts a step's time is called in the body of the chart, where the step
//! begins, and before the charts, so that the time is that of the scan.

use g7_model::{Body, Document, Expr, FbKind, Item, Span, Step, Stmt, StmtKind, Type, VarDecl, VarKind};

use crate::nodes::{self, Taken};
use crate::standard::LONGEST;

/// The clocks of all charts: their variables, which several programs use, and what runs before the charts.
#[derive(Default)]
pub(super) struct Clocks {
    vars: Vec<VarDecl>,
    before: Vec<Stmt>,
}

impl Clocks {
    /// The variable that holds the time of a step as a transition sees it. Statements that start and stop its clock
    /// come into the body of the chart.
    pub(super) fn of_step(&mut self, step: &Step, taken: &mut Taken, list: &mut Vec<Stmt>) -> Expr {
        let at = step.name.at.0;
        let own = &step.name.text;
        let on = self.fresh(taken, &format!("{own}_on"), Type::Bool, at);
        if let Some(decl) = self.vars.last_mut() {
            decl.init = step.initial.then(|| nodes::boolean(true, at));
        }
        let clock = taken.give(&format!("{own}_clock"));
        self.vars.push(nodes::variable(VarKind::Var, &clock, Type::Fb(FbKind::Ton), at));
        let time = self.fresh(taken, &format!("{own}_time"), Type::Time, at);
        let call = || {
            let inputs = vec![("IN", on.clone()), ("PT", nodes::time(LONGEST, at))];
            nodes::invoke(nodes::path(&[&clock], at), inputs, at)
        };
        list.push(nodes::assign(on.clone(), nodes::name(&[own, "X"], at), at));
        list.push(call());
        self.before.push(call());
        // A step that has ended keeps its time.
        let now = nodes::assign(time.clone(), nodes::name(&[&clock, "ET"], at), at);
        self.before.push(nodes::when(on, vec![now], Vec::new(), at));
        time
    }

    fn fresh(&mut self, taken: &mut Taken, wish: &str, ty: Type, at: Span) -> Expr {
        let name = taken.give(wish);
        self.vars.push(nodes::variable(VarKind::Var, &name, ty, at));
        nodes::name(&[&name], at)
    }

    /// Puts the clocks into the document.
    pub(super) fn into_document(mut self, document: &mut Document) {
        if self.vars.is_empty() {
            return;
        }
        let place = document.items.iter().position(|i| !matches!(i, Item::Profile(_))).unwrap_or(0);
        let known = document.items.iter_mut().find_map(|i| match i {
            Item::Pre(Body::St(block), _) => Some(block),
            _ => None,
        });
        match known {
            Some(block) => {
                self.before.append(&mut block.statements);
                block.statements = self.before;
            }
            None => {
                let at = Span::default();
                let body = Body::St(nodes::block(self.before, at));
                document.items.insert(place, Item::Pre(body, at.into()));
            }
        }
        let vars = self.vars.into_iter().map(Item::Var);
        document.items.splice(place..place, vars);
    }
}

/// Writes `block(in := a, out => b)` as `block(in := a); b := block.out;`: matiec makes C of the first form that does
/// not compile where the block is a variable of the configuration.
pub(super) fn outputs_apart(list: &mut Vec<Stmt>) {
    let mut made = Vec::with_capacity(list.len());
    for mut stmt in std::mem::take(list) {
        let mut behind = Vec::new();
        if let StmtKind::Call(block, args) = &mut stmt.kind {
            for arg in args.iter().filter(|a| a.output) {
                let Some(output) = &arg.name else { continue };
                let at = output.at.0;
                let mut path = block.clone();
                path.names.push(output.clone());
                let value = nodes::expr(g7_model::ExprKind::Path(path), at);
                behind.push(nodes::assign(arg.value.clone(), value, at));
            }
            args.retain(|a| !a.output);
        }
        g7_model::visit_mut::lists(&mut stmt, outputs_apart);
        made.push(stmt);
        made.append(&mut behind);
    }
    *list = made;
}
