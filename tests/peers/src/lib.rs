//! Tools that tests need from the machine and cannot bring along: compilers, the
//! runtime of the sanitizers, matiec, and the corpus of charts that people drew.
//!
//! A test asks here, and here alone. A peer is tried before a test uses it. If it
//! is missing, the test goes without that part, and the skip is written to the file
//! that `G7_SKIPS` names; `make test` counts these lines (`tally`) in its last line.
#![forbid(unsafe_code)]
#![allow(clippy::disallowed_methods, reason = "tests look at the machine that they run on")]

pub mod checkers;
#[cfg(feature = "crowd")]
pub mod crowd;
pub mod faults;
pub mod ironplc;
pub mod mended;
pub mod process;
pub mod projects;
pub mod tally;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts a skip of the running test.
///
/// # Panics
///
/// If the file that `G7_SKIPS` names cannot be written: an uncounted skip is worse
/// than a failure.
pub fn skip(why: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    println!("skipped: {why}");
    let Some(file) = std::env::var_os("G7_SKIPS") else { return };
    note(Path::new(&file), why, test).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
}

fn note(file: &Path, why: &str, test: &str) -> std::io::Result<()> {
    append(file, &format!("{why}\t{test}\n"))
}

/// One call writes the whole line, so that tests that run side by side do not mix.
fn append(file: &Path, line: &str) -> std::io::Result<()> {
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(file)?;
    file.write_all(line.as_bytes())
}

/// A folder of the corpus (`""` for all of it), which stands at `G7_CORPUS`, else at
/// `../shared/corpus` beside the repository.
///
/// # Panics
///
/// If `G7_CORPUS` names no folder.
pub fn corpus(part: &str) -> Option<PathBuf> {
    let named = std::env::var_os("G7_CORPUS").map(PathBuf::from);
    if let Some(wrong) = named.as_ref().filter(|p| !p.is_dir()) {
        panic!("G7_CORPUS is no folder: {}", wrong.display());
    }
    let beside = || [env!("CARGO_MANIFEST_DIR"), "..", "..", "..", "shared", "corpus"].iter().collect();
    let root = named.unwrap_or_else(beside);
    if !root.is_dir() {
        skip("corpus absent");
        return None;
    }
    let folder = root.join(part);
    if !folder.is_dir() {
        skip(&format!("corpus without {part}"));
        return None;
    }
    Some(folder)
}

/// The function library OSCAT Basic as a project of OpenPLC (its files `plc.st`), at `G7_OSCAT`; it is not part of the
/// repository.
pub fn oscat() -> Option<PathBuf> {
    let named = std::env::var_os("G7_OSCAT").map(PathBuf::from).filter(|path| path.is_dir());
    if named.is_none() {
        skip("OSCAT absent");
    }
    named
}

/// The schema of SARIF 2.1.0 as OASIS publishes it, at `G7_SARIF_SCHEMA`; it is not part of the repository.
pub fn sarif_schema() -> Option<PathBuf> {
    let named = std::env::var_os("G7_SARIF_SCHEMA").map(PathBuf::from).filter(|path| path.is_file());
    if named.is_none() {
        skip("schema of SARIF absent");
    }
    named
}

/// True if rustc can compile for a target; otherwise the skip is counted.
pub fn target(name: &str) -> bool {
    let found = compiles_for(name);
    if !found {
        skip(&format!("target {name} missing"));
    }
    found
}

fn compiles_for(target: &str) -> bool {
    let folder = Scratch::new("target");
    let arguments = ["--crate-type", "lib", "--target", target, "try.rs"];
    std::fs::write(folder.0.join("try.rs"), "#![no_std]\n").is_ok()
        && quiet(Command::new("rustc").args(arguments).current_dir(&folder.0))
}

/// A file system of its own with a bounded size, which a test fills up. Dropping it ends it.
pub struct SmallDisk(PathBuf);

impl SmallDisk {
    /// With so many KiB; `None` where this user may mount none, which is counted.
    pub fn new(kib: u32) -> Option<SmallDisk> {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("g7-disk-{}-{number}", std::process::id()));
        let made = std::fs::create_dir_all(&path).is_ok();
        let size = format!("size={kib}k");
        if made && quiet(Command::new("mount").args(["-t", "tmpfs", "-o", &size, "tmpfs"]).arg(&path)) {
            return Some(SmallDisk(path));
        }
        std::fs::remove_dir(&path).ok();
        skip("no file system can be mounted");
        None
    }

    /// Its folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        quiet(Command::new("umount").arg(&self.0));
        std::fs::remove_dir(&self.0).ok();
    }
}

