//! Names of the document as identifiers of IEC 61131-3, and what paths name.

use std::collections::{HashMap, HashSet};

use g7_model::BinaryOp;
use g7_model::codes;
use g7_model::{
    Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Item, Literal, Name, Path, Problem, Type, UnaryOp,
    VarDecl,
};

/// Words that are no identifiers in IEC 61131-3.
const KEYWORDS: [&str; 62] = [
    "ACTION",
    "AND",
    "ARRAY",
    "AT",
    "BOOL",
    "BY",
    "BYTE",
    "CASE",
    "CONFIGURATION",
    "CONSTANT",
    "DATE",
    "DINT",
    "DO",
    "DWORD",
    "ELSE",
    "ELSIF",
    "END",
    "EXIT",
    "FALSE",
    "FOR",
    "FROM",
    "FUNCTION",
    "FUNCTION_BLOCK",
    "IF",
    "INITIAL_STEP",
    "INT",
    "LINT",
    "LREAL",
    "LWORD",
    "MOD",
    "NOT",
    "OF",
    "ON",
    "OR",
    "PROGRAM",
    "REAL",
    "REPEAT",
    "RESOURCE",
    "RETAIN",
    "RETURN",
    "SINT",
    "STEP",
    "STRING",
    "STRUCT",
    "TASK",
    "THEN",
    "TIME",
    "TO",
    "TOD",
    "TRANSITION",
    "TRUE",
    "TYPE",
    "UDINT",
    "UINT",
    "ULINT",
    "UNTIL",
    "USINT",
    "VAR",
    "WHILE",
    "WITH",
    "WORD",
    "XOR",
];

/// Identifiers given so far.
#[derive(Default)]
pub(super) struct Names {
    given: HashMap<String, String>,
    taken: HashSet<String>,
    pub(super) renamed: Vec<Problem>,
}

/// What is visible where code stands.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    pub(super) document: &'a Document,
    /// The chart that becomes the program, with the expansions in it.
    pub(super) chart: Option<&'a Chart>,
    /// The function whose body it is.
    pub(super) function: Option<&'a g7_model::Function>,
}

impl Names {
    /// The identifier of a name; one that is none gets another, which is said once.
    pub(super) fn give(&mut self, name: &Name) -> String {
        if let Some(known) = self.given.get(&*name.text) {
            return known.clone();
        }
        let mut wanted: String =
            name.text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' }).collect();
        if wanted.starts_with(|c: char| c.is_ascii_digit()) {
            wanted.insert(0, 'S');
        }
        if wanted.is_empty() || KEYWORDS.contains(&wanted.to_ascii_uppercase().as_str()) {
            wanted.push('_');
        }
        let mut given = wanted.clone();
        let mut number = 2;
        while !self.taken.insert(given.to_uppercase()) {
            given = format!("{wanted}_{number}");
            number += 1;
        }
        if *given != *name.text {
            let what =
                format!("`{}` is no identifier of its own in IEC 61131-3; it is called `{given}`", name.text);
            self.renamed.push(Problem::new(&codes::RENAMED, name.at.0, what));
        }
        self.given.insert(name.text.to_string(), given.clone());
        given
    }

    /// A path in the words of IEC 61131-3, or why it has none.
    pub(super) fn path(&mut self, scope: &Scope, path: &Path) -> Result<String, String> {
        let Some(first) = path.names.first() else { return Ok(String::new()) };
        let rest = path.names.get(1..).unwrap_or(&[]);
        if scope.local(&first.text) || scope.variable(&first.text).is_some() {
            let mut text = self.give(first);
            for member in rest {
                text.push('.');
                text.push_str(&member.text);
            }
            return Ok(text);
        }
        if let Some(step) = self.step_of(scope, path) {
            return Ok(format!("{step}.X"));
        }
        // `step.X`, `step.t`.
        if let [.., step, member] = path.names.as_slice()
            && let Some(known) = scope.step(step_name(scope, &step.text))
        {
            let own = path.names.len() == 2 || (path.names.len() == 3 && scope.is_own(&first.text));
            let name = self.give(&known);
            match (own, &*member.text) {
                (true, "X" | "x") => return Ok(format!("{name}.X")),
                (true, "t" | "T") => return Ok(format!("{name}.T")),
                _ => {}
            }
        }
        if scope.is_own(&first.text) && !rest.is_empty() {
            return self.path(scope, &Path { names: rest.to_vec() });
        }
        if rest.is_empty() {
            return Ok(first.text.to_string());
        }
        Err(format!("`{}` of another chart: a program sees only its own", path.text()))
    }

