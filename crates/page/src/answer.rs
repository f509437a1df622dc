//! The outer form of answers: `{"ok":…}` or `{"no":"a sentence"}`.

use serde::Serialize;

/// An answer in JSON, or why there is none.
pub(crate) type Answer = Result<String, String>;

/// An answer that is there.
pub(crate) fn ok<T: Serialize>(value: &T) -> Answer {
    // Written into its frame at once: drawings are long.
    let mut out = br#"{"ok":"#.to_vec();
    serde_json::to_writer(&mut out, value).map_err(|e| e.to_string())?;
    out.push(b'}');
    String::from_utf8(out).map_err(|e| e.to_string())
}

/// The text that goes out.
pub(crate) fn text(answer: Answer) -> String {
    answer.unwrap_or_else(|no| serde_json::json!({ "no": no }).to_string())
}
