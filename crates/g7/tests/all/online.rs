//! `g7 run --online`: io files, values that outlive the program, and Modbus slaves and masters that are not
//! ours.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use common::Folder;
use common::talk::{Master, Running, Slave, free_port};

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : REAL
input weight : DINT
input line1_ok : BOOL
output valve : BOOL
output lamp : BOOL inverted
output speed : INT safe -1
output sum : LREAL
var presses : INT := 0 retain
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 presses := presses + 1  P1 speed := presses + 1  P1 sum := REAL_TO_LREAL(level) + DINT_TO_LREAL(weight) }
  1 -> 2 when go and line1_ok
  2 -> 1 when not go
}
";

/// The io file for a slave at a port of this machine.
fn io(port: u16) -> String {
    format!(
        "[controller]\nretain = 'kept'\n[devices.line1]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\n\
         timeout = '1s'\nretry = '500ms'\n[inputs]\ngo = 'line1.discrete(3)'\n\
         level = {{ at = 'line1.input(4)', as = 'f32' }}\nweight = {{ at = 'line1.input(6)', scale = 10 }}\n\
         line1_ok = 'line1.good()'\n[outputs]\nvalve = 'line1.coil(2)'\nlamp = 'line1.holding(9.4)'\n\
         speed = 'line1.holding(7)'\nsum = 'line1.holding(20)'\n"
    )
}

fn folder(port: u16) -> Folder {
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", io(port));
    folder
}

/// Valve; lamp; speed.
const SAFE: [(&str, &str); 3] = [("coil 2 1", "0"), ("holding 9 1", "16"), ("holding 7 1", "65535")];

#[test]
fn a_slave_of_pymodbus_is_driven_lost_and_found() {
    let Some(mut slave) = Slave::start(0) else { return };
    let folder = folder(slave.port());
    let mut g7 = Running::online(&folder, &[]);
    g7.until("line1 answers");
    // IEEE 754: 2.5 is 40200000. The lamp is lit, and its wire inverted.
    slave.set("input 4 16416 0 65535 65533");
    slave.becomes("holding 9 1", "0");
    slave.set("discrete 3 1");
    slave.becomes("coil 2 1", "1");
    slave.becomes("holding 9 1", "16");
    slave.becomes("holding 7 1", "1");
    // 2.5 + 10 * -3 = -27.5, which is C03B800000000000.
    slave.becomes("holding 20 4", "49211 32768 0 0");
    g7.say("stop");
    g7.until("stopped");
    SAFE.iter().for_each(|(what, values)| slave.becomes(what, values));
    g7.say("run");
    slave.becomes("coil 2 1", "1");

    let port = slave.port();
    drop(slave);
    g7.until("line1 does not answer");
    let mut slave = Slave::start(port).expect("it was there before");
    g7.until("line1 answers");
    // The slave has forgotten all; it gets each output anew, and the button is up now.
    slave.becomes("holding 7 1", "1");
    slave.becomes("coil 2 1", "0");
    slave.set("discrete 3 1");
    slave.becomes("coil 2 1", "1");
    slave.becomes("holding 7 1", "2");
    assert_eq!(g7.quit(), 0);
    SAFE.iter().for_each(|(what, values)| assert_eq!(slave.get(what), *values, "{what}"));

    // The next start is a warm one: step 2 is still active, and nothing is counted again.
    let mut g7 = Running::online(&folder, &[]);
    g7.until("warm start");
    slave.becomes("coil 2 1", "1");
    slave.becomes("holding 7 1", "2");
    assert_eq!(g7.quit(), 0);
}

#[test]
fn two_slaves_share_a_serial_line() {
    // pymodbus takes `serial` for serial lines.
    let Some(mut slave) = Slave::begin("serial, pymodbus", &["serial", "1", "7"]) else { return };
    let folder = Folder::with(CHART);
    let line = &slave.place;
    let device = |name: &str, unit: u8| {
        format!(
            "[devices.{name}]\nkind = 'modbus-rtu'\nport = '{line}'\nparity = 'none'\nunit = {unit}\n\
             words = 'low-first'\ntimeout = '300ms'\nretry = '300ms'\n"
        )
    };
    let channels = "[inputs]\ngo = 'a.coil(3)'\nline1_ok = 'b.good()'\nlevel = 'b.input(4)'\n\
        [outputs]\nvalve = 'b.coil(2)'\nspeed = { at = 'a.holding(7)', as = 'i32' }\n";
    // Nobody has unit 9: it costs the others time, not values.
    let devices = device("a", 1) + &device("b", 7) + &device("c", 9);
    folder.write("chart.io.toml", format!("{devices}{channels}lamp = 'c.coil(1)'\n"));
    let mut g7 = Running::online(&folder, &[]);
    let lines = [g7.until("answer"), g7.until("answer"), g7.until("answer")].join("\n");
    assert!(lines.contains("a answers") && lines.contains("b answers"), "{lines}");
    assert!(lines.contains("c does not answer"), "{lines}");
    slave.set("1 coil 3 1");
    slave.becomes("7 coil 2 1", "1");
    // -1 while safe, then 1: the low word first.
    slave.becomes("1 holding 7 2", "1 0");
    g7.say("stop");
    slave.becomes("1 holding 7 2", "65535 65535");
    slave.becomes("7 coil 2 1", "0");
    assert_eq!(g7.quit(), 0);
}

