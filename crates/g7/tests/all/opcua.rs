//! `g7 run --online` as a server of OPC UA: who is let in, and what the log says of it. The client is asyncua.
#![cfg(feature = "opcua")]
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use common::talk::{Master, Running, free_port};
use common::{Folder, Ran};

const CHART: &str = "\
profile iec60848
input go : BOOL
output lamp : BOOL
chart Main {
  initial step 1
  step 2 { N lamp }
  1 -> 2 when go
  2 -> 1 when not go
}
";

fn io(listen: &str, more: &str) -> String {
    format!(
        "[controller]\nwatchdog = '20s'\n{more}\n[devices.scada]\nkind = 'opc-ua-server'\nlisten = '{listen}'\n\
         [inputs]\ngo = {{ at = 'scada.node()', bad = false }}\n[outputs]\nlamp = 'scada.node()'\n"
    )
}

#[test]
fn an_address_of_others_needs_users_and_a_log() {
    let folder = Folder::with(CHART);
    let run = ["run", "chart.g7", "--online", "--for", "100ms"];
    folder.write("chart.io.toml", io("0.0.0.0:0", "log = 'machine.log'"));
    // The log is opened first, and says so in a line of its own.
    let ran = folder.g7(&run);
    let error = ran.is(2).err.lines().last().unwrap_or_default();
    for part in ["error:", "scada", "no users", "g7 users"] {
        assert!(error.contains(part), "`{part}` in: {}", ran.err);
    }
    folder.write("chart.io.toml", io("0.0.0.0:0", "[server]\nusers = 'g7.users'"));
    folder.g7(&run).is_refused(&["scada", "`log`"]);
    folder
        .write("chart.io.toml", io("127.0.0.1:0", "").replace("[inputs]", "anonymous = 'refuse'\n[inputs]"));
    folder.g7(&run).is_refused(&["nobody can come in"]);
}

#[test]
fn what_a_user_writes_is_in_the_log_with_the_name() {
    let (folder, port) = (Folder::with(CHART), free_port());
    let server = "log = 'machine.log'\n[server]\nusers = 'g7.users'";
    let io = io(&format!("127.0.0.1:{port}"), server).replace("[inputs]", "security = 'none'\n[inputs]");
    folder.write("chart.io.toml", io);
    let add: Ran = folder
        .command(&["users", "add", "chart.g7", "anna", "operator"])
        .stdin("a good secret\n")
        .assert()
        .into();
    add.is(0);
    let mut g7 = Running::online(&folder, &[]);
    g7.until("has no master");
    let Some(mut anna) = Master::of_opcua(port, "user=anna:a good secret") else { return };
    assert_eq!(anna.says("write go Boolean true"), "ok");
    g7.until("scada: `go` is set to TRUE, by anna");
    anna.until("read lamp", "true Good");
    assert_eq!(g7.quit(), 0);
    let rows = folder.g7(&["log", "machine.log", "--format", "jsonl"]);
    let set = |line: &&str| line.contains("\"set\"");
    let all: Vec<&str> = rows.is(0).out.lines().filter(set).collect();
    let [row] = all[..] else { panic!("{}", rows.out) };
    assert!(row.contains("anna") && row.contains("scada") && row.contains("TRUE"), "{row}");
}
