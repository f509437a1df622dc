//! Answers to the text view, in the form in which they are sent.

use g7_edit::{Head, UNITS};
use g7_ide::{File, completion, hover, logic, references, search, tables, tokens};
use g7_model::{Language, Qualifier, Said, VarKind, words};
use serde::{Deserialize, Serialize};

use crate::places::units;

/// The possible words, and the place at which the word begins.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Completions"))]
pub(crate) struct Completion {
    from: usize,
    items: Vec<Choice>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Completion"))]
struct Choice {
    label: String,
    kind: &'static str,
    detail: String,
    insert: String,
}

pub(crate) fn complete(file: &File, at: usize) -> Completion {
    let found = completion::complete(file, byte(file, at));
    let choice = |c: completion::Choice| Choice {
        label: c.label,
        kind: c.kind,
        detail: c.detail.in_language(file.language),
        insert: c.insert,
    };
    Completion {
        from: file.positions.unit(file.text(), found.from),
        items: found.items.into_iter().map(choice).collect(),
    }
}

/// An explanation of a piece of the text.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Hover {
    from: usize,
    to: usize,
    markdown: String,
}

pub(crate) fn hover(file: &File, at: usize) -> Option<Hover> {
    let found = hover::hover(file, byte(file, at))?;
    let (from, to) = units(file, &found.range);
    Some(Hover { from, to, markdown: found.markdown })
}

/// A token: its place, and its class.
pub(crate) type Coloured = (usize, usize, &'static str);

pub(crate) fn tokens(file: &File, from: usize, to: usize) -> Vec<Coloured> {
    let found = tokens::tokens(file, byte(file, from)..byte(file, to));
    let coloured = |t: tokens::Coloured| {
        let (from, to) = units(file, &t.range);
        (from, to, t.class.name())
    };
    found.into_iter().map(coloured).collect()
}

/// All places that name the same part as the word at a place.
pub(crate) fn references(file: &File, at: usize) -> Vec<(usize, usize)> {
    references::uses(file, byte(file, at)).all.iter().map(|range| units(file, range)).collect()
}

/// A result of a search.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "SearchHit", optional_fields))]
pub(crate) struct Hit {
    from: usize,
    to: usize,
    line: usize,
    text: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<String>,
}

pub(crate) fn search(file: &File, what: &str) -> Vec<Hit> {
    let hit = |h: search::Hit| {
        let (from, to) = units(file, &h.range);
        Hit { from, to, line: h.line, text: h.text, id: h.id, chart: h.chart }
    };
    search::search(file, what).into_iter().map(hit).collect()
}

/// The classes of variables.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "VariableClass"))]
#[serde(rename_all = "snake_case")]
enum Class {
    Input,
    Output,
    Var,
    Const,
}

/// The tables of variables and steps.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Symbols"))]
pub(crate) struct Tables {
    stale: bool,
    variables: Vec<Variable>,
    steps: Vec<Step>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "VariableRow", optional_fields))]
struct Variable {
    name: String,
    class: Class,
    #[serde(rename = "type")]
    ty: String,
    init: String,
    address: String,
    inverted: bool,
    retain: bool,
    safe: String,
    comment: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<String>,
    from: usize,
    to: usize,
    uses: usize,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "StepSymbol"))]
struct Step {
    id: String,
    name: String,
    chart: String,
    comment: String,
    initial: bool,
    from: usize,
    to: usize,
}

pub(crate) fn tables(file: &File) -> Tables {
    let readable = file.drawn();
    let found = tables::tables(&readable);
    let variable = |v: tables::Variable| {
        let (from, to) = readable.units(v.at);
        Variable {
            name: v.name,
            class: match v.class {
                VarKind::Input => Class::Input,
                VarKind::Output => Class::Output,
                VarKind::Var => Class::Var,
                VarKind::Const => Class::Const,
            },
            ty: v.ty,
            init: v.init,
            address: v.address,
            inverted: v.inverted,
            retain: v.retain,
            safe: v.safe,
            comment: v.comment,
            chart: v.chart,
            from,
            to,
            uses: v.uses,
        }
    };
    let step = |s: tables::Step| {
        let (from, to) = readable.units(s.at);
        Step { id: s.id, name: s.name, chart: s.chart, comment: s.comment, initial: s.initial, from, to }
    };
    Tables {
        stale: found.stale,
        variables: found.variables.into_iter().map(variable).collect(),
        steps: found.steps.into_iter().map(step).collect(),
    }
}

