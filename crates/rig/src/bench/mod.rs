//! The test bench: compiled charts, their plant, and the names of everything in them.

mod ask;
pub(crate) mod build;
mod tables;

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use g7_compile::Held;
use g7_compile::plant;
use g7_compile::resolve::kept_by_system;
use g7_compile::symbols::activity;
use g7_engine::{Addr, FaultKind, GroupId, State, StepId};
use g7_host::{Coupling, Force, Halt, Kind, Recording, Runner, Sample, Signal, Value, read_text, write_text};
use g7_model::{Nanos, Said, Span, Type, say};

use crate::fault;
pub use ask::{Answer, Ask, Options};
pub use tables::Table;

/// The role of a variable on the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// An input of the charts; the number is that of its first word, counted from the first input
    /// word.
    Input(u32),
    /// An output of the charts.
    Output,
    /// Any other variable of the charts, and the system bits that a terminal sets.
    Variable,
    /// A state of the plant.
    Plant,
}

/// A named value.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its name, as the language writes it outside of all charts.
    pub name: String,
    /// How its words are to be read.
    pub kind: Kind,
    /// The values that it can have, if it is of an enumeration or has bounds.
    pub held: Option<Arc<Held>>,
    /// Its use.
    pub role: Role,
    /// The address of its first word, among the variables of the charts or of the plant.
    pub addr: u32,
    /// The number of its words.
    pub words: u32,
    /// For a retained variable: its type as written.
    pub retain: Option<String>,
    /// The author's comment, without quotes.
    pub comment: Option<String>,
    /// Its type.
    pub ty: Type,
    /// The place of its declaration.
    pub at: Span,
}

/// A step or macro-step and its name.
#[derive(Clone, Debug)]
pub struct StepItem {
    /// Its name, as traces write it.
    pub name: String,
    /// The name of its chart; of an instance its own, `Axis[3]`.
    pub chart: String,
    /// The author's comment, without quotes.
    pub comment: Option<String>,
    /// The step or macro-step whose activity it has.
    pub id: Activity,
    /// The place of its name in the text.
    pub at: Span,
    /// True if it belongs to an expansion or a task.
    pub inner: bool,
}

impl StepItem {
    /// The name of its step variable in the language: `X12`, `G.X12`, `XM3`, `Fill.X`.
    pub fn activity(&self) -> String {
        activity(&self.name, matches!(self.id, Activity::Macro(_)))
    }
}

/// A step or macro-step as the owner of an activity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// A step: its own activity.
    Step(StepId),
    /// A macro-step: active while a step of its expansion is.
    Macro(GroupId),
}

/// A plant, compiled and coupled.
#[derive(Debug)]
pub struct PlantSide {
    /// Its name.
    pub name: String,
    /// Its program.
    pub compiled: g7_compile::Compiled,
    /// The words that it shares with the charts.
    pub coupling: Coupling,
    /// Its picture, as written.
    pub view: Option<String>,
    /// The moving parts of the picture.
    pub bindings: Vec<plant::Binding>,
    /// The code of the expressions that were asked of it.
    pub queries: Vec<g7_engine::Code>,
}

/// Compiled charts with names, and their plant if there is one.
pub struct Bench {
    /// The compiled charts.
    pub compiled: g7_compile::Compiled,
    /// All named values.
    pub items: Vec<Item>,
    /// All steps and macro-steps.
    pub steps: Vec<StepItem>,
    /// The plant.
    pub plant: Option<PlantSide>,
    /// The compiled expressions, in the order of `Options::asks`.
    pub answers: Vec<Answer>,
    /// The time between two scans.
    pub period: Nanos,
}

