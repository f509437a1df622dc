//! Faults around a controller on line, each made again and again: what must hold, how often it was tried, and
//! how long it took.
//!
//! `make test` tries each a few times, `make faults` as often as the table of the book says. A row is printed
//! for each. Times are printed and not judged, but for the limits that the program itself promises.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

mod clock;
use crate::common;
mod crowd;
mod disk;
mod load;
mod soak;

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use common::Folder;
use common::talk::{Running, Slave, free_port};
use g7_peers::faults::{Times, many, row, trials};

/// One after the other: their times are those of a machine that does nothing else.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> std::sync::MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

const COUNTER: &str = "\
output lamp : BOOL
var n : LINT retain
chart Main {
  initial step 1 { N lamp  each scan: n := n + 1 }
  1 -> 1 when FALSE
}
";

#[test]
fn row_1_a_controller_that_is_killed_goes_on_with_what_it_had_saved() {
    let _alone = alone();
    let folder = Folder::with(COUNTER);
    folder.write("chart.io.toml", "[controller]\nperiod = '1ms'\nretain = 'kept'\n");
    let (mut times, mut before, mut warm) = (Times::default(), 0, 0);
    let count = trials(1_000, 6);
    for k in 0..count {
        let begin = Instant::now();
        let mut g7 = Running::online(&folder, &[]);
        loop {
            let line = g7.line();
            warm += u32::from(line.contains("warm start"));
            if line.contains("running") {
                break;
            }
        }
        times.add(begin.elapsed());
        // Saves come each 100 ms, so kills fall before, into and behind them.
        std::thread::sleep(Duration::from_millis(90 + u64::from(k * 37 % 170)));
        g7.signal("KILL");
        drop(g7);
        let now = saved(&folder.path("kept"));
        assert!(now >= before, "{now} after {before} in trial {k}");
        before = now;
    }
    assert_eq!(warm, count - 1, "all starts but the first are warm");
    row(1, "", count.into(), 0, format!("whole each time; start to RUN {times}"));
}

/// The value of `n`, the one retained variable, in the file of the kept values: that of the newest whole slot.
fn saved(file: &std::path::Path) -> u64 {
    let bytes = std::fs::read(file).expect("it was laid out at the start");
    let slots = bytes.chunks(bytes.len() / 2).filter_map(|slot| {
        let number = |at: usize| Some(u64::from_le_bytes(*slot.get(at..)?.first_chunk()?));
        let length = (number(8)? >> 32) as usize;
        let check = u32::from_le_bytes(*slot.get(32 + length..)?.first_chunk()?);
        let whole = check == crc32(slot.get(..32 + length)?);
        // Behind the text with the names, which has a length and is filled up to words.
        let text = number(32)? as usize;
        whole.then_some((number(24)?, number(40 + text.next_multiple_of(8))?))
    });
    let newest = slots.max_by_key(|(sequence, _)| *sequence).expect("one slot is whole at least");
    if newest.0 == 0 { 0 } else { newest.1 }
}

/// CRC-32 of ISO 3309.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0xEDB8_8320 } else { c >> 1 })
    })
}

const VALVE: &str = "\
input go : BOOL
input other : BOOL
output valve : BOOL
chart Main {
  initial step 1
  step 2 { N valve }
  1 -> 2 when go
  2 -> 1 when not go
}
";

/// Two devices; `other` must not be touched by what happens to `line1`.
fn two(ports: [u16; 2]) -> Folder {
    let folder = Folder::with(VALVE);
    let device = |name: &str, port: u16| {
        format!(
            "[devices.{name}]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\npoll = '20ms'\n\
             timeout = '200ms'\nretry = '1s'\n"
        )
    };
    let io = device("line1", ports[0])
        + &device("line2", ports[1])
        + "[inputs]\ngo = { at = 'line1.discrete(0)', bad = false }\nother = 'line2.discrete(0)'\n\
           [outputs]\nvalve = 'line1.coil(0)'\n";
    folder.write("chart.io.toml", io);
    folder
}

