//! The state of the terminal view and the operations of the user.

use g7_host::{Clock, Halt, Kind, Recording, Runner, Start, Value, WallClock};

use crate::cli::Run;
use crate::failure::{Failure, raw};
use crate::message::told;
use crate::values::Assign;
use g7_model::{Nanos, say};
use g7_rig::{Bench, Conflicts, Item, Role, Table};

/// The keys for inputs: those that no command uses.
pub(super) const INPUT_KEYS: &str = "1234567890abcdefghijklmnoprstuvwxyz";
/// The speeds that `+` and `-` select.
const SPEEDS: [f64; 13] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// Changes kept for each signal: those of an hour for a fast signal.
const KEPT: usize = 50_000;
/// Wall time that one advance may take before the next picture is due.
const BUDGET: Nanos = Nanos::from_millis(30);
/// Spans of time that the chronogram can show.
const SPANS: [Nanos; 12] = [
    Nanos::from_millis(100),
    Nanos::from_millis(200),
    Nanos::from_millis(500),
    Nanos::from_millis(1_000),
    Nanos::from_millis(2_000),
    Nanos::from_millis(5_000),
    Nanos::from_millis(10_000),
    Nanos::from_millis(20_000),
    Nanos::from_millis(60_000),
    Nanos::from_millis(300_000),
    Nanos::from_millis(1_800_000),
    Nanos::from_millis(7_200_000),
];

/// A list in which the user can select.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Panel {
    Inputs,
    Outputs,
    Variables,
    Plant,
}

impl Panel {
    pub(super) const ALL: [Panel; 4] = [Panel::Inputs, Panel::Outputs, Panel::Variables, Panel::Plant];

    fn holds(self, item: &Item) -> bool {
        match item.role {
            Role::Input(_) => self == Panel::Inputs,
            Role::Output => self == Panel::Outputs,
            Role::Variable => self == Panel::Variables,
            Role::Plant => self == Panel::Plant,
        }
    }
}

/// A value that the user is typing.
#[derive(Clone, Debug, Default)]
pub(super) struct Edit {
    /// The position in [`Bench::items`].
    pub(super) item: usize,
    pub(super) text: String,
    /// The fault of the text that was to be taken; empty as soon as it is changed.
    pub(super) why: String,
}

pub(super) struct App<'b> {
    pub(super) bench: &'b Bench,
    pub(super) runner: Runner,
    pub(super) title: String,
    pub(super) recording: Recording,
    pub(super) clock: WallClock,
    pub(super) panel: Panel,
    pub(super) selected: [usize; 4],
    pub(super) edit: Option<Edit>,
    pub(super) help: bool,
    /// The queues and tracks of the plant.
    pub(super) tables: Vec<Table>,
    pub(super) message: String,
    /// The span of the chronogram, as a position in [`SPANS`].
    span: usize,
    /// Distance of the chronogram's right end from the present; 0 follows the run.
    pub(super) back: Nanos,
    /// The first lane that is shown.
    pub(super) lane: usize,
    speed: usize,
    script: Vec<Assign>,
    conflicts: Conflicts,
    until: Nanos,
    over: bool,
}

