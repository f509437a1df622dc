//! The symbols of what has been lowered.

use std::collections::HashMap;

use g7_engine::{Addr, StepId as Number};
use g7_model::Type;

use super::actions::{Actions, Drives};
use super::plan::parent;
use super::transitions::Origin;
use super::words::words_for;
use super::work::Lower;
use crate::ir::{self, StepId, StepSort, VarClass, VarId};
use crate::symbols::{BlockSymbol, ChartSymbol, MacroSymbol, Symbols, Variable};

impl Lower<'_> {
    #[inline(never)]
    pub(super) fn symbols(&self, ranks: &[Origin], a: &mut Actions) -> Symbols {
        let unit = self.unit;
        let mut s = Symbols {
            actions: std::mem::take(&mut a.symbols),
            s0: self.restarts.map(|r| r.0),
            s1: self.restarts.map(|r| r.1),
            seed: self.random,
            cycle: unit.cycle,
            ..Symbols::default()
        };
        for (i, var) in unit.vars.iter().enumerate() {
            self.variable_symbols(VarId(i as u32), var, &mut s.variables);
        }
        for chart in &self.plan.outer {
            if let (Some(c), Some(group)) = (unit.charts.get(chart.index()), self.plan.group(*chart)) {
                s.charts.push(ChartSymbol { name: c.name.clone(), group, at: c.at });
            }
        }
        self.step_symbols(&mut s);
        self.transition_symbols(ranks, &mut s);
        s.blocks = a.blocks.iter().map(|(drives, at)| self.block_symbol(*drives, *at)).collect();
        s
    }

    fn variable_symbols(&self, id: VarId, var: &ir::Var, to: &mut Vec<Variable>) {
        let addr = self.words.addr(id);
        let is_output = var.class == VarClass::Output;
        to.push(Variable {
            name: var.name.clone(),
            class: var.class,
            ty: var.ty,
            held: var.held.clone(),
            addr,
            elements: var.elements,
            retain: var.retain,
            inverted: var.inverted,
            address: var.address.clone(),
            safe: if is_output { words_for(var.ty, &var.safe).into() } else { Box::default() },
            comment: var.comment.clone(),
            at: var.at,
        });
        let Type::Fb(kind) = var.ty else { return };
        for (k, (name, ty, _)) in kind.members().iter().enumerate() {
            to.push(Variable {
                name: format!("{}.{name}", var.name).into(),
                class: var.class,
                ty: *ty,
                held: None,
                addr: Addr(addr.0 + k as u32),
                elements: 1,
                retain: var.retain,
                inverted: false,
                address: None,
                safe: Box::default(),
                comment: None,
                at: var.at,
            });
        }
    }

    fn step_symbols(&self, s: &mut Symbols) {
        let unit = self.unit;
        let mut count: HashMap<&str, u32> = HashMap::with_capacity(unit.steps.len());
        for step in &unit.steps {
            *count.entry(&step.name).or_default() += 1;
        }
        s.chart_names = unit.charts.iter().map(|c| c.name.clone()).collect();
        let unique = |name: &str| count.get(name) == Some(&1);
        for (i, id) in self.plan.source.iter().enumerate() {
            let Some(step) = unit.steps.get(id.index()) else { continue };
            s.step_names.push_with(|text| self.trace_name(*id, &unique, text));
            s.step_paths.push_with(|text| self.path(*id, text));
            s.step_places.push(step.at);
            s.step_charts.push(step.chart.0);
            s.pseudo.push(self.plan.pseudo(*id) == Some(Number(i as u32)));
        }
        for (i, step) in unit.steps.iter().enumerate() {
            let id = StepId(i as u32);
            let (StepSort::Macro(_), Some(chart)) = (&step.sort, self.plan.expansion(unit, id)) else {
                continue;
            };
            let Some(group) = self.plan.group(chart) else { continue };
            let (mut name, mut path) = (String::new(), String::new());
            self.trace_name(id, &unique, &mut name);
            self.path(id, &mut path);
            let step_id = self.plan.pseudo(id);
            let chart = unit.charts.get(step.chart.index()).map(|c| c.name.clone()).unwrap_or_default();
            s.macro_steps.push(MacroSymbol {
                chart,
                name: name.into(),
                path: path.into(),
                group,
                step: step_id,
                at: step.at,
            });
        }
    }

    /// `5`, or `G.5`; in an expansion `M3.E`, or `G.M3.E`.
    fn trace_name(&self, id: StepId, unique: &impl Fn(&str) -> bool, to: &mut String) {
        let unit = self.unit;
        let Some(step) = unit.steps.get(id.index()) else { return };
        match parent(unit, step.chart).and_then(|m| unit.steps.get(m.index())) {
            None if unique(&step.name) => to.push_str(&step.name),
            Some(m) if unique(&m.name) => {
                to.push_str(&m.name);
                to.push('.');
                to.push_str(&step.name);
            }
            _ => self.path(id, to),
        }
    }

    fn path(&self, id: StepId, to: &mut String) {
        let Some(step) = self.unit.steps.get(id.index()) else { return };
        if let Some(chart) = self.unit.charts.get(step.chart.index()) {
            to.push_str(&chart.path);
            to.push('.');
        }
        to.push_str(&step.name);
    }

    fn transition_symbols(&self, ranks: &[Origin], s: &mut Symbols) {
        let unit = self.unit;
        for origin in ranks {
            match *origin {
                Origin::Written(id) => {
                    let Some(t) = unit.transitions.get(id.index()) else { continue };
                    s.labels.push(t.label.as_deref().unwrap_or(""));
                    s.arrows.push_with(|text| {
                        self.side(&t.from, text);
                        text.push_str(" -> ");
                        self.side(&t.to, text);
                    });
                    s.transition_places.push(t.at);
                    s.transition_charts.push(t.chart.0);
                    s.hidden.push(false);
                }
                Origin::Return(task) => {
                    let Some(chart) = unit.charts.get(task.index()) else { continue };
                    s.labels.push("");
                    s.arrows.push_with(|text| {
                        self.side(chart.exit.as_slice(), text);
                        text.push_str(" -> ");
                        self.side(chart.entry.as_slice(), text);
                    });
                    s.transition_places.push(chart.at);
                    s.transition_charts.push(task.0);
                    s.hidden.push(true);
                }
            }
        }
    }

    /// Steps on one side of an arrow, as one writes them in their chart.
    fn side(&self, steps: &[StepId], to: &mut String) {
        let name = |s: &StepId| self.unit.steps.get(s.index()).map_or("", |s| &*s.name);
        match steps {
            [one] => to.push_str(name(one)),
            many => {
                to.push('(');
                for (i, s) in many.iter().enumerate() {
                    if i > 0 {
                        to.push_str(", ");
                    }
                    to.push_str(name(s));
                }
                to.push(')');
            }
        }
    }

    fn block_symbol(&self, drives: Drives, at: g7_model::Span) -> BlockSymbol {
        let name: Box<str> = match drives {
            Drives::Variable(v) => self.unit.vars.get(v.index()).map(|v| v.name.clone()),
            Drives::Named(b) => self.unit.bodies.get(b.index()).map(|b| b.name.clone()),
            Drives::Work => None,
        }
        .unwrap_or_default();
        BlockSymbol { name, at }
    }
}
