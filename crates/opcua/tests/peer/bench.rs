//! A controller with its threads, programs of asyncua beside it, and a folder for both.

use std::collections::VecDeque;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command as Program, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use g7_model::{FileId, Nanos};
use g7_online::setup::{self, Origin};
use g7_online::{Clients, Command, Happened, Options, RealDisk, Running, Wiring};
use g7_opcua::OpcUa;
use g7_rig::{Bench, Source};
use g7_store::users::Users;

/// Longer than anything takes that does not hang.
const PATIENCE: Duration = Duration::from_secs(60);

/// A folder that is deleted after the test.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Folder {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("g7-opcua-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder for the test");
        Folder(path)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a file for the test");
    }

    /// The file of the users.
    pub(crate) fn users(&self) -> Users {
        Users::open(&self.path("users")).expect("a file of users")
    }

    /// The names in a folder of it, sorted.
    pub(crate) fn names(&self, part: &str) -> Vec<String> {
        let list: Vec<fs::DirEntry> =
            fs::read_dir(self.path(part)).map(|list| list.flatten().collect()).unwrap_or_default();
        let mut names: Vec<String> =
            list.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Moves the only file of `rejected` to `trusted`.
    pub(crate) fn trust(&self, certificates: &str) {
        let names = self.names(&format!("{certificates}/rejected"));
        let [name] = &names[..] else { panic!("one rejected certificate: {names:?}") };
        let from = self.path(&format!("{certificates}/rejected/{name}"));
        fs::rename(from, self.path(&format!("{certificates}/trusted/{name}"))).expect("it is moved");
    }

    /// A certificate with its key, valid since so many days and for so many.
    pub(crate) fn certificate(&self, python: &Path, name: &str, since: i32, until: i32) -> (String, String) {
        let [cert, key] = ["der", "pem"].map(|end| self.path(&format!("{name}.{end}")).display().to_string());
        let made = Program::new(python)
            .arg(g7_peers::script("certificate.py"))
            .args([&cert, &key, name, &since.to_string(), &until.to_string()])
            .status();
        assert!(made.expect("it starts").success());
        (cert, key)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

/// A program of asyncua that is talked to.
pub(crate) struct Peer {
    child: Child,
    stdin: ChildStdin,
    lines: Receiver<String>,
}

impl Peer {
    fn start(python: &Path, script: &str, arguments: &[&str]) -> Peer {
        let mut child = Program::new(python)
            .arg(g7_peers::script(script))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .expect("it starts");
        let out = BufReader::new(child.stdout.take().expect("piped"));
        let (give, lines) = channel();
        std::thread::spawn(move || out.lines().map_while(Result::ok).try_for_each(|line| give.send(line)));
        let stdin = child.stdin.take().expect("piped");
        Peer { child, stdin, lines }
    }

    pub(crate) fn line(&mut self) -> String {
        self.lines.recv_timeout(PATIENCE).expect("a line")
    }

    /// Says a line and returns the answer.
    pub(crate) fn says(&mut self, what: &str) -> String {
        writeln!(self.stdin, "{what}").expect("it listens");
        self.line()
    }

    /// Waits until a line has this answer.
    pub(crate) fn until(&mut self, what: &str, answer: &str) {
        let begin = Instant::now();
        let mut found = self.says(what);
        while found != answer {
            assert!(begin.elapsed() < PATIENCE, "{what}: {found}, not {answer}");
            std::thread::sleep(Duration::from_millis(20));
            found = self.says(what);
        }
    }

    pub(crate) fn signal(&self, name: &str) {
        let pid = self.child.id().to_string();
        assert!(Program::new("kill").args(["-s", name, &pid]).status().expect("kill is there").success());
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// A server of asyncua and its port.
pub(crate) fn server(python: &Path, port: u16, options: &[&str]) -> (Peer, u16) {
    let port = port.to_string();
    let mut peer = Peer::start(python, "opcua_server.py", &[&[port.as_str()], options].concat());
    let port = peer.line().parse().expect("its port");
    (peer, port)
}

/// A client of asyncua, or the name of the status with which it was refused.
pub(crate) fn client(python: &Path, port: u16, options: &[&str]) -> Result<Peer, String> {
    let address = format!("opc.tcp://127.0.0.1:{port}/");
    let mut peer = Peer::start(python, "opcua_client.py", &[&[address.as_str()], options].concat());
    match peer.line().strip_prefix("refused ") {
        None => Ok(peer),
        Some(status) => Err(status.to_owned()),
    }
}

pub(crate) fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
    listener.local_addr().expect("it has an address").port()
}

/// Reads a chart and its io file; the messages of all problems where there are some.
pub(crate) fn wired(folder: &Folder, chart: &str, io: &str) -> Result<(Bench, Wiring), Vec<String>> {
    let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
    let (bench, problems) = g7_rig::build(&source, &g7_rig::Options::default()).expect("a chart");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let (mut setup, mut problems) = setup::read(io, FileId(1));
    setup::settle(&mut setup, &folder.0);
    problems.extend(setup::read_secrets(&mut setup, |origin| match origin {
        Origin::File(name) => fs::read(folder.path(name)).map_err(|e| g7_model::Said::foreign(e.to_string())),
        Origin::Variable(name) => Err(g7_model::Said::foreign(format!("no {name}"))),
    }));
    let (wiring, more) = g7_online::wire(&bench, &setup);
    problems.extend(more);
    let said =
        |p: &g7_model::Problem| format!("{} {}; {}", p.code.id, p.what, p.help.clone().unwrap_or_default());
    if problems.is_empty() { Ok((bench, wiring)) } else { Err(problems.iter().map(said).collect()) }
}

/// A controller that runs.
pub(crate) struct Machine {
    running: Running,
    wiring: Wiring,
    waiting: VecDeque<String>,
    seen: Vec<String>,
}

impl Machine {
    pub(crate) fn start(folder: &Folder, chart: &str, io: &str) -> Machine {
        let (bench, wiring) = wired(folder, chart, io).expect("no problem");
        let users = folder.path("users").is_file().then(|| Arc::new(folder.users()));
        let mut clients = Clients::default().with(OpcUa { users });
        let runner = g7_online::runner(&bench, &wiring, 0);
        let machine = g7_online::assemble(runner, &wiring, |wired| clients.device(wired)).expect("devices");
        let options = Options { watchdog: Nanos::MINUTE, priority: None };
        let mut running = g7_online::start::<RealDisk>(machine, None, options).expect("threads");
        running.command(Command::Run);
        Machine { running, wiring, waiting: VecDeque::new(), seen: Vec::new() }
    }

    pub(crate) fn command(&mut self, command: Command) {
        self.running.command(command);
    }

    /// Waits for an event of a device that has this text.
    pub(crate) fn until(&mut self, text: &str) -> String {
        loop {
            let line = match self.waiting.pop_front() {
                Some(line) => line,
                None => {
                    let event = self.running.devices.recv_timeout(PATIENCE);
                    let event = event.unwrap_or_else(|_| panic!("no `{text}` behind {:#?}", self.seen));
                    self.shown(event.device, &event.happened)
                }
            };
            self.seen.push(line.clone());
            if line.contains(text) {
                return line;
            }
        }
    }

    fn shown(&self, device: usize, happened: &Happened) -> String {
        let wired = &self.wiring.devices[device];
        let name = &wired.device.name.value;
        match happened {
            Happened::Up => format!("{name} up"),
            Happened::Down(why) => format!("{name} down: {why}"),
            Happened::NoInput(k, why) => format!("{name} no {}: {why}", wired.inputs[*k].name),
            Happened::Input(k) => format!("{name} has {}", wired.inputs[*k].name),
            Happened::NoOutput(k, why) => format!("{name} refuses {}: {why}", wired.outputs[*k].name),
            Happened::Output(k) => format!("{name} takes {}", wired.outputs[*k].name),
            Happened::Limited(k) => format!("{name} limits {}", wired.outputs[*k].name),
            Happened::Note(what) => format!("{name} note: {what}"),
            Happened::Written(k, word, who) => {
                format!("{name} sets {} {word} {who:?}", wired.inputs[*k].name)
            }
        }
    }
}
