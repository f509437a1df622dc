//! OPC UA beside asyncua, which is not ours: as the server of G7, and as its client.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

#[path = "peer/bench.rs"]
mod bench;

use std::time::{Duration, Instant};

use bench::{Folder, Machine, client, free_port, server, wired};
use g7_online::Command;

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : REAL
input count : INT
input seven : INT
input there : BOOL
output valve : BOOL
output speed : INT \"of the belt\" safe -1
output flow : LREAL
output small : INT
output fixed : BOOL
var presses : INT := 0
chart Main {
  initial step 1 \"waiting\"
  step 2 { N valve N fixed P1 presses := presses + 1  P1 speed := count + seven  P1 flow := REAL_TO_LREAL(level)  P1 small := count }
  1 -> 2 when go
  2 -> 1 when not go
}
";

/// The row of a server of asyncua.
fn row(port: u16, more: &str) -> String {
    format!(
        "[devices.line]\nkind = 'opc-ua'\nurl = 'opc.tcp://127.0.0.1:{port}/peer'\ntimeout = '20s'\nretry = '300ms'\n\
         interval = '50ms'\nkeep-alive = '500ms'\ncertificates = 'pki'\n{more}\n"
    )
}

const INPUTS: &str = "\
[inputs]
go = { at = 'line.node(nsu=urn:g7:peer;s=Go)', bad = false }
level = { at = 'line.node(ns=1;s=Level)', scale = 10 }
count = 'line.node(nsu=urn:g7:peer;s=Count)'
seven = 'line.node(nsu=urn:g7:peer;i=7)'
there = 'line.good()'
";

const OUTPUTS: &str = "\
[outputs]
valve = 'line.node(nsu=urn:g7:peer;s=Valve)'
speed = 'line.node(nsu=urn:g7:peer;s=Speed)'
flow = 'line.node(nsu=urn:g7:peer;s=Flow)'
small = 'line.node(nsu=urn:g7:peer;s=Small)'
";

#[test]
fn a_server_of_asyncua_is_driven_lost_and_found() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (mut peer, port) = server(&python, 0, &[]);
    let io = row(port, "security = 'none'") + INPUTS + OUTPUTS;
    let mut machine = Machine::start(&folder, CHART, &io);
    machine.until("line up");
    peer.until("get Speed", "-1");
    peer.says("set Count 300");
    peer.says("set Level 2.5");
    peer.says("set Go true");
    peer.until("get Valve", "true");
    // 300 + 7; 10 times 2.5.
    peer.until("get Speed", "307");
    peer.until("get Flow", "25.0");
    // 300 is no Byte: refused, and nothing else is.
    let line = machine.until("refuses small");
    assert!(line.contains("300") && line.contains("Byte"), "{line}");

    // What the server doubts is bad, by its name, and so the button counts as released.
    peer.says("set Go true UncertainLastUsableValue");
    assert!(machine.until("no go").contains("UncertainLastUsableValue"));
    peer.until("get Valve", "false");
    peer.says("set Go true");
    machine.until("has go");
    peer.until("get Valve", "true");
    machine.command(Command::Stop);
    peer.until("get Valve", "false");
    peer.until("get Speed", "-1");
    machine.command(Command::Run);

    // Fault: the server is killed and started, again and again.
    let many = std::env::var_os("G7_FAULTS").is_some_and(|faults| faults == "many");
    let (mut bad, mut back) = (Vec::new(), Vec::new());
    for _ in 0..if many { 50 } else { 2 } {
        let begin = Instant::now();
        drop(peer);
        machine.until("line down");
        bad.push(begin.elapsed());
        peer = server(&python, port, &[]).0;
        let begin = Instant::now();
        // It has forgotten all, so the button is up; it gets each output, and each change comes.
        machine.until("line up");
        peer.says("set Go true");
        peer.until("get Valve", "true");
        peer.says("set Go false");
        peer.until("get Valve", "false");
        back.push(begin.elapsed());
    }
    told("server killed to bad inputs", &mut bad);
    told("server started to the second change", &mut back);

    // Fault: it stands still. The connection is there, and no sign of life comes.
    let mut bad = Vec::new();
    for _ in 0..if many { 50 } else { 1 } {
        peer.signal("STOP");
        let begin = Instant::now();
        let line = machine.until("line down");
        bad.push(begin.elapsed());
        assert!(line.contains("no sign of life") || line.contains("answer"), "{line}");
        peer.signal("CONT");
        machine.until("line up");
    }
    told("server silent to bad inputs (keep-alive 500 ms)", &mut bad);
    peer.says("set Go true");
    peer.until("get Valve", "true");
}

