//! Builds the document from the units of a file.

use std::collections::{HashMap, HashSet};

use g7_model::codes;
use g7_model::{
    Action, ActionKind, BinaryOp, Block, Body, Chart, ChartItem, ChartKind, Composed, Document, Expr,
    ExprKind, Function, Item, Literal, Name, NamedAction, Nanos, Param, Problem, Profile, ProfileName, Step,
    StepKind, Stmt, Target, Transition as Written, VarDecl, VarKind, say,
};

use super::blocks::{foreign, local, lost_actions, no_type};
use super::unit::{Association, Part, Source, Transition, Unit, UnitKind};
use crate::enumerations;
use crate::nodes;
use crate::report::Report;
use crate::st::{Section, Variable, settle};

/// The document of a file.
pub(super) fn document(mut source: Source, length: usize, report: &mut Report) -> Document {
    source.units.iter_mut().for_each(|unit| copied(unit, report));
    let at = report.span(&(0..length));
    let profile = Profile { name: ProfileName::Iec61131, switches: Vec::new(), at: at.into() };
    let mut items = vec![Item::Profile(profile)];
    let paces = paces(&source, report);
    if let Some(scan) = paces.scan {
        items.push(Item::Cycle(scan, at.into()));
    }
    items.extend(types(&source));
    let turns = Turns::new(&source);
    let mut builder = Builder { source: &source, paces, turns, globals: HashSet::new(), report };
    items.extend(builder.globals());
    let alone = source.units.iter().filter(|u| u.kind != UnitKind::Function && builder.runs(u)).count() == 1;
    if !source.before.is_empty() {
        items.push(Item::Pre(Body::St(nodes::block(source.before.clone(), at)), at.into()));
    }
    let mut charts = Vec::new();
    let (mut before, mut behind) = (Vec::new(), Vec::new());
    for unit in &source.units {
        if !alone && builder.is_code(unit) {
            items.extend(builder.variables(unit).into_iter().map(Item::Var));
            lost_actions(unit, builder.report);
            foreign(unit, builder.report);
            let list = if builder.turns.is_late(unit) { &mut behind } else { &mut before };
            list.push((unit, &unit.body));
            if !unit.behind.is_empty() {
                behind.push((unit, &unit.behind));
            }
            continue;
        }
        let (of_file, unit) = builder.unit(unit, alone);
        items.extend(of_file.into_iter().map(Item::Var));
        charts.extend(unit);
    }
    items.extend(builder.code(before).map(|(b, at)| Item::Pre(b, at)));
    items.extend(builder.code(behind).map(|(b, at)| Item::Post(b, at)));
    items.append(&mut charts);
    let mut document = Document { items, notes: Vec::new() };
    settle(&mut document);
    numbers_as_conditions(&mut document, report);
    enumerations::settle(&mut document, report);
    document
}

/// Puts the copies of the parameters of a program without a chart into its statements.
fn copied(unit: &mut Unit, report: &mut Report) {
    if unit.is_chart() {
        return;
    }
    if !unit.after.is_empty() && unit.body.iter().any(Stmt::returns) {
        let what =
            say!("RETURN in a program whose outputs the configuration connects: they would not be copied");
        report.put(Problem::new(&codes::NOT_CARRIED, unit.name.at.0, what));
    }
    unit.body.splice(0..0, std::mem::take(&mut unit.before));
    let last = if unit.behind.is_empty() { &mut unit.body } else { &mut unit.behind };
    last.append(&mut unit.after);
}

/// The interval of each unit.
struct Paces {
    /// The shortest interval of all.
    scan: Option<Nanos>,
    /// Intervals by the name of the unit in upper case.
    units: HashMap<String, Nanos>,
}

