//! A document in the forms of IEC 61131-3, for all that write such files.
//!
//! # Where this sits
//!
//! ```text
//! Document -> standard -> Document -> write (text, PLCopen XML)
//! ```
//!
//! What comes out is a document that can be printed as it stands: its names are
//! identifiers of IEC 61131-3, its paths are `name`, `block.member`, `step.X` and
//! `step.T`, and each element has a form there.
//!
//! # What must hold
//!
//! - Where nothing is told, the document that comes out means the same: edges and
//!   delays become function blocks that a body before the charts calls, conditions
//!   of actions become bodies, steps that another program looks at drive a variable.
//! - What has no form is an error with its place; what runs by other rules a warning.

mod acts;
mod assemble;
mod code;
mod names;
mod scopes;
mod watch;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::codes;
use g7_model::{
    ActionKind, Chart, ChartKind, Document, Item, Problem, ProfileName, Qualifier, Span, StepKind, Stmt,
    Switch, Target, VarDecl,
};

use scopes::{Scopes, StepKey, VarKey};

/// What a program of the format is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Charts of one period are networks of one program, expansions stand in line.
    Networks,
    /// Each chart is a program, with macro-steps.
    Charts,
}

/// A document in the forms of the standard, and what they do not carry.
pub(crate) fn standard(document: &Document, form: Form) -> (Document, Vec<Problem>) {
    // Which variables several programs use shows on the way.
    let mut shared = HashSet::new();
    loop {
        let mut lower = Lower::new(document, form, shared);
        let out = lower.document();
        if lower.wanted.is_subset(&lower.shared) {
            return (out, lower.finish());
        }
        shared = std::mem::take(&mut lower.shared);
        shared.extend(lower.wanted);
    }
}

