//! `g7 explain`: prints the page on a problem.

use std::io::Write;

use g7_model::codes;

use crate::cli::Explain;
use crate::failure::{Failure, Verdict};
use crate::style;

pub(crate) fn explain(args: &Explain) -> Result<Verdict, Failure> {
    let mut out = anstream::stdout().lock();
    let Some(id) = &args.code else {
        for code in codes::ALL {
            let sort = code.severity.name();
            writeln!(out, "{}{}{:#}  {sort:<7}  {}", style::STRONG, code.id, style::STRONG, code.title)?;
        }
        return Ok(out.flush().map(|()| Verdict::Fine)?);
    };
    let Some(text) = g7_page::explain(id) else {
        return Err(Failure::Usage(format!("there is no problem `{id}`; `g7 explain` lists them all")));
    };
    write!(out, "{text}")?;
    Ok(out.flush().map(|()| Verdict::Fine)?)
}