/// An io file with a server alone: the master has the button and the weight, and sees the rest.
fn served(port: u16) -> String {
    format!(
        "[devices.scada]\nkind = 'modbus-server'\nlisten = '127.0.0.1:{port}'\nsilence = '500ms'\n\
         [inputs]\ngo = {{ at = 'scada.coil(10)', bad = false }}\nweight = 'scada.holding(4)'\n\
         line1_ok = 'scada.good()'\n[outputs]\nvalve = 'scada.coil(2)'\nlamp = 'scada.holding(9.4)'\n\
         speed = 'scada.input(7)'\nsum = 'scada.holding(20)'\n\
         [shown]\nX2 = 'scada.discrete(0)'\npresses = 'scada.input(8)'\nweight = 'scada.input(0)'\n"
    )
}

#[test]
fn a_master_of_pymodbus_drives_and_watches() {
    let (folder, port) = (Folder::with(CHART), free_port());
    folder.write("chart.io.toml", served(port));
    let mut g7 = Running::online(&folder, &[]);
    g7.until("scada has no master: none has asked");
    let Some(mut master) = Master::start(port) else { return };
    // Step 1 lights the lamp, whose wire is inverted.
    master.until("read discrete 0 1", "0");
    g7.until("scada has a master");
    assert_eq!(master.says("write holding 4 65535 65533"), "ok");
    assert_eq!(master.says("write coil 10 1"), "ok");
    master.until("read discrete 0 1", "1");
    master.until("read coil 2 1", "1");
    master.until("read holding 9 1", "16");
    // A DINT of -3, as the chart has it now; -3 as a LREAL is C008000000000000.
    master.until("read input 0 2", "65535 65533");
    master.until("read holding 20 4", "49160 0 0 0");
    master.until("read input 7 2", "1 1");

    // Addresses that are not wired; points that are not the master's; neither is half done.
    for (what, number) in [
        ("read discrete 1 1", 2),
        ("read discrete 0 2", 2),
        ("read input 6 1", 2),
        ("write coil 2 0", 2),
        ("write holding 20 1 2 3 4", 2),
        ("write holding 4 7 7 7", 2),
        ("write holding 9 0", 2),
    ] {
        assert_eq!(master.says(what), format!("exception {number}"), "{what}");
    }
    assert_eq!(master.says("read coil 2 1"), "1");
    assert_eq!(master.says("read holding 4 2"), "65535 65533");

    g7.say("stop");
    g7.until("stopped");
    // Outputs are safe; what is shown stays as it is.
    master.until("read coil 2 1", "0");
    master.until("read input 7 2", "65535 1");
    assert_eq!(master.says("read discrete 0 1"), "1");
    g7.say("run");
    master.until("read coil 2 1", "1");

    // Without a master the button counts as released.
    drop(master);
    g7.until("scada has no master: no request for 500ms");
    let mut master = Master::start(port).expect("it was there before");
    // It only reads: what was written before it came is no command of its own.
    master.until("read discrete 0 1", "0");
    g7.until("scada has a master");
    assert_eq!(master.says("read input 8 1"), "1");
    assert_eq!(master.says("write coil 10 1"), "ok");
    master.until("read input 8 1", "2");
    assert_eq!(g7.quit(), 0);
}

