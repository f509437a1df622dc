//! The equations of a scan as statements of IEC 61131-3: the one translation that
//! Structured Text, Instruction List and Ladder are printed from.
//!
//! - The time since the scan before comes from a standard timer that runs on.
//! - A fault sets FAULT; what follows in the scan stands in a part of its own, or
//!   in the ELSE of the question, and does not run.

use std::collections::HashSet;

use g7_compile::Compiled;
use g7_engine::Block as Kind;
use g7_equations::{About, Equations, Expr, MemoryId, Section, Stmt, What};
use g7_model::{Nanos, Problem, Said, Span, Type, codes, say};

use super::dialect::Dialect;
use super::form::{Block, Ex, St, narrow};
use super::memories::{Memories, literal};
use super::native;
use super::shared;
use super::signals::signals;
use crate::spare;

/// Passes of a scan that every chart may have, and those that none may have: at 0.1 ms a pass
/// the latter take 100 ms, which the watchdogs of most controllers allow. The program's own bound may
/// be less.
const PASSES: (u32, u32) = (100, 1000);
/// Passes for each transition, between these two: a search that ends clears few of them twice.
const PASSES_EACH: u32 = 4;
/// Elements up to which a table is copied one by one.
const LONG: u32 = 256;

/// A scan in translation.
pub(super) struct Scan<'a> {
    c: &'a Compiled,
    pub(super) e: &'a Equations,
    pub(super) memories: Memories,
    source: &'a str,
    /// The place of what is translated.
    at: Span,
    dialect: Dialect,
    faults: bool,
    /// Comments for the head of the block.
    notes: Vec<String>,
    pub(super) problems: Vec<Problem>,
}

/// The block that a chart is printed as, the names of its memories, and what
/// cannot be printed.
pub(super) fn block(
    c: &Compiled,
    name: &str,
    source: &str,
    dialect: Dialect,
) -> (Block, Memories, Vec<Problem>) {
    let options = g7_equations::Options { receptivities: dialect.set_reset, ..Default::default() };
    let mut e = g7_equations::equations(c, options);
    let overflow = spare::overflow(&e).map(|at| {
        let text = say!(
            "arithmetic that overflows is a fault of a run here; a controller goes on as its maker decided"
        );
        Problem::new(&codes::DIFFERENT, at, text)
    });
    let signals = signals(c, &e);
    let inside = native::native(&mut e, dialect.own_blocks);
    spare::spare_for_controllers(&mut e, &inside);
    let calls = first_of_calls(&e);
    let (name, memories) = Memories::new(c, &e, name, &calls, (signals, dialect.longest));
    let at = c.symbols.charts.first().map(|c| c.at).unwrap_or_default();
    let mut s = Scan {
        c,
        e: &e,
        memories,
        source,
        at,
        dialect,
        faults: false,
        notes: Vec::new(),
        problems: Vec::new(),
    };
    let parts = s.parts();
    let memories = &mut s.memories;
    let parts = parts.into_iter().map(|part| shared::once(part, &mut || memories.any())).collect();
    let safe = s.faults.then(|| s.safe());
    if s.faults {
        s.memories.internal("FAULT", "BOOL", "a fault has come: no further scan");
    }
    let mut variables = std::mem::take(&mut s.memories.declared);
    variables.sort_by_key(|v| v.class);
    let Scan { memories, notes, mut problems, .. } = s;
    problems.extend(overflow);
    (Block { name, notes, variables, parts, safe }, memories, problems)
}

fn first_of_calls(e: &Equations) -> HashSet<MemoryId> {
    let mut found = HashSet::new();
    for s in e.sections().flat_map(|s| &s.body) {
        s.visit(&mut |s| {
            if let Stmt::Call(_, list) = s {
                found.extend(list.first());
            }
        });
    }
    found
}

