//! The actions of a chart where the tool leaves them to matiec.
//!
//! ```text
//! Document -> standard -> Document -> control -> Document -> project (PLCopen XML)
//! ```
//!
//! matiec has no action control of IEC 61131-3, 2.6.4.5: two steps with `N` on one variable overwrite each
//! other, a body does not run once more after its step, a pulse on an initial step is lost in the first scan,
//! and `R` does not end a delay that `SD` began. It evolves as the standard says. So an action that it treats
//! like the standard stays beside its step, and all others are computed by one body, of a step that is always
//! active: the control block of each variable, then the bodies in the order of the text.
//!
//! matiec also takes a step off as soon as one of several transitions behind it clears, and transitions after
//! it see that; nor may a transition read a step that stands after it. They read a memory of the step instead, and of
//! its time a clock that runs before the chart as well (`clocks.rs`).

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    Action, ActionKind, BinaryOp, Body, Chart, ChartItem, ChartKind, Composed, Document, Expr, ExprKind,
    FbKind, Item, Literal, Name, NamedAction, Nanos, Path, Problem, Qualifier, Span, Step, Stmt, StmtKind,
    Target, Type, VarDecl, VarKind, codes, say,
};

use super::clocks::{Clocks, outputs_apart};
use super::never::{conversions, never};
use crate::nodes::{self, Taken};

/// Moves the actions that matiec treats otherwise than the standard into one body of each chart.
pub(super) fn control(mut document: Document, problems: &mut Vec<Problem>) -> Document {
    let mut taken = names(&document);
    let written = written(&document);
    let (variables, given) = (variables(&document, |_| true), variables(&document, |v| v.init.is_some()));
    conversions(&mut document, problems);
    let mut clocks = Clocks::default();
    for item in &mut document.items {
        match item {
            Item::Chart(chart) if chart.kind == ChartKind::Chart => {
                let (taken, vars) = (&mut taken, Vec::new());
                Control { taken, written: &written, given: &given, problems, vars, clocks: &mut clocks }
                    .chart(chart, &variables);
            }
            Item::Pre(Body::St(block), _)
            | Item::Post(Body::St(block), _)
            | Item::Composed(Composed { body: Some(Body::St(block)), .. }) => {
                outputs_apart(&mut block.statements);
            }
            _ => {}
        }
    }
    clocks.into_document(&mut document);
    document
}

/// One action of a step: what it does by its qualifier.
#[derive(Clone)]
struct Drive {
    step: Name,
    initial: bool,
    qualifier: Qualifier,
    time: Option<Expr>,
    at: Span,
}

/// A body with the actions that run it.
struct Work {
    name: String,
    list: Vec<Stmt>,
    drives: Vec<Drive>,
}

struct Control<'c> {
    taken: &'c mut Taken,
    /// The variables that statements write, in upper case.
    written: &'c HashSet<String>,
    /// The variables with initial values, in upper case.
    given: &'c HashSet<String>,
    problems: &'c mut Vec<Problem>,
    /// The new variables of the chart.
    vars: Vec<ChartItem>,
    clocks: &'c mut Clocks,
}

