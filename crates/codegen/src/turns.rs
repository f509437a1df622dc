//! The situation told by its changes, for speed (before `spare.rs`, flat style).
//!
//! The equations give each step its next value, and that value to the step:
//!
//! ```text
//! next := on OR (x AND NOT off);              IF on THEN
//! ...                                             IF NOT x THEN a; x := TRUE; END_IF
//! IF next AND NOT x THEN a; END_IF       ->   ELSIF x AND off THEN
//! IF x AND NOT next THEN b; END_IF                b; x := FALSE;
//! x := next;                                  END_IF
//! ```
//!
//! Few steps change in a scan, so code of the second form stores little. In a chart of many
//! steps, the code asks once for each group of steps whether any of them changes.
//!
//! # Invariants
//!
//! - A step is rewritten only where nothing between the two places writes what its
//!   next value is made of: both forms then do the same. So for a group.

use std::collections::{BTreeSet, HashMap};

use g7_equations::{About, Equations, Expr, MemoryId, Stmt, What};

use crate::spare::{mentioned, operands, written};

/// Number of steps in a group; the code asks once whether any step of a group changes.
const GROUP: usize = 8;
/// Least number of steps for which groups are made; the code of a small chart is easier to
/// read without groups.
const MANY: usize = 4 * GROUP;

/// Rewrites the statements of the pass; their meaning stays the same.
pub(crate) fn turned(e: &mut Equations) {
    let memories = &e.memories;
    let what = |m: MemoryId| memories.get(m.0 as usize).map(|m| m.what);
    let mut list: Vec<&mut Stmt> = e.pass.iter_mut().flat_map(|s| &mut s.body).collect();
    let lines: Vec<Stmt> = list.iter().map(|s| (**s).clone()).collect();
    let pass = Pass::of(&lines);
    let turns: Vec<Turn> = (0..lines.len()).filter_map(|at| pass.turn(at, &what)).collect();
    let (turns, raises) = pass.with_raises(turns);
    let most = if turns.len() < MANY { 1 } else { GROUP };
    for group in pass.groups(turns, most) {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
        let (from, at) = (first.from, last.at);
        let stmt = pass.together(group);
        for k in from..at {
            put(&mut list, k, Stmt::About(About::Nothing));
        }
        put(&mut list, at, stmt);
    }
    for (at, stmt) in raises {
        put(&mut list, at, stmt);
    }
}

fn put(list: &mut [&mut Stmt], at: usize, stmt: Stmt) {
    if let Some(place) = list.get_mut(at) {
        **place = stmt;
    }
}

/// A step that takes its next value.
struct Turn {
    step: MemoryId,
    next: MemoryId,
    /// The statement that sets its next value.
    set: usize,
    /// The first of the statements that follow from its change.
    from: usize,
    /// The statement that gives the step its next value, the last of them.
    at: usize,
    /// Activates the step.
    on: Expr,
    /// Deactivates the step, if `on` is FALSE.
    off: Expr,
    /// Runs where the step becomes active.
    comes: Vec<Stmt>,
    /// Runs where the step becomes inactive.
    goes: Vec<Stmt>,
}

impl Turn {
    /// The memories that ask for a change.
    fn asked(&self) -> Vec<MemoryId> {
        [operands(&self.on), operands(&self.off)].concat()
    }

    fn stmt(self) -> Stmt {
        let Turn { step, on, off, mut comes, mut goes, .. } = self;
        let active = Expr::Read(step);
        comes.push(Stmt::Set(step, Expr::truth(true)));
        goes.push(Stmt::Set(step, Expr::truth(false)));
        let goes = Stmt::when(active.clone().and(off), goes);
        if on.known() == Some(false) {
            let none = Stmt::About(About::Nothing);
            return goes.into_iter().next().unwrap_or(none);
        }
        if goes.is_empty() {
            return Stmt::If(on.and(active.negated()), comes, goes);
        }
        Stmt::If(on, Stmt::when(active.negated(), comes), goes)
    }
}

