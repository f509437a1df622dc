//! From the engine's tables to equations: start-up, edges, transitions, steps.

mod times;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use g7_compile::Compiled;
use g7_engine::{Extra, GroupId, Guard, NONE, Rows, StepId, Tables, Transition, WatchId};
use g7_model::{Problem, Span, codes};

use super::form::{Class, Equations, Ex, Section, St};
use super::names::Names;
use super::vars::{Ty, Vars};

/// Most passes in a scan of the controller; the program's own bound may be less.
const PASSES: u32 = 10_000;

/// Equations in the making.
pub(crate) struct Plan<'a> {
    pub(crate) c: &'a Compiled,
    pub(crate) t: &'a Tables,
    /// The text of the chart, for comments.
    source: &'a str,
    pub(crate) vars: Vars,
    pub(crate) names: Names,
    pub(crate) hidden: HashMap<u32, Ty>,
    hidden_names: BTreeMap<u32, String>,
    steps: Vec<String>,
    pub(crate) transitions: Vec<String>,
    /// Rising, falling and delay memories of watches.
    watches: Vec<[String; 3]>,
    /// Step times that something reads.
    pub(crate) timed: BTreeSet<u32>,
    pub(crate) counted: BTreeSet<u32>,
    timed_groups: BTreeSet<u32>,
    looked_back: BTreeSet<u32>,
    clock: bool,
    dt: bool,
    /// What stored actions of one moment write.
    pub(crate) nexts: BTreeMap<String, Ty>,
    pub(crate) block_names: Vec<String>,
    /// Conditions of actions that are judged before others, by their code.
    pub(crate) judged: BTreeMap<u32, String>,
    /// Memories of steps as the scan began.
    pub(crate) begun: BTreeMap<String, String>,
    /// Steps are set and reset, in the manner of DOLOG80.
    pub(crate) set_reset: bool,
    pub(crate) e: Equations,
}