impl Bench {
    /// A run before its first scan, coupled to the plant.
    pub fn runner(&self, seed: u64) -> Runner {
        let symbols = &self.compiled.symbols;
        let flags = symbols.s0.zip(symbols.s1);
        let kept = self.retained().map(|i| i.addr..i.addr + i.words).collect::<Vec<Range<u32>>>();
        let mut runner =
            Runner::new(self.compiled.program.clone(), self.period).with_retained(kept).with_flags(flags);
        if let Some(plant) = &self.plant {
            runner = runner.with_plant(plant.compiled.program.clone(), plant.coupling.clone());
            if let Some(addr) = plant.compiled.symbols.seed {
                runner.set_plant_word(addr, seed);
            }
        }
        runner
    }

    /// The retained variables.
    pub fn retained(&self) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(|i| i.retain.is_some())
    }

    /// The value with this name, or at this direct name (`%S21`).
    pub fn item(&self, name: &str) -> Option<&Item> {
        if let Some(direct) = name.strip_prefix('%') {
            return self.item_at(direct);
        }
        let plain = |i: &&Item| i.name == name;
        let cased = |i: &&Item| i.name.eq_ignore_ascii_case(name);
        self.items.iter().find(plain).or_else(|| self.items.iter().find(cased))
    }

    /// The value at a direct name, without `%`: a system bit, or the variable that
    /// is declared at this address.
    fn item_at(&self, direct: &str) -> Option<&Item> {
        let at = |v: &&g7_compile::symbols::Variable| {
            v.address.as_deref().is_some_and(|a| a.trim_start_matches('%').eq_ignore_ascii_case(direct))
        };
        let declared = self.compiled.symbols.variables.iter().find(at);
        let name =
            declared.map_or_else(|| format!("%{}", direct.to_ascii_uppercase()), |v| v.name.to_string());
        self.items.iter().find(|i| i.role != Role::Plant && i.name == name)
    }

    /// Why nothing of this name can be set, and what can be done instead or names that come
    /// near (empty where there are none).
    pub fn no_item(&self, name: &str) -> (Said, Said) {
        let near = self.near(name);
        match name.strip_prefix('%') {
            Some(_) if kept_by_system(&name.to_ascii_uppercase()) => {
                (say!("`{name}` is kept by the system: it can be read, not set"), near)
            }
            Some(rest) if rest.starts_with(['X', 'x']) => {
                let help =
                    say!("PRE sets and resets steps (`%X12 := TRUE`); the terminal has the system bits");
                (say!("`{name}` is the state of a step: it cannot be set"), help)
            }
            Some(_) => {
                let bits: Vec<String> = self
                    .items
                    .iter()
                    .filter(|i| i.name.starts_with('%'))
                    .map(|i| format!("`{}`", i.name))
                    .collect();
                let help = match bits.join(", ") {
                    none if none.is_empty() => say!("the system bits are those of `profile pl7`"),
                    bits => say!("there are {}", Said::foreign(bits)),
                };
                (say!("nothing at `{name}` can be set"), help)
            }
            None => (say!("nothing named `{name}` can be set"), near),
        }
    }

    /// A sentence that refuses an unknown name.
    pub fn unknown(&self, name: &str) -> Said {
        let (what, help) = if name.starts_with('%') {
            self.no_item(name)
        } else {
            (say!("there is no `{name}`"), self.near(name))
        };
        if help.is_empty() { what } else { say!("{what}; {help}") }
    }

    /// Asks whether one of the names was meant that come near; empty where there are none.
    pub fn near(&self, name: &str) -> Said {
        near(name, self.items.iter().map(|i| i.name.as_str()))
    }

    /// The present value of an item.
    pub fn value(&self, runner: &Runner, item: &Item) -> Value {
        match item.role {
            // Before the first scan the inputs are not yet in the state.
            Role::Input(index) if item.words == 1 && !runner.state().is_started() => {
                Value::Word(runner.input(index))
            }
            Role::Input(_) | Role::Output | Role::Variable => read(runner.shown(), item),
            Role::Plant => runner.plant().map_or(Value::Word(0), |(_, state)| read(state, item)),
        }
    }

    /// Sets an item once: an input, a variable or a state of the plant.
    pub fn set(&self, runner: &mut Runner, item: &Item, value: &Value) {
        for (at, word) in words(item, value) {
            match item.role {
                Role::Input(first) => runner.set_input(first + at, word),
                Role::Output | Role::Variable => runner.set_word(Addr(item.addr + at), word),
                Role::Plant => runner.set_plant_word(Addr(item.addr + at), word),
            }
        }
    }

    /// Forces an item to a value; a state of the plant is only set.
    pub fn force(&self, runner: &mut Runner, item: &Item, value: &Value) {
        for (at, word) in words(item, value) {
            match force(item, at) {
                Some(what) => runner.force(what, word),
                None => runner.set_plant_word(Addr(item.addr + at), word),
            }
        }
    }

    /// The value of an item of the charts in a state.
    pub fn value_in(&self, state: &State, item: &Item) -> Value {
        read(state, item)
    }

    /// The safe value of an output, that of its first word; `None` for anything else.
    pub fn safe(&self, item: &Item) -> Option<u64> {
        let tables = self.compiled.program.tables();
        let index = item.addr.saturating_sub(tables.outputs.start);
        (item.role == Role::Output).then(|| tables.safe.get(index as usize).copied().unwrap_or(0))
    }

    /// The one word of the charts that forcing the item writes; `None` where it is no single word, or one
    /// of the plant.
    pub fn force_of(&self, item: &Item) -> Option<Force> {
        if item.kind == Kind::Text { None } else { force(item, 0) }
    }

    /// Ends the force on an item.
    pub fn release(&self, runner: &mut Runner, item: &Item) {
        for at in 0..item.words {
            if let Some(what) = force(item, at) {
                runner.release(what);
            }
        }
    }

    /// True if an item is forced.
    pub fn is_forced(&self, runner: &Runner, item: &Item) -> bool {
        force(item, 0).is_some_and(|what| runner.is_forced(what))
    }

    /// True if a step or macro-step is active.
    pub fn is_active(&self, state: &State, step: &StepItem) -> bool {
        match step.id {
            Activity::Step(id) => state.is_active(id),
            Activity::Macro(group) => state.group_active(&self.compiled.program, group),
        }
    }

    /// The time since a step was activated: a duration, or a number of scans if the profile counts
    /// scans.
    pub fn step_time(&self, state: &State, step: &StepItem) -> Option<String> {
        let id = match step.id {
            Activity::Step(id) => id,
            Activity::Macro(_) => return None,
        };
        let time = state.step_time(&self.compiled.program, id);
        Some(if self.compiled.unit.rules.scan_clock {
            format!("{time} scans")
        } else {
            (Nanos::new(time / 10_000_000) * 10_000_000).plain()
        })
    }

    /// The names of the active steps, without macro-steps.
    pub fn situation<'a>(&'a self, state: &'a State) -> Vec<&'a str> {
        self.compiled.symbols.situation(state).collect()
    }

    /// All signals that can be recorded: all items and all steps.
    pub fn signals(&self) -> Vec<Signal> {
        let item = |i: &Item| Signal { group: group(i.role), name: i.name.clone(), kind: i.kind };
        let step = |s: &StepItem| Signal { group: "steps", name: s.activity(), kind: Kind::Bool };
        self.items.iter().map(item).chain(self.steps.iter().map(step)).collect()
    }

    /// The signals that changed, ordered from cause to effect. The attributes of single parts in a
    /// queue are left out.
    pub fn moving(recording: &Recording) -> Vec<usize> {
        let groups = ["inputs", "steps", "outputs", "variables", "plant"];
        let signals = recording.signals();
        let is_part = |s: &Signal| {
            let last = s.name.rsplit_once('.').map_or("", |(_, last)| last);
            s.group == "plant" && !last.is_empty() && last.bytes().all(|b| b.is_ascii_digit())
        };
        let mut moving: Vec<usize> = (0..signals.len()).filter(|i| recording.count(*i) > 1).collect();
        moving.retain(|i| signals.get(*i).is_some_and(|s| !is_part(s)));
        moving.sort_by_key(|i| signals.get(*i).and_then(|s| groups.iter().position(|g| *g == s.group)));
        moving
    }

    /// The signals that changed, ordered for reading: inputs and outputs, variables, steps of
    /// charts, the plant, steps of expansions.
    pub fn lanes(&self, recording: &Recording) -> Vec<usize> {
        let groups = ["inputs", "outputs", "variables", "steps", "plant"];
        let mut moving = Bench::moving(recording);
        moving.sort_by_key(|i| {
            let inner =
                i.checked_sub(self.items.len()).and_then(|i| self.steps.get(i)).is_some_and(|s| s.inner);
            let group = recording.signals().get(*i).and_then(|s| groups.iter().position(|g| *g == s.group));
            (inner, group)
        });
        moving
    }

    /// The values of [`Bench::signals`], in the same order.
    pub fn sample<'a>(&'a self, runner: &'a Runner) -> impl Iterator<Item = Sample<'a>> + 'a {
        let state = runner.shown();
        let plant = runner.plant().map_or(&[][..], |(_, state)| state.words());
        // Before the first scan the inputs are not yet in the state.
        let early = !runner.state().is_started();
        let items = self.items.iter().map(move |i| match i.role {
            Role::Input(index) if early && i.words == 1 => Sample::Word(runner.input(index)),
            Role::Input(_) | Role::Output | Role::Variable => stands(state.words(), i),
            Role::Plant => stands(plant, i),
        });
        items.chain(self.sample_steps(state))
    }

    /// The values of [`Bench::signals`] in a state of the charts alone; those of the plant are 0.
    pub fn sample_state<'a>(&'a self, state: &'a State) -> impl Iterator<Item = Sample<'a>> + 'a {
        let items = self.items.iter().map(move |i| match i.role {
            Role::Input(_) | Role::Output | Role::Variable => stands(state.words(), i),
            Role::Plant => Sample::Word(0),
        });
        items.chain(self.sample_steps(state))
    }

    fn sample_steps<'a>(&'a self, state: &'a State) -> impl Iterator<Item = Sample<'a>> + 'a {
        self.steps.iter().map(move |s| Sample::Word(u64::from(self.is_active(state, s))))
    }

    /// True if the plant drives the item.
    pub fn is_driven(&self, runner: &Runner, item: &Item) -> bool {
        matches!(item.role, Role::Input(index) if runner.is_driven(index))
    }

    /// A sentence that says why the run stopped.
    pub fn halt(&self, runner: &Runner, halt: Halt) -> Said {
        let kind = match halt {
            Halt::Charts(stopped) => stopped.kind,
            Halt::Plant(stopped) => return say!("the plant: {}", fault(stopped.kind)),
        };
        match kind {
            FaultKind::Forcing { chart } => match self.compiled.symbols.charts.get(chart as usize) {
                Some(chart) => say!("{} (chart `{}`)", fault(kind), chart.name),
                None => fault(kind),
            },
            FaultKind::Unstable { cycle } => {
                let cycle: Vec<String> =
                    self.cycle(runner, cycle).iter().map(|s| format!("{{{s}}}")).collect();
                say!("{}: {}", fault(kind), Said::foreign(cycle.join(" -> ")))
            }
            _ => fault(kind),
        }
    }

    /// The place in the text of the fault that stopped the run, if it has one.
    pub fn halt_place(&self, halt: Halt) -> Option<Span> {
        let (symbols, fault) = match halt {
            Halt::Charts(fault) => (&self.compiled.symbols, fault),
            Halt::Plant(fault) => (&self.plant.as_ref()?.compiled.symbols, fault),
        };
        fault.at.map(|at| symbols.place(at))
    }

    /// The situations of an unstable cycle, beginning with the present one.
    fn cycle(&self, runner: &Runner, length: u32) -> Vec<String> {
        let mut state = runner.state().clone();
        let mut seen = Vec::new();
        for _ in 0..length.min(16) {
            seen.push(self.situation(&state).join(", "));
            if g7_engine::pass(&self.compiled.program, &mut state).is_err() {
                break;
            }
        }
        if length > 16 {
            seen.push("…".to_owned());
        }
        seen
    }
}

