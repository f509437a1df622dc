//! The interface to everything that can run a chart: the naive engine, the engine, generated code.
//! Cases and random charts use all of them through it.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Document, Expr, ProfileName};

use crate::naive::{Naive, NaiveFault, Value};

/// Why a scan ended early, in the words of the cases.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// A state recurred; the situations of the cycle, with qualified step names.
    Unstable(Vec<BTreeSet<String>>),
    /// `forcing`, `overflow`, `division`, `range`, `bound`, `table`.
    Kind(&'static str),
    /// A failure that the chart did not cause.
    Other(String),
}

impl Fault {
    /// The word for it in the cases.
    pub fn kind(&self) -> &str {
        match self {
            Fault::Unstable(_) => "unstable",
            Fault::Kind(k) => k,
            Fault::Other(what) => what,
        }
    }
}

/// A running chart. Names are qualified: `G.5`, `G.M3.E`, `v`, `G.v`, `fb.Q`.
pub trait Subject {
    /// Makes one scan with these inputs; those not named keep their values.
    ///
    /// # Errors
    ///
    /// The fault that ended it.
    fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), Fault>;
    /// Restarts.
    fn restart(&mut self, cold: bool);
    /// The active steps, without macro-steps.
    fn active(&self) -> BTreeSet<String>;
    /// The outputs that the plant receives.
    fn outputs(&self) -> BTreeMap<String, Value>;
    /// All variables except constants; members of blocks too.
    fn variables(&self) -> BTreeMap<String, Value>;
    /// The times of the steps, without macro-steps: in nanoseconds, or in scans if the profile
    /// counts scans.
    fn step_times(&self) -> BTreeMap<String, i64>;
    /// The variables for which the last scan reported conflicting assignments; the engine reports
    /// only the first.
    fn conflicts(&self) -> Vec<String>;
    /// Evaluates a condition on the present state.
    ///
    /// # Errors
    ///
    /// It has no value.
    fn holds(&mut self, e: &Expr) -> Result<bool, String>;
}

/// Makes a subject from a document and a profile, together with the expressions that
/// [`Subject::holds`] will evaluate.
pub type Backend = fn(&Document, Option<ProfileName>, &[Expr]) -> Result<Box<dyn Subject>, String>;

/// The naive engine.
///
/// # Errors
///
/// The document has no meaning.
pub fn naive(doc: &Document, profile: Option<ProfileName>, _: &[Expr]) -> Result<Box<dyn Subject>, String> {
    Ok(Box::new(Naive::new(doc, profile)?))
}

impl From<NaiveFault> for Fault {
    fn from(fault: NaiveFault) -> Fault {
        match fault {
            NaiveFault::Unstable(cycle) => {
                Fault::Unstable(cycle.into_iter().map(|s| s.into_iter().collect()).collect())
            }
            NaiveFault::Passes => Fault::Kind("bound"),
            NaiveFault::Forcing(_) => Fault::Kind("forcing"),
            NaiveFault::Overflow => Fault::Kind("overflow"),
            NaiveFault::Division => Fault::Kind("division"),
            NaiveFault::Work => Fault::Kind("bound"),
            NaiveFault::Index => Fault::Kind("range"),
            NaiveFault::Table => Fault::Kind("table"),
            NaiveFault::Stopped => Fault::Other("stopped".into()),
            NaiveFault::Bad(what) => Fault::Other(what),
        }
    }
}

impl Subject for Naive {
    fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), Fault> {
        Naive::scan(self, inputs, now).map_err(Fault::from)
    }

    fn restart(&mut self, cold: bool) {
        // The initial values were evaluated without error when the subject was made.
        let _ = Naive::restart(self, cold);
    }

    fn active(&self) -> BTreeSet<String> {
        Naive::active(self)
    }

    fn outputs(&self) -> BTreeMap<String, Value> {
        Naive::outputs(self)
    }

    fn variables(&self) -> BTreeMap<String, Value> {
        Naive::variables(self).into_iter().map(|(n, _, v)| (n, v)).collect()
    }

    fn step_times(&self) -> BTreeMap<String, i64> {
        Naive::step_times(self).into_iter().filter(|(_, _, plain)| *plain).map(|(n, t, _)| (n, t)).collect()
    }

    fn conflicts(&self) -> Vec<String> {
        Naive::conflicts(self).to_vec()
    }

    fn holds(&mut self, e: &Expr) -> Result<bool, String> {
        match self.eval(e) {
            Ok(Value::Bool(b)) => Ok(b),
            Ok(other) => Err(format!("{other:?} is no truth value")),
            Err(f) => Err(format!("{f:?}")),
        }
    }
}
