//! The memory, threads and descriptors of a process, as Linux tells them.

use std::path::PathBuf;

fn of(pid: u32, what: &str) -> PathBuf {
    PathBuf::from(format!("/proc/{pid}/{what}"))
}

/// Its own memory in KiB, without what it shares with its file; `None` where the system does not tell.
pub fn memory(pid: u32) -> Option<u64> {
    let status = std::fs::read_to_string(of(pid, "status")).ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("RssAnon:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The number of its open files, sockets and the like; `None` where the system does not tell.
pub fn descriptors(pid: u32) -> Option<usize> {
    Some(std::fs::read_dir(of(pid, "fd")).ok()?.count())
}

/// A file as this process sees it, in its own mounts.
pub fn its_file(pid: u32, path: &std::path::Path) -> PathBuf {
    of(pid, "root").join(path.strip_prefix("/").unwrap_or(path))
}
