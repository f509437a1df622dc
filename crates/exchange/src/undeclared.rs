//! Variables that are declared outside of the imported part of a program.
//!
//! Vendors export a chart without its surroundings. A variable that the chart uses and the file
//! does not declare becomes an input if it is only read, and an output if it is written. Its type
//! is BOOL, unless its use shows another one.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::codes;
use g7_model::{
    BinaryOp, ChartItem, Document, Expr, ExprKind, Item, Literal, Path, Said, Span, Stmt, StmtKind, Type,
    UnaryOp, VarDecl, VarKind, say,
};

use g7_iec::nodes;
use g7_iec::report::Report;
use g7_model::visit_mut::{self, Use, Visitor};

/// The most variables named in one message.
const MOST_NAMED: usize = 12;

/// A variable, as it is used.
#[derive(Debug)]
struct Named {
    text: String,
    at: Span,
    written: bool,
}

/// The names used in bodies, in upper case.
#[derive(Debug, Default)]
struct Names {
    all: BTreeMap<String, Named>,
    types: HashMap<String, Type>,
}

fn upper(path: &Path) -> String {
    path.text().to_uppercase()
}

impl Visitor for Names {
    fn path(&mut self, path: &mut Path, how: Use, at: Span) {
        let entry = self.all.entry(upper(path));
        let named = entry.or_insert_with(|| Named { text: path.text(), at, written: false });
        named.written |= how != Use::Read;
    }

    fn expr(&mut self, e: &mut Expr) {
        if let ExprKind::Binary(op, a, b) = &e.kind
            && !matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor | BinaryOp::Dot)
        {
            self.alike(a, b, *op);
            self.alike(b, a, *op);
        }
    }

    fn stmt(&mut self, s: &mut Stmt) {
        if let StmtKind::Assign { target, value } = &s.kind {
            self.alike(target, value, BinaryOp::Eq);
        }
    }
}

impl Names {
    /// Gives a name the type of the expression with which it is combined.
    fn alike(&mut self, e: &Expr, other: &Expr, op: BinaryOp) {
        let ExprKind::Path(path) = &e.kind else { return };
        let ty = type_of(other).or_else(|| {
            // `a = b` may compare Booleans; `a + b` without any known type is read as numbers.
            (!matches!(op, BinaryOp::Eq | BinaryOp::Ne)).then_some(Type::Dint)
        });
        if let Some(ty) = ty {
            self.types.entry(upper(path)).or_insert(ty);
        }
    }
}

/// The type of an expression, as far as its form tells it.
fn type_of(e: &Expr) -> Option<Type> {
    match &e.kind {
        ExprKind::Literal(Literal::Int(0 | 1, None)) => None,
        ExprKind::Literal(Literal::Int(_, ty)) => Some(ty.unwrap_or(Type::Dint)),
        ExprKind::Literal(Literal::Real(_, ty)) => Some(ty.unwrap_or(Type::Real)),
        ExprKind::Literal(Literal::Time(_)) => Some(Type::Time),
        ExprKind::Literal(Literal::Moment(moment, _)) => Some(Type::Moment(*moment)),
        ExprKind::Literal(Literal::Str(_)) => Some(Type::STRING),
        ExprKind::Unary(UnaryOp::Neg, a) => type_of(a).or(Some(Type::Dint)),
        ExprKind::Binary(
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Mod,
            a,
            b,
        ) => type_of(a).or_else(|| type_of(b)).or(Some(Type::Dint)),
        _ => None,
    }
}

/// The declarations of a document, in upper case.
#[derive(Default)]
struct Declared {
    names: HashSet<String>,
    blocks: HashSet<String>,
    steps: HashSet<String>,
}

