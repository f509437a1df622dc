//! Prints problems, for people and for programs.

use crate::failure::raw;
use crate::tongue::language;
use annotate_snippets::{Annotation, AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};
use g7_model::{Fix, Problem, Severity, Span, TextEdit, say};
use g7_rig::testing::Unproved;
use serde_json::{Value, json};

use crate::sources::Source;
use crate::style;

/// Greatest number of lines in one excerpt, folded lines included.
const EXCERPT: usize = 400;
/// Longest line that is shown.
const WIDE: usize = 2_000;
/// Greatest number of problems printed for one file.
const MANY: usize = 100;

/// The number of problems of each severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) errors: usize,
    pub(crate) warnings: usize,
}

impl Tally {
    /// Counts problems.
    pub(crate) fn of(problems: &[Problem]) -> Tally {
        let errors = problems.iter().filter(|p| p.severity() == Severity::Error).count();
        Tally { errors, warnings: problems.len() - errors }
    }

    /// Adds another count.
    pub(crate) fn add(&mut self, other: Tally) {
        self.errors += other.errors;
        self.warnings += other.warnings;
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let errors = match self.errors {
            0 => None,
            1 => Some(say!("1 error")),
            n => Some(say!("{n} errors")),
        };
        let warnings = match self.warnings {
            0 => None,
            1 => Some(say!("1 warning")),
            n => Some(say!("{n} warnings")),
        };
        let parts: Vec<String> =
            errors.into_iter().chain(warnings).map(|part| part.in_language(language())).collect();
        f.write_str(&parts.join(", "))
    }
}

/// A line for each property that another command asks.
pub(crate) fn unproved(list: &[Unproved]) -> String {
    let left = say!("left to g7 prove").in_language(language());
    let line = |p: &Unproved| format!("{}: {}{left}{:#}: {}\n", p.place, style::WARN, style::WARN, p.text);
    list.iter().map(line).collect()
}

/// The same for programs.
pub(crate) fn unproved_json(list: &[Unproved]) -> Value {
    list.iter().map(|p| json!({ "place": p.place, "property": p.text })).collect()
}

/// All problems of a file with excerpts, in the order of the text; coloured.
pub(crate) fn text(source: &Source, problems: &[Problem]) -> String {
    let mut sorted: Vec<&Problem> = problems.iter().collect();
    sorted.sort_by_key(|p| (p.at.file, p.at.start, p.at.end));
    let mut out = String::new();
    for problem in sorted.iter().take(MANY) {
        out.push_str(&one(source, problem));
        out.push_str("\n\n");
    }
    if sorted.len() > MANY {
        let more = say!("… and {} more problems in {}", sorted.len() - MANY, raw(&source.name));
        out.push_str(&format!("{}\n\n", more.in_language(language())));
    }
    out
}

fn one(source: &Source, problem: &Problem) -> String {
    let level = match problem.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let related = problem.related.iter().map(|(at, there)| (*at, Some(there.in_language(language()))));
    let places: Vec<_> = std::iter::once((problem.at, None)).chain(related).collect();
    let mut elements: Vec<Element<'_>> = Vec::new();
    excerpts(source, &places, &mut elements);
    let help = problem.help.as_ref().map(|h| Level::HELP.message(h.in_language(language())));
    let group: Group<'_> = level
        .primary_title(problem.what.in_language(language()))
        .id(problem.code.id)
        .elements(elements)
        .elements(help);
    Renderer::styled().render(&[group])
}

/// A title with excerpts of places, the first of which is the main one; coloured.
pub(crate) fn marked(source: &Source, title: &str, places: &[(Span, Option<String>)]) -> String {
    let mut elements: Vec<Element<'_>> = Vec::new();
    excerpts(source, places, &mut elements);
    Renderer::styled().render(&[Level::NOTE.primary_title(title).elements(elements)])
}

