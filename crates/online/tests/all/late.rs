//! Slaves that answer late or wrongly, hundreds of times here and as often as the table of the book says with
//! `G7_FAULTS`: no value is ever that of another request, and no wrong length is taken (rows 9 and 10).
#![allow(clippy::disallowed_methods, reason = "devices answer in real time")]

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use g7_model::FileId;
use g7_online::{Absent, Clients, Device, Raw, setup, wire};
use g7_peers::faults::row;
use g7_rig::{Options, Source, build};
use serial2::SerialPort;

/// The addresses that are asked for, each by a request of its own.
const ADDRESSES: [u16; 3] = [0, 40, 80];
const CHART: &str = "\
profile iec60848
input a : INT
input b : INT
input c : INT
chart Main {
  initial step 1
  1 -> 1 when a = b and b = c
}
";

fn trials(many: u64, few: u64) -> u64 {
    if g7_peers::faults::many() { many } else { few }
}

/// The device of an io file that asks for the three addresses.
fn device(rows: &str) -> Box<dyn Device> {
    let source = Source::new("chart.g7", CHART.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let inputs = "[inputs]\na = 'd.holding(0)'\nb = 'd.holding(40)'\nc = 'd.holding(80)'\n";
    let (setup, problems) = setup::read(&format!("[devices.d]\n{rows}{inputs}"), FileId(1));
    assert!(problems.is_empty(), "{problems:?}");
    let (wiring, problems) = wire(&bench, &setup);
    assert!(problems.is_empty(), "{problems:?}");
    Clients::default().device(&wiring.devices[0]).expect("there are resources")
}

/// One exchange, on a new connection where the last one failed. Returns the values that came.
fn exchange(device: &mut dyn Device, up: &mut bool) -> Option<[Result<Raw, Absent>; 3]> {
    if !*up {
        device.connect().ok()?;
        *up = true;
    }
    let mut values = [const { Err(Absent::Unread) }; 3];
    if device.exchange(&[], &[], &mut values, &mut []).is_err() {
        device.close();
        *up = false;
        return None;
    }
    Some(values)
}

/// The value of an address is the address and something more.
fn right(values: &[Result<Raw, Absent>; 3]) -> bool {
    values.iter().zip(ADDRESSES).all(|(value, address)| *value == Ok(Raw::Whole(i128::from(1000 + address))))
}

/// Numbers without a pattern.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }
}

/// The frame of Modbus TCP that answers a request for one register rightly.
fn tcp_answer(request: &[u8]) -> Vec<u8> {
    let address = u16::from_be_bytes([request[8], request[9]]);
    let [high, low] = (1000 + address).to_be_bytes();
    vec![request[0], request[1], 0, 0, 0, 5, request[6], 3, 2, high, low]
}

fn listen() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = listener.local_addr().expect("an address").port();
    (listener, format!("kind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\ntimeout = '20ms'\n"))
}

#[test]
fn row_9_a_late_answer_over_tcp_is_no_answer_to_another_request() {
    let (listener, rows) = listen();
    let late = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&late);
    std::thread::spawn(move || {
        let mut random = Random(9);
        // The answer to the last request of an earlier connection comes on the next one, in front.
        let mut owed: Vec<u8> = Vec::new();
        for mut stream in listener.incoming().flatten() {
            let mut request = [0; 12];
            while stream.read_exact(&mut request).is_ok() {
                if random.below(3) == 0 {
                    count.fetch_add(1, Ordering::Relaxed);
                    owed = tcp_answer(&request);
                    if random.below(2) == 0 {
                        // On the same connection, behind the time-out.
                        std::thread::sleep(Duration::from_millis(25));
                        stream.write_all(&owed).ok();
                    }
                    continue;
                }
                let all = [std::mem::take(&mut owed), tcp_answer(&request)].concat();
                if stream.write_all(&all).is_err() {
                    break;
                }
            }
        }
    });
    let (mut device, mut up, mut good) = (device(&rows), false, 0);
    let wanted = trials(10_000, 40);
    while late.load(Ordering::Relaxed) < wanted || good == 0 {
        if let Some(values) = exchange(&mut *device, &mut up) {
            assert!(right(&values), "{values:?}");
            good += 1;
        }
    }
    assert!(good > 0, "right answers are taken");
    row(9, "TCP", wanted, 0, format!("{good} exchanges were right, none was wrong"));
}

