//! `g7 devices` and `g7 run --online` with a controller of Siemens: the server of python-snap7.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use common::Folder;
#[cfg(feature = "s7")]
use common::talk::{Running, S7};

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : REAL
input far : INT
output valve : BOOL
output speed : INT safe -1
chart Main {
  initial step 1
  step 2 { N valve  P1 speed := REAL_TO_INT(level) }
  1 -> 2 when go
  2 -> 1 when not go
}
";

fn io(port: &str) -> String {
    format!(
        "[controller]\nwatchdog = '20s'\n[devices.plc]\nkind = 's7'\nhost = '127.0.0.1'\nport = {port}\n\
         [inputs]\ngo = 'plc.I0.3'\nlevel = {{ at = 'plc.DB1.DBD4', scale = 10.0 }}\nfar = 'plc.DB9.DBW0'\n\
         [outputs]\nvalve = 'plc.Q4.0'\nspeed = 'plc.DB1.DBW100'\n"
    )
}

#[cfg(not(feature = "s7"))]
#[test]
fn a_build_without_the_kind_says_so() {
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", io("1"));
    let refused = folder.g7(&["devices"]);
    for part in ["chart.io.toml:3:10", "no devices of the kind \"s7\"", "--features s7", "G0701"] {
        assert!(refused.is(1).err.contains(part), "{part}: {}", refused.err);
    }
    folder.g7(&["devices", "--gpio", "/dev/x", "--read", "line(1)"]).is_refused(&["--features gpio"]);
}

#[cfg(feature = "s7")]
#[test]
fn a_controller_of_siemens_gives_inputs_and_takes_outputs() {
    let Some(mut plc) = S7::start() else { return };
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", io(&plc.place));
    // 1.5 is 3FC00000.
    plc.set("db1 4 63 192 0 0");
    plc.set("db1 100 255 254");
    let asked = folder.g7(&["devices"]);
    let lines: Vec<&str> = asked.is(1).out.lines().collect();
    assert!(
        lines[0].starts_with("plc 127.0.0.1:") && lines[0].contains("rack 0 slot 1 answers in"),
        "{}",
        asked.out
    );
    let expected = [
        "  go     I0.3        FALSE",
        "  level  DB1.DBD4    15 (from 1.5)",
        "  far    DB9.DBW0    it has no such data block",
        "  valve  Q4.0        FALSE",
        "  speed  DB1.DBW100  -2",
    ];
    assert_eq!(lines[1..], expected);
    let place = format!("127.0.0.1:{}", plc.place);
    let by_hand =
        folder.g7(&["devices", "--s7", &place, "--read", "DB1.DBW100", "--as", "i16", "--read", "I0.3"]);
    assert!(by_hand.is(0).out.contains("DB1.DBW100  -2"), "{}", by_hand.out);
    let mut g7 = Running::online(&folder, &[]);
    g7.until("no value for `far`: it has no such data block");
    plc.becomes("db1 100 2", "0 0");
    plc.set("i 0 8");
    plc.becomes("q 4 1", "1");
    plc.becomes("db1 100 2", "0 15");
    g7.say("stop");
    plc.becomes("q 4 1", "0");
    plc.becomes("db1 100 2", "255 255");
    // It is found again, at the same port.
    g7.say("run");
    plc.becomes("q 4 1", "1");
    assert_eq!(g7.quit(), 0);
    plc.becomes("q 4 1", "0");
}

#[cfg(feature = "gpio")]
#[test]
fn a_chip_that_is_not_there_is_told() {
    let folder = Folder::with(
        "input go : BOOL\noutput lamp : BOOL\nchart M { initial step 1 { N lamp }\n 1 -> 1 when go\n}\n",
    );
    folder.write(
        "chart.io.toml",
        "[devices.board]\nkind = 'gpio'\nchip = '/dev/g7-has-no-such-chip'\n[inputs]\n\
         go = { at = 'board.line(4)', bias = 'pull-up', active-low = true, debounce = '5ms' }\n\
         [outputs]\nlamp = 'board.line(17)'\n",
    );
    let asked = folder.g7(&["devices"]);
    assert!(asked.is(1).out.contains("board /dev/g7-has-no-such-chip does not answer"), "{}", asked.out);
}
