//! `g7 import`: converts a file of another tool to a .g7 file.

use g7_model::say;

use crate::cli::Import;
use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::talk;
use crate::prove;
use crate::report::{self, Tally};
use crate::sources;

pub(crate) fn import(args: &Import) -> Result<Verdict, Failure> {
    let source = sources::load(&args.file, 0)?;
    if source.format.is_none() {
        return Err(Failure::Usage(say!(
            "{} is not a file of another tool that g7 can read",
            raw(&source.name)
        )));
    }
    files::refuse_source(args.output.as_deref(), &[&args.file])?;
    files::refuse_present(args.output.as_deref(), args.force)?;
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
    files::deliver(args.output.as_deref(), text.as_bytes())?;
    match &args.output {
        Some(path) if args.compare => prove::read_back(source, sources::load(path, 0)?),
        _ => Ok(Verdict::Fine),
    }
}
