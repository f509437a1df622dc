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

/// Draws a document and its script.
///
/// # Errors
///
/// Where the text drawn cannot be read: an error of the generator or the parser.
pub fn sample(seed: u64, profile: ProfileName, scans: usize) -> Result<Sample, String> {
    let mut rng = Rng::new(seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ seed);
    let text = write::document(&mut rng, profile);
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    if let Some(p) = problems.first() {
        return Err(format!("seed {seed}: {} at byte {}\n{text}", p.what, p.at.start));
    }
    let script = script::script(&mut rng, &document, scans);
    Ok(Sample { seed, text, document, script })
}