impl Scan<'_> {
    pub(super) fn cannot(&mut self, what: Said) {
        let text = say!("{what} cannot be printed as equations for a PLC");
        if self.problems.iter().all(|p| *p.what != *text) {
            self.problems.push(Problem::new(&codes::NOT_CARRIED, self.at, text));
        }
    }

    /// The parts of a scan; each but the last ends where a fault can come.
    fn parts(&mut self) -> Vec<Vec<St>> {
        let e = self.e;
        let mut all = self.clock();
        all.extend(self.sections(&e.begin));
        match e.search {
            None => all.extend(self.sections(&e.pass)),
            Some((changed, bound)) => all.extend(self.search(changed, bound)),
        }
        all.extend(self.sections(&e.finish));
        let mut parts = cut(without_lone_remarks(all));
        parts.retain(|part| !part.is_empty());
        parts
    }

    /// Passes until one changes nothing.
    fn search(&mut self, changed: MemoryId, bound: u32) -> Vec<St> {
        let e = self.e;
        self.faults = true;
        self.memories.internal("PASSES", "DINT", "passes in this scan");
        let changed = Ex::var(self.memories.name(changed));
        let passes = Ex::var("PASSES");
        let mut body = vec![St::set("PASSES", Ex::op("+", passes.clone(), Ex::Int(1)))];
        body.extend(self.sections(&e.pass));
        let body = in_parts(without_lone_remarks(body));
        let transitions = u32::try_from(self.c.program.tables().transitions.len()).unwrap_or(u32::MAX);
        let bound = bound.min(transitions.saturating_mul(PASSES_EACH).clamp(PASSES.0, PASSES.1));
        self.notes.push(format!(
            "A scan makes passes until nothing changes, at most {bound}; a scan that needs more is a fault. \
             The watchdog has to allow for so many."
        ));
        let most = Ex::op(">=", passes, Ex::Int(bound.into()));
        let done = Ex::any([Ex::var("FAULT"), changed.clone().not(), most]);
        vec![
            St::Title("The evolution, until nothing changes".into()),
            St::set("PASSES", Ex::Int(0)),
            St::Until(body, done),
            St::If(changed, vec![St::set("FAULT", Ex::Bool(true))], Vec::new()),
        ]
    }

    /// The time since the scan before, where something reads it.
    fn clock(&mut self) -> Vec<St> {
        let read = self.memories.find(What::Dt).is_some_and(|m| !self.memories.name(m).is_empty());
        if !read {
            return Vec::new();
        }
        self.memories.internal("CLOCK", "TON", "gives the time");
        self.memories.internal("LAST", "TIME", "time of the scan before");
        let long = Ex::Time(Nanos::DAY * 20);
        let call = |on: bool| {
            St::Call("CLOCK".into(), vec![("IN".into(), Ex::Bool(on)), ("PT".into(), long.clone())])
        };
        let time = Ex::var("CLOCK.ET");
        let over = Ex::op(">=", Ex::var("LAST"), Ex::Time(Nanos::HOUR));
        let anew = vec![St::set("LAST", Ex::Time(Nanos::ZERO)), call(false), call(true)];
        vec![
            St::Title("A timer that runs on gives the time; it begins anew each hour".into()),
            call(true),
            St::set("SCAN_TIME", Ex::op("-", time.clone(), Ex::var("LAST"))),
            St::set("LAST", time),
            St::If(over, anew, Vec::new()),
        ]
    }

    fn sections(&mut self, list: &[Section]) -> Vec<St> {
        let mut out = Vec::new();
        for s in list {
            out.push(St::Title(s.title.to_owned()));
            out.extend(self.list(&s.body));
        }
        out
    }

    fn list(&mut self, list: &[Stmt]) -> Vec<St> {
        let mut out = Vec::new();
        let mut k = 0;
        while let Some(s) = list.get(k) {
            let turned =
                if self.dialect.set_reset { self.turns(list.get(k..).unwrap_or_default()) } else { None };
            if let Some((n, all)) = turned {
                out.extend(all);
                k += n;
                continue;
            }
            self.stmt(s, &mut out);
            k += 1;
        }
        out
    }

    fn stmt(&mut self, s: &Stmt, out: &mut Vec<St>) {
        match s {
            Stmt::About(about) => {
                let note = self.note(*about);
                if !note.is_empty() {
                    out.push(St::Note(note));
                }
            }
            Stmt::Set(m, e) => self.set(*m, e, out),
            Stmt::SetElement(m, index, e) => {
                let index = narrow(self.ex(index));
                let place = Ex::Index(self.memories.name(*m).to_owned(), Box::new(index));
                let ty = self.e.memory(*m).map_or(Type::Bool, |m| m.ty);
                out.push(St::Assign(place, self.ex_as(ty, e)));
            }
            Stmt::If(c, a, b) => {
                let c = self.ex(c);
                let (a, b) = (self.inner(a), self.inner(b));
                let bare = |l: &[St]| l.iter().all(St::is_remark);
                match (c, bare(&a), bare(&b)) {
                    (_, true, true) => {}
                    (Ex::Bool(true), ..) => out.extend(a),
                    (Ex::Bool(false), ..) => out.extend(b),
                    (c, true, false) => out.push(St::If(c.not(), b, Vec::new())),
                    (c, false, true) => out.push(St::If(c, a, Vec::new())),
                    (c, ..) => out.push(St::If(c, a, b)),
                }
            }
            Stmt::Loop(a) => {
                let a = self.list(a);
                out.push(St::Loop(leaving(without_lone_remarks(a))));
            }
            Stmt::Exit => out.push(St::Exit),
            Stmt::Fault(..) => {
                self.faults = true;
                out.push(St::set("FAULT", Ex::Bool(true)));
            }
            Stmt::Call(kind, list) => self.instance(*kind, list, out),
        }
    }

    /// Statements under a condition: behind one that may be a fault the others wait.
    fn inner(&mut self, list: &[Stmt]) -> Vec<St> {
        let list = self.list(list);
        guarded(without_lone_remarks(list))
    }

    fn set(&mut self, m: MemoryId, e: &Expr, out: &mut Vec<St>) {
        let Some(memory) = self.e.memory(m) else { return };
        let name = self.memories.name(m).to_owned();
        match memory.what {
            What::Started => return out.push(St::set(name, Ex::Bool(e.known() == Some(false)))),
            What::Until(_) if is_period(e) => return self.next_period(&name, e, out),
            _ => {}
        }
        if matches!(memory.ty, Type::String(_)) {
            return self.cannot(say!("a text"));
        }
        if let (Some(n), Expr::Read(from)) = (self.elements(m), e) {
            let from = self.memories.name(*from).to_owned();
            if n > LONG {
                self.cannot(say!("a table of more than 256 elements that actions change at one moment"));
            }
            let at = |name: &str, i: u32| Ex::Index(name.to_owned(), Box::new(Ex::Int(i.into())));
            out.extend((0..n.min(LONG)).map(|i| St::Assign(at(&name, i), at(&from, i))));
            return;
        }
        if let Expr::Or(list) = e
            && let Some((first, rest)) = list.split_first()
            && *first == Expr::Read(m)
        {
            let when = self.ex(&Expr::any(rest.iter().cloned()));
            return out.extend(St::when(when, vec![St::set(name, Ex::Bool(true))]));
        }
        let value = self.ex_as(memory.ty, e);
        out.push(St::set(name, value));
    }

    /// How many elements a table has.
    pub(super) fn elements(&self, m: MemoryId) -> Option<u32> {
        self.e.memory(m).map(|m| m.elements).filter(|n| *n > 1)
    }

    /// The next instant of a period that lies ahead; those missed are skipped.
    fn next_period(&mut self, name: &str, e: &Expr, out: &mut Vec<St>) {
        let mut period = None;
        e.visit(&mut |e| {
            if let Expr::Arith(g7_engine::Arith::Mul, Type::Lint, _, by) = e
                && let Expr::Const(_, n) = **by
            {
                period = Some(Nanos::new(n as i64));
            }
        });
        let Some(period) = period else { return };
        let waits = Ex::op(">", Ex::var(name), Ex::Time(Nanos::ZERO));
        let more = St::set(name, Ex::op("+", Ex::var(name), Ex::Time(period)));
        out.push(St::Loop(vec![St::If(waits, vec![St::Exit], Vec::new()), more]));
    }

    /// The call of an instance: the assignments to its inputs just before become
    /// part of it.
    fn instance(&mut self, kind: Kind, list: &[MemoryId], out: &mut Vec<St>) {
        let first = list.first().map_or("", |m| self.memories.name(*m));
        let Some((instance, _)) = first.split_once('.') else {
            return self.cannot(say!("a function block of this kind"));
        };
        let (instance, head) = (instance.to_owned(), format!("{instance}."));
        let mut inputs = Vec::new();
        while let Some(St::Assign(Ex::Var(to), _)) = out.last()
            && let Some(member) = to.strip_prefix(&head).map(str::to_owned)
            && list.len() >= native::members(kind)
            && let Some(St::Assign(_, e)) = out.pop()
        {
            inputs.insert(0, (member, e));
        }
        out.push(St::Call(instance, inputs));
    }

    /// In the manner of DOLOG80: steps one behind the other are reset and set, all
    /// that are set behind all that are reset. How many statements these were.
    fn turns(&mut self, list: &[Stmt]) -> Option<(usize, Vec<St>)> {
        let (mut copies, mut resets, mut sets) = (Vec::new(), Vec::new(), Vec::new());
        let (mut n, mut about) = (0, None);
        for (k, s) in list.iter().enumerate() {
            match s {
                Stmt::About(a @ About::Step(_)) => about = Some(*a),
                Stmt::Set(m, e) => {
                    let Some((step, on, off)) = self.turn(*m, e) else { break };
                    let name = self.memories.name(*m).to_owned();
                    if step != *m {
                        copies.push(St::set(name.clone(), Ex::var(self.memories.name(step))));
                    }
                    let note = about.take().map(|a| self.note(a)).unwrap_or_default();
                    for (when, on, word) in [(off, false, "off"), (on, true, "on")] {
                        let then = St::when(self.ex(&when), vec![St::set(name.clone(), Ex::Bool(on))]);
                        let to = if on { &mut sets } else { &mut resets };
                        if !then.is_empty() && !note.is_empty() {
                            to.push(St::Note(format!("{note} {word}")));
                        }
                        to.extend(then);
                    }
                    n = k + 1;
                }
                _ => break,
            }
        }
        copies.extend(resets);
        copies.extend(sets);
        (n > 0).then_some((n, copies))
    }

    /// The conditions that set and reset the step that `m` is, or will be.
    fn turn(&self, m: MemoryId, e: &Expr) -> Option<(MemoryId, Expr, Expr)> {
        let step = match self.e.memory(m)?.what {
            What::Step(_) => m,
            What::Next(s) => self.memories.find(What::Step(s))?,
            _ => return None,
        };
        let own = Expr::Read(step);
        let parts: &[Expr] = match e {
            Expr::Or(list) => list,
            one => std::slice::from_ref(one),
        };
        let (last, on) = parts.split_last()?;
        let off = match last {
            e if *e == own => Expr::truth(false),
            Expr::And(list) if list.first() == Some(&own) => {
                Expr::all(list.iter().skip(1).cloned()).negated()
            }
            _ => return None,
        };
        let on = Expr::any(on.iter().cloned());
        (!on.reads(step) && !off.reads(step)).then_some((step, on, off))
    }

    /// The safe values of the outputs.
    fn safe(&mut self) -> Vec<St> {
        let mut list = Vec::new();
        for (m, words) in &self.e.safe {
            let Some(memory) = self.e.memory(*m) else { continue };
            if matches!(memory.ty, Type::String(_)) {
                continue;
            }
            let name = self.memories.name(*m);
            if name.is_empty() || name.contains('.') {
                continue; // nothing uses it, or the controller's block holds it
            }
            for (i, word) in words.iter().enumerate() {
                let place = match memory.elements {
                    1 => Ex::var(name),
                    _ => Ex::Index(name.to_owned(), Box::new(Ex::Int(i as i128))),
                };
                list.push(St::Assign(place, literal(memory.ty, *word)));
            }
        }
        list
    }

    /// The comment that a statement gets, from the chart's text; what follows is
    /// at this place of it.
    fn note(&mut self, about: About) -> String {
        let symbols = &self.c.symbols;
        let t = self.c.program.tables();
        let (at, text) = match about {
            About::Nothing => (Span::default(), String::new()),
            About::Step(s) => (symbols.step_place(s), format!("step {}", symbols.step_path(s))),
            About::Transition(rank) => {
                let at = symbols.transition_place(rank);
                let text = self.text(at);
                let written = symbols.is_written(rank) && !text.is_empty();
                (at, if written { text } else { symbols.transition_text(rank).to_owned() })
            }
            About::Action(a) => {
                let at = symbols.actions.get(a as usize).map(|a| a.at).unwrap_or_default();
                (at, self.text(at))
            }
            About::Block(b) => match symbols.blocks.get(b as usize) {
                Some(b) if b.name.is_empty() => (b.at, self.text(b.at)),
                Some(b) => (b.at, b.name.to_string()),
                None => (Span::default(), String::new()),
            },
            About::Watch(w) => {
                let code = t.watches.get(w.0 as usize).map(|w| w.code.start);
                let at = code.map(|at| symbols.place(at)).unwrap_or_default();
                (at, self.text(at))
            }
            About::Order(o) => match t.orders.get(o as usize) {
                Some(o) => {
                    (symbols.step_place(o.step), format!("order of step {}", symbols.step_path(o.step)))
                }
                None => (Span::default(), String::new()),
            },
        };
        if at.start < at.end {
            self.at = at;
        }
        text
    }

    /// A piece of the chart's text on one line.
    fn text(&self, span: Span) -> String {
        let text = self.source.get(span.start as usize..span.end as usize).unwrap_or("");
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        match line.char_indices().nth(100) {
            Some((i, _)) => format!("{} …", line.get(..i).unwrap_or("")),
            None => line,
        }
    }
}

