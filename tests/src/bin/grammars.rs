//! `grammars`: writes the grammars of other editors anew, from the table of words.

use std::process::ExitCode;

use g7_tests::{grammars, house};

fn main() -> ExitCode {
    for (path, text) in grammars::all() {
        if let Err(e) = std::fs::write(house::root().join(path), text) {
            eprintln!("{path}: {e}");
            return ExitCode::FAILURE;
        }
        println!("{path}");
    }
    ExitCode::SUCCESS
}
