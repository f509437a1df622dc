//! `g7 service`: units of systemd, and what a controller tells the service manager.
#![cfg(target_os = "linux")]
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::UnixDatagram;
use std::process::Command;
use std::time::Duration;

use common::Folder;
use common::talk::{Running, free_port};
use snapbox::cmd::cargo_bin;

const CHART: &str = "\
profile iec60848
input go : BOOL
output valve : BOOL
chart Main {
  initial step 1
  step 2 { N valve }
  1 -> 2 when go
  2 -> 1 when not go
}
plant Idle { drive go := FALSE }
";

/// A chart in a folder of its own, whose name has a blank.
fn folder(controller: &str) -> Folder {
    let folder = Folder::new();
    folder.write("my plant/tank.g7", CHART);
    let port = free_port();
    folder.write(
        "my plant/tank.io.toml",
        format!(
            "[controller]\n{controller}\n[devices.rack]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\n\
             [inputs]\ngo = 'rack.discrete(0)'\n[outputs]\nvalve = 'rack.coil(0)'\n"
        ),
    );
    folder
}

/// The value of a line of a unit.
fn line<'t>(unit: &'t str, key: &str) -> Option<&'t str> {
    unit.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='))
}

#[test]
fn a_unit_has_what_the_io_file_asks_for() {
    let folder = folder("retain = 'kept'\npriority = 80");
    let unit = folder
        .g7(&["service", "install", "my plant/tank.g7", "--print", "--run-as", "plc"])
        .is(0)
        .out
        .clone();
    let chart = folder.path("my plant/tank.g7").canonicalize().expect("it is there");
    let command = line(&unit, "ExecStart").expect("a command");
    assert!(command.contains(&format!(" run --online \"{}\" --io ", chart.display())), "{command}");
    let kept = chart.parent().expect("a folder").display().to_string();
    for (key, value) in [
        ("Type", "notify"),
        ("User", "plc"),
        ("Restart", "no"),
        ("LimitRTPRIO", "99"),
        ("ReadWritePaths", &format!("\"{kept}\"")),
        ("WantedBy", "multi-user.target"),
    ] {
        assert_eq!(line(&unit, key), Some(value), "{key}: {unit}");
    }

    let plain = self::folder("start = 'stop'");
    let of_user = ["service", "install", "my plant/tank.g7", "--print", "--user", "--page", "--restart"];
    let unit = plain.g7(&of_user).is(0).out.clone();
    assert!(line(&unit, "ExecStart").is_some_and(|c| c.contains("serve --online --no-open")), "{unit}");
    assert_eq!(line(&unit, "Restart"), Some("on-failure"));
    assert_eq!(line(&unit, "WantedBy"), Some("default.target"));
    for key in ["User", "LimitRTPRIO", "ReadWritePaths"] {
        assert_eq!(line(&unit, key), None, "{key}: {unit}");
    }
}

#[test]
fn systemd_has_nothing_to_say_about_a_unit() {
    if !g7_peers::tool("systemd-analyze") {
        return;
    }
    let folder = folder("retain = 'kept'\npriority = 80");
    for more in [&["--run-as", "root"][..], &["--user", "--page"]] {
        let unit = folder
            .g7(&[&["service", "install", "my plant/tank.g7", "--print"], more].concat())
            .is(0)
            .out
            .clone();
        folder.write("g7-tank.service", &unit);
        // The page of the manual is not installed beside a test.
        let analyze = Command::new("systemd-analyze")
            .args(["verify", "--man=no"])
            .arg(folder.path("g7-tank.service"))
            .output()
            .expect("it starts");
        let said = String::from_utf8_lossy(&analyze.stderr).into_owned();
        let ours: Vec<&str> = said.lines().filter(|line| line.contains("g7-tank")).collect();
        assert!(analyze.status.success() && ours.is_empty(), "{said}\n{unit}");
    }
}

/// A `systemctl` that writes down what it is asked for.
fn systemctl(folder: &Folder) -> String {
    folder.write("bin/systemctl", "#!/bin/sh\necho \"$@\" >> \"$(dirname \"$0\")/asked\"\n");
    let allowed = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(folder.path("bin/systemctl"), allowed).expect("it is ours");
    format!("{}:{}", folder.path("bin").display(), std::env::var("PATH").unwrap_or_default())
}

