//! Draws charts as Mermaid flowcharts, for pages that draw them from text.
//!
//! This is a picture and is not read back: steps are boxes (with a thick frame for an initial step,
//! with side lines for a macro-step or enclosing step), transitions are hexagons with their
//! receptivity, actions are notes beside their step. Identifiers are numbered, so no name can break
//! the text. Signs with a meaning in Mermaid or HTML are written as character codes in labels.

use std::collections::HashMap;
use std::fmt::Write;

use g7_model::{Chart, ChartKind, Document, Step, StepKind, Transition};
use g7_syntax::{Part, print_expr, print_part};

use crate::Written;

/// Writes one flowchart with a box for each chart.
pub(crate) fn export(document: &Document) -> Written {
    let mut text = String::from("flowchart TB\n");
    for (number, chart) in document.charts().enumerate() {
        draw(&mut text, number, chart);
    }
    text.push_str("  classDef action fill:none,stroke-dasharray:4\n");
    Written { text, problems: Vec::new() }
}

fn draw(text: &mut String, number: usize, chart: &Chart) {
    let kind = match chart.kind {
        ChartKind::Chart => "",
        ChartKind::Expansion => "expansion ",
        ChartKind::Task => "task ",
    };
    line(
        text,
        1,
        &format!("subgraph c{number}[{}]", label(&[kind, &chart.name.text], chart.comment.as_deref())),
    );
    let ids: HashMap<&str, String> =
        chart.steps().enumerate().map(|(i, s)| (&*s.name.text, format!("c{number}s{i}"))).collect();
    for (step, id) in chart.steps().filter_map(|s| Some((s, ids.get(&*s.name.text)?))) {
        draw_step(text, step, id);
    }
    for (i, transition) in chart.transitions().enumerate() {
        draw_transition(text, transition, &format!("c{number}t{i}"), &ids);
    }
    line(text, 1, "end");
}

fn draw_step(text: &mut String, step: &Step, id: &str) {
    let name = label(&[&step.name.text], step.comment.as_deref());
    let symbol = match step.kind {
        // Mermaid's box with double side lines is its symbol of a subroutine.
        StepKind::Macro(_) | StepKind::Enclosing => format!("{id}[[{name}]]"),
        StepKind::Plain | StepKind::Entry | StepKind::Exit => format!("{id}[{name}]"),
    };
    line(text, 2, &symbol);
    if step.initial {
        // A thick frame replaces the double square, which Mermaid does not have for boxes.
        line(text, 2, &format!("style {id} stroke-width:4px"));
    }
    for (i, action) in step.actions.iter().enumerate() {
        line(
            text,
            2,
            &format!("{id}a{i}[{}]:::action", label(&[&print_part(Part::Action(action), None)], None)),
        );
        line(text, 2, &format!("{id} -.- {id}a{i}"));
    }
}

fn draw_transition(text: &mut String, transition: &Transition, id: &str, ids: &HashMap<&str, String>) {
    let receptivity = print_expr(&transition.receptivity);
    let label = match &transition.label {
        Some(name) => label(&[&name.text, ": ", &receptivity], transition.comment.as_deref()),
        None => label(&[&receptivity], transition.comment.as_deref()),
    };
    line(text, 2, &format!("{id}{{{{{label}}}}}"));
    for from in transition.from.iter().filter_map(|n| ids.get(&*n.text)) {
        line(text, 2, &format!("{from} --- {id}"));
    }
    for to in transition.to.iter().filter_map(|n| ids.get(&*n.text)) {
        line(text, 2, &format!("{id} --> {to}"));
    }
}

/// A quoted label: the parts in a row, with a comment below them.
fn label(parts: &[&str], comment: Option<&str>) -> String {
    let mut label = String::from("\"");
    parts.iter().for_each(|p| escape(&mut label, p));
    if let Some(comment) = comment {
        label.push_str("<br/>");
        escape(&mut label, comment);
    }
    label.push('"');
    label
}

/// Writes letters, digits, blanks and harmless signs as they are, line ends as breaks, the rest as
/// codes.
fn escape(out: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '\n' => out.push_str("<br/>"),
            c if c.is_control() => out.push(' '),
            '"' | '#' | '&' | '<' | '>' | ';' | '`' | '\\' | '*' | '_' | '[' | ']' | '{' | '}' | '|'
            | '~' => {
                // Writing to a string cannot fail.
                let _ = write!(out, "#{};", u32::from(c));
            }
            c => out.push(c),
        }
    }
}

fn line(text: &mut String, depth: usize, line: &str) {
    text.extend(std::iter::repeat_n("  ", depth));
    text.push_str(line);
    text.push('\n');
}