impl Control<'_> {
    fn chart(mut self, chart: &mut Chart, variables: &HashSet<String>) {
        let at = chart.name.at.0;
        never(chart, self.problems);
        self.apart(chart, variables);
        without_empty(chart);
        let named: HashMap<String, NamedAction> = chart
            .items
            .iter()
            .filter_map(|i| {
                if let ChartItem::Action(a) = i { Some((key(&a.name.text), a.clone())) } else { None }
            })
            .collect();
        let (mut order, mut driven) = (Vec::new(), HashMap::<String, (Expr, Vec<Drive>)>::new());
        let mut bodies: Vec<Work> = Vec::new();
        let mut places: HashMap<String, usize> = HashMap::new();
        for step in chart.steps() {
            for (number, action) in step.actions.iter().enumerate() {
                let Some((drive, target)) = drive(step, action) else { continue };
                match target {
                    Target::Path(path) => match named.get(&key(&path.text())) {
                        Some(action) => {
                            let place = *places.entry(key(&path.text())).or_insert(bodies.len());
                            if place == bodies.len() {
                                let list = action.body.block().statements.clone();
                                bodies.push(Work { name: path.text(), list, drives: Vec::new() });
                            }
                            bodies.iter_mut().skip(place).take(1).for_each(|b| b.drives.push(drive.clone()));
                        }
                        None => {
                            let target = nodes::expr(ExprKind::Path(path.clone()), action.at.0);
                            let (_, list) = driven.entry(key(&path.text())).or_insert_with(|| {
                                order.push(key(&path.text()));
                                (target, Vec::new())
                            });
                            list.push(drive);
                        }
                    },
                    Target::Direct(address, _) => {
                        let target = nodes::expr(ExprKind::Direct(address.clone()), action.at.0);
                        let text = key(&format!("%{address}"));
                        let (_, list) = driven.entry(text.clone()).or_insert_with(|| {
                            order.push(text);
                            (target, Vec::new())
                        });
                        list.push(drive);
                    }
                    // `standard` has reported it.
                    Target::Element(_) => {}
                    Target::Work(work) => bodies.push(Work {
                        name: format!("{}_{}", step.name.text, number + 1),
                        list: work.statements().to_vec(),
                        drives: vec![drive],
                    }),
                }
            }
        }
        let plain = |name: &String, drives: &[Drive]| natural(drives) && !self.written.contains(name);
        let own: HashSet<String> =
            order.iter().filter(|n| driven.get(*n).is_some_and(|(_, d)| plain(n, d))).cloned().collect();
        let mut list = Vec::new();
        for name in order.iter().filter(|n| !own.contains(*n)) {
            if let Some((target, drives)) = driven.get(name) {
                self.variable(name, target, drives, &mut list);
            }
        }
        for body in &bodies {
            self.body(body, &mut list);
        }
        self.early(chart, &mut list);
        if list.is_empty() {
            return;
        }
        outputs_apart(&mut list);
        chart.items.retain(|i| !matches!(i, ChartItem::Action(_)));
        for step in
            chart.items.iter_mut().filter_map(|i| if let ChartItem::Step(s) = i { Some(s) } else { None })
        {
            step.actions.retain(|a| match drive_target(a) {
                Some(Target::Path(path)) => own.contains(&key(&path.text())),
                Some(Target::Direct(address, _)) => own.contains(&key(&format!("%{address}"))),
                Some(Target::Element(_) | Target::Work(_)) => false,
                None => true,
            });
            step.braces = !step.actions.is_empty();
        }
        let mut step = nodes::step(Name::new(self.taken.give("Actions"), at), true, at);
        let target = Target::Work(nodes::work(list, at));
        step.actions.push(nodes::qualified(Qualifier::N, None, target, None, at));
        step.braces = true;
        step.comment = Some("always active: the actions that the tool does not control by itself".into());
        chart.items.append(&mut self.vars);
        chart.items.push(ChartItem::Step(step));
    }

    /// Gives a step that has the name of a variable another one, because its activity is read now, and one that has
    /// the name of the program, which matiec cannot tell apart in its C.
    fn apart(&mut self, chart: &mut Chart, variables: &HashSet<String>) {
        let title = chart.name.text.clone();
        let mut new: HashMap<String, String> = HashMap::new();
        let twin = |name: &str| variables.contains(&key(name)) || key(name) == key(&title);
        for step in chart.steps().filter(|s| twin(&s.name.text)) {
            let name = self.taken.give(&format!("{title}_{}", step.name.text));
            let what = say!("`{}` is called `{name}` there", step.name.text);
            self.problems.push(Problem::new(&codes::RENAMED, step.name.at.0, what));
            new.insert(key(&step.name.text), name);
        }
        let rename = |name: &mut Name| {
            if let Some(text) = new.get(&key(&name.text)) {
                *name = Name::new(text.as_str(), name.at.0);
            }
        };
        for item in &mut chart.items {
            match item {
                ChartItem::Step(s) => rename(&mut s.name),
                ChartItem::Transition(t) => t.from.iter_mut().chain(&mut t.to).for_each(rename),
                _ => {}
            }
        }
    }

    /// A new variable of the chart.
    fn fresh(&mut self, wish: &str, ty: Type, on: bool, at: Span) -> Expr {
        let name = self.taken.give(wish);
        let mut decl = nodes::variable(VarKind::Var, &name, ty, at);
        decl.init = on.then(|| nodes::boolean(true, at));
        self.vars.push(ChartItem::Var(decl));
        nodes::name(&[&name], at)
    }

    /// The control block of a variable.
    fn variable(&mut self, name: &str, target: &Expr, drives: &[Drive], list: &mut Vec<Stmt>) {
        let at = drives.first().map_or(Span::default(), |d| d.at);
        let base = match &target.kind {
            ExprKind::Path(path) => path.text().replace('.', "_"),
            _ => "Output".into(),
        };
        let (level, pulse) = self.block(&base, drives, list);
        let q = nodes::or(level, pulse, at);
        let only_n = drives.iter().all(|d| d.qualifier == Qualifier::N);
        if only_n && !self.written.contains(name) && !self.given.contains(name) {
            list.push(nodes::assign(target.clone(), q, at));
            return;
        }
        // A block writes its variable when its value changes; in between others may write.
        let now = self.fresh(&format!("{base}_now"), Type::Bool, false, at);
        let was = self.fresh(&format!("{base}_was"), Type::Bool, false, at);
        list.push(nodes::assign(now.clone(), q, at));
        let differ = nodes::binary(BinaryOp::Ne, now.clone(), was.clone(), at);
        let write = nodes::assign(target.clone(), now.clone(), at);
        list.push(nodes::when(differ, vec![write], Vec::new(), at));
        list.push(nodes::assign(was, now, at));
    }

    /// A body runs while its block is on, and once more when it is over.
    fn body(&mut self, body: &Work, list: &mut Vec<Stmt>) {
        let at = body.drives.first().map_or(Span::default(), |d| d.at);
        if let Some(end) = returns(&body.list) {
            let what = say!("RETURN in a body: it would end the other actions there as well");
            self.problems.push(Problem::new(&codes::NOT_CARRIED, end, what));
        }
        let (level, pulse) = self.block(&body.name, &body.drives, list);
        let pulses = body.drives.iter().all(|d| matches!(d.qualifier, Qualifier::P1 | Qualifier::P0));
        if pulses {
            list.push(nodes::when(pulse, body.list.clone(), Vec::new(), at));
            return;
        }
        let was = self.fresh(&format!("{}_was", body.name), Type::Bool, false, at);
        let level = if let ExprKind::Path(_) = level.kind {
            level
        } else {
            let now = self.fresh(&format!("{}_now", body.name), Type::Bool, false, at);
            list.push(nodes::assign(now.clone(), level, at));
            now
        };
        let runs = nodes::or(nodes::or(level.clone(), was.clone(), at), pulse, at);
        list.push(nodes::when(runs, body.list.clone(), Vec::new(), at));
        list.push(nodes::assign(was, level, at));
    }

    /// The block of the standard: its level, and its pulses at the begin and the end of steps. Statements
    /// that bring its memories up to date come first.
    fn block(&mut self, base: &str, drives: &[Drive], list: &mut Vec<Stmt>) -> (Expr, Expr) {
        let at = drives.first().map_or(Span::default(), |d| d.at);
        let input = |kind: Qualifier| {
            let steps = drives.iter().filter(|d| d.qualifier == kind);
            steps.fold(nodes::boolean(false, at), |all, d| nodes::or(all, active(&d.step, at), at))
        };
        let has = |kind: Qualifier| drives.iter().any(|d| d.qualifier == kind);
        let r = input(Qualifier::R);
        let stored = |c: &mut Self, word: &str, set: Expr, list: &mut Vec<Stmt>| {
            let memory = c.fresh(&format!("{base}_{word}"), Type::Bool, false, at);
            let value = nodes::and(nodes::or(memory.clone(), set, at), nodes::not(r.clone(), at), at);
            list.push(nodes::assign(memory.clone(), value, at));
            memory
        };
        let mut level = input(Qualifier::N);
        if has(Qualifier::S) {
            level = nodes::or(level, stored(self, "set", input(Qualifier::S), list), at);
        }
        for kind in [Qualifier::L, Qualifier::D, Qualifier::SD, Qualifier::DS, Qualifier::SL] {
            if !has(kind) {
                continue;
            }
            let mut on = input(kind);
            if matches!(kind, Qualifier::SD | Qualifier::SL) {
                on = stored(self, "stored", on, list);
            }
            let time = self.time(base, kind, drives, list);
            let timer = self.fresh(&format!("{base}_timer"), Type::Fb(FbKind::Ton), false, at);
            let ExprKind::Path(path) = &timer.kind else { continue };
            list.push(nodes::invoke(path.clone(), vec![("IN", on.clone()), ("PT", time)], at));
            let over = nodes::name(&[&path.text(), "Q"], at);
            let part = match kind {
                Qualifier::L | Qualifier::SL => nodes::and(on, nodes::not(over, at), at),
                Qualifier::DS => stored(self, "delayed", over, list),
                _ => over,
            };
            level = nodes::or(level, part, at);
        }
        if has(Qualifier::P) {
            let on = input(Qualifier::P);
            level = nodes::or(level, self.edge(base, "rise", on, false, list, at), at);
        }
        let mut pulse = nodes::boolean(false, at);
        for (kind, word) in [(Qualifier::P1, "begin"), (Qualifier::P0, "end")] {
            if !has(kind) {
                continue;
            }
            let initial = drives.iter().any(|d| d.qualifier == kind && d.initial);
            let on = input(kind);
            let rises = kind == Qualifier::P1;
            pulse = nodes::or(pulse, self.pulse(base, word, on, rises, initial, list, at), at);
        }
        let free = nodes::not(r, at);
        (nodes::and(level, free.clone(), at), nodes::and(pulse, free, at))
    }

    /// True for a scan when a value becomes true.
    fn edge(&mut self, base: &str, word: &str, on: Expr, was: bool, list: &mut Vec<Stmt>, at: Span) -> Expr {
        let pulse = self.fresh(&format!("{base}_{word}"), Type::Bool, false, at);
        let memory = self.fresh(&format!("{base}_{word}_was"), Type::Bool, was, at);
        let rises = nodes::and(on.clone(), nodes::not(memory.clone(), at), at);
        list.push(nodes::assign(pulse.clone(), rises, at));
        list.push(nodes::assign(memory, on, at));
        pulse
    }

    /// The pulse of P1 or P0. At the start the initial situation counts, even if it is left at once.
    #[allow(clippy::too_many_arguments, reason = "the parts of one assignment")]
    fn pulse(
        &mut self,
        base: &str,
        word: &str,
        on: Expr,
        rises: bool,
        initial: bool,
        list: &mut Vec<Stmt>,
        at: Span,
    ) -> Expr {
        if !rises {
            let pulse = self.fresh(&format!("{base}_{word}"), Type::Bool, false, at);
            let memory = self.fresh(&format!("{base}_{word}_was"), Type::Bool, initial, at);
            let falls = nodes::and(memory.clone(), nodes::not(on.clone(), at), at);
            list.push(nodes::assign(pulse.clone(), falls, at));
            list.push(nodes::assign(memory, on, at));
            return pulse;
        }
        let pulse = self.edge(base, word, on, initial, list, at);
        if initial {
            let first = self.fresh(&format!("{base}_first"), Type::Bool, true, at);
            let value = nodes::or(pulse.clone(), first.clone(), at);
            list.push(nodes::assign(pulse.clone(), value, at));
            list.push(nodes::assign(first, nodes::boolean(false, at), at));
        }
        pulse
    }

    /// The time of a timer: of several the one of the step that is active, or was last.
    fn time(&mut self, base: &str, kind: Qualifier, drives: &[Drive], list: &mut Vec<Stmt>) -> Expr {
        let of_kind: Vec<&Drive> = drives.iter().filter(|d| d.qualifier == kind).collect();
        let at = of_kind.first().map_or(Span::default(), |d| d.at);
        let time = |d: &Drive| d.time.clone().unwrap_or_else(|| nodes::time(Nanos::ZERO, at));
        let Some(first) = of_kind.first().map(|d| time(d)) else { return nodes::time(Nanos::ZERO, at) };
        let literal = matches!(first.kind, ExprKind::Literal(Literal::Time(_)));
        if literal && of_kind.iter().all(|d| time(d).kind == first.kind) {
            return first;
        }
        // It is taken when the step begins.
        let kept = self.fresh(&format!("{base}_time"), Type::Time, false, at);
        for drive in of_kind {
            let word = format!("{base}_{}_begin", drive.step.text);
            let begins = self.edge(&word, "is", active(&drive.step, at), false, list, at);
            list.push(nodes::when(
                begins,
                vec![nodes::assign(kept.clone(), time(drive), at)],
                Vec::new(),
                at,
            ));
        }
        kept
    }

    /// Gives a memory to each step that other transitions read than those behind it alone: these may read it
    /// before its place in the text, or after another transition has taken it off.
    fn early(&mut self, chart: &mut Chart, list: &mut Vec<Stmt>) {
        let mut reader = Reader::default();
        receptivities(chart, &mut reader);
        for step in chart.steps().filter(|s| reader.timed.contains(&key(&s.name.text))) {
            let time = self.clocks.of_step(step, self.taken, list);
            reader.times.insert(key(&step.name.text), time);
        }
        for step in chart.steps().filter(|s| reader.read.contains(&key(&s.name.text))) {
            let at = step.name.at.0;
            let memory = self.fresh(&format!("{}_before", step.name.text), Type::Bool, step.initial, at);
            list.push(nodes::assign(memory.clone(), active(&step.name, at), at));
            reader.memories.insert(key(&step.name.text), memory);
        }
        receptivities(chart, &mut reader);
    }
}

