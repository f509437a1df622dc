//! Why the names in a failed condition have their values: the answers that a failed test brings along.

use g7_host::Runner;
use g7_model::Nanos;
use g7_why::{Cause, Why};

use crate::{Bench, question};

/// Most names that are asked about.
const NAMES: usize = 2;

/// Finds the causes of the values that these names have at the end of a run.
pub type Causes = fn(&Bench, &Runner, &[&str]) -> Vec<Cause>;

/// The answers about the first names of a condition that have one; none where the run was not recorded.
pub fn causes(bench: &Bench, runner: &Runner, names: &[&str]) -> Vec<Cause> {
    let Some(tape) = runner.tape() else { return Vec::new() };
    let Ok(why) = Why::new(&bench.compiled, tape) else { return Vec::new() };
    let now = Nanos::new(runner.state().now());
    let asked = names.iter().filter_map(|name| question(bench, name).ok());
    asked.take(NAMES).filter_map(|asked| why.ask(asked, now).ok()).collect()
}
