//! `g7 explain`: prints the page on a problem, in the language that is asked for.

use std::io::Write;

use g7_model::{codes, say};

use crate::cli::Explain;
use crate::failure::{Failure, Verdict};
use crate::{style, tongue};

pub(crate) fn explain(args: &Explain) -> Result<Verdict, Failure> {
    let mut out = anstream::stdout().lock();
    let language = tongue::language();
    let Some(id) = &args.code else {
        for code in codes::ALL {
            let (sort, title) = (code.severity.name(), code.title_in(language));
            writeln!(out, "{}{}{:#}  {sort:<7}  {title}", style::STRONG, code.id, style::STRONG)?;
        }
        return Ok(out.flush().map(|()| Verdict::Fine)?);
    };
    let Some(text) = g7_page::explain(id, language) else {
        return Err(Failure::Usage(say!("there is no problem `{id}`; `g7 explain` lists them all")));
    };
    write!(out, "{text}")?;
    Ok(out.flush().map(|()| Verdict::Fine)?)
}
