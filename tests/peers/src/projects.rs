//! Readers of PLCopen XML that other people wrote: the generators of Beremiz and of OpenPLC.
//!
//! `G7_BEREMIZ` and `G7_XML2ST` name the folders of their checkouts. Each file is opened by a process
//! of its own (`python/plcopen_to_st.py`), which is ended after half a minute.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{python, script, skip};

/// For each program its name and the variable with its folder.
pub const READERS: [(&str, &str); 2] = [("Beremiz", "G7_BEREMIZ"), ("OpenPLC", "G7_XML2ST")];

/// A program that opens projects.
#[derive(Clone, Debug)]
pub struct Projects {
    /// The name of the program.
    pub name: &'static str,
    python: PathBuf,
    folder: PathBuf,
}

/// The programs that are installed. A skip is counted for each one that is missing.
pub fn readers() -> Vec<Projects> {
    let all = READERS.into_iter().filter_map(|(name, variable)| {
        let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
            skip(&format!("{name} missing"));
            return None;
        };
        Some(Projects { name, python: python("lxml")?, folder })
    });
    all.collect()
}

impl Projects {
    /// The text that the program makes of a project, or the last line of its complaint.
    ///
    /// # Errors
    ///
    /// The complaint of the program where it refuses the project.
    pub fn text(&self, project: &Path) -> Result<String, String> {
        let mut command = Command::new(&self.python);
        command.arg(script("plcopen_to_st.py")).arg(&self.folder).arg(project);
        let out = output(&command)?;
        Ok(String::from_utf8_lossy(&out).into_owned())
    }
}

/// Runs a command for half a minute at most and returns what it prints.
///
/// # Errors
///
/// The last line that it says, if it fails.
pub fn output(command: &Command) -> Result<Vec<u8>, String> {
    let mut limited = Command::new("timeout");
    limited.arg("30").arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        limited.env(name, value.unwrap_or(OsStr::new("")));
    }
    if let Some(folder) = command.get_current_dir() {
        limited.current_dir(folder);
    }
    let out = limited.output().map_err(|e| e.to_string())?;
    if out.status.success() {
        return Ok(out.stdout);
    }
    let said = [&*out.stdout, &*out.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let first = said.lines().find(|l| l.contains("error") || l.contains("refused"));
    Err(first.or(said.lines().last()).unwrap_or("it says nothing").to_owned())
}
