//! `g7 prove`: asks every question of charts, and prints each answer with what shows it.
//! `g7 compare`: two charts, or one under two profiles, beside each other.

mod added;
mod apart;
mod cover;
mod file;
mod found;
mod graph;
mod guilt;
mod junit;
mod made;
mod output;
mod patience;
mod process;
mod sarif;
mod save;
mod shard;
mod trace;
mod workers;

use std::path::Path;

use g7_dossier::{Answer, Known, Missing};
use g7_model::{Language, Nanos, Said, say};
use g7_verify::Verdict;

pub(crate) use apart::{compare, read_back};
pub(crate) use graph::{Graph, graph};
pub(crate) use shard::{Part, part};

use file::Work;
use found::Found;
use patience::{Patience, Phase, Progress, Share};

use crate::cli::{Answers, Prove};
use crate::failure::{self, Failure};
use crate::files;
use crate::message::talk;

pub(crate) fn prove(args: &Prove) -> Result<failure::Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    made::one_file(args, &paths)?;
    let from: Vec<_> = paths.iter().map(|p| p.as_path()).collect();
    files::refuse_foreign(args.junit.as_deref(), &from, args.force)?;
    process::refuse(args, &paths)?;
    let patience = Patience::new()?;
    let shared = &args.shared;
    if process::is_shared(shared) && shared.process.is_none() {
        return workers::run(args, &*patience.pressed());
    }
    if shared.child {
        patience.until_input_ends()?;
    }
    // The time that a file leaves over is for those behind it.
    let time = patience.share(args.time);
    let mut all = Vec::new();
    for (number, path) in paths.iter().enumerate() {
        let share = patience.share(time.part(paths.len() - number));
        let found = one(path, number, args, &patience, [&time, &share])?;
        if shared.is_silent() {
            // Process 0 has all answers and problems, and prints them.
            return Ok(failure::Verdict::Fine);
        }
        if !found.trouble.is_empty() {
            talk!("{}", found.trouble.trim_end());
        }
        match args.answers() {
            _ if shared.shard.is_some() => output::lines(&found)?,
            Answers::Text => output::text(&found, args.all)?,
            Answers::Json | Answers::Sarif => {}
        }
        all.push(found);
    }
    let is_open = |f: &Found| {
        let open = f.answers.iter().any(|a| matches!(a.verdict, Verdict::Open(_)));
        open || f.hidden() > 0 || f.unasked.is_some()
    };
    let open = all.iter().any(is_open);
    match args.answers() {
        _ if shared.shard.is_some() => {}
        Answers::Text => {
            let stopped = all.iter().any(|f| f.is_stopped).then(|| patience.reason(&time));
            output::summary(&all, stopped.as_ref())?;
        }
        Answers::Json => output::json(&all)?,
        Answers::Sarif => sarif::print(&all, args.all)?,
    }
    if let Some(path) = &args.junit {
        files::write(path, junit::junit(&all).as_bytes())?;
    }
    let wrong =
        |f: &Found| f.tally.errors > 0 || f.answers.iter().any(|a| matches!(a.verdict, Verdict::Refuted(_)));
    Ok(match (all.iter().any(wrong), open) {
        (true, _) => failure::Verdict::Found,
        (false, true) => failure::Verdict::Open,
        (false, false) => failure::Verdict::Fine,
    })
}

/// A sentence with another one behind it, if there is one.
fn joined(first: &Said, then: &Said) -> Said {
    let both = |language| [first, then].map(|s| s.in_language(language)).join("; ");
    if then.is_empty() { first.clone() } else { Said::in_each(Language::ALL.map(both)) }
}

/// The answers to all questions of a file, for a dossier.
pub(crate) fn answers(path: &Path, time: Nanos) -> Result<Known<Answer>, Failure> {
    let args = Prove::of(path, time);
    let patience = Patience::new()?;
    let time = patience.share(args.time);
    let found = one(path, 0, &args, &patience, [&time, &time])?;
    if let Some(why) = found.unasked {
        return Ok(Known::Missing(Missing::Because(why)));
    }
    if found.tally.errors > 0 {
        return Ok(Known::Missing(Missing::Errors));
    }
    let told = |a: found::Answered| Answer {
        place: a.place,
        claim: a.claim,
        own: a.own,
        verdict: match a.verdict {
            Verdict::Proved(_) => g7_dossier::Verdict::Proved,
            Verdict::Refuted(_) => g7_dossier::Verdict::Refuted,
            Verdict::Open(_) => g7_dossier::Verdict::Open,
        },
        reason: joined(&a.reason, &a.guilt),
        help: a.help,
    };
    Ok(Known::Here(found.answers.into_iter().map(told).collect()))
}

/// Asks a file, with its number in the list, all of its questions. `whole` is the time of all files, `time`
/// the part of this one.
fn one(
    path: &Path,
    number: usize,
    args: &Prove,
    patience: &Patience,
    [whole, time]: [&Share; 2],
) -> Result<Found, Failure> {
    let stop = time.stop();
    let unasked = |when: Said| {
        let unasked = Some(say!("{} {when}", patience.reason(whole)));
        Found { name: path.display().to_string(), unasked, is_stopped: true, ..Found::default() }
    };
    if stop() {
        return Ok(unasked(say!("before this file was read")));
    }
    let progress = Progress::default();
    let work = Work {
        args: args.clone(),
        number,
        patience: patience.clone(),
        time: time.clone(),
        progress: progress.clone(),
    };
    let (owned, seen) = (path.to_owned(), progress.clone());
    Ok(match Patience::wait(&stop, &progress, move || work.prove(&owned))? {
        Ok(found) => found?,
        Err(Phase::Read) => unasked(say!("while the file was read")),
        Err(Phase::Compile) => unasked(say!("while the chart and its questions were compiled")),
        Err(Phase::Search | Phase::Tell) => {
            unasked(say!("before one of {} questions was decided", seen.questions()))
        }
    })
}
