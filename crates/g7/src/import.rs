//! `g7 import`: a file of another tool becomes a .g7 file.

use std::io::Write;

use crate::cli::Import;
use crate::failure::{Failure, Verdict};
use crate::report::{self, Tally};
use crate::sources;
use crate::{files, style, talk};

pub(crate) fn import(args: &Import) -> Result<Verdict, Failure> {
    let source = sources::load(&args.file, 0)?;
    if source.format.is_none() {
        return Err(Failure::Usage(format!("{} is no file of another tool that is known here", source.name)));
    }
    if let Some(output) = args.output.as_ref().filter(|o| o.is_file() && !args.force) {
        return Err(Failure::Usage(format!("{} is there already; --force replaces it", output.display())));
    }
    if !source.problems.is_empty() {
        talk!("{}", report::text(&source, &source.problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(&source.problems));
    }
    if source.has_errors() {
        return Ok(Verdict::Found);
    }
    let mut document = source.document.clone();
    g7_draw::make_room(&mut document);
    let text = g7_syntax::print(&document, None);
    match &args.output {
        Some(path) => {
            files::write(path, text.as_bytes())?;
            talk!("{}wrote{:#} {}", style::GOOD, style::GOOD, path.display());
        }
        None => {
            let mut out = anstream::stdout().lock();
            write!(out, "{text}")?;
            out.flush()?;
        }
    }
    Ok(Verdict::Fine)
}
