//! `g7 serve` as a program: its output, what survives its end, its memory.

use crate::common;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use common::{Folder, PINGPONG};

/// A server for a folder; it ends with the test.
pub(crate) struct Served {
    child: Child,
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

impl Served {
    pub(crate) fn new(folder: &Folder, args: &[&str]) -> Served {
        let mut child =
            command(folder, args).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("g7 serve");
        let mut line = String::new();
        let out = child.stdout.take().expect("its output");
        BufReader::new(out).read_line(&mut line).expect("an address");
        let address = line.trim().strip_prefix("http://").unwrap_or_else(|| panic!("an address: {line}"));
        let (host, token) = address.split_once("/?token=").expect("a token");
        Served { child, host: host.to_owned(), token: token.to_owned() }
    }

    /// A memory of the process as the system tells it, in kB: `VmRSS` is what it has now, `VmHWM` the greatest.
    #[cfg(target_os = "linux")]
    #[allow(clippy::disallowed_methods, reason = "the system tells it in a file")]
    pub(crate) fn memory(&self, what: &str) -> u64 {
        let status =
            std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).expect("the process");
        let line = status.lines().find(|line| line.starts_with(what)).expect("its memory");
        line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).expect("a number")
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(120))).expect("a limit");
        stream
    }

    fn head(&self, line: &str, more: &str) -> String {
        format!(
            "{line} HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\n{more}\r\n",
            self.host, self.token
        )
    }

    /// The status and the body of an answer.
    fn ask(&self, line: &str, body: &str) -> (u16, String) {
        let mut stream = self.connect();
        let head = self.head(line, &format!("Connection: close\r\nContent-Length: {}\r\n", body.len()));
        stream.write_all(format!("{head}{body}").as_bytes()).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let status = answer.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
        (status, answer.split_once("\r\n\r\n").map_or(String::new(), |(_, body)| body.to_owned()))
    }

    /// A WebSocket made by hand, so that it can send nonsense.
    fn live(&self) -> TcpStream {
        let mut stream = self.connect();
        let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
            Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
        stream.write_all(self.head("GET /api/live", upgrade).as_bytes()).expect("sent");
        let mut answer = Vec::new();
        let mut byte = [0];
        while !answer.ends_with(b"\r\n\r\n") {
            stream.read_exact(&mut byte).expect("an answer");
            answer.push(byte[0]);
        }
        assert!(answer.starts_with(b"HTTP/1.1 101 "), "{}", String::from_utf8_lossy(&answer));
        stream
    }
}

fn command(folder: &Folder, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_g7"));
    command.args(["serve", "--no-open"]).args(args).current_dir(folder.root());
    // Kept in the test's folder, so that it is deleted with it.
    command.env("XDG_STATE_HOME", folder.path(".state"));
    command
}

/// A text as a masked frame.
fn frame(text: &str) -> Vec<u8> {
    let mut bytes = vec![0x81];
    match text.len() {
        n @ 0..126 => bytes.push(0x80 | n as u8),
        n => {
            bytes.push(0x80 | 126);
            bytes.extend((n as u16).to_be_bytes());
        }
    }
    // A mask of zeros changes nothing.
    bytes.extend([0; 4]);
    bytes.extend(text.as_bytes());
    bytes
}

/// The texts from a socket, as they arrive.
fn texts(stream: TcpStream) -> impl Iterator<Item = String> {
    let mut reader = BufReader::new(stream);
    std::iter::from_fn(move || {
        loop {
            let mut head = [0; 2];
            reader.read_exact(&mut head).ok()?;
            let length = match head[1] & 0x7f {
                126 => {
                    let mut more = [0; 2];
                    reader.read_exact(&mut more).ok()?;
                    usize::from(u16::from_be_bytes(more))
                }
                127 => {
                    let mut more = [0; 8];
                    reader.read_exact(&mut more).ok()?;
                    u64::from_be_bytes(more) as usize
                }
                n => usize::from(n),
            };
            let mut text = vec![0; length];
            reader.read_exact(&mut text).ok()?;
            if head[0] & 0x0f == 1 {
                return String::from_utf8(text).ok();
            }
        }
    })
}

#[test]
fn the_address_is_all_that_goes_to_the_standard_output() {
    let folder = Folder::with(PINGPONG);
    let served = Served::new(&folder, &["--port", "0"]);
    assert!(served.host.starts_with("127.0.0.1:"), "only this machine: {}", served.host);
    assert_eq!(served.token.len(), 48);
    let (status, info) = served.ask("GET /api/info", "");
    assert_eq!(status, 200);
    assert!(info.contains("\"start\":\"chart.g7\"") && info.contains("\"read_only\":false"), "{info}");
    let other = Served::new(&folder, &["--port", "0", "--read-only", "chart.g7"]);
    assert_ne!(served.token, other.token, "each start has its own");
    let (_, info) = other.ask("GET /api/info", "");
    assert!(info.contains("\"start\":\"chart.g7\"") && info.contains("\"read_only\":true"), "{info}");
}

