//! Leaves out what printed code need not say: memories that nothing reads, a
//! FALSE that the next statement turns over, values that are read where they
//! could as well be worked out. What the equations do stays the same.

use std::collections::{BTreeSet, HashMap, HashSet};

use g7_engine::FaultKind;
use g7_equations::{Class, Equations, Expr, MemoryId, Section, Stmt, What};
use g7_model::{Span, Type};

/// The same equations with less to read: those of a controller that judges overflow
/// and loops by itself, and keeps what is inside its own function blocks (`native`).
pub(crate) fn spare_for_controllers(e: &mut Equations, native: &HashSet<MemoryId>) {
    for s in sections(e) {
        s.body = left_to_the_controller(std::mem::take(&mut s.body));
    }
    drop_writes(e, native);
    spare(e, |_| false);
}

/// The same equations with less to read. Callers of the code ask for variables, steps
/// and what `asked` names; what else nothing reads is left out.
pub(crate) fn spare(e: &mut Equations, asked: fn(What) -> bool) {
    // The first pass says by itself whether it changed something.
    if let Some((changed, _)) = e.search {
        for s in &mut e.begin {
            retain(&mut s.body, &mut |s| !matches!(s, Stmt::Set(m, _) if *m == changed));
        }
    }
    start_once(e);
    drop_unread(e, asked);
    for mut list in phases(e) {
        join_raises(&mut list);
    }
    for s in sections(e) {
        drop_empty(&mut s.body);
    }
    one_name_a_value(e);
    in_place(e);
    drop_unread(e, asked);
}

/// Calls of function blocks as assignments, but for those that stay.
pub(crate) fn expanded(list: Vec<Stmt>, stays: &dyn Fn(&[MemoryId]) -> bool) -> Vec<Stmt> {
    let mut out = Vec::new();
    for s in list {
        match s {
            Stmt::Call(block, memories) if !stays(&memories) => {
                out.extend(g7_equations::expand(block, &memories));
            }
            Stmt::If(c, a, b) => out.push(Stmt::If(c, expanded(a, stays), expanded(b, stays))),
            Stmt::Loop(a) => out.push(Stmt::Loop(expanded(a, stays))),
            other => out.push(other),
        }
    }
    out
}

/// The copies that an action works on are set in a list of statements several
/// times: each value gets a memory of its own, so that it can stand in place.
fn one_name_a_value(e: &mut Equations) {
    let own: HashSet<MemoryId> = (0u32..)
        .zip(&e.memories)
        .filter(|(_, m)| matches!(m.what, What::Own(_) | What::OwnWrote(_)) && m.elements == 1)
        .map(|(i, _)| MemoryId(i))
        .collect();
    let mut memories = std::mem::take(&mut e.memories);
    for s in sections(e) {
        values_apart(&mut s.body, &own, &mut memories);
    }
    e.memories = memories;
}

/// The first value of a copy, or of the flag that it was written. A copy ends in the
/// list that hands it over.
fn begins(m: MemoryId, what: Option<What>, e: &Expr, handed_over: &HashSet<MemoryId>) -> bool {
    match what {
        Some(What::Own(of)) => handed_over.contains(&of) && !e.reads(m),
        Some(What::OwnWrote(_)) => e.known() == Some(false),
        _ => false,
    }
}

