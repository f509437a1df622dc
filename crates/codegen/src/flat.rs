//! The equations of a chart as code: the flat style.
//!
//! ```text
//! Equations -> spare (less to read) -> a function for each section -> tree
//! ```
//!
//! # Invariants
//!
//! - Nothing is decided here: each function says what its section says.
//! - A memory that only one function mentions, and that does not last, is a name of
//!   that function; all others are fields of `m` (they last) or `w` (they do not).

use std::collections::{BTreeMap, HashMap};

use g7_engine::{Addr, Num, StepId};
use g7_equations::{
    About, Class, Equations, Memory, MemoryId, Options, Section, StepTimes, Stmt as Line, What,
};
use g7_model::{Said, Type, say};

use crate::body::{self, Home, Places};
use crate::build::{Gen, s, state};
use crate::operations::Needs;
use crate::roll::roll;
use crate::runtime;
use crate::spare::{self, spare};
use crate::tree::{Bin, Block, Expr, Field, Stmt, Struct, Ty};
use crate::turns::turned;
use crate::vars::{self, Shape, members, num};

/// Statements up to which a section is one function: compilers take more than their
/// share of time for longer ones.
const LONG: usize = 400;

/// Prints the equations of a chart into the module at hand.
pub(crate) fn flat(g: &mut Gen<'_>) {
    let mut e = g7_equations::equations(g.c, Options { times: StepTimes::Stamps, ..Options::default() });
    // Function blocks are assignments here: their clocks are relative.
    for section in spare::sections(&mut e) {
        section.body = spare::expanded(std::mem::take(&mut section.body), &|_| false);
    }
    turned(&mut e);
    spare(&mut e, |what| matches!(what, What::Stamp(_) | What::Clock));
    let phases = [
        ("sections_before", "Before the passes.", std::mem::take(&mut e.begin)),
        ("sections_of_pass", "A pass.", std::mem::take(&mut e.pass)),
        ("sections_behind", "Behind the passes.", std::mem::take(&mut e.finish)),
    ];
    let phases = phases.map(|(name, note, sections)| (name, note, pieces(sections)));
    let mut f = Flat {
        locals: locals(&e, &phases),
        g,
        e,
        fields: BTreeMap::new(),
        beside: HashMap::new(),
        rows: HashMap::new(),
    };
    for (name, note, pieces) in &phases {
        f.phase(name, note, pieces);
    }
    f.structures();
    f.g.facts.times_apart = false;
    let (structs, functions) = runtime::flat(&f.g.facts);
    f.g.m.structs.extend(structs);
    f.g.m.functions.extend(functions);
}

/// A part of a section that is a function of its own.
struct Piece {
    title: &'static str,
    body: Vec<Line>,
}

/// The sections, the long ones in parts.
fn pieces(sections: Vec<Section>) -> Vec<Piece> {
    let mut all = Vec::new();
    for section in sections {
        let mut body = Vec::new();
        let mut size = 0;
        for line in section.body {
            let mut length = 0;
            line.visit(&mut |_| length += 1);
            // A note stays with what it is about.
            if size + length > LONG && !matches!(body.last(), Some(Line::About(_))) {
                all.push(Piece { title: section.title, body: std::mem::take(&mut body) });
                size = 0;
            }
            size += length;
            body.push(line);
        }
        all.push(Piece { title: section.title, body });
    }
    all.retain(|p| p.body.iter().any(|l| !matches!(l, Line::About(_))));
    all
}

type Phases = [(&'static str, &'static str, Vec<Piece>); 3];

/// By memory that does not last: it is mentioned in one function alone.
fn locals(e: &Equations, phases: &Phases) -> Vec<bool> {
    let mut home: Vec<Option<usize>> = vec![None; e.memories.len()];
    let mut shared = vec![false; e.memories.len()];
    let pieces = phases.iter().flat_map(|p| &p.2);
    for (k, piece) in pieces.enumerate() {
        let mut note = |m: MemoryId| {
            let at = m.0 as usize;
            if let (Some(home), Some(shared)) = (home.get_mut(at), shared.get_mut(at)) {
                *shared |= home.is_some_and(|other| other != k);
                *home = Some(k);
            }
        };
        for line in &piece.body {
            spare::mentioned(line).into_iter().for_each(&mut note);
        }
    }
    let lasts = |m: &Memory| m.class != Class::Scratch || m.elements > 1;
    let changed = e.search.map(|s| s.0.0 as usize);
    let one = |(i, m): (usize, &Memory)| !lasts(m) && shared.get(i) == Some(&false) && changed != Some(i);
    e.memories.iter().enumerate().map(one).collect()
}

