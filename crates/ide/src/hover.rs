//! A short explanation of the text under the pointer.

use std::ops::Range;

use g7_compile::references::{Declared, Member};
use g7_model::{Language, Problem, Qualifier, Said, StandardFunction, Type, say, words};

use crate::file::File;
use crate::names::{Meaning, Named, declared, meaning, sort, word_at};
use crate::rules;
use crate::tables::{declaration, kind, member_declaration, type_declaration};

/// An explanation of a piece of the text.
#[derive(Debug)]
pub struct Hover {
    /// The bytes that it explains.
    pub range: Range<usize>,
    /// The explanation, as Markdown.
    pub markdown: String,
    /// The source of the rule that a problem there breaks.
    pub source: Option<&'static str>,
    /// The name of the case that shows the rule (see [`crate::cases`]).
    pub case: Option<&'static str>,
}

/// The explanation of the text at a byte.
pub fn hover(file: &File, byte: usize) -> Option<Hover> {
    let touches = |range: &Range<usize>| range.start <= byte && byte <= range.end;
    let near = |p: &&Problem| {
        let range = file.source.range(p.at);
        touches(&range) && range.len() < 400
    };
    let problems: Vec<&Problem> = file.problems.iter().filter(near).collect();
    let language = file.language;
    let said = problems.iter().map(|p| {
        let help = p.help.as_ref().map_or(String::new(), |h| format!("  \n{}", h.in_language(language)));
        format!("**{}** {}{help}", p.code.id, p.what.in_language(language))
    });
    let word = word_at(file.text(), byte);
    let sign = if word.is_none() { sign_at(file.text(), byte) } else { None };
    let range = match (&word, &sign) {
        (Some(w), _) => w.token.start..w.token.end,
        (None, Some(sign)) => sign.clone(),
        (None, None) => file.problems.iter().map(|p| file.source.range(p.at)).find(touches)?,
    };
    let document = file.source.whole();
    let named = word.as_ref().and_then(|w| declared(document, byte).or_else(|| meaning(document, w)));
    let (about, rule) = match (named, &word, &sign) {
        (Some(named), _, _) => (Some(describe(&named, language)), None),
        (None, Some(word), _) => (explain(word.text, language), rules::of_word(word.text)),
        (None, None, Some(sign)) => explain_sign(file, sign),
        (None, None, None) => (None, None),
    };
    let parts: Vec<String> = said.chain(about).collect();
    if parts.is_empty() {
        return None;
    }
    let broken = problems.iter().find_map(|p| rules::of(rules::OF_CODES, p.code.id));
    let source = problems.first().map(|p| p.code.source);
    Some(Hover { range, markdown: parts.join("\n\n"), source, case: broken.or(rule) })
}

/// The arrow of a transition or the sign of an edge that contains a byte or ends there.
fn sign_at(text: &str, byte: usize) -> Option<Range<usize>> {
    let signs = g7_syntax::tokens(text).take_while(|t| t.start <= byte).filter(|t| byte <= t.end);
    let told = |range: &Range<usize>| matches!(text.get(range.clone()), Some("->" | "→" | "↑" | "^" | "↓"));
    signs.map(|t| t.start..t.end).find(told)
}

/// The meaning of a sign, and the case of its rule.
fn explain_sign(file: &File, sign: &Range<usize>) -> (Option<String>, Option<&'static str>) {
    let word = match file.text().get(sign.clone()) {
        Some("↑" | "^") => "rise",
        Some("↓") => "fall",
        _ => {
            let told = rules::of_arrow(&file.source.document, sign.start);
            return told.map(|(said, case)| (said.in_language(file.language), case)).unzip();
        }
    };
    (explain(word, file.language), rules::of_word(word))
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
            let kind = kind(c.kind);
            let head = say!("{kind} `{name}`: {steps} steps, {transitions} transitions");
            with(head, c.comment.as_deref())
        }
        Meaning::Type(c) => {
            let word = if c.block { "function block" } else { "struct" };
            let head = with(Said::foreign(format!("`{word} {name}`")), c.comment.as_deref());
            // The variables of a body are of no use to those who declare one.
            let shown = Member::all(c).filter(|m| !matches!(m.declared, Declared::Local(_)));
            let members = shown.map(|m| format!("  \n`{}`", member_declaration(&m)));
            std::iter::once(head).chain(members).collect()
        }
        Meaning::Named(t) => with(Said::foreign(format!("`{}`", type_declaration(t))), t.comment.as_deref()),
        Meaning::Value(t) => {
            let of = t.names.first().map_or("", |n| &*n.text);
            with(say!("value `{name}` of `{of}`"), t.comment.as_deref())
        }
        Meaning::Member(m) => {
            let head = say!("`{}` of `{}`", member_declaration(&m), m.of.name.text);
            with(
                head,
                match m.declared {
                    Declared::Var(v) | Declared::InOut(v) => v.comment.as_deref(),
                    Declared::Local(_) => None,
                },
            )
        }
        Meaning::Other(what, comment) => with(say!("{} `{name}`", sort(what)), comment),
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
