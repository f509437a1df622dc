//! One process of a shared search: its place among the others, and the answers.

use std::path::{Path, PathBuf};

use g7_hosts::{Place, Work};
use g7_rig::Source;
use g7_verify::{Asked, Budget, Expander, Model, Verdict, solve};
use sha2::{Digest, Sha256};

use g7_model::{Said, say};

use crate::cli::{Answers, Prove, Shared};
use crate::failure::{Failure, raw};
use crate::files;
use crate::message::talk;

/// Refuses what cannot be shared.
pub(super) fn refuse(args: &Prove, paths: &[PathBuf]) -> Result<(), Failure> {
    let shared = &args.shared;
    let usage = |text: Said| Err(Failure::Usage(text));
    match args.format.filter(|_| shared.shard.is_some()) {
        Some(Answers::Sarif) => {
            return usage(say!(
                "--shard prints lines of JSON: a log for code review is one object of all answers"
            ));
        }
        Some(Answers::Text) => {
            return usage(say!(
                "--shard prints lines of JSON, which are put together again: leave --format out"
            ));
        }
        Some(Answers::Json) | None => {}
    }
    if !is_shared(shared) {
        return match &shared.keep {
            Some(_) => usage(say!("--keep is for a search among processes: give --workers or --hosts too")),
            None => Ok(()),
        };
    }
    if paths.iter().any(|p| p.as_os_str() == "-") {
        return usage(say!("processes cannot share the standard input: name a file"));
    }
    match paths.len() {
        1 => Ok(()),
        n => Err(Failure::Usage(say!(
            "processes share the search of one chart, and there are {n}: name the one you mean, or use --shard"
        ))),
    }
}

/// True if the search is shared among processes.
pub(super) fn is_shared(shared: &Shared) -> bool {
    shared.workers.is_some() || shared.hosts.is_some()
}

impl Shared {
    /// True for a process of a shared search that has another one print the answers.
    pub(super) fn is_silent(&self) -> bool {
        self.process.is_some_and(|me| me > 0)
    }
}

/// The addresses of the file of hosts, which must agree with the other options.
pub(super) fn addresses(shared: &Shared, path: &Path) -> Result<Vec<String>, Failure> {
    let text = String::from_utf8_lossy(&files::read(path)?).into_owned();
    let list = g7_hosts::parse(&path.display().to_string(), &text).map_err(failure)?;
    let count = list.len();
    if let Some(workers) = shared.workers.map(usize::from).filter(|n| *n != count) {
        return Err(Failure::Usage(say!(
            "--workers {workers}, but {} has {count} hosts: one process for each line",
            raw(path.display())
        )));
    }
    match shared.process {
        Some(me) if me >= count => Err(Failure::Usage(say!(
            "--process {me}, but {} has {count} hosts: the first one is process 0",
            raw(path.display())
        ))),
        _ => Ok(list),
    }
}

pub(super) fn failure(error: g7_hosts::Error) -> Failure {
    Failure::Usage(raw(error))
}

/// A folder of its own, which goes with its owner.
pub(super) struct Temporary(pub(super) PathBuf);

impl Temporary {
    pub(super) fn new() -> Result<Temporary, Failure> {
        let base = std::env::temp_dir();
        let path = (0..1000).map(|k| base.join(format!("g7-prove-{}-{k}", std::process::id())));
        for path in path {
            match made(&path) {
                Ok(()) => return Ok(Temporary(path)),
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(Failure::Write(path, e)),
            }
        }
        Err(Failure::Usage(say!("no folder can be made in {}", raw(base.display()))))
    }
}

/// Makes a folder that nobody else may look into.
fn made(path: &Path) -> std::io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // A file that remains is in a folder that the system clears.
        let _left = std::fs::remove_dir_all(&self.0);
    }
}

/// The answers of this process; those of process 0 are whole.
pub(super) fn answer(
    args: &Prove,
    source: &Source,
    asked: &Asked,
    model: &Model<'_>,
    budget: &Budget<'_>,
) -> Result<Vec<Option<Verdict>>, Failure> {
    let shared = &args.shared;
    let (Some(hosts), Some(me)) = (&shared.hosts, shared.process) else { return Ok(Vec::new()) };
    let addresses = addresses(shared, hosts)?;
    let temporary = if shared.keep.is_none() { Some(Temporary::new()?) } else { None };
    let folder = match (&shared.keep, &temporary) {
        (Some(keep), _) => keep.as_path(),
        (None, Some(temporary)) => temporary.0.as_path(),
        (None, None) => Path::new("."),
    };
    let place = Place {
        me,
        addresses: &addresses,
        work: work(args, source, asked, model),
        folder,
        tried: None,
        tell: &|line: &str| talk!("process {me}: {line}"),
    };
    let mut answers = vec![None; asked.questions.len()];
    for (i, verdict) in g7_hosts::answer(model, &asked.questions, budget, &place).map_err(failure)? {
        if let Some(answer) = answers.get_mut(i) {
            *answer = Some(verdict);
        }
    }
    if me == 0 {
        solve(model, &asked.questions, &mut answers, budget);
    }
    Ok(answers)
}

/// All that decides on the answers, but the time and the memory.
fn work(args: &Prove, source: &Source, asked: &Asked, model: &Model<'_>) -> Work {
    let first = |parts: &[&[u8]]| {
        let mut hash = Sha256::new();
        parts.iter().for_each(|p| hash.update(p));
        hash.finalize().first_chunk().map_or(0, |b| u64::from_le_bytes(*b))
    };
    // The image has the hash of the compiled program.
    let image: Vec<u8> = Expander::new(model, &[]).start().0.iter().flat_map(|w| w.to_le_bytes()).collect();
    let options = format!("{:?} {} {:?} {:?}", args.profile, args.states, asked.questions, asked.assume);
    Work {
        program: first(&[env!("CARGO_PKG_VERSION").as_bytes()]),
        task: first(&[source.text.as_bytes(), options.as_bytes(), &image]),
    }
}