/// A language of controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub(crate) enum Tongue {
    St,
    Il,
    Ld,
}

/// The part of a symbol that a piece of logic is.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "LogicPart"))]
#[serde(rename_all = "snake_case")]
enum Part {
    Receptivity,
    Condition,
    Event,
    Body,
}

/// A piece of logic: the part of the symbol that it is, the number of the action in its step, and its text in the language
/// that was asked for.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "LogicPiece"))]
pub(crate) struct Piece {
    part: Part,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    index: Option<usize>,
    /// Null if the language cannot express it.
    text: Option<String>,
    /// Ladder has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    picture: Option<String>,
}

/// The logic of a symbol in one of the languages.
pub(crate) fn logic(file: &File, id: &str, tongue: Tongue) -> Result<Vec<Piece>, Said> {
    Ok(pieces(logic::logic(file, id, tongue.into())?))
}

/// The same in Structured Text: the others are not in the first module.
pub(crate) fn structured(file: &File, id: &str) -> Result<Vec<Piece>, Said> {
    Ok(pieces(logic::structured(file, id)?))
}

fn pieces(found: Vec<logic::Piece>) -> Vec<Piece> {
    let piece = |p: logic::Piece| Piece {
        part: match p.part {
            logic::Part::Receptivity => Part::Receptivity,
            logic::Part::Condition => Part::Condition,
            logic::Part::Event => Part::Event,
            logic::Part::Body => Part::Body,
        },
        index: p.index,
        text: p.text,
        picture: p.picture,
    };
    found.into_iter().map(piece).collect()
}

impl From<Tongue> for logic::Tongue {
    fn from(tongue: Tongue) -> logic::Tongue {
        match tongue {
            Tongue::St => logic::Tongue::St,
            Tongue::Il => logic::Tongue::Il,
            Tongue::Ld => logic::Tongue::Ld,
        }
    }
}

pub(crate) fn logic_read(tongue: Tongue, text: &str) -> Result<String, Said> {
    logic::read(tongue.into(), text)
}

/// A qualifier of actions.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct QualifierRow {
    name: &'static str,
    /// A time stands behind it.
    timed: bool,
    /// In a few words.
    does: String,
}

/// An action as typed, and the parts of its head.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct ActionForm {
    text: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    qualifier: Option<&'static str>,
    /// Its time as typed.
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<String>,
    /// The number and the unit of the time, if it has just one of each.
    #[serde(skip_serializing_if = "Option::is_none")]
    amount: Option<(String, &'static str)>,
    /// All qualifiers.
    qualifiers: Vec<QualifierRow>,
    /// The units of times.
    units: Vec<&'static str>,
}

/// The parts of an action, with another qualifier or time where one is given; an empty qualifier takes it away.
pub(crate) fn action_form(
    text: &str,
    qualifier: Option<&str>,
    time: Option<String>,
    language: Language,
) -> ActionForm {
    let mut text = text.to_owned();
    let mut head = Head::of(&text);
    if let Some(name) = qualifier {
        head.qualifier = Qualifier::named(name);
    }
    head.time = time.clone().or(head.time);
    if qualifier.is_some() || time.is_some() {
        text = head.written();
        head = Head::of(&text);
    }
    let row = |q: Qualifier| QualifierRow {
        name: q.name(),
        timed: q.timed(),
        does: words::in_language(words::of_qualifier(q)[0], language).to_owned(),
    };
    ActionForm {
        qualifier: head.qualifier.map(Qualifier::name),
        amount: head.amount().map(|(number, unit)| (number.to_owned(), unit)),
        time: head.time,
        qualifiers: Qualifier::ALL.map(row).into(),
        units: UNITS.into_iter().rev().collect(),
        text,
    }
}

fn byte(file: &File, unit: usize) -> usize {
    file.positions.byte(file.text(), unit)
}
