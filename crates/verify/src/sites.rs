//! The places of a chart where a fault can end a scan, and what it depends on there.
//!
//! `faults.rs` asks about each of them by itself: then a counter that may overflow keeps no other question
//! about a fault from its answer.

use std::collections::BTreeSet;

use g7_engine::{Addr, Arith, FaultKind};
use g7_equations::{Equations, Expr, MemoryId, Stmt, What, expand};

/// A place where a fault can end a scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Site {
    /// The memories that decide whether it does.
    pub(crate) reads: BTreeSet<MemoryId>,
    /// The variable to which a constant above 0 is added here, if that is all that can fail.
    pub(crate) counter: Option<Addr>,
}

/// All places of faults in the equations, but for orders that disagree, which are a question of their own.
/// `None` if a fault stands in a function block, where nothing tells what it depends on.
pub(crate) fn sites(e: &Equations) -> Option<Vec<Site>> {
    let mut found = Vec::new();
    let mut conditions = Vec::new();
    let sections = e.sections().flat_map(|s| &s.body);
    sections.map(|s| walk(e, s, &mut conditions, &mut found)).collect::<Option<Vec<()>>>()?;
    Some(found)
}

fn walk<'e>(
    e: &'e Equations,
    s: &'e Stmt,
    conditions: &mut Vec<&'e Expr>,
    found: &mut Vec<Site>,
) -> Option<()> {
    match s {
        Stmt::If(c, then, other) => {
            conditions.push(c);
            for s in then.iter().chain(other) {
                walk(e, s, conditions, found)?;
            }
            conditions.pop();
        }
        Stmt::Loop(body) => body.iter().try_for_each(|s| walk(e, s, conditions, found))?,
        Stmt::Fault(FaultKind::Forcing { .. }, _) => {}
        Stmt::Fault(..) => found.push(site(e, conditions)),
        Stmt::Call(block, memories) => {
            let mut fails = false;
            let mut note = |s: &Stmt| fails |= matches!(s, Stmt::Fault(..));
            expand(*block, memories).iter().for_each(|s| s.visit(&mut note));
            return (!fails).then_some(());
        }
        Stmt::Set(..) | Stmt::SetElement(..) | Stmt::Exit | Stmt::About(_) => {}
    }
    Some(())
}

/// A fault behind these conditions.
fn site(e: &Equations, conditions: &[&Expr]) -> Site {
    let mut reads = BTreeSet::new();
    for c in conditions {
        c.visit(&mut |x| {
            if let Expr::Read(m) | Expr::Element(m, _) = x {
                reads.insert(*m);
            }
        });
    }
    let counter = match conditions.last() {
        Some(Expr::Fails(sum)) => counted(e, sum),
        _ => None,
    };
    Site { reads, counter }
}

/// The variable of `n + 1`.
fn counted(e: &Equations, sum: &Expr) -> Option<Addr> {
    let Expr::Arith(Arith::Add, _, a, b) = sum else { return None };
    let (Expr::Read(m), Expr::Const(_, 1..)) = (&**a, &**b) else { return None };
    variable(e, *m)
}

/// The variable that a memory is, or is a copy of.
fn variable(e: &Equations, m: MemoryId) -> Option<Addr> {
    match e.memory(m)?.what {
        What::Variable(at) => Some(at),
        What::Own(of) | What::Given(of) | What::Begun(of) => variable(e, of),
        _ => None,
    }
}
