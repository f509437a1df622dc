//! Stored actions that all read the values from before the pass: each works on copies
//! of what it writes, and hands them over to the end of the pass (`change.rs`).

use g7_model::Type;

use crate::code::Stand;
use crate::fb;
use crate::form::{Expr, MemoryId, Stmt, What};
use crate::make::{Make, lower, raise};

impl Make<'_> {
    /// An action that reads the values from before the pass: it works on copies,
    /// and what it wrote is noted for [`Make::give`].
    pub(crate) fn run_apart(&mut self, action: u32) -> Vec<Stmt> {
        let Some(a) = self.t.actions.get(action as usize).copied() else { return Vec::new() };
        let due = self.due(a.period);
        let (mut list, condition) = self.condition(a.condition);
        let written = self.written(a.body);
        let mut stand = Stand::default();
        for m in &written {
            let own = self.beside(What::Own(*m), *m);
            let wrote = self.flag(What::OwnWrote(*m));
            stand.own.insert(*m, (own, wrote));
        }
        let mut body = self.work_in(a.body, Some(stand.clone()));
        let (mut work, mut back) = (self.note_run(action), Vec::new());
        for m in written {
            let Some((own, wrote)) = stand.own.get(&m).copied() else { continue };
            let sure = is_surely_written(&body, own);
            if sure {
                drop_sets(&mut body, wrote);
            } else {
                work.push(lower(wrote));
            }
            if !begins_with_write(&body, own) {
                work.push(Stmt::Set(own, Expr::Read(m)));
            }
            let written = if sure { Expr::truth(true) } else { Expr::Read(wrote) };
            back.extend(Stmt::when(written, self.hand_over(m, own)));
        }
        work.extend(body);
        work.extend(back);
        list.extend(Stmt::when(condition, work));
        Stmt::when(due, list)
    }

    /// Hands the value of a copy over to the end of the pass.
    fn hand_over(&mut self, m: MemoryId, own: MemoryId) -> Vec<Stmt> {
        let (given, noted) = (self.beside(What::Given(m), m), self.flag(What::Wrote(m)));
        let mut take = Vec::new();
        if self.options.conflicts {
            let ty = self.of(m).map_or(Type::Bool, |m| m.ty);
            let conflict = self.flag(What::Conflict(m));
            let differs = Expr::Differs(ty, Box::new(Expr::Read(own)), Box::new(Expr::Read(given)));
            take.extend(raise(conflict, Expr::Read(noted).and(differs)));
        }
        take.extend([Stmt::Set(given, Expr::Read(own)), Stmt::Set(noted, Expr::truth(true))]);
        take
    }
}

/// A list writes this memory whatever conditions hold within it.
fn is_surely_written(list: &[Stmt], own: MemoryId) -> bool {
    list.iter().any(|s| match s {
        Stmt::Set(m, _) => *m == own,
        Stmt::Call(block, memories) => fb::written(*block, memories).contains(&own),
        _ => false,
    })
}

/// Nothing reads this memory before all of it is written.
fn begins_with_write(list: &[Stmt], own: MemoryId) -> bool {
    let reads = |s: &Stmt| {
        let mut found = false;
        s.visit(&mut |s| {
            s.expressions(&mut |e| found |= e.reads(own));
            found |= matches!(s, Stmt::Call(_, memories) if memories.contains(&own));
        });
        found
    };
    let writes = |s: &Stmt| {
        let mut found = false;
        s.visit(&mut |s| found |= matches!(s, Stmt::Set(m, _) | Stmt::SetElement(m, ..) if *m == own));
        found
    };
    let first = list.iter().find(|s| reads(s) || writes(s));
    first.is_some_and(|s| matches!(s, Stmt::Set(..)) && !reads(s))
}

/// Drops what is set in a memory, at every depth.
fn drop_sets(list: &mut Vec<Stmt>, of: MemoryId) {
    list.retain(|s| !matches!(s, Stmt::Set(m, _) if *m == of));
    for s in list {
        match s {
            Stmt::If(_, a, b) => {
                drop_sets(a, of);
                drop_sets(b, of);
            }
            Stmt::Loop(a) => drop_sets(a, of),
            _ => {}
        }
    }
}
