//! Things that `g7 prove` makes beside its answers: files of tests, and the error of assumptions that
//! contradict each other.

use std::path::PathBuf;

use g7_model::{Nanos, ProfileName, PropertyKind, say};
use g7_rig::Source;
use g7_verify::{Asked, Budget, Model, Verdict, is_open, stuck, words};

use super::patience::Patience;
use super::{added, cover, save, trace};
use crate::cli::Prove;
use crate::failure::{Failure, raw};
use crate::files;
use crate::message::talk;
use crate::style;

/// Refuses the files of several charts, or two files in one place, before anything is searched.
pub(super) fn one_file(args: &Prove, paths: &[PathBuf]) -> Result<(), Failure> {
    let several = |option: &str| {
        Failure::Usage(say!(
            "{option} takes one chart, and there are {}: name the one you mean",
            paths.len(),
            option = raw(option)
        ))
    };
    for (option, file) in [("--save", &args.save), ("--tests", &args.tests)] {
        let Some(file) = file else { continue };
        if paths.len() > 1 {
            return Err(several(option));
        }
        if !paths.iter().any(|p| files::is_same(file, p)) {
            files::refuse_present(Some(file), args.force)?;
        }
    }
    match (&args.save, &args.tests) {
        (Some(a), Some(b)) if a == b => {
            Err(Failure::Usage(say!("--save and --tests name one file: each writes a file of its own")))
        }
        _ => Ok(()),
    }
}

/// Writes the file of the tests of refuted claims, if it is wanted.
pub(super) fn saved(args: &Prove, source: &Source, saved: &save::Saved) -> Result<(), Failure> {
    let Some(path) = &args.save else { return Ok(()) };
    if saved.tests.is_empty() {
        let none = saved.left.is_empty();
        let why = if none { "no claim is refuted" } else { "no test can state what is refuted" };
        talk!("nothing to save: {why}");
    } else {
        added::write(path, source, &saved.tests)?;
        wrote(path, &count(saved.tests.len(), "test of a refuted claim", "tests of refuted claims"));
    }
    for (claim, reason) in &saved.left {
        talk!("  not saved: {claim}: {reason}");
    }
    Ok(())
}

/// Writes the file of scenarios, if it is wanted.
pub(super) fn scenarios(
    args: &Prove,
    source: &Source,
    asked: &Asked,
    answers: &[Option<Verdict>],
    patience: &Patience,
) -> Result<(), Failure> {
    let Some(path) = &args.tests else { return Ok(()) };
    // The answers may have used up their time: the scenarios have as much again.
    let half = Nanos::new(args.time.count() / 2);
    let (first, whole) = (patience.within(half), patience.within(args.time));
    let bytes = args.memory.saturating_mul(1 << 20);
    let budget = |stop| Budget { states: args.states, scans: usize::MAX, bytes, stop };
    let known = cover::Known::of(asked, answers);
    let made = cover::cover(source, args.profile, &known, [&budget(&*first), &budget(&*whole)])?;
    if made.tests.is_empty() {
        talk!("no scenario was found");
    } else {
        added::write(path, source, &made.tests)?;
        wrote(path, &count(made.tests.len(), "scenario", "scenarios"));
    }
    for (sort, rows) in made.coverage.sorts() {
        let reached = rows.values().filter(|r| r.hits > 0).count();
        talk!("  {reached} of {} {sort} reached", rows.len());
    }
    for title in &made.unlike {
        talk!("  {title} was left out: `g7 test` shows another run than the search");
    }
    if let Some(open) = made.open {
        let ([why, ..], [help, ..]) = (words::why(&open.reason), words::way_on(&open.reason));
        talk!("  some run may reach more, or fewer scenarios do: {why}; {help}");
    }
    Ok(())
}

fn wrote(path: &std::path::Path, what: &str) {
    talk!("{}wrote{:#} {}: {what}", style::GOOD, style::GOOD, path.display());
}

fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// The error of assumptions that contradict each other: behind some run no input satisfies them, so
/// what would be proved there would mean nothing.
pub(super) fn contradiction(
    source: &Source,
    model: &Model<'_>,
    profile: Option<ProfileName>,
    answers: &[Option<Verdict>],
    budget: &Budget<'_>,
) -> Result<Option<String>, Failure> {
    if model.assume.is_empty() || !answers.iter().any(is_open) {
        return Ok(None);
    }
    let Some(run) = stuck(model, budget) else { return Ok(None) };
    let assumed = source.document.properties().find(|p| matches!(p.kind, PropertyKind::Assume(_)));
    let place = assumed.map_or_else(|| source.name.clone(), |p| source.place(p.at.0));
    let which = if model.assume.len() == 1 { "this assumption" } else { "the assumptions of this file" };
    let (style, mut text) = (style::BAD, String::new());
    match run.moves.len() {
        0 => text.push_str(&format!("{place}: {style}error{style:#}: no input satisfies {which}\n")),
        n => {
            let scans = count(n, "scan", "scans");
            text.push_str(&format!(
                "{place}: {style}error{style:#}: behind a run of {scans} no input satisfies {which}\n"
            ));
            if let Some(drawer) = trace::Drawer::new(source, profile)? {
                drawer.draw(&run.moves, "").lines().for_each(|line| text.push_str(&format!("  {line}\n")));
            }
        }
    }
    let it = if model.assume.len() == 1 { "it" } else { "them" };
    text.push_str(&format!(
        "  help: weaken {it}: where no input is left there are no runs, and every claim would hold\n"
    ));
    Ok(Some(text))
}