#[test]
fn a_port_in_use_is_told_and_tried_again() {
    let folder = Folder::with(CHART);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = taken.local_addr().expect("it has an address").port();
    folder.write("chart.io.toml", served(port));
    let asked = folder.g7(&["devices"]);
    let lines: Vec<&str> = asked.is(0).out.lines().collect();
    assert_eq!(lines[0], format!("scada listens at 127.0.0.1:{port} for masters"));
    assert!(lines[1].contains("coil(10)") && lines[1].ends_with("written"), "{}", asked.out);
    assert!(asked.out.lines().any(|l| l.contains("X2") && l.ends_with("read")), "{}", asked.out);
    let mut g7 = Running::online(&folder, &[]);
    let line = g7.until("scada has no master: cannot listen at");
    assert!(line.contains(&format!("127.0.0.1:{port}")), "{line}");
    drop(taken);
    if let Some(mut master) = Master::start(port) {
        master.until("read discrete 0 1", "0");
    }
    assert_eq!(g7.quit(), 0);
}

#[test]
fn devices_are_asked_and_nothing_is_written() {
    let Some(mut slave) = Slave::start(0) else { return };
    let folder = folder(slave.port());
    slave.set("input 4 16416 0 65535 65535");
    slave.set("holding 7 9");
    slave.set("discrete 3 1");
    let all = folder.g7(&["devices"]);
    all.is(0);
    let address = format!("127.0.0.1:{}", slave.port());
    assert!(all.out.starts_with(&format!("line1 {address} unit 1 answers in ")), "{}", all.out);
    let lines: Vec<&str> = all.out.lines().skip(1).collect();
    // 10 times -1; the wire of the lamp is inverted.
    let expected = [
        "  go      discrete(3)   TRUE",
        "  level   input(4)      2.5",
        "  weight  input(6)      -10 (from -1)",
        "  valve   coil(2)       FALSE",
        "  lamp    holding(9.4)  TRUE (from FALSE)",
        "  speed   holding(7)    9",
        "  sum     holding(20)   0",
    ];
    assert_eq!(lines, expected);
    let by_hand = folder.g7(&["devices", "--tcp", &address, "--read", "holding(6)", "--count", "3"]);
    let lines: Vec<&str> = by_hand.is(0).out.lines().skip(1).map(str::trim).collect();
    assert_eq!(lines, ["holding(6)  0", "holding(7)  9", "holding(8)  0"]);
    let float =
        folder.g7(&["devices", "--tcp", &address, "--read", "input(4)", "--as", "f32", "--read", "coil(1)"]);
    let lines: Vec<&str> = float.is(0).out.lines().skip(1).map(str::trim).collect();
    assert_eq!(lines, ["input(4)  2.5", "coil(1)   FALSE"]);
    let none = folder.g7(&["devices", "--tcp", &address, "--read", "holding(1000)"]);
    assert!(none.is(1).out.contains("exception"), "{}", none.out);
    // The outputs have what they had before.
    assert_eq!(slave.get("holding 7 1"), "9");
}

#[test]
fn devices_that_are_not_there_are_told() {
    let folder = folder(1);
    let all = folder.g7(&["devices"]);
    assert!(all.is(1).out.contains("line1 127.0.0.1:1 unit 1 does not answer"), "{}", all.out);
    let serial = folder.g7(&["devices", "--serial", "/dev/g7-none", "--read", "coil(1)"]);
    assert!(serial.is(1).out.contains("does not answer"), "{}", serial.out);
    folder.g7(&["devices", "--read", "coil(1)"]).is_refused(&["--tcp", "--serial"]);
    for bad in ["coil", "coil(1.2)", "holding(70000)", "good()"] {
        let refused = folder.g7(&["devices", "--tcp", "x", "--read", bad]);
        assert!(refused.is(2).err.contains("--read"), "{}", refused.err);
    }
    folder.g7(&["devices", "--tcp", "x:y"]).is_refused(&["port is no number"]);
}

#[test]
fn addresses_that_a_slave_does_not_have_are_bad_alone() {
    let Some(mut slave) = Slave::start(0) else { return };
    let folder = Folder::with(CHART);
    folder.write(
        "chart.io.toml",
        io(slave.port()).replace("input(4)", "input(1000)").replace("holding(7)", "holding(1000)"),
    );
    let mut g7 = Running::online(&folder, &[]);
    // An output that is refused, and an input without a value, in either order.
    let lines = [g7.until("line1"), g7.until("line1"), g7.until("line1")].join("\n");
    assert!(lines.contains("no value for `level`: exception"), "{lines}");
    assert!(lines.contains("refuses `speed`: exception"), "{lines}");
    slave.set("discrete 3 1");
    slave.becomes("coil 2 1", "1");
    assert_eq!(g7.quit(), 0);
}