impl<'b> App<'b> {
    pub(super) fn new(bench: &'b Bench, runner: Runner, title: &str, args: &Run) -> Result<App<'b>, Failure> {
        let mut script = args.set.clone();
        script.sort_by_key(|a| std::cmp::Reverse(a.at));
        for assign in &script {
            let Some(item) = bench.item(&assign.name) else {
                return Err(Failure::Usage(say!("--set: {}", bench.unknown(&assign.name))));
            };
            item.read(&assign.value).map_err(|e| Failure::Usage(say!("--set {}: {e}", raw(&assign.name))))?;
        }
        Ok(App {
            bench,
            runner,
            title: title.to_owned(),
            recording: Recording::new(bench.signals()).with_limit(KEPT),
            clock: WallClock::default(),
            panel: Panel::Inputs,
            selected: [0; 4],
            edit: None,
            help: false,
            tables: Table::all(bench),
            message: String::new(),
            span: 6,
            back: Nanos::ZERO,
            lane: 0,
            speed: 6,
            script,
            conflicts: Conflicts::default(),
            until: args.duration.unwrap_or(Nanos::MAX),
            over: false,
        })
    }

    pub(super) fn is_over(&self) -> bool {
        self.over
    }

    pub(super) fn quit(&mut self) {
        self.over = true;
    }

    pub(super) fn is_running(&self) -> bool {
        !self.clock.is_held() && self.runner.halt().is_none()
    }

    pub(super) fn speed(&self) -> f64 {
        SPEEDS.get(self.speed).copied().unwrap_or(1.0)
    }

    pub(super) fn span(&self) -> Nanos {
        SPANS.get(self.span).copied().unwrap_or(Nanos::SECOND * 10)
    }

    /// Makes the scans that are due. If the machine is too slow for the speed, the time runs
    /// slower; no scan is skipped.
    pub(super) fn advance(&mut self) {
        if !self.is_running() {
            return;
        }
        let mut watch = WallClock::default();
        while self.runner.due() <= self.clock.now() && self.is_running() {
            if self.runner.due() > self.until {
                self.pause(true);
                self.message = format!("{} are over", self.until.plain());
                return;
            }
            self.one_scan();
            if watch.now() > BUDGET {
                self.clock.set(self.runner.due());
                return;
            }
        }
    }

    fn one_scan(&mut self) {
        self.apply_script();
        let done = self.runner.scan().map(|_| ());
        self.after(done);
    }

    fn after(&mut self, done: Result<(), Halt>) {
        let now = Nanos::new(self.runner.shown().now());
        self.recording.sample(now, self.bench.sample(&self.runner));
        if let Some(conflict) = self.conflicts.of(self.bench, &self.runner) {
            self.message = told(&conflict);
        }
        if let Err(halt) = done {
            self.message = told(&say!("fault: {}; R restarts", self.bench.halt(&self.runner, halt)));
        }
    }

    fn apply_script(&mut self) {
        while self.script.last().is_some_and(|a| a.at <= self.runner.due()) {
            let Some(assign) = self.script.pop() else { return };
            let Some(item) = self.bench.item(&assign.name) else { continue };
            if let Ok(value) = item.read(&assign.value) {
                self.put(item, &value);
            }
        }
    }

    /// Sets an item, or forces it if the plant or the charts would overwrite it.
    fn put(&mut self, item: &Item, value: &Value) {
        let held = self.bench.is_driven(&self.runner, item) || self.bench.is_forced(&self.runner, item);
        if held || item.role == Role::Output {
            self.bench.force(&mut self.runner, item, value);
        } else {
            self.bench.set(&mut self.runner, item, value);
        }
    }

    pub(super) fn pause(&mut self, held: bool) {
        self.clock.hold(held);
        self.message.clear();
        if !held {
            self.clock.set(self.runner.due());
        }
    }

    /// Pauses and makes one scan, or completes the scan that is executed pass by pass.
    pub(super) fn scan_once(&mut self) {
        self.pause(true);
        if self.runner.halt().is_none() {
            self.one_scan();
        }
    }

    /// Pauses and makes one pass of a scan.
    pub(super) fn pass_once(&mut self) {
        self.pause(true);
        if self.runner.halt().is_some() {
            return;
        }
        self.apply_script();
        let done = self.runner.pass();
        self.after(done.map(|_| ()));
        if let Ok(last) = done {
            let word = if last { "the last pass: the scan is done" } else { "between two passes of a scan" };
            self.message = word.to_owned();
        }
    }

    pub(super) fn faster(&mut self, by: isize) {
        self.speed = self.speed.saturating_add_signed(by).min(SPEEDS.len() - 1);
        self.clock.set_speed(self.speed());
    }

    pub(super) fn zoom(&mut self, by: isize) {
        self.span = self.span.saturating_add_signed(by).min(SPANS.len() - 1);
    }

    /// Moves the chronogram by a quarter of its width; left is back in time.
    pub(super) fn move_time(&mut self, by: i64) {
        let length = self.recording.end() - self.recording.start();
        self.back = (self.back - self.span() / 4 * by).clamp(Nanos::ZERO, length.max(Nanos::ZERO));
    }

    pub(super) fn restart(&mut self, start: Start) {
        self.runner.restart(start);
        self.clock.set(self.runner.due());
        self.message = match start {
            Start::Warm => "restarted: retained variables kept",
            Start::Cold => "restarted cold",
        }
        .to_owned();
    }

    /// The positions of a panel's items in [`Bench::items`]. A queue or track is represented by its
    /// number of parts.
    pub(super) fn listed(&self, panel: Panel) -> Vec<usize> {
        let items = self.bench.items.iter().enumerate();
        let own = |at: &usize| !self.tables.iter().any(|t| t.rest.contains(at));
        items.filter(|(_, i)| panel.holds(i)).map(|(at, _)| at).filter(own).collect()
    }

    /// The queue or track that an item represents.
    pub(super) fn table(&self, at: usize) -> Option<&Table> {
        self.tables.iter().find(|t| t.count == at)
    }

    pub(super) fn next_panel(&mut self, by: usize) {
        let count = Panel::ALL.len();
        let now = Panel::ALL.iter().position(|p| *p == self.panel).unwrap_or(0);
        let filled = (1..=count).filter_map(|k| Panel::ALL.get((now + k * by) % count).copied());
        if let Some(panel) = filled.clone().find(|p| !self.listed(*p).is_empty()) {
            self.panel = panel;
        }
    }

    pub(super) fn select(&mut self, by: isize) {
        let last = self.listed(self.panel).len().saturating_sub(1);
        if let Some(at) = self.selected.get_mut(self.panel as usize) {
            *at = at.saturating_add_signed(by).min(last);
        }
    }

    /// The selected item of the focused panel.
    pub(super) fn current(&self) -> Option<usize> {
        let at = self.selected.get(self.panel as usize)?;
        self.listed(self.panel).get(*at).copied()
    }

    /// The key of an input, if it has one.
    pub(super) fn input_key(&self, number: usize) -> Option<char> {
        INPUT_KEYS.chars().nth(number)
    }

    /// Handles the key of an input: inverts a BOOL, asks for any other value.
    pub(super) fn press_input(&mut self, key: char) {
        let number = INPUT_KEYS.chars().position(|c| c == key);
        if let Some(at) = number.and_then(|n| self.listed(Panel::Inputs).get(n).copied()) {
            self.change(at);
        }
    }

    /// Inverts a BOOL, or asks for a value.
    pub(super) fn change(&mut self, at: usize) {
        let Some(item) = self.bench.items.get(at) else { return };
        if item.kind == Kind::Bool {
            let value = Value::Word(self.next_value(item) ^ 1);
            self.put(item, &value);
        } else {
            self.edit = Some(Edit { item: at, ..Edit::default() });
        }
    }

    /// The value that the next scan will read.
    fn next_value(&self, item: &Item) -> u64 {
        match item.role {
            Role::Input(index) => self.runner.input(index),
            Role::Output | Role::Variable | Role::Plant => self.bench.value(&self.runner, item).word(),
        }
    }

    /// Forces the selected item to its present value, or releases it.
    pub(super) fn toggle_force(&mut self) {
        let Some(item) = self.current().and_then(|at| self.bench.items.get(at)) else { return };
        if self.bench.is_forced(&self.runner, item) {
            self.bench.release(&mut self.runner, item);
            self.message = format!("{} released", item.name);
        } else if item.role == Role::Plant {
            self.message = "a state of the plant can be set (Enter), not held".to_owned();
        } else {
            let value = self.bench.value(&self.runner, item);
            self.bench.force(&mut self.runner, item, &value);
            self.message = format!("{} held", item.name);
        }
    }

    /// Ends typing and takes the value. A wrong value stays in its prompt, with what is wrong with it: the
    /// next keys are meant for it, and would operate inputs otherwise.
    pub(super) fn accept(&mut self) {
        let Some(mut edit) = self.edit.take() else { return };
        let Some(item) = self.bench.items.get(edit.item) else { return };
        match item.read(&edit.text) {
            Ok(value) => self.put(item, &value),
            Err(why) => {
                edit.why = told(&why);
                self.edit = Some(edit);
            }
        }
    }
}
