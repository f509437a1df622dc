//! The texts of an exercise, each in up to three languages: the statement, and the hints in their steps.

use std::collections::BTreeMap;

use g7_model::Language;

/// The files of a folder: their bytes by their paths from it, with `/` between the parts.
pub type Files = BTreeMap<String, Vec<u8>>;

/// One text in up to three languages, in the order of [`Language::ALL`]. `None`: the text is missing in that language.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts([Option<String>; 3]);

impl Texts {
    /// The text of `statement.md`, `statement.fr.md` and `statement.pt.md`, for the name `statement`.
    pub(crate) fn of(files: &Files, name: &str) -> Texts {
        Texts(Language::ALL.map(|language| {
            let bytes = files.get(&file_name(name, language))?;
            let text = String::from_utf8_lossy(bytes).trim().to_owned();
            (!text.is_empty()).then_some(text)
        }))
    }

    /// The text in a language, or else in English.
    pub fn in_language(&self, language: Language) -> &str {
        self.own(language).or(self.0[0].as_deref()).unwrap_or_default()
    }

    /// The text in this language, if there is one.
    pub fn own(&self, language: Language) -> Option<&str> {
        let texts = Language::ALL.iter().zip(&self.0);
        texts.filter(|(of, _)| **of == language).find_map(|(_, text)| text.as_deref())
    }

    /// The first heading in a language: the title of an exercise.
    pub fn title(&self, language: Language) -> &str {
        let text = self.in_language(language);
        let heading = text.lines().find_map(|l| l.strip_prefix("# "));
        heading.or_else(|| text.lines().next()).unwrap_or_default().trim()
    }

    /// The steps in a language: each begins with a heading `## `.
    pub fn steps(&self, language: Language) -> Vec<&str> {
        steps(self.in_language(language))
    }

    /// The languages whose number of steps differs from that of the English text, with both numbers.
    pub(crate) fn uneven(&self) -> Vec<(Language, usize, usize)> {
        let english = self.steps(Language::English).len();
        let own = Language::ALL.into_iter().filter_map(|l| Some((l, steps(self.own(l)?).len())));
        own.filter(|(_, n)| *n != english).map(|(l, n)| (l, n, english)).collect()
    }
}

/// The file of a text in a language.
pub(crate) fn file_name(name: &str, language: Language) -> String {
    match language {
        Language::English => format!("{name}.md"),
        other => format!("{name}.{}.md", other.tag()),
    }
}

fn steps(text: &str) -> Vec<&str> {
    const HEAD: &str = "## ";
    let begins: Vec<usize> = text
        .match_indices(HEAD)
        .map(|(at, _)| at)
        .filter(|at| *at == 0 || text.get(..*at).is_some_and(|before| before.ends_with('\n')))
        .collect();
    let ends = begins.iter().skip(1).copied().chain([text.len()]);
    begins.iter().zip(ends).filter_map(|(from, to)| text.get(*from..to)).map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_heading_begins_a_step() {
        assert_eq!(
            steps("intro\n## One\na ## b\n\n## Two\n### More\n"),
            ["## One\na ## b", "## Two\n### More"]
        );
        assert_eq!(steps("no heading"), Vec::<&str>::new());
    }

    #[test]
    fn a_language_without_a_text_has_the_english_one() {
        let files: Files = [("s.md", "# Lamp\n"), ("s.fr.md", "# Lampe\n")]
            .map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()))
            .into();
        let texts = Texts::of(&files, "s");
        let titles = Language::ALL.map(|l| texts.title(l));
        assert_eq!(titles, ["Lamp", "Lampe", "Lamp"]);
    }
}
