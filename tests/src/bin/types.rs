//! `types`: writes the messages of the page as TypeScript, from the table of `g7-page`.

use std::process::ExitCode;

use g7_tests::{house, types};

fn main() -> ExitCode {
    match std::fs::write(house::root().join(types::PATH), types::text()) {
        Ok(()) => {
            println!("{}", types::PATH);
            ExitCode::SUCCESS
        }
        Err(e) => {
            eprintln!("{}: {e}", types::PATH);
            ExitCode::FAILURE
        }
    }
}
