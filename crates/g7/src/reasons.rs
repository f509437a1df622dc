//! The causes that a failed test and a refuted question bring along, for people and programs.
//!
//! ```text
//! rig::testing::causes -> testing::output | prove::output | grade
//! ```

use std::io::{self, Write};

use g7_model::say;
use g7_why::Cause;
use serde_json::{Value, json};

use crate::message::told;

/// Most lines that are printed.
const LINES: usize = 6;

/// Prints the first sentences of each chain; what held as well is left out.
pub(crate) fn lines(out: &mut dyn Write, why: &[Cause]) -> io::Result<()> {
    let lines: Vec<(usize, &Cause)> = why.iter().flat_map(Cause::lines).filter(|(_, c)| !c.aside).collect();
    // A line that says that one more is left is as long as that one.
    let shown = if lines.len() == LINES + 1 { lines.len() } else { LINES };
    for (depth, line) in lines.iter().take(shown) {
        writeln!(out, "  {}{}{}", "  ".repeat(*depth), if *depth > 0 { "← " } else { "" }, told(&line.said))?;
    }
    if lines.len() > shown {
        writeln!(out, "  {}", told(&say!("… and {} more causes", lines.len() - shown)))?;
    }
    Ok(())
}

/// A sentence with its causes, without places.
pub(crate) fn json(cause: &Cause) -> Value {
    json!({
        "what": told(&cause.said), "kind": cause.fact.word(), "time_seconds": cause.now.as_seconds(),
        "aside": cause.aside, "causes": cause.causes.iter().map(json).collect::<Vec<_>>(),
    })
}
