//! What a channel of the io file is about: a variable of the chart, or a step.
//!
//! `wiring` finds it here by its name, and holds it against the point.

use g7_host::Kind;
use g7_model::{Problem, codes};
use g7_rig::{Activity, Bench, Item, Role, StepItem};

use crate::messages::Carried;
use crate::setup::At;
use crate::wire::Folder;
use crate::word::Source;

/// The three ways in which a channel is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Input,
    Output,
    /// Masters of a server read it.
    Shown,
}

/// The variable or step of a channel.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Its type, for messages.
    pub(crate) ty: String,
    pub(crate) inverted: bool,
    /// The number of an input word.
    pub(crate) input: Option<u32>,
    pub(crate) source: Source,
    pub(crate) safe: Option<u64>,
    /// Where a server of OPC UA shows it.
    pub(crate) folder: Folder,
    pub(crate) comment: Option<String>,
}

impl Subject {
    /// As far as messages and nodes must know it.
    pub(crate) fn carried(&self, class: Class) -> Carried<'_> {
        Carried {
            name: &self.name,
            kind: self.kind,
            inverted: self.inverted,
            input: class == Class::Input,
            safe: class == Class::Output,
        }
    }
}

/// What a name means: a variable of the chart or a step.
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
    let wrong = |what: String| Box::new(Problem::new(&codes::UNKNOWN_CHANNEL, *at, what));
    match bench.item(name) {
        Some(item) if item.role != Role::Plant => Ok(Named::Item(item)),
        Some(_) => Err(wrong(format!("`{name}` belongs to the plant, not to the chart"))),
        None => {
            let near = bench.suggestions(name).trim_start_matches("; ").to_owned();
            let mut problem = wrong(format!("the chart has no variable or step `{name}`"));
            problem.help = Some(near).filter(|near| !near.is_empty());
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
