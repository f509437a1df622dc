//! The units that run: each program, and each instance of a function block with a chart, with actions, or with an
//! instance of such a function block, with the meanings of the names in it.
//!
//! Each such instance becomes a chart with the name of the instance, which holds its variables. All other function
//! blocks are those of [`super::code`].

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::codes;
use g7_model::{Name, Nanos, Type, say};

use super::code::Code;
use super::read::{Pou, PouKind, Project, Section, SectionKind, variables};
use super::tree::{self, Language, Xml, head, name_of, tag};
use super::types::{self, Known};
use crate::nodes::{Taken, line};
use crate::report::Report;

/// The most instances of a file, at all levels together.
const MOST_UNITS: usize = 2_000;
/// The most elements of all instances together.
const MOST_ELEMENTS: usize = 1_000_000;
/// The deepest nesting of blocks.
const DEEPEST: usize = 20;

/// The meaning of a name. Names are kept in upper case, because the language ignores case.
#[derive(Clone, Debug)]
pub(super) enum Meaning {
    /// A variable: the chart that declares it (None: the file), its name there, and its type.
    Var(Option<String>, String, Option<Type>),
    /// An instance of a function block of the file.
    Unit(usize),
    /// A step, with its name in the document.
    Step(String),
    /// A named action: its index among the actions of the unit's POU.
    Action(usize),
}

/// Meanings by names in upper case.
pub(super) type Names = BTreeMap<String, Meaning>;

/// A program or an instance.
pub(super) struct Unit<'a> {
    pub(super) pou: usize,
    /// The name of the chart that it becomes.
    pub(super) chart: String,
    pub(super) names: Names,
    /// True if it runs on its own, false if it runs where it is called.
    pub(super) program: bool,
    /// The period of its task, if others run faster.
    pub(super) interval: Option<Nanos>,
    /// Its variables that are declared in the file.
    pub(super) of_file: HashSet<String>,
    /// The element that declares it.
    pub(super) node: Xml<'a>,
}

/// All units of a project.
pub(super) struct Plan<'a> {
    pub(super) project: &'a Project<'a>,
    pub(super) units: Vec<Unit<'a>>,
    /// Global variables.
    pub(super) globals: Names,
    /// The names of lists of global variables, in upper case.
    pub(super) lists: HashSet<String>,
    /// Functions by their names in upper case.
    pub(super) functions: HashMap<String, usize>,
    pub(super) code: Code,
}

impl<'a> Plan<'a> {
    pub(super) fn pou(&self, unit: usize) -> Option<&Pou<'a>> {
        self.units.get(unit).and_then(|u| self.project.pous.get(u.pou))
    }

    /// True if this is the name of a function block that becomes one of the document.
    pub(super) fn is_block(&self, name: &Name) -> bool {
        self.code.blocks.contains(&name.text.to_uppercase())
    }

    /// True if the body of the unit is a chart.
    pub(super) fn is_chart(&self, unit: usize) -> bool {
        self.pou(unit).is_some_and(|p| is_chart(p))
    }
}

/// True if the body of the POU is a chart.
pub(super) fn is_chart(pou: &Pou) -> bool {
    matches!(tree::body(pou.node), Some((Language::Sfc, _)))
}

/// Gives every unit its place and its names.
pub(super) fn plan<'a>(project: &'a Project<'a>, code: Code, report: &mut Report) -> Plan<'a> {
    let mut by_name: HashMap<String, usize> = HashMap::new();
    let mut functions = HashMap::new();
    for (index, pou) in project.pous.iter().enumerate() {
        let upper = pou.name.text.trim().to_uppercase();
        if let Some(first) = by_name.get(&upper) {
            let what = say!("a second unit is called `{}`", line(&pou.name.text));
            let problem = g7_model::Problem::new(&codes::TWICE, report.span(&pou.name.at), what);
            let there = project.pous.get(*first).map(|p| report.span(&p.name.at)).unwrap_or_default();
            report.put(problem.related(there, say!("the first of this name")));
            continue;
        }
        if pou.kind == PouKind::Function {
            functions.insert(upper.clone(), index);
        }
        by_name.insert(upper, index);
    }
    let (units, globals, lists) = (Vec::new(), Names::new(), HashSet::new());
    let plan = Plan { project, units, globals, lists, functions, code };
    let mut planner = Planner { plan, by_name, charts: Taken::default(), elements: 0, full: false, report };
    planner.globals();
    planner.programs();
    planner.strays();
    planner.plan
}

