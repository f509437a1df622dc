//! Words for the expressions of edges and delays, of which names can be made: `start`, `start_and_not_full`.
//! Read in the equations before anything is left out of them; [`super::memories`] makes names of it.

use std::collections::HashMap;

use g7_compile::Compiled;
use g7_engine::WatchId;
use g7_equations::{Equations, Expr, MemoryId, Stmt, What};

/// Letters of a name that still reads well; a longer expression has a number.
const LONGEST: usize = 24;

/// By watch: the words for what it watches. One with an expression that is too long has none.
pub(super) fn signals(c: &Compiled, e: &Equations) -> HashMap<WatchId, String> {
    let variables: HashMap<What, &str> =
        c.symbols.variables.iter().rev().map(|v| (What::Variable(v.addr), &*v.name)).collect();
    let words = |m: MemoryId| match e.memory(m)?.what {
        What::Step(s) => Some(format!("X_{}", c.symbols.step_name(s))),
        what => variables.get(&what).map(|name| (*name).to_owned()),
    };
    let mut found = HashMap::new();
    for s in e.sections().flat_map(|s| &s.body) {
        s.visit(&mut |s| {
            let Stmt::Set(to, value) = s else { return };
            // The value is worked out first where it is more than a memory.
            if let Some(What::Watched(w) | What::WatchedBefore(w)) = e.memory(*to).map(|m| m.what)
                && let Some(text) = of_expression(value, &words)
                && text.len() <= LONGEST
            {
                found.entry(w).or_insert(text);
            }
        });
    }
    found
}

fn of_expression(e: &Expr, words: &dyn Fn(MemoryId) -> Option<String>) -> Option<String> {
    let list = |list: &[Expr], sign: &str| {
        let parts: Option<Vec<String>> = list.iter().map(|e| of_expression(e, words)).collect();
        Some(parts?.join(sign))
    };
    match e {
        Expr::Read(m) => words(*m),
        Expr::Not(e) => Some(format!("not_{}", of_expression(e, words)?)),
        Expr::And(parts) => list(parts, "_and_"),
        Expr::Or(parts) => list(parts, "_or_"),
        _ => None,
    }
}
