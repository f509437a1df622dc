//! The two modules of the browser: questions that the first one leaves to the second, and what they tell each other.
//!
//! ```text
//! first module (without `whole`) -> {"elsewhere":{as, files}} -> web/src/lib/page.ts
//!                          -> second module: about, with the texts of the files -> the answer
//!                          -> second module: import -> `imported` -> first module: the file is opened
//! ```
//!
//! The browser loads a module without readers and printers of other tools and without proofs, which most visits
//! do not need; the second one is the whole program, loaded when a question needs it. The server has the
//! whole program, so it never answers this way. What the first module does not contain is decided where it is
//! answered, by [`not_here`].

use g7_ide::{File, convert};
use g7_model::{FileId, Language, Problem, Said, Span, codes};
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, Shelved, shelf, shelved};
use crate::request::Request;

/// True in the program that answers everything itself.
pub(crate) const WHOLE: bool = cfg!(feature = "whole");

/// Why the first module does not answer: the second one does.
pub(crate) const ELSEWHERE: &str = "the other module answers this";
/// Why the first module does not open a file: the second one converts it.
pub(crate) const FOREIGN: &str = "the other module reads this file";

/// Refuses what only the whole program can answer: `if !WHOLE { return not_here(); }`. The first module never runs
/// the code after this line, so the compiler removes that code, and everything that only it uses.
pub(crate) fn not_here<T>() -> Result<T, Said> {
    Err(Said::foreign(ELSEWHERE))
}

/// A message from the other module. It has the word `between` in the place of `do`.
#[derive(Debug, Deserialize)]
#[serde(tag = "between", rename_all = "snake_case")]
pub(crate) enum Between {
    /// A question about files that the other module has open.
    About { files: Vec<Lent>, ask: Box<Request> },
    /// Converts a file of another tool. The answer is the message `imported`, which the first module then gets.
    Import { ask: Foreign },
    /// A converted file to be opened.
    Imported(Imported),
}

/// A file that the other module has.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Lent {
    pub(crate) file: String,
    text: String,
    /// The files that it uses; none if it uses none.
    uses: Option<Vec<Shelved>>,
}

impl Lent {
    pub(crate) fn new(name: &str, file: &File) -> Lent {
        Lent { file: name.to_owned(), text: file.text().to_owned(), uses: Some(shelved(file)) }
    }

    /// The file with its text.
    pub(crate) fn file(self, language: Language) -> Result<File, Said> {
        let mut file = File::open_native(&self.file, self.text)?;
        file.language = language;
        file.lend(shelf(self.uses));
        Ok(file)
    }
}

/// A file of another tool.
#[derive(Debug, Deserialize)]
pub(crate) struct Foreign {
    file: String,
    text: String,
}

/// Says that the second module answers, by which message, about which files.
pub(crate) fn elsewhere(by: &str, files: Vec<Lent>) -> Answer {
    let there = serde_json::json!({ "elsewhere": { "as": by, "files": files } });
    serde_json::to_string(&there).map_err(|e| Said::foreign(e.to_string()))
}

/// Opens a text.
pub(crate) fn open(name: &str, text: String) -> Result<File, Said> {
    if WHOLE {
        return File::open(name, text);
    }
    if g7_exchange::is_foreign(name, text.as_bytes()) {
        return Err(Said::foreign(FOREIGN));
    }
    File::open_native(name, text)
}

/// The message that opens a converted file.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Imported {
    #[serde(skip_deserializing)]
    between: &'static str,
    /// The name of the foreign file.
    file: String,
    /// Its .g7 text.
    text: String,
    told: Vec<Told>,
}

/// A problem that the reader told, in the language of the page.
#[derive(Debug, Deserialize, Serialize)]
struct Told {
    code: String,
    what: String,
    help: Option<String>,
}

/// Converts a foreign file.
pub(crate) fn import(Foreign { file, text }: Foreign, language: Language) -> Result<Imported, Said> {
    let (text, problems) = convert(&file, text)?;
    let told = problems.iter().map(|p| Told {
        code: p.code.id.to_owned(),
        what: p.what.in_language(language),
        help: p.help.as_ref().map(|h| h.in_language(language)),
    });
    Ok(Imported { between: "imported", file, text, told: told.collect() })
}

impl Imported {
    /// Opens the text under the name of the foreign file.
    pub(crate) fn file(self) -> Result<(String, File), Said> {
        let at = Span { file: FileId(0), start: 0, end: 0 };
        let problem = |told: Told| {
            let help = told.help.map(Said::foreign);
            let problem = Problem::new(codes::find(&told.code)?, at, Said::foreign(told.what));
            Some(Problem { help, ..problem })
        };
        let told = self.told.into_iter().filter_map(problem).collect();
        let file = File::imported(&self.file, self.text, told)?;
        Ok((self.file, file))
    }
}
