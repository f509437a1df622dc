//! `g7 plant`: the plant of a chart answers in the place of its devices.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use std::time::{Duration, Instant};

use common::Folder;
use common::talk::{Master, Running, free_port};

/// A tank that a valve fills, with a button beside it.
const CHART: &str = "\
profile iec60848
input go : BOOL
input level : REAL
output valve : BOOL safe FALSE
output lamp : BOOL inverted safe TRUE
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve }
  step 3
  1 -> 2 when go
  2 -> 3 when level >= 2.5
  3 -> 1 when not go
}
plant Tank {
  state height : REAL
  each { IF valve THEN height := MIN(height + 0.5, 3.0) END_IF }
  drive level := height
}
";

fn io(port: u16) -> String {
    format!(
        "[devices.line1]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\n\
         [inputs]\ngo = 'line1.discrete(3)'\nlevel = {{ at = 'line1.input(4)', as = 'f32' }}\n\
         [outputs]\nvalve = 'line1.coil(2)'\nlamp = 'line1.holding(9.4)'\n"
    )
}

fn folder(port: u16) -> Folder {
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", io(port));
    folder
}

#[test]
fn a_controller_of_g7_drives_a_plant_of_g7_over_modbus() {
    let folder = folder(free_port());
    let mut plant = Running::g7(&folder, &["plant", "chart.g7"]);
    plant.until("running");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("line1 answers");
    plant.until("line1 has a master");
    plant.say("go := TRUE");
    plant.say("gone := TRUE");
    plant.until("there is no `gone`");
    plant.say("level := much");
    plant.until("not a number");
    // The valve fills the tank; the chart stays in step 3 while the button is held.
    let begin = Instant::now();
    let full = |out: &str| {
        let value = |name| {
            out.lines()
                .map(|l| l.split_whitespace().collect::<Vec<&str>>())
                .find(|l| l.first() == Some(&name))
        };
        let level: f64 = value("level").map_or(0.0, |l| l[2].parse().expect("a number"));
        level >= 2.5 && value("valve").is_some_and(|l| l[2] == "FALSE")
    };
    while !full(&folder.g7(&["devices"]).is(0).out) {
        assert!(begin.elapsed() < Duration::from_secs(20), "{}", folder.g7(&["devices"]).out);
    }
    g7.say("quit");
    let line = g7.until("the situation is");
    assert!(line.contains("{3}"), "{line}");
    plant.until("line1 has no master");
    assert_eq!(plant.quit(), 0);
}

#[test]
fn a_master_of_pymodbus_finds_the_points_of_the_io_file() {
    let port = free_port();
    let folder = folder(port);
    let mut plant = Running::g7(&folder, &["plant", "--listen", "127.0.0.1"]);
    plant.until("running");
    let Some(mut master) = Master::start(port) else { return };
    master.until("read discrete 3 1", "0");
    plant.say("go := TRUE");
    master.until("read discrete 3 1", "1");
    assert_eq!(master.says("write coil 2 1"), "ok");
    // The tank is full at 3.0, which is 40400000 (IEEE 754).
    master.until("read input 4 2", "16448 0");
    assert_eq!(master.says("write coil 2 0"), "ok");
    // The write counts from the next step of the plant, which the line may come before.
    let begin = Instant::now();
    while master.says("read input 4 2") != "0 0" {
        assert!(begin.elapsed() < Duration::from_secs(20), "the valve is shut, and the tank empty");
        plant.say("height := 0.0");
        std::thread::sleep(Duration::from_millis(50));
    }
    // It is the plant's, or it is not wired.
    assert_eq!(master.says("write coil 3 1"), "exception 2");
    assert_eq!(master.says("read holding 8 1"), "exception 2");
    // A controller that is gone has left its valve open: the device closes it.
    assert_eq!(master.says("write coil 2 1"), "ok");
    drop(master);
    plant.until("line1 has no master: no request for 1s");
    plant.say("height := 0.0");
    let mut master = Master::start(port).expect("it was there before");
    master.until("read input 4 2", "0 0");
    assert_eq!(plant.quit(), 0);
}

#[test]
fn what_cannot_be_mirrored_is_refused() {
    let folder = folder(1502);
    folder.write("far.toml", io(1502).replace("127.0.0.1", "192.0.2.1"));
    folder.g7(&["plant", "--io", "far.toml"]).is_refused(&["line1 is at 192.0.2.1", "--listen"]);
    let serial = io(1).replace("modbus-tcp'\nhost = '127.0.0.1'\nport = 1", "modbus-rtu'\nport = '/dev/x'");
    folder.write("serial.toml", serial);
    folder.g7(&["plant", "--io", "serial.toml"]).is_refused(&["line1 is on the serial line /dev/x"]);
    let second = "[devices.line2]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = 1502\nunit = 2\n";
    folder.write("two.toml", io(1502).replace("lamp = 'line1", "lamp = 'line2") + second);
    folder.g7(&["plant", "--io", "two.toml"]).is_refused(&["line2 and line1 would both listen"]);
    folder.write("none.toml", "");
    folder.g7(&["plant", "--io", "none.toml"]).is_refused(&["no device of Modbus TCP"]);
    folder.write("bare.g7", CHART.split("plant Tank").next().expect("the chart"));
    folder.g7(&["plant", "bare.g7", "--io", "chart.io.toml"]).is_refused(&["bare.g7 has no plant"]);
    let wrong = folder.g7(&["plant", "--listen", "here"]);
    assert!(wrong.is(2).err.contains("--listen"), "{}", wrong.err);
}

#[test]
fn a_plant_reads_and_drives_members_of_structures() {
    let text = "struct Limit { open : BOOL closed : BOOL }
struct Tank { level : REAL valve : BOOL }
input limit : ARRAY[1..2] OF Limit
input tank : Tank
output coil : ARRAY[1..2] OF Limit
var kept : Tank := (level := 4.0) retain
plant P {
  state place : REAL := 0.0
  rate place := 10.0 when coil[1].open
  drive limit[1].open := place > 5.0
  drive tank.level := place
}
chart G {
  initial step 1
  step 2 { N coil[1].open P1 kept := tank }
  1 -> 2 when not limit[1].open and tank.valve
  2 -> 1 when ↑limit[1].open
}
test \"t\" with P {
  set tank.valve := TRUE
  wait 300ms
  expect coil[1].open, kept.level = 0.0
  wait 400ms
  expect tank.level > 5.0, G.X1, kept.valve
  restart
  expect kept.valve, kept.level = 0.0
  force limit[2].closed := TRUE
  scan
  expect limit[2].closed
  release limit[2].closed
}
";
    let folder = Folder::with(text);
    let ran = folder.g7(&["test"]);
    assert!(ran.is(0).out.contains("1 passed, 0 failed"), "{}", ran.out);
}
