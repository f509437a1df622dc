//! The project file, `g7.toml`: it marks a folder whose files belong together, and names the chart that runs.
//!
//! ```toml
//! name = "Robot cell"
//! main = "cell.g7"
//! g7 = "0.1"
//! ```
//!
//! All keys may be left out; another key is an error.

use std::fs;
use std::path::Path;

use g7_model::{Said, say};
use serde::Deserialize;

use crate::failure::raw;

/// The name of the file.
pub(crate) const FILE: &str = "g7.toml";

/// The contents of a project file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Project {
    /// The title of the project.
    pub(crate) name: Option<String>,
    /// The path of the chart that runs, from the folder.
    main: Option<String>,
    /// The oldest version of G7 that reads its charts.
    g7: Option<String>,
}

impl Project {
    /// The project of a folder; `None` if there is no project file in it.
    ///
    /// # Errors
    ///
    /// The file cannot be read, has a mistake, or asks for a newer G7.
    pub(crate) fn of(folder: &Path) -> Result<Option<Project>, Said> {
        let path = folder.join(FILE);
        let told = |why: Said| of(folder, why);
        if !path.is_file() {
            return Ok(None);
        }
        let bytes = fs::read(&path).map_err(|e| told(raw(e)))?;
        let text = String::from_utf8(bytes).map_err(|e| told(raw(e)))?;
        let project: Project = toml::from_str(&text).map_err(|e| told(raw(e.to_string().trim_end())))?;
        let own = env!("CARGO_PKG_VERSION");
        if let Some(wanted) = &project.g7 {
            let Some(numbers) = numbers(wanted) else {
                return Err(told(say!(
                    "`{wanted}` is no version of G7, such as {own}",
                    wanted = raw(wanted),
                    own = raw(own)
                )));
            };
            if Some(numbers) > self::numbers(own) {
                return Err(told(say!(
                    "this project needs G7 {wanted} or newer, and this is {own}",
                    wanted = raw(wanted),
                    own = raw(own)
                )));
            }
        }
        Ok(Some(project))
    }

    /// The path of the chart that runs, from the folder, if the project names one.
    ///
    /// # Errors
    ///
    /// The path leads out of the folder, or is no path of a .g7 file.
    pub(crate) fn main(&self, folder: &Path) -> Result<Option<String>, Said> {
        let Some(main) = &self.main else { return Ok(None) };
        let inside = |path: String| {
            if path.starts_with("..") { Err(say!("it lies outside of the folder")) } else { Ok(path) }
        };
        let unusable = |why| of(folder, say!("`{}` cannot be used: {why}", raw(main)));
        g7_rig::resolved("", main).and_then(inside).map(Some).map_err(unusable)
    }
}

/// A mistake of the project file of a folder, with the name of the file.
fn of(folder: &Path, why: Said) -> Said {
    say!("{}: {why}", raw(folder.join(FILE).display()))
}

/// The numbers of a version.
fn numbers(version: &str) -> Option<[u32; 3]> {
    let mut numbers = [0; 3];
    let mut parts = version.split('.');
    for (k, number) in numbers.iter_mut().enumerate() {
        match parts.next() {
            Some(part) => *number = part.parse().ok()?,
            None if k > 0 => {}
            None => return None,
        }
    }
    parts.next().is_none().then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_numbers_from_left_to_right() {
        assert_eq!(numbers("0.1"), Some([0, 1, 0]));
        assert_eq!(numbers("2"), Some([2, 0, 0]));
        assert!(numbers("0.10.0") > numbers("0.9.9"));
        for wrong in ["", "a", "1.2.3.4", "1.-2", "1."] {
            assert_eq!(numbers(wrong), None, "{wrong:?}");
        }
    }
}
