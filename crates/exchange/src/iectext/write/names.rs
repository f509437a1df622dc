//! Names that the standard has a form for: letters, digits, single `_`, capitals not told apart.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

use g7_model::{Chart, ChartItem, Document, Item, Name, Span, Type, VarDecl};

/// Words of the language, its standard functions and blocks. Operators of Instruction List and
/// qualifiers are none: they mean something in their places only.
const RESERVED: &str = "ABS ACOS ACTION ADD AND ANY ANY_BIT ANY_DATE ANY_INT ANY_NUM ANY_REAL ARRAY ASIN AT ATAN BOOL BY \
BYTE CASE CONCAT CONFIGURATION CONSTANT COS CTD CTU CTUD DATE DATE_AND_TIME DELETE DINT DIV DO DT \
DWORD ELSE ELSIF END_ACTION END_CASE END_CONFIGURATION END_FOR END_FUNCTION END_FUNCTION_BLOCK \
END_IF END_PROGRAM END_REPEAT END_RESOURCE END_STEP END_STRUCT END_TRANSITION END_TYPE END_VAR \
END_WHILE EN ENO EQ EXIT EXP EXPT F_EDGE F_TRIG FALSE FIND FOR FROM FUNCTION FUNCTION_BLOCK GE GT IF \
INITIAL_STEP INSERT INT LE LEFT LEN LIMIT LINT LN LOG LREAL LT LWORD MAX MID MIN MOD MOVE MUL MUX NE \
NON_RETAIN NOT OF ON OR PROGRAM R_TRIG READ_ONLY READ_WRITE REAL REPEAT REPLACE RESOURCE RETAIN \
RETURN RIGHT ROL ROR RS SEL SHL SHR SIN SINT SQRT SR STEP STRING STRUCT SUB TAN TASK THEN TIME \
TIME_OF_DAY TO TOD TOF TON TP TRANSITION TRUE TRUNC TYPE UDINT UINT ULINT UNTIL USINT VAR VAR_ACCESS \
VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL VAR_IN_OUT VAR_INPUT VAR_OUTPUT VAR_TEMP WHILE WITH WORD WSTRING \
XOR";

/// A variable as it is written.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) text: String,
    pub(super) ty: Type,
}

/// Where a name is looked for: the file, or a chart by its place.
pub(super) type Scope = Option<usize>;

/// The written names of everything.
#[derive(Debug, Default)]
pub(super) struct Names {
    variables: HashMap<(Scope, Box<str>), Variable>,
    addresses: HashMap<String, String>,
    steps: HashMap<(usize, Box<str>), String>,
    actions: HashMap<(Scope, Box<str>), String>,
    functions: HashMap<Box<str>, Variable>,
    charts: HashMap<Box<str>, usize>,
    /// In capitals.
    taken: RefCell<HashSet<String>>,
    /// Names that had to be changed: where, and to what.
    pub(super) renamed: Vec<(Span, String, String)>,
}

/// Gives all names.
pub(super) fn give(document: &Document) -> Names {
    let mut names = Names {
        taken: RefCell::new(RESERVED.split_whitespace().map(str::to_string).collect()),
        ..Names::default()
    };
    for item in &document.items {
        match item {
            Item::Var(v) => names.variable(None, v, ""),
            Item::Action(a) => names.action(None, &a.name, ""),
            Item::Function(f) => {
                let text = names.unique(&f.name, "", "");
                names.functions.insert(f.name.text.clone(), Variable { text, ty: f.result });
            }
            _ => {}
        }
    }
    for (index, chart) in document.charts().enumerate() {
        names.chart(index, chart);
    }
    names
}

