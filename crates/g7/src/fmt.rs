//! `g7 fmt`: formats files.

use std::io::Write;
use std::path::Path;

use g7_model::say;

use crate::cli::Fmt;
use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::{done, talk, tell};
use crate::report::{self, Tally};
use crate::sources;

pub(crate) fn fmt(args: &Fmt) -> Result<Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let (mut changed, mut refused) = (0, 0);
    let mut out = anstream::stdout().lock();
    for path in &paths {
        let source = sources::load(path, 0)?;
        if source.format.is_some() {
            return Err(Failure::Usage(say!(
                "{} is a file of another tool; `g7 import` makes a .g7 file of it",
                raw(&source.name)
            )));
        }
        if source.has_errors() {
            talk!("{}", report::text(&source, &source.problems).trim_end());
            tell(say!("{}: left as it is: {}", raw(&source.name), raw(Tally::of(&source.problems))));
            refused += 1;
            continue;
        }
        let text = g7_syntax::print(&source.document, Some(&source.text));
        let same = text.as_bytes() == source.bytes;
        if !same {
            changed += 1;
        }
        if args.diff && !same {
            write!(out, "{}", diff(&source.name, &source.text, &text))?;
        }
        match (args.check || args.diff, path == Path::new("-")) {
            (true, _) if same || args.diff => {}
            (true, _) => writeln!(out, "{}", source.name)?,
            (false, true) => write!(out, "{text}")?,
            (false, false) if same => {}
            (false, false) => {
                files::write(path, text.as_bytes())?;
                done(&say!("formatted"), &source.name);
            }
        }
    }
    out.flush()?;
    if (args.check || args.diff) && changed > 0 {
        tell(say!("{changed} of {} files would change", paths.len()));
    }
    Ok(if refused > 0 || (args.check && changed > 0) { Verdict::Found } else { Verdict::Fine })
}

/// The change of a file as `diff -u` has it.
fn diff(name: &str, before: &str, after: &str) -> String {
    let name = name.strip_prefix("./").unwrap_or(name);
    let lines = similar::TextDiff::from_lines(before, after);
    lines.unified_diff().header(&format!("a/{name}"), &format!("b/{name}")).to_string()
}
