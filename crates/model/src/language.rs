//! The languages in which the program speaks to its readers.

use crate::words::Told;

/// A language of messages, words and pages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Language {
    /// English: every text is written in it first.
    #[default]
    English,
    /// French, with the terms of IEC 60848.
    French,
    /// Portuguese, as in Portugal.
    Portuguese,
}

impl Language {
    /// All of them, in the order of a [`Told`].
    pub const ALL: [Language; 3] = [Language::English, Language::French, Language::Portuguese];

    /// Its tag: `en`, `fr`, `pt`.
    pub const fn tag(self) -> &'static str {
        match self {
            Language::English => "en",
            Language::French => "fr",
            Language::Portuguese => "pt",
        }
    }

    /// The language of a tag or a locale: `fr`, `fr-CA`, `fr_FR.UTF-8`, `FR`; none for other languages.
    pub fn of(locale: &str) -> Option<Language> {
        let tag = locale.split(['-', '_', '.', '@']).next().unwrap_or_default();
        Language::ALL.into_iter().find(|l| l.tag().eq_ignore_ascii_case(tag))
    }

    /// The sentence of this language.
    pub const fn told(self, told: Told) -> &'static str {
        let [english, french, portuguese] = told;
        match self {
            Language::English => english,
            Language::French => french,
            Language::Portuguese => portuguese,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Language;

    #[test]
    fn locales_name_their_language() {
        for (locale, language) in [
            ("fr_FR.UTF-8", Some(Language::French)),
            ("pt-BR", Some(Language::Portuguese)),
            ("EN", Some(Language::English)),
            ("fr", Some(Language::French)),
            ("C.UTF-8", None),
            ("frr_DE", None),
            ("", None),
        ] {
            assert_eq!(Language::of(locale), language, "{locale}");
        }
    }
}
