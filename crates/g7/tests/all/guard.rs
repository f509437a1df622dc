//! The log and the users from the outside: commands, a full disk, a log that was changed (rows 4 and 25 of the
//! table of faults; those of the server stand beside it).

use crate::common;

use std::io::Write as _;
use std::path::Path;

use common::Folder;
use common::talk::Running;
use serde_json::Value;

const LAMP: &str = "\
output lamp : BOOL
chart Main {
  initial step 1
  1 -> 1 when FALSE
}
";

/// Many for the table, few in each test.
fn trials(many: u32, few: u32) -> u32 {
    if std::env::var_os("G7_FAULTS").is_some() { many } else { few }
}

/// The rows of a log as JSON.
fn rows(folder: &Folder, log: &str, more: &[&str]) -> Vec<Value> {
    let ran = folder.g7(&[&["log", log, "--format", "jsonl"], more].concat());
    ran.is(0).out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

fn kinds(rows: &[Value]) -> Vec<&str> {
    rows.iter().filter_map(|row| row["kind"].as_str()).collect()
}

#[test]
fn what_happens_and_what_the_console_does_are_rows() {
    let folder = Folder::with(LAMP);
    folder.write("chart.io.toml", "[controller]\nlog = 'machine.log'\n");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("log machine.log: new");
    g7.until("running");
    g7.say("force lamp := 1 for 60s");
    g7.until("forced");
    g7.say("release");
    g7.until("no longer forced");
    g7.say("stop");
    g7.until("stopped");
    assert_eq!(g7.quit(), 0);
    let all = rows(&folder, "machine.log", &[]);
    let wanted = ["begin", "run", "force", "forced", "release_all", "released", "stop", "stop", "end"];
    assert_eq!(kinds(&all), wanted, "each deed before its effect");
    let force = &all[2];
    assert_eq!((&force["level"], &force["from"]), (&Value::from("deed"), &Value::from("console")));
    assert_eq!(force["data"], serde_json::json!({ "name": "lamp", "value": "1", "seconds": 60 }));
    assert_eq!(kinds(&rows(&folder, "chart.g7", &["--level", "deed", "--last", "1"])), ["stop"]);
    assert_eq!(rows(&folder, "machine.log", &["--text", "LAMP"]).len(), 3);
    assert!(rows(&folder, "machine.log", &["--from", "2999-01-01"]).is_empty());
    let csv = folder.g7(&["log", "machine.log", "--format", "csv"]);
    assert_eq!(csv.is(0).out.lines().count(), all.len() + 1);
    let mark = folder.g7(&["log", "machine.log", "--check"]).is(0).out.trim().to_owned();
    // The next start tells where it stands.
    let mut g7 = Running::online(&folder, &[]);
    assert!(g7.until("newest row").contains(&mark));
    assert_eq!(g7.quit(), 0);
    folder.g7(&["log", "machine.log", "--check", "--known", &mark]).is(0);
    folder.g7(&["log", "machine.log", "--check", "--known", &format!("9{mark}")]).is(1);
    folder.g7(&["log", "chart.io.toml", "--check", "--known", "nonsense"]).is(2);
    folder.g7(&["log", "none.log"]).is_refused(&["none.log"]);
    folder.write("other.log", "no log");
    folder.g7(&["log", "other.log"]).is_refused(&["other.log"]);
}

#[test]
fn row_25_a_changed_byte_of_a_log_is_found() {
    let folder = Folder::with(LAMP);
    for (k, name) in ["ana", "rui", "eva", "leo"].iter().enumerate() {
        let role = if k == 0 { "admin" } else { "viewer" };
        let add = folder.command(&["users", "add", "g7.users", name, role, "--log", "g7.log"]);
        let add: common::Ran = add.stdin("correct horse\n").assert().into();
        assert!(add.is(0).err.contains(&format!("added {name}")), "{}", add.err);
    }
    folder.g7(&["log", "g7.log", "--check"]).is(0);
    let whole = std::fs::read(folder.path("g7.log")).expect("there");
    let mut found = 0;
    for name in ["ana", "rui", "eva", "leo"] {
        let text = format!("\"user\":\"{name}\"");
        let at = whole.windows(text.len()).position(|w| w == text.as_bytes()).expect("it is a row");
        for bit in [0, 1] {
            let mut changed = whole.clone();
            changed[at + 8] ^= 1 << bit;
            folder.write("g7.log", changed);
            let ran = folder.g7(&["log", "g7.log", "--check"]);
            assert!(ran.is(1).err.contains("does not fit"), "{}", ran.err);
            found += 1;
        }
    }
    folder.write("g7.log", &whole);
    folder.g7(&["log", "g7.log", "--check"]).is(0);
    g7_peers::faults::row(25, "changed rows of a log", found, 0, "all found");
}

#[test]
fn users_are_changed_from_the_command_line() {
    let folder = Folder::with(LAMP);
    folder.write(
        "chart.io.toml",
        "[controller]\nlog = 'machine.log'\n[server]\nusers = 'g7.users'\ncert = 'g7.cert.pem'\nkey = 'g7.key.pem'\n",
    );
    let with = |arguments: &[&str], input: &'static str| -> common::Ran {
        folder.command(&[&["users"], arguments].concat()).stdin(input).assert().into()
    };
    with(&["add", "chart.g7", "ana", "admin"], "short\n").is(2);
    with(&["add", "chart.g7", "ana", "king"], "correct horse\n").is(2);
    with(&["add", "chart.g7", "ana", "admin"], "correct horse\n").is(0);
    with(&["add", "chart.io.toml", "rui", "viewer"], "correct horse\n").is(0);
    with(&["role", "chart.g7", "rui", "operator"], "").is(0);
    with(&["password", "chart.g7", "rui"], "another horse\n").is(0);
    with(&["revoke", "chart.g7", "rui"], "").is(0);
    let list = folder.g7(&["users", "list", "g7.users"]).is(0).out.clone();
    assert!(list.contains("ana") && list.contains("admin") && list.contains("operator"), "{list}");
    with(&["remove", "chart.g7", "rui"], "").is(0);
    let refused = with(&["remove", "chart.g7", "ana"], "");
    assert!(refused.is(2).err.contains("last admin"), "{}", refused.err);
    let kinds_of = rows(&folder, "machine.log", &["--level", "deed"]);
    let wanted = [
        "user-add",
        "user-add",
        "user-add",
        "user-role",
        "user-password",
        "user-revoke",
        "user-remove",
        "user-remove",
    ];
    assert_eq!(kinds(&kinds_of), wanted);
    assert!(!folder.g7(&["log", "machine.log"]).out.contains("horse"), "no password is in it");
    folder.g7(&["users", "list", "none.users"]).is_refused(&["none.users"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        folder.g7(&["cert", "plant.example", "10.0.0.7"]).is(0);
        for name in ["g7.users", "g7.key.pem"] {
            let mode = std::fs::metadata(folder.path(name)).expect("there").permissions().mode();
            assert_eq!(mode & 0o077, 0, "{name} is its owner's alone");
        }
        folder.g7(&["cert"]).is_refused(&["already exists", "--force"]);
    }
    folder.g7(&["cert", "--cert", "a.pem", "--key", "b.pem", "no name"]).is_refused(&["no name"]);
}

#[test]
fn an_io_file_that_would_let_strangers_in_is_refused() {
    let folder = Folder::with(LAMP);
    let serve = |io: &str| {
        folder.write("chart.io.toml", io);
        folder.g7(&["serve", "chart.g7", "--online", "--no-open", "--port", "0"])
    };
    serve("[server]\nhost = '0.0.0.0'\n").is_refused(&["without encryption and without users"]);
    let none = serve("[server]\ncert = 'c.pem'\nkey = 'k.pem'\n");
    none.is_refused(&["cannot read", "c.pem"]);
    folder.g7(&["cert", "--cert", "c.pem", "--key", "k.pem"]).is(0);
    serve("[server]\nhost = '0.0.0.0'\ncert = 'c.pem'\nkey = 'k.pem'\nusers = 'u'\n").is_refused(&["log"]);
    let wrong = serve("[server]\nusers = 'u'\n");
    assert_eq!(wrong.code, 2, "{}", wrong.err);
    assert!(wrong.err.contains("encrypted connections alone"), "{}", wrong.err);
    let unknown = folder.g7(&["run", "chart.g7", "--online", "--for", "1s"]);
    assert!(unknown.is(1).err.contains("G0701"), "also where no page is served: {}", unknown.err);
}

/// Takes all room of a small disk.
fn fill(path: &Path) {
    let mut file = std::fs::File::create(path).expect("a file");
    while file.write_all(&[0; 4096]).is_ok() {}
    while file.write_all(&[0; 1]).is_ok() {}
}

#[test]
fn row_4_and_25_a_full_disk_refuses_forces_and_the_log_goes_on_when_there_is_room() {
    let Some(disk) = g7_peers::SmallDisk::new(4_096) else { return };
    let folder = Folder::with(LAMP);
    let log = disk.path().join("machine.log");
    folder.write("chart.io.toml", format!("[controller]\nlog = '{}'\n", log.display()));
    let (mut g7, filler) = (Running::online(&folder, &[]), disk.path().join("filler"));
    g7.until("running");
    let count = trials(100, 2);
    for _ in 0..count {
        fill(&filler);
        // The room that SQLite has already is used up first.
        let mut refused = false;
        for _ in 0..2_000 {
            g7.say("force lamp := 1 for 60s");
            let line = loop {
                let line = g7.line();
                if line.contains("forced to") || line.contains("nothing is done") {
                    break line;
                }
            };
            refused = line.contains("nothing is done");
            if refused {
                break;
            }
        }
        assert!(refused, "what cannot be written is not done");
        // The scan and what makes a machine safe go on.
        g7.say("stop");
        g7.until("stopped");
        g7.say("run");
        g7.until("running");
        std::fs::remove_file(&filler).expect("removed");
        loop {
            g7.say("force lamp := 1 for 60s");
            let line = g7.line();
            if line.contains("forced to") {
                break;
            }
        }
    }
    assert_eq!(g7.quit(), 0);
    let file = log.display().to_string();
    folder.g7(&["log", &file, "--check"]).is(0);
    let all = rows(&folder, &file, &[]);
    let stops = kinds(&all).iter().filter(|kind| **kind == "stop").count();
    assert_eq!(stops, 2 * count as usize, "events and deeds waited for the room");
    println!("row 4 and 25: {count} times full; forces refused, {} rows, none lost", all.len());
}