    /// The step whose activity a path is (`X12`, `Fill.X`), by its identifier.
    pub(super) fn step_of(&mut self, scope: &Scope, path: &Path) -> Option<String> {
        let (name, own) = match path.names.as_slice() {
            [one] => (step_name(scope, &one.text), one.text.starts_with('X')),
            [step, x] if x.text.eq_ignore_ascii_case("x") => (step_name(scope, &step.text), true),
            [chart, one] if scope.is_own(&chart.text) => {
                (step_name(scope, &one.text), one.text.starts_with('X'))
            }
            _ => return None,
        };
        if !own || path.names.len() == 1 && scope.variable(&path.names.first()?.text).is_some() {
            return None;
        }
        let step = scope.step(name)?;
        Some(self.give(&step))
    }
}

/// `X12` names step 12, unless a step is called `X12` itself.
fn step_name<'n>(scope: &Scope, name: &'n str) -> &'n str {
    match name.strip_prefix('X') {
        Some(rest) if scope.step(name).is_none() && !rest.is_empty() => rest,
        _ => name,
    }
}

impl<'a> Scope<'a> {
    fn local(&self, name: &str) -> bool {
        self.function.is_some_and(|f| {
            let locals = f.body.locals.iter().flat_map(|l| &l.names);
            *f.name.text == *name || f.params.iter().map(|p| &p.name).chain(locals).any(|n| *n.text == *name)
        })
    }

    /// A variable of the chart or the file.
    fn variable(&self, name: &str) -> Option<&'a VarDecl> {
        let of_file =
            self.document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
        let of_chart = self.chart.into_iter().flat_map(Chart::vars);
        of_chart.chain(of_file).find(|v| v.names.iter().any(|n| *n.text == *name))
    }

    /// The chart of the program and the expansions, which become parts of it.
    fn charts(&self) -> impl Iterator<Item = &'a Chart> {
        let expansions = self.document.charts().filter(|c| c.kind == ChartKind::Expansion);
        self.chart.into_iter().chain(expansions)
    }

    fn step(&self, name: &str) -> Option<Name> {
        self.charts().flat_map(Chart::steps).map(|s| &s.name).find(|n| *n.text == *name).cloned()
    }

    fn is_own(&self, chart: &str) -> bool {
        self.charts().any(|c| *c.name.text == *chart)
    }

    /// Whether an expression is Boolean, as far as it shows.
    pub(super) fn is_bool(&self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Literal(Literal::Bool(_)) | ExprKind::Timer { .. } => true,
            ExprKind::Unary(op, _) => *op != UnaryOp::Neg,
            ExprKind::Binary(op, a, b) => match op {
                BinaryOp::Add | BinaryOp::Mul => self.is_bool(a) || self.is_bool(b),
                BinaryOp::Sub | BinaryOp::Div | BinaryOp::Mod | BinaryOp::Pow => false,
                _ => true,
            },
            ExprKind::Path(path) => match path.names.as_slice() {
                [one] => match self.variable(&one.text) {
                    Some(decl) => decl.ty == Type::Bool,
                    None => one.text.starts_with('X') && self.step(step_name(self, &one.text)).is_some(),
                },
                [.., last] => matches!(&*last.text, "X" | "x" | "Q" | "Q1" | "QU" | "QD"),
                [] => false,
            },
            _ => false,
        }
    }
}

/// The sections of a chart by their names.
pub(super) fn is_section(chart: &Chart, document: &Document, expr: &Expr) -> Option<g7_model::Section> {
    let ExprKind::Path(path) = &expr.kind else { return None };
    let [name] = path.names.as_slice() else { return None };
    let of_chart =
        chart.items.iter().filter_map(|i| if let ChartItem::Section(s) = i { Some(s) } else { None });
    let of_file = document.items.iter().filter_map(|i| if let Item::Section(s) = i { Some(s) } else { None });
    of_chart.chain(of_file).find(|s| *s.name.text == *name.text).cloned()
}
