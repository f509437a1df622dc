//! Problems as a log of SARIF 2.1.0, with their fixes, for tools of code review.

use crate::tongue::language;
use std::collections::{BTreeMap, BTreeSet};

use g7_model::codes::{self, Code};
use g7_model::{Fix, Problem, Span};
use serde_json::{Value, json};

use super::checked::Checked;
use crate::sarif::{artifact, log};
use crate::sources::Source;

/// A log with one run.
pub(super) fn of(all: &[Checked]) -> Value {
    let used: BTreeSet<&str> = all.iter().flat_map(|c| &c.problems).map(|p| p.code.id).collect();
    let rules: Vec<&Code> = codes::ALL.iter().copied().filter(|code| used.contains(code.id)).collect();
    let place: BTreeMap<&str, usize> = rules.iter().enumerate().map(|(i, code)| (code.id, i)).collect();
    let results: Vec<Value> =
        all.iter().flat_map(|c| c.problems.iter().map(|p| result(&c.source, p, &place))).collect();
    let files: Vec<Value> = all.iter().map(|c| json!({ "location": artifact(&c.source.name) })).collect();
    log(&json!({
        "tool": { "driver": {
            "name": "g7 check", "semanticVersion": env!("CARGO_PKG_VERSION"),
            "rules": rules.into_iter().map(rule).collect::<Vec<_>>(),
        } },
        "invocations": [{ "executionSuccessful": true }],
        "columnKind": "unicodeCodePoints",
        "artifacts": files,
        "results": results,
    }))
}

fn rule(code: &Code) -> Value {
    let mut rule = json!({
        "id": code.id,
        "shortDescription": { "text": code.title_in(language()) },
        "defaultConfiguration": { "level": code.severity.name() },
    });
    if let Some(page) = g7_page::explain(code.id, g7_model::Language::English) {
        rule["help"] = json!({ "text": page, "markdown": page });
    }
    rule
}

fn result(source: &Source, problem: &Problem, rules: &BTreeMap<&str, usize>) -> Value {
    let help = problem
        .help
        .as_ref()
        .map_or_else(String::new, |help| format!(". Help: {}", help.in_language(language())));
    let related: Vec<Value> = problem
        .related
        .iter()
        .map(|(at, there)| {
            let mut place = location(source, *at);
            place["message"] = json!({ "text": there.in_language(language()) });
            place
        })
        .collect();
    let mut row = json!({
        "ruleId": problem.code.id, "ruleIndex": rules.get(problem.code.id),
        "level": problem.severity().name(), "message": { "text": format!("{}{help}", problem.what.in_language(language())) },
        "locations": [location(source, problem.at)],
        "relatedLocations": related,
    });
    if !problem.fixes.is_empty() {
        row["fixes"] = problem.fixes.iter().map(|f| fix(source, f)).collect();
    }
    row
}

fn location(source: &Source, at: Span) -> Value {
    json!({ "physicalLocation": { "artifactLocation": artifact(&source.home(at).name), "region": region(source, at) } })
}

fn region(source: &Source, at: Span) -> Value {
    let source = source.home(at);
    let range = source.range(at);
    let ((line, column), (end_line, end_column)) = (source.position(range.start), source.position(range.end));
    json!({ "startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column })
}

fn fix(source: &Source, fix: &Fix) -> Value {
    let edit = |e: &g7_model::TextEdit| json!({ "deletedRegion": region(source, e.at), "insertedContent": { "text": e.text } });
    json!({
        "description": { "text": fix.label.in_language(language()) },
        "artifactChanges": [{
            "artifactLocation": artifact(&fix.edits.first().map_or(source, |e| source.home(e.at)).name),
            "replacements": fix.edits.iter().map(edit).collect::<Vec<_>>(),
        }],
    })
}