#[test]
fn what_cannot_be_served_is_said_in_one_line() {
    let folder = Folder::with(PINGPONG);
    folder.write("notes.txt", "no chart");
    folder.g7(&["serve", "--no-open", "nowhere"]).is_refused(&["cannot read nowhere"]);
    folder.g7(&["serve", "--no-open", "notes.txt"]).is_refused(&["notes.txt", "not served"]);
    folder.g7(&["serve", "--no-open", "--start", "none.g7"]).is_refused(&["there is no file none.g7"]);
    folder.g7(&["serve", "--no-open", "--start", "../x.g7"]).is_refused(&["leads out of the folder"]);
    let served = Served::new(&folder, &["--port", "0"]);
    let port = served.host.rsplit(':').next().expect("a port");
    folder.g7(&["serve", "--no-open", "--port", port]).is_refused(&["cannot listen", port]);
}

#[test]
fn unsaved_work_is_there_again_when_the_server_was_killed() {
    let folder = Folder::with(PINGPONG);
    let served = Served::new(&folder, &["--port", "0"]);
    assert_eq!(served.ask("PUT /api/draft?window=a&end=open&path=chart.g7", "half a thought").0, 204);
    drop(served);
    let again = Served::new(&folder, &["--port", "0"]);
    let (status, drafts) = again.ask("GET /api/drafts?window=b", "");
    assert_eq!(status, 200);
    assert!(drafts.contains(r#""path":"chart.g7""#) && drafts.contains(r#""holder":"gone""#), "{drafts}");
    let id = drafts.split("\"id\":\"").nth(1).and_then(|d| d.split('"').next()).expect("its name");
    let taken = again.ask(&format!("POST /api/draft/take?window=b&id={id}"), "");
    assert_eq!(taken, (200, r#"{"path":"chart.g7","text":"half a thought","base":null}"#.to_owned()));
    assert_eq!(again.ask("POST /api/draft/saved?window=b&path=chart.g7", "").0, 204);
    assert_eq!(again.ask("GET /api/drafts?window=b", "").1, r#"{"drafts":[]}"#);
    assert_eq!(folder.read("chart.g7"), PINGPONG);
}

#[cfg(target_os = "linux")]
#[test]
fn floods_cost_bounded_memory_and_the_scan_goes_on() {
    let folder = Folder::with(PINGPONG);
    let served = Served::new(&folder, &["--port", "0"]);
    let mut page = served.live();
    page.write_all(&frame(r#"{"id":1,"call":{"do":"run_start","run":"a","file":"chart.g7"}}"#))
        .expect("sent");
    page.write_all(&frame(r#"{"id":2,"call":{"do":"pace","run":"a","speed":1.0}}"#)).expect("sent");
    let mut frames = texts(page.try_clone().expect("the other half")).filter(|t| t.starts_with("{\"frame\""));
    let mut scans = move || -> u64 {
        let frame = frames.next().expect("a frame");
        let number = frame.split("\"scans\":").nth(1).expect("scans");
        number.split(',').next().and_then(|n| n.parse().ok()).expect("a number")
    };
    let before = scans();
    let block = vec![b'x'; 1 << 20];
    // 100 MB as a file, with its length and without.
    for length in ["Content-Length: 104857600\r\n", "Transfer-Encoding: chunked\r\n"] {
        let mut put = served.connect();
        let head = served.head("PUT /api/file?path=chart.g7", &format!("If-Match: *\r\n{length}"));
        put.write_all(head.as_bytes()).expect("sent");
        for _ in 0..100 {
            let chunked = length.starts_with("Transfer");
            let sent = if chunked { put.write_all(b"100000\r\n") } else { Ok(()) };
            let sent = sent.and_then(|()| put.write_all(&block));
            if sent.and_then(|()| if chunked { put.write_all(b"\r\n") } else { Ok(()) }).is_err() {
                break;
            }
        }
    }
    // As one message; the server closes the connection.
    let mut huge = served.live();
    huge.write_all(&[0x81, 0xff, 0, 0, 0, 0, 0x06, 0x40, 0, 0, 0, 0, 0, 0]).expect("sent");
    for _ in 0..100 {
        if huge.write_all(&block).is_err() {
            break;
        }
    }
    // 10,000 messages whose answers are never read.
    let mut mute = served.live();
    mute.set_write_timeout(Some(Duration::from_millis(500))).expect("a limit");
    let watch = frame(r#"{"id":1,"call":{"do":"watch","run":"a"}}"#);
    for _ in 0..10_000 {
        if mute.write_all(&watch).is_err() {
            break;
        }
    }
    let behind = scans();
    while scans() < behind.max(before) + 20 {}
    let peak = served.memory("VmHWM");
    assert!(peak < 150_000, "{peak} kB for a server that was sent 300 MB");
    assert_eq!(folder.read("chart.g7"), PINGPONG);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_many_ask_for_and_nobody_reads_is_there_once() {
    let folder = Folder::with(PINGPONG);
    let large = 16 << 20;
    folder.write("page/g7.wasm", "x".repeat(large));
    let served = Served::new(&folder, &["--port", "0", "--page-dir", "page"]);
    let held: Vec<TcpStream> = (0..60)
        .map(|_| {
            let mut stream = served.connect();
            let head = format!("GET /g7.wasm HTTP/1.1\r\nHost: {}\r\n\r\n", served.host);
            stream.write_all(head.as_bytes()).expect("sent");
            let mut begin = [0; 12];
            stream.read_exact(&mut begin).expect("an answer");
            assert_eq!(&begin, b"HTTP/1.1 200");
            stream
        })
        .collect();
    let peak = served.memory("VmHWM");
    assert!(peak < 200_000, "{peak} kB for {} copies of {large} bytes", held.len());
}