/// A field of `m` or `w`: its type, and how many there are of it (none: it is one).
struct Row {
    ty: Ty,
    count: Option<usize>,
}

/// Where a memory is found among those of its kind.
enum Place {
    /// By its step.
    Step(StepId),
    /// By its transition.
    Transition(u32),
    /// By its number in the equations.
    Number(u32),
    /// It is the only one.
    Alone,
}

struct Flat<'g, 'a> {
    g: &'g mut Gen<'a>,
    e: Equations,
    locals: Vec<bool>,
    /// By structure (`m` or `w`) and field.
    fields: BTreeMap<(&'static str, String), Row>,
    /// The names of memories that stand beside variables.
    beside: HashMap<MemoryId, String>,
    /// The values of names that stand for rows.
    rows: HashMap<String, usize>,
}

impl Flat<'_, '_> {
    /// A function for each part, and one that calls them in order.
    fn phase(&mut self, name: &str, note: &str, pieces: &[Piece]) {
        let mut calls = Block::new();
        for piece in pieces {
            let made = body::translate(self, &piece.body, None);
            let rows = &self.rows;
            let number = |name: &str| rows.get(name).copied();
            let block = rolled(without_empty_notes(made.block), &number);
            let function = self.g.names.small(piece.title);
            calls.push(Stmt::Do(Expr::call(function.clone(), vec![s()])));
            if made.fails {
                let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                calls.push(Stmt::If(fault, vec![Stmt::Return(None)], Vec::new()));
            }
            self.g.function(&function, &format!("{}.", piece.title), vec![state()], block);
        }
        self.g.function(name, note, vec![state()], calls);
    }

    /// The structures `Memory` and `Work`, and those of function blocks.
    fn structures(&mut self) {
        for (of, name, note) in [
            ("m", "Memory", "The memories that last from scan to scan, beside the variables."),
            ("w", "Work", "The memories that are worked out in each scan anew."),
        ] {
            let mut fields: Vec<Field> = Vec::new();
            for ((_, field), row) in self.fields.iter().filter(|((at, _), _)| *at == of) {
                let ty = match row.count {
                    Some(n) => Ty::Array(Box::new(row.ty.clone()), n),
                    None => row.ty.clone(),
                };
                fields.push(Field { name: field.clone(), ty, note: explained(field).into(), kept: false });
            }
            self.g.m.structs.push(Struct { public: true, note: note.into(), name: name.into(), fields });
        }
        let kinds: BTreeMap<&str, g7_model::FbKind> = self
            .g
            .vars
            .slots
            .values()
            .filter_map(|slot| match slot.shape {
                Shape::Fb(kind) => Some((vars::block_names(kind).0, kind)),
                _ => None,
            })
            .collect();
        for (name, kind) in kinds {
            let fields = members(kind).iter().map(|(field, n)| Field {
                name: member(field).into(),
                ty: vars::ty(*n),
                note: String::new(),
                kept: true,
            });
            let fields = fields.collect();
            self.g.m.structs.push(Struct { public: true, note: String::new(), name: name.into(), fields });
        }
    }

    fn field(&mut self, of: &'static str, field: String, ty: Type, place: Place) -> Home {
        let (index, least) = match place {
            Place::Step(step) => (Some(self.g.step(step)), self.g.t.steps.len()),
            Place::Transition(rank) => (Some(self.g.transition(rank)), self.g.t.transitions.len()),
            Place::Number(n) => (Some(Expr::size(n as usize)), n as usize + 1),
            Place::Alone => (None, 0),
        };
        if let (Some(Expr::Name(name)), Place::Step(StepId(n)) | Place::Transition(n)) = (&index, &place) {
            self.rows.insert(name.clone(), *n as usize);
        }
        let text = match ty {
            Type::String(cap) => Some(cap),
            _ => None,
        };
        let n = num(ty).unwrap_or(Num::I64);
        let ty = match text {
            Some(cap) => Ty::Array(Box::new(Ty::U8), usize::from(cap) + 2),
            None => vars::ty(n),
        };
        let row = self
            .fields
            .entry((of, field.clone()))
            .or_insert_with(|| Row { ty, count: index.as_ref().map(|_| 0) });
        row.count = row.count.map(|c| c.max(least));
        let place = s().field(of).field(field);
        let place = match index {
            Some(i) => place.at(i),
            None => place,
        };
        match text {
            Some(cap) => Home::Text(place, cap),
            None => Home::Number(place, n),
        }
    }

    /// The name of the variable that a memory is, or stands beside.
    fn name_of(&mut self, m: MemoryId) -> String {
        match self.variable(m) {
            Some((slot, Some(part))) => format!("{}_{part}", slot.field),
            Some((slot, None)) => slot.field,
            None => format!("memory_{}", m.0),
        }
    }