/// Prints how long something took.
fn told(what: &str, times: &mut [Duration]) {
    times.sort();
    let of = |part: usize| times.get(times.len() * part / 100).or(times.last()).copied().unwrap_or_default();
    println!("{what}: {} times, half {:.1?}, most {:.1?}", times.len(), of(50), of(100));
}

#[test]
fn what_a_node_cannot_carry_is_refused_with_both_types() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (peer, port) = server(&python, 0, &[]);
    let io = row(port, "security = 'none'")
        + "[inputs]\ngo = 'line.node(ns=1;s=Count)'\nlevel = 'line.node(ns=1;s=Text)'\n\
           count = 'line.node(nsu=urn:nobody;s=Count)'\nseven = 'line.node(ns=1;s=Nothing)'\n\
           [outputs]\nvalve = 'line.node(ns=1;s=Speed)'\nflow = 'line.node(ns=1;s=Count)'\n\
           fixed = 'line.node(ns=1;s=Fixed)'\n";
    let mut machine = Machine::start(&folder, CHART, &io);
    let mut lines: Vec<String> = (0..7).map(|_| machine.until("line ")).collect();
    lines.retain(|line| line != "line up");
    lines.push(machine.until("line "));
    let all = lines.join("\n");
    for (what, parts) in [
        ("no go", ["Int16", "BOOL"]),
        ("no level", ["String", "REAL"]),
        ("no count", ["no namespace", "urn:nobody"]),
        ("no seven", ["no such node", "BadNodeIdUnknown"]),
        ("refuses valve", ["Int32", "BOOL"]),
        ("refuses flow", ["Int16", "LREAL"]),
        ("refuses fixed", ["Fixed", ""]),
    ] {
        let found = lines.iter().find(|line| line.contains(what)).unwrap_or_else(|| panic!("{what}: {all}"));
        let named = parts.iter().all(|part| found.contains(part)) || what == "refuses fixed";
        assert!(named, "{found}");
    }
    drop((machine, peer));
}

#[test]
fn an_unknown_server_and_a_wrong_password_are_refused() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (cert, key) = folder.certificate(&python, "peer", 1, 30);
    let options = [format!("certificate={cert}"), format!("key={key}"), "users".to_owned()];
    let options: Vec<&str> = options.iter().map(String::as_str).collect();
    let (mut peer, port) = server(&python, 0, &options);
    folder.write("right", "secret\n");
    folder.write("wrong", "guess\n");
    let io = |password: &str| {
        row(port, &format!("user = 'anna'\npassword-file = '{password}'")) + INPUTS + OUTPUTS
    };
    let mut machine = Machine::start(&folder, CHART, &io("wrong"));
    let line = machine.until("line down");
    assert!(line.contains("certificate is unknown") && line.contains("peer ["), "{line}");
    // It was put aside; a person moves it.
    let names = folder.names("pki/rejected");
    assert!(line.contains(names[0].as_str()), "{line} {names:?}");
    folder.trust("pki");
    drop(machine);
    let mut machine = Machine::start(&folder, CHART, &io("wrong"));
    let line = machine.until("line down");
    assert!(line.contains("the user") && line.contains("password"), "{line}");
    drop(machine);
    let mut machine = Machine::start(&folder, CHART, &io("right"));
    machine.until("line up");
    peer.says("set Go true");
    peer.until("get Valve", "true");
    drop((machine, peer));
    // Without a password there is nobody, and what the server does not offer is told with what it does.
    let (_peer, port) = server(&python, 0, &options);
    let mut machine = Machine::start(&folder, CHART, &(row(port, "") + INPUTS));
    assert!(machine.until("line down").contains("refuses"));
    drop(machine);
    let mut machine = Machine::start(&folder, CHART, &(row(port, "security = 'none'") + INPUTS));
    let line = machine.until("line down");
    assert!(line.contains("does not offer None") && line.contains("Basic256Sha256 SignAndEncrypt"), "{line}");
}

