//! The outer form of answers: `{"ok":…}` or `{"no":"a sentence"}`.

use serde::Serialize;
use serde_json::value::RawValue;

/// An answer in JSON, or why there is none.
pub(crate) type Answer = Result<Box<RawValue>, String>;

/// An answer that is there.
pub(crate) fn ok<T: Serialize>(value: &T) -> Answer {
    serde_json::value::to_raw_value(value).map_err(|e| e.to_string())
}

/// The text that goes out.
pub(crate) fn text(answer: Answer) -> String {
    #[derive(Serialize)]
    #[serde(rename_all = "lowercase")]
    enum Out {
        Ok(Box<RawValue>),
        No(String),
    }
    let out = match answer {
        Ok(value) => Out::Ok(value),
        Err(no) => Out::No(no),
    };
    serde_json::to_string(&out).unwrap_or_else(|_| r#"{"no":"this answer cannot be written"}"#.to_owned())
}
