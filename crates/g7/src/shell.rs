//! `g7 completions` and `g7 man`.

use std::fs;
use std::io::{self, Write};

use clap::CommandFactory;

use crate::cli::{Cli, Completions, Man};
use crate::failure::{Failure, Verdict};
use crate::files;
use crate::message::wrote;

pub(crate) fn completions(args: &Completions) -> Result<Verdict, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "g7", &mut text);
    let mut out = io::stdout().lock();
    out.write_all(&text)?;
    Ok(out.flush().map(|()| Verdict::Fine)?)
}

pub(crate) fn man(args: &Man) -> Result<Verdict, Failure> {
    let mut command = Cli::command();
    command.build();
    let Some(folder) = &args.out else {
        let mut text = Vec::new();
        clap_mangen::Man::new(command).render(&mut text)?;
        let mut out = io::stdout().lock();
        out.write_all(&text)?;
        return Ok(out.flush().map(|()| Verdict::Fine)?);
    };
    fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.clone(), e))?;
    let pages = std::iter::once(("g7".to_owned(), command.clone()))
        .chain(command.get_subcommands().map(|c| (format!("g7-{}", c.get_name()), c.clone())));
    for (name, page) in pages {
        let mut text = Vec::new();
        clap_mangen::Man::new(page).render(&mut text)?;
        files::write(&folder.join(format!("{name}.1")), &text)?;
        wrote(folder.join(format!("{name}.1")).display());
    }
    Ok(Verdict::Fine)
}
