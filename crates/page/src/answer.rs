//! The form of answers: `{"ok":…}` or `{"no":"a sentence"}`.

use serde::Serialize;

/// An answer as JSON, or a sentence that says why there is none.
pub(crate) type Answer = Result<String, String>;

/// A successful answer.
pub(crate) fn ok<T: Serialize>(value: &T) -> Answer {
    // The value is serialized directly into its frame, because drawings are long.
    let mut out = br#"{"ok":"#.to_vec();
    serde_json::to_writer(&mut out, value).map_err(|e| e.to_string())?;
    out.push(b'}');
    String::from_utf8(out).map_err(|e| e.to_string())
}

/// The text that is sent back.
pub(crate) fn text(answer: Answer) -> String {
    answer.unwrap_or_else(|no| serde_json::json!({ "no": no }).to_string())
}
