//! IronPLC: `ironplcc` on the `PATH`, which checks text of IEC 61131-3.

use std::path::Path;
use std::process::Command;

use crate::{quiet, skip};

/// The compiler.
#[derive(Clone, Copy, Debug)]
pub struct IronPlc(());

/// IronPLC, if it is there; otherwise the skip is counted.
pub fn find() -> Option<IronPlc> {
    let found =
        quiet(Command::new("ironplcc").arg("version")) || quiet(Command::new("ironplcc").arg("--version"));
    if !found {
        skip("ironplcc missing");
    }
    found.then_some(IronPlc(()))
}

impl IronPlc {
    /// Has a text checked: its syntax, names and types.
    ///
    /// # Errors
    ///
    /// The complaint, with the line of the text.
    pub fn checks(self, file: &Path) -> Result<(), String> {
        let mut command = Command::new("timeout");
        command.arg("30").args(["ironplcc", "check"]).arg(file).env("NO_COLOR", "1");
        let out = command.output().map_err(|e| e.to_string())?;
        if out.status.success() {
            return Ok(());
        }
        let said = [&*out.stdout, &*out.stderr].concat();
        Err(complaint(&String::from_utf8_lossy(&said)))
    }
}

/// The first error, and what was found at its place, without the colours of a terminal.
fn complaint(said: &str) -> String {
    let mut plain = String::new();
    let mut letters = said.chars();
    while let Some(c) = letters.next() {
        if c == '\u{1b}' {
            letters.find(|c| *c == 'm');
        } else {
            plain.push(c);
        }
    }
    let error = plain.lines().find(|line| line.contains("error[")).unwrap_or("it says nothing");
    // The names of one text stand in brackets.
    let error = error.split(" (").next().unwrap_or(error).trim();
    let found = plain.split_once("Found text ").and_then(|(_, rest)| rest.split(" that matched").next());
    found.map_or_else(|| error.to_owned(), |found| format!("{error}: {found}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complaint_has_the_error_and_what_was_found() {
        let syntax = "\u{1b}[0m\u{1b}[1merror[P0002]\u{1b}[0m: Syntax error\n  |  ^ Expected ';'. Found text 'END_STEP' that \
                      matched token 'END_STEP'\n";
        assert_eq!(complaint(syntax), "error[P0002]: Syntax error: 'END_STEP'");
        let name = "error[P4007]: Variable not defined before used (variable=S1)\n";
        assert_eq!(complaint(name), "error[P4007]: Variable not defined before used");
    }
}
