//! Prints an answer: its sentences one below the other, each cause indented below its effect, and the places that they
//! speak of, marked in the text.

use std::io::Write;

use g7_model::Span;
use g7_why::Cause;
use serde_json::Value;

use crate::failure::Failure;
use crate::message::told;
use crate::reasons;
use crate::report;
use crate::sources::Source;
use crate::style;

/// Most places that are marked.
const PLACES: usize = 12;

pub(super) fn text(source: &Source, cause: &Cause) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    for (depth, line) in cause.lines() {
        let style = if depth == 0 {
            style::STRONG
        } else if line.aside {
            style::FAINT
        } else {
            anstyle::Style::new()
        };
        let sign = match (depth, line.aside) {
            (0, _) => "",
            (_, true) => "· ",
            (_, false) => "← ",
        };
        writeln!(out, "{}{sign}{style}{}{style:#}", "  ".repeat(depth), told(&line.said))?;
    }
    let places = places(cause);
    if !places.is_empty() {
        writeln!(out, "\n{}", report::marked(source, &told(&cause.said), &places))?;
    }
    Ok(out.flush()?)
}

/// The places of an answer with their sentences, each place once, those of asides only where there is room.
fn places(cause: &Cause) -> Vec<(Span, Option<String>)> {
    let mut found: Vec<(Span, Option<String>)> = Vec::new();
    let lines = cause.lines();
    let followed = lines.iter().filter(|(_, c)| !c.aside);
    for (_, line) in followed.chain(lines.iter().filter(|(_, c)| c.aside)) {
        let Some(at) = line.places.first() else { continue };
        if found.len() < PLACES && !found.iter().any(|(there, _)| there == at) {
            found.push((*at, (!found.is_empty()).then(|| told(&line.said))));
        }
    }
    found
}

pub(super) fn json(source: &Source, cause: &Cause) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    writeln!(out, "{:#}", value(source, cause))?;
    Ok(out.flush()?)
}

/// A sentence with its causes as JSON.
fn value(source: &Source, cause: &Cause) -> Value {
    let mut value = reasons::json(cause);
    value["places"] = cause.places.iter().map(|at| report::place(source, *at)).collect();
    value["causes"] = cause.causes.iter().map(|c| self::value(source, c)).collect();
    value
}
