//! Coverage: the steps, transitions, actions and branches that the tests reached.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::ir::{Action, ActionKind, Unit};
use g7_engine::{Code, Contribution, State, StepId, eval};
use g7_model::{FileId, Said, Span, say};

use crate::Bench;
use crate::Source;

/// One element that tests can reach.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name in reports.
    pub name: String,
    /// Its place as `path:line:column`.
    pub place: String,
    /// The number of scans in which it was reached.
    pub hits: u64,
}

impl Row {
    /// The file in which it stands.
    fn file(&self) -> &str {
        self.place.rsplitn(3, ':').nth(2).unwrap_or(&self.place)
    }
}

/// A kind of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sort {
    /// A step.
    Step,
    /// A transition.
    Transition,
    /// An action.
    Action,
    /// A branch.
    Branch,
}

impl Sort {
    /// All, in the order of [`Coverage::sorts`].
    pub const ALL: [Sort; 4] = [Sort::Step, Sort::Transition, Sort::Action, Sort::Branch];

    /// The key in reports for programs.
    pub fn key(self) -> &'static str {
        match self {
            Sort::Step => "steps",
            Sort::Transition => "transitions",
            Sort::Action => "actions",
            Sort::Branch => "branches",
        }
    }

    /// The word for several.
    pub fn plural(self) -> Said {
        match self {
            Sort::Step => say!("steps"),
            Sort::Transition => say!("transitions"),
            Sort::Action => say!("actions"),
            Sort::Branch => say!("branches"),
        }
    }

    /// The word for one.
    pub fn one(self) -> Said {
        match self {
            Sort::Step => say!("step"),
            Sort::Transition => say!("transition"),
            Sort::Action => say!("action"),
            Sort::Branch => say!("branch"),
        }
    }
}

/// All elements of one kind, in the order of the text.
pub type Rows = BTreeMap<Span, Row>;

/// The coverage of one file.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    /// Steps.
    pub steps: Rows,
    /// Transitions.
    pub transitions: Rows,
    /// Actions.
    pub actions: Rows,
    /// The branches of selections: transitions that share a preceding step.
    pub branches: Rows,
    /// For each step its actions that hold as long as the step is active.
    lasting: BTreeMap<StepId, Vec<Lasting>>,
    /// Actions (by rank) that several steps share; their execution is counted for each step.
    shared: BTreeSet<u32>,
}

/// An action that lasts instead of happening at one moment: `N motor`, `D 5s alarm if c`, `force G
/// := INIT`.
#[derive(Clone, Copy, Debug)]
struct Lasting {
    at: Span,
    /// Empty if the action has no condition.
    condition: Code,
}

impl Coverage {
    /// The four kinds of elements.
    pub fn sorts(&self) -> [(Sort, &Rows); 4] {
        [
            (Sort::Step, &self.steps),
            (Sort::Transition, &self.transitions),
            (Sort::Action, &self.actions),
            (Sort::Branch, &self.branches),
        ]
    }

    /// The coverage of several heads as that of each file in which elements stand: what the tests of several heads reach
    /// in a file that they use counts together. Files come in the order in which they are met; those of the heads are
    /// all there.
    pub fn by_file(heads: &[(String, Coverage)]) -> Vec<(String, Coverage)> {
        let mut files: Vec<(String, Coverage)> = Vec::new();
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        let mut place = |files: &mut Vec<(String, Coverage)>, file: &str| {
            *places.entry(file.to_owned()).or_insert_with(|| {
                files.push((file.to_owned(), Coverage::default()));
                files.len() - 1
            })
        };
        for (head, coverage) in heads {
            place(&mut files, head);
            for (sort, rows) in coverage.sorts() {
                for (at, row) in rows {
                    let number = place(&mut files, row.file());
                    let Some((_, of)) = files.get_mut(number) else { continue };
                    let at = Span { file: FileId(0), ..*at };
                    let none = Row { hits: 0, ..row.clone() };
                    of.rows_mut(sort).entry(at).or_insert(none).hits += row.hits;
                }
            }
        }
        files
    }

    fn rows_mut(&mut self, sort: Sort) -> &mut Rows {
        match sort {
            Sort::Step => &mut self.steps,
            Sort::Transition => &mut self.transitions,
            Sort::Action => &mut self.actions,
            Sort::Branch => &mut self.branches,
        }
    }

    /// All elements of a file, none of them reached.
    pub fn of(bench: &Bench, source: &Source) -> Coverage {
        let mut coverage = Coverage::default();
        coverage.learn(bench, source);
        coverage
    }