/// The time until a period is due, worked out as a number.
fn is_period(e: &Expr) -> bool {
    let mut found = false;
    e.visit(&mut |e| found |= matches!(e, Expr::Convert(Type::Lint, Type::Time, _)));
    found
}

/// A statement behind which FAULT can be TRUE.
fn may_fault(s: &St) -> bool {
    match s {
        St::Assign(Ex::Var(name), e) => name == "FAULT" && *e != Ex::Bool(false),
        St::If(_, a, b) => a.iter().chain(b).any(may_fault),
        St::Loop(a) | St::Until(a, _) => a.iter().any(may_fault),
        St::Assign(..) | St::Title(_) | St::Note(_) | St::Exit | St::Call(..) => false,
    }
}

/// Parts that end with a statement behind which FAULT can be TRUE.
fn cut(list: Vec<St>) -> Vec<Vec<St>> {
    let mut parts = vec![Vec::new()];
    for s in list {
        let ends = may_fault(&s);
        if let Some(part) = parts.last_mut() {
            part.push(s);
        }
        if ends {
            parts.push(Vec::new());
        }
    }
    parts
}

/// The same as one list: each part runs only while no fault has come.
fn in_parts(list: Vec<St>) -> Vec<St> {
    let mut parts = cut(list).into_iter();
    let mut out = parts.next().unwrap_or_default();
    for part in parts.filter(|part| !part.is_empty()) {
        out.push(St::If(Ex::var("FAULT").not(), part, Vec::new()));
    }
    out
}

