//! A short explanation of the text under the pointer.

use std::ops::Range;

use g7_model::{Qualifier, StandardFunction, Type, words};

use crate::file::File;
use crate::names::{Meaning, Named, meaning, word_at};
use crate::tables::declaration;

/// An explanation of a piece of the text.
#[derive(Debug)]
pub struct Hover {
    /// The bytes that it explains.
    pub range: Range<usize>,
    /// The explanation, as Markdown.
    pub markdown: String,
}

/// The explanation of the text at a byte.
pub fn hover(file: &File, byte: usize) -> Option<Hover> {
    let problem = file.problems.iter().filter(|p| {
        let range = file.source.range(p.at);
        range.start <= byte && byte <= range.end && range.len() < 400
    });
    let said: Vec<String> = problem
        .map(|p| {
            let help = p.help.as_ref().map_or(String::new(), |h| format!("  \n{h}"));
            format!("**{}** {}{help}", p.code.id, p.what)
        })
        .collect();
    let word = word_at(file.text(), byte);
    let named = word.as_ref().and_then(|w| meaning(&file.source.document, w));
    let range = match &word {
        Some(w) => w.token.start..w.token.end,
        None => {
            let mut ranges = file.problems.iter().map(|p| file.source.range(p.at));
            ranges.find(|range| range.start <= byte && byte <= range.end)?
        }
    };
    let about = named.map(|n| describe(&n)).or_else(|| word.and_then(|w| explain(w.text)));
    let parts: Vec<String> = said.into_iter().chain(about).collect();
    (!parts.is_empty()).then(|| Hover { range, markdown: parts.join("\n\n") })
}

fn describe(n: &Named<'_>) -> String {
    let name = &n.name.text;
    let with = |head: String, comment: Option<&str>| match comment {
        Some(c) => format!("{head}  \n{c}"),
        None => head,
    };
    match n.meaning {
        Meaning::Variable(v, chart) => {
            let of = chart.map_or(String::new(), |c| format!(" of chart {}", c.name.text));
            with(format!("`{}`{of}", declaration(name, v)), v.comment.as_deref())
        }
        Meaning::Step(c, s) => {
            let sort = if s.initial { "initial step" } else { "step" };
            let actions = match s.actions.len() {
                0 => String::new(),
                1 => ", 1 action".to_owned(),
                n => format!(", {n} actions"),
            };
            with(format!("{sort} `{name}` of chart `{}`{actions}", c.name.text), s.comment.as_deref())
        }
        Meaning::Chart(c) => {
            let count = format!("{} steps, {} transitions", c.steps().count(), c.transitions().count());
            with(format!("{} `{name}`: {count}", crate::tables::kind(c.kind)), c.comment.as_deref())
        }
        Meaning::Other(what, comment) => with(format!("{what} `{name}`"), comment),
    }
}

/// Explains a word of the language.
fn explain(word: &str) -> Option<String> {
    if let Some(qualifier) = Qualifier::named(word) {
        return Some(format!("**{word}**: {}", words::of_qualifier(qualifier)[0]));
    }
    let standard = StandardFunction::named(word).map(StandardFunction::row).filter(|row| row.name == word);
    if let Some(row) = standard {
        return Some(format!("**{}**({}): {}", row.name, row.inputs.join(", "), row.does[0]));
    }
    if let Some(ty) = Type::named(word) {
        return Some(format!("**{word}**: {}", words::of_type(ty)[0]));
    }
    let mut told: Vec<&str> = words::rows(word).map(|w| w.does[0]).collect();
    told.dedup();
    (!told.is_empty()).then(|| format!("**{word}**: {}", told.join("; or ")))
}
