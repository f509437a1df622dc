//! `g7 run --online` as a client of a broker: mosquitto, which is killed, refuses and is silent.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use common::Folder;
use common::broker::{Broker, own_port};
use common::talk::Running;

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : REAL
input weight : DINT
input broker_ok : BOOL
output valve : BOOL
output speed : INT safe -1
output sum : LREAL
var presses : INT := 0
var big : UDINT := 4000000000
chart Main {
  initial step 1
  step 2 { N valve  P1 presses := presses + 1  P1 speed := presses + 1  P1 sum := REAL_TO_LREAL(level) + DINT_TO_LREAL(weight) }
  1 -> 2 when go and broker_ok
  2 -> 1 when not go
}
";

/// Many programs run beside each other: no scan is late here.
const PATIENT: &str = "[controller]\nwatchdog = '20s'\n";

/// The rows of the broker but for its port.
const CHANNELS: &str = "\
timeout = '1s'
retry = '300ms'
[inputs]
go = { at = 'hub.topic(plant/go)', bad = false }
level = { at = 'hub.topic(plant/tank)', field = 'level' }
weight = { at = 'hub.topic(plant/tank)', field = '/scale/0', scale = 10 }
broker_ok = 'hub.good()'
[outputs]
valve = 'hub.topic(plant/valve)'
speed = { at = 'hub.topic(plant/speed)', retain = false, qos = 0 }
sum = { at = 'hub.topic(plant/sum)', field = 'value' }
[shown]
X2 = 'hub.topic(plant/step2)'
";

fn io(port: u16, more: &str) -> String {
    format!("{PATIENT}[devices.hub]\nkind = 'mqtt'\nhost = '127.0.0.1'\nport = {port}\n{more}{CHANNELS}")
}

/// A chart that is wired to a broker, with more settings of the broker.
fn folder(port: u16, more: &str) -> Folder {
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", io(port, more));
    folder
}

