//! Writes the folder of pages: all of them or none, and never over files that this command did not write.

use std::fs;
use std::io;
use std::path::Path;

use g7_model::say;

use crate::failure::{Failure, raw};
use crate::files;

/// The mark in each page. A folder whose files all have it is replaced unasked.
pub(super) const MARK: &str = "<meta name=\"generator\" content=\"g7 grade\">";

/// Refuses a folder that holds what this command did not write, and one that is a source of it.
pub(super) fn refuse_foreign(folder: &Path, from: &[&Path]) -> Result<(), Failure> {
    files::refuse_source(Some(folder), from)?;
    match fs::symlink_metadata(folder) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(Failure::Write(folder.to_path_buf(), e)),
        Ok(meta) if !meta.is_dir() => {
            return Err(Failure::Usage(say!("{} is no folder; nothing was changed", raw(folder.display()))));
        }
        Ok(_) => {}
    }
    for path in files::list(folder)? {
        let is_ours = path.extension().is_some_and(|e| e == "html")
            && fs::symlink_metadata(&path).is_ok_and(|m| m.is_file())
            && files::read(&path).is_ok_and(|b| b.windows(MARK.len()).any(|part| part == MARK.as_bytes()));
        if !is_ours {
            return Err(Failure::Usage(say!(
                "{} is there, and g7 grade did not write it; choose another folder",
                raw(path.display())
            )));
        }
    }
    Ok(())
}

/// Writes the pages to a folder beside the wanted one, and puts that in its place.
pub(super) fn write(folder: &Path, pages: &[(String, String)]) -> Result<(), Failure> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let beside = |mark: &str| folder.with_file_name(format!(".{name}.{mark}-{}", std::process::id()));
    let (fresh, old) = (beside("new"), beside("old"));
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |e: io::Error| Failure::Write(path, e)
    };
    let put = || {
        fs::create_dir_all(&fresh).map_err(failed(&fresh))?;
        for (name, page) in pages {
            files::write(&fresh.join(name), page.as_bytes())?;
        }
        let was_there = folder.exists();
        if was_there {
            fs::rename(folder, &old).map_err(failed(folder))?;
        }
        if let Err(e) = fs::rename(&fresh, folder) {
            if was_there {
                fs::rename(&old, folder).ok();
            }
            return Err(Failure::Write(folder.to_path_buf(), e));
        }
        Ok(())
    };
    let done = put();
    fs::remove_dir_all(&fresh).ok();
    if done.is_ok() {
        fs::remove_dir_all(&old).ok();
    }
    done
}
