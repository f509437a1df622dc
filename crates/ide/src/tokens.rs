//! Colours for a text: the class of each word.

use std::collections::HashSet;
use std::ops::Range;

use g7_model::{Type, words};
use g7_syntax::{Token, TokenKind};

use crate::file::File;
use crate::names::{Meaning, names};

/// The class of a token, from which an editor chooses the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A word of the language.
    Keyword,
    /// A type.
    Type,
    /// A chart.
    Chart,
    /// A variable, or another name that is no step and no chart.
    Variable,
    /// A step, or its step variable.
    Step,
    /// A function.
    Function,
    /// A name that is not known.
    Name,
    /// A number.
    Number,
    /// A duration.
    Time,
    /// A text in quotes.
    String,
    /// A comment of the chart.
    Comment,
    /// A note of the author, which belongs to no symbol.
    Note,
    /// A direct name, `%I0.1`.
    Direct,
    /// A bracket or brace.
    Bracket,
    /// A sign between other tokens.
    Punctuation,
    /// An operator.
    Operator,
}

impl Class {
    /// All classes.
    pub const ALL: [Class; 16] = [
        Class::Keyword,
        Class::Type,
        Class::Chart,
        Class::Variable,
        Class::Step,
        Class::Function,
        Class::Name,
        Class::Number,
        Class::Time,
        Class::String,
        Class::Comment,
        Class::Note,
        Class::Direct,
        Class::Bracket,
        Class::Punctuation,
        Class::Operator,
    ];

    /// The word for the class.
    pub fn name(self) -> &'static str {
        match self {
            Class::Keyword => "keyword",
            Class::Type => "type",
            Class::Chart => "chart",
            Class::Variable => "variable",
            Class::Step => "step",
            Class::Function => "function",
            Class::Name => "name",
            Class::Number => "number",
            Class::Time => "time",
            Class::String => "string",
            Class::Comment => "comment",
            Class::Note => "note",
            Class::Direct => "direct",
            Class::Bracket => "bracket",
            Class::Punctuation => "punctuation",
            Class::Operator => "operator",
        }
    }
}

/// A token: its bytes, and its class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coloured {
    /// Its bytes.
    pub range: Range<usize>,
    /// Its class.
    pub class: Class,
}

/// The tokens that lie, at least in part, between two bytes.
pub fn tokens(file: &File, range: Range<usize>) -> Vec<Coloured> {
    let text = file.text();
    let readable = file.drawn();
    let (mut variables, mut steps) = (HashSet::new(), HashSet::new());
    let (mut charts, mut types) = (HashSet::new(), HashSet::new());
    for n in names(readable.document) {
        let list = match n.meaning {
            Meaning::Step(..) => &mut steps,
            Meaning::Chart(_) => &mut charts,
            Meaning::Type(_) | Meaning::Named(_) => &mut types,
            Meaning::Variable(..) | Meaning::Value(_) | Meaning::Member(_) | Meaning::Other(..) => {
                &mut variables
            }
        };
        list.insert(&*n.name.text);
    }
    let (first, last) = (range.start, range.end);
    let mut out = Vec::new();
    let all: Vec<Token> = g7_syntax::tokens(text).take_while(|t| t.start < last).collect();
    for (i, token) in all.iter().enumerate() {
        if token.end <= first {
            continue;
        }
        let before = i.checked_sub(1).and_then(|i| all.get(i));
        let behind = all.get(i + 1);
        let word = text.get(token.start..token.end).unwrap_or("");
        let class = match token.kind {
            TokenKind::Word | TokenKind::Ticked => {
                let name = word.trim_matches('`');
                let other = variables.contains(name) || steps.contains(name) || charts.contains(name);
                let of_file = types.contains(name);
                let known = other || of_file;
                let ticked = token.kind == TokenKind::Ticked;
                let of_language = !ticked && Type::named(&word.to_ascii_uppercase()).is_some();
                if !ticked && is_keyword(text, word, before, token, behind, known) {
                    Class::Keyword
                } else if of_language && !known || of_file && (!other || is_type_place(text, before)) {
                    Class::Type
                } else if charts.contains(name) {
                    Class::Chart
                } else if variables.contains(name) {
                    Class::Variable
                } else if steps.contains(name) || is_activity(name, &steps) {
                    Class::Step
                } else if behind.is_some_and(|b| b.kind == TokenKind::LParen && b.start == token.end) {
                    Class::Function
                } else {
                    Class::Name
                }
            }
            TokenKind::Number if steps.contains(word) && is_step_place(text, before, behind) => Class::Step,
            TokenKind::Number => Class::Number,
            TokenKind::Time => Class::Time,
            TokenKind::Str => Class::String,
            TokenKind::Comment => Class::Comment,
            TokenKind::Note => Class::Note,
            TokenKind::Direct => Class::Direct,
            TokenKind::LBrace | TokenKind::RBrace | TokenKind::LParen | TokenKind::RParen => Class::Bracket,
            TokenKind::Comma | TokenKind::Semi | TokenKind::Colon | TokenKind::PathDot => Class::Punctuation,
            TokenKind::Arrow | TokenKind::Star | TokenKind::Sign => Class::Operator,
        };
        out.push(Coloured { range: token.start..token.end, class });
    }
    out
}

fn is_keyword(
    text: &str,
    word: &str,
    before: Option<&Token>,
    token: &Token,
    behind: Option<&Token>,
    known: bool,
) -> bool {
    if g7_syntax::is_reserved(word) {
        return true;
    }
    let between = before.map_or("\n", |b| text.get(b.end..token.start).unwrap_or(""));
    let begins = between.contains('\n')
        || before.is_some_and(|b| matches!(b.kind, TokenKind::LBrace | TokenKind::RBrace | TokenKind::Semi));
    // A word before an assignment, arrow, comma, colon or dot is a name.
    let named = behind.is_some_and(|b| {
        let sign = text.get(b.start..b.end).unwrap_or("");
        matches!(b.kind, TokenKind::Arrow | TokenKind::Comma | TokenKind::PathDot | TokenKind::Colon)
            || sign == ":="
    });
    let dotted = before.is_some_and(|b| b.kind == TokenKind::PathDot);
    if dotted || named {
        return false;
    }
    // A function can have the name `block`.
    let own = before.is_some_and(|b| text.get(b.start..b.end) == Some("function")) && word == "block";
    if own && behind.is_none_or(|b| b.kind != TokenKind::LParen) {
        return true;
    }
    begins && words::begins(word) || !begins && !known && words::goes_on(word)
}

/// True if the name of a type is expected behind a token: a variable can have the name of a type.
fn is_type_place(text: &str, before: Option<&Token>) -> bool {
    let word = before.and_then(|b| text.get(b.start..b.end)).unwrap_or("");
    matches!(word, ":" | "struct" | "block") || word.eq_ignore_ascii_case("of")
}

/// `X12`, where there is a step 12.
fn is_activity(name: &str, steps: &HashSet<&str>) -> bool {
    name.strip_prefix('X').is_some_and(|s| steps.contains(s))
}

/// True if a number stands where the name of a step is expected.
fn is_step_place(text: &str, before: Option<&Token>, behind: Option<&Token>) -> bool {
    let word = before.and_then(|b| text.get(b.start..b.end)).unwrap_or("");
    let arrow = |t: Option<&Token>| t.is_some_and(|t| t.kind == TokenKind::Arrow);
    matches!(word, "step" | "macro" | "enclosing") || arrow(before) || arrow(behind)
}
