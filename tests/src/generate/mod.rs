//! Makes random documents that `check` accepts, each with a script of scans, from a seed. Names,
//! structure and conditions are chosen so that most charts run for many scans without a fault and
//! visit many situations.

mod block_charts;
mod body;
mod composed;
mod dates;
mod instances;
mod named;
mod rng;
mod script;
mod sight;
mod skeleton;
mod write;

use g7_model::{Document, FileId, ProfileName};

pub use rng::Rng;
pub use script::{Event, Script};

/// How common the features are: the percentage of places at which each is used. For links between
/// charts, the weight relative to 40 for no link.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Steps that are macro-steps.
    pub macro_steps: usize,
    /// Charts that are enclosed by a step.
    pub enclosing: usize,
    /// Charts that are forced by another chart.
    pub forcing: usize,
    /// Charts that are enabled by another chart.
    pub enabling: usize,
    /// Charts and outputs that are masked by a step.
    pub masking: usize,
    /// Documents with a task.
    pub tasks: usize,
    /// Documents that contain a chart with its own period.
    pub periods: usize,
    /// Documents whose profile has switches.
    pub switches: usize,
    /// Documents with arithmetic that can fault.
    pub risk: usize,
    /// Documents with PRE, and the same share with POST; in charts a quarter of it.
    pub sections: usize,
    /// Conditions may have edges and delays.
    pub moments: bool,
}

impl Default for Weights {
    fn default() -> Weights {
        Weights {
            macro_steps: 14,
            enclosing: 22,
            forcing: 26,
            enabling: 12,
            masking: 8,
            tasks: 25,
            periods: 15,
            switches: 25,
            risk: 30,
            sections: 30,
            moments: true,
        }
    }
}

/// A random document with its script.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The seed from which it was made.
    pub seed: u64,
    /// Its .g7 text.
    pub text: String,
    /// The parsed text.
    pub document: Document,
    /// The scans and restarts.
    pub script: Script,
}

/// Makes a document and its script with the usual weights.
///
/// # Errors
///
/// The same as [`sample_with`].
pub fn sample(seed: u64, profile: ProfileName, scans: usize) -> Result<Sample, String> {
    sample_with(seed, profile, scans, &Weights::default())
}

/// Makes a document and its script.
///
/// # Errors
///
/// The text cannot be read, because of an error in the generator or the parser.
pub fn sample_with(
    seed: u64,
    profile: ProfileName,
    scans: usize,
    weights: &Weights,
) -> Result<Sample, String> {
    let mut rng = Rng::new(seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ seed);
    let text = write::document(&mut rng, profile, weights);
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    if let Some(p) = problems.first() {
        return Err(format!("seed {seed}: {} at byte {}\n{text}", p.what, p.at.start));
    }
    let script = script::script(&mut rng, &document, scans);
    Ok(Sample { seed, text, document, script })
}
