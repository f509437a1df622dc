//! A short explanation of the text under the pointer.

use std::ops::Range;

use g7_model::{ChartKind, Language, Qualifier, Said, StandardFunction, Type, say, words};

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
    let language = file.language;
    let said: Vec<String> = problem
        .map(|p| {
            let help = p.help.as_ref().map_or(String::new(), |h| format!("  \n{}", h.in_language(language)));
            format!("**{}** {}{help}", p.code.id, p.what.in_language(language))
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
    let about =
        named.map(|n| describe(&n, language)).or_else(|| word.and_then(|w| explain(w.text, language)));
    let parts: Vec<String> = said.into_iter().chain(about).collect();
    (!parts.is_empty()).then(|| Hover { range, markdown: parts.join("\n\n") })
}

fn describe(n: &Named<'_>, language: Language) -> String {
    let name = &n.name.text;
    let with = |head: Said, comment: Option<&str>| match (head.in_language(language), comment) {
        (head, Some(c)) => format!("{head}  \n{c}"),
        (head, None) => head,
    };
    match n.meaning {
        Meaning::Variable(v, chart) => {
            let declared = declaration(name, v);
            let head = match chart {
                Some(c) => say!("`{declared}` of chart {}", Said::foreign(&*c.name.text)),
                None => say!("`{declared}`"),
            };
            with(head, v.comment.as_deref())
        }
        Meaning::Step(c, s) => {
            let sort = if s.initial { say!("initial step") } else { say!("step") };
            let actions = match s.actions.len() {
                0 => Said::default(),
                1 => say!(", 1 action"),
                n => say!(", {n} actions"),
            };
            with(say!("{sort} `{name}` of chart `{}`{actions}", c.name.text), s.comment.as_deref())
        }
        Meaning::Chart(c) => {
            let (steps, transitions) = (c.steps().count(), c.transitions().count());
            let kind = match c.kind {
                ChartKind::Chart => say!("chart"),
                ChartKind::Expansion => say!("expansion"),
                ChartKind::Task => say!("task"),
            };
            let head = say!("{kind} `{name}`: {steps} steps, {transitions} transitions");
            with(head, c.comment.as_deref())
        }
        Meaning::Other(what, comment) => with(say!("{} `{name}`", Said::foreign(what)), comment),
    }
}

/// Explains a word of the language.
fn explain(word: &str, language: Language) -> Option<String> {
    if let Some(qualifier) = Qualifier::named(word) {
        return Some(format!("**{word}**: {}", language.told(words::of_qualifier(qualifier))));
    }
    let standard = StandardFunction::named(word).map(StandardFunction::row).filter(|row| row.name == word);
    if let Some(row) = standard {
        return Some(format!("**{}**({}): {}", row.name, row.inputs.join(", "), language.told(row.does)));
    }
    if let Some(ty) = Type::named(word) {
        return Some(format!("**{word}**: {}", language.told(words::of_type(ty))));
    }
    let mut told: Vec<&str> = words::rows(word).map(|w| language.told(w.does)).collect();
    told.dedup();
    (!told.is_empty())
        .then(|| format!("**{word}**: {}", told.join(language.told(["; or ", "; ou ", "; ou "]))))
}
