//! The meaning of names in the document, and the references to everything in the file.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::{
    ActionKind, Chart, Document, Expr, Item, Name, Nanos, Order, Path, Step, StepKind, Type, VarDecl, VarKind,
};

use crate::xmi::timed;

/// A step: its chart and its number there.
pub(super) type Node = (usize, usize);

/// The meaning of a path.
pub(super) enum Meaning<'d> {
    /// A variable: the reference to its declaration and its type.
    Var(String, Type),
    /// A constant with its value.
    Const(&'d Expr),
    /// The activity of a step.
    Step(Node),
}

/// A declaration that is made only because a term uses it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Asked {
    /// The activity of a step.
    Step(Node),
    /// A time operator on it, as a Boolean of this name.
    Timed(String),
}

/// A variable of the file or of a chart.
struct Var<'d> {
    /// Its number among the variables that are written; constants are not counted.
    number: usize,
    declared: &'d VarDecl,
}

/// The names of a document.
pub(super) struct Lookup<'d> {
    charts: Vec<&'d Chart>,
    by_name: HashMap<&'d str, usize>,
    file_vars: Vec<&'d VarDecl>,
    /// The variables by chart (None: the file) and name.
    vars: HashMap<(Option<usize>, &'d str), Var<'d>>,
    steps: Vec<HashMap<&'d str, usize>>,
    nodes: Vec<Vec<NodeInfo>>,
    /// The number of variables of the file that are written.
    declared: usize,
    /// The steps whose activity a term uses, by the number of the declaration.
    asked: BTreeMap<usize, Asked>,
    numbers: HashMap<Asked, usize>,
    enclosing: HashMap<&'d str, Node>,
}

/// How a step is written.
struct NodeInfo {
    /// The feature that holds it.
    feature: &'static str,
    enclosing: bool,
    place: String,
    number: String,
    renumbered: bool,
}