/// A list in which nothing runs behind a fault.
fn guarded(list: Vec<St>) -> Vec<St> {
    let mut parts = cut(list).into_iter().rev();
    let mut rest = parts.next().unwrap_or_default();
    for mut part in parts {
        let bare = rest.iter().all(St::is_remark);
        match part.pop() {
            // The fault of a question itself: the others are its ELSE.
            Some(St::If(c, then, other)) if other.is_empty() && !bare && is_fault(&then) => {
                part.push(St::If(c, then, rest));
            }
            last => {
                part.extend(last);
                if !bare {
                    part.push(St::If(Ex::var("FAULT").not(), rest, Vec::new()));
                }
            }
        }
        rest = part;
    }
    rest
}

fn is_fault(list: &[St]) -> bool {
    matches!(list, [St::Assign(Ex::Var(name), Ex::Bool(true))] if name == "FAULT")
}

/// A repeated list that is left where a fault has come.
fn leaving(list: Vec<St>) -> Vec<St> {
    let mut out = Vec::new();
    let parts = cut(list);
    let last = parts.len().saturating_sub(1);
    for (i, part) in parts.into_iter().enumerate() {
        out.extend(part);
        if i < last {
            out.push(St::If(Ex::var("FAULT"), vec![St::Exit], Vec::new()));
        }
    }
    out
}

/// Titles and comments that stand before nothing are left out.
fn without_lone_remarks(list: Vec<St>) -> Vec<St> {
    let mut out: Vec<St> = Vec::new();
    let (mut title, mut note) = (None, None);
    for s in list {
        match s {
            St::Title(text) => {
                title = Some(text);
                note = None;
            }
            St::Note(text) => note = Some(text),
            s => {
                out.extend(title.take().map(St::Title));
                out.extend(note.take().map(St::Note));
                out.push(s);
            }
        }
    }
    out
}
