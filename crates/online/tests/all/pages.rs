//! The problem pages of io files hold what they say, and so does the book.
#![allow(clippy::disallowed_methods, reason = "the pages are read")]

use std::path::PathBuf;

use g7_model::{FileId, codes};
use g7_online::{setup, wire};
use g7_rig::{Options, Source, build};

const CHART: &str = "\
profile iec60848
input start : BOOL at %I0.3
input line1_ok : BOOL
input level : REAL
input weight : DINT
input auto : BOOL
input attended : BOOL
input amount : REAL
input mode : INT
output ready : BOOL
output alarm : BOOL
output count : INT
output valve : BOOL
output speed : INT
chart Main {
  initial step 1
  step 2 { N valve  P1 speed := 3 }
  1 -> 2 when start and level > 2.0 and weight > 3
  2 -> 1 when not start or not line1_ok
}
";

/// The ids of the problems of an io file for this chart.
fn reported(io: &str) -> Vec<&'static str> {
    let source = Source::new("chart.g7", CHART.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let (setup, mut problems) = setup::read(io, FileId(1));
    problems.extend(wire(&bench, &setup).1);
    for problem in &problems {
        assert!(problem.at.end as usize <= io.len(), "a place: {problem:?}");
    }
    problems.iter().map(|p| p.code.id).collect()
}

fn book(name: &str) -> String {
    let file: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "..", "..", "docs", "book", "src", name].iter().collect();
    std::fs::read_to_string(file).expect(name)
}

/// The TOML blocks of a page; true for those that are wrong.
fn blocks(page: &str) -> Vec<(bool, &str)> {
    let mut blocks = Vec::new();
    for piece in page.split("\n```toml").skip(1) {
        let (fence, rest) = piece.split_once('\n').expect("a line behind the fence");
        blocks.push((fence == ",wrong", rest.split("\n```").next().expect("a block")));
    }
    blocks
}

#[test]
fn each_code_of_io_files_has_a_page_that_holds() {
    let of_io = codes::ALL.iter().filter(|c| c.id.starts_with("G07"));
    for code in of_io {
        let page = book(&format!("problems/{}.md", code.id));
        assert!(page.starts_with(&format!("# {}: {}\n", code.id, code.title)), "{}: heading", code.id);
        assert!(page.contains(code.source), "{}: source", code.id);
        let blocks = blocks(&page);
        assert!(blocks.iter().any(|(wrong, _)| *wrong), "{}: no example", code.id);
        for (wrong, toml) in blocks {
            let reported = reported(toml);
            if wrong {
                assert!(
                    reported.iter().all(|id| *id == code.id) && !reported.is_empty(),
                    "{toml}\n{reported:?}"
                );
            } else {
                assert!(reported.is_empty(), "{toml}\n{reported:?}");
            }
        }
    }
}

#[test]
fn the_io_files_of_the_book_have_no_problem() {
    let page = book("online/io-file.md");
    for (wrong, block) in blocks(&page) {
        // The page shows both ways to name an input, by its name and by its address. A file may use only
        // one of them for each input, so the row with the address is left out here.
        assert_eq!(reported(&block.replace("\"%I0.3\" = ", "# ")), [""; 0], "{block}");
        assert!(!wrong, "{block}");
    }
}

#[test]
fn a_press_is_not_shorter_than_a_scan() {
    let io = "[devices.p]\nkind = 'panel'\npress = '100ms'\n[inputs]\nstart = 'p.button()'";
    let of = |scan: &str| {
        let source = Source::new("chart.g7", format!("{CHART}scan {scan}\n").into_bytes(), 0);
        let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        wire(&bench, &setup::read(io, FileId(1)).0).1.len()
    };
    assert_eq!((of("100ms"), of("101ms")), (0, 1));
}