/// Takes the device away and gives it back; prints the row.
fn lost_and_found(
    (number, part): (usize, &str),
    count: u32,
    mut take: impl FnMut(Slave) -> Box<dyn FnOnce() -> Slave>,
) {
    let (Some(slave), Some(other)) = (Slave::start(0), Slave::start(0)) else { return };
    let folder = two([slave.port(), other.port()]);
    let mut g7 = Running::online(&folder, &[]);
    // They come in any order.
    let both = [g7.until("answers"), g7.until("answers")].concat();
    assert!(both.contains("line1") && both.contains("line2"), "{both}");
    let (mut slave, mut bad, mut back) = (slave, Times::default(), Times::default());
    for _ in 0..count {
        slave.set("discrete 0 1");
        slave.becomes("coil 0 1", "1");
        let begin = Instant::now();
        let give_back = take(slave);
        let line = g7.until("does not answer");
        assert!(line.contains("line1"), "the other device is unaffected: {line}");
        bad.add(begin.elapsed());
        let begin = Instant::now();
        slave = give_back();
        let line = g7.until("answers");
        assert!(line.contains("line1"), "{line}");
        back.add(begin.elapsed());
    }
    assert_eq!(g7.quit(), 0);
    row(
        number,
        part,
        count.into(),
        0,
        format!("bad after {bad}; back after {back}; the other one unaffected"),
    );
}

#[test]
fn row_7_a_slave_that_is_killed_is_bad_and_comes_back() {
    let _alone = alone();
    lost_and_found((7, "killed"), trials(200, 2), |slave| {
        let port = slave.port();
        drop(slave);
        Box::new(move || Slave::start(port).expect("it was there before"))
    });
}

#[test]
fn row_8_a_slave_that_is_silent_is_bad_and_comes_back() {
    let _alone = alone();
    lost_and_found((8, ""), trials(200, 2), |slave| {
        slave.signal("STOP");
        Box::new(move || {
            slave.signal("CONT");
            slave
        })
    });
}

#[test]
fn row_19_the_watchdog_of_a_device_ends_its_outputs_when_the_controller_is_killed() {
    let _alone = alone();
    let (Some(mut slave), Some(other)) = (Slave::with_watchdog("0.5"), Slave::start(0)) else { return };
    let folder = two([slave.port(), other.port()]);
    let (mut times, count) = (Times::default(), trials(100, 2));
    for _ in 0..count {
        let g7 = Running::online(&folder, &[]);
        slave.set("discrete 0 1");
        slave.becomes("coil 0 1", "1");
        let begin = Instant::now();
        g7.signal("KILL");
        slave.becomes("coil 0 1", "0");
        times.add(begin.elapsed());
    }
    row(19, "", count.into(), 0, format!("outputs off after {times} (the device waits 500 ms)"));
}

/// Two steps that alternate; each text has them, with other things beside them.
fn alternating(more: bool) -> String {
    let (input, step) = if more { ("input spare : BOOL\n", "  step 9 { N lamp }\n") } else { ("", "") };
    let chart =
        "output lamp : BOOL\noutput horn : BOOL\nvar n : LINT\nchart Main {\n  initial step 1 { N lamp }\n";
    format!(
        "{input}{chart}{step}  step 2 {{ N horn  P1 n := n + 1 }}\n  1 -> 2 when 70ms/X1\n  2 -> 1 when 30ms/X2\n}}\n"
    )
}

