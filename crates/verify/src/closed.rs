//! The questions of a document about charts and plant as a closed loop (`prove … with Tank`).

use g7_model::{Problem, ProfileName};
use g7_rig::testing::{Claims, claims};
use g7_rig::{Bench, Error, Source};

use crate::ask::{of_every_chart, of_the_author};
use crate::model::{Model, Part};
use crate::question::{Query, Question};
use crate::slice::Slice;
use crate::values::values;

/// Charts and their plant, with all that is asked of both together.
pub struct Closed {
    /// Charts and plant, compiled with the conditions of questions and assumptions.
    pub bench: Bench,
    /// The questions, the author's last, in the order of the text.
    pub questions: Vec<Question>,
    /// For each [`Query`], its parts.
    conditions: Vec<Vec<Part>>,
    /// The conditions that the environment keeps.
    assume: Vec<Query>,
}

impl Closed {
    /// The model: inputs that the plant does not drive take all of their values.
    pub fn model(&self) -> Model<'_> {
        let compiled = &self.bench.compiled;
        Model {
            compiled,
            conditions: self.conditions.clone(),
            assume: self.assume.clone(),
            period: self.bench.period.count().max(1),
            inputs: values(compiled),
            plant: self.bench.plant.as_ref(),
            slice: Slice::default(),
        }
    }
}

/// Compiles the charts of a source with a plant and the questions about both: the author's, and with
/// `every` those that are asked of every chart. Gives nothing if a problem is an error.
///
/// # Errors
///
/// No property names the plant, and it does not exist.
pub fn ask_with(
    source: &Source,
    profile: Option<ProfileName>,
    plant: &str,
    every: bool,
) -> Result<(Option<Closed>, Vec<Problem>), Error> {
    let (made, problems) = claims(source, profile, plant)?;
    let Some(Claims { bench, properties, conditions }) = made else { return Ok((None, problems)) };
    let of = |range: std::ops::Range<usize>| -> Vec<Part> {
        let own = bench.answers.get(range).unwrap_or(&[]);
        own.iter().map(|a| Part { code: a.code, of_plant: a.of_plant }).collect()
    };
    let conditions = conditions.into_iter().map(of).collect();
    let mut questions = if every { of_every_chart(source.whole(), &bench.compiled) } else { Vec::new() };
    let assume = of_the_author(properties.into_iter(), &mut questions);
    Ok((Some(Closed { bench, questions, conditions, assume }), problems))
}
