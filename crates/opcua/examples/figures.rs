//! Figures of the server of OPC UA: 1000 nodes in one read, beside the server of asyncua under the same client; the
//! time from a write to the notifications of 100 subscriptions; memory.
//!
//! `make opcua-bench`, or `G7_PEERS=… cargo run --release --package g7-opcua --example figures`. The client is asyncua,
//! so all times have its own work in them. The machine should do nothing else.
#![allow(dead_code, reason = "the tests use the rest of their bench")]
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

#[path = "../tests/peer/bench.rs"]
mod bench;

use bench::{Folder, Machine, Peer, client, free_port, server};

/// Nodes in one read.
const NODES: usize = 1000;
/// Subscriptions, and turns of the input that changes all of them.
const SUBSCRIPTIONS: usize = 100;
const TURNS: usize = 100;

fn main() {
    let Some(python) = g7_peers::python("asyncua") else {
        eprintln!("asyncua is missing: `make opcua-bench` installs it, G7_PEERS names its folder");
        std::process::exit(2);
    };
    let folder = Folder::new();
    let before = memory();
    let (mut machine, port) = start(&folder);
    machine.until("scada down");
    let started = memory();
    let mut reader = client(&python, port, &[]).expect("there are no users");
    reader.until("read w999", "999 Good");
    let (least, half) = read(&mut reader);
    println!("G7: {NODES} nodes in one read: least {least} ms, half {half} ms");
    let (peer, port_of_peer) = server(&python, 0, &["many"]);
    let mut other = client(&python, port_of_peer, &[]).expect("it has no users");
    let (peer_least, peer_half) = read(&mut other);
    println!("asyncua: {NODES} nodes in one read: least {peer_least} ms, half {peer_half} ms");
    println!("G7 / asyncua: {:.2} (half {:.2})", least / peer_least, half / peer_half);
    drop((peer, other));
    let took = reader.says(&format!("latency {SUBSCRIPTIONS} {TURNS}"));
    println!(
        "{SUBSCRIPTIONS} subscriptions at 50 ms, from the write of an input through the scan (10 ms): {took}"
    );
    println!("memory: before {before} KiB, with the server {started} KiB, behind all of it {} KiB", memory());
}

/// A controller with as many variables, and outputs that one input changes.
fn start(folder: &Folder) -> (Machine, u16) {
    let port = free_port();
    let variables: String = (0..NODES).map(|k| format!("var w{k} : INT := {k}\n")).collect();
    let outputs: String = (0..SUBSCRIPTIONS).map(|k| format!("output q{k} : BOOL\n")).collect();
    let actions: String = (0..SUBSCRIPTIONS).map(|k| format!(" N q{k}\n")).collect();
    let chart = format!(
        "profile iec60848\ninput go : BOOL\n{variables}{outputs}chart Main {{\n initial step 1\n step 2 {{\n{actions} }}\n \
         1 -> 2 when go\n 2 -> 1 when not go\n}}\n"
    );
    let io = format!(
        "[devices.scada]\nkind = 'opc-ua-server'\nlisten = '127.0.0.1:{port}'\nsecurity = 'none'\n\
         expose = 'all'\ncertificates = 'pki'\n[inputs]\ngo = {{ at = 'scada.node()', bad = false }}\n"
    );
    (Machine::start(folder, &chart, &io), port)
}

/// The least and the usual time of a read, in ms.
fn read(reader: &mut Peer) -> (f64, f64) {
    let said = reader.says(&format!("many {NODES}"));
    let words: Vec<f64> = said.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [count, least, half] = words[..] else { panic!("{said}") };
    assert!((count - NODES as f64).abs() < 0.5, "{said}");
    (least, half)
}

/// The memory of this program in KiB; 0 where the system does not tell.
fn memory() -> u64 {
    g7_peers::process::memory(std::process::id()).unwrap_or(0)
}
