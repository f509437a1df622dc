//! The names that a document defines, and their meaning.

use g7_compile::Definition;
use g7_compile::references::{Member, values};
use g7_model::{
    Chart, ChartItem, Composed, Document, InstanceNames, Item, Name, PlantItem, Said, Span, Step, VarDecl,
    say,
};
use g7_syntax::{Token, TokenKind};

use crate::file::OWN;

/// The meaning of a name.
#[derive(Clone, Copy, Debug)]
pub enum Meaning<'d> {
    /// A variable, with its chart if it belongs to one.
    Variable(&'d VarDecl, Option<&'d Chart>),
    /// A step of a chart.
    Step(&'d Chart, &'d Step),
    /// A chart.
    Chart(&'d Chart),
    /// A structure or function block.
    Type(&'d Composed),
    /// A member, a parameter or a variable of one.
    Member(Member<'d>),
    /// An enumeration, a type with bounds, or another name for a type.
    Named(&'d VarDecl),
    /// A value of this enumeration.
    Value(&'d VarDecl),
    /// A named action, function, section, plant, or part of a plant: the word for its kind, and its
    /// comment.
    Other(&'static str, Option<&'d str>),
}

/// A name at its definition.
#[derive(Clone, Copy, Debug)]
pub struct Named<'d> {
    /// The name.
    pub name: &'d Name,
    /// Its meaning.
    pub meaning: Meaning<'d>,
    /// The part of the text in which it is known; everywhere if absent.
    pub scope: Option<Span>,
}

/// All names that a document defines, in the order of the text.
pub fn names(document: &Document) -> Vec<Named<'_>> {
    let mut all = Vec::new();
    for item in &document.items {
        match item {
            Item::Var(v) => variable(v, None, &mut all),
            Item::Chart(c) => chart(c, &mut all),
            Item::Instance(i) => {
                if let InstanceNames::One(name) = &i.names {
                    other(name, "instance", i.comment.as_deref(), None, &mut all);
                }
            }
            Item::Composed(c) => {
                all.push(Named { name: &c.name, meaning: Meaning::Type(c), scope: None });
                let scope = Some(c.at.0);
                all.extend(Member::all(c).map(|m| Named {
                    name: m.name,
                    meaning: Meaning::Member(m),
                    scope,
                }));
            }
            Item::Type(t) => {
                let one = |name, meaning| Named { name, meaning, scope: None };
                all.extend(t.names.first().map(|name| one(name, Meaning::Named(t))));
                all.extend(values(t).map(|(_, name)| one(name, Meaning::Value(t))));
            }
            Item::Action(a) => other(&a.name, "action", a.comment.as_deref(), None, &mut all),
            Item::Section(s) => other(&s.name, "transition section", None, None, &mut all),
            Item::Function(f) => {
                other(&f.name, "function", None, None, &mut all);
                f.params.iter().for_each(|p| other(&p.name, "parameter", None, Some(f.at.0), &mut all));
            }
            Item::Plant(p) => {
                other(&p.name, "plant", p.comment.as_deref(), None, &mut all);
                // Tests set the states of a plant, so these names are known outside the plant too.
                p.items.iter().for_each(|i| plant(i, &mut all));
            }
            Item::Profile(_)
            | Item::Cycle(..)
            | Item::Target(..)
            | Item::Use(_)
            | Item::Pre(..)
            | Item::Post(..)
            | Item::Test(_)
            | Item::Prove(_)
            | Item::Layout(_) => {}
        }
    }
    all
}

fn variable<'d>(v: &'d VarDecl, of: Option<&'d Chart>, all: &mut Vec<Named<'d>>) {
    all.extend(v.names.iter().map(|name| Named {
        name,
        meaning: Meaning::Variable(v, of),
        scope: of.map(|c| c.at.0),
    }));
}

fn other<'d>(
    name: &'d Name,
    what: &'static str,
    comment: Option<&'d str>,
    scope: Option<Span>,
    all: &mut Vec<Named<'d>>,
) {
    all.push(Named { name, meaning: Meaning::Other(what, comment), scope });
}

fn chart<'d>(c: &'d Chart, all: &mut Vec<Named<'d>>) {
    all.push(Named { name: &c.name, meaning: Meaning::Chart(c), scope: None });
    let scope = Some(c.at.0);
    c.params.iter().for_each(|p| other(&p.name, "parameter", None, scope, all));
    for item in &c.items {
        match item {
            ChartItem::Var(v) => variable(v, Some(c), all),
            ChartItem::Step(s) => all.push(Named { name: &s.name, meaning: Meaning::Step(c, s), scope }),
            ChartItem::Action(a) => other(&a.name, "action", a.comment.as_deref(), scope, all),
            ChartItem::Section(s) => other(&s.name, "transition section", None, scope, all),
            ChartItem::Transition(t) => {
                if let Some(label) = &t.label {
                    other(label, "transition", t.comment.as_deref(), scope, all);
                }
            }
            ChartItem::Pre(..) | ChartItem::Post(..) => {}
        }
    }
}

