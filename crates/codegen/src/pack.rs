//! Truth values as bits, for code that takes little memory: between the tree of a chart in the
//! structured style and `prune`.
//!
//! # Invariants
//!
//! - What the code does stays the same.

use std::collections::HashMap;

use crate::tree::{Block, Expr, Field, Module, Stmt, Ty};

/// Words for so many bits.
fn words(bits: usize) -> Ty {
    Ty::Array(Box::new(Ty::Int { signed: false, bits: 32 }), bits.div_ceil(32))
}

/// Packs the truth values of the memory and the state, a bit each. The steps are those of
/// `active`, which says the same.
pub(crate) fn pack(m: &mut Module) {
    let mut packed: HashMap<String, String> = HashMap::new();
    for s in m.structs.iter_mut().filter(|s| s.name == "Memory" || s.name == "State") {
        for Field { name, ty, .. } in &mut s.fields {
            let Ty::Array(of, n) = ty else { continue };
            if **of == Ty::Bool && *n > 0 {
                let to = if name == "x" { "active" } else { name.as_str() };
                packed.insert(name.clone(), to.to_owned());
                *ty = words(*n);
            }
        }
        s.fields.retain(|f| f.name != "x");
    }
    for f in &mut m.functions {
        block(&mut f.body, &packed);
    }
}

/// If an expression is a packed truth value: the array of words that has it, the index of its bit, and true if it is
/// the activity of a step.
fn bit_of(e: &Expr, packed: &HashMap<String, String>) -> Option<(Expr, Expr, bool)> {
    let Expr::Index(of, i) = e else { return None };
    let Expr::Field(home, name) = &**of else { return None };
    let known = match &**home {
        Expr::Name(s) => s == "s",
        Expr::Field(s, m) => **s == Expr::name("s") && m == "m",
        _ => false,
    };
    let to = packed.get(name).filter(|_| known)?;
    Some((home.as_ref().clone().field(to.as_str()), i.as_ref().clone(), name == "x"))
}

fn block(body: &mut Block, packed: &HashMap<String, String>) {
    let mut all = Block::new();
    for s in std::mem::take(body) {
        statement(s, packed, &mut all);
    }
    *body = all;
}

fn statement(mut s: Stmt, packed: &HashMap<String, String>, all: &mut Block) {
    match &mut s {
        Stmt::Assign(None, to, value) => {
            expression(value, packed);
            if let Some((words, mut i, is_step)) = bit_of(to, packed) {
                expression(&mut i, packed);
                let change = |f: &str| Stmt::Do(Expr::call(f, vec![words.clone().passed(), i.clone()]));
                match value {
                    // The set of active steps is written beside it.
                    _ if is_step => {}
                    Expr::Bool(true) => all.push(change("bit_set")),
                    Expr::Bool(false) => all.push(change("bit_clear")),
                    value => {
                        all.push(Stmt::If(value.clone(), vec![change("bit_set")], vec![change("bit_clear")]));
                    }
                }
                return;
            }
            expression(to, packed);
        }
        Stmt::Assign(_, to, value) => {
            expression(to, packed);
            expression(value, packed);
        }
        Stmt::Let { value, .. } => expression(value, packed),
        Stmt::If(c, a, b) => {
            expression(c, packed);
            block(a, packed);
            block(b, packed);
        }
        Stmt::While(c, body) => {
            expression(c, packed);
            block(body, packed);
        }
        Stmt::For(_, from, to, body) => {
            expression(from, packed);
            expression(to, packed);
            block(body, packed);
        }
        Stmt::Match(e, arms) => {
            expression(e, packed);
            for arm in arms {
                block(&mut arm.body, packed);
            }
        }
        Stmt::Return(Some(e)) | Stmt::Do(e) | Stmt::Clear(e, _) => expression(e, packed),
        Stmt::Return(None) | Stmt::Break | Stmt::Note(_) => {}
    }
    all.push(s);
}

fn expression(e: &mut Expr, packed: &HashMap<String, String>) {
    if let Some((words, mut i, _)) = bit_of(e, packed) {
        expression(&mut i, packed);
        *e = Expr::call("bit", vec![Expr::Ref(false, Box::new(words)), i]);
        return;
    }
    match e {
        Expr::Field(of, name) => {
            let is_memory = matches!(&**of, Expr::Field(s, m) if **s == Expr::name("s") && m == "m");
            if is_memory && name == "x" && packed.contains_key("x") {
                "active".clone_into(name);
            }
            expression(of, packed);
        }
        Expr::Un(_, a) | Expr::Cast(a, _) | Expr::Ref(_, a) | Expr::Deref(a) => expression(a, packed),
        Expr::Index(a, b) | Expr::Bin(_, a, b) => {
            expression(a, packed);
            expression(b, packed);
        }
        Expr::Call(_, args) => args.iter_mut().for_each(|a| expression(a, packed)),
        Expr::If(a, b, c) => {
            expression(a, packed);
            expression(b, packed);
            expression(c, packed);
        }
        Expr::Int(..) | Expr::Real(..) | Expr::Bool(_) | Expr::Name(_) => {}
    }
}
