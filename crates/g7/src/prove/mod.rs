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
mod sarif;
mod save;
mod trace;

use std::path::Path;

use g7_verify::Verdict;

pub(crate) use apart::{compare, read_back};
pub(crate) use graph::{Graph, graph};

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
    let patience = Patience::new()?;
    // The time that a file leaves over is for those behind it.
    let time = patience.share(args.time);
    let mut all = Vec::new();
    for (path, files) in paths.iter().zip((1..=paths.len()).rev()) {
        let found = one(path, args, &patience, patience.share(time.part(files)))?;
        if !found.trouble.is_empty() {
            talk!("{}", found.trouble.trim_end());
        }
        if args.format == Answers::Text {
            output::text(&found, args.all)?;
        }
        all.push(found);
    }
    let is_open = |f: &Found| {
        let open = f.answers.iter().any(|a| matches!(a.verdict, Verdict::Open(_)));
        open || f.hidden() > 0 || f.unasked.is_some()
    };
    let open = all.iter().any(is_open);
    match args.format {
        Answers::Text => {
            let stopped = all.iter().any(|f| f.is_stopped).then(|| patience.reason(args.time));
            output::summary(&all, stopped.as_deref())?;
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

/// Asks a file all of its questions, as far as the time goes.
fn one(path: &Path, args: &Prove, patience: &Patience, time: Share) -> Result<Found, Failure> {
    let stop = time.stop();
    let unasked = |why: &str| {
        let unasked = Some(format!("{} {why}", patience.reason(args.time)));
        Found { name: path.display().to_string(), unasked, is_stopped: true, ..Found::default() }
    };
    if stop() {
        return Ok(unasked("before this file was read"));
    }
    let progress = Progress::default();
    let work = Work { args: args.clone(), patience: patience.clone(), time, progress: progress.clone() };
    let (owned, seen) = (path.to_owned(), progress.clone());
    Ok(match Patience::wait(&stop, &progress, move || work.prove(&owned))? {
        Ok(found) => found?,
        Err(Phase::Read) => unasked("while the file was read"),
        Err(Phase::Compile) => unasked("while the chart and its questions were compiled"),
        Err(Phase::Search | Phase::Tell) => {
            unasked(&format!("before one of {} questions was decided", seen.questions()))
        }
    })
}