#[test]
fn every_mistake_has_its_code() {
    let devices = "[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\n[devices.m]\nkind = 'mqtt'\nhost = 'x'\n";
    let cases: &[(&str, &[&str])] = &[
        ("[inputs", &["G0701"]),
        ("inputs = 3", &["G0701"]),
        ("[surprise]", &["G0701"]),
        ("[devices.a]\nkind = 'profibus'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-tcp'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\nport = 0", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\npoll = '0s'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-rtu'\nport = '/dev/x'\nparity = 'mark'", &["G0701"]),
        (
            "[devices.a]\nkind = 'modbus-rtu'\nport = '/dev/x'\n[devices.b]\nkind = 'modbus-rtu'\nport = '/dev/x'\n\
             unit = 2\nbaud = 9600",
            &["G0701"],
        ),
        (
            "[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\n[devices.b]\nkind = 'modbus-tcp'\nhost = 'x'\n\
             [outputs]\nvalve = 'a.holding(2.0)'\nspeed = 'b.holding(2)'",
            &["G0704"],
        ),
        ("[devices.a]\nkind = 'modbus-server'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-server'\nlisten = 'here'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-server'\nlisten = '0.0.0.0:502'", &["G0701"]),
        ("[devices.a]\nkind = 'modbus-server'\nlisten = '0.0.0.0:502'\naccess = 'anyone'", &[]),
        ("[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:502'", &[]),
        ("[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:502'\npoll = '10ms'", &["G0701"]),
        (
            "[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:5'\n[devices.b]\nkind = 'modbus-server'\n\
             listen = '[::1]:5'",
            &["G0701"],
        ),
        (
            "[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:5'\n[inputs]\nstart = 'a.discrete(1)'",
            &["G0703"],
        ),
        (
            "[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:5'\n[inputs]\nstart = 'a.coil(1)'\n\
             [outputs]\nvalve = 'a.coil(1)'",
            &["G0704"],
        ),
        (
            "[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:5'\n[outputs]\nvalve = 'a.discrete(1)'\n\
             [shown]\nvalve = 'a.coil(1)'\nX2 = 'a.coil(2)'\nstart = 'a.coil(3)'\nweight = 'a.input(3)'",
            &[],
        ),
        (
            "[devices.a]\nkind = 'modbus-server'\nlisten = '[::1]:5'\n[shown]\nX9 = 'a.coil(1)'\n\
             X2 = 'a.input(2)'",
            &["G0702", "G0703"],
        ),
        ("[devices.p]\nkind = 'panel'", &[]),
        ("[devices.p]\nkind = 'panel'\nrelease = '100ms'", &["G0701"]),
        ("[devices.p]\nkind = 'panel'\npoll = '10ms'", &["G0701"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nmode = 'p.choice(A1)'", &["G0701"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nmode = 'p.choice(A1, A1)'", &["G0701"]),
        ("[devices.p]\nkind = 'panel'\n[outputs]\nready = 'p.lamp(pink)'", &["G0701"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nauto = 'p.choice(A1, F1)'", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nauto = 'p.lamp()'", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nauto = 'p.good()'", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[outputs]\nready = 'p.switch()'", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[outputs]\ncount = 'p.lamp()'", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\npress = '10ms'\n[inputs]\nstart = 'p.button()'", &[]),
        ("[controller]\nperiod = '20ms'\n[devices.p]\nkind = 'panel'\n[inputs]\nauto = 'p.button()'", &[]),
        (
            "[devices.p]\nkind = 'panel'\n[inputs]\namount = { at = 'p.number()', min = 5, max = 1 }",
            &["G0701"],
        ),
        (
            "[devices.p]\nkind = 'panel'\n[inputs]\namount = { at = 'p.number()', max = 1, initial = 2 }",
            &["G0701"],
        ),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nauto = { at = 'p.switch()', min = 0 }", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\namount = { at = 'p.number()', scale = 2 }", &["G0703"]),
        ("[devices.p]\nkind = 'panel'\n[inputs]\nmode = { at = 'p.number()', initial = 99999 }", &["G0703"]),
        (
            "[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\n[inputs]\nlevel = { at = 'a.input(0)', max = 3 }",
            &["G0703"],
        ),
        ("[devices.a]\nkind = 'modbus-tcp'\nhost = 'x'\n[inputs]\nauto = 'a.button()'", &["G0703"]),
        ("[devices.m]\nkind = 'mqtt'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nunit = 1", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\ntls = true", &[]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\ntls = { ca = 'ca.pem' }", &[]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\ntls = 'yes'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\ntls = { certificate = 'a.pem' }", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\ntls = { cert = 'a.pem' }", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = 'plant/events'", &[]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = 5", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = 'plant/#'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = '$SYS/a'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = { most = 1000 }", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = { topic = 'a', most = 9 }", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = { topic = 'a', file = '../b' }", &["G0701"]),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nevents = 'a'\nsparkplug = { group = 'g', node = 'n' }",
            &["G0701"],
        ),
        ("[devices.p]\nkind = 's7'", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\nrack = 8", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\nslot = 32", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\nconnection = 'other'", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nstart = 'p.I0.3'\nlevel = 'p.DB1.DBD4'", &[]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nstart = 'p.M0.8'", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nstart = 'p.DB0.DBX0.0'", &["G0701"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nstart = 'p.DB1.DBW0'", &["G0703"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nlevel = 'p.M0.0'", &["G0703"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[inputs]\nstart = 'p.coil(1)'", &["G0703"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[outputs]\nvalve = 'p.I0.0'", &["G0703"]),
        ("[devices.p]\nkind = 's7'\nhost = 'x'\n[outputs]\nvalve = 'p.M2.3'\nspeed = 'p.MW2'", &["G0704"]),
        ("[inputs]\nstart = 'a.M0.0'", &["G0703"]),
        ("[devices.g]\nkind = 'gpio'", &["G0701"]),
        (
            "[devices.g]\nkind = 'gpio'\nchip = '/dev/gpiochip0'\n[inputs]\n\
             start = { at = 'g.line(4)', bias = 'pull-up', active-low = true, debounce = '5ms' }",
            &[],
        ),
        ("[devices.g]\nkind = 'gpio'\nchip = 'c'\n[inputs]\nstart = 'g.line(x)'", &["G0701"]),
        ("[devices.g]\nkind = 'gpio'\nchip = 'c'\n[inputs]\nlevel = 'g.line(4)'", &["G0703"]),
        (
            "[devices.g]\nkind = 'gpio'\nchip = 'c'\n[inputs]\nstart = { at = 'g.line(4)', bias = 'up' }",
            &["G0701"],
        ),
        (
            "[devices.g]\nkind = 'gpio'\nchip = 'c'\n[inputs]\nstart = 'g.line(4)'\n\
             [outputs]\nvalve = 'g.line(4)'",
            &["G0704"],
        ),
        ("[inputs]\nstart = { at = 'a.coil(1)', debounce = '5ms' }", &["G0703"]),
        ("[inputs]\nstart = 'a.line(4)'", &["G0703"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\npassword = 'y'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\npassword-file = 'y'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nuser = 'u'\npassword-file = 'y'", &[]),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nuser = 'u'\npassword-file = 'y'\npassword-env = 'z'",
            &["G0701"],
        ),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nclient-id = ''", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nkeep-alive = '100ms'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nstatus = 'a/#'", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nstatus = '$SYS/a'", &["G0701"]),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\npoll = '1s'\ntimeout = '1s'\nrefresh = '1m'\nretry = '5s'\n\
             keep-alive = '1m'\nclient-id = 'g7'\nstatus = 'plant/g7'",
            &[],
        ),
        ("[inputs]\nstart = 'm.topic(a)'\nlevel = 'm.topic($SYS/a(b).c)'\nline1_ok = 'm.good()'", &[]),
        (
            "[inputs]\nlevel = { at = 'm.topic(a)', field = 'x' }\n\
             weight = { at = 'm.topic(a)', field = '/y/0', qos = 0, silence = '1m', scale = 2, bad = 3 }",
            &[],
        ),
        (
            "[outputs]\nvalve = { at = 'm.topic(a)', retain = false, qos = 0, will = true, field = 'v' }\n\
             [shown]\nX2 = { at = 'm.topic(b)', retain = true }",
            &[],
        ),
        ("[inputs]\nstart = 'm.topic(a/+)'", &["G0701"]),
        ("[inputs]\nstart = 'm.topic(#)'", &["G0701"]),
        ("[inputs]\nstart = 'm.topic()'", &["G0701"]),
        ("[inputs]\nstart = { at = 'm.topic(a)', retain = true }", &["G0701"]),
        ("[inputs]\nstart = { at = 'm.topic(a)', qos = 2 }", &["G0701"]),
        ("[inputs]\nstart = { at = 'm.topic(a)', field = 3 }", &["G0701"]),
        ("[outputs]\nvalve = { at = 'm.topic(a)', silence = '1s' }", &["G0701"]),
        ("[outputs]\nvalve = { at = 'm.topic(a)', retain = 'yes' }", &["G0701"]),
        ("[outputs]\nvalve = 'm.topic($SYS/a)'", &["G0703"]),
        ("[outputs]\nspeed = { at = 'm.topic(a)', as = 'i32' }", &["G0703"]),
        ("[outputs]\nvalve = { at = 'm.topic(a)', scale = 2 }", &["G0703"]),
        ("[inputs]\nweight = { at = 'm.topic(a)', bad = 2.5 }", &["G0703"]),
        ("[inputs]\nstart = 'm.coil(1)'", &["G0703"]),
        ("[inputs]\nstart = 'a.topic(b)'", &["G0703"]),
        ("[inputs]\nstart = { at = 'a.coil(1)', silence = '1s' }", &["G0703"]),
        ("[outputs]\nvalve = { at = 'a.coil(1)', retain = true }", &["G0703"]),
        ("[shown]\nX2 = { at = 'm.topic(a)', will = true }", &["G0703"]),
        ("[outputs]\nvalve = 'm.topic(a)'\nspeed = { at = 'm.topic(a)', field = 'x' }", &["G0704"]),
        ("[outputs]\nvalve = 'm.topic(a)'\n[shown]\nX2 = 'm.topic(a)'", &["G0704"]),
        (
            "[outputs]\nvalve = { at = 'm.topic(a)', will = true }\nspeed = { at = 'm.topic(b)', will = true }",
            &["G0704"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nstatus = 's'\n\
             [outputs]\nvalve = { at = 'm.topic(a)', will = true }",
            &["G0703"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\n[devices.n]\nkind = 'mqtt'\nhost = 'x'\nuser = 'u'\n\
             [outputs]\nvalve = 'm.topic(a)'\nspeed = 'n.topic(a)'",
            &["G0704"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g', node = 'n', device = 'd' }\n\
             [inputs]\nstart = 'm.metric()'\nlevel = { at = 'm.metric(Tank/Level)', scale = 2, bad = 1 }\n\
             [outputs]\nvalve = 'm.metric(Valve 1)'\n[shown]\nX2 = 'm.metric()'",
            &[],
        ),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g' }", &["G0701"]),
        ("[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g', node = 'a/b' }", &["G0701"]),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g', node = 'n', host = 'h' }",
            &["G0701"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nstatus = 's'\nsparkplug = { group = 'g', node = 'n' }",
            &["G0701"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g', node = 'n' }\n\
             [inputs]\nstart = 'm.topic(a)'\nlevel = { at = 'm.metric()', qos = 0 }\nweight = 'm.metric(bdSeq)'",
            &["G0703", "G0703", "G0703"],
        ),
        (
            "[devices.m]\nkind = 'mqtt'\nhost = 'x'\nsparkplug = { group = 'g', node = 'n' }\n\
             [inputs]\nstart = 'm.metric(a)'\n[outputs]\nvalve = 'm.metric(a)'",
            &["G0704"],
        ),
        ("[inputs]\nstart = 'm.metric()'", &["G0703"]),
        ("[inputs]\nstart = 'a.metric()'", &["G0703"]),
        ("[shown]\nX2 = 'a.coil(1)'", &["G0703"]),
        ("[shown]\nX2 = { at = 'a.coil(1)', bad = true }", &["G0701", "G0703"]),
        ("[controller]\nperiod = 10", &["G0701"]),
        ("[controller]\npriority = 100", &["G0701"]),
        ("[controller]\nmetrics = '127.0.0.1:9464'", &[]),
        ("[controller]\nmetrics = '0.0.0.0:9464'", &["G0701"]),
        ("[controller]\nmetrics = '9464'", &["G0701"]),
        ("[controller]\nchanged = 'maybe'", &["G0701"]),
        ("[inputs]\nstart = 'a'", &["G0701"]),
        ("[inputs]\nstart = 'a.coil(65536)'", &["G0701"]),
        ("[inputs]\nstart = 'a.coil(1.2)'", &["G0701"]),
        ("[inputs]\nstart = 'a.holding(1.16)'", &["G0701"]),
        ("[inputs]\nstart = 'a.good(1)'", &["G0701"]),
        ("[inputs]\nstart = { bad = true }", &["G0701"]),
        ("[inputs]\nstart = { at = 'a.coil(1)', bad = 'maybe' }", &["G0701"]),
        ("[outputs]\nvalve = { at = 'a.coil(1)', bad = true }", &["G0701"]),
        ("[inputs]\nlevel = { at = 'a.input(1)', scale = 0 }", &["G0701"]),
        ("[inputs]\nstart = 'b.coil(1)'", &["G0702"]),
        ("[inputs]\nvalve = 'a.coil(1)'", &["G0702"]),
        ("[outputs]\nstart = 'a.coil(1)'", &["G0702"]),
        ("[inputs]\n'%I0.9' = 'a.coil(1)'", &["G0702"]),
        ("[outputs]\nvalve = 'a.good()'", &["G0703"]),
        ("[inputs]\nlevel = 'a.good()'", &["G0703"]),
        ("[inputs]\nlevel = 'a.holding(1.2)'", &["G0703"]),
        ("[inputs]\nstart = 'a.holding(1)'", &["G0703"]),
        ("[inputs]\nlevel = 'a.input(65535)'", &["G0703"]),
        ("[outputs]\nspeed = 'a.input(1)'", &["G0703"]),
        ("[inputs]\nstart = { at = 'a.coil(1)', scale = 2.0 }", &["G0703"]),
        ("[inputs]\nstart = { at = 'a.coil(1)', bad = 3 }", &["G0703"]),
        ("[inputs]\nweight = { at = 'a.input(1)', bad = 2.5 }", &["G0703"]),
        ("[inputs]\nstart = 'a.coil(1)'\nSTART = 'a.coil(2)'", &["G0704"]),
        ("[inputs]\nstart = 'a.coil(1)'\n'%I0.3' = 'a.coil(2)'", &["G0704"]),
        ("[outputs]\nspeed = 'a.holding(3)'\nvalve = 'a.holding(3.15)'", &["G0704"]),
        ("[outputs]\nvalve = 'a.holding(3.0)'\nspeed = { at = 'a.holding(2)', as = 'i32' }", &["G0704"]),
    ];
    for (io, expected) in cases {
        let io = if io.contains("[devices") || io.starts_with("inputs") {
            (*io).to_owned()
        } else {
            format!("{devices}{io}")
        };
        assert_eq!(reported(&io), *expected, "{io}");
    }
}

#[test]
fn a_password_comes_from_elsewhere_and_is_never_shown() {
    let io = "[devices.a]\nkind = 'mqtt'\nhost = 'x'\nuser = 'u'\npassword-file = 'there'\n\
              [devices.b]\nkind = 'mqtt'\nhost = 'x'\nuser = 'u'\npassword-env = 'GONE'\n";
    let (mut setup, problems) = setup::read(io, FileId(1));
    assert!(problems.is_empty(), "{problems:?}");
    let problems = setup::read_secrets(&mut setup, |origin| match origin {
        setup::Origin::File(name) if name == "there" => Ok(b"sesame\n".to_vec()),
        setup::Origin::File(_) | setup::Origin::Variable(_) => {
            Err(g7_model::Said::foreign("it is not there"))
        }
    });
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert_eq!(
        (problem.code.id, &io[problem.at.start as usize..problem.at.end as usize]),
        ("G0701", "'GONE'")
    );
    assert!(problem.what.contains("it is not there"), "{problem:?}");
    assert!(!format!("{setup:?}").contains("sesame"));
}

#[test]
fn no_bytes_make_it_panic() {
    let whole =
        "[controller]\nperiod='1s'\n[devices.a]\nkind='modbus-tcp'\nhost='x'\n[inputs]\nstart='a.coil(1)'\n";
    for end in 0..whole.len() {
        reported(&whole[..end]);
        reported(&format!("{}\u{0}{}", &whole[..end], &whole[end..]));
    }
    reported(&"[".repeat(10_000));
    reported(&format!("a = {}", "[".repeat(10_000)));
    reported(&"é = 'ü'\n".repeat(3));
}

#[test]
fn what_is_half_said_of_users_and_the_log_is_a_problem() {
    let whole = "[controller]\nlog = 'l'\nlog-days = 30\nlog-mib = 5\n[server]\nhost = '0.0.0.0'\nport = 4700\n\
        users = 'u'\ncert = 'c'\nkey = 'k'\nidle = '1h'\nsession = '12h'\n";
    assert!(reported(whole).iter().all(|id| *id != "G0701"), "{:?}", reported(whole));
    for wrong in [
        "[server]\nusers = 'u'\n",
        "[server]\ncert = 'c'\n",
        "[server]\nkey = 'k'\n",
        "[server]\nhost = 'localhost'\n",
        "[server]\nport = 70000\n",
        "[server]\nidle = '1s'\n",
        "[server]\npassword = 'x'\n",
        "[controller]\nlog-days = 3\n",
        "[controller]\nlog = 'l'\nlog-days = 0\n",
    ] {
        assert!(reported(wrong).contains(&"G0701"), "{wrong}: {:?}", reported(wrong));
    }
}
