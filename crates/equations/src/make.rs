//! The equations in the making: memories by what they stand for, and the tables
//! that they are made from.

use std::collections::{HashMap, HashSet};

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::tree::{self, Clock, ExprKind, Piece, StmtKind};
use g7_engine::{Addr, Code, Extra, GroupId, NONE, Rows, Service, StepId, Tables, Transition};
use g7_model::Type;

use crate::form::{Class, Expr, Memory, MemoryId, Stmt, What};
use crate::whole::{Options, StepTimes};

/// A variable that takes more than one word, or one with a name.
#[derive(Clone, Copy)]
struct Slot {
    memory: MemoryId,
    start: u32,
    elements: u32,
}

/// The work in hand.
pub(crate) struct Make<'a> {
    pub(crate) c: &'a Compiled,
    pub(crate) t: &'a Tables,
    pub(crate) options: Options,
    /// Groups and times are kept by somebody else ([`crate::Bodies`]).
    pub(crate) apart: bool,
    pub(crate) memories: Vec<Memory>,
    known: HashMap<What, MemoryId>,
    /// By word of the variable area.
    slots: HashMap<u32, Slot>,
    /// Constant texts by their first word.
    texts: HashMap<u32, Box<str>>,
    temporaries: u32,
    pub(crate) returns: u32,
    /// Each scan adds the scan time to these clocks where their condition holds.
    pub(crate) clocks: Vec<(MemoryId, Expr)>,
    /// The same clocks, to be found.
    running: HashSet<MemoryId>,
    /// Some step encloses charts.
    hierarchy: bool,
    /// By output: the control blocks that drive it.
    drivers: HashMap<Addr, u32>,
    /// Variables that code of the chart writes.
    pub(crate) written_by_code: HashSet<MemoryId>,
}

