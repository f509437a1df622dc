//! OPC UA beside asyncua, which is not ours: as the server of G7, and as its client.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

#[path = "peer/bench.rs"]
mod bench;

use std::time::{Duration, Instant};

use bench::{Folder, Machine, Peer, client, free_port, server, wired};
use g7_online::Command;
use g7_peers::faults::{Times, row, trials};
use g7_store::users::Role;

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
fn peer_row(port: u16, more: &str) -> String {
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
fn a_server_of_asyncua_is_driven() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (mut peer, port) = server(&python, 0, &[]);
    let mut machine = driven(&folder, port);
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

    // A value that the server doubts is bad, by its name, and so the button counts as released.
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
}

/// A machine with a server of asyncua, which it has reached.
fn driven(folder: &Folder, port: u16) -> Machine {
    let io = peer_row(port, "security = 'none'") + INPUTS + OUTPUTS;
    let mut machine = Machine::start(folder, CHART, &io);
    machine.until("line up");
    machine
}

#[test]
fn row_13_a_server_that_is_killed_is_missed_and_found() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, count) = (Folder::new(), trials(50, 2));
    let (mut peer, port) = server(&python, 0, &[]);
    let mut machine = driven(&folder, port);
    let (mut bad, mut back) = (Times::default(), Times::default());
    for _ in 0..count {
        let begin = Instant::now();
        drop(peer);
        machine.until("line down");
        bad.add(begin.elapsed());
        peer = server(&python, port, &[]).0;
        let begin = Instant::now();
        // It has forgotten all, so the button is up; it gets each output, and each change comes.
        machine.until("line up");
        change(&mut peer, "true");
        change(&mut peer, "false");
        back.add(begin.elapsed());
    }
    let held = format!("bad inputs after {bad}; start of the server to the second change {back}");
    row(13, "", count.into(), 0, held);
}

/// Another value at the server comes to the chart, and the output comes back.
fn change(peer: &mut Peer, to: &str) {
    peer.says(&format!("set Go {to}"));
    peer.until("get Valve", to);
}

#[test]
fn row_13_a_server_that_stands_still_is_missed_by_its_signs_of_life() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, count, mut bad) = (Folder::new(), trials(50, 1), Times::default());
    let (mut peer, port) = server(&python, 0, &[]);
    let mut machine = driven(&folder, port);
    for _ in 0..count {
        // The connection is there, and no sign of life comes.
        peer.signal("STOP");
        let begin = Instant::now();
        let line = machine.until("line down");
        bad.add(begin.elapsed());
        assert!(line.contains("no sign of life") || line.contains("answer"), "{line}");
        peer.signal("CONT");
        machine.until("line up");
    }
    change(&mut peer, "true");
    row(13, "it stands still (keep-alive 500 ms)", count.into(), 0, format!("bad inputs after {bad}"));
}

#[test]
fn what_a_node_cannot_carry_is_refused_with_both_types() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (peer, port) = server(&python, 0, &[]);
    let io = peer_row(port, "security = 'none'")
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
fn row_14_an_unknown_server_and_a_wrong_password_are_refused() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (cert, key) = folder.certificate(&python, "peer", 1, 30);
    let options = [format!("certificate={cert}"), format!("key={key}"), "users".to_owned()];
    let options: Vec<&str> = options.iter().map(String::as_str).collect();
    let (mut peer, port) = server(&python, 0, &options);
    folder.write("right", "secret\n");
    folder.write("wrong", "guess\n");
    let io = |password: &str| {
        peer_row(port, &format!("user = 'anna'\npassword-file = '{password}'")) + INPUTS + OUTPUTS
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
    let mut machine = Machine::start(&folder, CHART, &(peer_row(port, "") + INPUTS));
    assert!(machine.until("line down").contains("refuses"));
    drop(machine);
    let mut machine = Machine::start(&folder, CHART, &(peer_row(port, "security = 'none'") + INPUTS));
    let line = machine.until("line down");
    assert!(line.contains("does not offer None") && line.contains("Basic256Sha256 SignAndEncrypt"), "{line}");
    row(14, "of a server: certificate, password, user, security", 4, 0, "refused, said with the way out");
}

#[test]
fn row_14_an_expired_certificate_of_a_server_is_refused() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let folder = Folder::new();
    let (cert, key) = folder.certificate(&python, "old", 30, -1);
    let (_peer, port) = server(&python, 0, &[&format!("certificate={cert}"), &format!("key={key}")]);
    std::fs::create_dir_all(folder.path("pki/trusted")).expect("a folder");
    // A person may give it any name.
    std::fs::copy(&cert, folder.path("pki/trusted/server.der")).expect("it is trusted");
    let mut machine = Machine::start(&folder, CHART, &(peer_row(port, "") + INPUTS));
    let line = machine.until("line down");
    assert!(line.contains("old [") && line.contains("not today"), "{line}");
    row(14, "an expired certificate of a server, trusted", 1, 0, "refused, said");
}

