//! The change of the situation: orders, transitions, marks, what activity
//! starts and stops, and the stored actions of a pass.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};

use g7_engine::{GroupId, NONE, Situation, StepId};

use super::form::{Ex, Section, St};
use super::plan::Plan;
use super::vars::Ty;

impl Plan<'_> {
    /// The sections of a pass behind its edges.
    pub(crate) fn moves(&mut self) -> Vec<Section> {
        let hierarchy = self.has_hierarchy();
        let mut blocked = BTreeMap::new();
        let mut forcing = Section::new("Forcing orders");
        if !self.t.orders.is_empty() {
            self.forcing(&mut forcing, &mut blocked);
        }
        let transitions = self.transitions(&blocked);
        if self.t.rules.sequential {
            let mut all = vec![transitions];
            all.extend(self.in_turn());
            return all;
        }
        let marked = hierarchy || !self.t.orders.is_empty();
        let mut marks = Section::new("What goes on and off");
        if marked {
            self.marks(&mut marks);
        }
        let runs = self.stored_runs();
        let plain = runs.is_empty()
            && !marked
            && !self.t.rules.stable
            && self.timed.is_empty()
            && self.counted.is_empty()
            && !self.has_timed_groups()
            && !self.late_lists();
        let mut next = Section::new("The next situation");
        if plain {
            self.situation(&mut next, marked, "X");
            return vec![forcing, transitions, marks, next];
        }
        let moving = self.situation(&mut next, marked, "N");
        let mut come = HashMap::new();
        for step in &moving {
            let (now, then) = (self.active(*step), self.next(*step, &moving));
            come.insert(*step, (then.clone().and(now.clone().not()), now.and(then.not())));
        }
        let runs = self.resolved(&runs, &come);
        let late = self.late_runs(&come);
        let mut acts = Section::new("Stored actions");
        for (action, when) in late {
            let name = self.late_flag(action);
            acts.set("", name, when);
        }
        let mut change = Section::new("The situation");
        if self.t.rules.stable {
            self.changed(&mut change, &moving);
        }
        let mut behind = Section::new("Stored actions");
        if self.t.rules.parallel_actions {
            self.parallel(&mut acts, runs);
        } else {
            let mut runs = runs;
            runs.sort_by_key(|r| r.0);
            let mut watched: Vec<(String, Ty)> = Vec::new();
            for (action, when) in runs {
                // What starts it is judged before the situation changes.
                let flag = self.memory("A", &(action + 1).to_string(), Ty::BOOL, "this action runs");
                acts.assign("", flag.clone(), when);
                let at = behind.rungs.len();
                self.run(&mut behind, action, Ex::Var(flag));
                for new in self.written(behind.rungs.get(at..).unwrap_or(&[])) {
                    if !watched.contains(&new) {
                        watched.push(new);
                    }
                }
            }
            if self.t.rules.stable {
                for (name, ty) in watched {
                    let old = format!("P_{name}");
                    self.declare(&old, ty.name(), "as the pass began");
                    acts.act("", Ex::Bool(true), vec![St::set(old.clone(), Ex::var(name.clone()))]);
                    let (a, b) = (Ex::Var(name), Ex::Var(old));
                    let differs = if ty == Ty::BOOL { a.xor(b) } else { Ex::op("<>", a, b) };
                    behind.set("", "CHANGED", differs);
                }
            }
        }
        self.stamps(&mut change, &come);
        let nexts: HashMap<u32, Ex> = moving.iter().map(|s| (*s, self.next(*s, &moving))).collect();
        let actives: Vec<Ex> = (0..self.t.steps.len() as u32).map(|s| self.active(s)).collect();
        self.group_stamps(&mut change, |s| {
            nexts.get(&s).cloned().or_else(|| actives.get(s as usize).cloned()).unwrap_or(Ex::Bool(false))
        });
        for step in &moving {
            let (x, n) = (self.step(StepId(*step)), self.next(*step, &moving));
            change.assign("", x, n);
        }
        self.take_next(&mut behind, None);
        vec![forcing, transitions, marks, next, acts, change, behind]
    }

    pub(crate) fn has_hierarchy(&self) -> bool {
        self.t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty())
    }

    fn late_lists(&self) -> bool {
        self.t.rules.late_actions && self.t.extras.iter().any(|e| !e.on.is_empty() || !e.off.is_empty())
    }

    fn next(&self, step: u32, moving: &BTreeSet<u32>) -> Ex {
        if moving.contains(&step) {
            Ex::Var(format!("N_{}", self.step(StepId(step)).trim_start_matches("X_")))
        } else {
            self.active(step)
        }
    }

    fn changed(&mut self, s: &mut Section, moving: &BTreeSet<u32>) {
        let all: Vec<Ex> =
            moving.iter().map(|step| self.active(*step).xor(self.next(*step, moving))).collect();
        s.assign("", "CHANGED", Ex::any(all.iter().take(6).cloned()));
        for part in all.get(6..).unwrap_or(&[]).chunks(6) {
            s.set("", "CHANGED", Ex::any(part.iter().cloned()));
        }
    }

    /// Transitions by what they do to each step: (on, off).
    fn turns(&self) -> BTreeMap<u32, (Vec<Ex>, Vec<Ex>)> {
        let mut all: BTreeMap<u32, (Vec<Ex>, Vec<Ex>)> = BTreeMap::new();
        for (i, t) in self.t.transitions.iter().enumerate() {
            let e = || Ex::Var(self.transitions.get(i).cloned().unwrap_or_default());
            for step in self.preceding(t) {
                all.entry(step).or_default().1.push(e());
            }
            for step in self.dropped(i as u32) {
                all.entry(step).or_default().1.push(e());
            }
            for step in self.succeeding(t) {
                all.entry(step).or_default().0.push(e());
            }
        }
        all
    }

    fn dropped(&self, rank: u32) -> Vec<u32> {
        self.t.drops.iter().filter(|d| d.0 == rank).map(|d| d.1.0).collect()
    }

    /// Equations of the steps that can change; which these are.
    fn situation(&mut self, s: &mut Section, marked: bool, before: &str) -> BTreeSet<u32> {
        let turns = self.turns();
        let moving: BTreeSet<u32> =
            if marked { (0..self.t.steps.len() as u32).collect() } else { turns.keys().copied().collect() };
        let name = |p: &Self, step: u32| {
            let x = p.step(StepId(step));
            if before == "X" { x } else { format!("N_{}", x.trim_start_matches("X_")) }
        };
        for step in &moving {
            let to = name(self, *step);
            if before == "N" {
                self.declare(&to, "BOOL", "the next situation");
            }
            let note = format!("step {}", self.c.symbols.step_path(StepId(*step)));
            let (on, off) = if marked {
                (self.mark("ON", *step), self.mark("OFF", *step))
            } else {
                let (on, off) = turns.get(step).cloned().unwrap_or_default();
                (Ex::any(on), Ex::any(off))
            };
            if self.set_reset && !marked {
                if before == "N" {
                    s.assign(note, to, self.active(*step));
                }
                continue;
            }
            let stays = self.active(*step).and(off.not());
            s.assign(note, to, on.or(stays));
        }
        if self.set_reset && !marked {
            for (on, title) in [(false, "off"), (true, "on")] {
                for step in &moving {
                    let (sets, resets) = turns.get(step).cloned().unwrap_or_default();
                    let when = Ex::any(if on { sets } else { resets });
                    let note = format!("step {} {title}", self.c.symbols.step_path(StepId(*step)));
                    match on {
                        true => s.set(note, name(self, *step), when),
                        false => s.reset(note, name(self, *step), when),
                    }
                }
            }
        }
        moving
    }

    fn mark(&mut self, which: &str, step: u32) -> Ex {
        let name = format!("{which}_{}", self.step(StepId(step)).trim_start_matches("X_"));
        self.declare(&name, "BOOL", if which == "ON" { "goes on" } else { "goes off" });
        Ex::Var(name)
    }

    fn mark_name(&mut self, which: &str, step: u32) -> String {
        match self.mark(which, step) {
            Ex::Var(name) => name,
            _ => String::new(),
        }
    }

    /// Orders in the partial order of the charts: what each imposes.
    fn forcing(&mut self, s: &mut Section, blocked: &mut BTreeMap<u32, String>) {
        for step in 0..self.t.steps.len() as u32 {
            for which in ["ON", "OFF"] {
                let name = self.mark_name(which, step);
                s.assign("", name, Ex::Bool(false));
            }
        }
        let orders = self.t.orders.clone();
        for o in &orders {
            let chart =
                self.c.symbols.charts.get(o.chart as usize).map_or(String::new(), |c| c.name.to_string());
            if let Entry::Vacant(place) = blocked.entry(o.chart) {
                let name = self.memory("FORCED", &chart, Ty::BOOL, "its transitions do not clear");
                s.assign("", name.clone(), Ex::Bool(false));
                place.insert(name);
            }
        }
        let mut acting: Vec<String> = Vec::new();
        for (i, o) in orders.iter().enumerate() {
            let n = (i + 1).to_string();
            let note = format!("order of step {}", self.c.symbols.step_path(o.step));
            let acts = {
                let (on, off) = (self.mark("ON", o.step.0), self.mark("OFF", o.step.0));
                on.or(self.active(o.step.0).and(off.not()))
            };
            let asks = self.memory("ASKS", &n, Ty::BOOL, "a forcing order acts");
            s.assign(note, asks.clone(), acts);
            let earlier: Vec<usize> =
                (0..i).filter(|j| orders.get(*j).is_some_and(|e| e.chart == o.chart)).collect();
            let mut first = Ex::var(asks.clone());
            for j in &earlier {
                let Some(other) = acting.get(*j).cloned() else { continue };
                if !orders.get(*j).is_some_and(|e| self.agree(e.situation, o.situation)) {
                    s.set("", "FAULT", Ex::var(asks.clone()).and(Ex::var(other.clone())));
                }
                first = first.and(Ex::var(other).not());
            }
            let own = if earlier.is_empty() {
                asks.clone()
            } else {
                let name = self.memory("IMPOSES", &n, Ty::BOOL, "");
                s.assign("", name.clone(), first);
                name
            };
            acting.push(own.clone());
            if let Some(name) = blocked.get(&o.chart).cloned() {
                s.set("", name, Ex::var(asks));
            }
            let Situation::Steps(rows) = o.situation else { continue };
            let wanted = self.arcs(rows);
            let group = self.t.charts.get(o.chart as usize).map_or(GroupId(0), |c| c.group);
            let steps = self.t.groups.get(group.0 as usize).map_or(0..0, |g| g.steps.start..g.steps.end);
            for step in steps {
                let (on, off) = (self.mark_name("ON", step), self.mark_name("OFF", step));
                let (x, own) = (self.active(step), Ex::var(own.clone()));
                if wanted.contains(&step) {
                    s.set("", on.clone(), own.clone().and(x.clone().not()));
                    s.reset("", on, own.clone().and(x.clone()));
                    s.reset("", off, own.and(x));
                } else {
                    s.set("", off, own.and(x));
                }
            }
            if self.has_hierarchy() {
                self.cascade(s);
            }
        }
    }

    fn agree(&self, a: Situation, b: Situation) -> bool {
        match (a, b) {
            (Situation::Current, Situation::Current) => true,
            (Situation::Steps(a), Situation::Steps(b)) => {
                let (a, b): (BTreeSet<u32>, BTreeSet<u32>) =
                    (self.arcs(a).into_iter().collect(), self.arcs(b).into_iter().collect());
                a == b
            }
            _ => false,
        }
    }

    /// Marks of the transitions, then what enclosing steps take and bring.
    fn marks(&mut self, s: &mut Section) {
        let turns = self.turns();
        let forced = !self.t.orders.is_empty();
        for step in 0..self.t.steps.len() as u32 {
            let (on, off) = turns.get(&step).cloned().unwrap_or_default();
            for (which, list) in [("ON", on), ("OFF", off)] {
                let name = self.mark_name(which, step);
                if forced {
                    s.set("", name, Ex::any(list));
                } else {
                    s.assign("", name, Ex::any(list));
                }
            }
        }
        if self.has_hierarchy() {
            self.cascade(s);
        }
    }

    /// Enclosing steps, those further out first.
    fn enclosing(&self) -> Vec<u32> {
        let groups = |step: u32| -> Vec<std::ops::Range<u32>> {
            let rows = self.extra(step).encloses;
            let list = self.t.group_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
            list.iter()
                .filter_map(|g| self.t.groups.get(g.0 as usize).map(|g| g.steps.start..g.steps.end))
                .collect()
        };
        let all: Vec<u32> = (0..self.t.steps.len() as u32)
            .filter(|s| {
                let e = self.extra(*s);
                !e.encloses.is_empty() || !e.links.is_empty()
            })
            .collect();
        let depth = |step: u32| {
            let (mut step, mut depth) = (step, 0);
            while let Some(around) =
                all.iter().copied().find(|e| *e != step && groups(*e).iter().any(|g| g.contains(&step)))
            {
                step = around;
                depth += 1;
                if depth > all.len() {
                    break;
                }
            }
            depth
        };
        let mut sorted: Vec<(usize, u32)> = all.iter().map(|s| (depth(*s), *s)).collect();
        sorted.sort_unstable();
        sorted.into_iter().map(|s| s.1).collect()
    }

    fn cascade(&mut self, s: &mut Section) {
        let enclosing = self.enclosing();
        for step in &enclosing {
            let rows = self.extra(*step).encloses;
            if rows.is_empty() {
                continue;
            }
            let leaves = Ex::all([self.mark("OFF", *step), self.mark("ON", *step).not(), self.active(*step)]);
            let groups =
                self.t.group_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]).to_vec();
            for g in groups {
                let steps = self.t.groups.get(g.0 as usize).map_or(0..0, |g| g.steps.start..g.steps.end);
                for inner in steps {
                    let (on, off) = (self.mark_name("ON", inner), self.mark_name("OFF", inner));
                    s.reset("", on, leaves.clone());
                    s.set("", off, leaves.clone().and(self.active(inner)));
                }
            }
        }
        for step in &enclosing {
            let comes = self.mark("ON", *step).and(self.active(*step).not());
            for link in self.arcs(self.extra(*step).links) {
                let on = self.mark_name("ON", link);
                s.set("", on, comes.clone());
            }
        }
    }

    /// Transitions one after the other, with their actions at once.
    fn in_turn(&mut self) -> Vec<Section> {
        let mut flags = Section::new("Actions on event");
        let mut behind = Section::new("Stored actions");
        let runs = self.event_runs();
        for (action, when) in runs {
            let flag = self.memory("A", &(action + 1).to_string(), Ty::BOOL, "this action runs");
            flags.assign("", flag.clone(), when);
            self.run(&mut behind, action, Ex::Var(flag));
        }
        if self.t.rules.stable {
            self.cannot(0, "a search for stability under transitions that clear in turn");
        }
        let mut s = Section::new("Transitions clear in turn");
        let all = self.t.transitions.clone();
        for (i, t) in all.iter().enumerate() {
            let fires = Ex::Var(self.transitions.get(i).cloned().unwrap_or_default());
            let note = self.transitions.get(i).cloned().unwrap_or_default();
            if t.on_clearing != NONE {
                self.run(&mut s, t.on_clearing, fires.clone());
            }
            let leaving: Vec<u32> = self.preceding(t).into_iter().chain(self.dropped(i as u32)).collect();
            for (step, on) in leaving
                .into_iter()
                .map(|s| (s, false))
                .chain(self.succeeding(t).into_iter().map(|s| (s, true)))
            {
                let x = self.active(step);
                let mut body = self.turn(step, on);
                let name = self.step(StepId(step));
                if body.len() == 1 {
                    match on {
                        true => s.set(note.clone(), name, fires.clone()),
                        false => s.reset(note.clone(), name, fires.clone()),
                    }
                    continue;
                }
                let when = fires.clone().and(if on { x.not() } else { x });
                s.act(note.clone(), when, std::mem::take(&mut body));
            }
        }
        vec![flags, s, behind]
    }

    /// What happens as a step is left or entered by itself.
    fn turn(&mut self, step: u32, on: bool) -> Vec<St> {
        let mut body = Vec::new();
        let e = self.extra(step);
        let actions: Vec<St> = self
            .action_list(if on { e.on } else { e.off })
            .into_iter()
            .flat_map(|a| {
                if self.t.rules.late_actions {
                    vec![St::set(self.late_flag(a), Ex::Bool(true))]
                } else {
                    let (c, body) = self.action(a);
                    St::when(c, body)
                }
            })
            .collect();
        let name = self.step(StepId(step)).trim_start_matches("X_").to_owned();
        let mut stamps = Vec::new();
        if self.timed.contains(&step) && (on || !self.t.rules.keep_step_time) {
            stamps.push(St::set(format!("XT_{name}"), Ex::Time(0)));
            if on {
                stamps.push(St::set(format!("XS_{name}"), Ex::var("NOW")));
            }
        }
        if self.counted.contains(&step) && (on || !self.t.rules.keep_step_time) {
            stamps.push(St::set(format!("XN_{name}"), Ex::Int(0)));
        }
        if !on {
            body.extend(actions.clone());
        }
        body.push(St::set(self.step(StepId(step)), Ex::Bool(on)));
        body.extend(stamps);
        if on {
            body.extend(actions);
        }
        body
    }
}
