//! `g7 new`: creates a folder with a first chart.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use g7_model::say;

use crate::cli::New;
use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::tell;

const CHART: &str = include_str!("new/chart.g7");
const README: &str = include_str!("new/README.md");

pub(crate) fn new(args: &New) -> Result<Verdict, Failure> {
    let folder = args.folder.as_path();
    match fs::read_dir(folder) {
        Ok(mut entries) => {
            if entries.next().is_some() {
                return Err(Failure::Usage(say!(
                    "{} is not empty; nothing was changed",
                    raw(folder.display())
                )));
            }
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => {}
        Err(e) => return Err(Failure::Write(folder.to_path_buf(), e)),
    }
    let made = !folder.exists();
    fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_path_buf(), e))?;
    if let Err(failure) = fill(folder) {
        for name in ["chart.g7", "README.md"] {
            fs::remove_file(folder.join(name)).ok();
        }
        if made {
            fs::remove_dir(folder).ok();
        }
        return Err(failure);
    }
    let shown = folder.display();
    let mut out = io::stdout().lock();
    writeln!(out, "{shown}/chart.g7\n{shown}/README.md")?;
    out.flush()?;
    tell(say!("made {}; now try `g7 run {shown}` and `g7 test {shown}`", raw(&shown)));
    Ok(Verdict::Fine)
}

fn fill(folder: &Path) -> Result<(), Failure> {
    files::write(&folder.join("chart.g7"), CHART.as_bytes())?;
    files::write(&folder.join("README.md"), README.as_bytes())
}
