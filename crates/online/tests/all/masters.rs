//! Hostile masters on a server of our own (row 12): half-open connections, noise, illegal counts, masters that
//! do not read, and no descriptors left. The known master is served all the while.
#![cfg(unix)]
#![allow(clippy::disallowed_methods, reason = "masters ask in real time")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use g7_model::FileId;
use g7_online::{Clients, Device, Raw, setup, wire};
use g7_peers::faults::{Times, many, row};
use g7_rig::{Options, Source, build};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// The longest time that a test waits for what must come.
const PATIENCE: Duration = Duration::from_secs(20);

fn server() -> (Box<dyn Device>, SocketAddr) {
    let chart = "output lamp : BOOL\nchart Main {\n  initial step 1 { N lamp }\n  1 -> 1 when FALSE\n}\n";
    let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let free = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let address = free.local_addr().expect("an address");
    drop(free);
    let io = format!(
        "[devices.s]\nkind = 'modbus-server'\nlisten = '{address}'\n[outputs]\nlamp = 's.discrete(7)'\n"
    );
    let (setup, problems) = setup::read(&io, FileId(1));
    assert!(problems.is_empty(), "{problems:?}");
    let (wiring, problems) = wire(&bench, &setup);
    assert!(problems.is_empty(), "{problems:?}");
    let mut device = Clients::default().device(&wiring.devices[0]).expect("there are resources");
    device.connect().expect("the port is free");
    device.exchange(&[Raw::Bit(true)], &[true], &mut [], &mut [None]).ok();
    (device, address)
}

fn master(address: SocketAddr) -> std::io::Result<TcpStream> {
    let stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    Ok(stream)
}

/// A request with its header: function and data.
fn framed(number: u16, body: &[u8]) -> Vec<u8> {
    let ([a, b], [c, d]) = (number.to_be_bytes(), (body.len() as u16 + 1).to_be_bytes());
    [&[a, b, 0, 0, c, d, 1], body].concat()
}

/// Function and data of the answer.
fn asked(stream: &mut TcpStream, number: u16, body: &[u8]) -> std::io::Result<Vec<u8>> {
    stream.write_all(&framed(number, body))?;
    let mut head = [0; 7];
    stream.read_exact(&mut head)?;
    assert_eq!(head[..2], number.to_be_bytes(), "the answer to this request");
    let mut answer = vec![0; usize::from(u16::from_be_bytes([head[4], head[5]])) - 1];
    stream.read_exact(&mut answer)?;
    Ok(answer)
}

/// The known master reads the lamp.
fn lamp(stream: &mut TcpStream, number: u16) -> Duration {
    let begin = Instant::now();
    let answer = asked(stream, number, &[2, 0, 7, 0, 1]).expect("the known master is served");
    assert_eq!(answer, [2, 1, 1]);
    begin.elapsed()
}

/// Makes trouble in one way, again and again.
fn trouble(address: SocketAddr, way: u8, over: &AtomicBool) {
    let mut kept = Vec::new();
    let mut number = 0u16;
    while !over.load(Ordering::Relaxed) {
        let Ok(mut stream) = master(address) else {
            std::thread::sleep(Duration::from_millis(10));
            continue;
        };
        number = number.wrapping_add(1);
        match way {
            // Half-open, with nothing or with a part of a request.
            0 => {
                stream.write_all(&[0, 1, 0][..usize::from(number % 4).min(3)]).ok();
                kept.push(stream);
                if kept.len() > 150 {
                    kept.clear();
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            1 => {
                let noise: Vec<u8> = (0..200).map(|k| (number.wrapping_mul(31) ^ (k * 77)) as u8).collect();
                stream.write_all(&noise).ok();
            }
            2 => {
                for (body, exception) in [
                    (&[1, 0, 0, 0, 0][..], 3),
                    (&[3, 0, 0, 0xff, 0xff], 3),
                    (&[16, 0, 0, 0, 1, 9, 0], 3),
                    (&[2, 0, 8, 0, 1], 2),
                    (&[5, 0, 7, 0xff, 0], 2),
                    (&[99, 0, 0, 0, 0], 1),
                ] {
                    // It may be sent away for a newer one; an answer is the right one.
                    let Ok(answer) = asked(&mut stream, number, body) else { break };
                    assert_eq!(answer, [body[0] | 0x80, exception]);
                }
            }
            // It asks and does not read.
            _ => {
                stream.set_write_timeout(Some(Duration::from_millis(200))).ok();
                let many: Vec<u8> = (0..500).flat_map(|k| framed(k, &[2, 0, 7, 0, 1])).collect();
                while !over.load(Ordering::Relaxed) && stream.write_all(&many).is_ok() {}
            }
        }
    }
}

#[test]
fn row_12_the_known_master_is_served_beside_hostile_ones() {
    let (device, address) = server();
    let mut known = master(address).expect("the server listens");
    lamp(&mut known, 1);
    let time = if many() { Duration::from_secs(600) } else { Duration::from_millis(1_500) };
    let over = Arc::new(AtomicBool::new(false));
    let hostile: Vec<_> = (0..4)
        .map(|way| {
            let over = Arc::clone(&over);
            std::thread::spawn(move || trouble(address, way, &over))
        })
        .collect();
    let (begin, mut times) = (Instant::now(), Vec::new());
    while begin.elapsed() < time {
        times.push(lamp(&mut known, times.len() as u16));
        std::thread::sleep(Duration::from_millis(10));
    }
    // A new master gets in as well.
    lamp(&mut master(address).expect("it gets in"), 7);
    over.store(true, Ordering::Relaxed);
    for thread in hostile {
        thread.join().expect("no answer was wrong");
    }
    row(12, "the known master", times.len() as u64, 0, format!("answers: {}", Times(times)));
    without_descriptors(address, known);
    drop(device);
}

/// Takes all descriptors of this process away, and gives them back.
fn without_descriptors(address: SocketAddr, mut known: TcpStream) {
    let before = getrlimit(Resource::Nofile);
    let open = std::fs::read_dir("/proc/self/fd").expect("Linux").count() as u64;
    let few = Rlimit { current: Some(open + 20), maximum: before.maximum };
    setrlimit(Resource::Nofile, few).expect("less is always allowed");
    let mut taken = Vec::new();
    while let Ok(stream) = TcpStream::connect(address) {
        taken.push(stream);
        assert!(taken.len() < 1_000, "there is a limit");
    }
    lamp(&mut known, 1);
    std::thread::sleep(Duration::from_millis(100));
    lamp(&mut known, 2);
    drop(taken);
    setrlimit(Resource::Nofile, before).expect("as it was");
    lamp(&mut known, 3);
    lamp(&mut master(address).expect("it gets in again"), 4);
}