#[test]
fn a_service_of_the_user_is_installed_and_removed() {
    let folder = folder("");
    let path = systemctl(&folder);
    let config = folder.path("config");
    let g7 = |args: &[&str]| {
        common::Ran::from(folder.command(args).env("PATH", &path).env("XDG_CONFIG_HOME", &config).assert())
    };
    g7(&["service", "install", "my plant/tank.g7", "--user"]).is(0);
    assert!(folder.read("config/systemd/user/g7-tank.service").contains("[Service]"));
    g7(&["service", "remove", "g7-tank", "--user"]).is(0);
    assert!(!folder.path("config/systemd/user/g7-tank.service").exists());
    let asked = folder.read("bin/asked");
    let expected = ["--user daemon-reload", "--user disable --now g7-tank", "--user daemon-reload"];
    assert_eq!(asked.lines().collect::<Vec<_>>(), expected);

    folder.write("config/systemd/user/other.service", "[Service]\nExecStart=/bin/true\n");
    g7(&["service", "remove", "other", "--user"]).is_refused(&["other.service", "not written by g7"]);
    assert!(folder.path("config/systemd/user/other.service").exists());
    g7(&["service", "remove", "../other", "--user"]).is_refused(&["../other", "no name of a service"]);
    g7(&["service", "remove", "absent", "--user"]).is_refused(&["absent.service"]);
}

#[test]
fn a_chart_that_cannot_run_gets_no_unit() {
    let folder = folder("");
    let config = folder.path("config");
    let install = |args: &[&str]| {
        let args = [&["service", "install", "--user"], args].concat();
        common::Ran::from(folder.command(&args).env("XDG_CONFIG_HOME", &config).assert())
    };
    install(&["my plant/tank.g7", "--name", "a b"]).is_refused(&["`a b`", "--name"]);
    install(&["my plant/none.g7"]).is_refused(&["none.g7"]);
    folder.write(
        "my plant/tank.io.toml",
        "[devices.rack]\nkind = 'modbus-tcp'\nhost = 'x'\n[inputs]\nstop = 'rack.discrete(0)'\n",
    );
    let ran = install(&["my plant/tank.g7"]);
    assert!(ran.is(1).err.contains("stop"), "{}", ran.err);
    assert!(!config.exists());
}

/// The next words that a manager is told, without those of the pulse.
fn told(manager: &UnixDatagram, pulses: &mut u32) -> String {
    loop {
        let mut bytes = [0; 1024];
        let length = manager.recv(&mut bytes).expect("the controller tells how it goes");
        match String::from_utf8_lossy(&bytes[..length]).trim() {
            "WATCHDOG=1" => *pulses += 1,
            other => return other.to_owned(),
        }
    }
}

#[test]
fn the_service_manager_is_told_how_it_goes() {
    let folder = folder("");
    let socket = folder.path("notify");
    let manager = UnixDatagram::bind(&socket).expect("a socket of the test");
    manager.set_read_timeout(Some(Duration::from_secs(20))).expect("it has time-outs");
    let mut command = Command::new(cargo_bin!("g7"));
    command
        .args(["run", "my plant/tank.g7", "--online", "--simulate"])
        .env("NOTIFY_SOCKET", &socket)
        .env("WATCHDOG_USEC", "200000")
        .current_dir(folder.root());
    let mut g7 = Running::start(command, |child| Box::new(child.stderr.take().expect("piped")));
    let mut pulses = 0;
    assert_eq!(told(&manager, &mut pulses), "READY=1");
    // The controller runs as soon as it is started, and may run before it is first looked at.
    while told(&manager, &mut pulses) != "STATUS=running" {}
    g7.say("stop");
    assert_eq!(told(&manager, &mut pulses), "STATUS=stopped");
    while pulses < 5 {
        let mut bytes = [0; 64];
        let length = manager.recv(&mut bytes).expect("signs of life");
        assert_eq!(bytes[..length].trim_ascii(), b"WATCHDOG=1");
        pulses += 1;
    }
    g7.say("quit");
    assert_eq!(told(&manager, &mut pulses), "STOPPING=1");
}