fn values_apart(list: &mut [Stmt], own: &HashSet<MemoryId>, memories: &mut Vec<g7_equations::Memory>) {
    // A copy that is written under a condition keeps its one memory, and so does one that was
    // begun in the list around this one.
    let handed_over: HashSet<MemoryId> = list
        .iter()
        .flat_map(written)
        .filter_map(|m| match memories.get(m.0 as usize).map(|m| m.what) {
            Some(What::Given(of)) => Some(of),
            _ => None,
        })
        .collect();
    let mut plain: HashSet<MemoryId> = HashSet::new();
    let mut seen: HashSet<MemoryId> = HashSet::new();
    for s in list.iter() {
        if let Stmt::Set(m, e) = s
            && own.contains(m)
            && !seen.contains(m)
            && begins(*m, memories.get(m.0 as usize).map(|m| m.what), e, &handed_over)
        {
            plain.insert(*m);
        }
        seen.extend(mentioned(s));
    }
    for s in list.iter_mut() {
        match s {
            Stmt::If(_, a, b) => {
                values_apart(a, own, memories);
                values_apart(b, own, memories);
            }
            Stmt::Loop(a) => values_apart(a, own, memories),
            _ => {}
        }
        if !matches!(s, Stmt::Set(..)) {
            for m in written(s) {
                plain.remove(&m);
            }
        }
    }
    let mut now: HashMap<MemoryId, Expr> = HashMap::new();
    for s in list {
        put_in(s, &now);
        if let Stmt::Set(m, _) = s
            && plain.contains(m)
            && let Some(like) = memories.get(m.0 as usize).cloned()
        {
            let n = memories.len() as u32;
            memories.push(g7_equations::Memory { what: What::Temporary(u32::MAX - n), ..like });
            now.insert(*m, Expr::Read(MemoryId(n)));
            *m = MemoryId(n);
        }
    }
}

pub(crate) fn sections(e: &mut Equations) -> impl Iterator<Item = &mut Section> {
    e.begin.iter_mut().chain(&mut e.pass).chain(&mut e.finish)
}

/// The statements that stand one behind the other: all of a scan, or, where
/// passes are repeated, those before, within and behind the repetition.
fn phases(e: &mut Equations) -> Vec<Vec<&mut Stmt>> {
    let Equations { begin, pass, finish, search, .. } = e;
    let parts = [begin, pass, finish].map(|p| p.iter_mut().flat_map(|s| &mut s.body).collect::<Vec<_>>());
    if search.is_some() { parts.into() } else { vec![parts.into_iter().flatten().collect()] }
}

/// The first place where a run would stop because a number overflows.
pub(crate) fn overflow(e: &Equations) -> Option<Span> {
    let mut found = None;
    for s in e.sections().flat_map(|s| &s.body) {
        s.visit(&mut |s| {
            if let Stmt::Fault(FaultKind::Overflow, at) = s {
                found.get_or_insert(*at);
            }
        });
    }
    found
}

/// Overflow and loops without end are the controller's matter.
fn left_to_the_controller(list: Vec<Stmt>) -> Vec<Stmt> {
    let left = |then: &[Stmt]| matches!(then, [Stmt::Fault(FaultKind::Overflow | FaultKind::Work, _)]);
    let kept = list.into_iter().filter_map(|s| match s {
        Stmt::If(_, then, other) if other.is_empty() && left(&then) => None,
        Stmt::If(c, a, b) => Some(Stmt::If(c, left_to_the_controller(a), left_to_the_controller(b))),
        Stmt::Loop(a) => Some(Stmt::Loop(left_to_the_controller(a))),
        other => Some(other),
    });
    kept.collect()
}

/// Drops what is set in these memories.
fn drop_writes(e: &mut Equations, of: &HashSet<MemoryId>) {
    for s in sections(e) {
        retain(&mut s.body, &mut |s| !matches!(s, Stmt::Set(m, _) if of.contains(m)));
        drop_empty(&mut s.body);
    }
}

/// That the scans have begun is set once, whatever else is done in the first
/// pass alone.
fn start_once(e: &mut Equations) {
    let Some(started) = e.find(What::Started) else { return };
    for s in sections(e) {
        let mut k = 0;
        while k < s.body.len() {
            let sets = |s: &Stmt| matches!(s, Stmt::Set(m, v) if *m == started && v.known() == Some(true));
            let mut found = None;
            if let Some(Stmt::If(_, then, _)) = s.body.get_mut(k)
                && let Some(at) = then.iter().position(sets)
                && !then.iter().skip(at).any(|s| reads(s, started))
            {
                found = Some(then.remove(at));
            }
            if let Some(set) = found {
                s.body.insert(k + 1, set);
            }
            k += 1;
        }
        drop_empty(&mut s.body);
    }
}

fn reads(s: &Stmt, memory: MemoryId) -> bool {
    let mut found = false;
    s.visit(&mut |s| s.expressions(&mut |e| found |= e.reads(memory)));
    found
}

