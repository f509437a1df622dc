//! Writes the actions of a step in JGrafchart's action language.

use g7_model::{
    Action, ActionKind, Expr, ExprKind, Order, Place, Qualifier, Stmt, StmtKind, Target, Type, VarKind, Work,
    say,
};

use super::Writer;
use super::guards;
use super::lookup::{Meaning, StepId, Thing, VarId};
use super::text::Speech;

impl Writer<'_> {
    /// The text of a step's actions.
    pub(super) fn actions(&mut self, step: StepId, actions: &[Action]) -> String {
        let mut lines = Vec::new();
        for action in actions {
            self.action(step, action, &mut lines);
        }
        // A step without actions has an empty statement.
        if lines.is_empty() { ";".to_string() } else { lines.join("\n") }
    }

    fn action(&mut self, step: StepId, action: &Action, lines: &mut Vec<String>) {
        let at = action.at;
        match &action.kind {
            ActionKind::Qualified { qualifier, time: None, target, condition } => {
                self.qualified(step, *qualifier, target, condition.as_ref(), at, lines);
            }
            ActionKind::Qualified { qualifier, .. } => {
                self.cannot(at, say!("the qualifier {}", qualifier));
            }
            ActionKind::EachScan { work, condition } => {
                self.work(step.0, &["P"], work, condition.as_ref(), at, lines);
            }
            ActionKind::OnEvent { .. } => self.cannot(at, say!("an action on an event")),
            ActionKind::Order(Order::Enclose(_)) => {}
            ActionKind::Order(_) => self.cannot(at, say!("an order of a step")),
            ActionKind::Comment(_) => self.leave_out(at, say!("a comment among the actions")),
        }
    }

    fn qualified(
        &mut self,
        step: StepId,
        qualifier: Qualifier,
        target: &Target,
        condition: Option<&Expr>,
        at: Place,
        lines: &mut Vec<String>,
    ) {
        let chart = step.0;
        match (qualifier, target) {
            (Qualifier::P1, Target::Work(work)) => self.work(chart, &["S"], work, condition, at, lines),
            (Qualifier::P0, Target::Work(work)) => {
                let (letters, condition) = self.end(step, condition);
                self.work(chart, letters, work, condition, at, lines);
            }
            (_, Target::Work(_)) => {
                self.cannot(at, say!("statements with the qualifier {}", qualifier));
            }
            (Qualifier::N | Qualifier::S | Qualifier::R, _) => {
                let Some((var, ty)) = self.written(chart, target, at) else { return };
                if ty != Type::Bool {
                    self.cannot(at, say!("an action on what is no Boolean variable"));
                    return;
                }
                if qualifier == Qualifier::N {
                    match condition {
                        Some(c) => self.cannot(c.at, say!("a condition of a continuous action")),
                        None => {
                            let name = self.name(chart, var, at);
                            lines.extend(name.map(|n| format!("N {n};")));
                        }
                    }
                    return;
                }
                let value = u8::from(qualifier == Qualifier::S).to_string();
                self.assign(chart, &["S"], var, value, condition, at, lines);
            }
            _ => self.cannot(at, say!("the qualifier {}", qualifier)),
        }
    }

    /// The letters of an action on deactivation: `X`; `A` if an exception transition deactivates
    /// the step; both if that makes no difference.
    fn end<'e>(
        &self,
        step: StepId,
        condition: Option<&'e Expr>,
    ) -> (&'static [&'static str], Option<&'e Expr>) {
        let Some(flag) = self.guards.aborted_step(step) else { return (&["X"], condition) };
        match condition {
            Some(e) if guards::is(&self.look, step.0, e, flag) => (&["A"], None),
            Some(e) if guards::is_not(&self.look, step.0, e, flag) => (&["X"], None),
            _ => (&["X", "A"], condition),
        }
    }

    /// Writes assignments, each with the letters.
    fn work(
        &mut self,
        chart: usize,
        letters: &[&str],
        work: &Work,
        condition: Option<&Expr>,
        at: Place,
        lines: &mut Vec<String>,
    ) {
        if matches!(work, Work::Block(b) if !b.locals.is_empty()) {
            self.cannot(at, say!("variables of a body"));
            return;
        }
        for statement in work.statements() {
            let Stmt { kind: StmtKind::Assign { target, value }, at } = statement else {
                self.cannot(statement.at, say!("a statement that is no assignment"));
                continue;
            };
            let target = match &target.kind {
                ExprKind::Path(path) => Target::Path(path.clone()),
                ExprKind::Direct(address) => Target::Direct(address.clone(), target.at),
                _ => {
                    self.cannot(*at, say!("an assignment to what is no variable"));
                    continue;
                }
            };
            let Some((var, ty)) = self.written(chart, &target, *at) else { continue };
            let home = chart;
            match (Speech { look: &mut self.look, chart, home }).value(value, ty) {
                Ok(value) => self.assign(chart, letters, var, value, condition, *at, lines),
                Err((at, what)) => self.cannot(at, what),
            }
        }
    }

    #[allow(clippy::too_many_arguments, reason = "the parts of one statement")]
    fn assign(
        &mut self,
        chart: usize,
        letters: &[&str],
        var: VarId,
        value: String,
        condition: Option<&Expr>,
        at: Place,
        lines: &mut Vec<String>,
    ) {
        let Some(name) = self.name(chart, var, at) else { return };
        let value = match condition {
            None => value,
            // If the condition is false, the variable keeps its value.
            Some(c) => match (Speech { look: &mut self.look, chart, home: chart }).condition(c) {
                Ok(condition) => format!("({condition}) ? ({value}) : {name}"),
                Err((at, what)) => return self.cannot(at, what),
            },
        };
        lines.extend(letters.iter().map(|letter| format!("{letter} {name} = {value};")));
    }

    /// The variable that an action writes, with its type.
    fn written(&mut self, chart: usize, target: &Target, at: Place) -> Option<(VarId, Type)> {
        let meaning = match target {
            Target::Path(path) => self.look.path(chart, path),
            Target::Direct(address, _) => self.look.direct(address),
            Target::Element(_) | Target::Work(_) => None,
        };
        let found = match meaning {
            Some(Meaning::Var(var)) => self.look.decl(var).map(|d| (var, d)),
            _ => None,
        };
        match found {
            Some((var, decl)) if decl.kind != VarKind::Const => Some((var, decl.ty)),
            _ => {
                self.cannot(at, say!("an action on what is no variable"));
                None
            }
        }
    }

    fn name(&mut self, chart: usize, var: VarId, at: Place) -> Option<String> {
        let name = self.look.speak(chart, Thing::Var(var));
        if name.is_none() {
            self.cannot(at, say!("a name that means something else where it is used"));
        }
        name
    }
}
