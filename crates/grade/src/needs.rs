//! The names that plants, tests and properties of an exercise need, and those that a submission lacks.

use std::collections::BTreeMap;
use std::sync::Arc;

use g7_compile::references::Written;
use g7_compile::{Definition, References, references};
use g7_model::{Item, Said, Span, say, similar};
use g7_rig::Source;

/// A name that a submission must have.
#[derive(Clone, Debug)]
pub(crate) struct Need {
    definition: Definition,
    /// The first place that names it, as `path:line:column`.
    place: String,
}

/// A name that the exercise looks at, and that a submission does not have.
#[derive(Clone, Debug)]
pub struct Lack {
    /// The first place of the exercise that names it, as `path:line:column`.
    pub place: String,
    /// The name, that of a step behind its chart.
    pub name: String,
    /// The most similar name that the submission has, and where it is declared.
    pub near: Option<(String, String)>,
}

impl Lack {
    /// The sentence.
    pub fn said(&self) -> Said {
        let name = Said::foreign(self.name.as_str());
        match &self.near {
            Some((near, at)) => say!(
                "the exercise looks at `{name}`, which is not there; there is `{}` at {}",
                Said::foreign(near.as_str()),
                Said::foreign(at.as_str())
            ),
            None => say!("the exercise looks at `{name}`, which is not there"),
        }
    }
}

/// The names of charts that stand in the plants, tests and properties of an exercise.
pub(crate) fn needs(template: &Source, model: &Source, asked: &[(Arc<Source>, Vec<Item>)]) -> Vec<Need> {
    let mut found: BTreeMap<Definition, String> = BTreeMap::new();
    for (source, items) in asked {
        let known = references(if source.id() == model.id() { model.whole() } else { template.whole() });
        let within = |at: Span| items.iter().any(|i| i.at().holds(at));
        for one in known.all().iter().filter(|u| within(u.at) && is_of_charts(&u.definition)) {
            found.entry(one.definition.clone()).or_insert_with(|| source.place(one.at));
        }
    }
    found.into_iter().map(|(definition, place)| Need { definition, place }).collect()
}

impl Need {
    /// The name as a line of words: its kind, what it belongs to, itself.
    pub(crate) fn line(&self) -> String {
        let (kind, of) = match &self.definition {
            Definition::Chart(_) => ("chart", ""),
            Definition::Function(_) => ("function", ""),
            Definition::Type(_) => ("type", ""),
            Definition::Plant(_) => ("plant", ""),
            Definition::Step { chart, .. } => ("step", chart.as_str()),
            Definition::Variable { chart, .. } => ("variable", chart.as_deref().unwrap_or_default()),
            Definition::Action { chart, .. } => ("action", chart.as_deref().unwrap_or_default()),
            Definition::Section { chart, .. } => ("section", chart.as_deref().unwrap_or_default()),
            Definition::Value { of, .. } => ("value", of.as_str()),
            Definition::Member { of, .. } => ("member", of.as_str()),
            Definition::Transition { chart, .. } => ("transition", chart.as_str()),
            Definition::PlantItem { plant, .. } => ("item", plant.as_str()),
        };
        [kind, of, name(&self.definition)].join("\t")
    }

    /// Reads such a line. `place` is the file that names it.
    pub(crate) fn of_line(line: &str, place: &str) -> Option<Need> {
        let mut words = line.split('\t').map(str::to_owned);
        let (kind, of, name) = (words.next()?, words.next()?, words.next()?);
        let chart = Some(of.clone()).filter(|of| !of.is_empty());
        let definition = match kind.as_str() {
            "chart" => Definition::Chart(name),
            "function" => Definition::Function(name),
            "type" => Definition::Type(name),
            "plant" => Definition::Plant(name),
            "step" => Definition::Step { chart: of, name },
            "variable" => Definition::Variable { chart, name },
            "action" => Definition::Action { chart, name },
            "section" => Definition::Section { chart, name },
            "value" => Definition::Value { of, name },
            "member" => Definition::Member { of, name },
            "transition" => Definition::Transition { chart: of, label: name },
            "item" => Definition::PlantItem { plant: of, name },
            _ => return None,
        };
        Some(Need { definition, place: place.to_owned() })
    }
}

/// The names that a submission lacks.
pub(crate) fn lacks(needs: &[Need], submission: &Source) -> Vec<Lack> {
    let known = references(submission.whole());
    let declared: BTreeMap<&Definition, Span> = declared(&known).collect();
    let missing = needs.iter().filter(|n| !declared.contains_key(&n.definition));
    missing
        .map(|need| {
            let like = declared.iter().filter(|(d, _)| same_kind(d, &need.definition));
            let names: Vec<(&str, Span)> = like.map(|(d, at)| (name(d), *at)).collect();
            let words: Vec<&str> = names.iter().map(|(n, _)| *n).collect();
            let near = similar(name(&need.definition), &words).and_then(|near| {
                let (_, at) = names.iter().find(|(n, _)| *n == near)?;
                Some((near.to_owned(), submission.place(*at)))
            });
            Lack { place: need.place.clone(), name: shown(&need.definition), near }
        })
        .collect()
}

fn declared(known: &References) -> impl Iterator<Item = (&Definition, Span)> {
    known.all().iter().filter(|u| u.written == Written::Declared).map(|u| (&u.definition, u.at))
}

/// True for what charts declare; a plant declares its own names.
fn is_of_charts(definition: &Definition) -> bool {
    !matches!(definition, Definition::Plant(_) | Definition::PlantItem { .. })
}

fn same_kind(a: &Definition, b: &Definition) -> bool {
    let chart = |d: &Definition| match d {
        Definition::Step { chart, .. } => Some(chart.clone()),
        Definition::Variable { chart, .. } => chart.clone(),
        _ => None,
    };
    std::mem::discriminant(a) == std::mem::discriminant(b) && chart(a) == chart(b)
}

/// The name alone.
pub(crate) fn name(definition: &Definition) -> &str {
    match definition {
        Definition::Chart(name)
        | Definition::Function(name)
        | Definition::Type(name)
        | Definition::Plant(name)
        | Definition::Step { name, .. }
        | Definition::Variable { name, .. }
        | Definition::Action { name, .. }
        | Definition::Section { name, .. }
        | Definition::Value { name, .. }
        | Definition::Member { name, .. }
        | Definition::Transition { label: name, .. }
        | Definition::PlantItem { name, .. } => name,
    }
}

/// The name as a reader finds it.
fn shown(definition: &Definition) -> String {
    match definition {
        Definition::Step { chart, name }
        | Definition::Variable { chart: Some(chart), name }
        | Definition::Action { chart: Some(chart), name }
        | Definition::Section { chart: Some(chart), name }
        | Definition::Transition { chart, label: name }
        | Definition::Member { of: chart, name }
        | Definition::Value { of: chart, name } => format!("{chart}.{name}"),
        other => name(other).to_owned(),
    }
}
