//! Writes files completely or not at all, and leaves what a file is besides its bytes: owner, mode, links.
//!
//! A file is written under a temporary name beside its place, synced, and renamed. The temporary file is locked
//! while it is written, so that the next writer of the same file knows what a killed one left behind, and
//! deletes it.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Writes a file under a temporary name, syncs it and renames it: a full disk or a power failure
/// leaves the old file unchanged. A path that is not a regular file (a pipe, a device) is written
/// directly. A symbolic link stays, and its target is written. A file with several names, or with an
/// owner that cannot be given to a new file, is written in its place; if that fails, it gets its old
/// bytes back.
///
/// # Errors
///
/// The file cannot be written; no half-written file is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    written(path, bytes, None)
}

/// The same for a secret: on systems that have it, the file is its owner's alone before it has a byte.
///
/// # Errors
///
/// The file cannot be written; no half-written file is left behind.
pub fn write_private(path: &Path, bytes: &[u8]) -> io::Result<()> {
    #[cfg(unix)]
    let own = Some(std::os::unix::fs::PermissionsExt::from_mode(0o600));
    #[cfg(not(unix))]
    let own = None;
    written(path, bytes, own)
}

fn written(path: &Path, bytes: &[u8], own: Option<fs::Permissions>) -> io::Result<()> {
    let meta = fs::metadata(path).ok();
    if let Some(meta) = &meta {
        if meta.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if !meta.is_file() {
            let mut file = File::options().write(true).open(path)?;
            file.write_all(bytes)?;
            return file.flush();
        }
        // Renaming would bypass the write protection that the user has set on the file.
        File::options().write(true).open(path)?;
    }
    let path = target(path)?;
    sweep(&path);
    if meta.as_ref().is_some_and(|meta| names(meta) > 1) {
        return in_place(&path, bytes, own);
    }
    let (aside, file) = beside(&path)?;
    let done = match fill(file, bytes, own.clone(), meta.as_ref()) {
        Ok(true) => fs::rename(&aside, &path),
        Ok(false) => fs::remove_file(&aside).and_then(|()| in_place(&path, bytes, own)),
        Err(e) => Err(e),
    };
    if done.is_err() {
        fs::remove_file(&aside).ok();
        return done;
    }
    if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
        // The new name is safe only after the folder is synced; not every system can do this.
        File::open(folder).and_then(|f| f.sync_all()).ok();
    }
    Ok(())
}

/// Most symbolic links on the way to a file, as Linux has it.
const MOST_LINKS: u32 = 40;

/// The file that a path leads to, over symbolic links, also if it is not there yet.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_symlink()) {
            return Ok(path);
        }
        let to = fs::read_link(&path)?;
        path = path.parent().map_or(to.clone(), |folder| folder.join(to));
    }
    Err(io::Error::other("too many symbolic links"))
}

/// The number of names of a file.
#[cfg(unix)]
fn names(meta: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(meta)
}

#[cfg(not(unix))]
fn names(_: &Metadata) -> u64 {
    1
}

/// Gives a new file the owner of another one; false if it must not have it.
#[cfg(unix)]
fn owned(file: &File, like: &Metadata) -> io::Result<bool> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let new = file.metadata()?;
    if (new.uid(), new.gid()) == (like.uid(), like.gid()) {
        return Ok(true);
    }
    Ok(fchown(file, Some(like.uid()), Some(like.gid())).is_ok())
}

#[cfg(not(unix))]
fn owned(_: &File, _: &Metadata) -> io::Result<bool> {
    Ok(true)
}

/// Writes a file without changing what it is. Its old bytes are in memory until the new ones are safe.
fn in_place(path: &Path, bytes: &[u8], own: Option<fs::Permissions>) -> io::Result<()> {
    let old = fs::read(path)?;
    let mut file = File::options().write(true).open(path)?;
    if let Some(permissions) = own {
        file.set_permissions(permissions)?;
    }
    let put = |file: &mut File, bytes: &[u8]| {
        io::Seek::rewind(file)?;
        file.write_all(bytes)?;
        file.set_len(bytes.len() as u64)?;
        file.sync_all()
    };
    put(&mut file, bytes).inspect_err(|_| {
        put(&mut file, &old).ok();
    })
}

/// Most writers of one file at one time.
const MOST_WRITERS: u32 = 100;

/// A new file beside a path, locked: `.name.PROCESS.new`, with a number more if another thread writes too.
fn beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    for number in 0..MOST_WRITERS {
        let mut aside = std::ffi::OsString::from(".");
        aside.push(name);
        let process = std::process::id();
        aside.push(if number == 0 { format!(".{process}.new") } else { format!(".{process}.{number}.new") });
        let aside = path.with_file_name(aside);
        match File::options().write(true).create_new(true).open(&aside) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
            Ok(file) => {
                // A system without locks sweeps nothing.
                file.try_lock().ok();
                return Ok((aside, file));
            }
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Writes the new file; false if it cannot have the owner of the old one.
fn fill(
    mut file: File,
    bytes: &[u8],
    own: Option<fs::Permissions>,
    like: Option<&Metadata>,
) -> io::Result<bool> {
    if let Some(like) = like {
        // The owner goes first, because a change of it takes bits of the mode away.
        if !owned(&file, like)? {
            return Ok(false);
        }
    }
    if let Some(permissions) = own.or_else(|| like.map(Metadata::permissions)) {
        file.set_permissions(permissions)?;
    }
    file.write_all(bytes)?;
    file.sync_all()?;
    Ok(true)
}

/// A temporary file younger than this may belong to a writer that has not locked it yet.
const YOUNG: Duration = Duration::from_secs(60);

/// The temporary files that were there when this process first wrote into a folder, by folder. A folder is listed
/// once: it may hold thousands of files, and each of them may be written.
static LEFT: Mutex<BTreeMap<PathBuf, Vec<String>>> = Mutex::new(BTreeMap::new());

/// Deletes what writers of this file that were killed before this process began have left beside it. What cannot
/// be deleted stays.
fn sweep(path: &Path) {
    let (Some(name), Some(folder)) = (path.file_name().and_then(|n| n.to_str()), path.parent()) else {
        return;
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(place) = folder.canonicalize() else { return };
    let mut left = LEFT.lock().unwrap_or_else(PoisonError::into_inner);
    let left = left.entry(place).or_insert_with_key(|place| temporaries(place));
    left.retain(|there| !written_for(there, name) || !swept(&folder.join(there)));
}

/// The names of the temporary files of a folder.
fn temporaries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|there| there.starts_with('.') && there.ends_with(".new")).collect()
}

