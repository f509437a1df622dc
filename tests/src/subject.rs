//! What runs a chart: the naive engine, the engine, later generated code. Cases
//! and random charts look at all of them through this one window.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Document, Expr, ProfileName};

use crate::naive::{Naive, NaiveFault, Value};

/// Why a scan ended early, in the words of the cases.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// A state recurred; the situations of the cycle, step names qualified.
    Unstable(Vec<BTreeSet<String>>),
    /// `forcing`, `overflow`, `division`, `range`, `bound`, `table`.
    Kind(&'static str),
    /// Anything that is not the chart's own doing.
    Other(String),
}

impl Fault {
    /// The word that a case has for it.
    pub fn kind(&self) -> &str {
        match self {
            Fault::Unstable(_) => "unstable",
            Fault::Kind(k) => k,
            Fault::Other(what) => what,
        }
    }
}

/// A running program. Names are qualified: `G.5`, `G.M3.E`, `v`, `G.v`, `fb.Q`.
pub trait Subject {
    /// One scan on these inputs; those not named keep their value.
    ///
    /// # Errors
    ///
    /// The fault that ended it.
    fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), Fault>;
    /// Starts again.
    fn restart(&mut self, cold: bool);
    /// Active steps, macro-steps left out.
    fn active(&self) -> BTreeSet<String>;
    /// What goes to the plant.
    fn outputs(&self) -> BTreeMap<String, Value>;
    /// Every variable but constants, members of blocks too.
    fn variables(&self) -> BTreeMap<String, Value>;
    /// Times of the steps that are no macro-steps: nanoseconds, or scans where the profile counts those.
    fn step_times(&self) -> BTreeMap<String, i64>;
    /// Variables with a diagnostic "conflicting assignment" in the last scan; the
    /// engine tells the first one only.
    fn conflicts(&self) -> Vec<String>;
    /// An expression on the state as it is.
    ///
    /// # Errors
    ///
    /// Where it has no value.
    fn holds(&mut self, e: &Expr) -> Result<bool, String>;
}

/// Makes a subject of a document under a profile, with the expressions that
/// [`Subject::holds`] will be asked for.
pub type Backend = fn(&Document, Option<ProfileName>, &[Expr]) -> Result<Box<dyn Subject>, String>;

/// The naive engine.
///
/// # Errors
///
/// Where the document has no meaning.
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
        // Initial values had a value when the program was made.
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