/// Keeps the statements, at any depth, that are wanted.
fn retain(list: &mut Vec<Stmt>, wanted: &mut dyn FnMut(&Stmt) -> bool) {
    list.retain(|s| wanted(s));
    for s in list {
        match s {
            Stmt::If(_, a, b) => {
                retain(a, wanted);
                retain(b, wanted);
            }
            Stmt::Loop(a) => retain(a, wanted),
            _ => {}
        }
    }
}

/// Drops IFs that do nothing.
fn drop_empty(list: &mut Vec<Stmt>) {
    for s in list.iter_mut() {
        match s {
            Stmt::If(_, a, b) => {
                drop_empty(a);
                drop_empty(b);
            }
            Stmt::Loop(a) => drop_empty(a),
            _ => {}
        }
    }
    let nothing = |l: &[Stmt]| l.iter().all(|s| matches!(s, Stmt::About(_)));
    list.retain(|s| !matches!(s, Stmt::If(_, a, b) if nothing(a) && nothing(b)));
}

/// Drops what is set and never read, but for what users see.
fn drop_unread(e: &mut Equations, asked: fn(What) -> bool) {
    loop {
        let mut read: HashSet<MemoryId> = e.search.iter().map(|s| s.0).collect();
        for s in e.sections().flat_map(|s| &s.body) {
            s.visit(&mut |s| {
                s.expressions(&mut |x| {
                    x.visit(&mut |x| {
                        if let Expr::Read(m) | Expr::Element(m, _) = x {
                            // A memory that only hands itself on is not read by it.
                            if !matches!(s, Stmt::Set(to, _) if to == m) {
                                read.insert(*m);
                            }
                        }
                    });
                });
                if let Stmt::Call(_, list) = s {
                    read.extend(list);
                }
            });
        }
        let unread: HashSet<MemoryId> = (0u32..)
            .zip(&e.memories)
            .filter(|(_, m)| !(matches!(m.what, What::Variable(_) | What::Step(_)) || asked(m.what)))
            .map(|(i, _)| MemoryId(i))
            .filter(|m| !read.contains(m))
            .collect();
        let before: usize = e.sections().map(|s| count(&s.body)).sum();
        drop_writes(e, &unread);
        if e.sections().map(|s| count(&s.body)).sum::<usize>() == before {
            return;
        }
    }
}

fn count(list: &[Stmt]) -> usize {
    let mut n = 0;
    list.iter().for_each(|s| s.visit(&mut |_| n += 1));
    n
}

/// `m := FALSE; …; m := m OR e` is `m := e`, where nothing between reads `m`.
fn join_raises(list: &mut [&mut Stmt]) {
    let mut low: HashMap<MemoryId, usize> = HashMap::new();
    let mut drops = Vec::new();
    for (i, s) in list.iter_mut().enumerate() {
        match &mut **s {
            Stmt::If(_, a, b) => {
                join_raises(&mut a.iter_mut().collect::<Vec<_>>());
                join_raises(&mut b.iter_mut().collect::<Vec<_>>());
            }
            Stmt::Loop(a) => join_raises(&mut a.iter_mut().collect::<Vec<_>>()),
            _ => {}
        }
        if let Stmt::Set(m, e) = &mut **s {
            if let (Some(first), Some(raised)) = (low.get(m), raised(*m, e)) {
                drops.push(*first);
                *e = raised;
            }
            if e.known() == Some(false) {
                // One FALSE behind another: the first one goes.
                drops.extend(low.insert(*m, i));
                continue;
            }
        }
        for m in mentioned(s) {
            low.remove(&m);
        }
    }
    for i in drops {
        if let Some(s) = list.get_mut(i) {
            **s = Stmt::About(g7_equations::About::Nothing);
        }
    }
}

/// `e` of `m OR e`.
fn raised(m: MemoryId, e: &Expr) -> Option<Expr> {
    let Expr::Or(list) = e else { return None };
    let (first, rest) = list.split_first()?;
    let others = Expr::any(rest.iter().cloned());
    (*first == Expr::Read(m) && !others.reads(m)).then_some(others)
}

/// The memories that a statement reads or writes.
pub(crate) fn mentioned(s: &Stmt) -> BTreeSet<MemoryId> {
    let mut found = written(s);
    s.visit(&mut |s| s.expressions(&mut |e| found.extend(operands(e))));
    found
}

