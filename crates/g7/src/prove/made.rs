//! Things that `g7 prove` makes beside its answers: files of tests, and the error of assumptions that
//! contradict each other.

use std::path::PathBuf;

use g7_model::{Nanos, ProfileName, PropertyKind, Said, say};
use g7_rig::Source;
use g7_verify::{Asked, Budget, Model, Verdict, is_open, stuck, words};

use super::patience::Patience;
use super::{added, cover, save, trace};
use crate::cli::Prove;
use crate::failure::{Failure, raw};
use crate::files;
use crate::message::{talk, tell, told};
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
        tell(if none {
            say!("nothing to save: no claim is refuted")
        } else {
            say!("nothing to save: no test can state what is refuted")
        });
    } else {
        added::write(path, source, &saved.tests)?;
        wrote(
            path,
            &match saved.tests.len() {
                1 => say!("1 test of a refuted claim"),
                n => say!("{n} tests of refuted claims"),
            },
        );
    }
    for (claim, reason) in &saved.left {
        talk!("  {}", told(&say!("not saved: {claim}: {reason}")));
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
        tell(say!("no scenario was found"));
    } else {
        added::write(path, source, &made.tests)?;
        wrote(
            path,
            &match made.tests.len() {
                1 => say!("1 scenario"),
                n => say!("{n} scenarios"),
            },
        );
    }
    for (sort, rows) in made.coverage.sorts() {
        let reached = rows.values().filter(|r| r.hits > 0).count();
        talk!("  {}", told(&say!("{reached} of {} {} reached", rows.len(), sort.plural())));
    }
    for title in &made.unlike {
        talk!(
            "  {}",
            told(&say!("{} was left out: `g7 test` shows another run than the search", raw(title)))
        );
    }
    if let Some(open) = made.open {
        let why = Said::in_each(words::why(&open.reason));
        let help = Said::in_each(words::way_on(&open.reason));
        talk!("  {}", told(&say!("some run may reach more, or fewer scenarios do: {why}; {help}")));
    }
    Ok(())
}

fn wrote(path: &std::path::Path, what: &Said) {
    crate::message::wrote(format!("{}: {}", path.display(), told(what)));
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
    let one = model.assume.len() == 1;
    let which = if one { say!("this assumption") } else { say!("the assumptions of this file") };
    let what = match run.moves.len() {
        0 => say!("no input satisfies {which}"),
        1 => say!("behind a run of 1 scan no input satisfies {which}"),
        n => say!("behind a run of {n} scans no input satisfies {which}"),
    };
    let (style, error) = (style::BAD, told(&say!("error")));
    let mut text = format!("{place}: {style}{error}{style:#}: {}\n", told(&what));
    match run.moves.len() {
        0 => {}
        _ => {
            if let Some(drawer) = trace::Drawer::new(source, profile)? {
                drawer.draw(&run.moves, "").lines().for_each(|line| text.push_str(&format!("  {line}\n")));
            }
        }
    }
    let help = if one {
        say!("weaken it: where no input is left there are no runs, and every claim would hold")
    } else {
        say!("weaken them: where no input is left there are no runs, and every claim would hold")
    };
    text.push_str(&format!("  {}\n", told(&say!("help: {}", help))));
    Ok(Some(text))
}