/// CRC-16/MODBUS.
fn crc(bytes: &[u8]) -> [u8; 2] {
    let all = bytes.iter().fold(0xffff_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0xa001 } else { c >> 1 })
    });
    all.to_le_bytes()
}

fn framed(body: &[u8]) -> Vec<u8> {
    [body, &crc(body)].concat()
}

/// The answer of a slave to a request of eight bytes; one that does not know the echo says so.
fn rtu_answer(request: &[u8; 8], knows_echo: bool) -> Vec<u8> {
    match request[1] {
        8 if knows_echo => request.to_vec(),
        8 => framed(&[1, 0x88, 1]),
        _ => {
            let [high, low] = (1000 + u16::from_be_bytes([request[2], request[3]])).to_be_bytes();
            framed(&[1, 3, 2, high, low])
        }
    }
}

/// The slave's end of a serial line, and the rows of the io file for the master's end, which must be kept.
fn serial() -> (SerialPort, SerialPort, String) {
    let (own, other) = SerialPort::pair().expect("the system has lines");
    let descriptor = std::os::fd::AsRawFd::as_raw_fd(&other);
    let path = std::fs::read_link(format!("/proc/self/fd/{descriptor}")).expect("a path");
    // One end has no path of its own; then they are exchanged.
    let (own, other, path) = if path.starts_with("/dev/pts") {
        (own, other, path)
    } else {
        let descriptor = std::os::fd::AsRawFd::as_raw_fd(&own);
        let path = std::fs::read_link(format!("/proc/self/fd/{descriptor}")).expect("a path");
        (other, own, path)
    };
    let rows = format!(
        "kind = 'modbus-rtu'\nport = '{}'\nbaud = 115200\nparity = 'none'\ntimeout = '20ms'\n",
        path.display()
    );
    (own, other, rows)
}

fn late_over_serial(knows_echo: bool) {
    let (mut own, _kept, rows) = serial();
    own.set_read_timeout(Duration::from_secs(3_600)).expect("set");
    let late = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&late);
    std::thread::spawn(move || {
        let mut random = Random(7);
        let mut request = [0; 8];
        // A slave answers in turn, each at its own time.
        while own.read_exact(&mut request).is_ok() {
            if random.below(8) == 0 {
                count.fetch_add(1, Ordering::Relaxed);
                // Behind one time-out or several, of this request and those that wait.
                std::thread::sleep(Duration::from_millis(15 + random.below(40)));
            }
            if own.write_all(&rtu_answer(&request, knows_echo)).is_err() {
                return;
            }
        }
    });
    let (mut device, mut up, mut good) = (device(&rows), false, 0);
    let wanted = trials(10_000, 15);
    while late.load(Ordering::Relaxed) < wanted || good == 0 {
        if let Some(values) = exchange(&mut *device, &mut up) {
            assert!(right(&values), "{values:?}");
            good += 1;
        }
    }
    let part = if knows_echo { "RTU" } else { "RTU, no echo" };
    row(9, part, wanted, 0, format!("{good} exchanges were right, none was wrong"));
}

#[test]
fn row_9_a_late_answer_over_a_serial_line_is_no_answer_to_another_request() {
    late_over_serial(true);
}

#[test]
fn row_9_the_same_with_a_slave_that_knows_no_echo() {
    late_over_serial(false);
}

/// The kinds of wrong answers over TCP; the last one is right.
const KINDS: u64 = 15;