    /// The name of a memory that stands beside a variable.
    fn name_beside(&mut self, id: MemoryId, of: MemoryId, what: What) -> String {
        if let Some(name) = self.beside.get(&id) {
            return name.clone();
        }
        let name = self.name_of(of);
        let name = self.g.names.small(&match what {
            What::Own(_) => format!("own_{name}"),
            What::Given(_) => format!("next_{name}"),
            What::Begun(_) => format!("begun_{name}"),
            What::OwnWrote(_) => format!("own_{name}_set"),
            _ => format!("next_{name}_set"),
        });
        self.beside.insert(id, name.clone());
        name
    }

    /// The slot of a variable, and which of its members it is.
    fn variable(&mut self, m: MemoryId) -> Option<(vars::Slot, Option<&'static str>)> {
        let memory = self.e.memory(m)?.clone();
        let addr = match memory.what {
            What::Variable(Addr(addr)) => addr,
            What::BlockClock(Addr(base)) => base + CLOCK,
            _ => return None,
        };
        self.g.vars.reveal(addr, &memory, &mut self.g.names);
        let slot = self.g.vars.slot(addr)?.clone();
        let part = match slot.shape {
            Shape::Fb(kind) => members(kind).get((addr - slot.start) as usize).map(|m| m.0),
            _ => None,
        };
        Some((slot, part))
    }

    fn variable_home(&mut self, m: MemoryId) -> Home {
        let ty = self.e.memory(m).map_or(Type::Bool, |m| m.ty);
        match self.variable(m) {
            Some((slot, Some(part))) => {
                let kind = if let Shape::Fb(kind) = slot.shape { Some(kind) } else { None };
                let n = kind.and_then(|k| members(k).iter().find(|m| m.0 == part)).map_or(Num::I64, |m| m.1);
                Home::Number(slot.place().field(member(part)), n)
            }
            Some((slot, None)) => match slot.shape {
                Shape::One(n) => Home::Number(slot.place(), n),
                Shape::Text(cap) => Home::Text(slot.place(), cap),
                Shape::Many(n, _) => Home::Table(slot.place(), n),
                Shape::Texts(..) | Shape::Fb(_) => {
                    self.cannot(say!("a table of texts or of function blocks"));
                    Home::Number(Expr::Bool(false), Num::Bool)
                }
            },
            None => Home::Number(Expr::Bool(false), num(ty).unwrap_or(Num::Bool)),
        }
    }
}

/// The word of a timer block that is its clock here.
const CLOCK: u32 = 4;

/// The name of a function block's member: where the engine keeps when a timer
/// started, the equations keep the time since.
fn member(name: &'static str) -> &'static str {
    if name == "start" { "clock" } else { name }
}

/// The meaning of a field, where its name does not say it all.
fn explained(field: &str) -> &'static str {
    match field {
        "x" => "the step memories",
        "clock" => "time since the start (scans under the scan clock)",
        "stamp" => "of an active step, the clock at its activation; else how long it was active",
        "clearable" => "enabled, and the receptivity true",
        "clears" => "with nothing better in the way",
        "next" => "the situation to come",
        _ => "",
    }
}

/// A kind of memory: its field, and the place among those of its kind.
fn kind(what: What) -> Option<(&'static str, Place)> {
    use Place::{Alone, Number, Step, Transition};
    Some(match what {
        What::Opening => ("opening", Alone),
        What::Stepped => ("stepped", Alone),
        What::Work => ("work", Alone),
        What::Step(step) => ("x", Step(step)),
        What::Next(step) => ("next", Step(step)),
        What::Was(step) => ("was", Step(step)),
        What::On(step) => ("on", Step(step)),
        What::Off(step) => ("off", Step(step)),
        What::Left(step) => ("left", Step(step)),
        What::Came(step) => ("came", Step(step)),
        // A step has a stamp for the one kind of time; only the other kind has clocks.
        What::StepTime(step) => ("age", Step(step)),
        What::StepScans(step) => ("scans", Step(step)),
        What::Clock => ("clock", Alone),
        What::Stamp(step) => ("stamp", Step(step)),
        What::Settled(step) => ("settled", Step(step)),
        What::Taken(step) => ("taken", Step(step)),
        What::RequestSet(step) => ("ask_set", Step(step)),
        What::RequestReset(step) => ("ask_reset", Step(step)),
        What::GroupWas(g) => ("group_was", Number(g.0)),
        What::GroupTime(g) => ("group_time", Number(g.0)),
        What::GroupScans(g) => ("group_scans", Number(g.0)),
        What::RequestInit(g) => ("ask_init", Number(g.0)),
        What::RequestClear(g) => ("ask_clear", Number(g.0)),
        What::RequestStart => ("ask_start", Alone),
        What::Watched(w) => ("watched", Number(w.0)),
        What::WatchedBefore(w) => ("watched_before", Number(w.0)),
        What::Rise(w) => ("rise", Number(w.0)),
        What::Fall(w) => ("fall", Number(w.0)),
        What::Timer(w) => ("timer", Number(w.0)),
        What::TimerClock(w) => ("timer_clock", Number(w.0)),
        What::Until(p) => ("until", Number(p)),
        What::Due(p) => ("due", Number(p)),
        What::Receptivity(rank) => ("receptivity", Transition(rank)),
        What::Clearable(rank) => ("clearable", Transition(rank)),
        What::Clears(rank) => ("clears", Transition(rank)),
        What::Enabled(rank) => ("enabled", Transition(rank)),
        What::Blocked(chart) => ("blocked", Number(chart)),
        What::Asks(o) => ("asks", Number(o)),
        What::Imposes(o) => ("imposes", Number(o)),
        What::Disagree(o) => ("disagree", Number(o)),
        What::Runs(a) => ("runs", Number(a)),
        What::Late(a) => ("late", Number(a)),
        What::Periodic(a) => ("periodic", Number(a)),
        What::Condition(row) => ("condition", Number(row)),
        What::StepCount => ("step_count", Alone),
        What::TransitionCount => ("transition_count", Alone),
        _ => return None,
    })
}

impl Places for Flat<'_, '_> {
    fn memory(&self, id: MemoryId) -> Option<&Memory> {
        self.e.memory(id)
    }

