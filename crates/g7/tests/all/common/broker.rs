//! A broker of MQTT that runs beside a test, with its own clients: mosquitto.

use std::collections::{BTreeMap, BTreeSet};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::Folder;
use super::talk::{Running, free_port};

/// A broker at a port of this machine. Dropping it kills it.
pub(crate) struct Broker {
    child: Child,
    folder: Folder,
    pub(crate) port: u16,
}

impl Broker {
    /// At a free port; `None` where the machine has no mosquitto.
    pub(crate) fn start() -> Option<Broker> {
        Broker::with(own_port(), "allow_anonymous true\n", &[])
    }

    /// At a port, with these lines in its settings and these files beside them.
    pub(crate) fn with(port: u16, settings: &str, files: &[(&str, &str)]) -> Option<Broker> {
        let program = g7_peers::mosquitto()?;
        let folder = Folder::new();
        files.iter().for_each(|(name, text)| folder.write(name, text));
        // As root it would take another user, who may not read the folder.
        let common = format!("listener {port} 127.0.0.1\npersistence false\nuser root\n");
        folder.write("broker.conf", format!("{common}{settings}"));
        let mut command = Command::new(program);
        command.args(["-c", "broker.conf"]).current_dir(folder.root()).stdin(Stdio::null());
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        let broker = Broker { child, folder, port };
        let begin = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(begin.elapsed() < Duration::from_secs(20), "mosquitto does not listen");
            std::thread::sleep(Duration::from_millis(5));
        }
        Some(broker)
    }

    /// Kills it and starts it again; it has forgotten all.
    pub(crate) fn again(self) -> Broker {
        let (port, settings) = (self.port, self.folder.read("broker.conf"));
        let own = settings.lines().skip(3).map(|line| format!("{line}\n")).collect::<String>();
        drop(self);
        Broker::with(port, &own, &[]).expect("it was there before")
    }

    fn client(&self, name: &str, arguments: &[&str]) -> Command {
        // They hold lines back that do not go to a terminal.
        let mut command = Command::new("stdbuf");
        command.args([
            "-oL",
            name,
            "-V",
            "mqttv5",
            "-h",
            "127.0.0.1",
            "-p",
            &self.port.to_string(),
            "-q",
            "1",
        ]);
        command.args(arguments);
        command
    }

    pub(crate) fn publish(&self, topic: &str, payload: &str) {
        self.publish_with(topic, payload, &[]);
    }

    /// With more arguments of `mosquitto_pub`.
    pub(crate) fn publish_with(&self, topic: &str, payload: &str, more: &[&str]) {
        let arguments = [&["-t", topic, "-m", payload], more].concat();
        assert!(self.client("mosquitto_pub", &arguments).status().expect("it starts").success());
    }

    /// Looks at all messages from here on, and at those that are retained.
    pub(crate) fn watch(&self) -> Watch {
        self.watch_with(&[])
    }

    /// With more arguments of `mosquitto_sub`.
    pub(crate) fn watch_with(&self, more: &[&str]) -> Watch {
        let arguments = [&["-t", "#", "-d", "-F", "%t\t%r\t%p"], more].concat();
        let command = self.client("mosquitto_sub", &arguments);
        let mut running = Running::start(command, |child| Box::new(child.stdout.take().expect("piped")));
        running.until("Subscribed");
        Watch { running, last: BTreeMap::new() }
    }

    /// The topics that the broker has a retained message of, each with the message.
    pub(crate) fn retained(&self) -> BTreeMap<String, String> {
        let mut watch = self.watch();
        // It comes behind those that are sent because of the subscription.
        self.publish("end/of/retained", "now");
        watch.becomes("end/of/retained", "now");
        let kept = watch.last.into_iter().filter(|(_, (retained, _))| *retained);
        kept.map(|(topic, (_, payload))| (topic, payload)).collect()
    }
}

/// A free port that no other broker of these tests has had: the system gives a port again as soon as
/// nobody listens there.
pub(crate) fn own_port() -> u16 {
    static USED: Mutex<BTreeSet<u16>> = Mutex::new(BTreeSet::new());
    let mut used = USED.lock().expect("nobody panics here");
    loop {
        let port = free_port();
        if used.insert(port) {
            return port;
        }
    }
}

/// A client that is subscribed to all topics.
pub(crate) struct Watch {
    running: Running,
    /// By topic: true where it was sent because it was retained, and the payload.
    last: BTreeMap<String, (bool, String)>,
}

impl Watch {
    /// Waits for the next message: its topic and payload.
    pub(crate) fn next(&mut self) -> (String, String) {
        loop {
            let line = self.running.line();
            // The lines that the client tells of itself have no tabs.
            if let [topic, retained, payload] = line.splitn(3, '\t').collect::<Vec<_>>()[..] {
                self.last.insert(topic.to_owned(), (retained == "1", payload.to_owned()));
                return (topic.to_owned(), payload.to_owned());
            }
        }
    }

    /// Waits until the last message of a topic is this one.
    pub(crate) fn becomes(&mut self, topic: &str, payload: &str) {
        while self.last.get(topic).is_none_or(|(_, last)| last != payload) {
            self.next();
        }
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}
