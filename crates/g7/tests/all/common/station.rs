//! `g7 serve --online` and the pages that watch it.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::{Error, Message, WebSocket, client};

use super::Folder;

/// Longer than anything takes on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);

/// `g7 serve --online` at work.
pub(crate) struct Station {
    pub(crate) child: Child,
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Drop for Station {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

impl Station {
    pub(crate) fn new(folder: &Folder, args: &[&str]) -> Station {
        let mut command = Command::new(env!("CARGO_BIN_EXE_g7"));
        command.args(["serve", "chart.g7", "--online", "--no-open", "--port", "0"]).args(args);
        command.current_dir(folder.root()).env("XDG_STATE_HOME", folder.path(".state"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("g7 serve");
        let mut line = String::new();
        let out = child.stdout.take().expect("piped");
        BufReader::new(out).read_line(&mut line).expect("an address");
        let address = line.trim().strip_prefix("http://").unwrap_or_else(|| panic!("an address: {line}"));
        let (host, token) = address.split_once("/operator?token=").expect("the page of the operator");
        Station { child, host: host.to_owned(), token: token.to_owned() }
    }

    pub(crate) fn get(&self, path: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.host).expect("a connection");
        let head = format!("GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.host);
        stream.write_all(head.as_bytes()).expect("sent");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
        (status, answer)
    }

    /// The WebSocket with these headers; a refusal is its status.
    pub(crate) fn try_page(&self, token: &str, origin: Option<&str>) -> Result<Page, u16> {
        let address = format!("ws://{}/api/live?token={token}", self.host);
        let mut request = address.into_client_request().expect("a request");
        if let Some(origin) = origin {
            request.headers_mut().insert("origin", origin.parse().expect("a header"));
        }
        let stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        match client(request, stream) {
            Ok((socket, _)) => Ok(Page { socket, next: 1, seen: json!({}), values: Vec::new() }),
            Err(e) => match e {
                tokio_tungstenite::tungstenite::HandshakeError::Failure(Error::Http(answer)) => {
                    Err(answer.status().as_u16())
                }
                other => panic!("{other}"),
            },
        }
    }

    /// A page that watches.
    pub(crate) fn page(&self) -> Page {
        let mut page = self.try_page(&self.token, None).expect("it is let in");
        let told = page.ok(json!({ "do": "operator_watch" }));
        page.take(&told["frame"]);
        page.seen["told"] = told;
        page
    }

    /// Ends it as Ctrl-C does and returns its exit code.
    pub(crate) fn interrupt(mut self) -> i32 {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &pid]).status().expect("kill").success());
        self.child.wait().expect("it ends").code().expect("an exit code")
    }
}

/// A page: all that it was told.
pub(crate) struct Page {
    pub(crate) socket: WebSocket<TcpStream>,
    pub(crate) next: u64,
    pub(crate) seen: Value,
    pub(crate) values: Vec<(String, String)>,
}

impl Page {
    pub(crate) fn receive(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().expect("a message in time") {
                return serde_json::from_str(&text).expect("JSON");
            }
        }
    }

    pub(crate) fn take(&mut self, frame: &Value) {
        // A message that the folder has changed is no frame.
        for (key, part) in frame.as_object().into_iter().flatten() {
            if key != "values" {
                self.seen[key] = part.clone();
                continue;
            }
            for cell in part.as_array().expect("a list") {
                let at = cell[0].as_u64().expect("a number") as usize;
                let text = |k: usize| cell[k].as_str().expect("a text").to_owned();
                if self.values.len() <= at {
                    self.values.resize(at + 1, Default::default());
                }
                self.values[at] = (text(1), text(2));
            }
        }
    }

    pub(crate) fn answer(&mut self, call: &Value) -> Value {
        let id = self.next;
        self.next += 1;
        let text = json!({ "id": id, "call": call }).to_string();
        self.socket.send(Message::text(text)).expect("an open socket");
        loop {
            let said = self.receive();
            if said["id"] == id {
                return said["answer"].clone();
            }
            self.take(&said["operator"]);
        }
    }

    #[track_caller]
    pub(crate) fn ok(&mut self, call: Value) -> Value {
        let answer = self.answer(&call);
        answer.get("ok").unwrap_or_else(|| panic!("{call}: {answer}")).clone()
    }

    #[track_caller]
    pub(crate) fn no(&mut self, call: Value, part: &str) {
        let answer = self.answer(&call);
        let why = answer["no"].as_str().unwrap_or_else(|| panic!("{call}: {answer}"));
        assert!(why.contains(part), "{call}: {why}");
    }

    pub(crate) fn does(&mut self, what: &str) {
        self.ok(json!({ "do": format!("operator_{what}") }));
    }

    pub(crate) fn force(&mut self, name: &str, value: &str, seconds: u32) {
        self.ok(json!({ "do": "operator_force", "name": name, "value": value, "seconds": seconds }));
    }

    /// Takes frames until a condition holds.
    #[track_caller]
    pub(crate) fn until(&mut self, said: &str, what: impl Fn(&Page) -> bool) {
        let begin = Instant::now();
        while !what(self) {
            let (seen, values) = (&self.seen, &self.values);
            assert!(begin.elapsed() < PATIENCE, "{said}: {seen} {values:?}");
            let frame = self.receive();
            self.take(&frame["operator"]);
        }
    }

    #[track_caller]
    pub(crate) fn becomes(&mut self, mode: &str) {
        self.until(mode, |page| page.seen["mode"]["is"] == mode);
    }

    pub(crate) fn signal(&self, name: &str) -> usize {
        let signals = self.seen["told"]["signals"].as_array().expect("a list");
        signals.iter().position(|signal| signal["name"] == name).unwrap_or_else(|| panic!("{name}"))
    }

    /// Value and quality.
    pub(crate) fn value(&self, name: &str) -> (&str, &str) {
        let (value, quality) = &self.values[self.signal(name)];
        (value, quality)
    }

    #[track_caller]
    pub(crate) fn shows(&mut self, name: &str, value: &str, quality: &str) {
        self.until(name, |page| page.value(name) == (value, quality));
    }

    pub(crate) fn events(&self) -> Vec<&Value> {
        self.seen["events"].as_array().expect("a list").iter().collect()
    }

    pub(crate) fn has_event(&self, kind: &str, name: &str) -> bool {
        self.events().iter().any(|e| e["kind"] == kind && e["name"] == name)
    }

    /// The names of the active steps.
    pub(crate) fn situation(&self) -> Vec<String> {
        let steps = &self.seen["told"]["steps"];
        let on = self.seen["on"].as_array().expect("a list").iter();
        let name = |on: &Value| steps[on[0].as_u64().expect("a number") as usize]["name"].to_string();
        on.map(|on| name(on).trim_matches('"').to_owned()).collect()
    }
}
