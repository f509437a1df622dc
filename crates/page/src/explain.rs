//! The book's pages on problems, in English, French and Portuguese.

use g7_model::codes;

/// The pages, each with its language and its problem code. A module for browsers has the English ones alone:
/// the page fetches the others.
static PAGES: &[(&str, &str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page on a problem (`G0101`, in upper or lower case), with the source of the rule.
///
/// `language` is a tag such as `fr`, `pt-BR`, or `fr_FR.UTF-8` as in `LANG`. A language without pages gets
/// the English one.
pub fn explain(id: &str, language: &str) -> Option<String> {
    let code = codes::find(id)?;
    let tag = language.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or("");
    let page = |tag: &str| {
        PAGES
            .iter()
            .find(|(of, page, _)| of.eq_ignore_ascii_case(tag) && *page == code.id)
            .map(|(.., text)| *text)
    };
    let Some(text) = page(tag).or_else(|| page("en")) else {
        return Some(format!("# {}: {}\n\nSource: {}\n", code.id, code.title, code.source));
    };
    Some(format!("{}\n", text.trim_end()))
}