impl Names {
    fn chart(&mut self, index: usize, chart: &Chart) {
        self.charts.insert(chart.name.text.clone(), index);
        let prefix = format!("{}_", chart.name.text);
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => self.variable(Some(index), v, &prefix),
                ChartItem::Action(a) => self.action(Some(index), &a.name, &prefix),
                ChartItem::Step(s) => {
                    let digit = s.name.text.starts_with(|c: char| c.is_ascii_digit());
                    let text = self.unique(&s.name, &prefix, if digit { "Step" } else { "" });
                    self.steps.insert((index, s.name.text.clone()), text);
                }
                _ => {}
            }
        }
    }

    fn variable(&mut self, scope: Scope, decl: &VarDecl, prefix: &str) {
        for name in &decl.names {
            let text = self.unique(name, prefix, "");
            if let Some(address) = decl.address.as_ref().filter(|a| a.text.starts_with('%')) {
                self.addresses
                    .insert(address.text.trim_start_matches('%').to_ascii_uppercase(), text.clone());
            }
            self.variables.insert((scope, name.text.clone()), Variable { text, ty: decl.ty });
        }
    }

    fn action(&mut self, scope: Scope, name: &Name, prefix: &str) {
        let text = self.unique(name, prefix, "");
        self.actions.insert((scope, name.text.clone()), text);
    }

    /// A name that nothing else has, as near to the author's as it can be.
    fn unique(&mut self, name: &Name, prefix: &str, start: &str) -> String {
        let plain = identifier(&format!("{start}{}", name.text));
        let mut text = plain.clone();
        if self.taken.borrow().contains(&text.to_ascii_uppercase()) && !prefix.is_empty() {
            text = identifier(&format!("{prefix}{plain}"));
        }
        text = self.free(&text);
        if text != *name.text {
            self.renamed.push((name.at.0, name.text.to_string(), text.clone()));
        }
        text
    }

    /// A name made from another one that is not taken; it is taken now.
    pub(super) fn free(&self, wish: &str) -> String {
        let wish = identifier(wish);
        let mut text = wish.clone();
        let mut number = 1;
        while !self.taken.borrow_mut().insert(text.to_ascii_uppercase()) {
            number += 1;
            text = format!("{}_{number}", wish.trim_end_matches('_'));
        }
        text
    }

    pub(super) fn variable_of(&self, scope: Scope, name: &str) -> Option<&Variable> {
        let of = |scope: Scope| self.variables.get(&(scope, name.into()));
        scope.and_then(|c| of(Some(c))).or_else(|| of(None))
    }

    pub(super) fn in_chart(&self, chart: usize, name: &str) -> Option<&Variable> {
        self.variables.get(&(Some(chart), name.into()))
    }

    pub(super) fn at_address(&self, address: &str) -> Option<&str> {
        self.addresses.get(address).map(String::as_str)
    }

    pub(super) fn action_of(&self, scope: Scope, name: &str) -> Option<&str> {
        let of = |scope: Scope| self.actions.get(&(scope, name.into())).map(String::as_str);
        scope.and_then(|c| of(Some(c))).or_else(|| of(None))
    }

    pub(super) fn function(&self, name: &str) -> Option<&Variable> {
        self.functions.get(name)
    }

    pub(super) fn chart_named(&self, name: &str) -> Option<usize> {
        self.charts.get(name).copied()
    }

    pub(super) fn step_in(&self, chart: usize, name: &str) -> Option<&str> {
        self.steps.get(&(chart, name.into())).map(String::as_str)
    }

    /// A step by its name: of this chart, else the only one of the document.
    pub(super) fn step(&self, scope: Scope, name: &str) -> Option<&str> {
        if let Some(found) = scope.and_then(|c| self.step_in(c, name)) {
            return Some(found);
        }
        let mut found = (0..self.charts.len()).filter_map(|c| self.step_in(c, name));
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }
}

/// Letters, digits and single `_`, a letter or `_` first.
fn identifier(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match fold(c) {
            "" if c.is_ascii_alphanumeric() => out.push(c),
            "" if !out.ends_with('_') => out.push('_'),
            "" => {}
            folded => out.push_str(folded),
        }
    }
    let out = if out.len() > 1 { out.trim_end_matches('_').to_string() } else { out };
    match out.chars().next() {
        Some(c) if c.is_ascii_digit() => format!("N{out}"),
        Some('_') | None => format!("v{out}"),
        Some(_) => out,
    }
}

/// Letters of other alphabets that have a usual spelling in this one.
fn fold(c: char) -> &'static str {
    match c {
        'ä' | 'å' | 'á' | 'à' | 'â' => "a",
        'Ä' | 'Å' | 'Á' | 'À' => "A",
        'ö' | 'ó' | 'ô' | 'ø' => "o",
        'Ö' | 'Ø' => "O",
        'ü' | 'ú' | 'ù' | 'û' => "u",
        'Ü' => "U",
        'é' | 'è' | 'ê' | 'ë' => "e",
        'É' | 'È' => "E",
        'í' | 'ì' | 'î' | 'ï' => "i",
        'ç' => "c",
        'ñ' => "n",
        'ß' => "ss",
        'æ' => "ae",
        _ => "",
    }
}
