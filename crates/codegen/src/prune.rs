//! Leaves away what nothing uses, and puts structures behind those they hold.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::tree::{Expr, Function, Module, Stmt, Ty};

fn names_in_type(ty: &Ty, found: &mut HashSet<String>) {
    match ty {
        Ty::Named(n) => {
            found.insert(n.clone());
        }
        Ty::Array(of, _) | Ty::Ref(_, of) | Ty::Slice(_, of) => names_in_type(of, found),
        Ty::Bool | Ty::Int { .. } | Ty::Real { .. } | Ty::Size => {}
    }
}

fn types_in(body: &[Stmt], found: &mut HashSet<String>) {
    for s in body {
        match s {
            Stmt::Let { ty, .. } | Stmt::Clear(_, ty) => names_in_type(ty, found),
            Stmt::If(_, a, b) => {
                types_in(a, found);
                types_in(b, found);
            }
            Stmt::While(_, body) | Stmt::For(_, _, _, body) => types_in(body, found),
            Stmt::Match(_, arms) => arms.iter().for_each(|a| types_in(&a.body, found)),
            Stmt::Assign(..) | Stmt::Return(_) | Stmt::Break | Stmt::Do(_) | Stmt::Note(_) => {}
        }
    }
}

/// True if a function does nothing.
fn is_idle(f: &Function) -> bool {
    f.result.is_none()
        && f.body.iter().all(|s| match s {
            Stmt::Match(_, arms) => arms.is_empty(),
            Stmt::Note(_) => true,
            _ => false,
        })
}

/// Takes out calls of functions that do nothing, and `x := x`.
fn without_idle(body: &mut Vec<Stmt>, idle: &HashSet<String>) {
    body.retain(|s| match s {
        Stmt::Do(Expr::Call(f, _)) => !idle.contains(f),
        Stmt::Assign(None, to, value) => to != value,
        _ => true,
    });
    for s in body {
        match s {
            Stmt::If(_, a, b) => {
                without_idle(a, idle);
                without_idle(b, idle);
            }
            Stmt::While(_, body) | Stmt::For(_, _, _, body) => without_idle(body, idle),
            Stmt::Match(_, arms) => arms.iter_mut().for_each(|a| without_idle(&mut a.body, idle)),
            _ => {}
        }
    }
}

/// Leaves in a module only the items that its public functions reach.
/// Tells the functions that are called and not there: those of the language's own part.
pub(crate) fn prune(m: &mut Module) -> BTreeSet<String> {
    loop {
        let idle: HashSet<String> =
            m.functions.iter().filter(|f| !f.public && is_idle(f)).map(|f| f.name.clone()).collect();
        m.functions.retain(|f| f.public || !idle.contains(&f.name));
        for f in &mut m.functions {
            without_idle(&mut f.body, &idle);
        }
        if idle.is_empty() {
            break;
        }
    }
    // Comparisons are made of the fields that are left.
    let (functions, _, fields, _) = reach(m);
    m.functions.retain(|f| functions.contains(&f.name));
    keep_fields(m, &fields);
    crate::frame::comparisons(m);
    let (functions, names, fields, helpers) = reach(m);
    m.functions.retain(|f| functions.contains(&f.name));
    m.consts.retain(|c| names.contains(&c.name));
    for n in m.numbers.iter_mut().filter(|n| !n.public) {
        n.rows.retain(|r| names.contains(&r.0));
    }
    keep_fields(m, &fields);
    // Structures that are held or passed.
    let mut used = HashSet::new();
    for f in &m.functions {
        f.parameters.iter().for_each(|(_, t)| names_in_type(t, &mut used));
        types_in(&f.body, &mut used);
    }
    let mut size = 0;
    while used.len() != size {
        size = used.len();
        for s in &m.structs {
            if used.contains(&s.name) {
                s.fields.iter().for_each(|f| names_in_type(&f.ty, &mut used));
            }
        }
    }
    m.structs.retain(|s| used.contains(&s.name));
    order(m);
    helpers
}

/// A name in capitals, of a table or a number, that is used and not there.
pub(crate) fn missing(m: &Module) -> Option<String> {
    let rows = m.numbers.iter().flat_map(|n| n.rows.iter().map(|r| r.0.as_str()));
    let there: HashSet<&str> = rows.chain(m.consts.iter().map(|c| c.name.as_str())).collect();
    let (_, names, _, _) = reach(m);
    let capital = |n: &&String| !n.contains(|c: char| c.is_lowercase());
    names.iter().filter(capital).find(|n| !there.contains(n.as_str())).cloned()
}

fn keep_fields(m: &mut Module, fields: &HashSet<String>) {
    for s in m.structs.iter_mut().filter(|s| s.name == "State" || s.name == "Memory") {
        s.fields.retain(|f| f.kept || fields.contains(&f.name));
    }
}

/// Functions, names, fields that are reached; functions that are not there.
fn reach(m: &Module) -> (HashSet<String>, HashSet<String>, HashSet<String>, BTreeSet<String>) {
    let by_name: HashMap<&str, &Function> = m.functions.iter().map(|f| (f.name.as_str(), f)).collect();
    let (mut functions, mut names, mut fields) = (HashSet::new(), HashSet::new(), HashSet::new());
    let mut helpers = BTreeSet::new();
    let mut waiting: Vec<&Function> = m.functions.iter().filter(|f| f.public).collect();
    functions.extend(waiting.iter().map(|f| f.name.clone()));
    while let Some(f) = waiting.pop() {
        for s in &f.body {
            s.walk(&mut |e| match e {
                Expr::Name(n) => {
                    names.insert(n.clone());
                }
                Expr::Field(_, n) => {
                    fields.insert(n.clone());
                }
                Expr::Call(f, _) => match by_name.get(f.as_str()) {
                    Some(f) => {
                        if functions.insert(f.name.clone()) {
                            waiting.push(f);
                        }
                    }
                    None => {
                        helpers.insert(f.clone());
                    }
                },
                _ => {}
            });
        }
    }
    for c in &m.consts {
        if names.contains(&c.name) {
            c.value.walk(&mut |e| {
                if let Expr::Name(n) = e {
                    names.insert(n.clone());
                }
            });
        }
    }
    (functions, names, fields, helpers)
}

/// Structures behind those that they hold.
fn order(m: &mut Module) {
    let mut left = std::mem::take(&mut m.structs);
    while !left.is_empty() {
        let there: HashSet<String> = m.structs.iter().map(|s| s.name.clone()).collect();
        let names: HashSet<String> = left.iter().map(|s| s.name.clone()).collect();
        let ready = left.iter().position(|s| {
            let mut needs = HashSet::new();
            s.fields.iter().for_each(|f| names_in_type(&f.ty, &mut needs));
            needs.iter().all(|n| there.contains(n) || !names.contains(n))
        });
        m.structs.push(left.remove(ready.unwrap_or(0)));
    }
}