fn paces(source: &Source, report: &mut Report) -> Paces {
    let mut units = HashMap::new();
    let programs: HashSet<String> = source.units.iter().map(|u| u.name.text.to_uppercase()).collect();
    for instance in &source.instances {
        let task = instance.task.as_ref();
        let of = |name: &Name| source.tasks.iter().find(|t| t.name.text.eq_ignore_ascii_case(&name.text));
        let interval = task.and_then(of).and_then(|t| t.interval);
        if let Some(name) = task
            && of(name).is_none()
        {
            let what = say!("there is no task `{}`", name.text);
            report.put(Problem::new(&codes::UNKNOWN_OBJECT, name.at.0, what));
        }
        let name = instance.unit.text.to_uppercase();
        if !programs.contains(&name) {
            let what = say!("there is no program `{}`", instance.unit.text);
            report.put(Problem::new(&codes::UNKNOWN_OBJECT, instance.unit.at.0, what));
        }
        if let Some(interval) = interval {
            units.insert(name, interval);
        }
    }
    // A task may exist only to give the time of a scan.
    let scan = source.tasks.iter().filter_map(|t| t.interval).min().filter(|_| !units.is_empty());
    Paces { scan, units }
}

/// The order in which the programs run.
struct Turns {
    /// The first turn of each program, by its name in upper case.
    of: HashMap<String, usize>,
    /// The turn of the chart that runs last.
    last_chart: Option<usize>,
}

impl Turns {
    fn new(source: &Source) -> Turns {
        let mut of = HashMap::new();
        for (turn, instance) in source.instances.iter().enumerate() {
            of.entry(instance.unit.text.to_uppercase()).or_insert(turn);
        }
        let mut turns = Turns { of, last_chart: None };
        turns.last_chart = source.units.iter().filter(|u| u.is_chart()).filter_map(|u| turns.of(u)).max();
        turns
    }

    fn of(&self, unit: &Unit) -> Option<usize> {
        self.of.get(&unit.name.text.to_uppercase()).copied()
    }

    /// True if a program runs behind all charts.
    fn is_late(&self, unit: &Unit) -> bool {
        matches!((self.of(unit), self.last_chart), (Some(own), Some(last)) if own > last)
    }
}

struct Builder<'a> {
    source: &'a Source,
    paces: Paces,
    turns: Turns,
    /// The names of the file's variables, in upper case.
    globals: HashSet<String>,
    report: &'a mut Report,
}