impl<'a> Plan<'a> {
    /// All equations of a chart.
    pub(crate) fn make(
        c: &'a Compiled,
        name: &str,
        source: &'a str,
        set_reset: bool,
        hidden: HashMap<u32, Ty>,
    ) -> Plan<'a> {
        let t = c.program.tables();
        let mut p = Plan {
            c,
            t,
            source,
            vars: Vars::default(),
            names: Names::default(),
            hidden,
            hidden_names: BTreeMap::new(),
            steps: Vec::new(),
            transitions: Vec::new(),
            watches: Vec::new(),
            timed: BTreeSet::new(),
            counted: BTreeSet::new(),
            timed_groups: BTreeSet::new(),
            looked_back: BTreeSet::new(),
            clock: false,
            dt: false,
            nexts: BTreeMap::new(),
            block_names: Vec::new(),
            judged: BTreeMap::new(),
            begun: BTreeMap::new(),
            set_reset,
            e: Equations::default(),
        };
        p.e.name = p.names.variable(name);
        for word in ["FIRST", "NOW", "CLOCK", "CLOCK_BASE", "PASSES", "CHANGED", "FAULT", "DT", "LAST"] {
            p.names.variable(word);
        }
        p.refuse();
        p.variables();
        p.number();
        p.declare("FIRST", "BOOL", "the first scan");
        if let Some(v) = p.e.variables.iter_mut().find(|v| v.name == "FIRST") {
            v.init = vec![Ex::Bool(true)];
        }
        p.evolution();
        p.times();
        p.safe();
        p
    }

    /// What equations cannot say.
    fn refuse(&mut self) {
        let t = self.t;
        if t.periods.iter().any(|p| *p > 0) {
            self.cannot(0, "a chart with a period of its own");
        }
        if t.counts.is_some() || t.limits.is_some() {
            self.cannot(0, "the counts of steps and transitions (%SW20, %SW21, %S25)");
        }
        let hierarchy = t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty());
        if t.rules.sequential && (hierarchy || !t.orders.is_empty()) {
            self.cannot(0, "enclosing or forcing under transitions that clear in turn");
        }
    }

    pub(crate) fn cannot(&mut self, at: u32, what: &str) {
        // What the lowering added has no place of its own: the first chart stands for it.
        let own = Some(at).filter(|at| *at > 0 && (*at as usize) < self.t.code.len());
        let own = own.map(|at| self.c.symbols.place(at)).filter(|span| span.start < span.end);
        let span = own.or(self.c.symbols.charts.first().map(|c| c.at)).unwrap_or_default();
        let what = what.trim_end_matches(',');
        let text = format!("{what} cannot be printed as equations for a PLC");
        if self.e.problems.iter().all(|p| p.what != text) {
            self.e.problems.push(Problem::new(&codes::NOT_CARRIED, span, text));
        }
    }

    /// Memories of steps, transitions and watches.
    fn number(&mut self) {
        let symbols = &self.c.symbols;
        for i in 0..self.t.steps.len() {
            let id = StepId(i as u32);
            let name = self.names.with("X", symbols.step_name(id));
            let note = symbols.step_path(id);
            let note = if symbols.is_listed(id) {
                format!("step {note}")
            } else {
                format!("stands for the macro-step {note}")
            };
            self.declare(&name, "BOOL", &note);
            self.steps.push(name);
        }
        for i in 0..self.t.transitions.len() {
            let text = symbols.transition_text(i as u32).replace("->", "to");
            let name = self.names.with("T", symbols.label(i as u32).unwrap_or(&text));
            let note = format!("transition {}", symbols.transition_text(i as u32));
            self.declare(&name, "BOOL", &note);
            self.transitions.push(name);
        }
        for i in 0..self.t.watches.len() {
            let n = (i + 1).to_string();
            let timer = self.t.watches.get(i).is_some_and(|w| w.times.is_some());
            let names = if timer {
                [String::new(), String::new(), self.names.with("TM", &n)]
            } else {
                [self.names.with("RE", &n), self.names.with("FE", &n), String::new()]
            };
            self.watches.push(names);
        }
    }

    pub(crate) fn step(&self, step: StepId) -> String {
        self.steps.get(step.0 as usize).cloned().unwrap_or_default()
    }

    pub(crate) fn active(&self, step: u32) -> Ex {
        Ex::Var(self.step(StepId(step)))
    }

    /// The activity of a step as the pass began.
    pub(crate) fn was(&mut self, step: StepId) -> Ex {
        self.looked_back.insert(step.0);
        let name = format!("W_{}", self.step(step));
        self.declare(&name, "BOOL", "as the pass began");
        Ex::Var(name)
    }

    /// The steps that count in a group.
    fn group_steps(&self, g: GroupId) -> Vec<u32> {
        let range = self.t.groups.get(g.0 as usize).map_or(0..0, |g| g.steps.start..g.steps.end);
        let counts = |s: &u32| {
            let rows = self.extra(*s).groups;
            self.t.group_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]).contains(&g)
        };
        range.filter(counts).collect()
    }

    pub(crate) fn group_active(&self, g: GroupId) -> Ex {
        Ex::any(self.group_steps(g).into_iter().map(|s| self.active(s)))
    }

    /// An edge (0 rising, 1 falling) or a delay (2).
    pub(crate) fn watch(&mut self, w: WatchId, which: usize) -> Ex {
        let name = self.watches.get(w.0 as usize).and_then(|n| n.get(which)).cloned().unwrap_or_default();
        self.declare(&name, "BOOL", "");
        Ex::Var(name)
    }

    pub(crate) fn hidden_name(&mut self, addr: u32) -> String {
        if let Some(name) = self.hidden_names.get(&addr) {
            return name.clone();
        }
        let ty = self.hidden.get(&addr).copied().unwrap_or(Ty::LINT);
        let name = self.memory("H", &(self.hidden_names.len() + 1).to_string(), ty, "");
        let init = self.t.init.get(addr as usize).copied().unwrap_or(0);
        if init != 0
            && let Some(v) = self.e.variables.iter_mut().find(|v| v.name == name)
        {
            v.init = vec![ty.literal(init)];
        }
        self.hidden_names.insert(addr, name.clone());
        name
    }

    /// The word of a name that the lowering made.
    pub(crate) fn hidden_at(&self, name: &str) -> Option<u32> {
        self.hidden_names.iter().find(|(_, n)| *n == name).map(|(addr, _)| *addr)
    }

    pub(crate) fn has_timed_groups(&self) -> bool {
        !self.timed_groups.is_empty()
    }

    /// A piece of the chart's text on one line.
    pub(crate) fn text(&self, span: Span) -> String {
        let text = self.source.get(span.start as usize..span.end as usize).unwrap_or("");
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        match line.char_indices().nth(100) {
            Some((i, _)) => format!("{} …", line.get(..i).unwrap_or("")),
            None => line,
        }
    }

    pub(crate) fn extra(&self, step: u32) -> Extra {
        let row = self.t.steps.get(step as usize).map_or(NONE, |s| s.extra);
        if row == NONE {
            Extra::default()
        } else {
            self.t.extras.get(row as usize).copied().unwrap_or_default()
        }
    }

    pub(crate) fn arcs(&self, rows: Rows) -> Vec<u32> {
        let rows = self.t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
        rows.iter().map(|s| s.0).collect()
    }

    pub(crate) fn preceding(&self, t: &Transition) -> Vec<u32> {
        let first = (t.from.0 != NONE).then_some(t.from.0);
        first.into_iter().chain(self.arcs(t.more_from)).collect()
    }

    pub(crate) fn succeeding(&self, t: &Transition) -> Vec<u32> {
        let first = (t.to.0 != NONE).then_some(t.to.0);
        first.into_iter().chain(self.arcs(t.more_to)).collect()
    }

    fn evolution(&mut self) {
        let stable = self.t.rules.stable;
        if stable {
            self.e.bound = Some(self.t.rules.bound.min(PASSES));
            self.declare("PASSES", "DINT", "passes in this scan");
            self.declare("CHANGED", "BOOL", "something changed in this pass");
            self.declare("FAULT", "BOOL", "no stable situation, or orders that disagree");
        } else if !self.t.orders.is_empty() {
            self.declare("FAULT", "BOOL", "orders that disagree");
        }
        let start = self.start_up();
        let edges = self.edges();
        let mut pre = Section::new("PRE");
        let code = self.body(self.t.pre);
        let once = if stable { Ex::op("=", Ex::var("PASSES"), Ex::Int(1)) } else { Ex::Bool(true) };
        pre.act("", once.clone(), code);
        let code = self.body(self.t.services);
        pre.act("", once, code);
        let mut sections = vec![edges, pre];
        let early = self.early_pulses();
        sections.push(early);
        let mut first = Section::new("");
        first.assign("", "FIRST", Ex::Bool(false));
        sections.push(first);
        let after = self.end_of_scan();
        let moves = self.moves();
        sections.extend(moves);
        self.e.before.push(start);
        let mut begun = Section::new("As the scan begins");
        for (before, step) in self.begun.clone() {
            begun.assign("", before, Ex::Var(step));
        }
        self.e.before.push(begun);
        self.e.pass = sections;
        self.e.after = after;
        let mut back = Section::new("As the pass begins");
        for step in self.looked_back.clone() {
            let name = format!("W_{}", self.step(StepId(step)));
            back.assign("", name, self.active(step));
        }
        self.e.pass.insert(0, back);
    }

    /// The initial situation with what its activation does.
    fn start_up(&mut self) -> Section {
        let mut s = Section::new("Start-up: the initial situation");
        let mut all: Vec<u32> = self.t.initial.iter().map(|s| s.0).collect();
        let mut k = 0;
        while let Some(step) = all.get(k).copied() {
            k += 1;
            for link in self.arcs(self.extra(step).links) {
                if !all.contains(&link) {
                    all.push(link);
                }
            }
        }
        let first = Ex::var("FIRST");
        let mut runs = Vec::new();
        for step in &all {
            for action in self.action_list(self.extra(*step).on) {
                runs.push((action, first.clone()));
            }
        }
        if self.t.rules.late_actions {
            for (action, when) in runs {
                let name = self.late_flag(action);
                s.set("", name, when);
            }
            for step in &all {
                s.set("", self.step(StepId(*step)), first.clone());
            }
        } else if self.t.rules.parallel_actions {
            self.parallel(&mut s, runs);
            for step in &all {
                s.set("", self.step(StepId(*step)), first.clone());
            }
            self.take_next(&mut s, Some(first));
        } else {
            for step in &all {
                s.set("", self.step(StepId(*step)), first.clone());
            }
            runs.sort_by_key(|r| r.0);
            for (action, when) in runs {
                self.run(&mut s, action, when);
            }
        }
        s
    }

    fn edges(&mut self) -> Section {
        let mut s = Section::new("Edges and delays");
        for i in 0..self.t.watches.len() {
            let Some(w) = self.t.watches.get(i).copied() else { break };
            let id = WatchId(i as u32);
            let (before, e) = self.value_behind(w.code, Ty::BOOL);
            let note = self.text(self.c.symbols.place(w.code.start));
            s.act("", Ex::Bool(true), before);
            let n = (i + 1).to_string();
            let value = self.memory("WB", &n, Ty::BOOL, "as the pass before began");
            let Some(times) = w.times else {
                let (rise, fall) = (self.watch(id, 0), self.watch(id, 1));
                let later = Ex::var("FIRST").not();
                let now = match &e {
                    Ex::Var(_) => e.clone(),
                    _ => {
                        let name = self.memory("WE", &n, Ty::BOOL, "");
                        s.assign(note.clone(), name.clone(), e.clone());
                        Ex::Var(name)
                    }
                };
                for (edge, e) in [
                    (rise, Ex::all([now.clone(), Ex::var(value.clone()).not(), later.clone()])),
                    (fall, Ex::all([now.clone().not(), Ex::var(value.clone()), later])),
                ] {
                    if let Ex::Var(name) = edge {
                        s.assign("", name, e);
                    }
                }
                s.assign("", value, now);
                continue;
            };
            let now = match &e {
                Ex::Var(_) => e.clone(),
                _ => {
                    let name = self.memory("WE", &n, Ty::BOOL, "");
                    s.assign(note, name.clone(), e.clone());
                    Ex::Var(name)
                }
            };
            let start = self.memory("WS", &n, Ty::TIME, "when it changed");
            let q = self.watch(id, 2);
            let Ex::Var(name) = &q else { continue };
            let clock = self.now();
            s.act("", now.clone().xor(Ex::var(value.clone())), vec![St::set(start.clone(), clock.clone())]);
            s.assign("", value, now.clone());
            let (on, off) = (self.value(times.0, Ty::TIME), self.value(times.1, Ty::TIME));
            let gone = |t: Ex| match t {
                Ex::Time(ns) if ns <= 0 => Ex::Bool(true),
                t => Ex::op(">=", Ex::op("-", clock.clone(), Ex::var(start.clone())), t),
            };
            s.set("", name.clone(), Ex::all([now.clone(), q.clone().not(), gone(on)]));
            s.reset("", name.clone(), Ex::all([now.not(), q.clone(), gone(off)]));
        }
        s
    }

    /// Receptivities: each transition's memory is "it clears".
    pub(crate) fn transitions(&mut self, blocked: &BTreeMap<u32, String>) -> Section {
        let mut s = Section::new("Transitions: enabled, and the receptivity true");
        let rules = self.t.rules;
        let all = self.t.transitions.clone();
        let froms: Vec<Vec<u32>> = all.iter().map(|t| self.preceding(t)).collect();
        let shares = |a: usize, b: usize| {
            let (a, b) = (froms.get(a), froms.get(b));
            a.zip(b).is_some_and(|(a, b)| a.iter().any(|s| b.contains(s)))
        };
        let better = |i: usize, j: usize| {
            let (x, y) = (all.get(i).map_or(NONE, |t| t.priority), all.get(j).map_or(NONE, |t| t.priority));
            y < x
        };
        // Clearable ones by themselves, where numbers exclude.
        let numbered = rules.multi_token && rules.numbered_exclusive;
        let mut clearable: HashMap<usize, String> = HashMap::new();
        for i in 0..all.len() {
            let Some(t) = all.get(i) else { break };
            let from = froms.get(i).cloned().unwrap_or_default();
            let (before, guard) = match t.guard {
                Guard::True => (Vec::new(), Ex::Bool(true)),
                Guard::Word(a) | Guard::NotWord(a) => {
                    let e = self.word(a.0);
                    (Vec::new(), if matches!(t.guard, Guard::Word(_)) { e } else { e.not() })
                }
                Guard::Code(code) => {
                    if self.writes(code) {
                        self.cannot(code.start, "a receptivity that writes variables");
                    }
                    self.value_behind(code, Ty::BOOL)
                }
            };
            let mut note = self.transition_note(i as u32);
            let mut guard = guard;
            // What is not enabled is not judged: its divisor may be zero.
            let enabled = Ex::all(from.iter().map(|f| self.active(*f)));
            s.act("", enabled.clone(), before);
            if guard.divides() || (self.set_reset && guard != Ex::Bool(true)) {
                let own = self.transitions.get(i).cloned().unwrap_or_default();
                let r = self.memory("R", own.trim_start_matches("T_"), Ty::BOOL, "its receptivity");
                if guard.divides() {
                    s.assign(std::mem::take(&mut note), r.clone(), Ex::Bool(false));
                    s.act("", enabled.clone(), vec![St::set(r.clone(), guard)]);
                } else {
                    s.assign(std::mem::take(&mut note), r.clone(), guard);
                }
                guard = Ex::Var(r);
            }
            let mut e = enabled.and(guard);
            if let Some(b) = blocked.get(&t.chart) {
                e = e.and(Ex::var(b.clone()).not());
            }
            let name = self.transitions.get(i).cloned().unwrap_or_default();
            if !rules.multi_token {
                let ahead = (0..i).filter(|j| shares(i, *j)).collect::<Vec<_>>();
                for j in ahead {
                    let other = self.transitions.get(j).cloned().unwrap_or_default();
                    e = e.and(Ex::Var(other).not());
                }
            } else if numbered && (0..all.len()).any(|j| shares(i, j) && (better(i, j) || better(j, i))) {
                let c = self.memory("C", name.trim_start_matches("T_"), Ty::BOOL, "clearable");
                s.assign(note, c.clone(), e);
                clearable.insert(i, c);
                continue;
            }
            s.assign(note, name, e);
        }
        for i in 0..all.len() {
            let Some(own) = clearable.get(&i) else { continue };
            let ahead = (0..all.len()).filter(|j| shares(i, *j) && better(i, *j));
            let ahead = ahead.filter_map(|j| clearable.get(&j)).map(|c| Ex::var(c.clone()).not());
            let e = Ex::all([Ex::var(own.clone())].into_iter().chain(ahead));
            s.assign("", self.transitions.get(i).cloned().unwrap_or_default(), e);
        }
        s
    }

    pub(crate) fn word(&mut self, addr: u32) -> Ex {
        use super::vars::Shape;
        match self.vars.slot(addr).cloned() {
            Some(slot) => match slot.shape {
                Shape::One(_) => Ex::Var(slot.name),
                Shape::Many(..) => Ex::Index(slot.name, Box::new(Ex::Int((addr - slot.start).into()))),
                Shape::Fb(kind) => {
                    let member = super::vars::members(kind).get((addr - slot.start) as usize);
                    Ex::Var(format!("{}.{}", slot.name, member.map_or("Q", |m| m.0)))
                }
                Shape::Text => Ex::Bool(false),
            },
            None => {
                self.hidden.entry(addr).or_insert(Ty::BOOL);
                Ex::Var(self.hidden_name(addr))
            }
        }
    }

    fn writes(&self, code: g7_engine::Code) -> bool {
        let lasting = if self.t.locals.is_empty() { u32::MAX } else { self.t.locals.start };
        let ops = self.t.code.get(code.start as usize..code.end as usize).unwrap_or(&[]);
        ops.iter().any(|op| match *op {
            g7_engine::Op::Store(a) => a.0 < lasting,
            g7_engine::Op::StoreAt { base, .. } | g7_engine::Op::Fb(_, base) => base.0 < lasting,
            _ => false,
        })
    }

    fn transition_note(&self, rank: u32) -> String {
        let symbols = &self.c.symbols;
        let text = self.text(symbols.transition_place(rank));
        if text.is_empty() || !symbols.is_written(rank) {
            symbols.transition_text(rank).to_owned()
        } else {
            text
        }
    }

    /// What the outputs are after a fault.
    fn safe(&mut self) {
        if !self.e.variables.iter().any(|v| v.name == "FAULT") {
            return;
        }
        let mut safe = Vec::new();
        let from = self.t.outputs.start;
        for (addr, word) in (from..self.t.outputs.end).zip(&self.t.safe) {
            let Some(slot) = self.vars.slot(addr).cloned() else { continue };
            let (place, ty) = match slot.shape {
                super::vars::Shape::One(ty) => (Ex::Var(slot.name), ty),
                super::vars::Shape::Many(ty, _) => {
                    (Ex::Index(slot.name, Box::new(Ex::Int((addr - slot.start).into()))), ty)
                }
                _ => continue,
            };
            safe.push(St::Assign(place, ty.literal(*word)));
        }
        self.e.safe = Some(safe);
    }

    /// Declarations that nothing reads are left out.
    pub(crate) fn prune(&mut self) {
        let mut used = BTreeSet::new();
        let mut note = |e: &Ex| {
            e.walk(&mut |e| {
                if let Ex::Var(n) | Ex::Index(n, _) = e {
                    used.insert(n.split('.').next().unwrap_or(n).to_owned());
                }
            });
        };
        fn statements(list: &[St], note: &mut dyn FnMut(&Ex)) {
            for s in list {
                match s {
                    St::Assign(a, b) => {
                        note(a);
                        note(b);
                    }
                    St::If(c, a, b) => {
                        note(c);
                        statements(a, note);
                        statements(b, note);
                    }
                    St::Loop(a) => statements(a, note),
                    St::Exit => {}
                    St::Call(n, inputs) => {
                        note(&Ex::var(n.clone()));
                        inputs.iter().for_each(|(_, e)| note(e));
                    }
                }
            }
        }
        for s in self.e.sections() {
            for r in &s.rungs {
                use super::form::What;
                match &r.what {
                    What::Assign(to, e) | What::Set(to, e) | What::Reset(to, e) => {
                        note(&Ex::var(to.clone()));
                        note(e);
                    }
                    What::Do(e, body) => {
                        note(e);
                        statements(body, &mut note);
                    }
                }
            }
        }
        let kept = |v: &super::form::Declared| {
            matches!(v.class, Class::Input | Class::Output)
                || ["PASSES", "CHANGED", "FAULT"].contains(&&*v.name)
        };
        self.e.variables.retain(|v| kept(v) || used.contains(&v.name));
    }
}