#[test]
fn an_expired_certificate_is_refused() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (cert, key) = folder.certificate(&python, "old", 30, -1);
    let (_peer, port) = server(&python, 0, &[&format!("certificate={cert}"), &format!("key={key}")]);
    std::fs::create_dir_all(folder.path("pki/trusted")).expect("a folder");
    // A person may give it any name.
    std::fs::copy(&cert, folder.path("pki/trusted/server.der")).expect("it is trusted");
    let mut machine = Machine::start(&folder, CHART, &(row(port, "") + INPUTS));
    let line = machine.until("line down");
    assert!(line.contains("old [") && line.contains("not today"), "{line}");
}

/// An io file with a server alone.
fn served(port: u16, more: &str) -> String {
    format!(
        "[devices.scada]\nkind = 'opc-ua-server'\nlisten = '127.0.0.1:{port}'\ncertificates = 'pki'\n{more}\n\
         [devices.scada.users]\nanna = {{ role = 'operator', password-file = 'anna' }}\n\
         view = {{ role = 'viewer', password-file = 'view' }}\n\
         [inputs]\ngo = {{ at = 'scada.node()', bad = false }}\ncount = 'scada.node(Count)'\nthere = 'scada.good()'\n\
         [outputs]\nvalve = 'scada.node()'\nspeed = 'scada.node()'\n\
         [shown]\nX2 = 'scada.node()'\nflow = {{ at = 'scada.node(Flow)', unit = 'm3/h' }}\n"
    )
}

fn users(folder: &Folder) {
    folder.write("anna", "secret");
    folder.write("view", "look");
}