/// The statements of a pass in their order, with those that use a memory.
struct Pass<'l> {
    lines: &'l [Stmt],
    /// By memory: the statements that write it.
    writes: HashMap<MemoryId, Vec<usize>>,
    /// By memory: the statements that read or write it, but those that raise it as a flag.
    looks: HashMap<MemoryId, Vec<usize>>,
}

impl Pass<'_> {
    fn of(lines: &[Stmt]) -> Pass<'_> {
        let mut writes: HashMap<MemoryId, Vec<usize>> = HashMap::new();
        let mut looks: HashMap<MemoryId, Vec<usize>> = HashMap::new();
        for (at, line) in lines.iter().enumerate() {
            for m in written(line) {
                writes.entry(m).or_default().push(at);
            }
            let raised = raise(line).map(|r| r.0);
            for m in mentioned(line).into_iter().filter(|m| raised != Some(*m)) {
                looks.entry(m).or_default().push(at);
            }
        }
        Pass { lines, writes, looks }
    }

    /// True if a statement in this range writes the memory.
    fn writes(&self, m: MemoryId, range: std::ops::Range<usize>) -> bool {
        let all = self.writes.get(&m).map_or(&[][..], Vec::as_slice);
        let first = all.partition_point(|at| *at < range.start);
        all.get(first).is_some_and(|at| *at < range.end)
    }

    /// The turn of the step that the statement at this place sets.
    fn turn(&self, at: usize, what: &dyn Fn(MemoryId) -> Option<What>) -> Option<Turn> {
        let Stmt::Set(step, Expr::Read(next)) = self.lines.get(at)? else { return None };
        let (step, next) = (*step, *next);
        let is_turn = matches!((what(step), what(next)),
            (Some(What::Step(a)), Some(What::Next(b))) if a == b);
        let [set] = self.writes.get(&next)?.as_slice() else { return None };
        let (true, Some(Stmt::Set(_, value))) = (is_turn && *set < at, self.lines.get(*set)) else {
            return None;
        };
        let (on, off) = parts(value, step)?;
        let (active, coming) = (Expr::Read(step), Expr::Read(next));
        let arrives = coming.clone().and(active.clone().negated());
        let leaves = active.and(coming.negated());
        let (mut comes, mut goes) = (Vec::new(), Vec::new());
        let mut from = at;
        while let Some(Stmt::If(c, then, other)) = from.checked_sub(1).and_then(|k| self.lines.get(k)) {
            let either = matches!(c, Expr::Or(list) if *list == [arrives.clone(), leaves.clone()]);
            if !other.is_empty() || !(either || *c == arrives || *c == leaves) {
                break;
            }
            for (list, here) in [(&mut comes, *c == arrives), (&mut goes, *c == leaves)] {
                if here || either {
                    list.splice(0..0, then.iter().cloned());
                }
            }
            from -= 1;
        }
        let mut made_of: BTreeSet<MemoryId> = operands(value).into_iter().collect();
        made_of.extend([step, next]);
        let inside = comes.iter().chain(&goes).flat_map(mentioned).any(|m| m == step || m == next);
        if inside || made_of.iter().any(|m| self.writes(*m, set + 1..at)) {
            return None;
        }
        Some(Turn { step, next, set: *set, from, at, on, off, comes, goes })
    }

    /// Divides the turns into groups. Between the turns of a group no statement does anything,
    /// and none of them writes what another one of the group depends on.
    fn groups(&self, turns: Vec<Turn>, most: usize) -> Vec<Vec<Turn>> {
        let mut groups: Vec<Vec<Turn>> = Vec::new();
        for turn in turns {
            let open = groups.last_mut().filter(|group| {
                let (Some(first), Some(last)) = (group.first(), group.last()) else { return false };
                let between = self.lines.get(last.at + 1..turn.from).unwrap_or_default();
                let stands = |m: MemoryId| !self.writes(m, first.from..turn.at + 1);
                group.len() < most
                    && between.iter().all(|line| matches!(line, Stmt::About(_)))
                    && group.iter().chain([&turn]).all(|t| t.asked().into_iter().all(stands))
            });
            match open {
                Some(group) => group.push(turn),
                None => groups.push(vec![turn]),
            }
        }
        groups
    }

    /// One statement for a group; a group of several steps is skipped if none of them changes.
    fn together(&self, group: Vec<Turn>) -> Stmt {
        let alone = group.len() == 1;
        let any = Expr::any(group.iter().flat_map(|t| [t.on.clone(), t.off.clone()]));
        let mut list = Vec::new();
        for turn in group {
            if !alone
                && let Some(about @ Stmt::About(_)) = turn.from.checked_sub(1).and_then(|k| self.lines.get(k))
            {
                list.push(about.clone());
            }
            list.push(turn.stmt());
        }
        match list.pop() {
            Some(only) if alone => only,
            last => Stmt::If(any, list.into_iter().chain(last).collect(), Vec::new()),
        }
    }

    /// Finds the flags that tell of a change: `flag := flag OR x XOR next OR ...`. The turn of
    /// `x` raises the flag instead, and the statement loses that part. Nothing is changed for a
    /// turn if a statement reads the flag before the turn.
    fn with_raises(&self, mut turns: Vec<Turn>) -> (Vec<Turn>, Vec<(usize, Stmt)>) {
        let place: HashMap<(MemoryId, MemoryId), usize> =
            turns.iter().enumerate().map(|(k, t)| ((t.step, t.next), k)).collect();
        let mut raises = Vec::new();
        for (at, line) in self.lines.iter().enumerate() {
            let Some((flag, list)) = raise(line) else { continue };
            let looks = self.looks.get(&flag).map_or(&[][..], Vec::as_slice);
            let next_look = looks.get(looks.partition_point(|k| *k <= at)).copied().unwrap_or(usize::MAX);
            let mut kept = Vec::new();
            for e in list {
                let turn = of_change(e).and_then(|pair| place.get(&pair)).and_then(|k| turns.get_mut(*k));
                match turn.filter(|t| t.set < at && at < t.from && t.at < next_look) {
                    Some(turn) => {
                        for list in [&mut turn.comes, &mut turn.goes] {
                            list.push(Stmt::Set(flag, Expr::truth(true)));
                        }
                    }
                    None => kept.push(e.clone()),
                }
            }
            let nothing = kept == [Expr::Read(flag)];
            let left = if nothing { Stmt::About(About::Nothing) } else { Stmt::Set(flag, Expr::any(kept)) };
            raises.push((at, left));
        }
        (turns, raises)
    }
}

