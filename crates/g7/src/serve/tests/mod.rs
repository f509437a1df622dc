//! Tests the server over real sockets.
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

mod assets;
mod crowd;
mod drafts;
mod files;
mod guard;
mod runs;
mod together;
mod users;
mod wiring;

use std::fs;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::{Error, Message};

use super::*;
use crate::station::Drive;

/// Longer than any answer takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Two steps: `a` leads to step 2, `not a` leads back; `n` counts the scans in step 2.
const CHART: &str = "\
input a : BOOL
output m : BOOL
var n : DINT

chart G {
  initial step 1
  step 2 {
    N m
    N n := n + 1
  }
  1 -> 2 when a
  2 -> 1 when not a
}
";

/// A server with a folder of its own, which is deleted after the test.
struct Server {
    bound: SocketAddr,
    token: String,
    /// The token of guests.
    guest: String,
    root: PathBuf,
    shared: Shared,
    task: tokio::task::JoinHandle<()>,
}

impl Drop for Server {
    fn drop(&mut self) {
        self.task.abort();
        fs::remove_dir_all(&self.root).ok();
    }
}

/// An answer over HTTP.
struct Reply {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Reply {
    fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.text()))
    }

    fn header(&self, name: &str) -> Option<&str> {
        let of = |line: &'_ str| line.split_once(": ").is_some_and(|(n, _)| n.eq_ignore_ascii_case(name));
        self.head.lines().find(|l| of(l)).and_then(|l| l.split_once(": ")).map(|(_, v)| v)
    }

    fn tag(&self) -> String {
        self.header("etag").expect("an ETag").to_owned()
    }

    #[track_caller]
    fn is(self, status: u16) -> Reply {
        assert_eq!(self.status, status, "{}\n{}", self.head, self.text());
        self
    }
}

/// The arguments for a folder.
fn args_of(folder: &Path) -> Serve {
    Serve {
        path: folder.to_path_buf(),
        port: None,
        host: None,
        users: None,
        cert: None,
        key: None,
        log: None,
        read_only: false,
        forget: false,
        guests: false,
        no_open: true,
        framed: None,
        start: None,
        drive: Drive { online: false, io: None, simulate: None },
        plant: None,
        page_dir: None,
    }
}

/// A pass by a token that no test knows.
fn some_pass() -> Pass {
    Pass::Tokens(Arc::new(Tokens::fresh().expect("a token")))
}

/// An answer from its bytes.
fn reply(bytes: &[u8]) -> Reply {
    let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").expect("a head");
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
    Reply { status, head, body: bytes[end + 4..].to_vec() }
}

impl Server {
    async fn new() -> Server {
        Server::with(|_| {}, Limits::default()).await
    }

    /// A folder `charts` with `chart.g7`, beside a file that the server must not touch.
    async fn with(change: impl FnOnce(&mut Serve), limits: Limits) -> Server {
        Server::under(change, |_| {}, limits).await
    }

    /// The same, with other rules than its arguments give.
    async fn under(change: impl FnOnce(&mut Serve), rule: impl FnOnce(&mut Rules), limits: Limits) -> Server {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let root = std::env::temp_dir().join(format!("g7-serve-{}-{number}", std::process::id()));
        fs::create_dir_all(root.join("charts")).expect("a folder for the test");
        fs::write(root.join("charts/chart.g7"), CHART).expect("a chart");
        fs::write(root.join("secret.g7"), "secret").expect("a file outside");
        let mut args = args_of(&root.join("charts"));
        args.page_dir = Some(root.join("charts"));
        change(&mut args);
        let mut rules = Rules::of(&args, None, &crate::audit::Audit::default(), None).expect("they fit");
        rule(&mut rules);
        let shared =
            shared(&args, limits, Some(&root.join("state")), None, &rules).expect("a folder to serve");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
        let bound = listener.local_addr().expect("an address");
        let tokens = Tokens::fresh().expect("a token");
        let token = tokens.own().to_owned();
        let guests = Tokens::fresh().expect("a token");
        let guest = guests.own().to_owned();
        let guard = rules.guard(Pass::Tokens(Arc::new(tokens)), Some(Arc::new(guests)), bound);
        let app = app(Arc::clone(&shared), guard);
        let (of, moves) = (Arc::clone(&shared), Arc::clone(&shared));
        let task = tokio::spawn(async move {
            tokio::select! {
                () = listen::listen(listener, app, listen::Door::default()) => {}
                () = tell_changes(of) => {}
                () = super::together::talk::tell_moves(moves) => {}
            }
        });
        Server { bound, token, guest, root, shared, task }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.join("charts").join(name)
    }

