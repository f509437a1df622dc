//! The compilers and the programs that they make.

use std::process::Command;

/// Runs a command to its end; returns what it prints.
///
/// # Errors
///
/// The reason why it did not start, or what it says of its failure.
pub fn run(command: &mut Command) -> Result<String, String> {
    let out = command.output().map_err(|e| format!("{}: {e}", command.get_program().display()))?;
    if out.status.success() {
        return Ok(String::from_utf8_lossy(&out.stdout).into_owned());
    }
    Err(format!("{} failed:\n{}", command.get_program().display(), String::from_utf8_lossy(&out.stderr)))
}