/// True if a tool can be started; otherwise the skip is counted.
pub fn tool(name: &str) -> bool {
    let found = starts(name);
    if !found {
        skip(&format!("{name} missing"));
    }
    found
}

/// True if tmux is there, which knows `-V` and no `--version`; otherwise the skip is counted.
pub fn tmux() -> bool {
    let found = quiet(Command::new("tmux").arg("-V"));
    if !found {
        skip("tmux missing");
    }
    found
}

fn starts(name: &str) -> bool {
    quiet(Command::new(name).arg("--version"))
}

/// The flags, if a compiler builds a program with them that starts; otherwise none,
/// and the skip is counted. Debian's clang comes without the runtime of its sanitizers.
pub fn sanitizers<'f>(compiler: &str, flags: &'f [&'f str]) -> &'f [&'f str] {
    if builds(compiler, flags) {
        return flags;
    }
    skip(&format!("{compiler} without sanitizers"));
    &[]
}

fn builds(compiler: &str, flags: &[&str]) -> bool {
    let folder = Scratch::new("sanitizers");
    std::fs::write(folder.0.join("try.c"), "int main(void) { return 0; }\n").is_ok()
        && quiet(Command::new(compiler).args(flags).args(["try.c", "-o", "try"]).current_dir(&folder.0))
        && quiet(&mut Command::new(folder.0.join("try")))
}

/// matiec: `iec2c` on the `PATH`, and its library.
#[derive(Clone, Debug)]
pub struct Matiec {
    /// The compiler.
    pub tool: PathBuf,
    /// The folder of `ieclib.txt`.
    pub lib: PathBuf,
}

impl Matiec {
    /// Finds it without trying it or counting anything. The library is looked for in
    /// `MATIEC_LIB`, then beside the compiler, then where packages put it.
    pub fn find() -> Option<Matiec> {
        let path = std::env::var_os("PATH")?;
        let tool = std::env::split_paths(&path).map(|d| d.join("iec2c")).find(|p| p.is_file())?;
        let home = tool.parent()?.to_path_buf();
        let named = std::env::var_os("MATIEC_LIB").map(PathBuf::from);
        let places = [
            home.join("lib"),
            home.join("../lib/matiec"),
            "/usr/lib/matiec".into(),
            "/usr/share/matiec/lib".into(),
        ];
        let lib = named.into_iter().chain(places).find(|l| l.join("ieclib.txt").is_file())?;
        Some(Matiec { tool, lib })
    }

    /// Its call for a file: C goes to the folder in which it runs.
    ///
    /// matiec looks at memory that it has not written when it meets S and R, and takes
    /// them for calls of function blocks then; the C library is told to clear it.
    pub fn translate(&self, folder: &Path, file: &str) -> Command {
        let mut command = Command::new(&self.tool);
        command.env("GLIBC_TUNABLES", "glibc.malloc.perturb=255:glibc.malloc.tcache_count=0");
        command.current_dir(folder).arg("-I").arg(&self.lib).args(["-T", ".", file]);
        command
    }
}

/// matiec, if it translates a program; otherwise the skip is counted.
pub fn matiec() -> Option<Matiec> {
    let Some(matiec) = Matiec::find() else {
        skip("iec2c missing");
        return None;
    };
    let folder = Scratch::new("matiec");
    let text = "PROGRAM p\nVAR a : BOOL; END_VAR\na := NOT a;\nEND_PROGRAM\n";
    let fine = std::fs::write(folder.0.join("try.st"), text).is_ok()
        && quiet(&mut matiec.translate(&folder.0, "try.st"));
    if !fine {
        skip("iec2c does not work");
    }
    fine.then_some(matiec)
}

/// A Python that has a module: that of `make test`, which `G7_PEERS` names, else the system's.
/// Otherwise the skip is counted.
pub fn python(module: &str) -> Option<PathBuf> {
    let own = std::env::var_os("G7_PEERS").map(|folder| Path::new(&folder).join("bin/python"));
    let has = |python: &PathBuf| quiet(Command::new(python).args(["-c", &format!("import {module}")]));
    let found = own.into_iter().chain([PathBuf::from("python3")]).find(has);
    if found.is_none() {
        skip(&format!("Python's {module} missing"));
    }
    found
}

/// The broker of mosquitto, with its clients beside it; otherwise the skip is counted. Debian puts it
/// where only root looks for programs.
pub fn mosquitto() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let places = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/usr/local/sbin".into()]);
    let found = places.map(|folder| folder.join("mosquitto")).find(|file| file.is_file());
    // It says its version and ends with an error.
    let clients = Command::new("mosquitto_sub").arg("--version").stdout(Stdio::null()).status().is_ok();
    let found = found.filter(|_| clients);
    if found.is_none() {
        skip("mosquitto missing");
    }
    found
}