/// Leaves out actions that do nothing: Beremiz and matiec want a statement in each.
fn without_empty(chart: &mut Chart) {
    let mut empty = HashSet::new();
    chart.items.retain(|item| match item {
        ChartItem::Action(a) if a.body.block().statements.is_empty() => {
            empty.insert(key(&a.name.text));
            false
        }
        _ => true,
    });
    for item in &mut chart.items {
        let ChartItem::Step(step) = item else { continue };
        step.actions.retain(|a| match drive_target(a) {
            Some(Target::Path(path)) => !empty.contains(&key(&path.text())),
            Some(Target::Work(work)) => !work.statements().is_empty(),
            _ => true,
        });
        step.braces = !step.actions.is_empty();
    }
}

/// True if matiec does with these actions what the standard says.
fn natural(drives: &[Drive]) -> bool {
    match drives {
        [one] => matches!(one.qualifier, Qualifier::N | Qualifier::D | Qualifier::L),
        _ => drives.iter().all(|d| matches!(d.qualifier, Qualifier::S | Qualifier::R)),
    }
}

fn drive_target(action: &Action) -> Option<&Target> {
    match &action.kind {
        ActionKind::Qualified { target, .. } => Some(target),
        _ => None,
    }
}

fn drive<'a>(step: &Step, action: &'a Action) -> Option<(Drive, &'a Target)> {
    let ActionKind::Qualified { qualifier, time, target, .. } = &action.kind else { return None };
    let drive = Drive {
        step: step.name.clone(),
        initial: step.initial,
        qualifier: *qualifier,
        time: time.clone(),
        at: action.at.0,
    };
    Some((drive, target))
}