impl<'a> Make<'a> {
    pub(crate) fn new(c: &'a Compiled, options: Options) -> Make<'a> {
        Make::with(c, options, false)
    }

    /// For code alone, without an evolution round it.
    pub(crate) fn apart(c: &'a Compiled) -> Make<'a> {
        Make::with(c, Options::default(), true)
    }

    fn with(c: &'a Compiled, options: Options, apart: bool) -> Make<'a> {
        let t = c.program.tables();
        let mut drivers = HashMap::new();
        for block in &t.blocks {
            *drivers.entry(block.output).or_default() += 1;
        }
        let mut m = Make {
            c,
            t,
            options,
            apart,
            memories: Vec::new(),
            known: HashMap::new(),
            slots: HashMap::new(),
            texts: HashMap::new(),
            temporaries: 0,
            returns: 0,
            clocks: Vec::new(),
            running: HashSet::new(),
            hierarchy: t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty()),
            drivers,
            written_by_code: HashSet::new(),
        };
        m.variables();
        m.discover();
        m
    }

    /// The variables that have names.
    fn variables(&mut self) {
        let symbols = &self.c.symbols;
        for v in &symbols.variables {
            // The words of an instance are those of its members, which follow.
            if matches!(v.ty, Type::Fb(_)) || v.elements == 0 {
                continue;
            }
            let class = match v.class {
                VarClass::Input => Class::Input,
                VarClass::Output => Class::Output,
                VarClass::Internal | VarClass::System => Class::Kept,
                VarClass::Local => Class::Scratch,
                VarClass::Const => Class::Constant,
            };
            let words = self.t.init.get(v.addr.0 as usize..).unwrap_or_default();
            let count = match v.ty {
                Type::String(_) => v.words(),
                _ => v.elements,
            };
            let init = words.get(..count as usize).unwrap_or_default().into();
            let what = What::Variable(v.addr);
            let (ty, elements, retain) = (v.ty.stored(), v.elements, v.retain);
            let memory = self.add(Memory { what, class, ty, elements, init, retain });
            for word in v.addr.0..v.addr.0 + v.words() {
                self.slots.entry(word).or_insert(Slot { memory, start: v.addr.0, elements });
            }
        }
    }

    /// Finds the items that some code reads, asks for or writes: the evolution has to know them
    /// before that code is come to.
    fn discover(&mut self) {
        let c = self.c;
        for piece in c.pieces.iter() {
            match piece {
                Piece::Value(e) => self.discover_in(e),
                Piece::Work(list) => self.discover_all(list),
            }
        }
        if self.options.times != StepTimes::Read {
            let scans = self.t.rules.scan_clock;
            for step in self.steps().map(StepId) {
                self.clock(if scans { Clock::StepScans(step) } else { Clock::Step(step) });
            }
        }
    }

    fn discover_in(&mut self, e: &tree::Expr) {
        let mut found = Vec::new();
        let mut lists = Vec::new();
        e.visit(&mut |e| match &e.kind {
            ExprKind::Time(clock) => found.push(Ok(*clock)),
            ExprKind::Tenths(step) => found.push(Ok(Clock::Step(*step))),
            ExprKind::WasActive(step) => found.push(Err(*step)),
            ExprKind::After(list, _) => lists.push(list.clone()),
            _ => {}
        });
        for f in found {
            match f {
                Ok(clock) => drop(self.clock(clock)),
                Err(step) => drop(self.flag(What::Was(step))),
            }
        }
        // `visit` has gone through their expressions.
        lists.iter().for_each(|list| self.discover_writes(list));
    }

    fn discover_all(&mut self, list: &[tree::Stmt]) {
        self.discover_writes(list);
        let mut inner = Vec::new();
        tree::visit_all(list, &mut |e| {
            if matches!(
                e.kind,
                ExprKind::Time(_) | ExprKind::Tenths(_) | ExprKind::WasActive(_) | ExprKind::After(..)
            ) {
                inner.push(e.clone());
            }
        });
        inner.iter().for_each(|e| self.discover_in(e));
    }

    fn discover_writes(&mut self, list: &[tree::Stmt]) {
        for s in list {
            match &s.kind {
                StmtKind::Store(ty, tree::Target::Word(addr), _) => {
                    let (memory, _) = self.word(*addr, *ty);
                    self.written_by_code.insert(memory);
                }
                StmtKind::Store(ty, tree::Target::Element(base, len, _), _) => {
                    for k in 0..*len {
                        let (memory, _) = self.word(Addr(base.0 + k), *ty);
                        self.written_by_code.insert(memory);
                    }
                }
                StmtKind::If(arms, other) => {
                    arms.iter().for_each(|(_, then)| self.discover_writes(then));
                    self.discover_writes(other);
                }
                StmtKind::Loop(body, _) | StmtKind::Body(body) => self.discover_writes(body),
                StmtKind::Service(service) => self.request(*service),
                _ => {}
            }
        }
    }

    /// The flag of a request to the service point.
    fn request(&mut self, service: Service) {
        let what = match service {
            Service::Start => What::RequestStart,
            Service::Init(g) => What::RequestInit(g),
            Service::Clear(g) => What::RequestClear(g),
            Service::Set(s) => What::RequestSet(s),
            Service::Reset(s) => What::RequestReset(s),
            Service::ResetTimes => return,
        };
        self.kept(what);
    }

    fn add(&mut self, memory: Memory) -> MemoryId {
        if let Some(id) = self.known.get(&memory.what) {
            return *id;
        }
        let id = MemoryId(self.memories.len() as u32);
        self.known.insert(memory.what, id);
        self.memories.push(memory);
        id
    }

    /// The memory of something, made at its first use.
    pub(crate) fn memory(&mut self, what: What, class: Class, ty: Type) -> MemoryId {
        self.add(Memory { what, class, ty, elements: 1, init: [0].into(), retain: false })
    }

    /// A BOOL that is set before it is read in each scan.
    pub(crate) fn flag(&mut self, what: What) -> MemoryId {
        self.memory(what, Class::Scratch, Type::Bool)
    }

    /// A BOOL that is kept.
    pub(crate) fn kept(&mut self, what: What) -> MemoryId {
        self.memory(what, Class::Kept, Type::Bool)
    }

    pub(crate) fn of(&self, id: MemoryId) -> Option<&Memory> {
        self.memories.get(id.0 as usize)
    }

    pub(crate) fn known(&self, what: What) -> Option<MemoryId> {
        self.known.get(&what).copied()
    }

    /// A memory of the shape of another one.
    pub(crate) fn beside(&mut self, what: What, of: MemoryId) -> MemoryId {
        let Some(like) = self.of(of).cloned() else { return of };
        self.add(Memory { what, class: Class::Scratch, retain: false, ..like })
    }

    pub(crate) fn temporary(&mut self, ty: Type) -> MemoryId {
        self.temporaries += 1;
        let what = What::Temporary(self.temporaries);
        let words = match ty {
            Type::String(_) => g7_compile::lower::words_of(ty),
            _ => 1,
        };
        let init = vec![0; words as usize].into();
        self.add(Memory { what, class: Class::Scratch, ty, elements: 1, init, retain: false })
    }

    /// The memory that a word lies in, and its place among the elements.
    pub(crate) fn word(&mut self, addr: Addr, ty: Type) -> (MemoryId, Option<u32>) {
        if let Some(slot) = self.slots.get(&addr.0) {
            let place = (slot.elements > 1).then(|| addr.0 - slot.start);
            return (slot.memory, place);
        }
        (self.hidden(addr, ty), None)
    }

    /// A word that the lowering keeps beside the variables.
    fn hidden(&mut self, addr: Addr, ty: Type) -> MemoryId {
        let lasts = self.t.locals.is_empty() || addr.0 < self.t.locals.start;
        let class = if lasts { Class::Kept } else { Class::Scratch };
        let words = match ty {
            Type::String(_) => g7_compile::lower::words_of(ty),
            _ => 1,
        };
        let init = self.t.init.get(addr.0 as usize..(addr.0 + words) as usize).unwrap_or(&[0]).into();
        let what = What::Variable(addr);
        self.add(Memory { what, class, ty, elements: 1, init, retain: false })
    }

    /// The memory of a text variable, or the text itself where it never changes.
    pub(crate) fn text(&mut self, addr: Addr, cap: u16) -> Result<MemoryId, Box<str>> {
        if let Some(slot) = self.slots.get(&addr.0) {
            return Ok(slot.memory);
        }
        let lasts = self.t.locals.is_empty() || addr.0 < self.t.locals.start;
        if !lasts {
            return Ok(self.hidden(addr, Type::String(cap)));
        }
        let t = self.t;
        let text = self.texts.entry(addr.0).or_insert_with(|| {
            let words = t.init.get(addr.0 as usize..).unwrap_or_default();
            let len = words.first().map_or(0, |w| *w as usize);
            let bytes: Vec<u8> = words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(len).collect();
            String::from_utf8_lossy(&bytes).into()
        });
        Err(text.clone())
    }

    /// A piece of code; `None` for an empty one.
    pub(crate) fn piece(&self, code: Code) -> Option<&'a Piece> {
        self.c.pieces.get(code)
    }

    pub(crate) fn extra(&self, step: u32) -> Extra {
        let row = self.t.steps.get(step as usize).map_or(NONE, |s| s.extra);
        if row == NONE {
            Extra::default()
        } else {
            self.t.extras.get(row as usize).copied().unwrap_or_default()
        }
    }

    pub(crate) fn arcs(&self, rows: Rows) -> &'a [StepId] {
        self.t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[])
    }

    /// The groups that a step encloses.
    pub(crate) fn enclosed(&self, step: u32) -> &'a [GroupId] {
        let rows = self.extra(step).encloses;
        self.t.group_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[])
    }

    /// All steps of the charts that a step encloses.
    pub(crate) fn inside(&self, step: u32) -> Vec<u32> {
        self.enclosed(step).iter().flat_map(|g| self.group_steps(*g)).collect()
    }

    pub(crate) fn group_steps(&self, group: GroupId) -> std::ops::Range<u32> {
        self.t.groups.get(group.0 as usize).map_or(0..0, |g| g.steps.start..g.steps.end)
    }

    pub(crate) fn preceding(&self, t: &Transition) -> impl Iterator<Item = u32> + 'a {
        let first = (t.from.0 != NONE).then_some(t.from.0);
        first.into_iter().chain(self.arcs(t.more_from).iter().map(|s| s.0))
    }

    pub(crate) fn succeeding(&self, t: &Transition) -> impl Iterator<Item = u32> + 'a {
        let first = (t.to.0 != NONE).then_some(t.to.0);
        first.into_iter().chain(self.arcs(t.more_to).iter().map(|s| s.0))
    }

    /// The steps that go off with a transition without having to be active for it.
    pub(crate) fn dropped(&self, rank: u32) -> impl Iterator<Item = u32> + 'a {
        let from = self.t.drops.partition_point(|d| d.0 < rank);
        self.t.drops.get(from..).unwrap_or(&[]).iter().take_while(move |d| d.0 == rank).map(|d| d.1.0)
    }

    pub(crate) fn actions(&self, rows: Rows) -> &'a [u32] {
        self.t.action_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[])
    }

    pub(crate) fn steps(&self) -> std::ops::Range<u32> {
        0..self.t.steps.len() as u32
    }

    pub(crate) fn has_hierarchy(&self) -> bool {
        self.hierarchy
    }

    /// True if one control block alone drives an output.
    pub(crate) fn has_one_driver(&self, output: Addr) -> bool {
        self.drivers.get(&output) == Some(&1)
    }

    pub(crate) fn step(&mut self, step: u32) -> MemoryId {
        self.kept(What::Step(StepId(step)))
    }

    pub(crate) fn active(&mut self, step: u32) -> Expr {
        Expr::Read(self.step(step))
    }

    /// The steps that count in a group: those of its expansion, without what
    /// stands for macro-steps inside.
    pub(crate) fn counted(&self, group: GroupId) -> Vec<u32> {
        let counts = |s: &u32| {
            let rows = self.extra(*s).groups;
            self.t
                .group_lists
                .get(rows.start as usize..rows.end as usize)
                .is_some_and(|list| list.contains(&group))
        };
        self.group_steps(group).filter(counts).collect()
    }

    pub(crate) fn group_active(&mut self, group: GroupId) -> Expr {
        if self.apart {
            return Expr::Read(self.flag(What::GroupActive(group)));
        }
        let steps = self.counted(group);
        Expr::any(steps.into_iter().map(|s| self.active(s)))
    }

    /// A period is due in this scan.
    pub(crate) fn due(&mut self, period: u32) -> Expr {
        match self.t.periods.get(period as usize) {
            Some(p) if *p > 0 => Expr::Read(self.flag(What::Due(period))),
            _ => Expr::truth(true),
        }
    }

    /// Adds the scan time to a clock in each scan in which the condition holds.
    pub(crate) fn runs(&mut self, clock: MemoryId, while_: Expr) {
        if self.running.insert(clock) {
            self.clocks.push((clock, while_));
        }
    }
}

/// Sets a BOOL where a condition holds.
pub(crate) fn raise(to: MemoryId, when: Expr) -> Vec<Stmt> {
    match when.known() {
        Some(false) => Vec::new(),
        _ => vec![Stmt::Set(to, Expr::Read(to).or(when))],
    }
}

/// A BOOL memory becomes FALSE.
pub(crate) fn lower(to: MemoryId) -> Stmt {
    Stmt::Set(to, Expr::truth(false))
}
