//! The functions that only one chart has: its transitions, what its steps bring,
//! its edges, its sections.

use std::collections::{BTreeMap, HashMap};

use g7_engine::{Addr, NONE, Num, Rows, Situation, StepId, Tables};
use g7_model::Type;

use crate::build::{Gen, memory, s, state};
use crate::facts::counts;
use crate::tree::{Arm, Bin, Block, Const, Expr, Known, Stmt, Ty};
use crate::vars::{Shape, members};

/// Steps in a word of a set of steps.
const WORD: usize = 32;

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
        self.receptivities();
        self.followers();
        if self.facts.has_on {
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

    /// One choice for each receptivity; transitions with the same one share it.
    fn receptivities(&mut self) {
        let mut known: HashMap<String, u32> = HashMap::new();
        let (mut when, mut arms) = (Vec::new(), Vec::new());
        let mut some_fail = false;
        for i in 0..self.t.transitions.len() as u32 {
            let (e, fails) = self.guard(i);
            some_fail |= fails;
            let first = *known.entry(format!("{e:?}")).or_insert(i);
            when.push(first);
            if first == i {
                let note = self.transition_note(i);
                arms.push(Arm { label: self.transition(i), note, body: vec![Stmt::Return(Some(e))] });
            }
        }
        let shared = arms.len() < when.len();
        self.facts.same_receptivities = shared;
        self.facts.guards_fail = some_fail;
        self.question("receptivity", "Whether the receptivity of a transition is true.", "transition", arms);
        let note = "Transitions that wait for the same: the first of them.";
        let rows = when.iter().map(|t| vec![self.transition(*t)]).collect();
        let notes = self.transition_notes();
        self.named_table("WHEN", note, rows, notes, self.t.transitions.len());
    }

    fn transition_notes(&self) -> Vec<String> {
        (0..self.t.transitions.len() as u32).map(|i| self.transition_note(i)).collect()
    }

    /// Outputs that follow one step each, for all steps of a word: a compiler makes few
    /// copies of neighbours, and a large chart has a case for each word that changed.
    fn followers(&mut self) {
        let t = self.t;
        let mut groups: BTreeMap<usize, Vec<(u32, StepId)>> = BTreeMap::new();
        for (i, step) in (0u32..).zip(&t.steps).filter(|(_, step)| step.direct.0 != NONE) {
            groups.entry(i as usize / WORD).or_default().push((step.direct.0, StepId(i)));
        }
        let mut arms = Vec::new();
        for (group, mut all) in groups {
            let path = |of: Option<&(u32, StepId)>| of.map_or("", |of| self.c.symbols.step_path(of.1));
            let note = match all.as_slice() {
                [one] => path(Some(one)).to_owned(),
                several => format!("{} to {}", path(several.first()), path(several.last())),
            };
            all.sort_unstable_by_key(|(addr, _)| *addr);
            let mut body = Block::new();
            for (addr, step) in all {
                let active = self.active(step);
                body.extend(self.assign(addr, Type::Bool, |_| active));
                if let Some(slot) = self.vars.slot(addr).filter(|s| matches!(s.shape, Shape::One(_))) {
                    self.m.followers.insert(slot.field.clone());
                }
            }
            arms.push(Arm { label: Expr::size(group), note, body });
        }
        let body = match arms.as_mut_slice() {
            [one] => std::mem::take(&mut one.body),
            _ => vec![Stmt::Match(Expr::name("word"), arms)],
        };
        let parameters = vec![state(), ("word".into(), Ty::Size)];
        self.function("follow", "Outputs that follow a step, for 32 steps.", parameters, body);
    }

    /// The parts that come and go with the activity of a step.
    fn step_changes(&mut self, on: bool) {
        let t = self.t;
        let places = counts(t).0;
        let mut arms = Vec::new();
        for (i, step) in t.steps.iter().enumerate() {
            let mut body = Block::new();
            if let Some(e) = t.extras.get(step.extra as usize).copied() {
                if e.uncounted && t.counts.is_some() {
                    body.push(Stmt::Assign(Some(Bin::Sub), s().field("moved"), Expr::size(1)));
                }
                self.contributions(&mut body, e.contributions, &places, on);
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
        let (name, note) = if on {
            ("step_on", "The parts that come with a step.")
        } else {
            ("step_off", "The parts that go with a step.")
        };
        self.choice(name, note, "step", arms);
    }

    /// `places`: by control block, where its inputs are counted.
    fn contributions(&self, body: &mut Block, rows: Rows, places: &[usize], on: bool) {
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
            let (now, fails) = self.value(w.code, Type::Bool, &format!("watched_{i}"));
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
                    let (one, f1) = self.value(up, Type::Time, &format!("time_on_{i}"));
                    let (two, f2) = self.value(down, Type::Time, &format!("time_off_{i}"));
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
        if !self.facts.has_lists {
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
                    if self.facts.late {
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
            if self.facts.sequential {
                self.choice(&format!("run_{name}"), note, "step", run);
            }
        }
    }

    pub(crate) fn numbers(&mut self, name: &str, note: &str, values: &[u32]) {
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
        self.starts(name, lists.iter().map(Vec::len));
        self.numbers(name, note, &lists.concat());
    }

    /// Rows of names, each with what it is for.
    fn named_table(&mut self, name: &str, note: &str, rows: Vec<Vec<Expr>>, notes: Vec<String>, of: usize) {
        let bits = if of < 256 {
            8
        } else if of < 65_536 {
            16
        } else {
            32
        };
        let ty = Ty::Int { signed: false, bits };
        let values: usize = rows.iter().map(Vec::len).sum();
        let cast = |row: Vec<Expr>| -> Vec<Expr> { row.into_iter().map(|e| e.cast(ty.clone())).collect() };
        let rows = rows.into_iter().map(cast).zip(notes).collect();
        self.m.consts.push(Const {
            public: false,
            note: note.to_owned(),
            name: name.to_owned(),
            value: if values == 0 { Known::Many(Vec::new()) } else { Known::Rows(rows) },
            ty: Ty::Array(Box::new(ty), values),
        });
    }

    /// Steps of each transition, one row behind the other, and where each begins.
    fn step_lists(&mut self, name: &str, note: &str, lists: &[Vec<u32>], notes: &[String]) {
        self.starts(name, lists.iter().map(Vec::len));
        let names = |list: &Vec<u32>| list.iter().map(|s| self.step(StepId(*s))).collect();
        let rows = lists.iter().map(names).collect();
        self.named_table(name, note, rows, notes.to_vec(), self.t.steps.len());
    }

    fn starts(&mut self, name: &str, lengths: impl Iterator<Item = usize>) {
        let mut starts = vec![0];
        let mut end = 0;
        for length in lengths {
            end += length as u32;
            starts.push(end);
        }
        self.numbers(&format!("{name}_AT"), "Where each row begins.", &starts);
    }

    /// Which transitions are looked at from where, and what else the runtime asks of one.
    fn watched(&mut self) {
        let t = self.t;
        let outs: Vec<Vec<u32>> = t.steps.iter().map(|s| Gen::list(&t.outs, s.out)).collect();
        self.starts("OUT", outs.iter().map(Vec::len));
        let names = |list: &Vec<u32>| list.iter().map(|r| self.transition(*r)).collect();
        let rows = outs.iter().map(names).collect();
        let paths =
            (0..t.steps.len() as u32).map(|i| self.c.symbols.step_path(StepId(i)).to_owned()).collect();
        self.named_table("OUT", "The transitions behind each step.", rows, paths, t.transitions.len());
        let charts: Vec<u32> = t.steps.iter().map(|s| s.chart).collect();
        self.numbers("STEP_CHART", "The chart of each step.", &charts);
        self.numbers("SOURCE", "Transitions without a preceding step.", &t.sources);
        let chart = |rank: &u32| t.transitions.get(*rank as usize).map_or(0, |x| x.chart);
        self.numbers("SOURCE_CHART", "Their charts.", &t.sources.iter().map(chart).collect::<Vec<_>>());
        let note = "Transitions that leave nothing to those behind them.";
        self.table("SETTLES", note, Ty::Bool, t.transitions.iter().map(|x| Expr::Bool(x.simple)));
        let none = t.actions.len() as u32;
        let actions = t.transitions.iter().map(|x| x.on_clearing.min(none));
        let note = format!("The action of each transition as it clears; {none} for none.");
        self.numbers("ON_CLEARING", &note, &actions.collect::<Vec<_>>());
    }

    /// The tables that the runtime reads.
    fn tables(&mut self) {
        let t: &Tables = self.t;
        let ids = |steps: Vec<StepId>| steps.into_iter().map(|s| s.0).collect::<Vec<_>>();
        let from: Vec<_> = t.transitions.iter().map(|x| ids(self.ends(x.from, x.more_from))).collect();
        let to: Vec<_> = t.transitions.iter().map(|x| ids(self.ends(x.to, x.more_to))).collect();
        let notes = self.transition_notes();
        self.step_lists("FROM", "The steps before each transition.", &from, &notes);
        self.step_lists("TO", "The steps behind each transition.", &to, &notes);
        self.watched();
        let mut drops: Vec<Vec<u32>> = vec![Vec::new(); t.transitions.len()];
        for (rank, step) in &t.drops {
            drops.get_mut(*rank as usize).into_iter().for_each(|list| list.push(step.0));
        }
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
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
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
                    let next = known.len() as u32 + 1;
                    (*known.entry(set).or_insert(next), list)
                }
            };
            numbers.push(number);
            lists.push(list);
        }
        self.numbers("ORDER_SITUATION", "The situation that each forcing order imposes.", &numbers);
        self.lists_of("ORDER_STEPS", "The steps that each forcing order imposes.", &lists);
        let steps: Vec<u32> = t.orders.iter().map(|o| o.step.0).collect();
        self.numbers("ORDER_STEP", "The step that gives each forcing order.", &steps);
        let charts: Vec<u32> = t.orders.iter().map(|o| o.chart).collect();
        self.numbers("ORDER_CHART", "The chart that each forces.", &charts);
    }

    /// Assigns a word of a variable, of this type where it has no declaration.
    pub(crate) fn assign(&mut self, addr: u32, ty: Type, value: impl FnOnce(Num) -> Expr) -> Block {
        let memory = self.bodies.word(Addr(addr), ty);
        let Some((slot, part)) = self.slot_of(memory) else { return Block::new() };
        let place = slot.place();
        let (place, n) = match slot.shape {
            Shape::One(n) => (place, n),
            Shape::Many(n, _) => (place.at(Expr::size(part)), n),
            Shape::Fb(kind) => match members(kind).get(part) {
                Some((name, n)) => (place.field(*name), *n),
                None => return Block::new(),
            },
            Shape::Text(_) | Shape::Texts(..) => return Block::new(),
        };
        vec![Stmt::set(place, value(n))]
    }
}
