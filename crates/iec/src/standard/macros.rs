//! Actions of macro-steps whose expansions are written in line: each step of the expansion gets them.
//!
//! `assemble.rs` notes them step by step and hands them down once all charts are there.

use g7_model::{Action, ActionKind, Body, Chart, ChartItem, Name, NamedAction, Step, Target, say};

use super::bodies::At;
use super::lower::{DEEPEST, Lower};
use crate::nodes;
use crate::scopes::StepKey;

impl<'d> Lower<'d> {
    /// Notes the actions of a macro-step whose expansion is written in line: each step of the expansion has
    /// them, and the control block of an action joins them again. A body gets a name, so that it has one block.
    pub(super) fn of_macro(&mut self, key: StepKey, step: &'d Step, at: &At<'d>) {
        let mut shown = step.actions.iter().filter(|a| !matches!(a.kind, ActionKind::Comment(_))).peekable();
        if shown.peek().is_some() && !self.keeps_a_step(key, 0) {
            for action in shown {
                self.lost(
                    action.at.0,
                    say!("an action of a macro-step whose expansion has a source, a sink or an initial step: it does not \
                     begin and end with the steps that stand in its place there"),
                );
            }
            return;
        }
        let mut made = self.actions(key, step, at);
        made.retain(|a| !matches!(a.kind, ActionKind::Comment(_)));
        for (number, action) in made.iter_mut().enumerate() {
            let span = action.at.0;
            if let ActionKind::Qualified { target, .. } = &mut action.kind
                && let Target::Work(work) = target
            {
                let wish = format!("{}_{}", self.names.step(key), number + 1);
                let name = self.names.free(at.program, &wish);
                let body = Body::St(nodes::block(work.statements().to_vec(), span));
                let named = NamedAction { name: Name::new(&*name, span), comment: None, body, at: action.at };
                self.of_macros.push((key, ChartItem::Action(named)));
                *target = Target::Path(nodes::path(&[&name], span));
            }
        }
        for inner in self.inside(key, 0) {
            let with = |a: &Action| (inner, a.clone());
            self.handed_down.extend(made.iter().map(with));
        }
    }

    /// True if the expansion of a macro-step has an active step exactly while the macro-step is active. So neither the
    /// expansion nor one inside it may have a source, a sink or an initial step.
    fn keeps_a_step(&self, key: StepKey, depth: usize) -> bool {
        let Some(inner) = self.scopes.expansion(key) else { return true };
        let is_closed = |c: &Chart| c.transitions().all(|t| !t.from.is_empty() && !t.to.is_empty());
        depth < DEEPEST
            && self.scopes.chart(inner).is_some_and(is_closed)
            && self.scopes.steps_of(inner).all(|(k, s)| !s.initial && self.keeps_a_step(k, depth + 1))
    }

    /// The steps in the expansion of a macro-step, at all levels.
    fn inside(&self, key: StepKey, depth: usize) -> Vec<StepKey> {
        let Some(inner) = self.scopes.expansion(key).filter(|_| depth < DEEPEST) else { return vec![key] };
        self.scopes.steps_of(inner).flat_map(|(k, _)| self.inside(k, depth + 1)).collect()
    }

    /// Gives the actions of macro-steps to the steps of their expansions.
    pub(super) fn hand_down(&mut self, charts: &mut [(usize, Vec<ChartItem>)]) {
        for (key, named) in std::mem::take(&mut self.of_macros) {
            if let Some((_, items)) = charts.iter_mut().find(|c| c.0 == key.0) {
                items.push(named);
            }
        }
        for (key, action) in std::mem::take(&mut self.handed_down) {
            let own = self.names.step(key);
            let items = charts.iter_mut().find(|c| c.0 == key.0).map(|c| &mut c.1);
            let step = items.into_iter().flatten().find_map(|i| match i {
                ChartItem::Step(s) if *s.name.text == *own => Some(s),
                _ => None,
            });
            if let Some(step) = step {
                step.actions.push(action);
                step.braces = true;
            }
        }
    }
}
