//! `g7 grade`: checks an exercise, and grades what students hand in.
//!
//! ```text
//! folder of the exercise -> Files -> g7_grade::Exercise -> its solutions graded -> mistakes for the teacher
//! folder of submissions  -> rows (several at a time)    -> table, CSV, JSON, HTML
//! ```
//!
//! Decision 78 has the form of an exercise.

mod args;
mod data;
mod folder;
mod html;
mod pages;
mod rows;
mod table;

use std::io::Write;
use std::path::{Path, PathBuf};

use g7_grade::{Exercise, Fault, check};
use g7_model::say;

use crate::failure::{Failure, Verdict};
use crate::message::{done, talk, told, wrote};
use crate::progress::Progress;
use crate::{files, style};
pub(crate) use args::Grade;
use rows::Rows;

pub(crate) fn grade(args: &Grade) -> Result<Verdict, Failure> {
    let found = folder::exercise(&args.exercise)?;
    let exercise = match Exercise::read(&found, &args.exercise.display().to_string()) {
        Ok(exercise) => exercise,
        Err(faults) => return Ok(refused(&faults)),
    };
    let submissions = args.submissions.as_deref().map(folder::submissions).transpose()?;
    refuse_outputs(args)?;
    let (model, wrong) = rows::solutions(args, &exercise)?;
    let (names, wrong): (Vec<String>, Vec<_>) = wrong.into_iter().unzip();
    let faults = check(&model, &wrong);
    if !faults.is_empty() {
        return Ok(refused(&faults));
    }
    let mut out = anstream::stdout().lock();
    let Some(submissions) = submissions else {
        table::exercise(&mut out, &exercise, &model, &names, &wrong)?;
        out.flush()?;
        return Ok(Verdict::Fine);
    };
    let mut progress = Progress::new("grading", submissions.len() as u64);
    let all = rows::rows(args, &exercise, &submissions, || progress.step())?;
    progress.end();
    table::rows(&mut out, &all)?;
    out.flush()?;
    write(args, &exercise, &all)?;
    Ok(if all.passed() == all.rows.len() { Verdict::Fine } else { Verdict::Found })
}

/// Tells what is wrong with an exercise.
fn refused(faults: &[Fault]) -> Verdict {
    for fault in faults {
        talk!(
            "{}: {}{}{:#}: {}",
            fault.place,
            style::BAD,
            told(&say!("error")),
            style::BAD,
            told(&fault.what)
        );
    }
    let what = match faults.len() {
        1 => say!("the exercise has a mistake; nothing was graded"),
        n => say!("the exercise has {n} mistakes; nothing was graded"),
    };
    talk!("{}", told(&what));
    Verdict::Found
}

/// Refuses outputs before the work begins.
fn refuse_outputs(args: &Grade) -> Result<(), Failure> {
    let from: Vec<PathBuf> = args.submissions.iter().cloned().chain([args.exercise.clone()]).collect();
    let from: Vec<&Path> = from.iter().map(PathBuf::as_path).collect();
    for output in [&args.csv, &args.json] {
        files::refuse_foreign(output.as_deref(), &from, args.force)?;
    }
    args.html.as_deref().map_or(Ok(()), |folder| pages::refuse_foreign(folder, &from))
}

fn write(args: &Grade, exercise: &Exercise, all: &Rows) -> Result<(), Failure> {
    if let Some(path) = &args.csv {
        files::write(path, data::csv(&all.rows).as_bytes())?;
        wrote(path.display());
    }
    if let Some(path) = &args.json {
        files::write(path, data::json(exercise, &all.rows).as_bytes())?;
        wrote(path.display());
    }
    if let Some(folder) = &args.html {
        let made = html::pages(exercise, all);
        pages::write(folder, &made)?;
        done(&say!("wrote"), format!("{} ({})", folder.display(), made.len()));
    }
    Ok(())
}
