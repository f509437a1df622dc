//! Times a read of 100 registers of Modbus TCP: by G7's own device, by tokio-modbus, and by the client of
//! pymodbus where there is one; all from one server, in turns. Prints the time of a read in us: minimum and
//! median over the rounds, and the ratio of the minima to that of G7.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::process::Command;
use std::time::{Duration, Instant};

use g7_model::FileId;
use g7_online::{Absent, Clients, setup, wire};
use g7_rig::{Options, Source, build};
use tokio_modbus::client::Reader as _;

const REGISTERS: u16 = 100;
const READS: u32 = 4_000;
const ROUNDS: usize = 7;

fn main() {
    let server = serve();
    let python = g7_peers::python("pymodbus");
    let mut rows: Vec<(&str, Vec<f64>)> =
        vec![("G7", Vec::new()), ("tokio-modbus", Vec::new()), ("pymodbus", Vec::new())];
    for _ in 0..ROUNDS {
        let times = [Some(g7(server)), Some(tokio(server)), python.as_deref().map(|p| pymodbus(p, server))];
        for ((_, all), time) in rows.iter_mut().zip(times) {
            all.extend(time);
        }
    }
    let first = |all: &[f64]| all.iter().copied().fold(f64::MAX, f64::min);
    let own = rows.first().map_or(1.0, |(_, all)| first(all));
    println!("{:<16}{:>10}{:>10}{:>10}", "us a read", "least", "median", "ratio");
    for (name, mut all) in rows.into_iter().filter(|(_, all)| !all.is_empty()) {
        all.sort_by(f64::total_cmp);
        let median = all.get(all.len() / 2).copied().unwrap_or(0.0);
        println!("{name:<16}{:>10.1}{median:>10.1}{:>10.2}", first(&all), first(&all) / own);
    }
}

fn each(elapsed: Duration) -> f64 {
    elapsed.as_secs_f64() * 1e6 / f64::from(READS)
}

/// A server that answers each request with 100 registers.
fn serve() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let address = listener.local_addr().expect("it has an address");
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            std::thread::spawn(move || answer(stream));
        }
    });
    address
}

fn answer(mut stream: TcpStream) -> Option<()> {
    stream.set_nodelay(true).ok()?;
    let mut request = [0; 12];
    let mut frame = vec![0; 9 + 2 * usize::from(REGISTERS)];
    loop {
        stream.read_exact(&mut request).ok()?;
        frame[..8].copy_from_slice(&request[..8]);
        frame[4..6].copy_from_slice(&(3 + 2 * REGISTERS).to_be_bytes());
        frame[8] = (2 * REGISTERS) as u8;
        for k in 0..REGISTERS {
            let at = 9 + 2 * usize::from(k);
            frame[at..at + 2].copy_from_slice(&k.to_be_bytes());
        }
        stream.write_all(&frame).ok()?;
    }
}

fn g7(server: SocketAddr) -> f64 {
    let chart: String = (0..REGISTERS).map(|k| format!("input i{k} : INT\n")).collect();
    let source = Source::new("a.g7", format!("{chart}chart A {{\n initial step 1\n}}\n").into_bytes(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("no plant");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let inputs: String = (0..REGISTERS).map(|k| format!("i{k} = 'd.holding({k})'\n")).collect();
    let io = format!(
        "[devices.d]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {}\n[inputs]\n{inputs}",
        server.port()
    );
    let (setup, _) = setup::read(&io, FileId(1));
    let (wiring, wrong) = wire(&bench, &setup);
    assert!(wrong.is_empty(), "{wrong:?}");
    let mut device = Clients::default().device(&wiring.devices[0]).expect("a client");
    device.connect().expect("the server is there");
    let mut values = vec![Err(Absent::Unread); usize::from(REGISTERS)];
    let begin = Instant::now();
    for _ in 0..READS {
        device.exchange(&[], &[], &mut values, &mut []).expect("the server answers");
    }
    let time = each(begin.elapsed());
    assert!(matches!(values[99], Ok(g7_online::Raw::Whole(99))), "{:?}", values[99]);
    device.close();
    time
}

fn tokio(server: SocketAddr) -> f64 {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let mut client = tokio_modbus::client::tcp::connect(server).await.expect("the server is there");
        let begin = Instant::now();
        let mut last = Vec::new();
        for _ in 0..READS {
            last = client.read_holding_registers(0, REGISTERS).await.expect("answers").expect("no exception");
        }
        assert_eq!(last[99], 99);
        each(begin.elapsed())
    })
}

/// The script prints us a read.
fn pymodbus(python: &std::path::Path, server: SocketAddr) -> f64 {
    let arguments = [server.port().to_string(), (READS / 10).to_string()];
    let out = Command::new(python).arg(g7_peers::script("modbus_speed.py")).args(arguments).output();
    let out = out.expect("Python is there");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    text.trim().parse().unwrap_or_else(|_| panic!("{text}{}", String::from_utf8_lossy(&out.stderr)))
}
