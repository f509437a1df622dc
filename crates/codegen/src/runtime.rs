//! The runtime of printed charts (`crates/runtime`), as the build read it, and what of
//! it a chart needs.
//!
//! # Invariants
//!
//! - Nothing is parsed here. The build ends where the runtime names a fact, a table or a
//!   function that is not there; what a chart calls by a name is looked up in [`helpers`],
//!   which tells what it does not find.

use std::collections::{BTreeSet, HashSet};

use crate::tree::{self, Bin, Expr, Stmt, Ty, Un};

/// A type, with the lengths of arrays as facts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Type {
    Bool,
    Int {
        signed: bool,
        bits: u8,
    },
    Size,
    /// A number of a step, a transition, an action.
    Row,
    /// A time as the clock gives it.
    Tick,
    Named(&'static str),
    Array(&'static Type, fn(&Facts) -> usize),
    Ref(bool, &'static Type),
    Slice(bool, &'static Type),
}

/// An expression.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Term {
    Int(i128, Option<Type>),
    Bool(bool),
    Truth(fn(&Facts) -> bool),
    Size(fn(&Facts) -> usize),
    Name(&'static str),
    Field(&'static Term, &'static str),
    Index(&'static Term, &'static Term),
    Call(&'static str, &'static [Term]),
    Not(&'static Term),
    Neg(&'static Term),
    Bin(Bin, &'static Term, &'static Term),
    Cast(&'static Term, Type),
    Ref(bool, &'static Term),
    Deref(&'static Term),
}

/// A statement.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Line {
    Let { mutable: bool, name: &'static str, ty: Type, value: Term },
    Assign(Option<Bin>, Term, Term),
    If(Term, &'static [Line], &'static [Line]),
    While(Term, &'static [Line]),
    For(&'static str, Term, Term, &'static [Line]),
    Return(Option<Term>),
    Do(Term),
    Note(&'static str),
}

/// A function.
#[derive(Debug)]
pub(crate) struct Function {
    public: bool,
    note: &'static str,
    name: &'static str,
    parameters: &'static [(&'static str, Type)],
    result: Option<Type>,
    body: &'static [Line],
}

/// A structure's field.
#[derive(Debug)]
pub(crate) struct Field {
    name: &'static str,
    ty: Type,
    note: &'static str,
}

/// A structure.
#[derive(Debug)]
pub(crate) struct Struct {
    note: &'static str,
    name: &'static str,
    fields: &'static [Field],
}

/// A helper of printed code as it stands in its file.
#[derive(Debug)]
pub(crate) struct Helper {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
    /// True if C has it from `<math.h>`.
    pub(crate) math: bool,
    /// Places of those that it needs.
    needs: &'static [usize],
}

include!(concat!(env!("OUT_DIR"), "/runtime.rs"));

/// The helpers of Rust.
pub(crate) fn rust_helpers() -> &'static [Helper] {
    RUST
}

/// The helpers of C.
pub(crate) fn c_helpers() -> &'static [Helper] {
    C
}

/// Helpers with what they need, each once.
#[derive(Debug)]
pub(crate) struct Helpers {
    pub(crate) text: String,
    pub(crate) math: bool,
}

/// The helpers of a language that are called.
///
/// # Errors
///
/// The name of one that is not there.
pub(crate) fn helpers(all: &'static [Helper], called: &BTreeSet<String>) -> Result<Helpers, String> {
    let mut done = BTreeSet::new();
    let mut found = Helpers { text: String::new(), math: false };
    for name in called.iter().filter(|n| !tree::is_operator(n)) {
        let Some(at) = all.iter().position(|h| h.name == name) else { return Err(name.clone()) };
        let needs = all.get(at).map_or(&[] as &[usize], |h| h.needs);
        for k in needs.iter().chain([&at]) {
            if let Some(h) = all.get(*k).filter(|_| done.insert(*k)) {
                found.text += h.text;
                found.text += "\n\n";
                found.math |= h.math;
            }
        }
    }
    Ok(found)
}

/// The structures and functions of the runtime that a chart with these facts has.
pub(crate) fn of(facts: &Facts) -> (Vec<tree::Struct>, Vec<tree::Function>) {
    (STRUCTS.iter().map(|s| s.with(facts)).collect(), FUNCTIONS.iter().map(|f| f.with(facts)).collect())
}

/// The names of the functions of the runtime, in both styles.
pub(crate) fn names() -> HashSet<&'static str> {
    FUNCTIONS.iter().chain(FLAT_FUNCTIONS).map(|f| f.name).collect()
}

/// Those of a chart that is printed as equations.
pub(crate) fn flat(facts: &Facts) -> (Vec<tree::Struct>, Vec<tree::Function>) {
    let structs = FLAT_STRUCTS.iter().map(|s| s.with(facts)).collect();
    (structs, FLAT_FUNCTIONS.iter().map(|f| f.with(facts)).collect())
}

impl Type {
    fn with(self, facts: &Facts) -> Ty {
        match self {
            Type::Bool => Ty::Bool,
            Type::Int { signed, bits } => Ty::Int { signed, bits },
            Type::Size => Ty::Size,
            Type::Row => Ty::Int { signed: false, bits: facts.row_bits },
            Type::Tick if facts.tick_bits == 32 => Ty::Int { signed: false, bits: 32 },
            Type::Tick => Ty::I64,
            Type::Named(name) => Ty::Named(name.to_owned()),
            Type::Array(of, length) => Ty::Array(Box::new(of.with(facts)), length(facts)),
            Type::Ref(mutable, of) => Ty::Ref(mutable, Box::new(of.with(facts))),
            Type::Slice(mutable, of) => Ty::Slice(mutable, Box::new(of.with(facts))),
        }
    }
}

impl Struct {
    fn with(&self, facts: &Facts) -> tree::Struct {
        let field = |f: &Field| tree::Field {
            name: f.name.to_owned(),
            ty: f.ty.with(facts),
            note: f.note.to_owned(),
            kept: false,
        };
        tree::Struct {
            public: true,
            note: self.note.to_owned(),
            name: self.name.to_owned(),
            fields: self.fields.iter().map(field).collect(),
        }
    }
}

impl Function {
    fn with(&self, facts: &Facts) -> tree::Function {
        tree::Function {
            public: self.public,
            note: self.note.to_owned(),
            name: self.name.to_owned(),
            parameters: self.parameters.iter().map(|(n, t)| ((*n).to_owned(), t.with(facts))).collect(),
            result: self.result.map(|t| t.with(facts)),
            body: block(self.body, facts),
        }
    }
}

/// The statements that are reached with these facts.
fn block(lines: &[Line], facts: &Facts) -> tree::Block {
    let mut all = tree::Block::new();
    for line in lines {
        line.with(facts, &mut all);
    }
    if let Some(at) = all.iter().position(|s| matches!(s, Stmt::Return(_))) {
        all.truncate(at + 1);
    }
    all
}

impl Line {
    fn with(&self, facts: &Facts, all: &mut tree::Block) {
        match *self {
            Line::Let { mutable, name, ty, value } => all.push(Stmt::Let {
                mutable,
                name: name.to_owned(),
                ty: ty.with(facts),
                value: value.with(facts),
            }),
            Line::Assign(op, to, value) => {
                all.push(Stmt::Assign(op, to.with(facts), value.with(facts)));
            }
            Line::If(c, then, other) => match c.with(facts) {
                Expr::Bool(true) => all.extend(block(then, facts)),
                Expr::Bool(false) => all.extend(block(other, facts)),
                c => all.push(Stmt::If(c, block(then, facts), block(other, facts))),
            },
            Line::While(c, body) => match c.with(facts) {
                Expr::Bool(false) => {}
                c => all.push(Stmt::While(c, block(body, facts))),
            },
            Line::For(name, from, to, body) => {
                let (from, to) = (from.with(facts), to.with(facts));
                if from != to {
                    all.push(Stmt::For(name.to_owned(), from, to, block(body, facts)));
                }
            }
            Line::Return(value) => all.push(Stmt::Return(value.map(|v| v.with(facts)))),
            Line::Do(call) => all.push(Stmt::Do(call.with(facts))),
            Line::Note(text) => all.push(Stmt::Note(text.to_owned())),
        }
    }
}

impl Term {
    fn with(&self, facts: &Facts) -> Expr {
        let one = |t: &Term| Box::new(t.with(facts));
        match *self {
            Term::Int(n, ty) => Expr::Int(n, ty.map(|t| t.with(facts))),
            Term::Bool(b) => Expr::Bool(b),
            Term::Truth(fact) => Expr::Bool(fact(facts)),
            Term::Size(fact) => Expr::size(fact(facts)),
            Term::Name(name) => Expr::name(name),
            Term::Field(of, name) => of.with(facts).field(name),
            Term::Index(of, i) => of.with(facts).at(i.with(facts)),
            Term::Call(f, args) => Expr::call(f, args.iter().map(|a| a.with(facts)).collect()),
            Term::Not(e) => e.with(facts).not(),
            Term::Neg(e) => Expr::Un(Un::Neg, one(e)),
            Term::Bin(op, a, b) => known(op, a.with(facts), b.with(facts)),
            Term::Cast(e, ty) => e.with(facts).cast(ty.with(facts)),
            Term::Ref(mutable, e) => Expr::Ref(mutable, one(e)),
            Term::Deref(e) => Expr::Deref(one(e)),
        }
    }
}

/// Leaves out what is known beforehand.
fn known(op: Bin, left: Expr, right: Expr) -> Expr {
    match (op, &left, &right) {
        (Bin::And, Expr::Bool(true), _) | (Bin::Or, Expr::Bool(false), _) => right,
        (Bin::And, _, Expr::Bool(true)) | (Bin::Or, _, Expr::Bool(false)) => left,
        (Bin::And, Expr::Bool(false), _) | (Bin::And, _, Expr::Bool(false)) => Expr::Bool(false),
        (Bin::Or, Expr::Bool(true), _) | (Bin::Or, _, Expr::Bool(true)) => Expr::Bool(true),
        _ => left.bin(op, right),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_there(all: &'static [Helper], name: &str) -> bool {
        helpers(all, &BTreeSet::from([name.to_owned()])).is_ok()
    }

    /// The names that `operations.rs` puts together from an operation and a type.
    #[test]
    fn every_operation_has_its_helper_for_every_type() {
        let signed = ["i8", "i16", "i32", "i64"];
        let unsigned = ["u8", "u16", "u32", "u64"];
        let reals = ["f32", "f64"];
        let of = |operations: &[&str], types: &[&str]| -> Vec<String> {
            operations.iter().flat_map(|o| types.iter().map(move |t| format!("{o}_{t}"))).collect()
        };
        let whole = [signed, unsigned].concat();
        let mut names = of(
            &["add", "sub", "mul", "div", "rem", "neg", "min", "max", "round", "trunc", "text_to"],
            &whole,
        );
        names.extend(of(&["abs"], &signed));
        names.extend(of(&["shl", "shr", "rol", "ror"], &unsigned));
        names.extend(of(&["div", "rem", "pow", "min", "max"], &reals));
        names.extend(whole.iter().filter(|t| **t != "i64").map(|t| format!("{t}_from_i64")));
        names.extend(whole.iter().filter(|t| **t != "u64").map(|t| format!("{t}_from_u64")));
        let functions = ["abs", "sqrt", "ln", "log", "exp", "sin", "cos", "tan", "asin", "acos", "atan"];
        names.extend(functions.iter().map(|f| format!("real_{f}")));
        let texts = [
            "len",
            "left",
            "right",
            "mid",
            "concat",
            "insert",
            "delete",
            "replace",
            "find",
            "copy",
            "compare",
            "to_bool",
            "from_bool",
            "from_time",
            "from_i64",
            "from_u64",
        ];
        names.extend(texts.iter().map(|f| format!("text_{f}")));
        for name in &names {
            assert!(is_there(RUST, name), "`{name}` in Rust");
            assert!(is_there(C, name), "`{name}` in C");
        }
        for name in of(&["text_to", "text_from"], &reals) {
            assert!(is_there(RUST, &name), "`{name}` in Rust, which alone turns reals into text");
        }
        assert_eq!(helpers(RUST, &BTreeSet::from(["no_such".to_owned()])).err().as_deref(), Some("no_such"));
    }

    #[test]
    fn a_helper_brings_what_it_needs_before_it() {
        let found = helpers(C, &BTreeSet::from(["text_left".to_owned()])).expect("it is there");
        let at = |name: &str| found.text.find(&format!(" {name}(")).unwrap_or_else(|| panic!("no {name}"));
        assert!(at("text_size") < at("text_append") && at("text_append") < at("text_left"));
        assert!(!found.math);
        assert!(helpers(C, &BTreeSet::from(["real_sin".to_owned()])).is_ok_and(|f| f.math));
    }
}
