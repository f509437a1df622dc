//! Grades submissions, several at a time, and finds those that are alike. Each becomes a row of the reports.

use std::panic::{AssertUnwindSafe, catch_unwind};

use g7_grade::{Exercise, Graded, Limits, MODEL, Mark, Shape, Stop, TEMPLATE, Tested, groups, judge};
use g7_host::{Clock, WallClock};
use g7_model::{Said, say};
use g7_rig::Source;

use super::args::Grade;
use super::folder::Submission;
use crate::failure::Failure;
use crate::share;

/// A submission in the reports.
pub(super) struct Row {
    pub(super) name: String,
    /// The result, or why there is nothing to grade.
    pub(super) graded: Result<Graded, Said>,
    shape: Option<Shape>,
    /// Others that are the same but for names.
    pub(super) like: Vec<String>,
}

impl Row {
    pub(super) fn mark(&self) -> Mark {
        self.graded.as_ref().map_or(Mark::Unread, |g| g.mark)
    }

    /// The first test that did not pass.
    pub(super) fn first_failing(&self) -> Option<&Tested> {
        self.graded.as_ref().ok().and_then(Graded::first_failing)
    }
}

/// Grades the model solution and the wrong solutions of an exercise.
pub(super) fn solutions(
    args: &Grade,
    exercise: &Exercise,
) -> Result<(Graded, Vec<(String, Graded)>), Failure> {
    let all: Vec<(&str, &[u8])> = std::iter::once((MODEL, exercise.model.bytes.as_slice()))
        .chain(exercise.wrong.iter().map(|(path, bytes)| (path.as_str(), bytes.as_slice())))
        .collect();
    let mut graded = Vec::new();
    let one = |(path, bytes): &(&str, &[u8])| {
        let name = args.exercise.join(path).display().to_string();
        Ok((
            (*path).to_owned(),
            work(args, exercise, exercise.submission(&name, bytes.to_vec(), &mut no_file)),
        ))
    };
    share::in_order(args.jobs, &all, one, |done| {
        graded.push(done);
        Ok(())
    })?;
    let mut graded = graded.into_iter();
    match graded.next() {
        Some((_, model)) => Ok((model, graded.collect())),
        None => Err(Failure::Usage(say!("there is no model solution"))),
    }
}

/// The rows of all submissions, and the groups of those that are the same but for names.
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    pub(super) groups: Vec<Vec<String>>,
}

impl Rows {
    /// The number of submissions that passed.
    pub(super) fn passed(&self) -> usize {
        self.rows.iter().filter(|row| row.mark() == Mark::Passed).count()
    }
}

/// Grades submissions; `step` is called for each.
pub(super) fn rows(
    args: &Grade,
    exercise: &Exercise,
    submissions: &[Submission],
    mut step: impl FnMut(),
) -> Result<Rows, Failure> {
    let mut rows = Vec::new();
    let one = |submission: &Submission| Ok(row(args, exercise, submission));
    share::in_order(args.jobs, submissions, one, |row| {
        step();
        rows.push(row);
        Ok(())
    })?;
    let groups = find_like(exercise, &mut rows);
    Ok(Rows { rows, groups })
}

/// Grades a submission. A panic is a mistake of G7; all others are graded nevertheless.
fn row(args: &Grade, exercise: &Exercise, submission: &Submission) -> Row {
    let graded = || {
        let source = submission.load(exercise)?;
        let shape = Shape::of(&source, &exercise.template);
        Ok((work(args, exercise, source), shape))
    };
    let done = catch_unwind(AssertUnwindSafe(graded))
        .unwrap_or_else(|_| Err(say!("g7 stopped at this file, which is a mistake of g7: please report it")));
    let (graded, shape) = match done {
        Ok((graded, shape)) => (Ok(graded), shape),
        Err(why) => (Err(why), None),
    };
    Row { name: submission.name.clone(), graded, shape, like: Vec::new() }
}

fn work(args: &Grade, exercise: &Exercise, source: Source) -> Graded {
    let end = || -> Stop {
        let (clock, length) = (WallClock::default(), args.time);
        Box::new(move || {
            let mut clock = clock;
            clock.now() >= length
        })
    };
    let bytes = args.memory.saturating_mul(1 << 20);
    let mut clock = WallClock::default();
    let limits = &mut Limits { test: args.timeout, questions: &end, bytes, states: None, clock: &mut clock };
    judge(exercise, source, limits)
}

/// The groups of submissions that are the same but for names, solutions of the exercise among them. Each row is told the
/// others of its group.
fn find_like(exercise: &Exercise, rows: &mut [Row]) -> Vec<Vec<String>> {
    let own = |name: &str, source: &Source| (name.to_owned(), Shape::of(source, &exercise.template));
    let mut all = vec![own(TEMPLATE, &exercise.template), own(MODEL, &exercise.model)];
    for (path, bytes) in &exercise.wrong {
        let source = exercise.submission(path, bytes.clone(), &mut no_file);
        all.push(own(path, &source));
    }
    let first = all.len();
    all.extend(rows.iter_mut().map(|row| (row.name.clone(), row.shape.take())));
    let (names, shapes): (Vec<String>, Vec<Option<Shape>>) = all.into_iter().unzip();
    let mut found = Vec::new();
    for group in groups(&shapes).iter().filter(|group| group.iter().any(|number| *number >= first)) {
        let named = |of: &[usize]| of.iter().filter_map(|n| names.get(*n).cloned()).collect::<Vec<_>>();
        for number in group {
            let others: Vec<usize> = group.iter().copied().filter(|other| other != number).collect();
            let row = number.checked_sub(first).and_then(|number| rows.get_mut(number));
            row.into_iter().for_each(|row| row.like = named(&others));
        }
        found.push(named(group));
    }
    found
}

/// A solution of the exercise brings no files.
fn no_file(_: &str) -> Result<Vec<u8>, Said> {
    Err(say!("a solution uses the library and the files of the template alone"))
}