pub(crate) fn operands(e: &Expr) -> Vec<MemoryId> {
    let mut found = Vec::new();
    e.visit(&mut |e| {
        if let Expr::Read(m) | Expr::Element(m, _) = e {
            found.push(*m);
        }
    });
    found
}

pub(crate) fn written(s: &Stmt) -> BTreeSet<MemoryId> {
    let mut found = BTreeSet::new();
    s.visit(&mut |s| match s {
        Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => drop(found.insert(*m)),
        Stmt::Call(_, list) => found.extend(list),
        _ => {}
    });
    found
}

/// Values that stand where they are read: of memories that are set once and read
/// once (or cost nothing), while nothing that they are made of has changed.
fn in_place(e: &mut Equations) {
    let mut times: HashMap<MemoryId, (usize, usize)> = HashMap::new();
    for s in e.sections().flat_map(|s| &s.body) {
        s.visit(&mut |s| {
            match s {
                Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => times.entry(*m).or_default().0 += 1,
                // A call is more than one of each.
                Stmt::Call(_, list) => list.iter().for_each(|m| times.entry(*m).or_default().0 += 2),
                _ => {}
            }
            s.expressions(&mut |x| {
                for m in operands(x) {
                    times.entry(m).or_default().1 += 1;
                }
            });
        });
    }
    let has_clears: HashSet<u32> = e
        .memories
        .iter()
        .filter_map(|m| if let What::Clears(rank) = m.what { Some(rank) } else { None })
        .collect();
    let may = |m: MemoryId| {
        e.memory(m).is_some_and(|memory| {
            memory.class == Class::Scratch && memory.elements == 1 && is_small(memory.what, &has_clears)
        })
    };
    let once: HashMap<MemoryId, usize> =
        times.into_iter().filter(|(m, n)| n.0 == 1 && n.1 > 0 && may(*m)).map(|(m, n)| (m, n.1)).collect();
    let mut look = Look { once, ..Look::default() };
    for list in phases(e) {
        look.waiting.clear();
        look.all(list.iter().map(|s| &**s));
    }
    let Look { once, met, values, .. } = look;
    let found: HashMap<MemoryId, Expr> =
        values.into_iter().filter(|(m, _)| met.get(m) == once.get(m)).collect();
    for s in sections(e) {
        retain(&mut s.body, &mut |s| !matches!(s, Stmt::Set(m, _) if found.contains_key(m)));
        s.body.iter_mut().for_each(|s| put_in(s, &found));
        drop_empty(&mut s.body);
    }
}

/// Memories without a name of their own in the printed code.
fn is_small(what: What, has_clears: &HashSet<u32>) -> bool {
    match what {
        What::Clearable(rank) => has_clears.contains(&rank),
        What::Next(_)
        | What::On(_)
        | What::Off(_)
        | What::Was(_)
        | What::Temporary(_)
        | What::Watched(_)
        | What::Runs(_)
        | What::Begun(_)
        | What::GroupWas(_)
        | What::Imposes(_)
        | What::Disagree(_)
        | What::Given(_)
        | What::Own(_)
        | What::Control(..) => true,
        _ => false,
    }
}

/// Values on the way from where they are set to where they are read.
#[derive(Default)]
struct Look {
    /// How often each is read.
    once: HashMap<MemoryId, usize>,
    /// Those whose value still holds.
    waiting: HashMap<MemoryId, BTreeSet<MemoryId>>,
    /// By memory: the values that are made of it.
    made_of: HashMap<MemoryId, Vec<MemoryId>>,
    /// How often each was read while its value still held.
    met: HashMap<MemoryId, usize>,
    values: HashMap<MemoryId, Expr>,
}