    fn home(&mut self, id: MemoryId) -> Home {
        let Some(memory) = self.e.memory(id) else {
            return Home::Number(Expr::Bool(false), Num::Bool);
        };
        let (what, ty) = (memory.what, memory.ty);
        let of = if memory.class == Class::Scratch { "w" } else { "m" };
        if self.locals.get(id.0 as usize) == Some(&true) {
            return Home::Local(None);
        }
        match what {
            What::Variable(_) | What::BlockClock(_) => self.variable_home(id),
            What::Dt => Home::Number(s().field("dt"), Num::I64),
            What::Started => Home::Number(s().field("started"), Num::Bool),
            What::Changed => Home::Number(s().field("changed"), Num::Bool),
            What::Own(m) | What::Given(m) | What::Begun(m) | What::OwnWrote(m) | What::Wrote(m) => {
                let name = self.name_beside(id, m, what);
                self.field(of, name, ty, Place::Alone)
            }
            What::Control(block, part) => {
                let name = format!("{part:?}").replace(['(', ')'], "").to_lowercase();
                self.field(of, format!("block_{name}"), ty, Place::Number(block))
            }
            _ => match kind(what) {
                Some((name, place)) => self.field(of, name.to_owned(), ty, place),
                None => self.field(of, format!("value_{}", id.0), ty, Place::Alone),
            },
        }
    }

    fn constant(&mut self, text: &str) -> Expr {
        self.g.constant(text)
    }

    fn about(&mut self, about: About) -> Option<String> {
        let symbols = &self.g.c.symbols;
        let note = match about {
            About::Nothing => return None,
            About::Step(step) => symbols.step_path(step).to_owned(),
            About::Transition(rank) => self.g.transition_note(rank),
            About::Action(a) => self.g.action_note(a as usize),
            About::Block(b) => symbols.blocks.get(b as usize).map_or(String::new(), |b| b.name.to_string()),
            About::Watch(_) | About::Order(_) => return None,
        };
        (!note.is_empty()).then_some(note)
    }

    fn needs(&mut self, needs: Needs) {
        self.g.needs(needs);
    }

    fn cannot(&mut self, what: Said) {
        self.g.cannot(what);
    }
}

/// Notes with nothing behind them are left out.
fn without_empty_notes(block: Block) -> Block {
    let mut out = Block::new();
    for stmt in block {
        if matches!(stmt, Stmt::Note(_)) && matches!(out.last(), Some(Stmt::Note(_))) {
            out.pop();
        }
        out.push(match stmt {
            Stmt::If(c, a, b) => Stmt::If(c, without_empty_notes(a), without_empty_notes(b)),
            other => other,
        });
    }
    if matches!(out.last(), Some(Stmt::Note(_))) {
        out.pop();
    }
    out
}

fn rolled(block: Block, number: &dyn Fn(&str) -> Option<usize>) -> Block {
    let inner = block.into_iter().map(|stmt| match stmt {
        Stmt::If(c, a, b) => Stmt::If(c, rolled(a, number), rolled(b, number)),
        other => other,
    });
    roll(inner.collect(), number)
}