/// The excerpts of the first place and of the related ones; places close to each other share one.
fn excerpts<'a>(source: &'a Source, places: &[(Span, Option<String>)], out: &mut Vec<Element<'a>>) {
    let Some((first, related)) = places.split_first() else { return };
    let mut near: Vec<(Span, Option<String>)> = vec![first.clone()];
    let mut far = Vec::new();
    let line = |span: Span| source.home(span).line(source.home(span).range(span).start);
    for place in related {
        if place.0.file == first.0.file && line(place.0).abs_diff(line(first.0)) < EXCERPT / 2 {
            near.push(place.clone())
        } else {
            far.push(vec![place.clone()])
        }
    }
    for places in std::iter::once(near).chain(far) {
        let home = places.first().map_or(source, |(at, _)| source.home(*at));
        out.push(excerpt(home, places));
    }
}

fn excerpt<'a>(source: &'a Source, places: Vec<(Span, Option<String>)>) -> Element<'a> {
    let ranges: Vec<_> = places.iter().map(|(span, _)| clip(source, *span)).collect();
    let first = ranges.iter().map(|r| source.line(r.start)).min().unwrap_or(0);
    let last = ranges.iter().map(|r| source.line(r.end)).max().unwrap_or(first);
    let region = source.lines(first, last);
    let text = source.text.get(region.clone()).unwrap_or("");
    if text.lines().any(|l| l.len() > WIDE) {
        let (line, column) = source.position(ranges.first().map_or(0, |r| r.start));
        return Origin::path(source.name.as_str()).line(line).char_column(column).into();
    }
    let annotations: Vec<Annotation<'a>> = ranges
        .iter()
        .zip(places)
        .map(|(range, (_, there))| {
            let kind = if there.is_none() { AnnotationKind::Primary } else { AnnotationKind::Context };
            kind.span(range.start - region.start..range.end - region.start).label(there)
        })
        .collect();
    Snippet::source(text).path(source.name.as_str()).line_start(first + 1).annotations(annotations).into()
}

/// A span of several lines is marked on its first line.
fn clip(source: &Source, span: Span) -> std::ops::Range<usize> {
    let range = source.range(span);
    let (first, last) = (source.line(range.start), source.line(range.end));
    if last - first < 6 {
        return range;
    }
    let line = source.lines(first, first);
    let text = source.text.get(range.start..line.end).unwrap_or("").trim_end();
    range.start..range.start + text.len()
}

/// A problem as JSON.
pub(crate) fn json(source: &Source, problem: &Problem) -> Value {
    let severity = problem.severity().name();
    let related: Vec<Value> = problem
        .related
        .iter()
        .map(|(span, there)| {
            let mut place = place(source, *span);
            place["message"] = json!(there.in_language(language()));
            place
        })
        .collect();
    let mut out = place(source, problem.at);
    out["code"] = json!(problem.code.id);
    out["severity"] = json!(severity);
    out["title"] = json!(problem.code.title_in(language()));
    out["message"] = json!(problem.what.in_language(language()));
    out["source"] = json!(problem.code.source);
    out["help"] = json!(problem.help.as_ref().map(|h| h.in_language(language())));
    out["related"] = json!(related);
    let edit = |e: &TextEdit| {
        let mut edit = place(source, e.at);
        edit["text"] = json!(e.text);
        edit
    };
    let fix = |f: &Fix| json!({ "label": f.label.in_language(language()), "sure": f.sure, "edits": f.edits.iter().map(edit).collect::<Vec<_>>() });
    out["fixes"] = problem.fixes.iter().map(fix).collect();
    out
}

/// A place as JSON.
pub(crate) fn place(source: &Source, span: Span) -> Value {
    let source = source.home(span);
    let range = source.range(span);
    let point = |byte: usize| {
        let (line, column) = source.position(byte);
        json!({ "line": line, "column": column, "byte": byte })
    };
    json!({ "file": source.name, "start": point(range.start), "end": point(range.end) })
}
