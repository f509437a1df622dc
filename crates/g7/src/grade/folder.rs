//! The files of an exercise, and the submissions of a folder.
//!
//! A file is a submission, and so is a folder, for students who hand in several files. Links are not followed, and a submission
//! reads no file but its own and those that the exercise gives: one student's chart cannot read that of another.

use std::fs;
use std::path::{Path, PathBuf};

use g7_grade::{Exercise, Files};
use g7_model::{Said, say};
use g7_rig::Source;

use crate::failure::{Failure, raw};
use crate::{files, sources, used};

/// The subfolders of an exercise whose files are read too.
const FOLDERS: [&str; 2] = ["wrong", "lib"];
/// The size of the largest file that is read, in bytes.
const LONGEST: u64 = 8 << 20;

/// The files of an exercise.
pub(super) fn exercise(folder: &Path) -> Result<Files, Failure> {
    let mut found = Files::new();
    for (within, prefix) in std::iter::once((folder.to_path_buf(), String::new()))
        .chain(FOLDERS.iter().map(|name| (folder.join(name), format!("{name}/"))))
    {
        if !prefix.is_empty() && !within.is_dir() {
            continue;
        }
        for path in files::list(&within)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let is_text = path.extension().is_some_and(|e| e == "md" || e == "g7");
            if is_text && path.is_file() {
                found.insert(format!("{prefix}{name}"), read(&path)?);
            }
        }
    }
    Ok(found)
}

/// A submission: its name, the file or folder, and the folder of its own if it has one.
#[derive(Clone, Debug)]
pub(super) struct Submission {
    pub(super) name: String,
    path: PathBuf,
}

/// The submissions of a folder by their names, or the one of a file.
pub(super) fn submissions(path: &Path) -> Result<Vec<Submission>, Failure> {
    let one = |path: PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
        Submission { name, path }
    };
    if fs::metadata(path).map_err(|e| Failure::Read(path.to_path_buf(), e))?.is_file() {
        return Ok(vec![one(path.to_path_buf())]);
    }
    let mut found: Vec<Submission> = files::list(path)?.into_iter().map(one).collect();
    // Hidden files are notes of systems and tools, and a link may lead anywhere.
    found.retain(|s| !s.name.starts_with('.') && (is_plain_file(&s.path) || is_plain_folder(&s.path)));
    if found.is_empty() {
        return Err(Failure::Usage(say!("{} has no submission", raw(path.display()))));
    }
    Ok(found)
}

impl Submission {
    /// Reads the charts, with the files that they use.
    ///
    /// # Errors
    ///
    /// The reason for which there is nothing to grade.
    pub(super) fn load(&self, exercise: &Exercise) -> Result<Source, Said> {
        let told = |failure: Failure| failure.said();
        let (path, folder) = if is_plain_folder(&self.path) {
            (self.chart()?, Some(self.path.canonicalize().map_err(raw)?))
        } else {
            (self.path.clone(), None)
        };
        let bytes = read(&path).map_err(told)?;
        let name = if folder.is_some() {
            format!("{}/{}", self.name, path.strip_prefix(&self.path).unwrap_or(&path).display())
        } else {
            self.name.clone()
        };
        let source = exercise.submission(&name, bytes, &mut |path_of_use| match &folder {
            Some(folder) => {
                let beside =
                    path.strip_prefix(&self.path).ok().and_then(Path::parent).unwrap_or(Path::new(""));
                used::within(folder, &folder.join(beside).join(path_of_use))
            }
            None => {
                Err(say!("a submission of one file uses the library and the files of the exercise alone"))
            }
        });
        sources::refuse_formless(&source, &path)?;
        Ok(source)
    }

    /// The chart in a folder: its only .g7 file, or the only file that it has.
    fn chart(&self) -> Result<PathBuf, Said> {
        let all = files::list(&self.path).map_err(|failure| failure.said())?;
        let visible = |p: &&PathBuf| {
            is_plain_file(p) && !p.file_name().unwrap_or_default().to_string_lossy().starts_with('.')
        };
        let all: Vec<&PathBuf> = all.iter().filter(visible).collect();
        let charts: Vec<&PathBuf> = all.iter().copied().filter(|p| files::is_chart(p)).collect();
        let named = |name: &str| charts.iter().find(|p| p.ends_with(name)).copied();
        let chosen = named(g7_grade::TEMPLATE).or_else(|| named("chart.g7")).or(match (&*charts, &*all) {
            ([only], _) | ([], [only]) => Some(*only),
            _ => None,
        });
        match chosen {
            Some(path) => Ok(path.clone()),
            None if all.is_empty() => Err(say!("the folder is empty")),
            None => Err(say!(
                "it is not clear which file of the folder is the chart: name it `template.g7` or `chart.g7`"
            )),
        }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let length = fs::metadata(path).map_err(|e| Failure::Read(path.to_path_buf(), e))?.len();
    if length > LONGEST {
        let (name, most) = (path.file_name().unwrap_or_default().to_string_lossy(), LONGEST >> 20);
        return Err(Failure::Usage(say!(
            "{name} is longer than {most} MiB, and is not read",
            name = raw(name)
        )));
    }
    files::read(path)
}

fn is_plain_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|m| m.is_file())
}

fn is_plain_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|m| m.is_dir())
}
