//! `g7 check`: prints every problem, with its place and a way to solve it.
//!
//! ```text
//! files -> problems -> fixed, with --fix -> report: text, JSON, SARIF, annotations -> again, with --watch
//! ```

mod annotations;
mod checked;
mod fixes;
mod log;
mod watch;

use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use g7_model::{Item, Place, Problem, Span, codes, say};
use serde_json::json;

use crate::cli::{Check, Fixing, Report};
use crate::failure::{Failure, Verdict, raw};
use crate::message::{done, talk, told};
use crate::progress::Progress;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::tongue::language;
use crate::{files, style};
use checked::Checked;
use watch::Looked;

pub(crate) fn check(args: &Check) -> Result<Verdict, Failure> {
    if args.fix.is_some() && args.paths.iter().any(|p| p == Path::new("-")) {
        return Err(Failure::Usage(say!("--fix changes files; the standard input is none")));
    }
    if !args.watch {
        return Ok(once(args, &files::all(&args.paths)?)?.verdict);
    }
    if args.format != Report::Text || args.paths.iter().any(|p| p == Path::new("-")) {
        return Err(Failure::Usage(say!("--watch looks at files, and tells people: no --format, no `-`")));
    }
    watch::for_ever(|| files::all(&args.paths), |paths| once(args, paths))
}

/// Checks these files.
fn once(args: &Check, paths: &[PathBuf]) -> Result<Looked, Failure> {
    let mut progress = Progress::new("checking", paths.len() as u64);
    let mut out = anstream::stdout().lock();
    let (mut tally, mut all, mut fixable) = (Tally::default(), Vec::new(), 0);
    let mut used = Vec::new();
    let mut known = HashSet::new();
    for path in paths {
        let mut checked = one(args, path)?;
        // A mistake of a file that several use is told once.
        let key = |source: &Source, p: &Problem| (source.place(p.at), p.code.id, p.what.to_string());
        checked.problems.retain(|p| !known.contains(&key(&checked.source, p)));
        known.extend(checked.problems.iter().map(|p| key(&checked.source, p)));
        tally.add(Tally::of(&checked.problems));
        used.extend(checked.source.files().skip(1).map(|(name, _)| PathBuf::from(name)));
        // A mistake of a used file is solved where that file is checked.
        let own = |p: &&Problem| p.at.file == checked.source.id() && p.fixes.iter().any(|f| f.sure);
        fixable += checked.problems.iter().filter(own).count();
        progress.step();
        match args.format {
            Report::Text => print(&mut out, &checked)?,
            Report::Json | Report::Sarif | Report::Github => all.push(checked),
        }
    }
    progress.end();
    match args.format {
        Report::Text => {}
        Report::Json => writeln!(out, "{:#}", object(&all, tally))?,
        Report::Sarif => writeln!(out, "{:#}", log::of(&all))?,
        Report::Github => write!(out, "{}", annotations::of(&all))?,
    }
    out.flush()?;
    if args.format == Report::Text {
        summary(paths.len(), tally, fixable);
    }
    let bad = tally.errors > 0 || (args.strict && tally.warnings > 0);
    Ok(Looked { verdict: if bad { Verdict::Found } else { Verdict::Fine }, used })
}

/// Reads a file, solves what is to be solved, and checks what is left.
fn one(args: &Check, path: &Path) -> Result<Checked, Failure> {
    let source = match sources::load(path, 0) {
        Err(Failure::Form { name, why }) => {
            let source = Source::plain(&name, Vec::new());
            let problems = vec![Problem::new(&codes::EXPECTED, Span::default(), why.clone())];
            return Ok(Checked { source, problems, unproved: Vec::new(), no_form: Some(why) });
        }
        read => read?,
    };
    let (source, problems) = problems(source, args)?;
    let (source, problems) = match args.fix {
        Some(fixing) if source.format.is_none() => {
            let likely = fixing == Fixing::Likely;
            let fixed = fixes::applied(source, problems, likely, |source| self::problems(source, args))?;
            if fixed.count > 0 {
                files::write(path, fixed.source.text.as_bytes())?;
                let of = raw(&fixed.source.name);
                let many = match fixed.count {
                    1 => say!("1 problem of {of}"),
                    n => say!("{n} problems of {of}"),
                };
                done(&say!("solved"), told(&many));
            }
            (fixed.source, fixed.problems)
        }
        _ => (source, problems),
    };
    let unproved = g7_rig::testing::unproved(&source);
    Ok(Checked { source, problems, unproved, no_form: None })
}

fn print(out: &mut dyn Write, checked: &Checked) -> Result<(), Failure> {
    if let Some(why) = &checked.no_form {
        writeln!(
            out,
            "{}{}[{}]:{:#} {}: {}",
            style::BAD,
            told(&say!("error")),
            codes::EXPECTED.id,
            style::BAD,
            checked.source.name,
            told(why)
        )?;
        return Ok(());
    }
    write!(
        out,
        "{}{}",
        report::text(&checked.source, &checked.problems),
        report::unproved(&checked.unproved)
    )?;
    Ok(())
}

fn object(all: &[Checked], tally: Tally) -> serde_json::Value {
    let problems: Vec<_> =
        all.iter().flat_map(|c| c.problems.iter().map(|p| report::json(&c.source, p))).collect();
    let unproved: Vec<_> = all.iter().map(|c| report::unproved_json(&c.unproved)).collect();
    let unproved: Vec<_> = unproved.iter().filter_map(|list| list.as_array()).flatten().collect();
    json!({
        "files": all.len(), "errors": tally.errors, "warnings": tally.warnings, "problems": problems,
        "not_proved": unproved,
    })
}

/// The parser's problems; if there is no syntax error, also those of charts, plants and tests.
fn problems(mut source: Source, args: &Check) -> Result<(Source, Vec<Problem>), Failure> {
    if let Some(target) = args.target {
        source.amend(|document| {
            document.items.retain(|i| !matches!(i, Item::Target(..)));
            document.items.push(Item::Target(target, Place::default()));
        });
    }
    let mut problems = g7_rig::testing::problems(&source, args.profile)?;
    if problems.is_empty() {
        problems.extend(g7_compile::empty(source.whole()));
    }
    Ok((source, problems))
}

fn summary(files: usize, tally: Tally, fixable: usize) {
    let files = if files == 1 { say!("1 file") } else { say!("{files} files") };
    let line = if tally == Tally::default() {
        let line = say!("{files}: no problems").in_language(language());
        format!("{}{line}{:#}", style::GOOD, style::GOOD)
    } else {
        let style = if tally.errors > 0 { style::BAD } else { style::WARN };
        let tally = raw(format!("{style}{tally}{style:#}"));
        let line = match fixable {
            0 => say!("{files}: {tally}; `g7 explain CODE` says more"),
            n => say!("{files}: {tally}; `g7 explain CODE` says more; `g7 check --fix` solves {n}"),
        };
        line.in_language(language())
    };
    talk!("{line}");
}
