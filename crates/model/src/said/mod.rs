//! A text for a reader, that can be told in each language.
//!
//! Whoever reports a problem makes it with `say!`. It is English at once; a door of the program (the command
//! line, the language server, the page) asks for the language of its reader ([`Said::in_language`]), and the
//! table beside this file has the words. A plain `String` is no `Said`: what another program or a user wrote
//! is handed on as [`Said::foreign`].

mod part;
mod table;

use std::borrow::Cow;

use crate::Language;
pub use part::{Part, Spoken};
pub use table::{Row, rows};

/// A text, with the template and the parts it was made of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Said {
    /// As it stands in the source; empty for a foreign text.
    template: &'static str,
    /// In English.
    text: Cow<'static, str>,
    parts: Vec<Part>,
}

impl Said {
    /// A text without holes. `say!` calls this.
    pub const fn plain(template: &'static str, text: &'static str) -> Said {
        Said { template, text: Cow::Borrowed(text), parts: Vec::new() }
    }

    /// A text with its holes filled in their order. `say!` calls this.
    pub fn filled(template: &'static str, parts: Vec<Part>) -> Said {
        let text = table::fill(template, template, &parts, Language::English);
        Said { template, text: Cow::Owned(text), parts }
    }

    /// The text of another program, of a file or of a user: the same in each language.
    pub fn foreign(text: impl Into<String>) -> Said {
        Said { template: "", text: Cow::Owned(text.into()), parts: Vec::new() }
    }

    /// In English.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// In a language.
    pub fn in_language(&self, language: Language) -> String {
        if language == Language::English || self.template.is_empty() {
            return self.text.clone().into_owned();
        }
        // A text of no row stays English; a test finds it.
        let row = table::in_language(self.template, language).unwrap_or(self.template);
        table::fill(self.template, row, &self.parts, language)
    }
}

impl std::ops::Deref for Said {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&self.text)
    }
}

#[cfg(test)]
mod tests;