/// An io file with a server alone.
fn served(port: u16, more: &str) -> String {
    format!(
        "[devices.scada]\nkind = 'opc-ua-server'\nlisten = '127.0.0.1:{port}'\ncertificates = 'pki'\n{more}\n\
         [inputs]\ngo = {{ at = 'scada.node()', bad = false }}\ncount = 'scada.node(Count)'\nthere = 'scada.good()'\n\
         [outputs]\nvalve = 'scada.node()'\nspeed = 'scada.node()'\n\
         [shown]\nX2 = 'scada.node()'\nflow = {{ at = 'scada.node(Flow)', unit = 'm3/h' }}\n"
    )
}

/// Anna and one who only looks.
fn users(folder: &Folder) {
    let users = folder.users();
    for (name, role, password) in
        [("anna", Role::Operator, "a good secret"), ("view", Role::Viewer, "look around")]
    {
        users.add(name, role, password, 1, false).expect("added");
    }
}

/// The same as an option of a client.
const ANNA: &str = "user=anna:a good secret";

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

    let mut viewer = client(&python, port, &["user=view:look around"]).expect("the password is right");
    assert_eq!(viewer.says("write go Boolean true"), "refused BadUserAccessDenied");
    for (user, why) in [("anna:a bad guess", "an operator"), ("nobody:a good secret", "nobody")] {
        let refused = client(&python, port, &[&format!("user={user}")]).err();
        assert_eq!(refused.as_deref(), Some("BadUserAccessDenied"), "{why}");
    }
    assert!(machine.until("note").contains("\"anna\": unknown, or another password"));

    let mut anna = client(&python, port, &[ANNA]).expect("the password is right");
    // Each value is told with the name, but not when it is only said again.
    for value in [5, 5, 6, 5] {
        assert_eq!(anna.says(&format!("write Count Int16 {value}")), "ok");
    }
    for value in [5, 6, 5] {
        assert_eq!(machine.until("sets"), format!("scada sets count {value} Some(\"anna\")"));
    }
    assert_eq!(anna.says("write go Boolean true"), "ok");
    assert_eq!(machine.until("sets"), "scada sets go 1 Some(\"anna\")");
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
fn row_14_an_unknown_or_expired_client_is_refused_and_put_aside() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    users(&folder);
    let mut machine = Machine::start(&folder, CHART, &served(port, ""));
    machine.until("scada down");
    let options = |(cert, key): &(String, String)| {
        [format!("certificate={cert}"), format!("key={key}"), ANNA.to_owned()]
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
    row(14, "clients: no security, an unknown and an expired certificate", 3, 0, "refused, put aside, said");
}

#[test]
fn row_14_who_has_no_user_or_not_the_role_does_not_write() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    users(&folder);
    let io = served(port, "security = 'none'\nanonymous = 'read'");
    let mut machine = Machine::start(&folder, CHART, &io);
    machine.until("scada down");
    for options in [&[][..], &["user=view:look around"]] {
        let mut peer = client(&python, port, options).expect("it may read");
        assert_eq!(peer.says("write go Boolean true"), "refused BadUserAccessDenied");
    }
    // A user who is changed is there no more, whatever the session.
    let mut anna = client(&python, port, &[ANNA]).expect("the password is right");
    assert_eq!(anna.says("write go Boolean true"), "ok");
    anna.until("read X2", "true Good");
    folder.users().set_role("anna", Role::Viewer).expect("changed");
    machine.until("log in again");
    assert!(anna.says("write go Boolean true").starts_with("refused"));
    // She logs in anew, and now she only reads; the button is up again.
    let begin = Instant::now();
    let mut anna = loop {
        match client(&python, port, &[ANNA]) {
            Ok(anna) => break anna,
            Err(status) => assert!(begin.elapsed() < Duration::from_secs(30), "{status}"),
        }
    };
    anna.until("read X2", "false Good");
    assert_eq!(anna.says("write go Boolean true"), "refused BadUserAccessDenied");
    row(
        14,
        "writes without a user, as a viewer, and after a change of the role",
        4,
        0,
        "refused; sessions end",
    );
}

#[test]
fn without_users_a_client_of_this_machine_writes() {
    let Some(python) = g7_peers::python("asyncua") else { return };
    let (folder, port) = (Folder::new(), free_port());
    let mut machine = Machine::start(&folder, CHART, &served(port, "security = 'none'"));
    machine.until("scada down");
    let mut anybody = client(&python, port, &[]).expect("there are no users");
    assert_eq!(anybody.says("write go Boolean true"), "ok");
    assert_eq!(machine.until("sets"), "scada sets go 1 None");
    anybody.until("read X2", "true Good");
    assert!(client(&python, port, &[ANNA]).is_err());
}

#[test]
fn mistakes_in_the_io_file_have_a_way_out() {
    let folder = Folder::new();
    let fine = served(4840, "");
    assert!(wired(&folder, CHART, &fine).is_ok());
    let line = "[devices.line]\nkind = 'opc-ua'\nurl = 'opc.tcp://a'\n";
    for (io, parts) in [
        (
            fine.replace("127.0.0.1:4840", "0.0.0.0:4840")
                .replace("certificates", "security = 'none'\ncertificates"),
            vec!["without security"],
        ),
        (fine.replace("[inputs]", "[devices.scada.users]\n[inputs]"), vec!["users"]),
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