impl<'d> Lookup<'d> {
    pub(super) fn new(document: &'d Document) -> Lookup<'d> {
        let charts: Vec<&Chart> = document.charts().collect();
        let file_vars: Vec<&VarDecl> =
            document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None }).collect();
        let mut look = Lookup {
            by_name: HashMap::new(),
            vars: HashMap::new(),
            steps: Vec::new(),
            nodes: Vec::new(),
            declared: 0,
            asked: BTreeMap::new(),
            numbers: HashMap::new(),
            enclosing: HashMap::new(),
            charts,
            file_vars,
        };
        look.declared = look.declare(None, look.file_vars.clone());
        for index in 0..look.charts.len() {
            let Some(chart) = look.charts.get(index).copied() else { continue };
            look.by_name.entry(&chart.name.text).or_insert(index);
            look.declare(Some(index), chart.vars().collect());
            look.number_steps(index, chart);
        }
        look
    }

    /// Numbers the variables of a chart or of the file, and returns how many are written.
    fn declare(&mut self, sheet: Option<usize>, vars: Vec<&'d VarDecl>) -> usize {
        let mut number = 0;
        for declared in vars {
            for name in &declared.names {
                self.vars.entry((sheet, &name.text)).or_insert(Var { number, declared });
                number += usize::from(is_written(declared));
            }
        }
        number
    }

    /// Gives each step its position and its number: its own if it has one.
    fn number_steps(&mut self, sheet: usize, chart: &'d Chart) {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut by_name = HashMap::new();
        let mut infos = Vec::new();
        let mut taken: HashSet<String> = chart.steps().filter_map(own_number).collect();
        let mut next = 1u32;
        for (index, step) in chart.steps().enumerate() {
            by_name.entry(&*step.name.text).or_insert(index);
            let feature = match step.kind {
                StepKind::Plain | StepKind::Enclosing => "steps",
                StepKind::Macro(_) => "macrosteps",
                StepKind::Entry => "entryStep",
                StepKind::Exit => "exitStep",
            };
            let count = places.entry(feature).or_default();
            let place = match step.kind {
                StepKind::Entry | StepKind::Exit => format!("//@partialGrafcets.{sheet}/@{feature}"),
                _ => format!("//@partialGrafcets.{sheet}/@{feature}.{count}"),
            };
            *count += 1;
            let own = own_number(step);
            let renumbered = own.is_none();
            let number = own.unwrap_or_else(|| {
                while !taken.insert(next.to_string()) {
                    next += 1;
                }
                next.to_string()
            });
            let enclosing = step.kind == StepKind::Enclosing;
            infos.push(NodeInfo { feature, enclosing, place, number, renumbered });
            for action in &step.actions {
                if let ActionKind::Order(Order::Enclose(inner)) = &action.kind {
                    self.enclosing.entry(&inner.text).or_insert((sheet, index));
                }
            }
        }
        self.steps.push(by_name);
        self.nodes.push(infos);
    }

    pub(super) fn charts(&self) -> &[&'d Chart] {
        &self.charts
    }

    pub(super) fn file_vars(&self) -> Vec<&'d VarDecl> {
        self.file_vars.clone()
    }

    pub(super) fn chart(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    pub(super) fn chart_place(&self, name: &str) -> Option<String> {
        self.chart(name).map(|c| format!("//@partialGrafcets.{c}"))
    }

    pub(super) fn step_node(&self, sheet: usize, name: &str) -> Option<Node> {
        self.steps.get(sheet)?.get(name).map(|step| (sheet, *step))
    }

    pub(super) fn place(&self, node: Node) -> String {
        self.info(node).map(|i| i.place.clone()).unwrap_or_default()
    }

    pub(super) fn number(&self, node: Node) -> String {
        self.info(node).map(|i| i.number.clone()).unwrap_or_default()
    }

    pub(super) fn renumbered(&self, node: Node) -> bool {
        self.info(node).is_some_and(|i| i.renumbered)
    }

    fn info(&self, node: Node) -> Option<&NodeInfo> {
        self.nodes.get(node.0).and_then(|c| c.get(node.1))
    }

    /// The step that encloses a chart.
    pub(super) fn enclosing(&self, chart: &str) -> Option<String> {
        self.enclosing.get(chart).map(|node| self.place(*node))
    }

    /// The charts that a step encloses.
    pub(super) fn enclosed_by(&self, step: &Step) -> String {
        let inner = step.actions.iter().filter_map(|a| match &a.kind {
            ActionKind::Order(Order::Enclose(name)) => self.chart_place(&name.text),
            _ => None,
        });
        inner.collect::<Vec<_>>().join(" ")
    }

    /// True for a step that the meta-model calls initialisable: only such a step can be forced, and only its
    /// activity can be read. Macro-steps and the entry and exit steps of expansions are not initialisable.
    pub(super) fn is_initialisable(&self, node: Node) -> bool {
        self.info(node).is_some_and(|i| i.feature == "steps")
    }

    /// True for a step to which an action can be linked.
    pub(super) fn takes_actions(&self, node: Node) -> bool {
        self.info(node).is_some_and(|i| i.feature == "steps" && !i.enclosing)
    }

    /// The name of the Boolean for a time operator on the activity of a step, if the reader finds
    /// the step by its number.
    pub(super) fn timed_name(&self, time: Nanos, node: Node) -> Option<String> {
        let info = self.info(node).filter(|i| i.feature == "steps")?;
        let same = |i: &&NodeInfo| i.feature == "steps" && i.number == info.number;
        let alone = self.nodes.iter().flatten().filter(same).count() == 1;
        let name = timed::name(time, &info.number)?;
        (alone && !self.vars.contains_key(&(None, &name))).then_some(name)
    }

    /// A declaration that is made at its first use.
    pub(super) fn ask(&mut self, asked: Asked) -> String {
        let next = self.declared + self.asked.len();
        let number = *self.numbers.entry(asked.clone()).or_insert(next);
        self.asked.insert(number, asked);
        format!("//@variableDeclarationContainer/@variableDeclarations.{number}")
    }

    /// The declarations that were asked for, in their order.
    pub(super) fn take_asked(&mut self) -> Vec<Asked> {
        std::mem::take(&mut self.asked).into_values().collect()
    }

    /// The meaning of a path in a chart, in the order of the grammar.
    pub(super) fn path(&self, sheet: usize, path: &Path) -> Option<Meaning<'d>> {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        if let [name] = names[..] {
            let var = self.var(Some(sheet), name).or_else(|| self.var(None, name));
            return var.or_else(|| self.activity(sheet, name).map(Meaning::Step));
        }
        let (first, rest) = names.split_first()?;
        if let Some(chart) = self.inner(sheet, first) {
            if let [name] = rest
                && let Some(var) = self.var(Some(chart), name)
            {
                return Some(var);
            }
            if let Some(step) = self.step_of(chart, rest) {
                return Some(Meaning::Step(step));
            }
        }
        match rest {
            ["X"] => self.home(sheet, first).map(Meaning::Step),
            _ => None,
        }
    }

    /// A chart, or the expansion of a macro-step of this one.
    fn inner(&self, sheet: usize, name: &str) -> Option<usize> {
        self.chart(name).or_else(|| {
            let (chart, step) = self.home(sheet, name)?;
            match &self.charts.get(chart)?.steps().nth(step)?.kind {
                StepKind::Macro(expansion) => self.chart(&expansion.text),
                _ => None,
            }
        })
    }

    /// `X12`, `Fill.X` or `M3.X12` within a chart that has been named.
    fn step_of(&self, chart: usize, rest: &[&str]) -> Option<Node> {
        let (first, more) = rest.split_first()?;
        match more {
            [] => self.step_node(chart, first.strip_prefix('X')?),
            ["X"] => self.step_node(chart, first),
            _ => {
                let (_, step) = self.step_node(chart, first)?;
                match &self.charts.get(chart)?.steps().nth(step)?.kind {
                    StepKind::Macro(expansion) => self.step_of(self.chart(&expansion.text)?, more),
                    _ => None,
                }
            }
        }
    }

    fn activity(&self, sheet: usize, name: &str) -> Option<Node> {
        self.home(sheet, name.strip_prefix('X')?)
    }

    /// A step by its name alone: of this chart, otherwise the only one in all charts.
    fn home(&self, sheet: usize, name: &str) -> Option<Node> {
        self.step_node(sheet, name).or_else(|| {
            let all = |kind: fn(&Chart) -> bool| {
                let charts = self.charts.iter().enumerate().filter(move |(_, c)| kind(c));
                charts.filter_map(|(c, _)| self.step_node(c, name)).collect::<Vec<_>>()
            };
            let of_charts = all(|c| c.kind == g7_model::ChartKind::Chart);
            let found = if of_charts.is_empty() { all(|_| true) } else { of_charts };
            match found[..] {
                [one] => Some(one),
                _ => None,
            }
        })
    }

    fn var(&self, sheet: Option<usize>, name: &str) -> Option<Meaning<'d>> {
        let var = self.vars.get(&(sheet, name))?;
        if var.declared.kind == VarKind::Const {
            return var.declared.init.as_ref().map(Meaning::Const);
        }
        is_written(var.declared).then(|| Meaning::Var(reference(sheet, var.number), var.declared.ty))
    }

    /// The variable declared at an address.
    pub(super) fn direct(&self, address: &str) -> Option<Meaning<'d>> {
        let at = |name: &Name| name.text.trim_start_matches('%').eq_ignore_ascii_case(address);
        let declared = self.file_vars.iter().find(|v| v.address.as_ref().is_some_and(at))?;
        self.var(None, &declared.names.first()?.text)
    }
}

/// True if the meta-model has a declaration for the variable.
fn is_written(declared: &VarDecl) -> bool {
    declared.kind != VarKind::Const && (declared.ty == Type::Bool || declared.ty.is_integer())
}

fn reference(sheet: Option<usize>, number: usize) -> String {
    let holder = sheet.map_or(String::from("/"), |s| format!("//@partialGrafcets.{s}"));
    format!("{holder}/@variableDeclarationContainer/@variableDeclarations.{number}")
}

/// The number of a step whose name contains one: `12`, `M3`, `E3`, `S3`.
fn own_number(step: &Step) -> Option<String> {
    let letter = match step.kind {
        StepKind::Plain | StepKind::Enclosing => "",
        StepKind::Macro(_) => "M",
        StepKind::Entry => "E",
        StepKind::Exit => "S",
    };
    let number = step.name.text.strip_prefix(letter)?;
    number.parse::<i32>().is_ok_and(|n| n.to_string() == number).then(|| number.to_string())
}