    fn on_disk(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Sends a request as it is; returns the complete answer.
    async fn raw(&self, request: &[u8]) -> Reply {
        let mut stream = TcpStream::connect(self.bound).await.expect("a connection");
        // The server may close the connection early; its answer can still be read.
        stream.write_all(request).await.ok();
        let mut bytes = Vec::new();
        tokio::time::timeout(PATIENCE, stream.read_to_end(&mut bytes)).await.expect("an answer").ok();
        reply(&bytes)
    }

    /// A request with only these headers.
    async fn bare(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Reply {
        let mut request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
        headers.iter().for_each(|(n, v)| request.push_str(&format!("{n}: {v}\r\n")));
        request.push_str(&format!("Content-Length: {}\r\n\r\n{body}", body.len()));
        self.raw(request.as_bytes()).await
    }

    /// A request of a page of this server.
    async fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Reply {
        self.ask_by(&self.token, method, path, headers, body).await
    }

    /// A request with a token.
    async fn ask_by(
        &self,
        token: &str,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &str,
    ) -> Reply {
        let (host, token) = (self.bound.to_string(), format!("Bearer {token}"));
        let mut all = vec![("Host", host.as_str()), ("Authorization", token.as_str())];
        all.extend(headers);
        self.bare(method, path, &all, body).await
    }

    async fn get(&self, path: &str) -> Reply {
        self.ask("GET", path, &[], "").await
    }

    /// The WebSocket of a page.
    async fn live(&self) -> Live {
        self.try_live(&[]).await.expect("a WebSocket")
    }

    /// The WebSocket of a guest.
    async fn guest(&self) -> Live {
        self.live_by(&self.guest, &[]).await.expect("a WebSocket")
    }

    async fn try_live(&self, headers: &[(&'static str, &str)]) -> Result<Live, Error> {
        self.live_by(&self.token, headers).await
    }

    async fn live_by(&self, token: &str, headers: &[(&'static str, &str)]) -> Result<Live, Error> {
        use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
        let address = format!("ws://{}/api/live?token={token}", self.bound);
        let mut request = address.into_client_request().expect("a request");
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().expect("a header"));
        }
        let stream = TcpStream::connect(self.bound).await.map_err(Error::Io)?;
        let (socket, _) = tokio_tungstenite::client_async(request, stream).await?;
        Ok(Live { socket, next: 1, unread: Vec::new() })
    }
}

/// The status of a refused upgrade.
fn refused(result: Result<Live, Error>) -> (u16, String) {
    match result {
        Err(Error::Http(answer)) => {
            let text = answer.body().as_deref().map(String::from_utf8_lossy).unwrap_or_default().into_owned();
            (answer.status().as_u16(), text)
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was let in"),
    }
}

/// The WebSocket of a page.
struct Live {
    socket: WebSocketStream<TcpStream>,
    next: u64,
    /// Messages that came while the client waited for an answer.
    unread: Vec<Value>,
}

impl Live {
    async fn receive(&mut self) -> Value {
        loop {
            let message =
                tokio::time::timeout(PATIENCE, self.socket.next()).await.expect("a message in time");
            if let Message::Text(text) = message.expect("an open socket").expect("a message") {
                return serde_json::from_str(&text).expect("JSON");
            }
        }
    }

    /// The next message that is not an answer.
    async fn hear(&mut self) -> Value {
        if self.unread.is_empty() { self.receive().await } else { self.unread.remove(0) }
    }

    /// Waits for a notice of this kind; earlier ones are skipped.
    async fn hear_of(&mut self, kind: &str) -> Value {
        loop {
            if let Some(found) = self.hear().await.get(kind) {
                return found.clone();
            }
        }
    }

    async fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).await.expect("an open socket");
    }

    async fn answer(&mut self, call: Value) -> Value {
        let id = self.next;
        self.next += 1;
        self.send(&json!({ "id": id, "call": call }).to_string()).await;
        loop {
            let said = self.receive().await;
            if said["id"] == id {
                return said["answer"].clone();
            }
            self.unread.push(said);
        }
    }

    async fn call(&mut self, call: Value) -> Value {
        let answer = self.answer(call.clone()).await;
        answer.get("ok").unwrap_or_else(|| panic!("{call}: {answer}")).clone()
    }

    async fn no(&mut self, call: Value) -> String {
        let answer = self.answer(call.clone()).await;
        answer["no"].as_str().unwrap_or_else(|| panic!("{call}: {answer}")).to_owned()
    }

    /// Starts the chart of the folder.
    async fn start(&mut self, run: &str) -> Value {
        self.call(json!({ "do": "run_start", "run": run, "file": "chart.g7" })).await
    }
}