#[cfg(not(feature = "opcua"))]
#[test]
fn a_kind_that_this_build_has_not_is_told_with_the_build_that_has_it() {
    let folder = Folder::with(CHART);
    let io = "[devices.tanks]\nkind = 'opc-ua'\nurl = 'opc.tcp://127.0.0.1:1'\n\
        [inputs]\ngo = 'tanks.node(ns=2;s=Go)'\n";
    folder.write("chart.io.toml", io);
    for command in [&["run", "--online"][..], &["devices"]] {
        let ran = folder.g7(command);
        assert_eq!(ran.code, 1, "{}", ran.err);
        for part in ["chart.io.toml:1", "the kind \"opc-ua\"", "--features opcua"] {
            assert!(ran.err.contains(part), "{part}: {}", ran.err);
        }
    }
}

#[test]
fn without_its_device_a_chart_runs_and_says_so() {
    // Nobody listens at port 1.
    let folder = folder(1);
    let ran = folder.g7(&["run", "--online", "--for", "300ms"]);
    ran.is(0);
    assert!(ran.err.contains("line1 does not answer"), "{}", ran.err);
    assert!(ran.err.contains("the situation is {1}"), "{}", ran.err);
}

#[test]
fn the_plant_stands_for_devices_on_request() {
    let folder = folder(1);
    let plant = "plant Hand {\n  drive go := TRUE\n  drive line1_ok := TRUE\n}\n";
    folder.write("chart.g7", format!("{CHART}{plant}"));
    let ran = folder.g7(&["run", "--online", "--for", "300ms", "--simulate"]);
    assert!(ran.is(0).err.contains("the situation is {2}"), "{}", ran.err);
    assert!(!ran.err.contains("line1 does not answer"), "{}", ran.err);
    // Without the switch there is no plant, though the file has one.
    folder.g7(&["run", "--online", "--for", "300ms", "--io", "chart.io.toml"]).is(0);
    folder.g7(&["run", "--online", "--simulate", "line2"]).is_refused(&["no device `line2`", "line1"]);
}

#[test]
fn values_of_another_program_are_refused_unless_the_file_says_otherwise() {
    let folder = folder(1);
    folder.g7(&["run", "--online", "--for", "300ms"]).is(0);
    let again = folder.g7(&["run", "--online", "--for", "100ms"]);
    assert!(again.is(0).err.contains("warm start"), "{}", again.err);
    folder.write("chart.g7", CHART.replace("1 -> 2 when go", "1 -> 2 when not go"));
    let kept = std::fs::read(folder.path("kept")).expect("it is there");
    folder.g7(&["run", "--online", "--for", "100ms"]).is_refused(&["kept", "another program", "fit"]);
    assert!(std::fs::read(folder.path("kept")).expect("still there") == kept, "it is left as it is");
    folder.write("chart.io.toml", io(1).replace("retain =", "changed = 'fit'\nretain ="));
    let fitted = folder.g7(&["run", "--online", "--for", "100ms"]);
    assert!(fitted.is(0).err.contains("1 of 1 retained variables"), "{}", fitted.err);
    let warm = folder.g7(&["run", "--online", "--for", "100ms"]);
    assert!(warm.is(0).err.contains("warm start"), "{}", warm.err);
    // Both slots are damaged.
    folder.write("kept", vec![7; kept.len()]);
    folder.g7(&["run", "--online"]).is_refused(&["kept", "damaged", "move it away"]);
}

#[test]
fn mistakes_have_a_place_and_nothing_runs() {
    let folder = Folder::with(CHART);
    // The least file: it runs.
    folder.write("least.toml", "");
    let least = folder.g7(&["run", "--online", "--io", "least.toml", "--for", "100ms"]);
    assert!(
        least.is(0).err.contains("running") && least.err.contains("no device has go, level"),
        "{}",
        least.err
    );
    // The plant stands for the devices of what is wired, and for nothing else.
    folder.write(
        "some.toml",
        "[devices.a]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\n[inputs]\ngo = 'a.coil(0)'\n",
    );
    let some = ["run", "--online", "--io", "some.toml", "--simulate", "--for", "100ms"];
    let some = folder.g7(&some);
    assert!(some.is(0).err.contains("no device has level, "), "{}", some.err);
    folder.write("stop.toml", "[controller]\nstart = 'stop'\n");
    let stop = folder.g7(&["run", "--online", "--io", "stop.toml", "--for", "100ms"]);
    assert!(stop.is(0).err.contains("0 scans"), "{}", stop.err);
    folder.g7(&["run", "--online"]).is_refused(&["chart.io.toml is missing", "--io"]);
    folder.write("chart.io.toml", io(1).replace("coil(2)", "discrete(2)").replace("timeout", "timout"));
    let ran = folder.g7(&["run", "--online"]);
    ran.is(1);
    for part in
        ["chart.io.toml:7:1", "no setting `timout`", "G0701", "cannot be written", "G0703", "2 errors"]
    {
        assert!(ran.err.contains(part), "{part}: {}", ran.err);
    }
    folder.write("chart.io.toml", b"\xff");
    folder.g7(&["run", "--online"]).is_refused(&["chart.io.toml", "UTF-8"]);
    let both = folder.g7(&["run", "--online", "--headless"]);
    assert!(both.is(2).err.contains("--headless"), "{}", both.err);
    let alone = folder.g7(&["run", "--io", "x.toml"]);
    assert!(alone.is(2).err.contains("--online"), "{}", alone.err);
}