/// True if a temporary file was written for a file: `.a.77.1.new` for `a`.
fn written_for(there: &str, name: &str) -> bool {
    let rest = there.strip_prefix('.').and_then(|rest| rest.strip_prefix(name)?.strip_prefix('.'));
    let numbers = rest.and_then(|rest| rest.strip_suffix(".new"));
    numbers.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit() || b == b'.'))
}

/// Deletes a temporary file whose writer was killed; true if it is gone.
fn swept(there: &Path) -> bool {
    let file = match File::options().write(true).open(there) {
        Err(e) => return e.kind() == io::ErrorKind::NotFound,
        Ok(file) => file,
    };
    let age = file.metadata().and_then(|meta| meta.modified()).map(|at| at.elapsed());
    matches!(age, Ok(Ok(age)) if age > YOUNG) && file.try_lock().is_ok() && fs::remove_file(there).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder for a test, deleted at its end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Folder {
            let path = std::env::temp_dir().join(format!("g7-whole-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Folder(path)
        }

        fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = fs::read_dir(&self.0)
                .unwrap()
                .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).ok();
        }
    }

    #[test]
    fn a_full_disk_leaves_the_old_file_and_nothing_beside_it() {
        let folder = Folder::new("full");
        let path = folder.0.join("a");
        fs::write(&path, "old").unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(write_whole(&folder.0.join("missing/a"), b"x").is_err());
        assert!(write_whole(&folder.0, b"x").is_err());
        assert_eq!(folder.names(), ["a"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_that_is_full_says_so() {
        let error = write_whole(Path::new("/dev/full"), b"x").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_mode_stay() {
        use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
        let folder = Folder::new("links");
        let at = |name: &str| folder.0.join(name);
        fs::write(at("a"), "old and longer").unwrap();
        fs::set_permissions(at("a"), fs::Permissions::from_mode(0o640)).unwrap();
        fs::hard_link(at("a"), at("b")).unwrap();
        symlink("b", at("c")).unwrap();
        symlink("later", at("d")).unwrap();
        write_whole(&at("c"), b"new").unwrap();
        write_whole(&at("d"), b"made").unwrap();
        let meta = fs::metadata(at("a")).unwrap();
        assert_eq!((meta.nlink(), meta.mode() & 0o7777), (2, 0o640));
        assert_eq!(fs::read(at("a")).unwrap(), b"new");
        for link in ["c", "d"] {
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        }
        assert_eq!(fs::read(at("later")).unwrap(), b"made");
        fs::set_permissions(at("later"), fs::Permissions::from_mode(0o604)).unwrap();
        write_whole(&at("later"), b"again").unwrap();
        assert_eq!(fs::metadata(at("later")).unwrap().mode() & 0o7777, 0o604);
        assert_eq!(folder.names(), ["a", "b", "c", "d", "later"]);
    }

    #[cfg(unix)]
    #[test]
    fn the_owner_stays_when_root_writes() {
        use std::os::unix::fs::{MetadataExt, chown};
        let folder = Folder::new("owner");
        let path = folder.0.join("a");
        fs::write(&path, "old").unwrap();
        // Only root can give a file away; for anybody else there is nothing to keep.
        if chown(&path, Some(12_345), Some(23_456)).is_err() {
            return;
        }
        write_whole(&path, b"new").unwrap();
        let meta = fs::metadata(&path).unwrap();
        assert_eq!((meta.uid(), meta.gid()), (12_345, 23_456));
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn what_killed_writers_left_is_swept_and_nothing_else() {
        let folder = Folder::new("sweep");
        let path = folder.0.join("a");
        let left = |name: &str, old: bool| {
            let file = File::create(folder.0.join(name)).unwrap();
            if old {
                file.set_modified(std::time::UNIX_EPOCH).unwrap();
            }
            file
        };
        left(".a.77.new", true);
        left(".a.77.1.new", true);
        left(".a.78.new", false);
        left(".a.draft.new", true);
        left(".b.77.new", true);
        let busy = left(".a.79.new", true);
        busy.lock().unwrap();
        write_whole(&path, b"x").unwrap();
        assert_eq!(folder.names(), [".a.78.new", ".a.79.new", ".a.draft.new", ".b.77.new", "a"]);
        // Files written later in this folder are swept for as well, without another look at the folder.
        drop(busy);
        write_whole(&folder.0.join("b"), b"x").unwrap();
        write_whole(&path, b"y").unwrap();
        assert_eq!(folder.names(), [".a.78.new", ".a.draft.new", "a", "b"]);
    }
}