fn declared(document: &Document) -> Declared {
    let mut d = Declared::default();
    let var = |v: &VarDecl, d: &mut Declared| {
        for name in &v.names {
            let set = if matches!(v.ty, Type::Fb(_)) { &mut d.blocks } else { &mut d.names };
            set.insert(name.text.to_uppercase());
        }
    };
    for item in &document.items {
        match item {
            Item::Var(v) => var(v, &mut d),
            Item::Action(a) => drop(d.names.insert(a.name.text.to_uppercase())),
            Item::Section(s) => drop(d.names.insert(s.name.text.to_uppercase())),
            Item::Function(f) => drop(d.names.insert(f.name.text.to_uppercase())),
            Item::Chart(c) => {
                for item in &c.items {
                    match item {
                        ChartItem::Var(v) => var(v, &mut d),
                        ChartItem::Action(a) => drop(d.names.insert(a.name.text.to_uppercase())),
                        ChartItem::Section(s) => drop(d.names.insert(s.name.text.to_uppercase())),
                        ChartItem::Step(s) => drop(d.steps.insert(s.name.text.to_uppercase())),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    d
}

impl Declared {
    /// True if a name in a text is declared.
    fn has(&self, name: &str) -> bool {
        if self.names.contains(name) || self.blocks.contains(name) {
            return true;
        }
        let Some((before, member)) = name.rsplit_once('.') else { return is_activity(name, &self.steps) };
        let step = before.rsplit('.').next().unwrap_or(before);
        self.blocks.contains(before)
            || (matches!(member, "X" | "T") && (self.steps.contains(step) || is_activity(step, &self.steps)))
    }
}

/// True for `X12` if there is a step 12.
fn is_activity(name: &str, steps: &HashSet<String>) -> bool {
    name.strip_prefix('X').is_some_and(|n| steps.contains(n))
}

/// Declares the undeclared variables in front of the first chart.
pub(crate) fn declare(document: &mut Document, report: &mut Report) {
    let mut names = Names::default();
    visit_mut::document(document, &mut names);
    let known = declared(document);
    let mut new = Vec::new();
    let mut told = Vec::new();
    for (key, named) in names.all.iter().filter(|(key, _)| !known.has(key)) {
        let kind = if named.written { VarKind::Output } else { VarKind::Input };
        let ty = names.types.get(key).copied().unwrap_or(Type::Bool);
        told.push((named.at, format!("`{}`", named.text)));
        new.push(nodes::variable(kind, &named.text, ty, named.at));
    }
    tell(&told, say!("nothing in the file declares"), say!("they are inputs and outputs here"), report);
    insert(document, new);
}

/// Turns variables without an address that nothing writes into inputs, because they are set from
/// outside.
pub(crate) fn open(document: &mut Document, report: &mut Report) {
    let mut names = Names::default();
    visit_mut::document(document, &mut names);
    let mut told = Vec::new();
    let mut own: Vec<&mut VarDecl> = Vec::new();
    for item in &mut document.items {
        match item {
            Item::Var(v) => own.push(v),
            Item::Chart(c) => own.extend(c.items.iter_mut().filter_map(|i| match i {
                ChartItem::Var(v) => Some(v),
                _ => None,
            })),
            _ => {}
        }
    }
    for v in own {
        let plain =
            v.kind == VarKind::Var && v.address.is_none() && v.init.is_none() && !matches!(v.ty, Type::Fb(_));
        let [name] = v.names.as_slice() else { continue };
        let found = names.all.get(&name.text.to_uppercase());
        if plain && found.is_some_and(|n| !n.written) {
            told.push((v.at.0, format!("`{}`", name.text)));
            v.kind = VarKind::Input;
        }
    }
    tell(&told, say!("nothing in the file writes"), say!("they are inputs here"), report);
}

/// Reports all of them in one message.
fn tell(list: &[(Span, String)], why: Said, then: Said, report: &mut Report) {
    let Some((at, _)) = list.first() else { return };
    let names: Vec<&str> = list.iter().take(MOST_NAMED).map(|(_, n)| n.as_str()).collect();
    let more = match list.len().saturating_sub(MOST_NAMED) {
        0 => Said::default(),
        n => say!(" and {n} more"),
    };
    let what = say!("{why} {}{more}; {then}", Said::foreign(names.join(", ")));
    report.put(g7_model::Problem::new(&codes::DIFFERENT, *at, what));
}

fn insert(document: &mut Document, new: Vec<VarDecl>) {
    let place =
        document.items.iter().position(|i| !matches!(i, Item::Profile(_) | Item::Cycle(..) | Item::Var(_)));
    let place = place.unwrap_or(document.items.len());
    document.items.splice(place..place, new.into_iter().map(Item::Var));
}
