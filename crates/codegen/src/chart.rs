//! The functions that only one chart has: its transitions, what its steps bring,
//! its edges, its sections.

use g7_engine::{NONE, Num, Rows, Situation, StepId, Tables};

use crate::build::{Gen, memory, s, state};
use crate::facts::counts;
use crate::flow::Flow;
use crate::tree::{Arm, Bin, Block, Const, Expr, Known, Stmt, Ty};
use crate::vars::Kind;

/// `set[field]` gets or loses a member.
fn member(field: &str, row: u32, on: bool) -> Stmt {
    let f = if on { "bit_set" } else { "bit_clear" };
    Stmt::Do(Expr::call(f, vec![memory(field).passed(), Expr::size(row as usize)]))
}

pub(crate) fn call(f: &str, arg: Expr) -> Stmt {
    Stmt::Do(Expr::call(f, vec![s(), arg]))
}

impl Gen<'_> {
    /// Everything that is this chart's own.
    pub(crate) fn chart(&mut self) {
        let t = self.t;
        let start: Block = t.initial.iter().map(|step| call("mark_on", self.step(*step))).collect();
        self.function("start", "The initial situation.", vec![state()], start);
        self.watch_steps();
        if !t.sources.is_empty() {
            self.sources();
        }
        self.clearing();
        if self.flag("HAS_ON") {
            self.step_changes(true);
            self.step_changes(false);
        }
        self.lists();
        if !t.watches.is_empty() {
            self.watches();
        }
        self.section("pre", "PRE.", t.pre);
        self.section("services", "System bits and services.", t.services);
        self.section("post", "POST.", t.post);
        self.section("tail", "System bits fall back.", t.tail);
        self.tables();
    }

    /// `if a transition can clear, fire it`, for the transitions watched by a step.
    fn watch_steps(&mut self) {
        let t = self.t;
        let blocks = self.flag("HAS_ORDERS") || self.flag("HAS_PERIODS");
        let mut arms = Vec::new();
        for (i, step) in t.steps.iter().enumerate() {
            let ranks = Gen::list(&t.outs, step.out);
            if ranks.is_empty() {
                continue;
            }
            let body = self.watched(&ranks);
            let free = s().field("blocked").at(Expr::size(step.chart as usize)).not();
            let body = if blocks { Stmt::when(free, body) } else { body };
            let id = StepId(i as u32);
            let note = self.c.symbols.step_path(id).to_owned();
            arms.push(Arm { label: self.step(id), note, body });
        }
        self.choice(
            "watch_step",
            "The transitions behind an active step, best priority first.",
            "step",
            arms,
        );
    }

    fn watched(&mut self, ranks: &[u32]) -> Block {
        let single = !self.t.rules.multi_token;
        let mut parts = Vec::new();
        for rank in ranks {
            let Some(tr) = self.t.transitions.get(*rank as usize).copied() else { continue };
            let rest = self.rest_active(tr.more_from);
            let (guard, fails) = self.guard(*rank);
            let note = self.transition_note(*rank);
            let fire = call("fire", self.transition(*rank));
            parts.push((note, rest.and(guard), fire, tr.simple && single, fails));
        }
        // Behind the first that clears of those that need nothing else, none is looked at.
        let chained = parts.len() < 40 && parts.iter().all(|p| p.3);
        if chained {
            let mut all = Block::new();
            for (note, c, fire, ..) in parts.into_iter().rev() {
                let then = vec![Stmt::Note(note.clone()), fire];
                all = match c {
                    Expr::Bool(true) => then,
                    c => vec![Stmt::If(c, then, all)],
                };
            }
            return all;
        }
        let mut all = Block::new();
        let some_end = parts.iter().rev().skip(1).any(|p| p.3);
        let open = || Expr::name("open");
        if some_end {
            all.push(Stmt::Let { mutable: true, name: "open".into(), ty: Ty::Bool, value: Expr::Bool(true) });
        }
        let mut ended = false;
        let last = parts.len().saturating_sub(1);
        for (i, (note, c, fire, ends, _)) in parts.into_iter().enumerate() {
            let mut then = vec![Stmt::Note(note), fire];
            if ends && i < last {
                then.push(Stmt::set(open(), Expr::Bool(false)));
            }
            let c = if ended { open().and(c) } else { c };
            all.extend(Stmt::when(c, then));
            ended |= ends;
        }
        all
    }

    fn sources(&mut self) {
        let t = self.t;
        let mut body = Block::new();
        for rank in &t.sources {
            let Some(tr) = t.transitions.get(*rank as usize) else { continue };
            let (guard, fails) = self.guard(*rank);
            let fire = call("fire", self.transition(*rank));
            let then = Stmt::when(guard, vec![Stmt::Note(self.transition_note(*rank)), fire]);
            let blocks = self.flag("HAS_ORDERS") || self.flag("HAS_PERIODS");
            let free = s().field("blocked").at(Expr::size(tr.chart as usize)).not();
            body.extend(if blocks { Stmt::when(free, then) } else { then });
            if fails {
                let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                body.push(Stmt::If(fault, vec![Stmt::Return(None)], Vec::new()));
            }
        }
        self.function("sources", "Transitions without a preceding step.", vec![state()], body);
    }

    /// What a transition does as it clears.
    fn clearing(&mut self) {
        let t = self.t;
        let sequential = self.flag("SEQUENTIAL");
        let mut arms = Vec::new();
        for (i, tr) in t.transitions.iter().enumerate() {
            let mut body = Block::new();
            if sequential {
                if tr.on_clearing == NONE {
                    continue;
                }
                body.push(call("run_action", Expr::size(tr.on_clearing as usize)));
            } else {
                for from in self.ends(tr.from, tr.more_from) {
                    body.push(call("mark_off", self.step(from)));
                }
                for (_, step) in t.drops.iter().filter(|d| d.0 == i as u32) {
                    body.push(call("mark_off", self.step(*step)));
                }
                for to in self.ends(tr.to, tr.more_to) {
                    body.push(call("mark_on", self.step(to)));
                }
                if tr.on_clearing != NONE {
                    body.push(call("run_in_pass", Expr::size(tr.on_clearing as usize)));
                }
            }
            let note = self.transition_note(i as u32);
            arms.push(Arm { label: self.transition(i as u32), note, body });
        }
        let (name, note) = if sequential {
            ("clearing", "The action of a transition that clears.")
        } else {
            ("clear", "A transition clears: the steps before it go off, those behind it come on.")
        };
        self.choice(name, note, "transition", arms);
    }

    /// What comes and goes with the activity of a step.
    fn step_changes(&mut self, on: bool) {
        let t = self.t;
        let mut arms = Vec::new();
        for (i, step) in t.steps.iter().enumerate() {
            let mut body = Block::new();
            if step.direct.0 != NONE {
                let mut flow = Flow::new(self, g7_engine::Code::default(), None);
                if let crate::values::Entry::Typed { e, .. } = flow.load(step.direct.0) {
                    body.push(Stmt::set(e, Expr::Bool(on)));
                }
            }
            if let Some(e) = t.extras.get(step.extra as usize).copied() {
                if e.uncounted && t.counts.is_some() {
                    body.push(Stmt::Assign(Some(Bin::Sub), s().field("moved"), Expr::size(1)));
                }
                self.contributions(&mut body, e.contributions, on);
                for g in t.group_lists.get(e.groups.start as usize..e.groups.end as usize).unwrap_or(&[]) {
                    let args = vec![s(), Expr::size(g.0 as usize), Expr::Bool(on)];
                    body.push(Stmt::Do(Expr::call("count_group", args)));
                }
                body.extend((e.events.start..e.events.end).map(|k| member("events", k, on)));
                body.extend((e.periodics.start..e.periodics.end).map(|k| member("periodics", k, on)));
            }
            if !body.is_empty() {
                let id = StepId(i as u32);
                arms.push(Arm { label: self.step(id), note: self.c.symbols.step_path(id).to_owned(), body });
            }
        }
        let (name, note) =
            if on { ("step_on", "What comes with a step.") } else { ("step_off", "What goes with a step.") };
        self.choice(name, note, "step", arms);
    }

    fn contributions(&self, body: &mut Block, rows: Rows, on: bool) {
        let places = counts(self.t).0;
        for k in rows.start..rows.end {
            let Some(c) = self.t.contributions.get(k as usize) else { continue };
            let at = places.get(c.block as usize).copied().unwrap_or(0) + usize::from(c.input);
            let name = self.c.symbols.blocks.get(c.block as usize).map_or("", |b| &b.name);
            let input = g7_engine::INPUTS.get(usize::from(c.input)).copied().unwrap_or("");
            body.push(Stmt::Note(format!("{input} {name}").trim().to_owned()));
            let (at, block) = (Expr::size(at), Expr::size(c.block as usize));
            if c.condition.is_empty() && c.time.is_empty() {
                let f = if on { "add_input" } else { "remove_input" };
                body.push(Stmt::Do(Expr::call(f, vec![s(), at, block])));
            } else if on {
                body.push(member("conditions", k, true));
            } else {
                let args = vec![s(), Expr::size(k as usize), at, block];
                body.push(Stmt::Do(Expr::call("drop_condition", args)));
            }
        }
    }

    /// Edges and timers, brought up to date as a pass begins.
    fn watches(&mut self) {
        let t = self.t;
        let mut body = Block::new();
        for (i, w) in t.watches.iter().enumerate() {
            let (now, fails) = self.value(w.code, Num::Bool, &format!("watched_{i}"));
            let name = format!("now{i}");
            let mut part = vec![Stmt::Let { mutable: false, name: name.clone(), ty: Ty::Bool, value: now }];
            let leave = || {
                let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
                Stmt::If(fault, vec![Stmt::Return(None)], Vec::new())
            };
            if fails {
                part.push(leave());
            }
            let row = Expr::size(i);
            match w.times {
                None => {
                    let args = vec![s(), row, Expr::name(name), Expr::name("fresh")];
                    part.push(Stmt::Do(Expr::call("edge", args)));
                }
                Some((up, down)) => {
                    let runs = Expr::call("timer_runs", vec![s(), row.clone(), Expr::name(name.clone())]);
                    let mut inner = Block::new();
                    let time = format!("time{i}");
                    let (one, f1) = self.value(up, Num::I64, &format!("time_on_{i}"));
                    let (two, f2) = self.value(down, Num::I64, &format!("time_off_{i}"));
                    let value = if one == two {
                        one
                    } else {
                        Expr::If(Box::new(Expr::name(name)), Box::new(one), Box::new(two))
                    };
                    inner.push(Stmt::Let { mutable: false, name: time.clone(), ty: Ty::I64, value });
                    if f1 || f2 {
                        inner.push(leave());
                    }
                    let args = vec![s(), row, Expr::name(time)];
                    inner.push(Stmt::Do(Expr::call("timer_goes", args)));
                    part.push(Stmt::If(runs, inner, Vec::new()));
                }
            }
            body.extend(Stmt::when(self.due(w.period), part));
        }
        let parameters = vec![state(), ("fresh".into(), Ty::Bool)];
        self.function("watch", "Edges and delays, as a pass begins.", parameters, body);
    }

    /// The stored actions of steps that come on and go off.
    fn lists(&mut self) {
        if !self.flag("HAS_LISTS") {
            return;
        }
        let t = self.t;
        for (on, name, note) in [
            (true, "on", "The actions of a step that comes on."),
            (false, "off", "The actions of a step that goes off."),
        ] {
            let (mut gather, mut run) = (Vec::new(), Vec::new());
            for (i, step) in t.steps.iter().enumerate() {
                let Some(e) = t.extras.get(step.extra as usize) else { continue };
                let actions = Gen::list(&t.action_lists, if on { e.on } else { e.off });
                if actions.is_empty() {
                    continue;
                }
                let id = StepId(i as u32);
                let label = self.step(id);
                let note = self.c.symbols.step_path(id).to_owned();
                let each = actions.iter().map(|a| call("store_action", Expr::size(*a as usize)));
                gather.push(Arm { label: label.clone(), note: note.clone(), body: each.collect() });
                let mut body = Block::new();
                for (k, a) in actions.iter().enumerate() {
                    let run = call("run_action", Expr::size(*a as usize));
                    if self.flag("LATE") {
                        body.push(call("run_at_end", Expr::size(*a as usize)));
                    } else if k == 0 {
                        body.push(run);
                    } else {
                        let fine = s().field("fault").bin(Bin::Eq, Expr::size(0));
                        body.push(Stmt::If(fine, vec![run], Vec::new()));
                    }
                }
                run.push(Arm { label, note, body });
            }
            self.choice(&format!("gather_{name}"), note, "step", gather);
            if self.flag("SEQUENTIAL") {
                self.choice(&format!("run_{name}"), note, "step", run);
            }
        }
    }

    fn numbers(&mut self, name: &str, note: &str, values: &[u32]) {
        let most = values.iter().copied().max().unwrap_or(0);
        let bits = if most < 256 {
            8
        } else if most < 65_536 {
            16
        } else {
            32
        };
        self.table(
            name,
            note,
            Ty::Int { signed: false, bits },
            values.iter().map(|v| Expr::size(*v as usize)),
        );
    }

    fn table(&mut self, name: &str, note: &str, of: Ty, values: impl Iterator<Item = Expr>) {
        let values: Vec<Expr> = values.collect();
        self.m.consts.push(Const {
            public: false,
            note: note.to_owned(),
            name: name.to_owned(),
            ty: Ty::Array(Box::new(of), values.len()),
            value: Known::Many(values),
        });
    }

    /// Lists one behind the other, and where each begins.
    fn lists_of(&mut self, name: &str, note: &str, lists: &[Vec<u32>]) {
        let mut starts = vec![0];
        let mut all = Vec::new();
        for list in lists {
            all.extend(list);
            starts.push(all.len() as u32);
        }
        self.numbers(&format!("{name}_AT"), note, &starts);
        self.numbers(name, "", &all);
    }

    /// What the templates look up.
    fn tables(&mut self) {
        let t: &Tables = self.t;
        let ids = |steps: Vec<StepId>| steps.into_iter().map(|s| s.0).collect::<Vec<_>>();
        let from: Vec<_> = t.transitions.iter().map(|x| ids(self.ends(x.from, x.more_from))).collect();
        let to: Vec<_> = t.transitions.iter().map(|x| ids(self.ends(x.to, x.more_to))).collect();
        self.lists_of("FROM", "The steps before each transition.", &from);
        self.lists_of("TO", "The steps behind each transition.", &to);
        let drops: Vec<Vec<u32>> = (0..t.transitions.len() as u32)
            .map(|i| t.drops.iter().filter(|d| d.0 == i).map(|d| d.1.0).collect())
            .collect();
        self.lists_of("DROPS", "Steps that go off with a transition.", &drops);
        let extra = |row: u32| t.extras.get(row as usize).copied().unwrap_or_default();
        let arcs = |r: Rows| ids(t.arcs.get(r.start as usize..r.end as usize).unwrap_or(&[]).to_vec());
        let groups = |r: Rows| {
            let list = t.group_lists.get(r.start as usize..r.end as usize).unwrap_or(&[]);
            list.iter().map(|g| g.0).collect::<Vec<_>>()
        };
        let encloses: Vec<_> = t.steps.iter().map(|x| groups(extra(x.extra).encloses)).collect();
        let links: Vec<_> = t.steps.iter().map(|x| arcs(extra(x.extra).links)).collect();
        self.lists_of("ENCLOSES", "Groups that each step encloses.", &encloses);
        self.lists_of("LINKS", "Steps that come on with each step.", &links);
        let initial: Vec<_> = t.groups.iter().map(|g| arcs(g.initial)).collect();
        self.lists_of("INITIAL", "The initial situation of each group.", &initial);
        let column = |f: fn(&g7_engine::Group) -> u32| t.groups.iter().map(f).collect::<Vec<_>>();
        self.numbers("GROUP_FIRST", "Groups of steps: the first.", &column(|g| g.steps.start));
        self.numbers("GROUP_END", "Groups of steps: one behind the last.", &column(|g| g.steps.end));
        let charts = |f: fn(&g7_engine::Chart) -> u32| t.charts.iter().map(f).collect::<Vec<_>>();
        self.numbers("CHART_GROUP", "The group of each chart.", &charts(|c| c.group.0));
        self.numbers("CHART_PERIOD", "The period of each chart.", &charts(|c| c.period));
        self.table(
            "PERIOD",
            "Periods in nanoseconds.",
            Ty::I64,
            t.periods.iter().map(|p| Expr::Int((*p).into(), None)),
        );
        let truth = |b: bool| Expr::Bool(b);
        self.table(
            "SHARES",
            "Transitions that share a step before them.",
            Ty::Bool,
            t.transitions.iter().map(|x| truth(x.shares)),
        );
        self.table(
            "COUNTED",
            "Transitions of the text.",
            Ty::Bool,
            t.transitions.iter().map(|x| truth(!x.uncounted)),
        );
        self.table(
            "STEP_COUNTED",
            "Steps of the text.",
            Ty::Bool,
            t.steps.iter().map(|x| truth(!extra(x.extra).uncounted)),
        );
        let number = |p: u32| Expr::size(p as usize);
        let bits = Ty::Int { signed: false, bits: 32 };
        self.table("PRIORITY", "Written priorities.", bits, t.transitions.iter().map(|x| number(x.priority)));
        let periodics: Vec<u32> = t.periodics.clone();
        self.numbers("PERIODIC_ACTION", "Actions of each scan.", &periodics);
        self.orders();
        let places = counts(t).0;
        let full: Vec<usize> =
            (0..t.blocks.len()).filter(|i| t.blocks.get(*i).is_some_and(|b| !b.plain)).collect();
        let blocks: Vec<u32> = full.iter().map(|i| *i as u32).collect();
        self.numbers("FULL_BLOCK", "Control blocks with memory.", &blocks);
        let at: Vec<u32> = full.iter().filter_map(|i| places.get(*i)).map(|a| *a as u32).collect();
        self.numbers("FULL_AT", "Where their inputs are counted.", &at);
        let periods: Vec<u32> = full.iter().filter_map(|i| t.blocks.get(*i)).map(|b| b.period).collect();
        self.numbers("FULL_PERIOD", "Their periods.", &periods);
    }

    /// Forcing orders; two with the same situation have the same number for it.
    fn orders(&mut self) {
        let t = self.t;
        let mut known: Vec<Vec<u32>> = Vec::new();
        let (mut numbers, mut lists) = (Vec::new(), Vec::new());
        for o in &t.orders {
            let (number, list) = match o.situation {
                Situation::Current => (0, Vec::new()),
                Situation::Steps(r) => {
                    let arcs = t.arcs.get(r.start as usize..r.end as usize).unwrap_or(&[]);
                    let list: Vec<u32> = arcs.iter().map(|s| s.0).collect();
                    let mut set = list.clone();
                    set.sort_unstable();
                    set.dedup();
                    let at = known.iter().position(|k| *k == set).unwrap_or_else(|| {
                        known.push(set);
                        known.len() - 1
                    });
                    (at as u32 + 1, list)
                }
            };
            numbers.push(number);
            lists.push(list);
        }
        self.numbers("ORDER_SITUATION", "What each forcing order imposes.", &numbers);
        let mut starts = vec![0];
        let mut all = Vec::new();
        for list in &lists {
            all.extend(list);
            starts.push(all.len() as u32);
        }
        self.numbers("ORDER_AT", "", &starts);
        self.numbers("ORDER_STEPS", "", &all);
        let steps: Vec<u32> = t.orders.iter().map(|o| o.step.0).collect();
        self.numbers("ORDER_STEP", "The step that gives each forcing order.", &steps);
        let charts: Vec<u32> = t.orders.iter().map(|o| o.chart).collect();
        self.numbers("ORDER_CHART", "The chart that each forces.", &charts);
    }

    /// Assigns a word of a variable.
    pub(crate) fn assign(&mut self, addr: u32, value: impl FnOnce(Num) -> Expr) -> Block {
        let mut flow = Flow::new(self, g7_engine::Code::default(), None);
        match flow.load(addr) {
            crate::values::Entry::Typed { e, kind: Kind::Num(n), .. } => vec![Stmt::set(e, value(n))],
            crate::values::Entry::Hidden(addr, e) => {
                let n = self.vars.hidden.get(&addr).copied().unwrap_or(Num::I64);
                vec![Stmt::set(e, value(n))]
            }
            _ => Block::new(),
        }
    }
}
