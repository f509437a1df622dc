//! `g7 check`: prints every problem, with its place and a way to solve it.

use std::io::Write;

use g7_model::{Item, Place, Problem};
use serde_json::json;

use crate::cli::{Check, Format};
use crate::failure::{Failure, Verdict};
use crate::message::talk;
use crate::progress::Progress;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::{files, style};

pub(crate) fn check(args: &Check) -> Result<Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let mut progress = Progress::new("checking", paths.len() as u64);
    let mut out = anstream::stdout().lock();
    let (mut tally, mut listed, mut unproved) = (Tally::default(), Vec::new(), Vec::new());
    for path in &paths {
        let (source, problems) = problems(sources::load(path, 0)?, args)?;
        tally.add(Tally::of(&problems));
        let mut claims = g7_rig::testing::unproved(&source);
        match args.format {
            Format::Text => {
                write!(out, "{}{}", report::text(&source, &problems), report::unproved(&claims))?;
            }
            Format::Json => listed.extend(problems.iter().map(|p| report::json(&source, p))),
        }
        unproved.append(&mut claims);
        progress.step();
    }
    progress.end();
    if args.format == Format::Json {
        let all = json!({
            "files": paths.len(), "errors": tally.errors, "warnings": tally.warnings, "problems": listed,
            "not_proved": report::unproved_json(&unproved),
        });
        writeln!(out, "{all:#}")?;
    }
    out.flush()?;
    if args.format == Format::Text {
        summary(paths.len(), tally);
    }
    let bad = tally.errors > 0 || (args.strict && tally.warnings > 0);
    Ok(if bad { Verdict::Found } else { Verdict::Fine })
}

/// The parser's problems; if there is no syntax error, also those of charts, plants and tests.
fn problems(mut source: Source, args: &Check) -> Result<(Source, Vec<Problem>), Failure> {
    if let Some(target) = args.target {
        source.document.items.retain(|i| !matches!(i, Item::Target(..)));
        source.document.items.push(Item::Target(target, Place::default()));
    }
    let problems = g7_rig::testing::problems(&source, args.profile)?;
    Ok((source, problems))
}

fn summary(files: usize, tally: Tally) {
    let files = if files == 1 { "1 file".to_owned() } else { format!("{files} files") };
    if tally == Tally::default() {
        talk!("{}{files}: no problems{:#}", style::GOOD, style::GOOD);
    } else {
        let style = if tally.errors > 0 { style::BAD } else { style::WARN };
        talk!("{files}: {style}{tally}{style:#}; `g7 explain CODE` says more");
    }
}
