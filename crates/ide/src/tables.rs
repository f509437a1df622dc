//! The tables of variables and steps.

use g7_compile::references::{Declared, Member};
use g7_model::{ChartKind, Document, Item, Limits, Said, Span, Type, ValueType, VarDecl, VarKind, say};

use crate::file::Readable;
use crate::ids;
use crate::names::{Meaning, names};

/// The tables of a file.
#[derive(Debug)]
pub struct Tables {
    /// True if they show an earlier text, because the present one has syntax errors.
    pub stale: bool,
    /// The variables, in the order of the text.
    pub variables: Vec<Variable>,
    /// The steps, in the order of the text.
    pub steps: Vec<Step>,
}

/// A variable, as declared; what is not there is empty.
#[derive(Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: VarKind,
    /// Its type.
    pub ty: String,
    /// Its initial value.
    pub init: String,
    /// The address of its input or output channel, such as `%I0.0`.
    pub address: String,
    /// True if the channel carries the complement.
    pub inverted: bool,
    /// True if it keeps its value over a warm restart.
    pub retain: bool,
    /// Its value after a fault.
    pub safe: String,
    /// Its comment.
    pub comment: String,
    /// The chart that it belongs to.
    pub chart: Option<String>,
    /// The place of its name.
    pub at: Span,
    /// The number of uses in the text, without the declaration.
    pub uses: usize,
}

/// A step.
#[derive(Debug)]
pub struct Step {
    /// Its id.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Its chart.
    pub chart: String,
    /// Its comment; empty if there is none.
    pub comment: String,
    /// True if it is active in the initial situation.
    pub initial: bool,
    /// The place of its name.
    pub at: Span,
}

/// The word for a kind of chart.
pub fn kind(kind: ChartKind) -> Said {
    match kind {
        ChartKind::Chart => say!("chart"),
        ChartKind::Expansion => say!("expansion"),
        ChartKind::Task => say!("task"),
    }
}

/// The word for a class of variables.
pub fn class(kind: VarKind) -> &'static str {
    match kind {
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Var => "var",
        VarKind::Const => "const",
    }
}

/// The tables of a document.
pub fn tables(readable: &Readable<'_>) -> Tables {
    let document = readable.document;
    let (mut variables, mut steps) = (Vec::new(), Vec::new());
    let mut counts: std::collections::HashMap<&str, usize> = Default::default();
    for t in g7_syntax::tokens(readable.text) {
        let word = readable.text.get(t.start..t.end).unwrap_or("").trim_matches('`');
        *counts.entry(word).or_default() += 1;
    }
    for n in names(document) {
        let at = n.name.at.0;
        match n.meaning {
            Meaning::Variable(v, chart) => variables.push(Variable {
                name: n.name.text.to_string(),
                class: v.kind,
                ty: declared_type(v),
                init: v.init.as_ref().map_or(String::new(), |e| readable.words(e.at.0)),
                address: v.address.as_ref().map_or(String::new(), |a| a.text.to_string()),
                inverted: v.inverted,
                retain: v.retain,
                safe: v.safe.as_ref().map_or(String::new(), |e| readable.words(e.at.0)),
                comment: v.comment.as_deref().unwrap_or("").to_owned(),
                chart: chart.map(|c| c.name.text.to_string()),
                at,
                uses: counts.get(&*n.name.text).copied().unwrap_or(0).saturating_sub(1),
            }),
            Meaning::Step(c, s) => steps.push(Step {
                id: ids::step(&c.name.text, &s.name.text),
                name: s.name.text.to_string(),
                chart: c.name.text.to_string(),
                comment: s.comment.as_deref().unwrap_or("").to_owned(),
                initial: s.initial,
                at,
            }),
            Meaning::Chart(_)
            | Meaning::Type(_)
            | Meaning::Named(_)
            | Meaning::Value(_)
            | Meaning::Member(_)
            | Meaning::Other(..) => {}
        }
    }
    Tables { stale: readable.stale, variables, steps }
}

/// A type of one value, as the text writes it: `Mode`, `INT(0..100)`.
pub fn value_type(ty: &ValueType) -> String {
    match (&ty.of, ty.limits.as_deref()) {
        (Some(of), _) => of.text.to_string(),
        (None, Some(Limits::Range(least, most))) => {
            format!("{}({}..{})", ty.base, g7_syntax::print_expr(least), g7_syntax::print_expr(most))
        }
        (None, _) => ty.base.to_string(),
    }
}

/// The type of a declaration, with the bounds of an array.
pub fn declared_type(v: &VarDecl) -> String {
    let ty = value_type(&v.value_type());
    let Some(array) = &v.array else { return ty };
    let bounds: Vec<String> = array
        .dimensions
        .iter()
        .map(|(least, most)| format!("{}..{}", g7_syntax::print_expr(least), g7_syntax::print_expr(most)))
        .collect();
    format!("ARRAY[{}] OF {}", bounds.join(", "), ty)
}

/// A declaration on one line, as it would stand in the text.
pub fn declaration(name: &str, v: &VarDecl) -> String {
    declaration_after(&format!("{} ", class(v.kind)), name, v)
}

fn declaration_after(word: &str, name: &str, v: &VarDecl) -> String {
    let mut line = format!("{word}{name} : {}", declared_type(v));
    if v.init.is_some() && (v.ty != Type::Bool || v.of.is_some()) {
        line.push_str(" := …");
    }
    if let Some(a) = &v.address {
        line.push_str(&format!(" at {}", a.text));
    }
    if v.retain {
        line.push_str(" retain");
    }
    line
}

/// The declaration of a type on one line: `type Percent : INT(0..100)`.
pub fn type_declaration(t: &VarDecl) -> String {
    let item = Item::Type(VarDecl { comment: None, ..t.clone() });
    g7_syntax::print(&Document { items: vec![item], notes: Vec::new() }, None).trim_end().to_owned()
}

/// The declaration of a member on one line.
pub fn member_declaration(member: &Member<'_>) -> String {
    let name = &*member.name.text;
    match member.declared {
        // The members of a structure are declared without a word.
        Declared::Var(v) if !member.of.block => declaration_after("", name, v),
        Declared::Var(v) => declaration(name, v),
        Declared::InOut(v) => declaration_after("inout ", name, v),
        Declared::Local(l) => format!("var {name} : {}", value_type(&l.ty)),
    }
}
