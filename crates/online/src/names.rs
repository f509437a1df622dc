//! Names of an io file, held against a chart.

use g7_model::{Problem, Said, codes, say};
use g7_rig::{Activity, Bench, Item, Role, StepItem};

use crate::setup::At;
use crate::word::Source;

/// The meaning of a name: a variable of the chart or a step.
pub(crate) enum Named<'a> {
    Item(&'a Item),
    Step(&'a StepItem),
}

/// The variable of the chart, or the step by its step variable, that has a name.
pub(crate) fn named<'a>(bench: &'a Bench, name: &At<String>) -> Result<Named<'a>, Box<Problem>> {
    let At { value: name, at } = name;
    if let Some(step) = bench.steps.iter().find(|s| s.activity().eq_ignore_ascii_case(name)) {
        return Ok(Named::Step(step));
    }
    let wrong = |what: Said| Box::new(Problem::new(&codes::UNKNOWN_CHANNEL, *at, what));
    match bench.item(name) {
        Some(item) if item.role != Role::Plant => Ok(Named::Item(item)),
        Some(_) => Err(wrong(say!("`{name}` belongs to the plant, not to the chart"))),
        None => {
            let mut problem = wrong(say!("the chart has no variable or step `{name}`"));
            problem.help = Some(bench.near(name)).filter(|near| !near.is_empty());
            Err(problem)
        }
    }
}

/// The word that tells the activity of a step.
pub(crate) fn source_of(step: &StepItem) -> Source {
    match step.id {
        Activity::Step(id) => Source::Step(id),
        Activity::Macro(id) => Source::Macro(id),
    }
}
