//! Properties of a file: those that are left to the prover, and the conditions of those about charts and
//! plant together (`prove … with Tank`).

use std::ops::Range;

use g7_model::{Document, Expr, Problem, ProfileName, Property, PropertyKind, Severity, Type, codes, say};

use super::{sides, statements};
use crate::bench::{self, Ask, Bench, Options};
use crate::{Error, Source};

/// A property that is left to the prover.
pub struct Unproved {
    /// `path:line:column` of it.
    pub place: String,
    /// As written, in one line.
    pub text: String,
}

/// The properties of a file, without its assumptions: these claim nothing. Names and types in them are
/// checked with the charts; to prove them is the work of `verify`.
pub fn unproved(source: &Source) -> Vec<Unproved> {
    let one = |p: &Property| {
        let written = source.written(p.at.0);
        Unproved {
            place: source.place(p.at.0),
            text: written.split_whitespace().collect::<Vec<_>>().join(" "),
        }
    };
    let claims = source.document.properties().filter(|p| !matches!(p.kind, PropertyKind::Assume(_)));
    claims.map(one).collect()
}

/// The plants with which properties of a document are asked, each once, in the order of the text.
pub fn plants(document: &Document) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in document.properties().filter_map(|p| p.plant.as_ref()) {
        if !names.contains(&&*name.text) {
            names.push(&name.text);
        }
    }
    names
}

/// Charts and a plant, compiled with the conditions of the properties about both.
pub struct Claims<'s> {
    /// Charts and plant.
    pub bench: Bench,
    /// The properties with this plant, and all assumptions.
    pub properties: Vec<&'s Property>,
    /// For each condition of these, in the order of the text: its parts in [`Bench::answers`]. It
    /// holds where all of them hold.
    pub conditions: Vec<Range<usize>>,
}

/// Compiles charts, plant and the properties about both. Gives nothing if a problem is an error.
///
/// # Errors
///
/// No property names the plant, and it does not exist.
pub fn claims<'s>(
    source: &'s Source,
    profile: Option<ProfileName>,
    plant: &str,
) -> Result<(Option<Claims<'s>>, Vec<Problem>), Error> {
    let is_meant = |p: &&Property| match &p.plant {
        Some(name) => *name.text == *plant,
        None => matches!(p.kind, PropertyKind::Assume(_)),
    };
    let properties: Vec<&Property> = source.document.properties().filter(is_meant).collect();
    let named = properties.iter().find_map(|p| p.plant.as_ref());
    if let Some(problem) = named.and_then(|name| statements::unknown_plant(source, name)) {
        return Ok((None, vec![problem]));
    }
    let options = Options { profile, plant: Some(plant), ..Options::default() };
    let (bench, mut problems) = bench::build::build(source, &options)?;
    let Some(bench) = bench else { return Ok((None, problems)) };
    let (mut asks, mut conditions) = (Vec::<Ask>::new(), Vec::new());
    let claimed: Vec<&Expr> = properties.iter().flat_map(|p| p.kind.claims()).collect();
    for e in claimed {
        let first = asks.len();
        for part in sides::parts(&bench, e) {
            match sides::ask(&bench, part) {
                Ok(ask) => asks.push(ask),
                Err(problem) => problems.push(problem),
            }
        }
        conditions.push(first..asks.len());
    }
    let (bench, found) = bench::build::build(source, &Options { asks: &asks, ..options })?;
    problems.extend(found);
    let Some(bench) = bench else { return Ok((None, problems)) };
    for (answer, ask) in bench.answers.iter().zip(&asks).filter(|(answer, _)| answer.ty != Type::Bool) {
        let what = say!("a condition is a BOOL, and this is a {}", answer.ty);
        problems.push(Problem::new(&codes::TEST_TYPE, ask.expr.at.0, what));
    }
    let is_wrong = problems.iter().any(|p| p.severity() == Severity::Error);
    Ok(((!is_wrong).then_some(Claims { bench, properties, conditions }), problems))
}
