//! The consequences of a change of steps: stored actions, times, conditions of
//! qualifiers; and transitions that clear one after the other.

use std::collections::BTreeSet;

use g7_engine::{Cmp, NONE, StepId};
use g7_model::Type;

use crate::form::{About, Class, Expr, MemoryId, Section, Stmt, What};
use crate::make::{Make, lower, raise};

impl Make<'_> {
    /// The actions that run within a pass: on clearing and event, and those on
    /// activation and deactivation where they do not wait for the end of the scan.
    pub(crate) fn stored_in_pass(&self) -> Vec<u32> {
        let t = self.t;
        let mut found: BTreeSet<u32> = t.events.iter().map(|e| e.action).collect();
        found.extend(t.transitions.iter().map(|t| t.on_clearing).filter(|a| *a != NONE));
        if !t.rules.late_actions {
            for e in &t.extras {
                found.extend(self.actions(e.on));
                found.extend(self.actions(e.off));
            }
        }
        found.into_iter().collect()
    }

    /// Draws the consequences of the marks (or, without marks, of the transitions
    /// that clear) for these steps.
    pub(crate) fn commit(&mut self, moving: Vec<u32>, marked: bool) -> Vec<Section> {
        let mut next = Section::new("The next situation");
        if marked && self.has_hierarchy() {
            self.cascade(&mut next.body);
        }
        let turns = if marked { Default::default() } else { self.turns() };
        for step in &moving {
            let (on, off) = if marked {
                (
                    Expr::Read(self.flag(What::On(StepId(*step)))),
                    Expr::Read(self.flag(What::Off(StepId(*step)))),
                )
            } else {
                let (on, off) = turns.get(step).cloned().unwrap_or_default();
                (Expr::any(on), Expr::any(off))
            };
            let active = self.active(*step);
            let to = self.flag(What::Next(StepId(*step)));
            next.body.push(Stmt::About(About::Step(StepId(*step))));
            next.body.push(Stmt::Set(to, on.or(active.and(off.negated()))));
        }
        let gathered = self.gather(&moving, !self.t.rules.sequential);
        if self.t.rules.parallel_actions {
            let run = self.run_stored();
            let apply = self.apply(&moving, false);
            let give = self.give();
            vec![next, gathered, run, apply, give]
        } else {
            let begun = self.note_begun();
            let apply = self.apply(&moving, false);
            let run = self.run_stored();
            let compare = self.compare_begun();
            vec![next, gathered, begun, apply, run, compare]
        }
    }

    fn comes(&mut self, step: u32) -> Expr {
        let next = Expr::Read(self.flag(What::Next(StepId(step))));
        next.and(self.active(step).negated())
    }

    fn goes(&mut self, step: u32) -> Expr {
        let next = Expr::Read(self.flag(What::Next(StepId(step))));
        self.active(step).and(next.negated())
    }

    /// The stored actions of the steps that change, and of the transitions that clear.
    fn gather(&mut self, moving: &[u32], clearing: bool) -> Section {
        let mut s = Section::new("Stored actions that run");
        let t = self.t;
        if clearing {
            for (rank, tr) in (0u32..).zip(&t.transitions) {
                if tr.on_clearing != NONE {
                    let runs = self.flag(What::Runs(tr.on_clearing));
                    let clears = self.clears(rank);
                    s.body.extend(raise(runs, clears));
                }
            }
        }
        for step in moving {
            let e = self.extra(*step);
            for (rows, on) in [(e.off, false), (e.on, true)] {
                for action in self.actions(rows) {
                    let flag = self.run_flag(*action);
                    let when = if on { self.comes(*step) } else { self.goes(*step) };
                    s.body.push(Stmt::About(About::Action(*action)));
                    s.body.extend(raise(flag, when));
                }
            }
        }
        s
    }

    /// The flag by which an action on activation or deactivation runs.
    fn run_flag(&mut self, action: u32) -> MemoryId {
        if self.t.rules.late_actions { self.late(action) } else { self.flag(What::Runs(action)) }
    }

    /// The flag by which an action runs at the end of the scan.
    pub(crate) fn late(&mut self, action: u32) -> MemoryId {
        self.flag(What::Late(action))
    }

    /// Runs the gathered actions in their order.
    pub(crate) fn run_stored(&mut self) -> Section {
        let mut s = Section::new("Stored actions");
        for action in self.stored_in_pass() {
            let runs = Expr::Read(self.flag(What::Runs(action)));
            let parallel = self.t.rules.parallel_actions;
            let body = if parallel { self.run_apart(action) } else { self.run(action) };
            s.body.push(Stmt::About(About::Action(action)));
            s.body.extend(Stmt::when(runs, body));
        }
        if self.t.rules.parallel_actions {
            let noted: Vec<MemoryId> = self.given().into_iter().map(|m| self.flag(What::Wrote(m))).collect();
            let first = noted.into_iter().map(lower);
            s.body.splice(0..0, first);
        }
        s
    }

    /// The memories that the actions of a pass give values to.
    fn given(&self) -> Vec<MemoryId> {
        let found = self.memories.iter().filter_map(|m| match m.what {
            What::Given(of) => Some(of),
            _ => None,
        });
        found.collect()
    }

    /// The values given in this pass are taken, the last one of each memory.
    pub(crate) fn give(&mut self) -> Section {
        let mut s = Section::new("The values that the stored actions give");
        for m in self.given() {
            let (given, wrote) = (self.beside(What::Given(m), m), self.flag(What::Wrote(m)));
            let mut then = Vec::new();
            if let Some(changed) = self.changed() {
                let ty = self.of(m).map_or(Type::Bool, |m| m.ty);
                let differs = Expr::Differs(ty, Box::new(Expr::Read(given)), Box::new(Expr::Read(m)));
                then.extend(raise(changed, differs));
            }
            then.push(Stmt::Set(m, Expr::Read(given)));
            s.body.push(Stmt::If(Expr::Read(wrote), then, Vec::new()));
        }
        s
    }

    /// The lasting memories that the actions of a pass write.
    fn written_in_pass(&mut self) -> Vec<MemoryId> {
        let mut found = BTreeSet::new();
        for action in self.stored_in_pass() {
            if let Some(a) = self.t.actions.get(action as usize).copied() {
                found.extend(self.written(a.body));
            }
        }
        found.into_iter().collect()
    }

    /// Under search for stability: what the variables were.
    pub(crate) fn note_begun(&mut self) -> Section {
        let mut s = Section::new("What the stored actions may change");
        if self.t.rules.stable {
            for m in self.written_in_pass() {
                let begun = self.begun(m);
                s.body.push(Stmt::Set(begun, Expr::Read(m)));
            }
        }
        s
    }

    /// Under search for stability: a variable that differs is a change.
    pub(crate) fn compare_begun(&mut self) -> Section {
        let mut s = Section::new("What has changed");
        if let Some(changed) = self.changed() {
            for m in self.written_in_pass() {
                let begun = self.begun(m);
                let ty = self.of(m).map_or(Type::Bool, |m| m.ty);
                let differs = Expr::Differs(ty, Box::new(Expr::Read(m)), Box::new(Expr::Read(begun)));
                s.body.extend(raise(changed, differs));
            }
        }
        s
    }

    /// Takes over the next situation, with the times of what changes.
    fn apply(&mut self, moving: &[u32], opening: bool) -> Section {
        let mut s = Section::new("The situation");
        // Outside of a pass nobody asks whether the pass changed something.
        let changed = if opening { self.known(What::Stepped) } else { self.changed() };
        if let Some(flag) = changed {
            for part in moving.chunks(8) {
                let turns: Vec<Expr> = part
                    .iter()
                    .map(|step| {
                        let next = Expr::Read(self.flag(What::Next(StepId(*step))));
                        self.active(*step).xor(next)
                    })
                    .collect();
                s.body.extend(raise(flag, Expr::any(turns)));
            }
        }
        let groups = self.timed_groups();
        for g in &groups {
            let (was, active) = (self.flag(What::GroupWas(*g)), self.group_active(*g));
            s.body.push(Stmt::Set(was, active));
        }
        for step in moving {
            s.body.push(Stmt::About(About::Step(StepId(*step))));
            let (comes, goes) = (self.comes(*step), self.goes(*step));
            s.body.extend(Stmt::when(comes.clone(), self.times_of(*step, true)));
            let off = self.times_of(*step, false);
            s.body.extend(Stmt::when(goes.clone(), off));
            if let Some(count) = self.counts_steps(*step) {
                s.body.extend(Stmt::when(comes.or(goes), vec![count]));
            }
            let (x, next) = (self.step(*step), self.flag(What::Next(StepId(*step))));
            s.body.push(Stmt::Set(x, Expr::Read(next)));
        }
        for g in &groups {
            let body = self.group_times(*g);
            s.body.extend(body);
        }
        let conditions = self.forget_conditions(moving);
        s.body.extend(conditions);
        s
    }

    /// One more step that changed, where `%SW20` counts them.
    fn counts_steps(&mut self, step: u32) -> Option<Stmt> {
        let counts = self.t.counts.is_some() && !self.extra(step).uncounted;
        counts.then(|| {
            let count = self.memory(What::StepCount, Class::Scratch, Type::Lint);
            add_one(count)
        })
    }

    /// The condition of a qualifier no longer holds once its step is left.
    fn forget_conditions(&mut self, moving: &[u32]) -> Vec<Stmt> {
        let mut list = Vec::new();
        for step in moving {
            for row in self.conditional(*step) {
                let (c, active) = (self.kept(What::Condition(row)), self.active(*step));
                list.push(Stmt::Set(c, Expr::Read(c).and(active)));
            }
        }
        list
    }

    /// Transitions clear one after the other, in order of rank, with their actions
    /// at once: a step that one activates and a later one deactivates ends inactive.
    pub(crate) fn in_turn(&mut self) -> Vec<Section> {
        let mut s = Section::new("Transitions clear in turn");
        let t = self.t;
        let enclosing: Vec<u32> = self
            .steps()
            .filter(|s| !self.extra(*s).encloses.is_empty() || !self.extra(*s).links.is_empty())
            .collect();
        for step in &enclosing {
            let (left, came) = (self.flag(What::Left(StepId(*step))), self.flag(What::Came(StepId(*step))));
            s.body.extend([lower(left), lower(came)]);
        }
        let begun = self.note_begun();
        s.body.extend(begun.body);
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let clears = self.clears(rank);
            let mut then = Vec::new();
            let groups = self.timed_groups();
            for g in &groups {
                let (was, active) = (self.flag(What::GroupWas(*g)), self.group_active(*g));
                then.push(Stmt::Set(was, active));
            }
            if tr.on_clearing != NONE {
                then.extend(self.run(tr.on_clearing));
            }
            let leaving: Vec<u32> = self.preceding(tr).chain(self.dropped(rank)).collect();
            for step in leaving {
                then.extend(self.leave(step));
            }
            let entering: Vec<u32> = self.succeeding(tr).collect();
            for step in entering {
                then.extend(self.enter(step));
            }
            for g in &groups {
                then.extend(self.group_times(*g));
            }
            s.body.push(Stmt::About(About::Transition(rank)));
            s.body.extend(Stmt::when(clears, then));
        }
        let compare = self.compare_begun();
        let mut sections = vec![s, compare];
        if !enclosing.is_empty() {
            sections.push(self.enclosures(&enclosing));
        }
        sections
    }

    /// Notes that a step has changed, at its own turn.
    fn turned(&mut self, step: u32) -> Vec<Stmt> {
        let changed = self.changed();
        let mut list: Vec<Stmt> = changed.into_iter().map(|f| Stmt::Set(f, Expr::truth(true))).collect();
        list.extend(self.counts_steps(step));
        list
    }

    /// Deactivates a step: its exit actions first, then its enclosed charts, step
    /// by step, each before the next one.
    fn leave(&mut self, step: u32) -> Vec<Stmt> {
        let e = self.extra(step);
        let mut then = self.run_list(e.off);
        let x = self.step(step);
        then.push(lower(x));
        then.extend(self.times_of(step, false));
        then.extend(self.turned(step));
        for row in self.conditional(step) {
            let c = self.kept(What::Condition(row));
            then.push(lower(c));
        }
        if !e.encloses.is_empty() {
            let left = self.flag(What::Left(StepId(step)));
            then.push(Stmt::Set(left, Expr::truth(true)));
        }
        for inner in self.inside(step) {
            then.extend(self.leave(inner));
        }
        Stmt::when(Expr::Read(x), then)
    }

    /// Activates a step: its entry actions run at once, its linked steps come
    /// with it in the order of the text, each with what it brings.
    fn enter(&mut self, step: u32) -> Vec<Stmt> {
        let e = self.extra(step);
        let x = self.step(step);
        let mut then = vec![Stmt::Set(x, Expr::truth(true))];
        then.extend(self.times_of(step, true));
        then.extend(self.turned(step));
        then.extend(self.run_list(e.on));
        if !e.links.is_empty() {
            let came = self.flag(What::Came(StepId(step)));
            then.push(Stmt::Set(came, Expr::truth(true)));
        }
        for link in self.arcs(e.links) {
            then.extend(self.enter(link.0));
        }
        Stmt::when(Expr::Read(x).negated(), then)
    }

    fn run_list(&mut self, rows: g7_engine::Rows) -> Vec<Stmt> {
        let mut list = Vec::new();
        for action in self.actions(rows) {
            if self.t.rules.late_actions {
                let late = self.late(*action);
                list.push(Stmt::Set(late, Expr::truth(true)));
            } else {
                list.extend(self.run(*action));
            }
        }
        list
    }

    /// A chart whose enclosing step has gone is empty, linked steps are active,
    /// whatever the turns behind did.
    fn enclosures(&mut self, enclosing: &[u32]) -> Section {
        let mut s = Section::new("Enclosed charts follow");
        for step in enclosing {
            let mut then = Vec::new();
            for inner in self.inside(*step) {
                let (on, off) = (self.flag(What::On(StepId(inner))), self.flag(What::Off(StepId(inner))));
                then.push(lower(on));
                let active = self.active(inner);
                then.extend(raise(off, active));
            }
            let left = Expr::Read(self.flag(What::Left(StepId(*step))));
            let gone = left.and(self.active(*step).negated());
            s.body.extend(Stmt::when(gone, then));
        }
        for step in enclosing {
            let (left, came) = (self.flag(What::Left(StepId(*step))), self.flag(What::Came(StepId(*step))));
            let comes = Expr::all([Expr::Read(came), Expr::Read(left).negated(), self.active(*step)]);
            for link in self.arcs(self.extra(*step).links) {
                let on = self.flag(What::On(*link));
                s.body.extend(raise(on, comes.clone()));
            }
        }
        s
    }

    /// The start and the requests of services: marks, then all that follows.
    pub(crate) fn requests(&mut self) -> Vec<Section> {
        let t = self.t;
        let mut s = Section::new("Services");
        let mut any = Vec::new();
        let mut list = Vec::new();
        for step in self.steps() {
            let (on, off) = (self.flag(What::On(StepId(step))), self.flag(What::Off(StepId(step))));
            list.extend([lower(on), lower(off)]);
        }
        for (i, group) in (0u32..).zip(&t.groups) {
            let g = g7_engine::GroupId(i);
            for (what, init) in [(What::RequestInit(g), true), (What::RequestClear(g), false)] {
                let Some(asked) = self.known(what) else { continue };
                any.push(Expr::Read(asked));
                let mut then = vec![lower(asked)];
                for step in self.group_steps(g) {
                    let (off, active) = (self.flag(What::Off(StepId(step))), self.active(step));
                    then.extend(raise(off, active));
                }
                for step in self.arcs(group.initial).iter().filter(|_| init) {
                    let on = self.flag(What::On(*step));
                    then.push(Stmt::Set(on, Expr::truth(true)));
                }
                list.extend(Stmt::when(Expr::Read(asked), then));
            }
        }
        for step in self.steps() {
            let id = StepId(step);
            for (what, mark) in
                [(What::RequestSet(id), What::On(id)), (What::RequestReset(id), What::Off(id))]
            {
                let Some(asked) = self.known(what) else { continue };
                any.push(Expr::Read(asked));
                let mark = self.flag(mark);
                list.push(Stmt::If(
                    Expr::Read(asked),
                    vec![lower(asked), Stmt::Set(mark, Expr::truth(true))],
                    Vec::new(),
                ));
            }
        }
        if any.is_empty() && self.known(What::RequestStart).is_none() {
            return Vec::new();
        }
        list.extend(self.commit_alone(true));
        let asked = Stmt::when(Expr::any(any), list);
        s.body = match self.known(What::RequestStart) {
            Some(start) => vec![Stmt::If(Expr::Read(start), self.start_again(start), asked)],
            None => asked,
        };
        vec![s]
    }

    /// All charts take the situation of the start; nothing else that was asked for
    /// takes place.
    fn start_again(&mut self, asked: MemoryId) -> Vec<Stmt> {
        let mut list = vec![lower(asked)];
        for step in self.steps() {
            let id = StepId(step);
            let (on, off) = (self.flag(What::On(id)), self.flag(What::Off(id)));
            let starts = self.t.initial.contains(&id);
            list.push(Stmt::Set(on, Expr::truth(starts)));
            let active = self.active(step);
            list.push(Stmt::Set(off, active));
            let other = [What::RequestSet(id), What::RequestReset(id)];
            list.extend(other.into_iter().filter_map(|w| self.known(w)).map(lower));
        }
        for g in (0..self.t.groups.len() as u32).map(g7_engine::GroupId) {
            let other = [What::RequestInit(g), What::RequestClear(g)];
            list.extend(other.into_iter().filter_map(|w| self.known(w)).map(lower));
        }
        list.extend(self.commit_alone(false));
        list
    }

    /// The consequences of marks alone, outside of a pass. `follow`: enclosed charts
    /// follow their enclosing steps.
    fn commit_alone(&mut self, follow: bool) -> Vec<Stmt> {
        let mut list = Vec::new();
        for action in self.stored_in_pass() {
            let runs = self.flag(What::Runs(action));
            list.push(lower(runs));
        }
        let moving: Vec<u32> = self.steps().collect();
        let mut next = Section::new("");
        if follow && self.has_hierarchy() {
            self.cascade(&mut next.body);
        }
        for step in &moving {
            let id = StepId(*step);
            let (on, off) = (self.flag(What::On(id)), self.flag(What::Off(id)));
            let (to, active) = (self.flag(What::Next(id)), self.active(*step));
            let stays = active.and(Expr::Read(off).negated());
            next.body.push(Stmt::Set(to, Expr::Read(on).or(stays)));
        }
        list.extend(next.body);
        list.extend(self.gather(&moving, false).body);
        let run = self.run_stored().body;
        let apply = self.apply(&moving, true).body;
        let (first, second) = if self.t.rules.parallel_actions { (run, apply) } else { (apply, run) };
        list.extend(first);
        list.extend(second);
        if self.t.rules.parallel_actions {
            list.extend(self.give().body);
        }
        list
    }

    /// The initial situation (rule 1) with what its activation does.
    pub(crate) fn start(&mut self) -> Section {
        let mut s = Section::new("The initial situation");
        let t = self.t;
        // The initial steps alone: activation links act at later activations.
        let all: Vec<u32> = t.initial.iter().map(|s| s.0).collect();
        let mut then = Vec::new();
        let mut now = BTreeSet::new();
        for step in &all {
            for action in self.actions(self.extra(*step).on) {
                if t.rules.late_actions {
                    let late = self.late(*action);
                    then.push(Stmt::Set(late, Expr::truth(true)));
                } else {
                    now.insert(*action);
                }
            }
        }
        let mut run = Vec::new();
        for action in now {
            run.push(Stmt::About(About::Action(action)));
            let body = if t.rules.parallel_actions { self.run_apart(action) } else { self.run(action) };
            run.extend(body);
        }
        let mut on = Vec::new();
        for step in &all {
            let x = self.step(*step);
            on.push(Stmt::Set(x, Expr::truth(true)));
            let stamp = self.stamp(StepId(*step));
            on.extend(stamp.map(|(stamp, clock)| Stmt::Set(stamp, clock)));
        }
        if t.rules.parallel_actions {
            let given = self.given();
            for m in &given {
                let wrote = self.flag(What::Wrote(*m));
                then.push(lower(wrote));
            }
            then.extend(run);
            then.extend(on);
            let changed = self.changed();
            then.extend(changed.map(lower));
            then.extend(self.give().body);
        } else {
            then.extend(on);
            then.extend(run);
        }
        let started = self.kept(What::Started);
        s.body = Stmt::when(Expr::Read(started).negated(), then);
        s
    }
}

/// One more.
pub(crate) fn add_one(count: MemoryId) -> Stmt {
    let one = Expr::long(1);
    Stmt::Set(count, Expr::Read(count).arith(g7_engine::Arith::Add, Type::Lint, one))
}

/// At most so many.
pub(crate) fn at_most(count: MemoryId, most: i64) -> Vec<Stmt> {
    let over = Expr::Read(count).compare(Cmp::Gt, Type::Lint, Expr::long(most));
    Stmt::when(over, vec![Stmt::Set(count, Expr::long(most))])
}