/// The library of faketime, which gives a program another time of day; otherwise the skip is counted.
pub fn faketime() -> Option<PathBuf> {
    let folders = std::fs::read_dir("/usr/lib").into_iter().flatten().flatten().map(|f| f.path());
    let library =
        folders.map(|folder| folder.join("faketime/libfaketimeMT.so.1")).find(|file| file.is_file());
    let works = |library: &PathBuf| {
        let mut date = Command::new("date");
        date.arg("+%Y").env("LD_PRELOAD", library).env("FAKETIME", "@2031-05-01 00:00:00");
        date.output().is_ok_and(|out| out.stdout == b"2031\n")
    };
    let found = library.filter(works);
    if found.is_none() {
        skip("faketime missing");
    }
    found
}

/// A command that runs a line of the shell where it may mount file systems that nobody else sees; otherwise
/// the skip is counted.
pub fn with_own_mounts() -> Option<Command> {
    let command = |user: &[&str]| {
        let mut command = Command::new("unshare");
        command.arg("--mount").args(user).args(["sh", "-c"]);
        command
    };
    let fine = |user: &[&str]| quiet(command(user).arg("mount -t tmpfs -o size=64k none /tmp"));
    let found = [&[][..], &["--map-root-user"]].into_iter().find(|user| fine(user));
    if found.is_none() {
        skip("no file system can be mounted");
    }
    found.map(command)
}

/// cyclictest and stress-ng, where SCHED_FIFO is allowed; otherwise the skip is counted.
pub fn load_tools() -> bool {
    let found = starts("stress-ng")
        && quiet(Command::new("cyclictest").args(["--priority=50", "--loops=2", "--quiet"]));
    if !found {
        skip("cyclictest or stress-ng missing, or no SCHED_FIFO");
    }
    found
}

/// A script in Python of this project that drives a peer.
pub fn script(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "python", name].iter().collect()
}

/// Node with a script of this project and the package that it needs, which `make test` installs in the
/// folder that `G7_PEERS` names; otherwise the skip is counted.
pub fn node(package: &str, script: &str) -> Option<Command> {
    let modules = std::env::var_os("G7_PEERS").map(|peers| Path::new(&peers).join("node/node_modules"));
    let found = modules.filter(|folder| folder.join(package).is_dir());
    let found = found.filter(|_| quiet(Command::new("node").arg("--version")));
    let Some(modules) = found else {
        skip(&format!("Node's {package} missing"));
        return None;
    };
    let file: PathBuf = [env!("CARGO_MANIFEST_DIR"), "node", script].iter().collect();
    let mut command = Command::new("node");
    command.arg(file).env("NODE_PATH", modules);
    Some(command)
}

/// The program of tree-sitter, with a compiler for the parsers that it makes; otherwise the skip is counted.
pub fn tree_sitter() -> Option<PathBuf> {
    let own = std::env::var_os("G7_PEERS").map(|peers| Path::new(&peers).join("tree-sitter/bin/tree-sitter"));
    let program = own.filter(|p| p.is_file()).unwrap_or_else(|| "tree-sitter".into());
    let found = quiet(Command::new(&program).arg("--version")) && starts("cc");
    if !found {
        skip("tree-sitter missing");
    }
    found.then_some(program)
}

/// True if a command starts and succeeds; nothing of what it says is shown.
fn quiet(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|s| s.success())
}

/// A folder of its own for a trial, removed at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(what: &str) -> Scratch {
        static TRIALS: AtomicUsize = AtomicUsize::new(0);
        let trial = TRIALS.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("g7-{what}-{}-{trial}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for a trial");
        Scratch(folder)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// These do not count their skips: they are no skips of `make test`.
    #[test]
    fn what_does_not_work_is_not_used() {
        assert!(starts("rustc") && !starts("g7-has-no-such-tool"));
        assert!(!builds("g7-has-no-such-tool", &[]));
        assert!(!builds("rustc", &["--no-such-flag"]));
        assert!(!compiles_for("g7-has-no-such-target"));
    }

    #[test]
    fn skips_are_lines_with_the_reason_first() {
        let folder = Scratch::new("skips");
        let file = folder.0.join("skips");
        note(&file, "corpus absent", "one").expect("a line");
        note(&file, "clang missing", "two").expect("a line");
        let text = std::fs::read_to_string(&file).expect("the lines");
        assert_eq!(text, "corpus absent\tone\nclang missing\ttwo\n");
        let mut tally = tally::Tally::default();
        tally.add_skips(&text);
        assert!(tally.to_string().ends_with("skipped: 2 (clang missing: 1, corpus absent: 1)"));
        assert!(note(&folder.0.join("no/skips"), "corpus absent", "one").is_err());
    }
}