struct Planner<'r, 'a> {
    plan: Plan<'a>,
    by_name: HashMap<String, usize>,
    /// The names of charts and of variables of the file.
    charts: Taken,
    elements: usize,
    full: bool,
    report: &'r mut Report,
}

impl<'a> Planner<'_, 'a> {
    fn globals(&mut self) {
        let project = self.plan.project;
        for section in &project.globals {
            self.plan.lists.extend(section.name.as_ref().map(|n| n.to_uppercase()));
        }
        let variables = || project.globals.iter().flat_map(|s| &s.variables);
        // An instance of a block gives its name to a chart.
        let plain = variables().filter(|v| !self.is_own_block(**v)).filter_map(|v| name_of(*v));
        for name in plain.collect::<Vec<_>>() {
            self.charts.take(&name.to_uppercase());
        }
        for variable in variables() {
            let Some(name) = name_of(*variable) else { continue };
            let upper = name.to_uppercase();
            if self.plan.globals.contains_key(&upper) {
                continue; // Reported at the declaration.
            }
            let meaning = self.meaning(*variable, None, name, &[]);
            self.plan.globals.insert(upper, meaning);
        }
    }

    /// The meaning of a declared variable.
    fn meaning(&mut self, variable: Xml<'a>, home: Option<&str>, name: String, above: &[usize]) -> Meaning {
        match types::known(variable) {
            Known::Derived(ty) => match self.own_block(&ty) {
                Some(pou) => {
                    let long = home.map_or(name.clone(), |h| format!("{h}_{name}"));
                    let program = above.len() <= 1;
                    let chart = if program { name } else { long };
                    Meaning::Unit(self.unit(pou, chart, variable, above))
                }
                None => Meaning::Var(home.map(str::to_string), name, None),
            },
            Known::Type(ty) => Meaning::Var(home.map(str::to_string), name, Some(ty)),
            Known::None => Meaning::Var(home.map(str::to_string), name, None),
        }
    }

    fn programs(&mut self) {
        let project = self.plan.project;
        let shortest = project.cycle;
        let mut shared: HashMap<String, usize> = HashMap::new();
        for pou in project.pous.iter().filter(|p| p.kind == PouKind::Program) {
            let names: BTreeSet<String> =
                variables(pou).filter_map(name_of).map(|n| n.to_uppercase()).collect();
            for name in names {
                *shared.entry(name).or_default() += 1;
            }
        }
        let programs = project.pous.iter().filter(|p| p.kind == PouKind::Program).count();
        for (index, pou) in project.pous.iter().enumerate() {
            if pou.kind != PouKind::Program {
                continue;
            }
            let name = pou.name.text.trim();
            let runs: Vec<_> = project.runs.iter().filter(|r| r.pou.eq_ignore_ascii_case(name)).collect();
            let several = runs.len() > 1;
            let blocks: HashSet<String> = variables(pou)
                .filter(|v| self.is_own_block(*v))
                .filter_map(name_of)
                .map(|n| n.to_uppercase())
                .collect();
            for number in 0..runs.len().max(1) {
                let run = runs.get(number);
                let interval = run.and_then(|r| r.interval).filter(|i| Some(*i) != shortest);
                let chart = run.filter(|_| several).map_or(name, |r| r.name.as_str()).to_string();
                let node = run.map_or(pou.node, |r| r.node);
                // Beside other programs, the variables of a chart are its own: others name them by it.
                let apart = is_chart(pou) && programs > 1;
                let flag =
                    |upper: &str| is_chart(pou) && matches!(upper, "SFCRESET" | "SFCINIT" | "SFCPAUSE");
                let own = |upper: &String| {
                    !several && !apart && !flag(upper.as_str()) && shared.get(upper) == Some(&1)
                };
                let of_file: HashSet<String> = variables(pou)
                    .filter_map(name_of)
                    .map(|n| n.to_uppercase())
                    .filter(|u| own(u) && !self.charts.has(u) && !blocks.contains(u))
                    .chain(self.made(index).map(|n| n.to_uppercase()).filter(|_| !several && !apart))
                    .collect();
                self.program(index, chart, node, interval, of_file);
            }
        }
    }

    /// True if a variable is an instance of a function block that becomes a unit.
    fn is_own_block(&self, variable: Xml) -> bool {
        matches!(types::known(variable), Known::Derived(ty) if self.own_block(&ty).is_some())
    }

    /// The function block of the file with this name whose instances become units.
    fn own_block(&self, name: &str) -> Option<usize> {
        let index = self.by_name.get(&name.to_uppercase()).copied()?;
        let block = self.plan.project.pous.get(index).is_some_and(|p| p.kind == PouKind::Block);
        (block && self.plan.code.plain.get(index) != Some(&true)).then_some(index)
    }

    fn program(
        &mut self,
        pou: usize,
        chart: String,
        node: Xml<'a>,
        interval: Option<Nanos>,
        of_file: HashSet<String>,
    ) {
        of_file.iter().for_each(|name| _ = self.charts.take(name));
        let unit = self.unit_with(pou, chart, node, &[], of_file);
        if let Some(unit) = self.plan.units.get_mut(unit) {
            unit.program = true;
            unit.interval = interval;
        }
    }

    /// Adds blocks that nothing instantiates: those with a chart, or the only block of a file
    /// without programs.
    fn strays(&mut self) {
        let used: HashSet<usize> = self.plan.units.iter().map(|u| u.pou).collect();
        let project = self.plan.project;
        let alone = project.pous.iter().filter(|p| p.kind != PouKind::Function).count() == 1;
        for (index, pou) in project.pous.iter().enumerate() {
            let plain = self.plan.code.plain.get(index) == Some(&true);
            if plain || pou.kind != PouKind::Block || used.contains(&index) {
                continue;
            }
            let chart = pou.name.text.trim().to_string();
            if alone && !is_chart(pou) {
                let of_file = variables(pou).filter_map(name_of).map(|n| n.to_uppercase());
                let of_file = of_file.filter(|u| !self.charts.has(u)).collect();
                self.program(index, chart, pou.node, None, of_file);
            } else if !is_chart(pou) {
                let what = say!("the function block `{}` is not used; it is left out", line(&pou.name.text));
                self.report.say(&codes::LEFT_OUT, &head(pou.node), what);
            } else if !self.plan.units.iter().any(|u| u.pou == index) {
                let unit = self.unit(index, chart, pou.node, &[]);
                if let Some(unit) = self.plan.units.get_mut(unit) {
                    unit.program = true;
                }
            }
        }
    }

    fn unit(&mut self, pou: usize, chart: String, node: Xml<'a>, above: &[usize]) -> usize {
        self.unit_with(pou, chart, node, above, HashSet::new())
    }

    fn unit_with(
        &mut self,
        pou: usize,
        chart: String,
        node: Xml<'a>,
        above: &[usize],
        of_file: HashSet<String>,
    ) -> usize {
        let index = self.plan.units.len();
        let chart = self.free(&chart, node);
        let names = Names::new();
        let unit = Unit { pou, chart: chart.clone(), names, program: false, interval: None, of_file, node };
        self.plan.units.push(unit);
        let project = self.plan.project;
        let Some(source) = project.pous.get(pou) else { return index };
        self.elements = self.elements.saturating_add(source.node.descendants().count());
        if above.contains(&pou) || above.len() > DEEPEST {
            let what = say!("the block `{}` contains itself", line(&source.name.text));
            self.report.say(&codes::NOT_CARRIED, &head(node), what);
            return index;
        }
        if index >= MOST_UNITS || self.elements > MOST_ELEMENTS {
            if !self.full {
                self.full = true;
                self.report.say(
                    &codes::TOO_LARGE,
                    &head(node),
                    say!("more instances of blocks than are read"),
                );
            }
            return index;
        }
        let mut path = above.to_vec();
        path.push(pou);
        self.fill(index, source, &chart, &path);
        index
    }

    /// Adds the names within a unit.
    fn fill(&mut self, index: usize, pou: &Pou<'a>, chart: &str, path: &[usize]) {
        let mut names = Names::new();
        for step in steps(pou.node) {
            if let Some(name) = name_of(step) {
                names.entry(name.to_uppercase()).or_insert(Meaning::Step(name));
            }
        }
        for step in pou.actions.iter().flat_map(|a| steps(*a)) {
            if let Some(name) = name_of(step) {
                names.entry(name.to_uppercase()).or_insert(Meaning::Step(name));
            }
        }
        for (number, action) in pou.actions.iter().enumerate() {
            if let Some(name) = name_of(*action) {
                names.insert(name.to_uppercase(), Meaning::Action(number));
            }
        }
        for section in &pou.sections {
            for variable in &section.variables {
                let Some(name) = name_of(*variable) else { continue };
                let upper = name.to_uppercase();
                if self.external(section, &upper) {
                    continue;
                }
                let of_file = self.plan.units.get(index).is_some_and(|u| u.of_file.contains(&upper));
                let home = (!of_file).then_some(chart);
                let meaning = match self.meaning(*variable, Some(chart), name, path) {
                    Meaning::Var(_, name, ty) => Meaning::Var(home.map(str::to_string), name, ty),
                    other => other,
                };
                names.insert(upper, meaning);
            }
        }
        let of_file = self.plan.units.get(index).map(|u| &u.of_file);
        for name in self.made(self.plan.units.get(index).map_or(usize::MAX, |u| u.pou)) {
            let upper = name.to_uppercase();
            let home = of_file.is_none_or(|o| !o.contains(&upper)).then(|| chart.to_string());
            names.insert(upper, Meaning::Var(home, name, None));
        }
        if let Some(unit) = self.plan.units.get_mut(index) {
            unit.names = names;
        }
    }

    /// The variables that the rewritten statements of a unit of the project need.
    fn made(&self, pou: usize) -> impl Iterator<Item = String> + use<'_, 'a> {
        self.plan.code.made.get(&pou).into_iter().flatten().flat_map(|d| &d.names).map(|n| n.text.to_string())
    }

    /// True if a declaration only refers to a global variable.
    fn external(&self, section: &Section, upper: &str) -> bool {
        section.kind == SectionKind::External && self.plan.globals.contains_key(upper)
    }

    /// A name that no other chart and no variable of the file has.
    fn free(&mut self, wanted: &str, node: Xml) -> String {
        let wanted = line(wanted);
        let wanted = if wanted.is_empty() { "Chart".to_string() } else { wanted };
        let name = self.charts.give(&wanted);
        if name != wanted {
            let what = say!("something else is called `{wanted}`; the chart is called `{name}`");
            self.report.say(&codes::RENAMED, &head(node), what);
        }
        name
    }
}

/// The steps of the chart of a unit or an action, including macro-steps and their expansions.
fn steps(pou: Xml<'_>) -> impl Iterator<Item = Xml<'_>> {
    let inside = tree::body(pou).filter(|(l, _)| *l == Language::Sfc).map(|(_, n)| n);
    inside
        .into_iter()
        .flat_map(|n| n.descendants())
        .filter(|n| n.is_element() && matches!(tag(*n).as_str(), "step" | "macroStep"))
}
