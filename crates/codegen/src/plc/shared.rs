//! Lists of memories joined by OR that several statements read: each is written once, into a memory
//! of its own before the first of them.
//!
//! Invariant: between that memory and its last reader nothing assigns what the list names, so the
//! value is the one that stood there. Statements within loops are looked at by themselves.

use std::collections::{BTreeSet, HashMap};

use super::form::{Ex, St};

/// Parts of a list that is worth a memory.
const LEAST: usize = 3;

/// Statements between which a list keeps its value.
struct Run {
    parts: Vec<String>,
    from: usize,
    readers: Vec<usize>,
}

/// Writes each list once; `name` declares a memory and returns its name.
pub(super) fn once(list: Vec<St>, name: &mut dyn FnMut() -> String) -> Vec<St> {
    let list: Vec<St> = list.into_iter().map(|s| inside(s, name)).collect();
    let mut before: HashMap<usize, Vec<St>> = HashMap::new();
    let mut instead: HashMap<usize, HashMap<Vec<String>, String>> = HashMap::new();
    for run in runs(&list) {
        let own = name();
        let value = Ex::any(run.parts.iter().map(Ex::var));
        before.entry(place(&list, run.from)).or_default().push(St::set(own.clone(), value));
        for at in run.readers {
            instead.entry(at).or_default().insert(run.parts.clone(), own.clone());
        }
    }
    let mut out = Vec::new();
    for (i, mut s) in list.into_iter().enumerate() {
        out.extend(before.remove(&i).unwrap_or_default());
        if let Some(names) = instead.get(&i) {
            expressions(&mut s, &mut |e| put(e, names));
        }
        out.push(s);
    }
    out
}

/// The bodies of loops and conditions, each by itself.
fn inside(s: St, name: &mut dyn FnMut() -> String) -> St {
    match s {
        St::If(c, a, b) => St::If(c, once(a, name), once(b, name)),
        St::Loop(a) => St::Loop(once(a, name)),
        St::Until(a, c) => St::Until(once(a, name), c),
        other => other,
    }
}

/// The remark of a statement stays beside it.
fn place(list: &[St], mut at: usize) -> usize {
    while at > 0 && list.get(at - 1).is_some_and(|s| matches!(s, St::Note(_))) {
        at -= 1;
    }
    at
}

/// The lists that at least two statements read, with these statements.
fn runs(list: &[St]) -> Vec<Run> {
    let mut open: HashMap<Vec<String>, Run> = HashMap::new();
    let mut by_name: HashMap<String, BTreeSet<Vec<String>>> = HashMap::new();
    let mut closed = Vec::new();
    for (i, s) in list.iter().enumerate() {
        // A loop reads what it has assigned itself: its lists are its own.
        if !matches!(s, St::Loop(_) | St::Until(..)) {
            let assigned = assigned(s);
            let nested = matches!(s, St::If(..));
            read(s, &mut |parts| {
                if nested && parts.iter().any(|p| assigned.contains(p)) {
                    return;
                }
                for p in parts {
                    by_name.entry(p.clone()).or_default().insert(parts.to_vec());
                }
                let new = || Run { parts: parts.to_vec(), from: i, readers: Vec::new() };
                let run = open.entry(parts.to_vec()).or_insert_with(new);
                if run.readers.last() != Some(&i) {
                    run.readers.push(i);
                }
            });
        }
        for name in assigned(s) {
            for parts in by_name.remove(&name).unwrap_or_default() {
                closed.extend(open.remove(&parts));
            }
        }
    }
    closed.extend(open.into_values());
    closed.retain(|run| run.readers.len() > 1);
    closed.sort_by(|a, b| (a.from, &a.parts).cmp(&(b.from, &b.parts)));
    closed
}

/// The memories that a statement and those within it assign.
fn assigned(s: &St) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut todo = vec![s];
    while let Some(s) = todo.pop() {
        match s {
            St::Assign(Ex::Var(name) | Ex::Index(name, _), _) => drop(found.insert(name.clone())),
            St::If(_, a, b) => todo.extend(a.iter().chain(b)),
            St::Loop(a) | St::Until(a, _) => todo.extend(a),
            _ => {}
        }
    }
    found
}

/// The lists that a statement and those within it read.
fn read(s: &St, f: &mut dyn FnMut(&[String])) {
    let mut look = |e: &Ex| {
        e.walk(&mut |e| {
            if let Some(parts) = names(e) {
                f(&parts);
            }
        });
    };
    match s {
        St::Assign(_, e) => look(e),
        St::If(c, a, b) => {
            look(c);
            a.iter().chain(b).for_each(|s| read(s, f));
        }
        _ => {}
    }
}

/// Memories alone, joined by OR.
fn names(e: &Ex) -> Option<Vec<String>> {
    let Ex::Or(parts) = e else { return None };
    let name = |e: &Ex| match e {
        Ex::Var(name) if !name.contains('.') => Some(name.clone()),
        _ => None,
    };
    if parts.len() < LEAST { None } else { parts.iter().map(name).collect() }
}

/// The expressions that [`read`] looks at.
fn expressions(s: &mut St, f: &mut dyn FnMut(&mut Ex)) {
    match s {
        St::Assign(_, e) => f(e),
        St::If(c, a, b) => {
            f(c);
            a.iter_mut().chain(b).for_each(|s| expressions(s, f));
        }
        _ => {}
    }
}

fn put(e: &mut Ex, by: &HashMap<Vec<String>, String>) {
    if let Some(own) = names(e).and_then(|parts| by.get(&parts)) {
        *e = Ex::var(own);
        return;
    }
    e.inner_mut().into_iter().for_each(|inner| put(inner, by));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn or() -> Ex {
        Ex::any(["a", "b", "c"].map(Ex::var))
    }

    fn written(list: Vec<St>) -> Vec<St> {
        let mut n = 0;
        once(list, &mut || {
            n += 1;
            format!("ANY_{n}")
        })
    }

    #[test]
    fn a_list_of_two_readers_is_written_once() {
        let list = vec![
            St::Note("x".into()),
            St::set("x", or()),
            St::If(or().not(), vec![St::set("y", Ex::Bool(true))], Vec::new()),
        ];
        let want = vec![
            St::set("ANY_1", or()),
            St::Note("x".into()),
            St::set("x", Ex::var("ANY_1")),
            St::If(Ex::var("ANY_1").not(), vec![St::set("y", Ex::Bool(true))], Vec::new()),
        ];
        assert_eq!(written(list), want);
    }

    #[test]
    fn a_list_whose_parts_change_is_written_again() {
        let list = vec![St::set("x", or()), St::set("b", Ex::Bool(true)), St::set("y", or())];
        assert_eq!(written(list.clone()), list);
        let list = vec![
            St::If(Ex::var("q"), vec![St::set("b", Ex::Bool(true)), St::set("x", or())], Vec::new()),
            St::set("y", or()),
        ];
        assert_eq!(written(list.clone()), list);
    }
}
