//! One pass: what is blocked and forced, which transitions clear, what becomes
//! of the steps (SEMANTICS section 3).

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_engine::{NONE, Receptivity, Situation, StepId};
use g7_model::Type;

use crate::form::{About, Class, Expr, Section, Stmt, What};
use crate::make::{Make, lower, raise};

/// Transitions out of one step up to which each names those before it.
const FEW: usize = 8;

impl Make<'_> {
    /// The sections of a pass behind the edges and PRE.
    pub(crate) fn pass(&mut self) -> Vec<Section> {
        let sequential = self.t.rules.sequential;
        let marked = !self.t.orders.is_empty() || self.has_hierarchy();
        let mut sections = vec![self.as_it_begins(), self.blocked()];
        sections.push(self.transitions());
        sections.push(self.events());
        sections.push(self.priorities());
        if sequential {
            sections.extend(self.in_turn());
            if marked {
                sections.extend(self.commit(self.steps().collect(), true));
            } else {
                sections.push(self.run_stored());
            }
            return sections;
        }
        if marked {
            sections.push(self.marks());
            sections.extend(self.commit(self.steps().collect(), true));
        } else {
            let mut moving: Vec<u32> = Vec::new();
            for (rank, tr) in (0u32..).zip(&self.t.transitions) {
                moving.extend(self.preceding(tr).chain(self.succeeding(tr)).chain(self.dropped(rank)));
            }
            moving.sort_unstable();
            moving.dedup();
            sections.extend(self.commit(moving, false));
        }
        sections
    }

    /// The values that are remembered as the pass begins.
    fn as_it_begins(&mut self) -> Section {
        let mut s = Section::new("As the pass begins");
        let looked: Vec<StepId> = self
            .memories
            .iter()
            .filter_map(|m| match m.what {
                What::Was(step) => Some(step),
                _ => None,
            })
            .collect();
        for step in looked {
            let (was, active) = (self.flag(What::Was(step)), self.active(step.0));
            s.body.push(Stmt::Set(was, active));
        }
        s
    }

    /// Charts that stand still: those that are not due, and those that an order forces.
    fn blocked(&mut self) -> Section {
        let mut s = Section::new("Forcing orders");
        let t = self.t;
        let has_orders = !t.orders.is_empty();
        if has_orders || self.has_hierarchy() || t.rules.sequential {
            self.clear_marks(&mut s.body);
        }
        let forced: HashSet<u32> = t.orders.iter().map(|o| o.chart).collect();
        for (i, chart) in (0u32..).zip(&t.charts) {
            let due = self.due(chart.period);
            if due.known() != Some(true) || forced.contains(&i) {
                let blocked = self.flag(What::Blocked(i));
                s.body.push(Stmt::Set(blocked, due.negated()));
            }
        }
        let mut earlier: HashMap<u32, Vec<(u32, Situation)>> = HashMap::new();
        for (i, o) in (0u32..).zip(&t.orders) {
            let on_chart = earlier.entry(o.chart).or_default();
            self.order(i, on_chart, &mut s.body);
            on_chart.push((i, o.situation));
        }
        if has_orders {
            for i in 0..t.charts.len() as u32 {
                if let Some(flag) = self.known(What::Disagree(i)) {
                    let kind = g7_engine::FaultKind::Forcing { chart: i };
                    let at = self.c.symbols.charts.get(i as usize).map(|c| c.at).unwrap_or_default();
                    s.body.extend(Stmt::when(Expr::Read(flag), vec![Stmt::Fault(kind, at)]));
                }
            }
        }
        s
    }

    /// Nothing is marked yet.
    pub(crate) fn clear_marks(&mut self, to: &mut Vec<Stmt>) {
        if self.t.orders.is_empty() && !self.has_hierarchy() {
            return;
        }
        for step in self.steps() {
            let (on, off) = (self.flag(What::On(StepId(step))), self.flag(What::Off(StepId(step))));
            to.extend([lower(on), lower(off)]);
        }
    }

    /// A forcing order, behind all that act on the chart of its step; `earlier` are the orders
    /// before it that act on the same chart.
    fn order(&mut self, i: u32, earlier: &[(u32, Situation)], to: &mut Vec<Stmt>) {
        let t = self.t;
        let Some(o) = t.orders.get(i as usize) else { return };
        to.push(Stmt::About(About::Order(i)));
        let acts = self.after_orders(o.step);
        let asks = self.flag(What::Asks(i));
        to.push(Stmt::Set(asks, acts));
        let asks = Expr::Read(asks);
        let mut first = asks.clone();
        for (j, situation) in earlier {
            let imposes = Expr::Read(self.flag(What::Imposes(*j)));
            let differ = self.differ(*situation, o.situation, o.chart);
            if differ.known() != Some(false) {
                let known = self.known(What::Disagree(o.chart)).is_some();
                let flag = self.flag(What::Disagree(o.chart));
                let both = Expr::all([asks.clone(), imposes.clone(), differ]);
                to.push(Stmt::Set(flag, if known { Expr::Read(flag).or(both) } else { both }));
            }
            first = first.and(imposes.negated());
        }
        let imposes = self.flag(What::Imposes(i));
        to.push(Stmt::Set(imposes, first));
        let imposes = Expr::Read(imposes);
        let blocked = self.flag(What::Blocked(o.chart));
        to.extend(raise(blocked, asks));
        if let Situation::Steps(rows) = o.situation {
            for step in self.arcs(rows) {
                let on = self.flag(What::On(*step));
                to.extend(raise(on, imposes.clone()));
            }
            let group = t.charts.get(o.chart as usize).map(|c| c.group);
            for step in group.map_or(0..0, |g| self.group_steps(g)) {
                let off = self.flag(What::Off(StepId(step)));
                let active = self.active(step);
                to.extend(raise(off, imposes.clone().and(active)));
            }
        }
        if self.has_hierarchy() {
            self.cascade(to);
        }
    }

    /// True if an order asks for another situation than one that acts on its chart already.
    fn differ(&mut self, first: Situation, own: Situation, chart: u32) -> Expr {
        match (first, own) {
            (Situation::Current, Situation::Current) => Expr::truth(false),
            (Situation::Steps(a), Situation::Steps(b)) => {
                let (a, b) = (self.arcs(a), self.arcs(b));
                Expr::truth(!(a.iter().all(|x| b.contains(x)) && b.iter().all(|x| a.contains(x))))
            }
            (Situation::Current, Situation::Steps(rows)) => {
                let wanted: Vec<StepId> = self.arcs(rows).to_vec();
                let group = self.t.charts.get(chart as usize).map(|c| c.group);
                let mut other = Vec::new();
                for step in group.map_or(0..0, |g| self.group_steps(g)) {
                    let is_in = self.after_orders(StepId(step));
                    other.push(if wanted.contains(&StepId(step)) { is_in.negated() } else { is_in });
                }
                Expr::any(other)
            }
            // The tables have the orders that keep a situation first.
            (Situation::Steps(_), Situation::Current) => Expr::truth(true),
        }
    }

    /// A step is active after the orders so far.
    fn after_orders(&mut self, step: StepId) -> Expr {
        let (on, off) = (self.flag(What::On(step)), self.flag(What::Off(step)));
        Expr::Read(on).or(self.active(step.0).and(Expr::Read(off).negated()))
    }

    /// Which transitions are clearable, in the order in which the engine asks.
    fn transitions(&mut self) -> Section {
        let mut s = Section::new("Transitions: enabled, and the receptivity true");
        let t = self.t;
        for rank in &t.sources {
            self.transition(*rank, Expr::truth(true), &mut s.body);
        }
        for (i, step) in (0u32..).zip(&t.steps) {
            let outs = t.outs.get(step.out.start as usize..step.out.end as usize).unwrap_or(&[]);
            let one = |rank: &u32| t.transitions.get(*rank as usize).is_some_and(|tr| tr.simple);
            // Behind the first that is clearable, of those that need this step alone, none is asked.
            let settles = !t.rules.multi_token && outs.len() > 1 && outs.iter().all(one);
            let many = settles && outs.len() > FEW;
            if many {
                let settled = self.flag(What::Settled(StepId(i)));
                s.body.push(lower(settled));
            }
            let mut before = Vec::new();
            for rank in outs {
                let free = if many {
                    Expr::Read(self.flag(What::Settled(StepId(i)))).negated()
                } else if settles {
                    Expr::all(before.iter().cloned())
                } else {
                    Expr::truth(true)
                };
                let clearable = self.transition(*rank, free, &mut s.body);
                if many {
                    let settled = self.flag(What::Settled(StepId(i)));
                    s.body.extend(raise(settled, clearable));
                } else if settles {
                    before.push(clearable.negated());
                }
            }
        }
        s
    }

    /// One transition; gives whether it is clearable.
    fn transition(&mut self, rank: u32, free: Expr, to: &mut Vec<Stmt>) -> Expr {
        let t = self.t;
        let Some(tr) = t.transitions.get(rank as usize) else { return Expr::truth(false) };
        let mut enabled = Vec::new();
        if let Some(blocked) = self.known(What::Blocked(tr.chart)) {
            enabled.push(Expr::Read(blocked).negated());
        }
        for step in self.preceding(tr) {
            enabled.push(self.active(step));
        }
        enabled.push(free);
        let enabled = Expr::all(enabled);
        let (list, receptivity) = match tr.receptivity {
            Receptivity::True => (Vec::new(), Expr::truth(true)),
            Receptivity::Word(a) => (Vec::new(), Expr::Read(self.word(a, Type::Bool).0)),
            Receptivity::NotWord(a) => (Vec::new(), Expr::Read(self.word(a, Type::Bool).0).negated()),
            Receptivity::Code(code) => self.value(code),
        };
        to.push(Stmt::About(About::Transition(rank)));
        let clearable = self.flag(What::Clearable(rank));
        if list.is_empty() {
            let mut receptivity = receptivity;
            if self.options.receptivities && receptivity.known().is_none() {
                let own = self.flag(What::Receptivity(rank));
                to.push(Stmt::Set(own, receptivity));
                receptivity = Expr::Read(own);
            }
            to.push(Stmt::Set(clearable, enabled.and(receptivity)));
        } else {
            // A transition that is not enabled is not asked: its receptivity could fail.
            to.push(lower(clearable));
            let mut list = list;
            list.push(Stmt::Set(clearable, receptivity));
            to.extend(Stmt::when(enabled, list));
        }
        Expr::Read(clearable)
    }

    /// Of the clearable transitions that share a step, those that clear.
    fn priorities(&mut self) -> Section {
        let mut s = Section::new("Of those that share a step, the best priority clears");
        let t = self.t;
        let numbered = t.rules.multi_token && t.rules.numbered_exclusive;
        if t.rules.multi_token && !numbered {
            return s;
        }
        let mut behind: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            if tr.shares {
                for step in self.preceding(tr) {
                    behind.entry(step).or_default().push(rank);
                }
            }
        }
        let contested: Vec<u32> = (0u32..)
            .zip(&t.transitions)
            .filter(|(_, tr)| tr.shares && (t.rules.multi_token || !tr.simple))
            .map(|(rank, _)| rank)
            .collect();
        if behind.values().any(|list| list.len() > FEW) {
            s.body = self.by_step(&behind, &contested, numbered);
        } else {
            for rank in contested {
                self.by_name(rank, &behind, numbered, &mut s.body);
            }
        }
        s
    }

    /// A transition clears unless one of those before it does, each by its name.
    fn by_name(&mut self, rank: u32, behind: &BTreeMap<u32, Vec<u32>>, numbered: bool, to: &mut Vec<Stmt>) {
        let Some(tr) = self.t.transitions.get(rank as usize) else { return };
        let rivals: BTreeSet<u32> =
            self.preceding(tr).filter_map(|s| behind.get(&s)).flatten().copied().collect();
        let before = |r: &u32| if numbered { self.priority(*r) < tr.priority } else { *r < rank };
        let ahead: Vec<u32> = rivals.into_iter().filter(before).collect();
        if ahead.is_empty() {
            return;
        }
        let mut parts = vec![Expr::Read(self.flag(What::Clearable(rank)))];
        for other in ahead {
            let e = if numbered { Expr::Read(self.flag(What::Clearable(other))) } else { self.clears(other) };
            parts.push(e.negated());
        }
        let clears = self.flag(What::Clears(rank));
        to.push(Stmt::About(About::Transition(rank)));
        to.push(Stmt::Set(clears, Expr::all(parts)));
    }

    /// The same with a memory for each step that one of those before has taken it: the
    /// names of all would be as many as the square of the transitions.
    fn by_step(&mut self, behind: &BTreeMap<u32, Vec<u32>>, contested: &[u32], numbered: bool) -> Vec<Stmt> {
        let mut list: Vec<Stmt> =
            behind.keys().map(|step| lower(self.flag(What::Taken(StepId(*step))))).collect();
        let mut sharing: Vec<u32> = behind.values().flatten().copied().collect();
        sharing.sort_unstable();
        sharing.dedup();
        if numbered {
            sharing.sort_by_key(|rank| self.priority(*rank));
        }
        let same = |a: &u32, b: &u32| numbered && self.priority(*a) == self.priority(*b);
        let groups: Vec<Vec<u32>> = sharing.chunk_by(same).map(<[u32]>::to_vec).collect();
        for group in groups {
            let mut takes = Vec::new();
            for rank in group {
                let Some(tr) = self.t.transitions.get(rank as usize) else { continue };
                let taken: Vec<_> = self.preceding(tr).map(|s| self.flag(What::Taken(StepId(s)))).collect();
                let clearable = Expr::Read(self.flag(What::Clearable(rank)));
                if contested.binary_search(&rank).is_ok() {
                    let clears = self.flag(What::Clears(rank));
                    let free = taken.iter().map(|m| Expr::Read(*m).negated());
                    let parts = std::iter::once(clearable.clone()).chain(free);
                    list.push(Stmt::About(About::Transition(rank)));
                    list.push(Stmt::Set(clears, Expr::all(parts)));
                }
                // Numbered, a transition keeps those behind it back whether it clears or not.
                let takes_it = if numbered { clearable } else { self.clears(rank) };
                takes.extend(taken.into_iter().flat_map(|m| raise(m, takes_it.clone())));
            }
            list.extend(takes);
        }
        list
    }

    fn priority(&self, rank: u32) -> u32 {
        self.t.transitions.get(rank as usize).map_or(NONE, |x| x.priority)
    }

    /// A transition clears.
    pub(crate) fn clears(&mut self, rank: u32) -> Expr {
        let memory = self.known(What::Clears(rank));
        Expr::Read(memory.unwrap_or_else(|| self.flag(What::Clearable(rank))))
    }

    /// By step: what activates it, and what deactivates it.
    pub(crate) fn turns(&mut self) -> BTreeMap<u32, (Vec<Expr>, Vec<Expr>)> {
        let t = self.t;
        let mut all: BTreeMap<u32, (Vec<Expr>, Vec<Expr>)> = BTreeMap::new();
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let clears = self.clears(rank);
            for step in self.preceding(tr).chain(self.dropped(rank)) {
                all.entry(step).or_default().1.push(clears.clone());
            }
            for step in self.succeeding(tr) {
                all.entry(step).or_default().0.push(clears.clone());
            }
        }
        all
    }

    /// Marks of the transitions that clear.
    fn marks(&mut self) -> Section {
        let mut s = Section::new("Steps that the transitions activate and deactivate");
        for (step, (on, off)) in self.turns() {
            for (what, list) in [(What::On(StepId(step)), on), (What::Off(StepId(step)), off)] {
                let mark = self.flag(what);
                s.body.extend(raise(mark, Expr::any(list)));
            }
        }
        s
    }

    /// Enclosing steps, the outermost first.
    fn enclosing(&self) -> Vec<u32> {
        let mut around: BTreeMap<u32, u32> = BTreeMap::new();
        let all: Vec<u32> = self
            .steps()
            .filter(|s| {
                let e = self.extra(*s);
                !e.encloses.is_empty() || !e.links.is_empty()
            })
            .collect();
        for step in &all {
            for group in self.enclosed(*step) {
                for inner in self.group_steps(*group) {
                    around.insert(inner, *step);
                }
            }
        }
        let depth = |step: u32| {
            let (mut at, mut depth) = (step, 0usize);
            while let Some(outer) = around.get(&at).filter(|o| **o != at && depth <= all.len()) {
                at = *outer;
                depth += 1;
            }
            depth
        };
        let mut sorted: Vec<(usize, u32)> = all.iter().map(|s| (depth(*s), *s)).collect();
        sorted.sort_unstable();
        sorted.into_iter().map(|s| s.1).collect()
    }

    /// Enclosed charts follow their enclosing steps, through all levels.
    pub(crate) fn cascade(&mut self, to: &mut Vec<Stmt>) {
        let enclosing = self.enclosing();
        for step in &enclosing {
            let inside = self.inside(*step);
            if inside.is_empty() {
                continue;
            }
            let (on, off) = (self.flag(What::On(StepId(*step))), self.flag(What::Off(StepId(*step))));
            let leaves = Expr::all([Expr::Read(off), Expr::Read(on).negated(), self.active(*step)]);
            let mut then = Vec::new();
            for inner in inside {
                let (on, off) = (self.flag(What::On(StepId(inner))), self.flag(What::Off(StepId(inner))));
                then.push(lower(on));
                let active = self.active(inner);
                then.extend(raise(off, active));
            }
            to.extend(Stmt::when(leaves, then));
        }
        for step in &enclosing {
            let on = self.flag(What::On(StepId(*step)));
            let comes = Expr::Read(on).and(self.active(*step).negated());
            for link in self.arcs(self.extra(*step).links) {
                let on = self.flag(What::On(*link));
                to.extend(raise(on, comes.clone()));
            }
        }
    }

    /// Stored actions on event: of the steps that are active as the pass begins.
    fn events(&mut self) -> Section {
        let mut s = Section::new("Actions on event");
        let t = self.t;
        for action in self.stored_in_pass() {
            let runs = self.flag(What::Runs(action));
            s.body.push(lower(runs));
        }
        for step in self.steps() {
            let rows = self.extra(step).events;
            for e in t.events.get(rows.start as usize..rows.end as usize).unwrap_or(&[]) {
                let due = t.actions.get(e.action as usize).map_or(0, |a| a.period);
                let looks = self.active(step).and(self.due(due));
                let (mut list, event) = self.value(e.event);
                let runs = self.flag(What::Runs(e.action));
                s.body.push(Stmt::About(About::Action(e.action)));
                if list.is_empty() {
                    s.body.extend(raise(runs, looks.and(event)));
                } else {
                    list.extend(raise(runs, event));
                    s.body.extend(Stmt::when(looks, list));
                }
            }
        }
        s
    }

    /// A memory of the pass that keeps a value of the variables that its actions write.
    pub(crate) fn begun(&mut self, memory: crate::form::MemoryId) -> crate::form::MemoryId {
        self.beside(What::Begun(memory), memory)
    }

    /// True if the pass changed something, where passes go on until none does.
    pub(crate) fn changed(&mut self) -> Option<crate::form::MemoryId> {
        self.t.rules.stable.then(|| self.memory(What::Changed, Class::Scratch, Type::Bool))
    }
}