    /// Lists all elements of a file.
    pub(super) fn learn(&mut self, bench: &Bench, source: &Source) {
        let symbols = &bench.compiled.symbols;
        let add = |rows: &mut Rows, at: Span, name: &str| {
            rows.entry(at).or_insert_with(|| Row { name: name.to_owned(), place: source.place(at), hits: 0 });
        };
        for step in (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s)) {
            add(&mut self.steps, symbols.step_place(step), symbols.step_name(step));
        }
        for rank in (0..symbols.transitions()).filter(|r| symbols.is_written(*r)) {
            let text = symbols.transition_text(rank);
            let name = symbols.label(rank).map_or(text.to_owned(), |l| format!("{l}: {text}"));
            let at = symbols.transition_place(rank);
            add(&mut self.transitions, at, &name);
            if bench.compiled.program.tables().transitions.get(rank as usize).is_some_and(|t| t.shares) {
                add(&mut self.branches, at, &name);
            }
        }
        self.shared = shared(bench);
        let ranks = (0u32..).zip(&symbols.actions);
        let own = || ranks.clone().filter(|(rank, a)| !a.hidden && !self.shared.contains(rank));
        for (_, action) in own() {
            add(&mut self.actions, action.at, &first_line(source, action.at));
        }
        self.lasting = lasting_of(bench, &own().map(|(_, a)| a.at).collect());
        for action in self.lasting.values().flatten() {
            add(&mut self.actions, action.at, &first_line(source, action.at));
        }
    }

    /// Counts what the latest scan reached.
    pub(super) fn see(&mut self, bench: &Bench, state: &mut State) {
        for (sort, at) in self.reached(bench, state) {
            if let Some(row) = self.rows_mut(sort).get_mut(&at) {
                row.hits += 1;
            }
        }
    }

    /// The elements that the latest scan reached, as [`Coverage::sorts`] has them; some that are no
    /// elements may be among them.
    pub fn reached(&self, bench: &Bench, state: &mut State) -> Vec<(Sort, Span)> {
        let mut found = self.holding(bench, state);
        let symbols = &bench.compiled.symbols;
        let tables = bench.compiled.program.tables();
        found.extend(state.active().map(|step| (Sort::Step, symbols.step_place(step))));
        // The initial situation too, if it was left in the first scan.
        if state.scans() == 1 {
            found.extend(tables.initial.iter().map(|step| (Sort::Step, symbols.step_place(*step))));
        }
        for rank in state.cleared() {
            let at = symbols.transition_place(*rank);
            found.extend([(Sort::Transition, at), (Sort::Branch, at)]);
            // A step counts too if it was active only within the scan.
            if let Some(t) = tables.transitions.get(*rank as usize) {
                let more = tables.arcs.get(t.more_to.start as usize..t.more_to.end as usize).unwrap_or(&[]);
                let left = std::iter::once(&t.to).chain(more).filter(|s| !state.is_active(**s));
                found.extend(left.map(|step| (Sort::Step, symbols.step_place(*step))));
            }
        }
        let own = state.ran().iter().filter(|rank| !self.shared.contains(rank));
        let own = own.filter_map(|rank| symbols.actions.get(*rank as usize));
        found.extend(own.map(|action| (Sort::Action, action.at)));
        found
    }

    /// The lasting actions of the active steps whose conditions hold.
    fn holding(&self, bench: &Bench, state: &mut State) -> Vec<(Sort, Span)> {
        let active: Vec<StepId> = state.active().collect();
        let actions = active.iter().filter_map(|s| self.lasting.get(s)).flatten();
        let holds = |action: &&Lasting| {
            action.condition.is_empty()
                || eval(&bench.compiled.program, state, action.condition).is_ok_and(|word| word != 0)
        };
        actions.filter(holds).map(|action| (Sort::Action, action.at)).collect()
    }
}

/// The actions that run a named action body for several steps.
fn shared(bench: &Bench) -> BTreeSet<u32> {
    let blocks = bench.compiled.program.tables().blocks.iter().zip(&bench.compiled.symbols.blocks);
    blocks.filter(|(_, symbol)| !symbol.name.is_empty()).map(|(block, _)| block.action).collect()
}

/// The lasting actions of each step, in the order of the text, with the conditions of their
/// control-block inputs. Actions in `told` are left out: the engine reports when they happen.
fn lasting_of(bench: &Bench, told: &BTreeSet<Span>) -> BTreeMap<StepId, Vec<Lasting>> {
    let (unit, symbols) = (&bench.compiled.unit, &bench.compiled.symbols);
    let tables = bench.compiled.program.tables();
    let places: BTreeMap<Span, StepId> =
        (0..symbols.steps()).map(StepId).map(|s| (symbols.step_place(s), s)).collect();
    let mut found: BTreeMap<StepId, Vec<Lasting>> = BTreeMap::new();
    for step in unit.steps.iter().filter(|s| !s.actions.is_empty()) {
        let Some(id) = places.get(&step.at) else { continue };
        let extra = tables.steps.get(id.0 as usize).and_then(|s| tables.extras.get(s.extra as usize));
        let inputs = extra.map(|e| e.contributions.start as usize..e.contributions.end as usize);
        let inputs = inputs.and_then(|rows| tables.contributions.get(rows)).unwrap_or(&[]);
        let mut inputs = inputs.iter().peekable();
        for action in &step.actions {
            let drives = |c: &&Contribution| {
                let block = symbols.blocks.get(c.block as usize);
                block.is_some_and(|b| drives(unit, action, &b.name, b.at))
            };
            let condition = inputs.next_if(drives).map_or(Code::default(), |c| c.condition);
            if !told.contains(&action.at) {
                found.entry(*id).or_default().push(Lasting { at: action.at, condition });
            }
        }
    }
    found
}

/// True if an action drives the control block with this name and place.
fn drives(unit: &Unit, action: &Action, name: &str, at: Span) -> bool {
    match &action.kind {
        ActionKind::Variable { var, .. } => unit.vars.get(var.index()).is_some_and(|v| *v.name == *name),
        ActionKind::Named { body, .. } => unit.bodies.get(body.index()).is_some_and(|b| b.at == at),
        ActionKind::Work { .. } => name.is_empty() && action.at == at,
        ActionKind::OnEvent { .. }
        | ActionKind::EachScan { .. }
        | ActionKind::Force(..)
        | ActionKind::Enable(_)
        | ActionKind::MaskChart(_)
        | ActionKind::MaskVar(_) => false,
    }
}

/// The author's text at a place, up to the end of the line.
fn first_line(source: &Source, at: Span) -> String {
    let text = source.written(at);
    let line = text.lines().next().unwrap_or("").trim();
    if line.chars().count() > 40 { line.chars().take(39).chain(['…']).collect() } else { line.to_owned() }
}
