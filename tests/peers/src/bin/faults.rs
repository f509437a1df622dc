//! `faults FILE`: the table of faults from the lines that the tests wrote.
#![allow(clippy::disallowed_methods, reason = "it reads the lines")]

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(file) = std::env::args_os().nth(1) else {
        eprintln!("faults: the file of the rows is missing");
        return ExitCode::from(2);
    };
    let told = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()));
    match told.and_then(|told| g7_peers::faults::table(&told)) {
        Ok(table) => {
            println!("{table}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}
