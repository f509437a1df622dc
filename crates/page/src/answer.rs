//! The form of answers: `{"ok":…}` or `{"no":"a sentence"}`, and those that are a single text.

use std::sync::Arc;

use g7_ide::{File, Texts};
use g7_model::Said;
use serde::{Deserialize, Serialize};

/// An answer as JSON, or a sentence that says why there is none.
pub(crate) type Answer = Result<String, Said>;

/// A successful answer.
pub(crate) fn ok<T: Serialize>(value: &T) -> Answer {
    // The value is serialized directly into its frame, because drawings are long.
    let mut out = br#"{"ok":"#.to_vec();
    serde_json::to_writer(&mut out, value).map_err(|e| Said::foreign(e.to_string()))?;
    out.push(b'}');
    String::from_utf8(out).map_err(|e| Said::foreign(e.to_string()))
}

/// The text that is sent back.
pub(crate) fn text(answer: Result<String, String>) -> String {
    answer.unwrap_or_else(|no| serde_json::json!({ "no": no }).to_string())
}

/// A text.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Text {
    pub(crate) text: String,
}

/// The text before the last change; null if there was none.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Before {
    pub(crate) text: Option<String>,
}

/// A style sheet.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Style {
    pub(crate) css: String,
}

/// The breakpoints of a run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Breaks {
    /// The ids of their symbols.
    pub(crate) ids: Vec<String>,
}

/// A file that another one uses.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields = nullable))]
pub(crate) struct Shelved {
    /// Its name; where that one is given as well, its path from the folder of that one.
    pub(crate) file: String,
    /// Its text; none if it is not there.
    pub(crate) text: Option<String>,
}

/// The files that an open file uses.
pub(crate) fn shelved(file: &File) -> Vec<Shelved> {
    let one = |(path, text): (&String, &Option<Arc<str>>)| Shelved {
        file: path.clone(),
        text: text.as_deref().map(str::to_owned),
    };
    file.lent().map(one).collect()
}

/// Their texts.
pub(crate) fn shelf(files: Option<Vec<Shelved>>) -> Texts {
    files.into_iter().flatten().map(|f| (f.file, f.text.map(Arc::from))).collect()
}
