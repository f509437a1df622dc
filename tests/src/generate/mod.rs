//! Random documents that `check` accepts, each with a script of scans, under a
//! seed. Names, structure and conditions are chosen so that most charts run for
//! many scans without fault and visit many situations.

mod body;
mod plan;
mod rng;
mod script;
mod sight;
mod write;

use g7_model::{Document, FileId, ProfileName};

pub use rng::Rng;
pub use script::{Event, Script};

/// How common the features are, in so many of a hundred places where each could
/// stand (of the links between charts: against the 40 that have none).
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Steps that are macro-steps.
    pub macro_steps: usize,
    /// Charts that a step encloses.
    pub enclosing: usize,
    /// Charts that another forces.
    pub forcing: usize,
    /// Charts that another enables.
    pub enabling: usize,
    /// Charts and outputs that a step masks.
    pub masking: usize,
    /// Documents with a task.
    pub tasks: usize,
    /// Documents with a chart of a period of its own.
    pub periods: usize,
    /// Documents whose profile has switches.
    pub switches: usize,
    /// Documents with arithmetic that may fault.
    pub risk: usize,
    /// Documents with PRE, and so many with POST; a quarter as common in a chart.
    pub sections: usize,
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
        }
    }
}

/// A random document with what happens to it.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The seed it came from.
    pub seed: u64,
    /// Its .g7 text.
    pub text: String,
    /// The same, read.
    pub document: Document,
    /// Scans and restarts.
    pub script: Script,
}

/// Draws a document and its script, every feature in its usual share.
///
/// # Errors
///
/// As [`sample_with`].
pub fn sample(seed: u64, profile: ProfileName, scans: usize) -> Result<Sample, String> {
    sample_with(seed, profile, scans, &Weights::default())
}

/// Draws a document and its script.
///
/// # Errors
///
/// Where the text drawn cannot be read: an error of the generator or the parser.
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