/// Finds variables to which the stored actions of one pass gave different values. Each variable is
/// reported once per run.
#[derive(Debug, Default)]
pub struct Conflicts(BTreeSet<Addr>);

impl Conflicts {
    /// A sentence about the conflict of the latest scan, if there is one that was not reported
    /// before.
    pub fn of(&mut self, bench: &Bench, runner: &Runner) -> Option<Said> {
        let addr = runner.report().conflict.filter(|a| self.0.insert(*a))?;
        let now = Said::foreign(Nanos::new(runner.state().now()).plain());
        Some(match bench.compiled.symbols.variable_at(addr) {
            Some(v) => say!(
                "conflicting assignment: actions of one pass gave `{}` different values at {now}",
                v.name
            ),
            None => {
                say!("conflicting assignment: actions of one pass gave a variable different values at {now}")
            }
        })
    }
}

fn group(role: Role) -> &'static str {
    match role {
        Role::Input(_) => "inputs",
        Role::Output => "outputs",
        Role::Variable => "variables",
        Role::Plant => "plant",
    }
}

/// The value of an item where it stands.
#[inline]
fn stands<'a>(words: &'a [u64], item: &Item) -> Sample<'a> {
    let at = item.addr as usize;
    match item.kind {
        Kind::Text => Sample::Text(words.get(at..at + item.words as usize).unwrap_or(&[])),
        Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => {
            Sample::Word(words.get(at).copied().unwrap_or(0))
        }
    }
}