impl Builder<'_> {
    /// The variables of the file, and those that units expect there but nobody declares.
    fn globals(&mut self) -> Vec<Item> {
        let source = self.source;
        let mut items = Vec::new();
        for variable in &source.globals {
            if known_type(self.source, variable, self.report) && self.globals.insert(upper(variable)) {
                items.push(Item::Var(variable.decl.clone()));
            }
        }
        let externals = source.units.iter().flat_map(|u| &u.vars).filter(|v| v.section == Section::External);
        for variable in externals.chain(&source.externals) {
            if !known_type(self.source, variable, self.report) || !self.globals.insert(upper(variable)) {
                continue;
            }
            let name = variable.decl.names.first().map_or("", |n| &*n.text);
            let what =
                say!("no global variable `{name}` is declared in this file; it is one with its first value");
            self.report.put(Problem::new(&codes::DIFFERENT, variable.decl.at.0, what));
            items.push(Item::Var(variable.decl.clone()));
        }
        items
    }

    /// True if a unit is carried over as something that runs: a program, a chart, or the only
    /// function block of the file.
    fn runs(&self, unit: &Unit) -> bool {
        let mut others = self.source.units.iter().filter(|u| !std::ptr::eq(*u, unit));
        unit.is_chart()
            || unit.kind == UnitKind::Program
            || unit.kind == UnitKind::FunctionBlock && others.all(|u| u.kind == UnitKind::Function)
    }

    /// True if a program consists of statements that can run in each scan of the file, with names
    /// that nothing else in the file has.
    fn is_code(&mut self, unit: &Unit) -> bool {
        let pace = self.paces.units.get(&unit.name.text.to_uppercase());
        let base = pace.is_none_or(|p| Some(*p) == self.paces.scan);
        if unit.is_chart() || unit.kind != UnitKind::Program || !base {
            return false;
        }
        let own: Vec<String> =
            unit.vars.iter().filter(|v| v.section != Section::External).map(upper).collect();
        if own.iter().any(|n| self.globals.contains(n)) {
            return false;
        }
        self.globals.extend(own);
        true
    }

    /// The bodies of programs without steps, in order.
    fn code(&mut self, mut units: Vec<(&Unit, &Vec<Stmt>)>) -> Option<(Body, g7_model::Place)> {
        units.sort_by_key(|(unit, _)| self.turns.of(unit).unwrap_or(usize::MAX));
        let at = units.first()?.0.at;
        if units.len() > 1 {
            for (unit, _) in units.iter().filter(|u| u.1.iter().any(Stmt::returns)) {
                let what = say!("RETURN in one of several programs: the others would not run either");
                self.report.put(Problem::new(&codes::NOT_CARRIED, unit.name.at.0, what));
            }
        }
        let statements = units.iter().flat_map(|u| u.1.iter().cloned()).collect();
        Some((Body::St(Block { locals: Vec::new(), statements, at: at.into() }), at.into()))
    }

    /// The variables of the file and the items that a unit becomes.
    fn unit(&mut self, unit: &Unit, alone: bool) -> (Vec<VarDecl>, Option<Item>) {
        if unit.kind == UnitKind::Function {
            return (Vec::new(), function(self.source, unit, self.report).map(Item::Function));
        }
        if !self.runs(unit) {
            let what = say!("the function block `{}` is not used; it is left out", unit.name.text);
            self.report.put(Problem::new(&codes::LEFT_OUT, unit.name.at.0, what));
            return (Vec::new(), None);
        }
        foreign(unit, self.report);
        let vars = self.variables(unit);
        let block = Block { locals: Vec::new(), statements: unit.body.clone(), at: unit.at.into() };
        if unit.is_chart() && !unit.body.is_empty() {
            let what = say!("statements in a unit that is a chart; they belong into an action");
            self.report.say(&codes::NOT_CARRIED, &unit.body_at, what);
        }
        if !unit.is_chart() && alone {
            lost_actions(unit, self.report);
            return (vars, Some(Item::Pre(Body::St(block), unit.at.into())));
        }
        let mut items = Vec::new();
        let of_file = if alone {
            vars
        } else {
            items.extend(vars.into_iter().map(ChartItem::Var));
            Vec::new()
        };
        if unit.is_chart() {
            let copies = |list: &Vec<Stmt>| Body::St(nodes::block(list.clone(), unit.at));
            items.extend(step_first(&unit.parts).map(|part| self.part(unit, part)));
            let filled = |list: &&Vec<Stmt>| !list.is_empty();
            items
                .extend(Some(&unit.before).filter(filled).map(|b| ChartItem::Pre(copies(b), unit.at.into())));
            items
                .extend(Some(&unit.after).filter(filled).map(|b| ChartItem::Post(copies(b), unit.at.into())));
        } else {
            lost_actions(unit, self.report);
            items.push(ChartItem::Pre(Body::St(block), unit.at.into()));
            if !unit.behind.is_empty() {
                let block = Block { locals: Vec::new(), statements: unit.behind.clone(), at: unit.at.into() };
                items.push(ChartItem::Post(Body::St(block), unit.at.into()));
            }
        }
        let every = self.paces.units.get(&unit.name.text.to_uppercase()).copied();
        let chart = Chart {
            kind: ChartKind::Chart,
            name: unit.name.clone(),
            params: Vec::new(),
            block: None,
            comment: None,
            every: every.filter(|e| Some(*e) != self.paces.scan),
            items,
            at: unit.at.into(),
        };
        (of_file, Some(Item::Chart(chart)))
    }

    /// The variables of a unit, with the addresses that a resource gives them.
    fn variables(&mut self, unit: &Unit) -> Vec<VarDecl> {
        let mut decls = Vec::new();
        for variable in unit.vars.iter().filter(|v| v.section != Section::External) {
            if !known_type(self.source, variable, self.report) {
                continue;
            }
            let name = variable.decl.names.first().map_or("", |n| &*n.text);
            let what = match variable.section {
                Section::InOut => {
                    Some(say!("`{name}` is a variable of the chart; nothing outside is changed by it"))
                }
                Section::Temp => Some(say!("`{name}` keeps its value from scan to scan")),
                _ => None,
            };
            if let Some(what) = what {
                self.report.put(Problem::new(&codes::DIFFERENT, variable.decl.at.0, what));
            }
            decls.push(variable.decl.clone());
        }
        let source = self.source;
        let here = |i: &&super::unit::Instance| i.unit.text.eq_ignore_ascii_case(&unit.name.text);
        for (name, value) in source.instances.iter().filter(here).flat_map(|i| &i.links) {
            self.link(&mut decls, name, value);
        }
        decls
    }

    /// `START := %I0.0`.
    fn link(&mut self, decls: &mut [VarDecl], name: &Name, value: &Expr) {
        let named = |d: &&mut VarDecl| d.names.iter().any(|n| n.text.eq_ignore_ascii_case(&name.text));
        let Some(decl) = decls.iter_mut().find(named) else {
            let what = say!("the program has no variable `{}`", name.text);
            return self.report.put(Problem::new(&codes::UNKNOWN_OBJECT, name.at.0, what));
        };
        match &value.kind {
            ExprKind::Direct(address) if decl.kind != VarKind::Const => {
                decl.address = Some(Name::new(format!("%{address}"), value.at.0));
            }
            ExprKind::Bad => {}
            _ => {
                let what =
                    say!("a variable of a program stands at an address; other values have no counterpart");
                self.report.put(Problem::new(&codes::NOT_CARRIED, value.at.0, what));
            }
        }
    }

    fn part(&mut self, unit: &Unit, part: &Part) -> ChartItem {
        match part {
            Part::Step { name, initial, associations, at } => {
                let actions: Vec<Action> = associations.iter().map(|a| self.association(a)).collect();
                ChartItem::Step(Step {
                    name: name.clone(),
                    kind: StepKind::Plain,
                    initial: *initial,
                    linked: false,
                    comment: None,
                    braces: !actions.is_empty(),
                    actions,
                    at: (*at).into(),
                })
            }
            Part::Transition(t) => ChartItem::Transition(self.transition(unit, t)),
            Part::Action { name, body, at } => {
                let block = Block { locals: Vec::new(), statements: body.clone(), at: (*at).into() };
                let at = (*at).into();
                ChartItem::Action(NamedAction {
                    name: name.clone(),
                    comment: None,
                    body: Body::St(block),
                    at,
                })
            }
        }
    }

    fn association(&mut self, a: &Association) -> Action {
        let target = match &a.target.kind {
            ExprKind::Direct(name) => Target::Direct(name.clone(), a.target.at),
            ExprKind::Path(path) => Target::Path(path.clone()),
            ExprKind::Element(..) => Target::Element(Box::new(a.target.clone())),
            _ => Target::Path(g7_model::Path { names: Vec::new() }),
        };
        let kind =
            ActionKind::Qualified { qualifier: a.qualifier, time: a.time.clone(), target, condition: None };
        Action { kind, at: a.at.into() }
    }

    fn transition(&mut self, unit: &Unit, t: &Transition) -> Written {
        if t.priority == Some(0) {
            let what = say!("priority 0 in `{}`; 1 is the highest", unit.name.text);
            self.report.put(Problem::new(&codes::BAD_VALUE, t.at, what));
        }
        Written {
            label: t.label.clone(),
            from: t.from.clone(),
            to: t.to.clone(),
            receptivity: t.receptivity.clone(),
            priority: t.priority.filter(|p| *p > 0),
            comment: None,
            on_clearing: None,
            chained: false,
            at: t.at.into(),
        }
    }
}

