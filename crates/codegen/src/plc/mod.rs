//! Code for PLCs, printed from the lowered program of a chart: the same Boolean
//! equations as Structured Text, Instruction List and Ladder.
//!
//! ```text
//! compile::Compiled -> equations -> ST | IL | Ladder (PLCopen XML, drawing)
//! ```
//!
//! # Invariants
//!
//! - The equations do what the engine does, scan by scan; the tests run both.
//! - What a form cannot say is refused with its place, never printed wrong.

mod acts;
mod blocks;
mod code;
mod drawn;
mod form;
mod il;
mod ladder;
mod ld;
mod moves;
mod names;
mod plan;
mod st;
mod vars;

use std::collections::HashMap;

use g7_compile::Compiled;
use g7_engine::{Addr, StepId};
use g7_model::{Problem, Severity};

use form::Equations;
use plan::Plan;
use vars::Shape;

/// The form of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Structured Text.
    St,
    /// Instruction List.
    Il,
    /// Instruction List in the manner of DOLOG80: a memory for each receptivity,
    /// steps that are set and reset.
    Dolog80,
    /// Ladder, as PLCopen XML.
    Ld,
    /// Ladder, drawn (SVG).
    Drawing,
}

/// Equations that were printed.
#[derive(Clone, Debug)]
pub struct Printed {
    /// The text.
    pub text: String,
    /// The name of the function block.
    pub name: String,
    /// What is printed with a difference.
    pub problems: Vec<Problem>,
    steps: Vec<String>,
    variables: HashMap<u32, (String, u32)>,
}

impl Printed {
    /// The memory of a step.
    pub fn step(&self, step: StepId) -> &str {
        self.steps.get(step.0 as usize).map_or("", String::as_str)
    }

    /// The name of a variable, and how many elements it has.
    pub fn variable(&self, addr: Addr) -> Option<(&str, u32)> {
        self.variables.get(&addr.0).map(|(n, k)| (n.as_str(), *k))
    }
}

/// Prints a chart as a function block for a PLC.
///
/// `name` is what the block is called, `source` the text of the chart, for comments.
///
/// # Errors
///
/// What the form cannot say, with its place in the chart.
pub fn print(compiled: &Compiled, form: Form, name: &str, source: &str) -> Result<Printed, Vec<Problem>> {
    let plan = equations(compiled, name, source, form == Form::Dolog80)?;
    let text = match form {
        Form::St => st::print(&plan.e),
        Form::Il | Form::Dolog80 => il::print(&plan.e, form == Form::Dolog80),
        Form::Ld | Form::Drawing => {
            let place = compiled.symbols.charts.first().map_or(g7_model::Span::default(), |c| c.at);
            let ladder = ladder::ladder(&plan.e, place)?;
            if form == Form::Ld {
                ld::print(&plan.e.name, &ladder)
            } else {
                drawn::draw(&plan.e.name, &ladder)
            }
        }
    };
    Ok(printed(&plan, text))
}

/// The equations, with the types of words that have no declaration found out.
fn equations<'a>(
    compiled: &'a Compiled,
    name: &str,
    source: &'a str,
    set_reset: bool,
) -> Result<Plan<'a>, Vec<Problem>> {
    let mut hidden = HashMap::new();
    for _ in 0..6 {
        let mut plan = Plan::make(compiled, name, source, set_reset, hidden.clone());
        let known = std::mem::take(&mut plan.hidden);
        if known == hidden {
            if plan.e.problems.iter().any(|p| p.severity() == Severity::Error) {
                return Err(std::mem::take(&mut plan.e.problems));
            }
            plan.prune();
            return Ok(plan);
        }
        hidden = known;
    }
    Err(Vec::new())
}

fn printed(plan: &Plan<'_>, text: String) -> Printed {
    let e: &Equations = &plan.e;
    let steps = (0..plan.t.steps.len() as u32).map(|s| plan.step(StepId(s))).collect();
    let kept = |name: &str| e.variables.iter().any(|v| v.name == name);
    let slots = plan.vars.slots.values().filter(|s| kept(&s.name));
    let variables = slots.filter_map(|s| {
        let n = match s.shape {
            Shape::One(_) => 1,
            Shape::Many(_, n) => n,
            Shape::Fb(_) | Shape::Text => return None,
        };
        Some((s.start, (s.name.clone(), n)))
    });
    Printed {
        text,
        name: e.name.clone(),
        problems: e.problems.clone(),
        steps,
        variables: variables.collect(),
    }
}
