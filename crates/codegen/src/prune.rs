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

/// Every statement, those within others included.
fn each_statement<'a>(body: &'a [Stmt], f: &mut dyn FnMut(&'a Stmt)) {
    for s in body {
        f(s);
        match s {
            Stmt::If(_, a, b) => {
                each_statement(a, f);
                each_statement(b, f);
            }
            Stmt::While(_, body) | Stmt::For(_, _, _, body) => each_statement(body, f),
            Stmt::Match(_, arms) => arms.iter().for_each(|a| each_statement(&a.body, f)),
            _ => {}
        }
    }
}

/// The field of the state that a statement writes and does nothing else.
fn written(s: &Stmt) -> Option<&str> {
    let Stmt::Assign(_, Expr::Field(of, field), value) = s else { return None };
    (**of == Expr::name("s") && is_free(value)).then_some(field)
}

/// Functions of the runtime that only tell a number.
const PURE: [&str; 3] = ["since", "ticks_gone", "in_nanoseconds"];

/// True if nothing happens as an expression is evaluated.
fn is_free(e: &Expr) -> bool {
    let mut free = true;
    e.walk(&mut |e| free &= !matches!(e, Expr::Call(f, _) if !PURE.contains(&f.as_str())));
    free
}

/// Fields of the runtime's state that are written and never read; what callers look at is a structure.
fn unread(m: &Module) -> HashSet<String> {
    let mut uses: HashMap<&str, isize> = HashMap::new();
    for s in m.structs.iter().filter(|s| s.name == "State") {
        let own = |f: &&crate::tree::Field| !f.kept && !matches!(f.ty, Ty::Named(_));
        uses.extend(s.fields.iter().filter(own).map(|f| (f.name.as_str(), 0)));
    }
    for f in &m.functions {
        for s in &f.body {
            s.walk(&mut |e| {
                if let Expr::Field(_, field) = e
                    && let Some(n) = uses.get_mut(field.as_str())
                {
                    *n += 1;
                }
            });
        }
        each_statement(&f.body, &mut |s| {
            if let Some(n) = written(s).and_then(|field| uses.get_mut(field)) {
                *n -= 1;
            }
        });
    }
    uses.into_iter().filter(|(_, n)| *n == 0).map(|(field, _)| field.to_owned()).collect()
}

/// Takes out what writes these fields, and conditions that nothing depends on any more.
fn without_writes(body: &mut Vec<Stmt>, fields: &HashSet<String>) {
    for s in body.iter_mut() {
        match s {
            Stmt::If(_, a, b) => {
                without_writes(a, fields);
                without_writes(b, fields);
            }
            Stmt::While(_, body) | Stmt::For(_, _, _, body) => without_writes(body, fields),
            Stmt::Match(_, arms) => arms.iter_mut().for_each(|a| without_writes(&mut a.body, fields)),
            _ => {}
        }
    }
    body.retain(|s| match s {
        Stmt::If(c, a, b) => !(a.is_empty() && b.is_empty() && is_free(c)),
        _ => written(s).is_none_or(|field| !fields.contains(field)),
    });
}

/// Takes out a `return` behind which a function ends anyway.
fn without_last_return(body: &mut Vec<Stmt>) {
    loop {
        match body.last_mut() {
            Some(Stmt::Return(None)) => {}
            Some(Stmt::If(c, a, b)) => {
                without_last_return(a);
                without_last_return(b);
                if !(a.is_empty() && b.is_empty() && is_free(c)) {
                    return;
                }
            }
            Some(Stmt::Match(_, arms)) => {
                return arms.iter_mut().for_each(|a| without_last_return(&mut a.body));
            }
            _ => return,
        }
        body.pop();
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
    let (functions, _, _, _) = reach(m);
    m.functions.retain(|f| functions.contains(&f.name));
    let unread = unread(m);
    for f in &mut m.functions {
        without_writes(&mut f.body, &unread);
    }
    let (_, _, fields, _) = reach(m);
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
    for f in &mut m.functions {
        if f.result.is_none() {
            without_last_return(&mut f.body);
        }
    }
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
