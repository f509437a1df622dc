//! The state of the rewriting: the document, its programs and its names.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::{
    Action, ActionKind, Chart, ChartItem, ChartKind, Document, Expr, Item, Name, Nanos, Problem, ProfileName,
    Qualifier, Span, StepKind, Stmt, Switch, Target, VarDecl, say,
};

use super::blocks::Blocks;
use super::form::Form;
use super::identifiers::{Names, Owner};
use super::structures::{Structures, Whole};
use crate::report::renamed;
use crate::scopes::{Ref, Scopes, StepKey, VarKey};

/// The deepest nesting of macro-steps.
pub(super) const DEEPEST: usize = 20;

/// A document that is being rewritten.
pub(super) struct Lower<'d> {
    pub(super) document: &'d Document,
    pub(super) form: Form,
    pub(super) blocks: &'d Blocks,
    /// The variables with a structure that stay one variable.
    pub(super) whole: Whole<'d>,
    pub(super) scopes: Scopes<'d>,
    pub(super) names: Names,
    /// The program of each chart; None for a task.
    pub(super) programs: Vec<Option<usize>>,
    /// The first chart of each program.
    pub(super) heads: Vec<usize>,
    /// The name of each program, where others use its variables by that name.
    pub(super) units: Vec<String>,
    /// The macro-step of each expansion.
    pub(super) owners: HashMap<usize, StepKey>,
    /// The time of a scan.
    pub(super) scan: Option<Nanos>,
    /// True if bodies run once more after their step is left.
    pub(super) final_scan: bool,
    /// True if step times count scans.
    pub(super) scan_clock: bool,
    /// The variables that change behind the conditions of actions, since actions or bodies of charts write them, and the
    /// instances that such bodies call.
    pub(super) moved: HashSet<VarKey<'d>>,
    /// Conditions read copies of these from before all bodies: of each variable, or of a member of an instance, the name of
    /// its copy.
    pub(super) copies: BTreeMap<(VarKey<'d>, Option<String>), String>,
    /// The counted time of each step, in scans or (true) in seconds.
    pub(super) counts: BTreeMap<(StepKey, bool), String>,
    /// The time of each macro-step, or step of another program, that is read.
    pub(super) clocks: BTreeMap<StepKey, String>,
    /// Variables of charts that are known to be used by other programs.
    pub(super) shared: HashSet<VarKey<'d>>,
    /// Variables of charts that turned out to be used by other programs.
    pub(super) wanted: HashSet<VarKey<'d>>,
    /// Steps that have the name of a variable and whose activity or time is read, as far as this and earlier
    /// rounds found them. They need a name of their own.
    pub(super) read_twins: HashSet<StepKey>,
    /// The variables that each program writes.
    pub(super) written: BTreeSet<(VarKey<'d>, usize)>,
    /// The variables that each program reads.
    pub(super) read: BTreeSet<(VarKey<'d>, usize)>,
    /// The steps that use a named action, with their qualifiers; by the chart and the name of the
    /// action.
    pub(super) uses: HashMap<VarKey<'d>, Vec<(StepKey, Qualifier)>>,
    pub(super) driven_by: HashMap<VarKey<'d>, Vec<Drive<'d>>>,
    pub(super) formulas: HashMap<VarKey<'d>, Formula>,
    pub(super) mirrors: BTreeMap<StepKey, String>,
    pub(super) watches: Vec<Watch>,
    pub(super) started: Option<String>,
    pub(super) first: Option<String>,
    /// Statements before all others that read inverted channels.
    pub(super) channels: Vec<Stmt>,
    /// Statements before the charts that compute edges and delays.
    pub(super) looking: Vec<Stmt>,
    /// Statements behind the charts.
    pub(super) closing: Vec<Stmt>,
    /// Statements before the charts that compute sections and times.
    pub(super) sections: Vec<Stmt>,
    /// Sections that are computed, with the variable of each.
    pub(super) computed: Vec<(VarKey<'d>, String)>,
    /// Actions of macro-steps in line, for the steps of their expansions.
    pub(super) handed_down: Vec<(StepKey, Action)>,
    /// Bodies of macro-steps in line, with a name each.
    pub(super) of_macros: Vec<(StepKey, ChartItem)>,
    pub(super) new_globals: Vec<VarDecl>,
    pub(super) new_vars: Vec<Vec<VarDecl>>,
    pub(super) problems: Vec<Problem>,
}

/// One action that drives a variable.
#[derive(Clone)]
pub(super) struct Drive<'d> {
    pub(super) step: StepKey,
    pub(super) number: usize,
    pub(super) qualifier: Qualifier,
    pub(super) time: Option<&'d Expr>,
    pub(super) condition: Option<&'d Expr>,
}

/// The value of a variable with conditions, with one part for each of its actions.
pub(super) struct Formula {
    pub(super) value: Expr,
    /// The assignment of the memory of what is set, which comes first.
    pub(super) stored: Option<Stmt>,
    /// The calls that a part needs first, by step and number of the action.
    pub(super) calls: HashMap<(StepKey, usize), Vec<Stmt>>,
}

/// An observed value and the variable that holds the result.
pub(super) struct Watch {
    pub(super) kind: WatchKind,
    pub(super) value: Expr,
    pub(super) name: String,
}

#[derive(Clone, PartialEq)]
pub(super) enum WatchKind {
    Edge(bool),
    Delay(Expr, Option<Expr>),
}

impl<'d> Lower<'d> {
    pub(super) fn new(
        document: &'d Document,
        form: Form,
        (blocks, structures): (&'d Blocks, &Structures<'_>),
        shared: HashSet<VarKey<'d>>,
        read_twins: HashSet<StepKey>,
    ) -> Lower<'d> {
        let scopes = Scopes::new(document);
        let mut lower = Lower {
            document,
            form,
            blocks,
            whole: Whole::default(),
            names: Names::new(0, form.words()),
            programs: Vec::new(),
            heads: Vec::new(),
            units: Vec::new(),
            owners: HashMap::new(),
            scan: document.cycle(),
            final_scan: final_scan(document),
            scan_clock: scan_clock(document),
            moved: HashSet::new(),
            copies: BTreeMap::new(),
            counts: BTreeMap::new(),
            clocks: BTreeMap::new(),
            shared,
            wanted: HashSet::new(),
            read_twins,
            written: BTreeSet::new(),
            read: BTreeSet::new(),
            uses: HashMap::new(),
            driven_by: HashMap::new(),
            formulas: HashMap::new(),
            mirrors: BTreeMap::new(),
            watches: Vec::new(),
            started: None,
            first: None,
            channels: Vec::new(),
            looking: Vec::new(),
            closing: Vec::new(),
            sections: Vec::new(),
            computed: Vec::new(),
            handed_down: Vec::new(),
            of_macros: Vec::new(),
            new_globals: Vec::new(),
            new_vars: Vec::new(),
            problems: Vec::new(),
            scopes,
        };
        lower.divide();
        lower.names = Names::new(lower.heads.len(), form.words());
        lower.new_vars = vec![Vec::new(); lower.heads.len()];
        lower.driven_by = lower.drives();
        lower.uses = lower.used();
        lower.moved = lower.moving();
        if !structures.is_empty() {
            // A copy of a member of all elements is no array of structures.
            let copied = lower.copied_in_conditions().into_iter().filter(|key| key.1.contains(']'));
            let apart = lower.driven_by.keys().copied().chain(copied);
            lower.whole = Whole::of(document, &lower.scopes, structures, apart);
            lower.whole.all_or_none(&mut lower.shared);
        }
        lower.name();
        lower
    }

    /// The period of a chart, if it differs from that of the document.
    pub(super) fn pace(&self, chart: &Chart) -> Option<Nanos> {
        chart.every.filter(|e| Some(*e) != self.scan)
    }

    pub(super) fn program_of(&self, chart: usize) -> Option<usize> {
        self.programs.get(chart).copied().flatten()
    }

    /// True if a step is active from the beginning.
    pub(super) fn initial(&self, key: StepKey) -> bool {
        let Some(step) = self.scopes.step(key) else { return false };
        let entered = || self.owners.get(&key.0).is_some_and(|m| m.0 != key.0 && self.initial(*m));
        step.initial || step.kind == StepKind::Entry && entered()
    }

    /// Assigns each chart to a program.
    pub(super) fn divide(&mut self) {
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
                Form::Networks { .. } => self.heads.iter().position(same),
                Form::Charts | Form::Codesys { .. } => None,
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
            // The bound ends circles of macro-steps.
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

    /// Gives all names: first those that everyone sees, then those of each program.
    pub(super) fn name(&mut self) {
        let document = self.document;
        self.blocks.names().for_each(|name| self.names.reserve(name));
        // Functions come first, so that each function block and the rest of the file know them by the same names.
        for item in &document.items {
            if let Item::Function(f) = item {
                self.names.give_function(f);
            }
        }
        for item in &document.items {
            if let Item::Var(v) = item {
                v.names.iter().for_each(|n| self.name_variable(None, None, n, ""));
            }
        }
        for (chart, def) in self.scopes.charts.clone().into_iter().enumerate() {
            for name in def.vars().flat_map(|v| &v.names) {
                if self.shared.contains(&(Some(chart), &*name.text)) {
                    self.name_variable(None, Some(chart), name, &def.name.text);
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
                    ChartItem::Var(v) => {
                        for name in &v.names {
                            if !self.shared.contains(&(Some(chart), &*name.text)) {
                                self.name_variable(owner, Some(chart), name, prefix);
                            }
                        }
                    }
                    ChartItem::Action(a) => {
                        self.names.give_part(owner, Some(chart), &a.name, prefix);
                    }
                    ChartItem::Section(s) => {
                        self.names.give_part(owner, Some(chart), &s.name, prefix);
                    }
                    _ => {}
                }
            }
            let text = self.form == (Form::Networks { drawn: false });
            let apart = |key| text && !self.read_twins.contains(&key);
            let macros = !matches!(self.form, Form::Codesys { .. });
            self.names.give_steps(owner, chart, prefix, &self.scopes, macros, apart);
        }
        if let Form::Codesys { .. } = self.form {
            let heads = self.heads.iter().filter_map(|head| self.scopes.chart(*head));
            self.units = heads.map(|head| self.names.give_unit(&head.name)).collect();
        }
    }

    fn name_variable(&mut self, owner: Owner, chart: Option<usize>, name: &'d Name, prefix: &str) {
        match self.whole.member((chart, &*name.text)) {
            Some(member) => self.names.give_member(owner, chart, name, member, prefix),
            None => self.names.give_var(owner, chart, name, prefix),
        }
    }

    /// The steps that use each named action.
    pub(super) fn used(&self) -> HashMap<VarKey<'d>, Vec<(StepKey, Qualifier)>> {
        let mut uses: HashMap<VarKey, Vec<(StepKey, Qualifier)>> = HashMap::new();
        for chart in 0..self.scopes.charts.len() {
            for (key, step) in self.scopes.steps_of(chart) {
                for action in &step.actions {
                    if let ActionKind::Qualified { qualifier, target: Target::Path(path), .. } = &action.kind
                        && let Some(Ref::Action(home, named)) = self.scopes.refer(Some(chart), &path.names)
                    {
                        uses.entry((home, &*named.name.text)).or_default().push((key, *qualifier));
                    }
                }
            }
        }
        uses
    }

    /// The problems in the order of the document, and the names.
    pub(super) fn finish(self) -> (Vec<Problem>, Names) {
        let mut problems = self.problems;
        problems.extend(renamed(&self.names.renamed));
        problems.sort_by_key(|p| (p.at.start, p.at.end));
        // A problem of a part that two programs share is reported once.
        problems.dedup_by(|a, b| a.code == b.code && a.at == b.at && a.what == b.what);
        (problems, self.names)
    }

    /// Reports rules of the document that differ from those of IEC 61131-3.
    pub(super) fn rules(&mut self) {
        let Some(profile) = self.document.profile() else {
            let at = self.scopes.charts.first().map_or(Span::default(), |c| c.name.at.0);
            return self.other_rules(at, ProfileName::default());
        };
        if profile.name != ProfileName::Iec61131 {
            self.other_rules(profile.at.0, profile.name);
        }
        for (switch, at) in &profile.switches {
            if !matches!(switch, Switch::FinalScan(_) | Switch::ScanClock(_) | Switch::Bound(_)) {
                let what = say!("this switch is not carried over; there the rules of the standard hold");
                self.differs(at.0, what);
            }
        }
    }

    pub(super) fn other_rules(&mut self, at: Span, profile: ProfileName) {
        let what = say!(
            "the chart evolves by the rules of {} and there by those of IEC 61131-3: one transition after the other, one scan each",
            profile
        );
        self.differs(at, what);
    }

    /// Reports variables that one program writes and a later one reads: the later one sees the new
    /// value in the same scan.
    pub(super) fn between_programs(&mut self) {
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
            let what = say!(
                "`{}` runs behind `{}` there, and sees `{name}` as that has left it in the same scan",
                reader.text,
                writer.text
            );
            self.differs(reader.at.0, what);
        }
    }
}

/// True if bodies run once more after their step is left.
fn final_scan(document: &Document) -> bool {
    let of = |s: &Switch| if let Switch::FinalScan(on) = s { Some(*on) } else { None };
    rule(document, of, ProfileName::Iec61131)
}

/// True if step times count scans.
fn scan_clock(document: &Document) -> bool {
    let of = |s: &Switch| if let Switch::ScanClock(on) = s { Some(*on) } else { None };
    rule(document, of, ProfileName::Jgrafchart)
}

/// A rule by the last switch for it, else by the profile that has it.
fn rule(document: &Document, of: impl Fn(&Switch) -> Option<bool>, usual: ProfileName) -> bool {
    let switches = document.profile().map(|p| p.switches.as_slice()).unwrap_or(&[]);
    let set = switches.iter().rev().find_map(|(s, _)| of(s));
    set.unwrap_or(document.profile().is_some_and(|p| p.name == usual))
}
