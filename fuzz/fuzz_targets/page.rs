//! Sends arbitrary lines as messages to one page: each gets an answer, and nothing panics.
#![no_main]

use g7_page::Page;
use libfuzzer_sys::fuzz_target;
use serde_json::Value;

/// Greatest number of messages; each may run for a while.
const MOST: usize = 40;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let mut page = Page::new();
    for message in text.lines().take(MOST) {
        let answer = page.call(message);
        let read: Value = serde_json::from_str(&answer).expect("an answer is JSON");
        let ok = read.get("ok").is_some();
        assert!(ok != read.get("no").is_some_and(Value::is_string), "{message}\n{answer}");
    }
});
