//! An editor that speaks the Language Server Protocol with `g7 lsp`.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::{Value, json};
use snapbox::cmd::cargo_bin;

/// The address of the text that is open.
pub(crate) const URI: &str = "file:///plant/chart.g7";

/// The test in the role of an editor: it sends messages to `g7 lsp` and reads what comes back.
pub(crate) struct Editor {
    pub(crate) server: Child,
    pub(crate) input: ChildStdin,
    pub(crate) output: BufReader<ChildStdout>,
    pub(crate) number: u64,
    /// Notifications that came before the answer that was waited for.
    pub(crate) told: Vec<Value>,
}

impl Editor {
    pub(crate) fn new() -> Editor {
        Editor::speaking(None)
    }

    /// An editor whose user reads a language.
    pub(crate) fn speaking(locale: Option<&str>) -> Editor {
        let mut server = Command::new(cargo_bin!("g7"))
            .arg("lsp")
            .env("LC_ALL", "C")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("g7 lsp starts");
        let input = server.stdin.take().expect("its input");
        let output = BufReader::new(server.stdout.take().expect("its output"));
        let mut editor = Editor { server, input, output, number: 0, told: Vec::new() };
        let abilities = json!({ "workspace": { "inlayHint": { "refreshSupport": true } } });
        let hello = editor.ask(
            "initialize",
            json!({ "processId": null, "rootUri": null, "capabilities": abilities, "locale": locale }),
        );
        assert_eq!(hello["serverInfo"]["name"], "g7");
        editor.tell("initialized", json!({}));
        editor
    }

    /// An editor with a text that is open.
    pub(crate) fn with(text: &str) -> Editor {
        Editor::open(URI, text)
    }

    /// A new editor in which a text is open under an address.
    pub(crate) fn open(uri: &str, text: &str) -> Editor {
        Editor::new().opened(uri, text)
    }

    /// Opens a text under an address in this editor.
    pub(crate) fn opened(mut self, uri: &str, text: &str) -> Editor {
        let editor = &mut self;
        editor.tell(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "languageId": "g7", "version": 1, "text": text } }),
        );
        self
    }

    pub(crate) fn send(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.input, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("it reads");
        self.input.flush().expect("it reads");
    }

    pub(crate) fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).expect("a header") > 0, "the server ended");
            match line.trim_end().strip_prefix("Content-Length: ") {
                Some(n) => length = n.parse().expect("a length"),
                None if line.trim_end().is_empty() => break,
                None => {}
            }
        }
        let mut bytes = vec![0; length];
        self.output.read_exact(&mut bytes).expect("a message");
        serde_json::from_slice(&bytes).expect("JSON")
    }

    pub(crate) fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// The whole answer to a request.
    pub(crate) fn answer(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let number = self.number;
        self.send(&json!({ "jsonrpc": "2.0", "id": number, "method": method, "params": params }));
        loop {
            let message = self.read();
            if message["id"] == number {
                return message;
            }
            self.told.push(message);
        }
    }

    pub(crate) fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.answer(method, params);
        assert_eq!(answer.get("error"), None, "{method}");
        answer["result"].clone()
    }

    /// A request about the word at a place of the text, by line and column from 0.
    pub(crate) fn at(&mut self, method: &str, line: u32, character: u32) -> Value {
        self.ask(
            method,
            json!({
                "textDocument": { "uri": URI },
                "position": { "line": line, "character": character },
                "context": { "includeDeclaration": true, "triggerKind": 1 },
            }),
        )
    }

    /// The problems that were told last of the text.
    pub(crate) fn problems(&mut self) -> Value {
        loop {
            let message = if self.told.is_empty() { self.read() } else { self.told.remove(0) };
            if message["method"] == "textDocument/publishDiagnostics" {
                return message["params"].clone();
            }
        }
    }

    /// Takes the place of some characters on a line.
    pub(crate) fn type_at(&mut self, version: u32, line: u32, from: u32, to: u32, text: &str) {
        self.tell(
            "textDocument/didChange",
            json!({
                "textDocument": { "uri": URI, "version": version },
                "contentChanges": [{
                    "range": { "start": { "line": line, "character": from }, "end": { "line": line, "character": to } },
                    "text": text,
                }],
            }),
        );
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        self.server.kill().ok();
        self.server.wait().ok();
    }
}

pub(crate) fn range(line: u32, from: u32, to: u32) -> Value {
    json!({ "start": { "line": line, "character": from }, "end": { "line": line, "character": to } })
}
