//! Questions that the browser asks of a second module.
//!
//! ```text
//! first module (without `whole`) -> {"elsewhere":{files, as}} -> web/src/lib/page.ts
//!                                      -> second module (`whole`): about { files, ask }   -> the answer
//!                                      -> second module: import -> `imported` -> the first -> the answer
//! ```
//!
//! The browser loads a module without readers and printers of other tools and without proofs, which most visits
//! do not need; the second one is the whole program, loaded when a question needs it. The server has the
//! whole program, so it never answers this way. What the first module leaves out is decided in one place: the
//! arms of `Page::answer`, which the compiler holds to all requests.

use g7_ide::File;
use serde::{Deserialize, Serialize};

use crate::answer::Answer;
use crate::request::Request;

/// True in the program that answers everything itself.
pub(crate) const WHOLE: bool = cfg!(feature = "whole");

/// A file that a question is about, lent by the page that has it open.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Lent {
    pub(crate) file: String,
    pub(crate) text: String,
}

impl Lent {
    pub(crate) fn new(name: &str, file: &File) -> Lent {
        Lent { file: name.to_owned(), text: file.text().to_owned() }
    }
}

/// Where an answer is to be had.
#[derive(Debug, Serialize)]
struct Elsewhere {
    /// The files that the question is about.
    files: Vec<Lent>,
    /// The word under which the question is asked there; its answer is then a message for this page.
    #[serde(skip_serializing_if = "Option::is_none")]
    r#as: Option<&'static str>,
}

/// Says that the second module answers.
pub(crate) fn elsewhere(files: Vec<Lent>, r#as: Option<&'static str>) -> Answer {
    let there = Elsewhere { files, r#as };
    serde_json::to_string(&serde_json::json!({ "elsewhere": there })).map_err(|e| e.to_string())
}

impl Request {
    /// The names of the files that a question is about which the first module does not answer.
    pub(crate) fn files(&self) -> Vec<&str> {
        match self {
            Request::Export { file, .. } | Request::Prove { file, .. } | Request::ProveWays { file, .. } => {
                vec![file]
            }
            Request::Compare(both) => both.files.iter().map(String::as_str).collect(),
            _ => Vec::new(),
        }
    }
}