/// An answer of a kind; true if the connection ends behind it.
fn wrong(kind: u64, request: &[u8], random: &mut Random) -> (Vec<u8>, bool) {
    let mut frame = tcp_answer(request);
    match kind {
        0 => frame[0] ^= 0x40,
        1 => frame[2] = 1,
        2 => frame[4..6].copy_from_slice(&[0, 0]),
        3 => frame[4..6].copy_from_slice(&[0, 1]),
        4 => frame[4..6].copy_from_slice(&[0xff, 0xff]),
        5 => frame.truncate(9),
        6 => frame.extend([1, 2, 3, 4]),
        7 => frame[6] ^= 1,
        8 => frame[7] = 4,
        9 => frame[8] = 4,
        10 => frame[8] = 0,
        // One register more than was asked for, by all of its lengths.
        11 => frame = [&frame[..4], &[0, 7, frame[6], 3, 4, frame[9], frame[10], 0, 0]].concat(),
        12 => frame = [&frame[..4], &[0, 3, frame[6], 0x83, random.below(256) as u8]].concat(),
        13 => frame = (0..random.below(300)).map(|_| random.below(256) as u8).collect(),
        _ => {}
    }
    (frame, kind != 14)
}

/// Exchanges with a slave that gives wrong answers of some kinds: a value is right, or there is none.
fn no_wrong_value(part: &str, rows: &str, wanted: u64, kinds: u64) {
    let (mut device, mut up, mut good) = (device(rows), false, 0);
    for _ in 0..wanted {
        let Some(values) = exchange(&mut *device, &mut up) else { continue };
        for (value, address) in values.iter().zip(ADDRESSES) {
            match value {
                Ok(raw) => assert_eq!(*raw, Raw::Whole(i128::from(1000 + address))),
                // An exception is an answer.
                Err(why) => assert!(matches!(why, Absent::Refused(_)), "{why:?}"),
            }
        }
        good += u64::from(values.iter().all(Result::is_ok));
    }
    assert!(good > 0, "right answers are taken");
    let held = format!("{kinds} kinds of answers, {good} exchanges were right, no wrong value");
    row(10, part, wanted, 0, held);
}

#[test]
fn row_10_wrong_answers_over_tcp_give_no_value() {
    let (listener, rows) = listen();
    std::thread::spawn(move || {
        let mut random = Random(10);
        let serve = |mut stream: TcpStream, random: &mut Random| {
            let mut request = [0; 12];
            while stream.read_exact(&mut request).is_ok() {
                let (frame, ends) = wrong(random.below(KINDS * 4).min(KINDS - 1), &request, random);
                if stream.write_all(&frame).is_err() || ends {
                    return;
                }
            }
        };
        for stream in listener.incoming().flatten() {
            serve(stream, &mut random);
        }
    });
    no_wrong_value("TCP", &rows, trials(1_000_000, 2_000), KINDS);
}

#[test]
fn row_10_wrong_answers_over_a_serial_line_give_no_value() {
    let (mut own, _kept, rows) = serial();
    own.set_read_timeout(Duration::from_secs(3_600)).expect("set");
    std::thread::spawn(move || {
        let (mut random, mut request) = (Random(11), [0; 8]);
        while own.read_exact(&mut request).is_ok() {
            let mut frame = rtu_answer(&request, true);
            if request[1] != 8 {
                match random.below(40) {
                    0 => frame[0] = 2,
                    1 => frame[1] = 4,
                    2 => frame = framed(&[1, 3, 4, 0, 1, 0, 2]),
                    3 => frame[2] = 0xff,
                    4 => frame[3] ^= 0x10,
                    5 => frame = framed(&[1, 0x83, random.below(256) as u8]),
                    6 => frame = framed(&[1, 99, 0, 0]),
                    7 => frame = (0..random.below(40)).map(|_| random.below(256) as u8).collect(),
                    _ => {}
                }
            }
            if own.write_all(&frame).is_err() {
                return;
            }
        }
    });
    no_wrong_value("RTU", &rows, trials(20_000, 60), 9);
}