/// A name as it is compared.
fn key(name: &str) -> String {
    name.to_ascii_uppercase()
}

fn active(step: &Name, at: Span) -> Expr {
    nodes::name(&[&step.text, "X"], at)
}

/// The place of the last RETURN in a list.
fn returns(list: &[Stmt]) -> Option<Span> {
    let own = |s: &Stmt| (s.kind == StmtKind::Return).then_some(s.at.0);
    list.iter().rev().find_map(|s| own(s).or_else(|| s.lists().into_iter().rev().find_map(returns)))
}

/// Finds the steps whose activity is read, and puts their memories in the place.
#[derive(Default)]
struct Reader {
    /// The only step before the transition, which may read it as it is.
    own: Option<String>,
    read: HashSet<String>,
    memories: HashMap<String, Expr>,
    /// Steps whose time is read, and what stands for it.
    timed: HashSet<String>,
    times: HashMap<String, Expr>,
}

impl Visitor for Reader {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Path(path) = &e.kind else { return };
        let [step, member] = path.names.as_slice() else { return };
        let step = key(&step.text);
        if self.own.as_ref() == Some(&step) {
            return;
        }
        let (memories, read) = match &*key(&member.text) {
            "X" => (&self.memories, &mut self.read),
            "T" => (&self.times, &mut self.timed),
            _ => return,
        };
        if let Some(memory) = memories.get(&step) {
            *e = memory.clone();
        }
        read.insert(step);
    }
}