fn read(state: &State, item: &Item) -> Value {
    match item.kind {
        Kind::Text => Value::Text(read_text(state.words(), item.addr).into()),
        Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => {
            Value::Word(state.word(Addr(item.addr)))
        }
    }
}

fn words(item: &Item, value: &Value) -> Vec<(u32, u64)> {
    let words = match value {
        Value::Word(w) => vec![*w],
        Value::Text(t) => write_text(t, item.words),
    };
    (0u32..).zip(words).collect()
}

fn force(item: &Item, at: u32) -> Option<Force> {
    match item.role {
        Role::Input(first) => Some(Force::Input(first + at)),
        Role::Output => Some(Force::Output(Addr(item.addr + at))),
        Role::Variable => Some(Force::Variable(Addr(item.addr + at))),
        Role::Plant => None,
    }
}

/// Asks whether one of these names was meant, those that come near to a name; empty where there are none.
pub(crate) fn near<'n>(name: &str, all: impl Iterator<Item = &'n str>) -> Said {
    let mut near: Vec<(usize, &str)> = all
        .map(|n| (distance(name, n), n))
        .filter(|(d, n)| *d <= (name.chars().count() + 1) / 3 || n.rsplit('.').next() == Some(name))
        .collect();
    near.sort_unstable();
    near.dedup();
    near.truncate(3);
    let mut near = near.into_iter().map(|(_, n)| say!("`{n}`"));
    let Some(first) = near.next() else { return Said::default() };
    let all = near.fold(first, |all, next| say!("{all} or {next}"));
    say!("is it {all}?")
}

/// The edit distance between two words.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().flat_map(char::to_lowercase).take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().flat_map(char::to_lowercase).take(64).enumerate() {
        let mut last = i;
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
        for (j, y) in b.iter().enumerate() {
            let (here, left) = (row.get(j + 1).copied().unwrap_or(0), row.get(j).copied().unwrap_or(0));
            let best = (last + usize::from(x != *y)).min(here + 1).min(left + 1);
            last = here;
            if let Some(cell) = row.get_mut(j + 1) {
                *cell = best;
            }
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_edits() {
        assert_eq!(distance("start", "start"), 0);
        assert_eq!(distance("strat", "start"), 2);
        assert_eq!(distance("Start", "start"), 0);
        assert_eq!(distance("", "abc"), 3);
    }
}