/// True if the type of a variable is known; otherwise reports it.
fn known_type(source: &Source, variable: &Variable, report: &mut Report) -> bool {
    let Some(ty) = &variable.unknown else { return true };
    let named = |c: &Composed| c.name.text.eq_ignore_ascii_case(&ty.text);
    if source.blocks.iter().chain(&source.types.structures).any(named) {
        return true;
    }
    report.put(Problem::new(&codes::NOT_CARRIED, variable.decl.at.0, no_type(source, ty)));
    false
}

/// The function of a unit; None if it has no result.
pub(crate) fn function(source: &Source, unit: &Unit, report: &mut Report) -> Option<Function> {
    let given = &unit.result.as_ref()?.decl;
    let result = given.value_type();
    foreign(unit, report);
    let mut params = Vec::new();
    let mut locals = Vec::new();
    for variable in &unit.vars {
        if variable.section == Section::External || !known_type(source, variable, report) {
            continue;
        }
        let decl = &variable.decl;
        match variable.section {
            Section::Input => {
                params.extend(
                    decl.names.iter().map(|name| Param { name: name.clone(), ty: decl.value_type() }),
                );
            }
            _ => locals.push(local(decl.clone())),
        }
    }
    let statements: Vec<Stmt> = unit.body.clone();
    let body = Block { locals, statements, at: unit.at.into() };
    Some(Function { name: unit.name.clone(), params, result, body, at: unit.at.into() })
}