fn plant<'d>(item: &'d PlantItem, all: &mut Vec<Named<'d>>) {
    match item {
        PlantItem::Const { names, comment, .. } => {
            names.iter().for_each(|n| other(n, "constant of the plant", comment.as_deref(), None, all));
        }
        PlantItem::State(s) => {
            s.names.iter().for_each(|n| other(n, "state of the plant", s.comment.as_deref(), None, all));
        }
        PlantItem::Parts(p) => other(&p.name, "parts of the plant", None, None, all),
        PlantItem::Arrivals(a) => other(&a.name, "arrivals of the plant", None, None, all),
        PlantItem::Rate(_)
        | PlantItem::Drive(_)
        | PlantItem::On(..)
        | PlantItem::Each(..)
        | PlantItem::View(_) => {}
    }
}

/// A word of a text, with the path before it.
pub struct Word<'t> {
    /// Its place.
    pub token: Token,
    /// The word without back-ticks.
    pub text: &'t str,
    /// `Chart` in `Chart.name`.
    pub before: Option<&'t str>,
}

/// The word that contains a byte or ends there.
pub fn word_at(text: &str, byte: usize) -> Option<Word<'_>> {
    let mut before: Option<Token> = None;
    let mut dotted = false;
    for token in g7_syntax::tokens(text) {
        let is_name = matches!(token.kind, TokenKind::Word | TokenKind::Ticked | TokenKind::Number);
        if token.start > byte {
            return None;
        }
        if is_name && token.start <= byte && byte <= token.end {
            let chart = before.filter(|_| dotted).and_then(|t| plain(text, t));
            return Some(Word { token, text: plain(text, token)?, before: chart });
        }
        match token.kind {
            TokenKind::PathDot => dotted = true,
            _ => (before, dotted) = (is_name.then_some(token), false),
        }
    }
    None
}

/// A name without its back-ticks.
fn plain(text: &str, token: Token) -> Option<&str> {
    let word = text.get(token.start..token.end)?;
    Some(word.trim_matches('`'))
}

/// The definition of a word of the text, as far as the place decides it.
pub fn meaning<'d>(document: &'d Document, word: &Word<'_>) -> Option<Named<'d>> {
    let at = u32::try_from(word.token.start).ok()?;
    let inside = |s: Span| s.file == OWN && s.start <= at && at < s.end;
    // `X12` and `Chart.X12` name the step variable of step 12.
    let stem = word.text.strip_prefix('X').filter(|s| s.starts_with(|c: char| c.is_ascii_digit()));
    let fits = |n: &Named<'_>| {
        let step = matches!(n.meaning, Meaning::Step(..));
        *n.name.text == *word.text || step && stem.is_some_and(|s| *n.name.text == *s)
    };
    let chart_of = |n: &Named<'d>| match n.meaning {
        Meaning::Step(c, _) | Meaning::Variable(_, Some(c)) => Some(&*c.name.text),
        Meaning::Variable(_, None)
        | Meaning::Chart(_)
        | Meaning::Type(_)
        | Meaning::Named(_)
        | Meaning::Value(_)
        | Meaning::Member(_)
        | Meaning::Other(..) => None,
    };
    let number = word.token.kind == TokenKind::Number;
    let mut found: Vec<Named<'d>> = names(document).into_iter().filter(fits).collect();
    found.retain(|n| !number || matches!(n.meaning, Meaning::Step(..)));
    // The spelling does not tell whose member a word is; see `declared`.
    found.retain(|n| !matches!(n.meaning, Meaning::Member(_)));
    if let Some(chart) = word.before
        && let Some(i) = found.iter().position(|n| chart_of(n) == Some(chart))
    {
        return Some(found.swap_remove(i));
    }
    // Prefer the innermost scope, then the file, then any other.
    let rank = |n: &Named<'_>| match n.scope {
        Some(s) if inside(s) => 0,
        None => 1,
        Some(_) => 2,
    };
    found.into_iter().min_by_key(rank).filter(|n| !number || rank(n) == 0)
}

/// The type, or the member of a type, that the file declares and that is named at a byte.
pub fn declared(document: &Document, byte: usize) -> Option<Named<'_>> {
    // Following all names is of use only where there are such types.
    document.items.iter().find(|i| matches!(i, Item::Composed(_) | Item::Type(_)))?;
    let known = g7_compile::references(document).seen_from(OWN);
    let definition = known.at(u32::try_from(byte).ok()?)?;
    names(document).into_iter().find(|n| match (&n.meaning, definition) {
        (Meaning::Type(_) | Meaning::Named(_), Definition::Type(name)) => *n.name.text == **name,
        (Meaning::Value(t), Definition::Value { of, name }) => {
            *n.name.text == **name && t.names.first().is_some_and(|n| *n.text == **of)
        }
        (Meaning::Member(m), Definition::Member { of, name }) => {
            *n.name.text == **name && *m.of.name.text == **of
        }
        _ => false,
    })
}

/// The word for the kind of a name ([`Meaning::Other`]).
pub fn sort(what: &'static str) -> Said {
    match what {
        "action" => say!("action"),
        "transition section" => say!("transition section"),
        "function" => say!("function"),
        "parameter" => say!("parameter"),
        "plant" => say!("plant"),
        "transition" => say!("transition"),
        "constant of the plant" => say!("constant of the plant"),
        "state of the plant" => say!("state of the plant"),
        "parts of the plant" => say!("parts of the plant"),
        "arrivals of the plant" => say!("arrivals of the plant"),
        other => Said::foreign(other),
    }
}
