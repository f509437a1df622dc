//! `--workers n`: all processes of a shared search on this machine, and started again if they are killed.

use std::ffi::OsString;
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use g7_model::say;

use super::process::{Temporary, addresses};
use crate::cli::Prove;
use crate::failure::{Failure, Verdict, plain, raw};
use crate::files;
use crate::message::talk;

/// How often one process is started again.
const AGAIN: usize = 5;
/// The time between two looks at the processes.
const PAUSE: Duration = Duration::from_millis(20);

/// The processes. Those that are left when this goes are ended.
struct Workers {
    command: Vec<OsString>,
    running: Vec<Option<Child>>,
    starts: Vec<usize>,
}

/// Starts the processes, and waits for the end of the first, which prints the answers.
pub(super) fn run(args: &Prove, stop: &dyn Fn() -> bool) -> Result<Verdict, Failure> {
    let shared = &args.shared;
    let own = Temporary::new()?;
    let mut more: Vec<OsString> = vec!["--child".into()];
    let count = match (&shared.hosts, shared.workers) {
        (Some(hosts), Some(_)) => addresses(shared, hosts)?.len(),
        (None, Some(workers)) => {
            let file = own.0.join("hosts");
            files::write(&file, free(workers.into())?.join("\n").as_bytes())?;
            more.extend(["--hosts".into(), file.into_os_string()]);
            workers.into()
        }
        _ => {
            return Err(Failure::Usage(say!(
                "--hosts needs --process with the number of this machine's line, or --workers to start all here"
            )));
        }
    };
    if shared.keep.is_none() {
        more.extend(["--keep".into(), own.0.clone().into_os_string()]);
    }
    let mut workers = Workers { command: command(more), running: Vec::new(), starts: vec![0; count] };
    for number in 0..count {
        let child = workers.start(number)?;
        workers.running.push(Some(child));
    }
    workers.wait(stop)
}

/// This command with more arguments behind the word `prove`.
fn command(more: Vec<OsString>) -> Vec<OsString> {
    let mut all: Vec<OsString> = std::env::args_os().skip(1).collect();
    let at = all.iter().position(|a| a == "prove").map_or(0, |at| at + 1);
    all.splice(at..at, more);
    all
}

/// So many addresses of this machine that are free now.
fn free(count: usize) -> Result<Vec<String>, Failure> {
    let all: std::io::Result<Vec<TcpListener>> =
        (0..count).map(|_| TcpListener::bind("127.0.0.1:0")).collect();
    let address = |l: TcpListener| l.local_addr().map(|a| a.to_string());
    let list = all.and_then(|all| all.into_iter().map(address).collect());
    list.map_err(crate::failure::refused)
}

impl Workers {
    fn start(&mut self, number: usize) -> Result<Child, Failure> {
        self.starts.get_mut(number).into_iter().for_each(|n| *n += 1);
        let program = std::env::current_exe().map_err(crate::failure::refused)?;
        let mut arguments = self.command.clone();
        let at = arguments.iter().position(|a| a == "--child").unwrap_or(0);
        arguments.splice(at..at, ["--process".into(), number.to_string().into()]);
        // The end of its standard input tells a process that this one is gone.
        Command::new(program).args(arguments).stdin(Stdio::piped()).spawn().map_err(crate::failure::refused)
    }

    /// Waits until all processes have ended.
    fn wait(&mut self, stop: &dyn Fn() -> bool) -> Result<Verdict, Failure> {
        let mut verdict = None;
        while self.running.iter().any(Option::is_some) {
            if stop() {
                // They print what is known, and end.
                self.running.iter_mut().flatten().for_each(|c| drop(c.stdin.take()));
            }
            for number in 0..self.running.len() {
                let Some(Some(child)) = self.running.get_mut(number) else { continue };
                let Some(status) = child.try_wait().map_err(crate::failure::refused)? else { continue };
                let end = match status.code() {
                    Some(0) => Verdict::Fine,
                    Some(1) => Verdict::Found,
                    Some(3) => Verdict::Open,
                    Some(2) => return Err(Failure::Usage(say!("process {number} could not go on"))),
                    _ if self.starts.get(number).is_some_and(|n| *n <= AGAIN) && !stop() => {
                        talk!("process {number} has ended ({status}); it is started again");
                        let child = self.start(number)?;
                        if let Some(place) = self.running.get_mut(number) {
                            *place = Some(child);
                        }
                        continue;
                    }
                    _ => {
                        return Err(Failure::Usage(say!(
                            "process {number} has ended ({status})",
                            status = raw(status)
                        )));
                    }
                };
                if number == 0 {
                    verdict = Some(end);
                }
                self.running.get_mut(number).into_iter().for_each(|r| *r = None);
            }
            std::thread::sleep(PAUSE);
        }
        verdict.ok_or_else(|| Failure::Usage(say!("process 0 gave no answers")))
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        for child in self.running.iter_mut().flatten() {
            if let Err(e) = child.kill() {
                talk!("a process cannot be ended: {}", plain(&e));
            }
            // It has ended now.
            let _status = child.wait();
        }
    }
}
