//! Programs that run beside a test and are talked to: the program under test, Modbus slaves and masters
//! of pymodbus.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use snapbox::cmd::cargo_bin;

use super::Folder;

/// A program whose lines are read as they come.
pub(crate) struct Running {
    child: Child,
    stdin: Option<ChildStdin>,
    lines: Receiver<String>,
    seen: Vec<String>,
}

impl Running {
    pub(crate) fn start(
        mut command: Command,
        says: fn(&mut Child) -> Box<dyn std::io::Read + Send>,
    ) -> Running {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("it starts");
        let (give, lines) = channel();
        let out = BufReader::new(says(&mut child));
        // A program that writes much to the other pipe would wait for a reader.
        let (rest, more) = (child.stdout.take(), child.stderr.take());
        std::thread::spawn(move || {
            rest.map(|mut pipe| std::io::copy(&mut pipe, &mut std::io::sink()));
            more.map(|mut pipe| std::io::copy(&mut pipe, &mut std::io::sink()));
        });
        std::thread::spawn(move || out.lines().map_while(Result::ok).try_for_each(|line| give.send(line)));
        let stdin = child.stdin.take();
        Running { child, stdin, lines, seen: Vec::new() }
    }

    /// `g7 run chart.g7 --online` with more arguments.
    pub(crate) fn online(folder: &Folder, args: &[&str]) -> Running {
        Running::g7(folder, &[&["run", "chart.g7", "--online"], args].concat())
    }

    /// The program under test; its events are read.
    pub(crate) fn g7(folder: &Folder, args: &[&str]) -> Running {
        let mut command = Command::new(cargo_bin!("g7"));
        command.args(args).current_dir(folder.root());
        Running::start(command, |child| Box::new(child.stderr.take().expect("piped")))
    }

    /// A script that needs this module of Python; what it prints is read. `None` without the module.
    fn python(module: &str, script: &str, arguments: &[&str]) -> Option<Running> {
        let mut command = Command::new(g7_peers::python(module)?);
        command.arg(g7_peers::script(script)).args(arguments);
        Some(Running::start(command, |child| Box::new(child.stdout.take().expect("piped"))))
    }

    pub(crate) fn say(&mut self, line: &str) {
        let stdin = self.stdin.as_mut().expect("open");
        writeln!(stdin, "{line}").expect("it listens");
    }

    /// The next line.
    pub(crate) fn line(&mut self) -> String {
        match self.lines.recv_timeout(Duration::from_secs(20)) {
            Ok(line) => {
                self.seen.push(line.clone());
                line
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                panic!("no line behind {:#?}", self.seen)
            }
        }
    }

    /// Waits for a line that has this text.
    pub(crate) fn until(&mut self, text: &str) -> String {
        loop {
            let line = self.line();
            if line.contains(text) {
                return line;
            }
        }
    }

    /// Its number in the system.
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// All lines until it ends, those that were read already too.
    pub(crate) fn rest(mut self) -> Vec<String> {
        self.seen.extend(self.lines.iter());
        self.child.wait().expect("it ends");
        std::mem::take(&mut self.seen)
    }

    /// Sends a signal, by name.
    pub(crate) fn signal(&self, name: &str) {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args(["-s", name, &pid]).status().expect("kill is there").success());
    }

    /// Ends it by the command and returns its exit code.
    pub(crate) fn quit(mut self) -> i32 {
        self.say("quit");
        self.child.wait().expect("it ends").code().expect("an exit code")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// A slave of pymodbus.
pub(crate) struct Slave {
    running: Running,
    /// Its port, or its serial line.
    pub(crate) place: String,
}

impl Slave {
    /// With the arguments of the script; `None` without a module of Python.
    pub(crate) fn begin(module: &str, arguments: &[&str]) -> Option<Slave> {
        let mut running = Running::python(module, "modbus_slave.py", arguments)?;
        let place = running.line();
        Some(Slave { running, place })
    }

    /// At a port, or at a free one for 0.
    pub(crate) fn start(port: u16) -> Option<Slave> {
        Slave::begin("pymodbus", &[&port.to_string()])
    }

    /// With a watchdog that clears its coils after so many seconds without a request.
    pub(crate) fn with_watchdog(seconds: &str) -> Option<Slave> {
        Slave::begin("pymodbus", &["0", seconds])
    }

    pub(crate) fn signal(&self, name: &str) {
        self.running.signal(name);
    }

    pub(crate) fn port(&self) -> u16 {
        self.place.parse().expect("a port")
    }

    pub(crate) fn set(&mut self, what: &str) {
        self.running.say(&format!("set {what}"));
        assert_eq!(self.running.line(), "ok");
    }

    pub(crate) fn get(&mut self, what: &str) -> String {
        self.running.say(&format!("get {what}"));
        self.running.line()
    }

    /// Waits until registers or bits have these values.
    pub(crate) fn becomes(&mut self, what: &str, values: &str) {
        let begin = Instant::now();
        let mut found = self.get(what);
        while found != values {
            assert!(begin.elapsed() < Duration::from_secs(20), "{what} is {found}, not {values}");
            std::thread::sleep(Duration::from_millis(10));
            found = self.get(what);
        }
    }
}

/// A master of pymodbus, or a client of asyncua.
pub(crate) struct Master(Running);

impl Master {
    pub(crate) fn start(port: u16) -> Option<Master> {
        let mut running = Running::python("pymodbus", "modbus_master.py", &[&port.to_string()])?;
        assert_eq!(running.line(), "connected");
        Some(Master(running))
    }

    /// A client of OPC UA with an option of its script.
    pub(crate) fn of_opcua(port: u16, option: &str) -> Option<Master> {
        let address = format!("opc.tcp://127.0.0.1:{port}/");
        let mut running = Running::python("asyncua", "opcua_client.py", &[&address, option])?;
        assert_eq!(running.line(), "connected");
        Some(Master(running))
    }

    pub(crate) fn says(&mut self, what: &str) -> String {
        self.0.say(what);
        self.0.line()
    }

    /// Waits until a line has this answer.
    pub(crate) fn until(&mut self, what: &str, answer: &str) {
        let begin = Instant::now();
        let mut found = self.says(what);
        while found != answer {
            assert!(begin.elapsed() < Duration::from_secs(20), "{what}: {found}, not {answer}");
            std::thread::sleep(Duration::from_millis(10));
            found = self.says(what);
        }
    }
}

/// A port of this machine that was free a moment ago.
pub(crate) fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
    listener.local_addr().expect("it has an address").port()
}

/// A controller of Siemens: the server of python-snap7.
pub(crate) struct S7 {
    running: Running,
    /// Its port.
    pub(crate) place: String,
}

impl S7 {
    /// `None` where the machine has no python-snap7.
    pub(crate) fn start() -> Option<S7> {
        let mut running = Running::python("snap7.server", "s7_server.py", &[])?;
        let place = running.line();
        Some(S7 { running, place })
    }

    pub(crate) fn set(&mut self, what: &str) {
        self.running.say(&format!("set {what}"));
        assert_eq!(self.running.line(), "ok");
    }

    /// Waits until bytes have these values.
    pub(crate) fn becomes(&mut self, what: &str, values: &str) {
        let begin = Instant::now();
        loop {
            self.running.say(&format!("get {what}"));
            let found = self.running.line();
            if found == values {
                return;
            }
            assert!(begin.elapsed() < Duration::from_secs(20), "{what} is {found}, not {values}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}
