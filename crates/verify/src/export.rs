//! The questions of a chart as a file for other model checkers: the system of bits that the solver is asked
//! about, in the AIGER format. Tests and benches have others answer what `sat` answers.

use crate::model::Model;
use crate::question::Question;
use crate::reason::{Part as Unfollowed, Reason};
use crate::sat::{Signal, aiger};
use crate::system::{Observed, system};

/// A file with the questions that can be asked by it.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The bytes of the file, AIGER 1.9. One step of it is one scan.
    pub file: Vec<u8>,
    /// For each question its place in the file, or why it cannot be asked of one scan after the other.
    pub rows: Vec<Result<Row, Reason>>,
}

/// The place of a question in a file.
#[derive(Clone, Debug)]
pub struct Row {
    /// The number of the bad signal that is 1 at a scan that breaks the claim, or shows it if it is of some run.
    pub bad: usize,
    /// The number of the one that is 1 behind a scan that is not followed to its end.
    pub unsure: usize,
    /// The reasons why the file has more runs than the chart, as far as the question depends on them.
    pub limits: Vec<Unfollowed>,
}

/// Writes the questions of a chart.
pub fn exported(model: &Model<'_>, questions: &[Question]) -> Exported {
    let translated = system(model, questions, Observed::Asked);
    let mut bad: Vec<Signal> = Vec::new();
    let mut rows = Vec::new();
    for (asked, follows) in translated.asked.iter().zip(&translated.follows) {
        let asked = match follows {
            Some(_) => Err(Reason::Future),
            None => asked.clone(),
        };
        rows.push(asked.map(|asked| {
            let limits = translated.limits(&[asked.bad, asked.unsure]);
            let limits = limits.iter().map(|l| l.part).collect();
            bad.extend([asked.bad, asked.unsure]);
            Row { bad: bad.len() - 2, unsure: bad.len() - 1, limits }
        }));
    }
    Exported { file: aiger(&translated.system, &bad), rows }
}
