//! A part of a panel as the page is told of it.

use g7_online::Part;
use g7_online::setup::Handle;
use serde_json::{Value as Json, json};

/// The kind of a part, with its limits, words and colour.
pub(super) fn json(part: &Part) -> Json {
    let mut told = json!({ "is": part.handle.word(), "min": part.min, "max": part.max });
    let more = match &part.handle {
        Handle::Choice(words) => Some(("words", json!(words))),
        Handle::Lamp(colour) => Some(("colour", json!(colour))),
        _ => None,
    };
    if let (Some((key, value)), Some(fields)) = (more, told.as_object_mut()) {
        fields.insert(key.to_owned(), value);
    }
    told
}
