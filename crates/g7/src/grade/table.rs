//! The results in the terminal: a line for each submission, and below it what its author must know.

use std::io::{self, Write};

use g7_grade::{Answered, Ended, Exercise, Graded, Mark};
use g7_model::{Said, say};

use super::rows::{Row, Rows};
use crate::failure::raw;
use crate::message::told;
use crate::style;
use crate::tongue::language;

/// Most errors of a submission that are shown.
const ERRORS: usize = 3;

/// Prints that the exercise itself is right, and which test catches each wrong solution.
pub(super) fn exercise(
    out: &mut dyn Write,
    exercise: &Exercise,
    model: &Graded,
    names: &[String],
    wrong: &[Graded],
) -> io::Result<()> {
    let title = exercise.statement.title(language());
    writeln!(out, "{}{title}{:#}", style::STRONG, style::STRONG)?;
    let (seen, hidden): (Vec<_>, Vec<_>) = exercise.tests().partition(|(_, hidden)| !hidden);
    let hints = exercise.hints.steps(language()).len();
    let counted =
        say!("tests that the student sees: {}; hidden: {}; hints: {hints}", seen.len(), hidden.len());
    writeln!(out, "  {}", told(&counted))?;
    let good = style::GOOD;
    writeln!(out, "  {good}{}{good:#}: {}", g7_grade::MODEL, told(&summary(model)))?;
    for (name, one) in names.iter().zip(wrong) {
        let caught = match (one.first_failing(), one.questions.iter().find(|q| q.is_refuted())) {
            (Some(test), _) => say!("caught by the test `{}`", raw(&test.title)),
            (None, Some(question)) => say!("caught by the question `{}`", question.claim),
            (None, None) => continue,
        };
        writeln!(out, "  {good}{name}{good:#}: {}", told(&caught))?;
    }
    writeln!(out, "{}", told(&say!("the exercise is right")))
}

/// The numbers of a graded submission in a sentence.
fn summary(graded: &Graded) -> Said {
    let ((passed, all), (reached, elements)) = (graded.passed(), graded.reached());
    let (proved, questions) = graded.proved();
    say!(
        "tests passed: {passed} of {all}; elements reached: {reached} of {elements}; questions proved: {proved} of {questions}"
    )
}

/// Prints the table, and the groups of charts that are the same.
pub(super) fn rows(out: &mut dyn Write, all: &Rows) -> io::Result<()> {
    let rows = &all.rows;
    let width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).min(40);
    let marks: Vec<String> = rows.iter().map(|r| told(&r.mark().said())).collect();
    let wide = marks.iter().map(|m| m.chars().count()).max().unwrap_or(0);
    for (row, mark) in rows.iter().zip(&marks) {
        let colour = if row.mark() == Mark::Passed { style::GOOD } else { style::BAD };
        let numbers = row.graded.as_ref().map(numbers).unwrap_or_default();
        let first = row.first_failing().map(|t| t.title.clone()).unwrap_or_default();
        let line = format!("{:width$}  {colour}{mark:wide$}{colour:#}  {numbers}  {first}", row.name);
        writeln!(out, "{}", line.trim_end())?;
        for note in notes(row) {
            writeln!(out, "  {note}")?;
        }
    }
    if !all.groups.is_empty() {
        writeln!(out)?;
    }
    for group in &all.groups {
        writeln!(out, "{}", told(&alike(group)))?;
    }
    writeln!(out, "\n{}", told(&counted(all)))
}

/// The sentence about all submissions.
pub(super) fn counted(all: &Rows) -> Said {
    say!("submissions that passed: {passed} of {}", all.rows.len(), passed = all.passed())
}

/// Tests, coverage and questions in columns.
fn numbers(graded: &Graded) -> String {
    let ((passed, all), (proved, questions)) = (graded.passed(), graded.proved());
    format!("{passed:>3}/{all:<3} {:>4} %  {proved}/{questions}", percent(graded))
}

/// The part of the elements that the tests reached.
pub(super) fn percent(graded: &Graded) -> usize {
    let (reached, elements) = graded.reached();
    (reached * 100).checked_div(elements).unwrap_or(0)
}

/// The sentences about a submission, each with its place.
pub(super) fn notes(row: &Row) -> Vec<String> {
    let mut notes = Vec::new();
    match &row.graded {
        Err(why) => notes.push(told(why)),
        Ok(graded) => {
            notes.extend(errors(graded));
            notes.extend(graded.changed.iter().map(|c| format!("{}: {}", c.place, told(&c.what))));
            notes.extend(graded.lacks.iter().map(|l| format!("{}: {}", l.place, told(&l.said()))));
            // A name that is missing was told above.
            let is_told = |blocked: bool| blocked && !graded.lacks.is_empty();
            if let Some(test) = graded.first_failing()
                && let Some(why) = test.ended.why()
                && !is_told(matches!(test.ended, Ended::Blocked { .. }))
            {
                notes.push(format!("{}: {}", test.ended.place().unwrap_or(&test.place), told(&why)));
            }
            let open = graded.questions.iter().filter(|q| !q.is_proved() && !is_told(q.verdict.is_none()));
            notes.extend(open.map(|q| format!("{}: {}: {}", q.place, told(&answer(q)), told(&q.claim))));
        }
    }
    notes
}

/// The word for an answer.
pub(super) fn answer(question: &Answered) -> Said {
    match &question.verdict {
        Some(verdict) => Said::in_each(g7_verify::words::verdict(verdict)),
        None => say!("it cannot be asked here"),
    }
}

/// The sentence about charts that are the same.
pub(super) fn alike(group: &[String]) -> Said {
    say!("the same but for names: {}", raw(group.join(", ")))
}

/// The first errors of the charts, each with its place.
pub(super) fn errors(graded: &Graded) -> Vec<String> {
    let all = &graded.problems;
    let mut shown: Vec<String> = all
        .iter()
        .take(ERRORS)
        .map(|p| format!("{}: {} [{}]", graded.source.place(p.at), told(&p.what), p.code.id))
        .collect();
    if all.len() > ERRORS {
        shown.push(told(&say!("more errors: {}", all.len() - ERRORS)));
    }
    shown
}
