//! `g7 explain`: the page of a problem.

use std::io::Write;

use g7_model::{Severity, codes};

use crate::cli::Explain;
use crate::failure::{Failure, Verdict};
use crate::style;

/// Pages of the book by problem, in the order of their numbers.
static PAGES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

pub(crate) fn explain(args: &Explain) -> Result<Verdict, Failure> {
    let mut out = anstream::stdout().lock();
    let Some(id) = &args.code else {
        for code in codes::ALL {
            let sort = match code.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            };
            writeln!(out, "{}{}{:#}  {sort:<7}  {}", style::STRONG, code.id, style::STRONG, code.title)?;
        }
        return Ok(out.flush().map(|()| Verdict::Fine)?);
    };
    let Some(code) = codes::find(id) else {
        return Err(Failure::Usage(format!("there is no problem `{id}`; `g7 explain` lists them all")));
    };
    match PAGES.iter().find(|(page, _)| *page == code.id) {
        Some((_, text)) => write!(out, "{}", text.trim_end())?,
        None => write!(out, "# {}: {}", code.id, code.title)?,
    }
    writeln!(out, "\n\nSource: {}", code.source)?;
    Ok(out.flush().map(|()| Verdict::Fine)?)
}
