//! `tally FOLDER`: says what the logs (`*.log`) and the skips (`skips`) of a run of
//! `make test` come to. Each skip has a line; the last line counts all.
#![allow(clippy::disallowed_methods, reason = "it reads the logs")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use g7_peers::tally::Tally;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("tally: the folder of the logs is missing");
        return ExitCode::from(2);
    };
    match tally(Path::new(&folder)) {
        Ok(lines) => {
            println!("{lines}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("tally: {why}");
            ExitCode::FAILURE
        }
    }
}

fn tally(folder: &Path) -> Result<String, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut logs: Vec<PathBuf> =
        std::fs::read_dir(folder).map_err(failed)?.flatten().map(|e| e.path()).collect();
    logs.retain(|p| p.extension().is_some_and(|e| e == "log"));
    logs.sort();
    if logs.is_empty() {
        return Err(format!("{}: no logs", folder.display()));
    }
    let mut tally = Tally::default();
    for log in logs {
        let bytes = std::fs::read(&log).map_err(failed)?;
        let name = log.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        tally.add_log(&name, &String::from_utf8_lossy(&bytes))?;
    }
    // `make test` makes this file before the first test, so a missing one is a fault.
    let skips = std::fs::read_to_string(folder.join("skips")).map_err(failed)?;
    tally.add_skips(&skips);
    let lines: String =
        skips.lines().map(|l| format!("skipped: {}\n", l.replacen('\t', ", by ", 1))).collect();
    Ok(format!("{lines}{tally}"))
}