/// A document on its way.
struct Lower<'d> {
    document: &'d Document,
    form: Form,
    scopes: Scopes<'d>,
    names: names::Names,
    /// The program of each chart; tasks have none.
    programs: Vec<Option<usize>>,
    /// The first chart of each program.
    heads: Vec<usize>,
    /// The macro-step of each expansion.
    owners: HashMap<usize, StepKey>,
    /// The time of a scan.
    scan: Option<i64>,
    /// Whether bodies run once more behind their step, in this document.
    final_scan: bool,
    /// Variables of charts that other programs use, and those that turn out to be.
    shared: HashSet<VarKey<'d>>,
    wanted: HashSet<VarKey<'d>>,
    written: BTreeSet<(VarKey<'d>, usize)>,
    read: BTreeSet<(VarKey<'d>, usize)>,
    /// The steps that use a named action, and how; by the chart that has it, and its name.
    uses: HashMap<VarKey<'d>, Vec<(StepKey, Qualifier)>>,
    driven_by: HashMap<VarKey<'d>, Vec<acts::Drive<'d>>>,
    formulas: HashMap<VarKey<'d>, acts::Formula>,
    mirrors: BTreeMap<StepKey, String>,
    watches: Vec<watch::Watch>,
    started: Option<String>,
    /// Statements before the charts: of edges and delays, and of sections and times.
    looking: Vec<Stmt>,
    /// Statements behind them.
    closing: Vec<Stmt>,
    sections: Vec<Stmt>,
    computed: Vec<(VarKey<'d>, String)>,
    new_globals: Vec<VarDecl>,
    new_vars: Vec<Vec<VarDecl>>,
    problems: Vec<Problem>,
}

impl<'d> Lower<'d> {
    fn new(document: &'d Document, form: Form, shared: HashSet<VarKey<'d>>) -> Lower<'d> {
        let scopes = Scopes::new(document);
        let mut lower = Lower {
            document,
            form,
            names: names::Names::new(0),
            programs: Vec::new(),
            heads: Vec::new(),
            owners: HashMap::new(),
            scan: document.items.iter().find_map(|i| if let Item::Cycle(t, _) = i { Some(*t) } else { None }),
            final_scan: final_scan(document),
            shared,
            wanted: HashSet::new(),
            written: BTreeSet::new(),
            read: BTreeSet::new(),
            uses: HashMap::new(),
            driven_by: HashMap::new(),
            formulas: HashMap::new(),
            mirrors: BTreeMap::new(),
            watches: Vec::new(),
            started: None,
            looking: Vec::new(),
            closing: Vec::new(),
            sections: Vec::new(),
            computed: Vec::new(),
            new_globals: Vec::new(),
            new_vars: Vec::new(),
            problems: Vec::new(),
            scopes,
        };
        lower.divide();
        lower.names = names::Names::new(lower.heads.len());
        lower.new_vars = vec![Vec::new(); lower.heads.len()];
        lower.name();
        lower.driven_by = lower.drives();
        lower.uses = lower.used();
        lower
    }

    /// The period of a chart, where it is not that of all.
    fn pace(&self, chart: &Chart) -> Option<i64> {
        chart.every.filter(|e| Some(*e) != self.scan)
    }

    fn program_of(&self, chart: usize) -> Option<usize> {
        self.programs.get(chart).copied().flatten()
    }

    /// Whether a step is active from the beginning.
    fn initial(&self, key: StepKey) -> bool {
        let Some(step) = self.scopes.step(key) else { return false };
        let entered = || self.owners.get(&key.0).is_some_and(|m| m.0 != key.0 && self.initial(*m));
        step.initial || step.kind == StepKind::Entry && entered()
    }

    /// Which chart belongs to which program.
    fn divide(&mut self) {
        let count = self.scopes.charts.len();
        self.programs = vec![None; count];
        for chart in 0..count {
            let Some(def) = self.scopes.chart(chart) else { continue };
            for (key, step) in self.scopes.steps_of(chart) {
                if let StepKind::Macro(_) = step.kind
                    && let Some(inner) = self.scopes.expansion(key).filter(|i| *i != chart)
                {
                    self.owners.entry(inner).or_insert(key);
                }
            }
            if def.kind != ChartKind::Chart {
                continue;
            }
            let pace = self.pace(def);
            let same = |head: &usize| self.scopes.chart(*head).is_some_and(|h| self.pace(h) == pace);
            let known = match self.form {
                Form::Networks => self.heads.iter().position(same),
                Form::Charts => None,
            };
            let program = known.unwrap_or(self.heads.len());
            if known.is_none() {
                self.heads.push(chart);
            }
            if let Some(place) = self.programs.get_mut(chart) {
                *place = Some(program);
            }
        }
        for chart in 0..count {
            let mut at = chart;
            // A circle of macro-steps ends somewhere.
            for _ in 0..count {
                match self.owners.get(&at) {
                    Some(owner) if self.program_of(at).is_none() => at = owner.0,
                    _ => break,
                }
            }
            let program = self.program_of(at);
            if let Some(place) = self.programs.get_mut(chart) {
                *place = program;
            }
        }
    }

    /// Gives all names: those that all see, then those of each program.
    fn name(&mut self) {
        let document = self.document;
        for item in &document.items {
            match item {
                Item::Var(v) => v.names.iter().for_each(|n| self.names.give_var(None, None, n, "")),
                Item::Function(f) => self.names.give_function(&f.name),
                _ => {}
            }
        }
        for (chart, def) in self.scopes.charts.clone().into_iter().enumerate() {
            for name in def.vars().flat_map(|v| &v.names) {
                if self.shared.contains(&(Some(chart), &*name.text)) {
                    self.names.give_var(None, Some(chart), name, &def.name.text);
                }
            }
        }
        for item in &document.items {
            match item {
                Item::Action(a) => self.names.give_part(None, None, &a.name, ""),
                Item::Section(s) => self.names.give_part(None, None, &s.name, ""),
                _ => {}
            }
        }
        for (chart, def) in self.scopes.charts.clone().into_iter().enumerate() {
            let owner = self.program_of(chart);
            let prefix = &*def.name.text;
            for item in &def.items {
                match item {
                    g7_model::ChartItem::Var(v) => {
                        for name in &v.names {
                            if !self.shared.contains(&(Some(chart), &*name.text)) {
                                self.names.give_var(owner, Some(chart), name, prefix);
                            }
                        }
                    }
                    g7_model::ChartItem::Action(a) => {
                        self.names.give_part(owner, Some(chart), &a.name, prefix);
                    }
                    g7_model::ChartItem::Section(s) => {
                        self.names.give_part(owner, Some(chart), &s.name, prefix);
                    }
                    _ => {}
                }
            }
            self.names.give_steps(owner, chart, prefix, &self.scopes);
        }
    }

    /// The steps that use each named action.
    fn used(&self) -> HashMap<VarKey<'d>, Vec<(StepKey, Qualifier)>> {
        let mut uses: HashMap<VarKey, Vec<(StepKey, Qualifier)>> = HashMap::new();
        for chart in 0..self.scopes.charts.len() {
            for (key, step) in self.scopes.steps_of(chart) {
                for action in &step.actions {
                    if let ActionKind::Qualified { qualifier, target: Target::Path(path), .. } = &action.kind
                        && let Some(scopes::Ref::Action(home, named)) =
                            self.scopes.refer(Some(chart), &path.names)
                    {
                        uses.entry((home, &*named.name.text)).or_default().push((key, *qualifier));
                    }
                }
            }
        }
        uses
    }

    /// What was told, in the order of the document.
    fn finish(self) -> Vec<Problem> {
        let mut problems = self.problems;
        if let Some((at, from, to)) = self.names.renamed.first() {
            let more = self.names.renamed.len() - 1;
            let tail =
                if more > 0 { format!("; {more} more names are changed as well") } else { String::new() };
            let what = format!("`{from}` is called `{to}` there{tail}");
            let mut problem = Problem::new(&codes::RENAMED, *at, what);
            for (at, _, to) in self.names.renamed.iter().skip(1).take(100) {
                problem.related.push((*at, format!("called `{to}`")));
            }
            problems.push(problem);
        }
        problems.sort_by_key(|p| (p.at.start, p.at.end));
        // What two programs say of one part is said once.
        problems.dedup_by(|a, b| a.code == b.code && a.at == b.at && a.what == b.what);
        problems
    }

    /// Which rules of the document are not those of IEC 61131-3.
    fn rules(&mut self) {
        let Some(profile) = self.document.profile() else {
            let at = self.scopes.charts.first().map_or(Span::default(), |c| c.name.at.0);
            return self.other_rules(at, ProfileName::default());
        };
        if profile.name != ProfileName::Iec61131 {
            self.other_rules(profile.at.0, profile.name);
        }
        for (switch, at) in &profile.switches {
            if !matches!(switch, Switch::FinalScan(_) | Switch::Bound(_)) {
                let what = "this switch is not carried over; there the rules of the standard hold";
                self.differs(at.0, what);
            }
        }
    }

    fn other_rules(&mut self, at: Span, profile: ProfileName) {
        let what = format!(
            "the chart evolves by the rules of {} and there by those of IEC 61131-3: one transition after the other, one scan each",
            profile.name()
        );
        self.differs(at, &what);
    }

    /// Variables that one program writes and a later one reads: there it sees them at once.
    fn between_programs(&mut self) {
        let mut seen: BTreeSet<(usize, usize, &str)> = BTreeSet::new();
        for (key, reader) in &self.read {
            for writer in 0..*reader {
                if self.written.contains(&(*key, writer)) {
                    seen.insert((*reader, writer, key.1));
                }
            }
        }
        for (reader, writer, name) in seen {
            let title =
                |p: usize| self.heads.get(p).and_then(|h| self.scopes.chart(*h)).map(|c| c.name.clone());
            let (Some(reader), Some(writer)) = (title(reader), title(writer)) else { continue };
            let what = format!(
                "`{}` runs behind `{}` there, and sees `{name}` as that has left it in the same scan",
                reader.text, writer.text
            );
            self.differs(reader.at.0, &what);
        }
    }
}

/// Whether bodies run once more behind their step.
fn final_scan(document: &Document) -> bool {
    let switches = document.profile().map(|p| p.switches.as_slice()).unwrap_or(&[]);
    let set =
        switches.iter().rev().find_map(|(s, _)| if let Switch::FinalScan(on) = s { Some(*on) } else { None });
    set.unwrap_or(document.profile().is_some_and(|p| p.name == ProfileName::Iec61131))
}
