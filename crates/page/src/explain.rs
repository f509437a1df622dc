//! The book's pages on problems.

use g7_model::codes;

/// The pages by problem code, in the order of the codes.
static PAGES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page on a problem (`G0101`, in upper or lower case), with the source of the rule.
pub fn explain(id: &str) -> Option<String> {
    let code = codes::find(id)?;
    let page = PAGES.iter().find(|(page, _)| *page == code.id);
    let text = page.map_or_else(|| format!("# {}: {}", code.id, code.title), |(_, text)| (*text).to_owned());
    let text = text.trim_end();
    // Most pages name their sources in their own text.
    if text.lines().any(|line| line.starts_with("Source:")) {
        return Some(format!("{text}\n"));
    }
    Some(format!("{text}\n\nSource: {}\n", code.source))
}
