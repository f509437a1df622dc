//! Names of translated code: which can be declared where they get their value, and
//! which nothing reads (`body.rs` makes them).

use std::collections::HashMap;

use g7_equations::{Expr as Term, MemoryId, Stmt as Line};

use crate::tree::{Block, Expr, Stmt};

/// The memories that are set once, before all that reads them, in a list round it:
/// they can be declared where they are set.
#[derive(Default)]
pub(crate) struct Lets {
    /// By memory: the list that sets it; `None` where it is not as simple as that.
    set_in: HashMap<MemoryId, Option<usize>>,
    lists: usize,
}

impl Lets {
    pub(crate) fn of(list: &[Line], value: Option<&Term>) -> Lets {
        let mut lets = Lets::default();
        lets.list(list, &mut vec![0]);
        if let Some(e) = value {
            lets.reads(e, &[0]);
        }
        lets
    }

    fn list(&mut self, list: &[Line], open: &mut Vec<usize>) {
        for s in list {
            s.expressions(&mut |e| self.reads(e, open));
            match s {
                Line::Set(m, _) => {
                    let here = open.last().copied();
                    self.set_in.entry(*m).and_modify(|at| *at = None).or_insert(here);
                }
                Line::SetElement(m, ..) => self.set_in.extend([(*m, None)]),
                Line::Call(_, all) => self.set_in.extend(all.iter().map(|m| (*m, None))),
                Line::If(_, a, b) => {
                    self.inner(a, open);
                    self.inner(b, open);
                }
                Line::Loop(a) => self.inner(a, open),
                Line::Exit | Line::Fault(..) | Line::About(_) => {}
            }
        }
    }

    fn inner(&mut self, list: &[Line], open: &mut Vec<usize>) {
        self.lists += 1;
        open.push(self.lists);
        self.list(list, open);
        open.pop();
    }

    fn reads(&mut self, e: &Term, open: &[usize]) {
        e.visit(&mut |e| {
            if let Term::Read(m) | Term::Element(m, _) = e {
                let at = self.set_in.entry(*m).or_insert(None);
                if at.is_some_and(|list| !open.contains(&list)) {
                    *at = None;
                }
            }
        });
    }

    pub(crate) fn is_simple(&self, m: MemoryId) -> bool {
        self.set_in.get(&m).is_some_and(Option::is_some)
    }
}

/// Takes out names that nothing reads; what gives their values stays where it can fail.
pub(crate) fn drop_unused(block: &mut Block, value: Option<&Expr>) {
    let mut used: HashMap<String, usize> = HashMap::new();
    let mut count = |e: &Expr| {
        if let Expr::Name(n) = e {
            *used.entry(n.clone()).or_default() += 1;
        }
    };
    block.iter().for_each(|s| s.walk(&mut count));
    if let Some(e) = value {
        e.walk(&mut count);
    }
    without_unused(block, &used);
}

fn without_unused(block: &mut Block, used: &HashMap<String, usize>) {
    for s in block.iter_mut() {
        match s {
            Stmt::Let { name, value: Expr::Call(f, args), .. } if !used.contains_key(name) => {
                *s = Stmt::Do(Expr::Call(f.clone(), args.clone()));
            }
            Stmt::If(_, a, b) => {
                without_unused(a, used);
                without_unused(b, used);
            }
            Stmt::While(_, a) => without_unused(a, used),
            _ => {}
        }
    }
    block.retain(|s| match s {
        Stmt::Let { name, .. } => used.contains_key(name),
        Stmt::Do(Expr::Call(f, _)) => f != "zeroed",
        _ => true,
    });
}
