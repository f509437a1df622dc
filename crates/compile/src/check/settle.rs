//! Facts that the receptivities decide: the transitions that can clear together, and so the charts in
//! which a choice can double the token.
//!
//! `facts` says what holds by the form of the charts, and `solve` answers questions with it; here the
//! answers settle the facts before the checks use them.

use super::facts::Facts;
use super::solve::Question;
use crate::ir::{ChartRole, StepId, StepSort, Transition, Unit};

/// The search for single-token charts ends after so many rounds; then every chart with a choice
/// counts as one that can hold several tokens.
const ROUNDS: usize = 8;
/// The largest number of pairs of branches that are compared in one document.
const PAIRS: usize = 20_000;

impl<'u> Facts<'u> {
    pub(super) fn of(unit: &'u Unit) -> Facts<'u> {
        let mut facts = Facts::by_form(unit);
        facts.settle();
        facts
    }

    /// Tells whether two transitions with a common step can clear together; `None` if that cannot
    /// be decided.
    #[inline(never)]
    pub(super) fn meet(&self, a: &Transition, b: &Transition) -> Option<bool> {
        if self.unit.rules.numbered_exclusive && a.priority != b.priority {
            return Some(false);
        }
        let mut active = a.from.clone();
        active.extend(&b.from);
        let mut question = Question::new(self);
        question.demand(&a.receptivity, true);
        question.demand(&b.receptivity, true);
        question.with_active(&active);
        question.possible()
    }

    /// Removes charts in which a choice can double the token, until no more are removed.
    #[inline(never)]
    fn settle(&mut self) {
        for round in 0.. {
            let mut budget = PAIRS;
            let lost: Vec<usize> = (0..self.single.len())
                .filter(|c| self.single.get(*c) == Some(&true))
                .filter(|c| round >= ROUNDS && self.chooses(*c) || !self.stays_single(*c, &mut budget))
                .collect();
            if lost.is_empty() {
                return;
            }
            for c in lost {
                if let Some(s) = self.single.get_mut(c) {
                    *s = false;
                }
            }
        }
    }

    /// True if some step of a chart is followed by several transitions.
    fn chooses(&self, chart: usize) -> bool {
        let Some(chart) = self.unit.charts.get(chart) else { return false };
        (chart.steps.start..chart.steps.end).any(|s| self.branches(StepId(s)).len() > 1)
    }

    #[inline(never)]
    fn stays_single(&self, chart: usize, budget: &mut usize) -> bool {
        let Some(chart) = self.unit.charts.get(chart) else { return false };
        // A macro-step that is entered again while it is active gets a second token.
        if let ChartRole::Expansion(m) = chart.role {
            let around = self.unit.steps.get(m.index()).map(|s| s.chart.index());
            if around.and_then(|c| self.single.get(c)) != Some(&true) {
                return false;
            }
        }
        for step in (chart.steps.start..chart.steps.end).map(StepId) {
            let sort = self.unit.steps.get(step.index()).map(|s| &s.sort);
            if let Some(StepSort::Macro(inner)) = sort
                && self.single.get(inner.index()) != Some(&true)
            {
                return false;
            }
            if self.unit.rules.multi_token && !self.branches_exclude(step, budget) {
                return false;
            }
        }
        true
    }

    #[inline(never)]
    fn branches_exclude(&self, step: StepId, budget: &mut usize) -> bool {
        let rows: Vec<&Transition> =
            self.branches(step).iter().filter_map(|t| self.unit.transitions.get(*t as usize)).collect();
        for (k, a) in rows.iter().enumerate() {
            for b in rows.get(k + 1..).unwrap_or(&[]) {
                if *budget == 0 {
                    return false;
                }
                *budget -= 1;
                if a.to != b.to && self.meet(a, b) != Some(false) {
                    return false;
                }
            }
        }
        true
    }
}