/// The parts of a chart in their order, but for what stands before the first step: it follows that
/// step. The order of actions among each other, of transitions and of steps is kept. Compilers want
/// a step first, so a text that is written has one there; this gives the same document for both.
fn step_first(parts: &[Part]) -> impl Iterator<Item = &Part> {
    let first = parts.iter().position(|p| matches!(p, Part::Step { .. })).unwrap_or(0);
    let (before, rest) = parts.split_at(first);
    let (step, behind) = rest.split_at(rest.len().min(1));
    step.iter().chain(before).chain(behind)
}

fn upper(variable: &Variable) -> String {
    variable.decl.names.first().map_or(String::new(), |n| n.text.to_uppercase())
}

/// The enumerations, the structures and the function blocks.
pub(super) fn types(source: &Source) -> impl Iterator<Item = Item> + use<'_> {
    let enumerations = source.types.enumerations.iter().cloned();
    let composed = source.types.structures.iter().chain(&source.blocks).cloned();
    enumerations.map(Item::Type).chain(composed.map(Item::Composed))
}

/// Some tools allow a number as a condition: it is true unless it is 0.
fn numbers_as_conditions(document: &mut Document, report: &mut Report) {
    let mut of_file = HashMap::new();
    for item in &document.items {
        if let Item::Var(v) = item {
            of_file.extend(v.names.iter().map(|n| (n.text.clone(), v.ty)));
        }
    }
    for item in &mut document.items {
        let Item::Chart(chart) = item else { continue };
        let mut own = HashMap::new();
        for var in chart.vars() {
            own.extend(var.names.iter().map(|n| (n.text.clone(), var.ty)));
        }
        for item in &mut chart.items {
            let ChartItem::Transition(t) = item else { continue };
            let ExprKind::Path(path) = &t.receptivity.kind else { continue };
            let [name] = path.names.as_slice() else { continue };
            let ty = own.get(&name.text).or_else(|| of_file.get(&name.text));
            if !ty.is_some_and(|t| t.is_integer()) {
                continue;
            }
            let at = t.receptivity.at;
            let what = say!("`{}` is a number, no condition; it is compared with 0", name.text);
            report.put(Problem::new(&codes::DIFFERENT, at.0, what));
            let zero = Expr { kind: ExprKind::Literal(Literal::Int(0, None)), at };
            let kind = ExprKind::Binary(BinaryOp::Ne, Box::new(t.receptivity.clone()), Box::new(zero));
            t.receptivity = Expr { kind, at };
        }
    }
}
