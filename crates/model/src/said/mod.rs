//! A text for a reader, that can be told in each language.
//!
//! Whoever reports a problem makes it with `say!`. It is English at once; a door of the program (the command
//! line, the language server, the page) asks for the language of its reader ([`Said::in_language`]), and the
//! table beside this file has the words. A plain `String` is no `Said`: what another program or a user wrote
//! is handed on as [`Said::foreign`].

pub(crate) mod spoken;
mod table;

use std::borrow::Cow;

use crate::Language;
pub use table::{Row, rows, teach};

/// A text, with the template and the parts it was made of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Said(Box<Made>);

/// Boxed, so that a result with a problem stays small.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Made {
    /// As it stands in the source; empty for a foreign text.
    template: &'static str,
    /// In English.
    text: Cow<'static, str>,
    parts: Vec<Part>,
    /// In French and Portuguese, where a table elsewhere has the words.
    told: Option<[String; 2]>,
}

impl Said {
    /// A text without holes. `say!` calls this.
    pub fn plain(template: &'static str, text: &'static str) -> Said {
        Said(Box::new(Made { template, text: Cow::Borrowed(text), ..Made::default() }))
    }

    /// A text with its holes filled in their order. `say!` calls this.
    pub fn filled(template: &'static str, parts: Vec<Part>) -> Said {
        let text = table::fill(template, template, &shown(&parts, Language::English));
        Said(Box::new(Made { template, text: Cow::Owned(text), parts, told: None }))
    }

    /// The text of another program, of a file or of a user: the same in each language.
    pub fn foreign(text: impl Into<String>) -> Said {
        Said(Box::new(Made { text: Cow::Owned(text.into()), ..Made::default() }))
    }

    /// A text that is given in each language, in the order of [`Language::ALL`].
    pub fn in_each([english, french, portuguese]: [String; 3]) -> Said {
        let told = Some([french, portuguese]);
        Said(Box::new(Made { text: Cow::Owned(english), told, ..Made::default() }))
    }

    /// In English.
    pub fn as_str(&self) -> &str {
        &self.0.text
    }

    /// In a language.
    pub fn in_language(&self, language: Language) -> String {
        match (&self.0.told, language) {
            (Some([french, _]), Language::French) => return french.clone(),
            (Some([_, portuguese]), Language::Portuguese) => return portuguese.clone(),
            _ => {}
        }
        if language == Language::English || self.0.template.is_empty() {
            return self.0.text.clone().into_owned();
        }
        // A text of no row stays English; a test finds it.
        let row = table::in_language(self.0.template, language).unwrap_or(self.0.template);
        table::fill(self.0.template, row, &shown(&self.0.parts, language))
    }
}

impl std::ops::Deref for Said {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0.text
    }
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&self.0.text)
    }
}

impl std::error::Error for Said {}

/// The content of a hole.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// A name, a number, a piece of somebody's text: the same in each language.
    Raw(String),
    /// A text with a row of its own.
    Said(Said),
}

impl Part {
    /// A part that stands in back-ticks.
    pub fn raw(shown: &impl ToString) -> Part {
        Part::Raw(shown.to_string())
    }

    fn in_language(&self, language: Language) -> String {
        match self {
            Part::Raw(text) => text.clone(),
            Part::Said(said) => said.in_language(language),
        }
    }
}

/// The parts in a language, by their numbers.
fn shown(parts: &[Part], language: Language) -> impl Fn(usize) -> Option<String> {
    move |k| parts.get(k).map(|part| part.in_language(language))
}

#[cfg(test)]
mod tests;
