//! Answers in SARIF 2.1.0 (OASIS, 2020), for tools of code review.
//!
//! A refuted claim is a result of the kind `fail`, with the scans of its run as a code flow; one
//! that is not decided is `open`, a proved one `pass`.

use std::collections::BTreeMap;
use std::io::Write;

use g7_verify::{Claim, Verdict};
use serde_json::{Value, json};

use super::found::{Answered, Found};
use super::output::{trouble, word};
use crate::failure::Failure;
use crate::sarif::{artifact, log};

/// The questions as rules: name, and what is claimed.
const RULES: [(&str, &str); 13] = [
    ("step-active", "Each step can be active."),
    ("transition-clears", "Each transition can clear."),
    ("action-runs", "Each action can run."),
    ("output-on", "Each output can be other than 0."),
    ("input-asked", "Each input is asked for."),
    ("no-deadlock", "From each situation some input leads on, or the chart is at its end."),
    ("no-conflict", "No two transitions of one step are clearable at once."),
    ("no-unsafe", "No step is activated while it is active."),
    ("no-instability", "Every evolution ends."),
    ("no-opposed-writes", "No pass gives a variable two values."),
    ("no-opposed-orders", "Forcing orders agree."),
    ("no-fault", "No fault stops the chart."),
    ("property", "A property that the author wrote."),
];

/// The rule of a claim.
pub(super) fn rule(claim: &Claim) -> &'static str {
    match claim {
        Claim::Active(_) => "step-active",
        Claim::Clears(_) => "transition-clears",
        Claim::Runs(_) => "action-runs",
        Claim::On(_) => "output-on",
        Claim::Asked(_) => "input-asked",
        Claim::NoDeadlock => "no-deadlock",
        Claim::NoConflict => "no-conflict",
        Claim::NoUnsafe => "no-unsafe",
        Claim::NoInstability => "no-instability",
        Claim::NoOpposedWrites => "no-opposed-writes",
        Claim::NoOpposedOrders => "no-opposed-orders",
        Claim::NoFault => "no-fault",
        Claim::Always(_)
        | Claim::Never(_)
        | Claim::Reachable(_)
        | Claim::AtMost(..)
        | Claim::Within { .. }
        | Claim::Until { .. }
        | Claim::Between { .. }
        | Claim::LeadsTo { .. } => "property",
    }
}

/// Prints a log with one run. What is proved is in it with `all` only, since many tools of code
/// review show every result as a finding.
pub(super) fn print(found: &[Found], all: bool) -> Result<(), Failure> {
    let list = || found.iter().flat_map(|f| &f.answers);
    let rules: Vec<Value> =
        RULES.iter().map(|(id, text)| json!({ "id": id, "shortDescription": { "text": text } })).collect();
    let shown = list().filter(|a| all || !matches!(a.verdict, Verdict::Proved(_)));
    let results: Vec<Value> = shown.map(result).collect();
    let files: BTreeMap<&str, Value> =
        list().map(|a| place(&a.place).0).map(|f| (f, json!({ "location": artifact(f) }))).collect();
    // A file with errors, or one for which the time was over.
    let notes: Vec<Value> = found.iter().filter_map(notification).collect();
    let run = json!({
        "tool": { "driver": {
            "name": "g7 prove", "semanticVersion": env!("CARGO_PKG_VERSION"), "rules": rules,
        } },
        "invocations": [{
            "executionSuccessful": notes.is_empty(), "toolExecutionNotifications": notes,
        }],
        "columnKind": "unicodeCodePoints",
        "artifacts": files.into_values().collect::<Vec<_>>(),
        "results": results,
    });
    let log = log(&run);
    writeln!(anstream::stdout().lock(), "{log:#}")?;
    Ok(())
}

fn notification(found: &Found) -> Option<Value> {
    let level = if found.tally.errors > 0 { "error" } else { "warning" };
    let text = trouble(found)?;
    Some(json!({
        "level": level, "message": { "text": text },
        "locations": [{ "physicalLocation": { "artifactLocation": artifact(&found.name) } }],
    }))
}

fn result(a: &Answered) -> Value {
    let (kind, level) = match a.verdict {
        Verdict::Proved(_) => ("pass", "none"),
        Verdict::Refuted(_) => ("fail", "error"),
        Verdict::Open(_) => ("open", "none"),
    };
    let mut text = format!("{}: {}; {}", word(&a.verdict), a.claim, a.reason);
    if !a.guilt.is_empty() {
        text.push_str(&format!("; {}", a.guilt));
    }
    if !a.help.is_empty() {
        text.push_str(&format!(". Help: {}", a.help));
    }
    let index = RULES.iter().position(|(id, _)| *id == a.rule);
    let mut row = json!({
        "ruleId": a.rule, "ruleIndex": index, "kind": kind, "level": level, "message": { "text": text },
        "locations": [location(&a.place, None)],
    });
    if !a.scans.is_empty() {
        let steps: Vec<Value> = a
            .scans
            .iter()
            .enumerate()
            .map(|(i, text)| json!({ "executionOrder": i + 1, "location": location(&a.place, Some(text)) }))
            .collect();
        row["codeFlows"] = json!([{ "threadFlows": [{ "locations": steps }] }]);
    }
    row
}

fn location(at: &str, message: Option<&str>) -> Value {
    let (file, line, column) = place(at);
    let mut row = json!({ "physicalLocation": {
        "artifactLocation": artifact(file), "region": { "startLine": line, "startColumn": column },
    } });
    if let Some(text) = message {
        row["message"] = json!({ "text": text });
    }
    row
}

/// `path:line:column` in its parts.
fn place(at: &str) -> (&str, u64, u64) {
    let mut parts = at.rsplitn(3, ':');
    let number = |part: Option<&str>| part.and_then(|p| p.parse().ok()).unwrap_or(1);
    let (column, line) = (number(parts.next()), number(parts.next()));
    (parts.next().unwrap_or(at), line, column)
}

#[cfg(test)]
mod tests {
    use super::place;

    #[test]
    fn places_are_what_a_reader_expects() {
        assert_eq!(place("a/b.g7:12:3"), ("a/b.g7", 12, 3));
        assert_eq!(place("C:/b.g7:12:3"), ("C:/b.g7", 12, 3));
    }
}