fn receptivities(chart: &mut Chart, reader: &mut Reader) {
    for item in &mut chart.items {
        if let ChartItem::Transition(t) = item {
            reader.own = if let [one] = t.from.as_slice() { Some(key(&one.text)) } else { None };
            visit_mut::expr(&mut t.receptivity, reader);
        }
    }
}

/// All names of a document, those of transition sections too.
fn names(document: &Document) -> Taken {
    let mut taken = Taken::of(document);
    let items = document.charts().flat_map(|c| &c.items);
    for item in items {
        if let ChartItem::Section(s) = item {
            taken.take(&s.name.text);
        }
    }
    taken
}

/// The variables that statements write, or that actions of several charts drive.
fn written(document: &Document) -> HashSet<String> {
    struct Writes(HashSet<String>);
    impl Visitor for Writes {
        fn path(&mut self, path: &mut Path, how: Use, _at: Span) {
            if how == Use::Write {
                self.0.insert(key(&path.text()));
            }
        }
    }
    let mut all = Writes(HashSet::new());
    let mut without = document.clone();
    let mut driven: HashMap<String, usize> = HashMap::new();
    for (number, item) in without.items.iter_mut().enumerate() {
        let Item::Chart(chart) = item else { continue };
        for item in &mut chart.items {
            let ChartItem::Step(step) = item else { continue };
            step.actions.retain(|a| match drive_target(a) {
                Some(Target::Path(path)) => {
                    let first = *driven.entry(key(&path.text())).or_insert(number);
                    if first != number {
                        all.0.insert(key(&path.text()));
                    }
                    false
                }
                _ => true,
            });
        }
    }
    visit_mut::document(&mut without, &mut all);
    all.0
}

/// The variables that fit, in upper case.
fn variables(document: &Document, fits: impl Fn(&VarDecl) -> bool) -> HashSet<String> {
    let of_file = document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
    let all = of_file.chain(document.charts().flat_map(Chart::vars));
    all.filter(|v| fits(v)).flat_map(|v| &v.names).map(|n| key(&n.text)).collect()
}
