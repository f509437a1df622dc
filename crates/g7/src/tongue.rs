//! The language of the messages: `--lang`, or else that of the surroundings.
//!
//! It is chosen once, as the program begins; reports ask for it here. The language server has the language of
//! its editor instead, and the page that of its own switch.

use std::sync::OnceLock;

use clap::ValueEnum;
use g7_model::Language;

static CHOSEN: OnceLock<Language> = OnceLock::new();

/// A language of the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Tongue {
    /// English.
    En,
    /// French.
    Fr,
    /// Portuguese.
    Pt,
}

/// Chooses the language of this run.
pub(crate) fn choose(wish: Option<Tongue>) {
    let wished = wish.map(|tongue| match tongue {
        Tongue::En => Language::English,
        Tongue::Fr => Language::French,
        Tongue::Pt => Language::Portuguese,
    });
    let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let language = wished.unwrap_or_else(|| of_surroundings(variable));
    // A second choice would be a mistake of this program; the first one stays.
    let _ = CHOSEN.set(language);
}

/// The language of the first variable that is set, as POSIX orders them.
fn of_surroundings(variable: impl Fn(&str) -> Option<String>) -> Language {
    let locale = ["LC_ALL", "LC_MESSAGES", "LANG"].into_iter().find_map(variable);
    locale.and_then(|locale| Language::of(&locale)).unwrap_or_default()
}

/// The language of this run.
pub(crate) fn language() -> Language {
    CHOSEN.get().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::of_surroundings;
    use g7_model::Language;

    #[test]
    fn the_first_variable_that_is_set_decides() {
        let of = |set: &[(&str, &str)]| {
            of_surroundings(|name| set.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned()))
        };
        assert_eq!(of(&[("LANG", "fr_FR.UTF-8")]), Language::French);
        assert_eq!(of(&[("LANG", "fr_FR.UTF-8"), ("LC_ALL", "C")]), Language::English);
        assert_eq!(of(&[("LANG", "fr"), ("LC_MESSAGES", "pt_PT")]), Language::Portuguese);
        assert_eq!(of(&[("LANG", "de_DE.UTF-8")]), Language::English);
        assert_eq!(of(&[]), Language::English);
    }
}