impl Look {
    fn all<'s>(&mut self, list: impl Iterator<Item = &'s Stmt>) {
        let mut own = Vec::new();
        for s in list {
            self.stmt(s, &mut own);
        }
        for m in own {
            self.waiting.remove(&m);
        }
    }

    fn stmt(&mut self, s: &Stmt, own: &mut Vec<MemoryId>) {
        let mut of = BTreeSet::new();
        s.expressions(&mut |e| of.extend(operands(e).into_iter().collect::<Vec<_>>()));
        s.expressions(&mut |e| {
            for m in operands(e) {
                if self.waiting.contains_key(&m) {
                    *self.met.entry(m).or_default() += 1;
                }
            }
        });
        match s {
            Stmt::If(_, a, b) => {
                self.all(a.iter());
                self.all(b.iter());
            }
            Stmt::Loop(a) => {
                // A value that is read in a loop is read more than once.
                let outer = std::mem::take(&mut self.waiting);
                self.all(a.iter());
                self.waiting = outer;
                written(s).into_iter().for_each(|m| self.changes(m));
            }
            Stmt::Set(m, e) => {
                self.changes(*m);
                let free = |e: &Expr| match e {
                    Expr::Read(_) | Expr::Const(..) => true,
                    Expr::Not(e) => matches!(**e, Expr::Read(_)),
                    Expr::Convert(from, to, e) => widens(*from, *to) && matches!(**e, Expr::Read(_)),
                    _ => false,
                };
                let fits = self.once.get(m).is_some_and(|n| *n == 1 || free(e));
                if fits && !of.contains(m) {
                    let inner: Vec<MemoryId> =
                        of.iter().filter_map(|m| self.waiting.get(m)).flatten().copied().collect();
                    of.extend(inner);
                    for part in &of {
                        self.made_of.entry(*part).or_default().push(*m);
                    }
                    self.waiting.insert(*m, of);
                    self.values.insert(*m, e.clone());
                    own.push(*m);
                }
            }
            Stmt::SetElement(..) | Stmt::Call(..) => written(s).into_iter().for_each(|m| self.changes(m)),
            Stmt::Exit | Stmt::Fault(..) | Stmt::About(_) => {}
        }
    }

    fn changes(&mut self, m: MemoryId) {
        for value in self.made_of.remove(&m).unwrap_or_default() {
            if self.waiting.get(&value).is_some_and(|of| of.contains(&m)) {
                self.waiting.remove(&value);
            }
        }
    }
}

/// A conversion between integers that changes nothing.
pub(crate) fn widens(from: Type, to: Type) -> bool {
    let whole = |ty: Type| !ty.is_real() && !matches!(ty, Type::Bool | Type::Time | Type::String(_));
    whole(from) && whole(to) && !g7_compile::tree::narrows(from, to)
}

fn put_in(s: &mut Stmt, found: &HashMap<MemoryId, Expr>) {
    match s {
        Stmt::Set(_, e) => replace(e, found),
        Stmt::SetElement(_, i, e) => {
            replace(i, found);
            replace(e, found);
        }
        Stmt::If(e, a, b) => {
            replace(e, found);
            a.iter_mut().chain(b).for_each(|s| put_in(s, found));
        }
        Stmt::Loop(a) => a.iter_mut().for_each(|s| put_in(s, found)),
        Stmt::Exit | Stmt::Fault(..) | Stmt::Call(..) | Stmt::About(_) => {}
    }
}

fn replace(e: &mut Expr, found: &HashMap<MemoryId, Expr>) {
    let again = |e: Expr| {
        let mut e = e;
        replace(&mut e, found);
        e
    };
    match e {
        Expr::Read(m) => {
            if let Some(value) = found.get(m) {
                *e = again(value.clone());
            }
        }
        Expr::Const(..) | Expr::Text(_) => {}
        Expr::Not(x) => *e = again(std::mem::replace(&mut **x, Expr::truth(false))).negated(),
        Expr::And(list) => *e = Expr::all(std::mem::take(list).into_iter().map(again)),
        Expr::Or(list) => *e = Expr::any(std::mem::take(list).into_iter().map(again)),
        Expr::Element(_, x)
        | Expr::Neg(_, x)
        | Expr::Convert(_, _, x)
        | Expr::Trunc(_, _, x)
        | Expr::Random(x)
        | Expr::Fails(x) => replace(x, found),
        Expr::Call(_, _, list) => list.iter_mut().for_each(|e| replace(e, found)),
        Expr::Xor(a, b) | Expr::Arith(_, _, a, b) | Expr::Compare(_, _, a, b) | Expr::Differs(_, a, b) => {
            replace(a, found);
            replace(b, found);
        }
    }
}
