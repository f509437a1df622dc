//! `g7 test`: runs the tests of files and prints the results.

mod output;

pub(crate) use output::escape;

use std::io::Write;

use g7_host::WallClock;
use g7_rig::testing::{self, Coverage, Options};

use crate::cli::{Format, Test};
use crate::failure::{Failure, Verdict};
use crate::files;
use crate::message::talk;
use crate::progress::Progress;
use crate::report::{self, Tally};
use crate::sources;

pub(crate) fn test(args: &Test) -> Result<Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let options = Options { profile: args.profile, scan: args.scan, filter: args.filter.as_deref() };
    let mut progress = Progress::new("testing", 0);
    let (mut outcomes, mut covered, mut tally) = (Vec::new(), Vec::new(), Tally::default());
    let mut unproved = Vec::new();
    let mut out = anstream::stdout().lock();
    for path in &paths {
        let source = sources::load(path, 0)?;
        let mut coverage = Coverage::default();
        progress.more(source.tests().count() as u64);
        let mut clock = WallClock::default();
        let mut step = || progress.step();
        let (mut done, problems) = testing::file(&source, options, &mut coverage, &mut clock, &mut step)?;
        progress.end();
        let found = Tally::of(&problems);
        if found.errors > 0 {
            talk!("{}", report::text(&source, &problems).trim_end());
        }
        tally.add(found);
        if args.format == Format::Text {
            output::progress_lines(&mut out, &done)?;
        }
        unproved.append(&mut testing::unproved(&source));
        outcomes.append(&mut done);
        covered.push((source.name.clone(), coverage));
    }
    if let Some(path) = &args.junit {
        files::write(path, output::junit(&outcomes).as_bytes())?;
    }
    match args.format {
        Format::Json => {
            let covered = args.coverage.then_some(covered.as_slice());
            output::json(&mut out, &outcomes, covered, &unproved)?;
        }
        Format::Text => {
            output::failures(&mut out, &outcomes)?;
            if args.coverage {
                output::coverage(&mut out, &covered)?;
            }
            write!(out, "{}", report::unproved(&unproved))?;
            output::summary(&mut out, &outcomes, unproved.len())?;
        }
    }
    out.flush()?;
    if outcomes.is_empty() && tally.errors == 0 {
        talk!(
            "{}",
            if args.filter.is_some() { "no test has that in its title" } else { "there are no tests" }
        );
    }
    let failed = tally.errors > 0 || outcomes.iter().any(|o| o.defect.is_some());
    Ok(if failed { Verdict::Found } else { Verdict::Fine })
}
