//! The things that belong together in two charts: inputs, outputs and steps, by name and type.

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{Addr, Program, StepId};
use g7_model::Type;

use super::equality::{Compare, Unlike};
use crate::asked::Asking;
use crate::explore::Move;
use crate::model::Model;
use crate::values::{Values, values};

/// A pair of words of the same meaning.
pub(super) struct Pair {
    pub(super) name: String,
    pub(super) at: [Addr; 2],
}

/// An input of one or both charts: its place in each, and its values.
pub(super) struct Input {
    pub(super) places: [Option<usize>; 2],
    pub(super) values: Values,
}

/// A step of one or both charts.
pub(super) type Step = (String, [Option<StepId>; 2]);

/// Two charts with what belongs together.
pub(super) struct Sides<'c> {
    /// The charts with their assumptions. An input of both takes the same values in both.
    pub(super) models: [Model<'c>; 2],
    pub(super) inputs: Vec<Input>,
    pub(super) outputs: Vec<Pair>,
    pub(super) steps: Vec<Step>,
    pub(super) asking: [Asking; 2],
    pub(super) period: i64,
}

fn of_class(c: &Compiled, class: VarClass) -> impl Iterator<Item = &Variable> {
    c.symbols.variables.iter().filter(move |v| v.class == class)
}

impl<'c> Sides<'c> {
    pub(super) fn new(what: &Compare<'c>) -> Result<Sides<'c>, Unlike> {
        let [a, b] = what.charts;
        let period = a.symbols.cycle.count().max(1);
        if period != b.symbols.cycle.count().max(1) {
            return Err(Unlike::Periods);
        }
        let inputs = inputs(a, b)?;
        let outputs = outputs(a, b)?;
        let steps = if what.situations { steps(a, b) } else { Vec::new() };
        let [of_a, of_b] = &what.assume;
        let mut models = [Model::new(a, of_a.clone()), Model::new(b, of_b.clone())];
        for (side, model) in models.iter_mut().enumerate() {
            for input in &inputs {
                let place = input.places.get(side).copied().flatten();
                if let Some(values) = place.and_then(|p| model.inputs.get_mut(p)) {
                    *values = input.values.clone();
                }
            }
        }
        let asking = [&models[0], &models[1]].map(|m| Asking::new(&m.compiled.program, m.codes()));
        Ok(Sides { models, inputs, outputs, steps, asking, period })
    }

    pub(super) fn programs(&self) -> [&'c Program; 2] {
        [&self.models[0], &self.models[1]].map(|m| &*m.compiled.program)
    }

    /// The inputs of one chart among those of both.
    pub(super) fn of_side(&self, side: usize, all: &[u64]) -> Vec<u64> {
        let count = self.asking.get(side).map_or(0, Asking::count);
        let mut own = vec![0; count];
        for (input, value) in self.inputs.iter().zip(all) {
            let place = input.places.get(side).copied().flatten();
            if let Some(word) = place.and_then(|p| own.get_mut(p)) {
                *word = *value;
            }
        }
        own
    }

    /// The moves of each chart for values of the inputs of both, scan by scan.
    pub(super) fn moves(&self, vectors: &[Vec<u64>]) -> [Vec<Move>; 2] {
        let wait = |k: usize| if k == 0 { 0 } else { self.period };
        let of = |side| {
            let list = vectors.iter().enumerate();
            list.map(|(k, v)| Move { inputs: self.of_side(side, v), wait: wait(k) }).collect()
        };
        [of(0), of(1)]
    }
}

/// The inputs of both charts, each once.
fn inputs(a: &Compiled, b: &Compiled) -> Result<Vec<Input>, Unlike> {
    let mut inputs: Vec<(String, Input)> = Vec::new();
    for (side, c) in [a, b].into_iter().enumerate() {
        let list = values(c);
        let first = c.program.tables().inputs.start;
        for v in of_class(c, VarClass::Input) {
            for k in 0..v.words() {
                let place = (v.addr.0 + k - first) as usize;
                let key = format!("{}#{k}", v.name);
                let mine = list.get(place).cloned().unwrap_or_default();
                let known = inputs.iter_mut().find(|(n, _)| *n == key);
                let input = match known {
                    Some((_, input)) => {
                        same_type(a, b, v)?;
                        let new: Vec<u64> =
                            mine.tried.into_iter().filter(|v| !input.values.tried.contains(v)).collect();
                        input.values.tried.extend(new);
                        input.values.whole &= mine.whole;
                        input
                    }
                    None => {
                        inputs.push((key, Input { places: [None; 2], values: mine }));
                        let Some((_, input)) = inputs.last_mut() else { continue };
                        input
                    }
                };
                if let Some(p) = input.places.get_mut(side) {
                    *p = Some(place);
                }
            }
        }
    }
    Ok(inputs.into_iter().map(|(_, i)| i).collect())
}

/// The outputs, which are those of both charts.
fn outputs(a: &Compiled, b: &Compiled) -> Result<Vec<Pair>, Unlike> {
    let mut outputs = Vec::new();
    for v in of_class(a, VarClass::Output) {
        same_type(a, b, v)?;
        let other = of_class(b, VarClass::Output).find(|o| o.name == v.name);
        let other = other.ok_or_else(|| only(&v.name, 0))?;
        let pair = |k| Pair { name: v.name.to_string(), at: [Addr(v.addr.0 + k), Addr(other.addr.0 + k)] };
        outputs.extend((0..v.words()).map(pair));
    }
    let gone = of_class(b, VarClass::Output).find(|v| !outputs.iter().any(|o| *o.name == *v.name));
    match gone {
        Some(v) => Err(only(&v.name, 1)),
        None => Ok(outputs),
    }
}

fn only(name: &str, side: usize) -> Unlike {
    Unlike::Only { output: name.to_owned(), side }
}

/// An input or output has one type in both charts.
fn same_type(a: &Compiled, b: &Compiled, v: &Variable) -> Result<(), Unlike> {
    let shape = |c: &Compiled| -> Option<(Type, u32)> {
        of_class(c, v.class).find(|o| o.name == v.name).map(|o| (o.ty, o.elements))
    };
    match (shape(a), shape(b)) {
        (Some(x), Some(y)) if x != y => Err(Unlike::Types(v.name.to_string())),
        _ => Ok(()),
    }
}

/// The steps of both charts by name.
fn steps(a: &Compiled, b: &Compiled) -> Vec<Step> {
    let names = |c: &Compiled| -> Vec<(String, StepId)> {
        let listed = (0..c.symbols.steps()).map(StepId).filter(|s| c.symbols.is_listed(*s));
        listed.map(|s| (c.symbols.step_path(s).to_owned(), s)).collect()
    };
    let (of_a, of_b) = (names(a), names(b));
    let find = |list: &[(String, StepId)], name: &str| list.iter().find(|(n, _)| n == name).map(|(_, s)| *s);
    let mut all: Vec<Step> = of_a.iter().map(|(n, s)| (n.clone(), [Some(*s), find(&of_b, n)])).collect();
    all.extend(
        of_b.iter().filter(|(n, _)| find(&of_a, n).is_none()).map(|(n, s)| (n.clone(), [None, Some(*s)])),
    );
    all
}
