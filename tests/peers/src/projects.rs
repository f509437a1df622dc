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

/// The schema of PLCopen's TC6 2.01, which the checkout of Beremiz has, with the lxml of Python that holds files
/// against it.
#[derive(Clone, Debug)]
pub struct Schema {
    python: PathBuf,
    file: PathBuf,
}

/// The schema; a skip is counted if it is missing.
pub fn schema() -> Option<Schema> {
    let folder = std::env::var_os("G7_BEREMIZ").map(PathBuf::from);
    let file = folder.map(|f| f.join("plcopen/tc6_xml_v201.xsd")).filter(|f| f.is_file());
    let Some(file) = file else {
        skip("schema of TC6 missing");
        return None;
    };
    Some(Schema { python: python("lxml")?, file })
}

impl Schema {
    /// For each file the complaint where it breaks the schema.
    pub fn holds(&self, files: &[PathBuf]) -> Vec<Result<(), String>> {
        let mut command = Command::new("timeout");
        command.arg("300").arg(&self.python).arg(script("schema.py")).arg(&self.file).args(files);
        lines(command, files.len())
            .into_iter()
            .map(|line| if line.is_empty() { Ok(()) } else { Err(line) })
            .collect()
    }
}

/// The lines that a command prints, one for each file.
fn lines(mut command: Command, files: usize) -> Vec<String> {
    let said = match command.output() {
        Ok(out) => String::from_utf8_lossy(&out.stdout).into_owned(),
        Err(e) => e.to_string(),
    };
    let all = said.lines().map(str::to_owned).chain(std::iter::repeat("it ended early".to_owned()));
    all.take(files).collect()
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

impl Projects {
    /// The texts of several projects, made by one process, which is faster; for each the reason where it is refused.
    pub fn texts(&self, projects: &[PathBuf]) -> Vec<Result<String, String>> {
        if let [one] = projects {
            return vec![self.text(one)];
        }
        // As long as for one process each.
        let mut command = Command::new("timeout");
        command.arg((30 * projects.len()).to_string()).arg(&self.python);
        command.arg(script("plcopen_to_st.py")).arg(&self.folder).args(projects);
        let said = lines(command, projects.len());
        let text = |(project, said): (&PathBuf, String)| {
            if !said.is_empty() {
                return Err(said);
            }
            let made = format!("{}.st", project.display());
            std::fs::read_to_string(made).map_err(|e| e.to_string())
        };
        projects.iter().zip(said).map(text).collect()
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
