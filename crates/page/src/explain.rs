//! The book's pages on problems, in English, French and Portuguese.

use g7_model::{Language, codes};

/// The pages, each with its language and its problem code.
static PAGES: &[(&str, &str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page on a problem (`G0101`, in upper or lower case), with the source of the rule; the English one where
/// there is none in the language.
pub fn explain(id: &str, language: Language) -> Option<String> {
    let code = codes::find(id)?;
    let page = |language: Language| {
        let own = PAGES.iter().find(|(of, page, _)| *of == language.tag() && *page == code.id);
        own.map(|(.., text)| *text)
    };
    let Some(text) = page(language).or_else(|| page(Language::English)) else {
        return Some(format!("# {}: {}\n\nSource: {}\n", code.id, code.title, code.source));
    };
    Some(format!("{}\n", text.trim_end()))
}