/// The flag of a statement `flag := flag OR ...`, and all operands of its OR.
fn raise(line: &Stmt) -> Option<(MemoryId, &[Expr])> {
    match line {
        Stmt::Set(flag, Expr::Or(list)) if list.first() == Some(&Expr::Read(*flag)) => Some((*flag, list)),
        _ => None,
    }
}

/// The step and its next value, if the expression says that they differ.
fn of_change(e: &Expr) -> Option<(MemoryId, MemoryId)> {
    match e {
        Expr::Xor(a, b) => match (&**a, &**b) {
            (Expr::Read(step), Expr::Read(next)) => Some((*step, *next)),
            _ => None,
        },
        _ => None,
    }
}

/// `on` and `off` of `on OR (x AND NOT off)`.
fn parts(value: &Expr, x: MemoryId) -> Option<(Expr, Expr)> {
    let list = if let Expr::Or(list) = value { list.as_slice() } else { std::slice::from_ref(value) };
    let (own, others): (Vec<&Expr>, Vec<&Expr>) = list.iter().partition(|e| e.reads(x));
    let [own] = own.as_slice() else { return None };
    let stays: Vec<Expr> = match own {
        Expr::Read(_) => Vec::new(),
        Expr::And(all) if all.first() == Some(&Expr::Read(x)) => all.iter().skip(1).cloned().collect(),
        _ => return None,
    };
    if stays.iter().any(|e| e.reads(x)) {
        return None;
    }
    let off = Expr::any(stays.into_iter().map(Expr::negated));
    Some((Expr::any(others.into_iter().cloned()), off))
}
