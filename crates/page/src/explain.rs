//! The pages of the book on problems.

use g7_model::codes;

/// Pages by problem, in the order of their numbers.
static PAGES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// The page of a problem, `G0101` in any case: its text and where the rule comes from.
pub fn explain(id: &str) -> Option<String> {
    let code = codes::find(id)?;
    let page = PAGES.iter().find(|(page, _)| *page == code.id);
    let text = page.map_or_else(|| format!("# {}: {}", code.id, code.title), |(_, text)| (*text).to_owned());
    let text = text.trim_end();
    // Most pages name their sources themselves.
    if text.lines().any(|line| line.starts_with("Source:")) {
        return Some(format!("{text}\n"));
    }
    Some(format!("{text}\n\nSource: {}\n", code.source))
}