#[test]
fn row_23_a_chart_that_is_changed_again_and_again_leaves_no_scan_out() {
    let _alone = alone();
    let folder = Folder::with(&alternating(false));
    let priority = if many() { "priority = 50\n" } else { "" };
    folder.write("chart.io.toml", format!("[controller]\nperiod = '10ms'\nretain = 'kept'\n{priority}"));
    let mut g7 = Running::online(&folder, &[]);
    g7.until("running");
    let (mut times, mut missed, count) = (Times::default(), 0, trials(1_000, 20));
    for k in 0..count {
        folder.write("chart.g7", alternating(k % 2 == 0));
        let begin = Instant::now();
        g7.say("change");
        loop {
            let line = g7.line();
            missed += u32::from(line.contains("left out"));
            assert!(!line.contains("lost"), "{line}");
            if line.contains("goes on with the changed chart") {
                break;
            }
        }
        times.add(begin.elapsed());
        // A bad change is refused whole.
        if k % 10 == 0 {
            folder.write("chart.g7", "chart Main {");
            g7.say("change");
            g7.until("chart.g7: ");
        }
    }
    assert_eq!(g7.quit(), 0);
    row(23, "", count.into(), missed.into(), format!("bad ones refused whole; a change took {times}"));
}

/// A slave of Modbus TCP that has only zeros; it tells of each request.
fn answer(mut stream: TcpStream, number: usize, tell: &Sender<(usize, Instant)>) -> Option<()> {
    let mut head = [0; 8];
    loop {
        stream.read_exact(&mut head).ok()?;
        let mut rest = vec![0; usize::from(u16::from_be_bytes([head[4], head[5]])).checked_sub(2)?];
        stream.read_exact(&mut rest).ok()?;
        let body: &[u8] = if head[7] == 2 { &[1, 0] } else { rest.get(..4)? };
        let length = (body.len() + 2) as u16;
        let mut frame = head.to_vec();
        frame[4..6].copy_from_slice(&length.to_be_bytes());
        frame.extend(body);
        stream.write_all(&frame).ok()?;
        if head[7] == 2 {
            tell.send((number, Instant::now())).ok()?;
        }
    }
}

#[test]
fn row_11_dead_slaves_do_not_slow_the_others() {
    const DEAD: usize = 30;
    let _alone = alone();
    let (tell, told) = channel();
    let all = if many() { 100 } else { 40 };
    let (mut io, mut inputs, mut chart) = (String::new(), String::new(), String::new());
    for number in 0..all {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
        let port = listener.local_addr().expect("it has an address").port();
        io += &format!(
            "[devices.d{number}]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {}\npoll = '20ms'\ntimeout = '200ms'\nretry = '1s'\n",
            if number < DEAD { free_port() } else { port }
        );
        inputs += &format!("i{number} = {{ at = 'd{number}.discrete(0)', bad = false }}\n");
        chart += &format!("input i{number} : BOOL\n");
        if number >= DEAD {
            let tell = tell.clone();
            std::thread::spawn(move || {
                for stream in listener.incoming().flatten() {
                    answer(stream, number, &tell);
                }
            });
        }
    }
    let folder = Folder::with(&format!("{chart}chart Main {{\n  initial step 1\n  1 -> 1 when FALSE\n}}\n"));
    folder.write("chart.io.toml", io + "[inputs]\n" + &inputs);
    let seconds = if many() { 60 } else { 2 };
    let mut g7 = Running::online(&folder, &[]);
    for _ in DEAD..all {
        g7.until("answers");
    }
    while told.try_recv().is_ok() {}
    std::thread::sleep(Duration::from_secs(seconds));
    assert_eq!(g7.quit(), 0);
    let mut last = vec![None; all];
    let mut pauses = Times::default();
    for (number, at) in told.try_iter() {
        if let Some(before) = last[number].replace(at) {
            pauses.0.push(at - before);
        }
    }
    let polls = pauses.0.len() as f64 / (all - DEAD) as f64 / seconds as f64;
    assert!(last.iter().skip(DEAD).all(Option::is_some), "each of the others is asked");
    let held = format!("{seconds} s, {polls:.1} polls a second of each other one; pauses {pauses}");
    row(11, &format!("{all} at 20 ms, {DEAD} of them dead"), all as u64, 0, held);
}
