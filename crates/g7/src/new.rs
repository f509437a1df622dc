//! `g7 new`: creates a folder with a first chart, or with an exercise.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use g7_model::say;

use crate::cli::New;
use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::tell;

/// The files of a new folder: their paths in it, and their texts.
type Texts = &'static [(&'static str, &'static str)];

const CHART: Texts =
    &[("chart.g7", include_str!("new/chart.g7")), ("README.md", include_str!("new/README.md"))];

/// The word that asks for an exercise in the place of a chart.
const EXERCISE: &str = "exercise";

const PARTS: Texts = &[
    ("README.md", include_str!("new/exercise/README.md")),
    ("statement.md", include_str!("new/exercise/statement.md")),
    ("statement.fr.md", include_str!("new/exercise/statement.fr.md")),
    ("statement.pt.md", include_str!("new/exercise/statement.pt.md")),
    ("hints.md", include_str!("new/exercise/hints.md")),
    ("hints.fr.md", include_str!("new/exercise/hints.fr.md")),
    ("hints.pt.md", include_str!("new/exercise/hints.pt.md")),
    ("template.g7", include_str!("new/exercise/template.g7")),
    ("model.g7", include_str!("new/exercise/model.g7")),
    ("wrong/level.g7", include_str!("new/exercise/wrong/level.g7")),
    ("wrong/stays-on.g7", include_str!("new/exercise/wrong/stays-on.g7")),
    ("wrong/two-pushes.g7", include_str!("new/exercise/wrong/two-pushes.g7")),
];

pub(crate) fn new(args: &New) -> Result<Verdict, Failure> {
    let is_exercise = args.folder == Path::new(EXERCISE);
    let folder = match &args.exercise {
        Some(folder) if is_exercise => folder.as_path(),
        Some(_) => {
            let what = say!("one folder at a time; only `g7 new exercise` has a folder behind it");
            return Err(Failure::Usage(what));
        }
        None => args.folder.as_path(),
    };
    let texts = if is_exercise { PARTS } else { CHART };
    make(folder, texts)?;
    let shown = folder.display();
    let mut out = io::stdout().lock();
    for (name, _) in texts {
        writeln!(out, "{shown}/{name}")?;
    }
    out.flush()?;
    tell(if is_exercise {
        say!("made {}; now try `g7 grade {shown}`", raw(&shown))
    } else {
        say!("made {}; now try `g7 run {shown}` and `g7 test {shown}`", raw(&shown))
    });
    Ok(Verdict::Fine)
}

/// Makes a folder with files; of a folder that cannot be filled nothing is left.
fn make(folder: &Path, texts: Texts) -> Result<(), Failure> {
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
    let mut filled: Vec<PathBuf> = Vec::new();
    let result = texts.iter().try_for_each(|(name, text)| {
        let path = folder.join(name);
        let within = path.parent().unwrap_or(folder);
        fs::create_dir_all(within).map_err(|e| Failure::Write(within.to_path_buf(), e))?;
        files::write(&path, text.as_bytes())?;
        filled.push(path);
        Ok(())
    });
    if result.is_err() {
        for path in &filled {
            fs::remove_file(path).ok();
            path.parent().filter(|within| *within != folder).map(fs::remove_dir);
        }
        if made {
            fs::remove_dir(folder).ok();
        }
    }
    result
}
