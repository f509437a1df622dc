//! `g7 test`: runs the tests of files, several files at a time, and prints the results in the order of the files.

mod output;
mod work;

pub(crate) use output::{defect_json, escape};

use std::io::Write;

use g7_model::say;
use g7_rig::testing::Coverage;

use crate::cli::Test;
use crate::failure::{Failure, Verdict};
use crate::form::Format;
use crate::message::talk;
use crate::progress::Progress;
use crate::tongue::language;
use crate::{files, report};
use output::Results;

pub(crate) fn test(args: &Test) -> Result<Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let from: Vec<_> = paths.iter().map(|p| p.as_path()).collect();
    files::refuse_foreign(args.junit.as_deref(), &from, args.force)?;
    if args.list {
        return list(args, &paths);
    }
    let mut progress = Progress::new("testing", paths.len() as u64);
    let mut results = Results::default();
    let mut out = anstream::stdout().lock();
    work::share(args, &paths, |done| {
        progress.step();
        progress.end();
        if let Some(told) = &done.told {
            talk!("{}", told.trim_end());
            results.broken.push((done.name.clone(), told.clone()));
        }
        if args.format == Format::Text {
            output::progress_lines(&mut out, &done.outcomes)?;
        }
        results.not_run += done.not_run;
        results.unproved.extend(done.unproved);
        results.outcomes.extend(done.outcomes);
        results.covered.push((done.name, done.coverage));
        Ok(())
    })?;
    if args.coverage {
        results.covered = Coverage::by_file(&results.covered);
    }
    if let Some(path) = &args.junit {
        files::write(path, output::junit(&results).as_bytes())?;
    }
    match args.format {
        Format::Json => output::json(&mut out, &results, args.coverage)?,
        Format::Text => {
            output::failures(&mut out, &results.outcomes)?;
            if args.coverage {
                output::coverage(&mut out, &results.covered)?;
            }
            write!(out, "{}", report::unproved(&results.unproved))?;
            output::summary(&mut out, &results)?;
        }
    }
    out.flush()?;
    let none = results.outcomes.is_empty() && results.broken.is_empty();
    if none {
        talk!("{}", nothing(args));
    }
    let failed = results.outcomes.iter().any(|o| o.defect.is_some());
    Ok(if none || failed || !results.broken.is_empty() { Verdict::Found } else { Verdict::Fine })
}

fn nothing(args: &Test) -> String {
    let what = if args.filter.is_some() {
        say!("no test has that in its title")
    } else {
        say!("there are no tests")
    };
    what.in_language(language())
}

/// Lists the tests without running them.
fn list(args: &Test, paths: &[std::path::PathBuf]) -> Result<Verdict, Failure> {
    let mut out = anstream::stdout().lock();
    let (mut rows, mut broken) = (Vec::new(), false);
    for path in paths {
        let source = crate::sources::load(path, 0)?;
        if source.has_errors() {
            talk!("{}", report::text(&source, &source.problems).trim_end());
            broken = true;
        }
        let wanted = |title: &str| args.filter.as_ref().is_none_or(|f| title.contains(f.as_str()));
        for test in source.tests().filter(|t| wanted(&t.title)) {
            rows.push((source.name.clone(), test.title.to_string(), source.place(test.at.0)));
        }
    }
    match args.format {
        Format::Text => rows.iter().try_for_each(|(file, title, _)| writeln!(out, "{file}: {title}"))?,
        Format::Json => {
            let row = |(file, title, place): &(String, String, String)| serde_json::json!({ "file": file, "title": title, "place": place });
            let rows: Vec<_> = rows.iter().map(row).collect();
            writeln!(out, "{:#}", serde_json::json!({ "tests": rows }))?;
        }
    }
    out.flush()?;
    if rows.is_empty() && !broken {
        talk!("{}", nothing(args));
    }
    Ok(if rows.is_empty() || broken { Verdict::Found } else { Verdict::Fine })
}