#[test]
fn a_client_of_asyncua_reads_and_writes_by_its_role() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    users(&folder);
    let io = served(port, "security = 'none'\nanonymous = 'read'\nexpose = 'all'")
        + "[devices.gone]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = 1\n[inputs]\n";
    let io = io.replace("[inputs]\n[devices", "[devices").trim_end_matches("[inputs]\n").to_owned();
    let io = io.replace("there = 'scada.good()'", "there = 'scada.good()'\nlevel = { at = 'gone.input(0)', as = 'f32', bad = 1.5 }\nseven = 'gone.input(4)'");
    let mut machine = Machine::start(&folder, CHART, &io);
    assert!(machine.until("scada down").contains("no client"));

    let mut anybody = client(&python, port, &[]).expect("who has no user may read");
    anybody.until("read X1", "true Good");
    machine.until("scada up");
    // An input that nobody has written; one whose device is gone, with a substitute, and one without.
    assert_eq!(anybody.says("read Count"), "null BadWaitingForInitialData");
    anybody.until("read level", "1.5 UncertainSubstituteValue");
    assert_eq!(anybody.says("read seven"), "0 BadWaitingForInitialData");
    assert_eq!(anybody.says("about speed"), "Int16 of the belt");
    assert_eq!(anybody.says("about X1.T"), "Duration waiting");
    assert_eq!(anybody.says("about Flow"), "Double - m3/h");
    let all = anybody.says("browse");
    let folders = [
        "Inputs: Count, go, level, seven, there",
        "Outputs: Flow, fixed, small, speed, valve",
        "Steps: X1, X1.T, X2, X2.T",
        "Variables: presses",
    ];
    for part in folders {
        assert!(all.contains(part), "{part} in {all}");
    }
    assert_eq!(anybody.says("write go Boolean true"), "refused BadUserAccessDenied");

    let mut viewer = client(&python, port, &["user=view:look"]).expect("the password is right");
    assert_eq!(viewer.says("write go Boolean true"), "refused BadUserAccessDenied");
    for (user, why) in [("anna:guess", "an operator"), ("nobody:secret", "nobody")] {
        let refused = client(&python, port, &[&format!("user={user}")]).err();
        assert_eq!(refused.as_deref(), Some("BadUserAccessDenied"), "{why}");
    }
    assert!(machine.until("note").contains("\"anna\": unknown, or another password"));

    let mut anna = client(&python, port, &["user=anna:secret"]).expect("the password is right");
    assert_eq!(anna.says("write Count Int16 5"), "ok");
    assert_eq!(anna.says("write go Boolean true"), "ok");
    anna.until("read X2", "true Good");
    anna.until("read valve", "true Good");
    anna.until("read speed", "5 Good");
    assert_eq!(anna.says("read Count"), "5 Good");
    // Wrong types and what is not a client's.
    for (what, status) in [
        ("write Count Int32 5", "BadTypeMismatch"),
        ("write go Int16 1", "BadTypeMismatch"),
        ("write valve Boolean false", "BadNotWritable"),
        ("write presses Int16 9", "BadNotWritable"),
        ("write Nothing Int16 9", "BadNodeIdUnknown"),
    ] {
        let said = anna.says(what);
        assert!(
            said == format!("refused {status}")
                || said == "refused BadUserAccessDenied" && status == "BadNotWritable",
            "{what}: {said}"
        );
    }
    assert_eq!(anybody.says("watch X2"), "ok");
    assert_eq!(anybody.line(), "change X2 true Good");
    // Without its client a command is none: the button is released.
    drop(anna);
    assert_eq!(anybody.line(), "change X2 false Good");
    assert_eq!(anybody.says("read go"), "null BadWaitingForInitialData");
    machine.command(Command::Stop);
    anybody.until("read speed", "-1 Good");
}

#[test]
fn an_unknown_or_expired_client_is_refused_and_put_aside() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    users(&folder);
    let mut machine = Machine::start(&folder, CHART, &served(port, ""));
    machine.until("scada down");
    let options = |(cert, key): &(String, String)| {
        [format!("certificate={cert}"), format!("key={key}"), "user=anna:secret".to_owned()]
    };
    let (good, old) =
        (folder.certificate(&python, "panel", 1, 30), folder.certificate(&python, "old", 30, -1));
    let try_it = |options: &[String]| {
        let options: Vec<&str> = options.iter().map(String::as_str).collect();
        client(&python, port, &options)
    };
    // Nothing without security is offered.
    assert!(client(&python, port, &[]).is_err());
    assert!(try_it(&options(&good)).is_err());
    let line = machine.until("note");
    assert!(line.contains("unknown certificate \"CN=panel ["), "{line}");
    folder.trust("pki");
    let begin = Instant::now();
    let mut anna = loop {
        match try_it(&options(&good)) {
            Ok(anna) => break anna,
            Err(status) => assert!(begin.elapsed() < Duration::from_secs(30), "{status}"),
        }
    };
    assert_eq!(anna.says("write go Boolean true"), "ok");
    anna.until("read X2", "true Good");
    std::fs::copy(&old.0, folder.path("pki/trusted/old.der")).expect("it is trusted");
    assert!(try_it(&options(&old)).is_err());
    drop(anna);
}