#[test]
#[cfg(target_os = "linux")]
fn the_scan_thread_makes_no_system_call_but_its_sleep() {
    if !g7_peers::tool("strace") {
        return;
    }
    let folder = folder(1);
    let mut traced = std::process::Command::new("strace");
    traced.args(["-f", "-o", "calls"]).arg(snapbox::cmd::cargo_bin!("g7"));
    traced.args(["run", "chart.g7", "--online", "--for", "1s"]).stdin(std::process::Stdio::null());
    let traced = traced.current_dir(folder.root()).output().expect("it runs");
    if String::from_utf8_lossy(&traced.stderr).contains("ptrace") {
        return g7_peers::skip("strace may not trace here");
    }
    let calls = folder.read("calls");
    let named = calls.lines().find(|l| l.contains("PR_SET_NAME, \"scan\"")).expect("the scan thread");
    let thread = named.split_whitespace().next().expect("its number");
    let own: Vec<&str> =
        calls.lines().filter_map(|l| l.strip_prefix(thread)).map(|l| l.trim_start()).collect();
    let is_sleep = |l: &str| l.contains("clock_nanosleep");
    let first = own.iter().position(|l| is_sleep(l)).expect("it sleeps");
    let last = own.iter().rposition(|l| is_sleep(l)).expect("it sleeps");
    let between = &own[first..=last];
    assert!(between.len() > 50, "{} calls in a second", between.len());
    let other: Vec<&&str> = between.iter().filter(|l| !is_sleep(l)).collect();
    assert!(other.is_empty(), "{other:#?}");
}

/// The answer of a server of this machine: status and body.
fn http(port: u16, path: &str) -> (u16, String) {
    use std::io::{Read as _, Write as _};
    let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).expect("it listens");
    write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").expect("it reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers");
    let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
    (head.split_whitespace().nth(1).and_then(|code| code.parse().ok()).expect("a status"), body.to_owned())
}

#[test]
fn a_monitoring_system_finds_what_happened() {
    let Some(slave) = Slave::start(0) else { return };
    let (folder, port) = (folder(slave.port()), free_port());
    let io = io(slave.port()).replace("[controller]", &format!("[controller]\nmetrics = '127.0.0.1:{port}'"));
    folder.write("chart.io.toml", &io);
    let mut g7 = Running::online(&folder, &[]);
    g7.until("line1 answers");
    assert_eq!(http(port, "/healthz").0, 200);
    assert_eq!(http(port, "/readyz").0, 200);
    drop(slave);
    g7.until("line1 does not answer");
    g7.say("stop");
    g7.until("stopped");
    assert_eq!(http(port, "/readyz").0, 503);
    let (status, text) = http(port, "/metrics");
    assert_eq!(status, 200);
    for line in [
        "g7_running 0",
        "g7_fault 0",
        "g7_device_up{device=\"line1\"} 0",
        "g7_device_losses_total{device=\"line1\"} 1",
        "# EOF",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}: {text}");
    }
    let scans =
        text.lines().find_map(|l| l.strip_prefix("g7_scan_late_seconds_count ")).expect("a histogram");
    assert!(scans.parse::<u64>().expect("a number") > 0, "{text}");
    assert_eq!(http(port, "/other").0, 404);
    assert_eq!(g7.quit(), 0);
    // A port in use: nothing runs.
    let taken = std::net::TcpListener::bind(("127.0.0.1", port)).expect("it is free again");
    folder.g7(&["run", "--online", "--for", "100ms"]).is_refused(&["cannot listen at", "metrics"]);
    drop(taken);
}