#[test]
fn a_broker_gives_inputs_and_gets_outputs() {
    let Some(broker) = Broker::start() else { return };
    let mut watch = broker.watch();
    broker.publish_with("plant/tank", r#"{"level":2.5,"scale":[-3]}"#, &["-r"]);
    let folder = folder(broker.port, "status = 'plant/g7'\n");
    let mut g7 = Running::online(&folder, &[]);
    // Retained messages are there at once; nobody has pressed the button yet.
    let line = g7.until("no value");
    assert!(line.contains("`go`: there is no message yet"), "{line}");
    watch.becomes("plant/g7", "online");
    watch.becomes("plant/valve", "FALSE");
    watch.becomes("plant/speed", "0");
    broker.publish("plant/go", "ON");
    g7.until("`go` has a value again");
    watch.becomes("plant/valve", "TRUE");
    watch.becomes("plant/speed", "1");
    watch.becomes("plant/step2", "TRUE");
    // 2.5 + 10 * -3 = -27.5.
    watch.becomes("plant/sum", r#"{"value":-27.5}"#);
    broker.publish("plant/go", "0");
    watch.becomes("plant/valve", "FALSE");
    broker.publish("plant/go", "true");
    watch.becomes("plant/valve", "TRUE");
    watch.becomes("plant/speed", "2");
    let kept = broker.retained();
    let value = |topic: &str| kept.get(topic).map(String::as_str);
    assert_eq!(value("plant/valve"), Some("TRUE"));
    assert_eq!(value("plant/g7"), Some("online"));
    assert_eq!(value("plant/speed"), None, "it says `retain = false`");
    g7.say("stop");
    watch.becomes("plant/valve", "FALSE");
    watch.becomes("plant/speed", "-1");
    g7.say("run");
    watch.becomes("plant/valve", "TRUE");
    assert_eq!(g7.quit(), 0);
    // Outputs are safe, what is shown stays as it was, and the will is not used.
    let kept = broker.retained();
    let value = |topic: &str| kept.get(topic).map(String::as_str);
    assert_eq!(value("plant/valve"), Some("FALSE"));
    assert_eq!(value("plant/step2"), Some("TRUE"));
    assert_eq!(value("plant/g7"), Some("offline"));
    watch.becomes("plant/speed", "-1");
}

#[test]
fn a_message_that_is_no_value_is_bad_and_told_once() {
    let Some(broker) = Broker::start() else { return };
    let folder = folder(broker.port, "");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("`weight`: there is no message yet");
    broker.publish("plant/tank", r#"{"level":"2.5"}"#);
    g7.until("`level` has a value again");
    broker.publish("plant/tank", r#"{"scale":[1e99],"level":true}"#);
    g7.until("no value for `level`: \"true\" is no value of the variable");
    // Beyond a DINT: told only where it is another state than before.
    broker.publish("plant/tank", "{");
    broker.publish("plant/tank", "\u{1}");
    broker.publish("plant/go", "perhaps");
    broker.publish("plant/tank", r#"{"level":1,"scale":[2]}"#);
    let mut lines = vec![g7.line()];
    while !lines.iter().any(|l| l.contains("`weight` has a value again")) {
        lines.push(g7.line());
    }
    assert!(!lines.iter().any(|l| l.contains("no value for")), "{lines:#?}");
    assert_eq!(g7.quit(), 0);
}

#[test]
fn a_broker_that_was_killed_is_found_again() {
    let Some(mut broker) = Broker::start() else { return };
    let folder = folder(broker.port, "");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    for presses in ["1", "2", "3"] {
        let mut watch = broker.watch();
        broker.publish("plant/go", "1");
        watch.becomes("plant/valve", "TRUE");
        watch.becomes("plant/speed", presses);
        broker = broker.again();
        g7.until("hub does not answer");
        g7.until("hub answers");
        // An old message is no message of this connection.
        g7.until("no value for `go`: there is no message yet");
        // The broker has forgotten all: each output is published anew, and the button counts as
        // released until somebody says otherwise.
        let mut watch = broker.watch();
        watch.becomes("plant/valve", "FALSE");
        watch.becomes("plant/sum", r#"{"value":0}"#);
    }
    assert_eq!(g7.quit(), 0);
}

#[test]
fn a_program_that_is_killed_leaves_its_will() {
    let Some(broker) = Broker::start() else { return };
    let folder = folder(broker.port, "");
    let wired = io(broker.port, "").replace("topic(plant/valve)'", "topic(plant/valve)', will = true }");
    folder.write("chart.io.toml", wired.replace("valve = '", "valve = { at = '"));
    let mut watch = broker.watch();
    let g7 = Running::online(&folder, &[]);
    watch.becomes("plant/valve", "FALSE");
    broker.publish("plant/go", "1");
    watch.becomes("plant/valve", "TRUE");
    drop(g7);
    watch.becomes("plant/valve", "FALSE");
    assert_eq!(broker.retained().get("plant/valve").map(String::as_str), Some("FALSE"));

    folder.write("chart.io.toml", io(broker.port, "status = 'plant/g7'\n"));
    let g7 = Running::online(&folder, &[]);
    watch.becomes("plant/g7", "online");
    drop(g7);
    watch.becomes("plant/g7", "offline");
}

#[test]
fn a_topic_that_is_silent_is_bad() {
    let Some(broker) = Broker::start() else { return };
    let folder = folder(broker.port, "");
    folder
        .write("chart.io.toml", io(broker.port, "").replace("bad = false", "bad = false, silence = '400ms'"));
    let mut watch = broker.watch();
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    broker.publish("plant/go", "1");
    watch.becomes("plant/valve", "TRUE");
    g7.until("no value for `go`: no message for 400ms");
    watch.becomes("plant/valve", "FALSE");
    broker.publish("plant/go", "1");
    g7.until("`go` has a value again");
    assert_eq!(g7.quit(), 0);
}

#[test]
fn users_and_topics_that_a_broker_refuses_are_told() {
    let passwords = Folder::new();
    let Some(mosquitto) = g7_peers::mosquitto() else { return };
    drop(mosquitto);
    let made = std::process::Command::new("mosquitto_passwd")
        .args(["-b", "-c", "users", "g7", "sesame"])
        .current_dir(passwords.root())
        .status();
    assert!(made.expect("it comes with mosquitto").success());
    let users = passwords.read("users");
    let rules = "user g7\ntopic readwrite plant/#\ntopic deny plant/valve\ntopic deny plant/go\n";
    let settings = "password_file users\nacl_file rules\n";
    let files = [("users", users.as_str()), ("rules", rules)];
    let broker = Broker::with(own_port(), settings, &files).expect("it is there");
    let folder = folder(broker.port, "user = 'g7'\npassword-file = 'secret'\n");
    folder.g7(&["run", "--online", "--for", "100ms"]).is(1);
    let none = folder.g7(&["run", "--online", "--for", "100ms"]);
    for part in ["chart.io.toml:8:17", "the password cannot be read", "secret", "G0701"] {
        assert!(none.err.contains(part), "{part}: {}", none.err);
    }
    folder.write("secret", "sesam\n");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub does not answer: the broker");
    g7.quit();
    folder.write("secret", "sesame\n");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    g7.until("hub refuses `valve`: the broker does not allow its topic");
    assert_eq!(g7.quit(), 0);
    // A variable of the environment, and no trace of the password in what is told.
    folder.write("chart.io.toml", io(broker.port, "user = 'g7'\npassword-env = 'HUB_PASSWORD'\n"));
    let refused = folder.g7(&["devices"]);
    assert!(refused.is(1).err.contains("no variable HUB_PASSWORD"), "{}", refused.err);
    let asked: common::Ran = folder.command(&["devices"]).env("HUB_PASSWORD", "sesame").assert().into();
    assert!(asked.out.contains("hub 127.0.0.1:"), "{}", asked.out);
    assert!(asked.out.contains("answers"), "{}", asked.out);
    assert!(!asked.out.contains("sesame") && !asked.err.contains("sesame"));
}

#[test]
fn devices_says_what_a_broker_has() {
    let Some(broker) = Broker::start() else { return };
    let folder = folder(broker.port, "client-id = 'line 1'\nstatus = 'plant/g7'\n");
    broker.publish_with("plant/tank", r#"{"level":2.5,"scale":[-3]}"#, &["-r"]);
    broker.publish_with("plant/speed", "7", &["-r"]);
    broker.publish_with("plant/sum", "seven", &["-r"]);
    let asked = folder.g7(&["devices"]);
    let lines: Vec<&str> = asked.is(1).out.lines().collect();
    assert!(lines[0].starts_with(&format!("hub 127.0.0.1:{} answers in ", broker.port)), "{}", asked.out);
    let expected = [
        "  go      topic(plant/go)             no message",
        "  level   topic(plant/tank) level     2.5",
        "  weight  topic(plant/tank) /scale/0  -30 (from -3)",
        "  valve   topic(plant/valve)          no message",
        "  speed   topic(plant/speed)          7",
        "  sum     topic(plant/sum) value      \"seven\" is no JSON",
        "  X2      topic(plant/step2)          no message",
    ];
    assert_eq!(lines[1..], expected);
    // It leaves nothing behind, and does not take the place of the controller.
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    // By now the controller has published a value in place of the wrong one.
    folder.g7(&["devices"]).is(0);
    g7.say("status");
    // The connection is there still.
    while let line = g7.line()
        && !line.contains("running")
    {
        assert!(!line.contains("does not answer"), "{line}");
    }
    assert_eq!(g7.quit(), 0);
    drop(broker);
    let gone = folder.g7(&["devices"]);
    assert!(gone.is(1).out.contains("does not answer"), "{}", gone.out);
}

#[test]
fn the_last_value_arrives_however_often_the_broker_is_killed() {
    let Some(mut broker) = Broker::start() else { return };
    let folder = Folder::with(
        "profile iec60848\noutput count : UDINT\noutput fast : BOOL\n\
         chart Main {\n  initial step 1 { N fast  P1 count := count + 1 }\n  step 2 { P1 count := count + 1 }\n\
         1 -> 2 when 4ms/X1\n  2 -> 1 when 4ms/X2\n}\n",
    );
    let io = |port| {
        format!(
            "{PATIENT}period = '2ms'\n[devices.hub]\nkind = 'mqtt'\nhost = '127.0.0.1'\nport = {port}\nretry = '50ms'\npoll = '1ms'\n\
             [outputs]\ncount = 'hub.topic(n)'\nfast = 'hub.topic(fast)'\n"
        )
    };
    folder.write("chart.io.toml", io(broker.port));
    let mut g7 = Running::online(&folder, &[]);
    let mut before = 0;
    for _ in 0..20 {
        let mut watch = broker.watch();
        // Values come, they never go back, and those of this broker are new.
        for _ in 0..20 {
            let (topic, payload) = watch.next();
            if topic == "n" {
                let n: u64 = payload.parse().expect("a number");
                assert!(n >= before, "{n} behind {before}");
                before = n;
            }
        }
        broker = broker.again();
    }
    let mut watch = broker.watch();
    watch.next();
    g7.say("stop");
    watch.becomes("n", "0");
    watch.becomes("fast", "FALSE");
    assert_eq!(g7.quit(), 0);
}

/// The io file of an edge node: of a device, or of the node alone.
fn node(port: u16, device: &str) -> String {
    format!(
        "{PATIENT}[devices.scada]\nkind = 'mqtt'\nhost = '127.0.0.1'\nport = {port}\nretry = '300ms'\n\
         sparkplug = {{ group = 'plant', node = 'sorter'{device} }}\n\
         [inputs]\ngo = {{ at = 'scada.metric()', bad = false }}\nlevel = 'scada.metric(Tank/Level)'\n\
         weight = 'scada.metric()'\nbroker_ok = 'scada.good()'\n\
         [outputs]\nvalve = 'scada.metric()'\nspeed = 'scada.metric()'\nsum = 'scada.metric(Tank/Sum)'\n\
         [shown]\nX2 = 'scada.metric(Step2)'\nbig = 'scada.metric()'\n"
    )
}

/// A program that plays a host: it sees what a node publishes, and commands it.
#[derive(Clone, Copy)]
enum Host {
    /// pysparkplug.
    Python,
    /// The library of Eclipse Tahu for Node.
    Tahu,
}

impl Host {
    fn command(self) -> Option<std::process::Command> {
        match self {
            Host::Python => {
                let mut command = std::process::Command::new(g7_peers::python("pysparkplug")?);
                command.arg(g7_peers::script("sparkplug_host.py"));
                Some(command)
            }
            Host::Tahu => g7_peers::node("sparkplug-payload", "sparkplug_host.cjs"),
        }
    }

    fn start(self, port: u16) -> Option<Running> {
        let mut command = self.command()?;
        command.args([&port.to_string(), "plant", "sorter"]);
        let mut host = Running::start(command, |child| Box::new(child.stdout.take().expect("piped")));
        assert_eq!(host.line(), "ready");
        Some(host)
    }
}

/// Waits for a line of the host that begins and goes on so; none is a gap.
fn told(host: &mut Running, kind: &str, parts: &[&str]) -> String {
    loop {
        let line = host.line();
        assert_ne!(line, "GAP", "a number of the sequence is missing");
        if line.starts_with(kind) && parts.iter().all(|part| line.contains(part)) {
            return line;
        }
    }
}

#[test]
fn a_host_of_pysparkplug_drives_and_watches_a_device() {
    drives_and_watches_a_device(Host::Python);
}

#[test]
fn a_host_of_tahu_drives_and_watches_a_device() {
    drives_and_watches_a_device(Host::Tahu);
}

fn drives_and_watches_a_device(peer: Host) {
    let Some(broker) = Broker::start() else { return };
    let Some(mut host) = peer.start(broker.port) else { return };
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", node(broker.port, ", device = 'plc'"));
    let mut g7 = Running::online(&folder, &[]);
    // Births have quality of service 0, are not retained, and number from 0.
    told(&mut host, "NBIRTH 0 0 0 ", &["bdSeq=0", "Node Control/Rebirth=False"]);
    let all = [
        "valve=False",
        "speed=-1",
        "Tank/Sum=0.0",
        "Step2=False",
        "big=4000000000",
        "go=None",
        "Tank/Level=None",
    ];
    told(&mut host, "DBIRTH 0 0 1 ", &all);
    // Commands by name and by alias; each is told back as data.
    host.say("name DCMD Tank/Level FLOAT 2.5");
    told(&mut host, "DDATA 0 0 ", &["Tank/Level=2.5"]);
    host.say("alias DCMD weight INT32 -3");
    told(&mut host, "DDATA 0 0 ", &["weight=-3"]);
    host.say("alias DCMD go BOOLEAN True");
    told(&mut host, "DDATA", &["valve=True"]);
    // An output is no metric that a host writes; nor is one that nobody knows a fault.
    host.say("name DCMD valve BOOLEAN False");
    host.say("alias DCMD go BOOLEAN False");
    told(&mut host, "DDATA", &["valve=False"]);
    g7.say("stop");
    told(&mut host, "DDATA", &["speed=-1"]);
    assert_eq!(g7.quit(), 0);
    told(&mut host, "NDEATH 1 0 - ", &["bdSeq=0"]);
}

#[test]
fn a_node_is_born_again_for_pysparkplug() {
    is_born_again(Host::Python);
}

#[test]
fn a_node_is_born_again_for_tahu() {
    is_born_again(Host::Tahu);
}

fn is_born_again(peer: Host) {
    let Some(broker) = Broker::start() else { return };
    let Some(mut host) = peer.start(broker.port) else { return };
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", node(broker.port, ""));
    let mut g7 = Running::online(&folder, &[]);
    // Without a device the metrics are those of the node.
    told(&mut host, "NBIRTH 0 0 0 ", &["bdSeq=0", "valve=False", "go=None"]);
    host.say("name NCMD weight INT32 7");
    told(&mut host, "NDATA", &["weight=7"]);
    host.say("name NCMD Node_Control/Rebirth BOOLEAN True");
    told(&mut host, "NBIRTH 0 0 0 ", &["bdSeq=0", "weight=7"]);
    // The numbers go round: 300 changes, one after the other.
    for n in 0..300 {
        host.say(&format!("name NCMD weight INT32 {n}"));
        told(&mut host, "NDATA", &[&format!("weight={n}")]);
    }
    drop(host);
    let broker = broker.again();
    g7.until("scada does not answer");
    g7.until("scada answers");
    let mut host = peer.start(broker.port).expect("it was there before");
    broker.publish_with("spBv1.0/plant/NCMD/sorter", "no protocol buffer", &[]);
    // The will is that of this connection.
    drop(g7);
    let death = told(&mut host, "NDEATH 1 0 - ", &[]);
    assert!(!death.contains("bdSeq=0"), "{death}");
    drop(broker);
}
