//! A page that tests can send messages to.
#![allow(clippy::disallowed_methods, reason = "the examples are read")]

use g7_page::Page;
use serde_json::{Value, json};

/// A page that takes and returns JSON values.
#[derive(Default)]
pub(crate) struct Asked(Page);

impl Asked {
    /// The answer, or the sentence of a refusal.
    pub(crate) fn ask(&mut self, message: Value) -> Result<Value, String> {
        let mut answer: Value =
            serde_json::from_str(&self.0.call(&message.to_string())).expect("an answer is JSON");
        match (answer["ok"].take(), answer["no"].as_str()) {
            (_, Some(no)) => Err(no.to_owned()),
            (ok, None) => Ok(ok),
        }
    }

    /// The same, with scans that end when `goes_on` says no.
    pub(crate) fn while_(
        &mut self,
        message: &Value,
        goes_on: impl FnMut() -> bool + Send + 'static,
    ) -> Value {
        let answer = self.0.call_while(&message.to_string(), goes_on);
        serde_json::from_str::<Value>(&answer).expect("an answer is JSON")["ok"].take()
    }

    /// The answer to a message that must be accepted.
    pub(crate) fn ok(&mut self, message: Value) -> Value {
        self.ask(message.clone()).unwrap_or_else(|no| panic!("{message}: {no}"))
    }

    /// The sentence for a message that must be refused.
    pub(crate) fn no(&mut self, message: Value) -> String {
        self.ask(message.clone()).err().unwrap_or_else(|| panic!("{message} was answered"))
    }

    /// Opens a text as `a.g7`.
    pub(crate) fn open(&mut self, text: &str) -> Value {
        self.ok(json!({ "do": "open", "file": "a.g7", "text": text }))
    }

    /// The text of `a.g7`.
    pub(crate) fn text(&mut self) -> String {
        let text = self.ok(json!({ "do": "text", "file": "a.g7" }));
        text["text"].as_str().expect("a text").to_owned()
    }
}

/// Pseudo-random numbers; every run gives the same ones.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    /// A number below a bound.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound.max(1)
    }

    /// One element of a list.
    pub(crate) fn one<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// The text of an example.
pub(crate) fn example(path: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// All examples, with their paths.
pub(crate) fn examples() -> Vec<(String, String)> {
    fn walk(folder: &std::path::Path, all: &mut Vec<(String, String)>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(&path, all);
            } else if path.extension().is_some_and(|e| e == "g7") {
                let text = std::fs::read_to_string(&path).expect("a text");
                all.push((path.display().to_string(), text));
            }
        }
    }
    let mut all = Vec::new();
    walk(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples"), &mut all);
    all.sort();
    assert!(all.len() > 15);
    all
}