#[test]
fn mistakes_in_the_io_file_have_a_way_out() {
    let folder = Folder::new();
    users(&folder);
    let fine = served(4840, "");
    assert!(wired(&folder, CHART, &fine).is_ok());
    let line = "[devices.line]\nkind = 'opc-ua'\nurl = 'opc.tcp://a'\n";
    for (io, parts) in [
        (
            fine.replace("127.0.0.1:4840", "0.0.0.0:4840")
                .replace("certificates", "security = 'none'\ncertificates"),
            vec!["without security"],
        ),
        (
            "[devices.s]\nkind = 'opc-ua-server'\nlisten = '127.0.0.1:4840'\n".to_owned(),
            vec!["nobody can come in", "anonymous"],
        ),
        (
            "[devices.s]\nkind = 'opc-ua-server'\nlisten = '10.0.0.1:4840'\nanonymous = 'read'\n".to_owned(),
            vec!["needs users"],
        ),
        (fine.replace("'operator'", "'boss'"), vec!["role", "\"operator\""]),
        (fine.replace("password-file = 'view'", ""), vec!["view has no password"]),
        (fine.replace("password-file = 'view'", "password-file = 'none'"), vec!["password cannot be read"]),
        (fine.replace("scada.node(Count)", "scada.node(go)"), vec!["wired to one point"]),
        (fine.replace("scada.node(Count)", "scada.coil(1)"), vec!["no point of OPC UA"]),
        (line.replace("opc.tcp", "http"), vec!["opc.tcp://"]),
        (format!("{line}user = 'anna'\n"), vec!["user without a password"]),
        (format!("{line}security = 'none'\npolicy = 'Basic256Sha256'\n"), vec!["no policy"]),
        (format!("{line}[inputs]\ngo = 'line.node(Go)'\n"), vec!["is no node", "ns=2"]),
        (format!("{line}[inputs]\ngo = {{ at = 'line.node(i=1)', unit = 'm' }}\n"), vec!["shows a unit"]),
        (format!("{line}[inputs]\ngo = {{ at = 'line.node(i=1)', as = 'i16' }}\n"), vec!["form of number"]),
        (format!("{line}[shown]\nX2 = 'line.node(i=1)'\n"), vec!["does not ask", "opc-ua-server"]),
        (
            format!("{line}[outputs]\nvalve = 'line.node(i=1)'\nfixed = 'line.node(i=1)'\n"),
            vec!["wired to one point"],
        ),
    ] {
        let problems = wired(&folder, CHART, &io).err().unwrap_or_else(|| panic!("no problem: {io}"));
        let all = problems.join("\n");
        assert!(parts.iter().all(|part| all.contains(part)), "{parts:?} in {all}");
    }
}

#[test]
fn a_thousand_nodes_are_read_at_once() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    let variables: String = (0..1000).map(|k| format!("var w{k} : INT := {k}\n")).collect();
    let chart = format!("profile iec60848\n{variables}chart Main {{\n initial step 1\n}}\n");
    let before = memory();
    let io = format!(
        "[devices.scada]\nkind = 'opc-ua-server'\nlisten = '127.0.0.1:{port}'\nsecurity = 'none'\n\
         anonymous = 'read'\nexpose = 'all'\ncertificates = 'pki'\n"
    );
    let mut machine = Machine::start(&folder, &chart, &io);
    machine.until("scada down");
    let mut anybody = client(&python, port, &[]).expect("who has no user may read");
    anybody.until("read w999", "999 Good");
    let read = anybody.says("many 1000");
    assert!(read.starts_with("1000 "), "{read}");
    let subscribed = anybody.says("subscribe 100");
    assert!(subscribed.starts_with("100 "), "{subscribed}");
    println!("1000 nodes in one read, the least of 10: {read}; 100 subscriptions: {subscribed}");
    println!("memory with the server and its client: {} KiB, before: {before} KiB", memory());
}

/// The memory of this program in KiB; 0 where the system does not tell.
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
