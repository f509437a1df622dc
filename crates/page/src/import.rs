//! Files of other tools on their way from the module that reads them to the page that opens them.

use g7_ide::{File, convert};
use g7_model::{FileId, Language, Problem, Said, Span, codes};
use serde::{Deserialize, Serialize};

/// The message that opens a converted file.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Imported {
    #[serde(rename = "do", skip_deserializing)]
    r#do: &'static str,
    /// The name of the foreign file.
    file: String,
    /// Its .g7 text.
    text: String,
    told: Vec<Told>,
}

/// What the reader told, in the language of the page.
#[derive(Debug, Deserialize, Serialize)]
struct Told {
    code: String,
    what: String,
    help: Option<String>,
}

/// Converts a foreign file.
pub(crate) fn import(file: String, text: String, language: Language) -> Result<Imported, String> {
    let (text, problems) = convert(&file, text)?;
    let told = problems.iter().map(|p| Told {
        code: p.code.id.to_owned(),
        what: p.what.in_language(language),
        help: p.help.as_ref().map(|h| h.in_language(language)),
    });
    Ok(Imported { r#do: "imported", file, text, told: told.collect() })
}

impl Imported {
    /// Opens the text; the file is called as the foreign one.
    pub(crate) fn file(self) -> Result<(String, File), String> {
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
