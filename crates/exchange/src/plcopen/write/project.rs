//! The whole project: programs, functions, tasks.

use g7_model::codes;
use g7_model::{
    Block, Body, Chart, ChartItem, ChartKind, Document, Function, Item, NamedAction, Problem, Profile,
    ProfileName, Section, Stmt, Switch, VarDecl,
};

use super::declare::{external, initial, lists, type_of, value};
use super::names::{Names, Scope};
use super::sfc::{Sfc, chart_name};
use super::st::{Text, duration};
use super::xml::Element;
use crate::Written;

/// The nominal scan time where the document has none.
const SCAN: i64 = 10_000_000;
/// A file says when it was made; ours says what it was made of.
const MADE: &str = "2026-01-01T00:00:00";

/// Writes a document.
pub(in crate::plcopen) fn export(document: &Document) -> Written {
    let mut problems = Vec::new();
    let mut names = Names::default();
    profile(document, &mut problems);
    leftovers(document, &mut problems);
    let mut writer = Writer { document, names: &mut names, problems: &mut problems };
    let project = writer.project();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
    project.print(0, &mut text);
    problems.append(&mut names.renamed);
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

/// The document's rules against those of IEC 61131-3.
fn profile(document: &Document, problems: &mut Vec<Problem>) {
    let Some(at) = document.items.iter().find_map(item_at) else { return };
    match document.profile() {
        Some(Profile { name: ProfileName::Iec61131, switches, .. }) => {
            for (switch, at) in switches {
                if !matches!(switch, Switch::FinalScan(true) | Switch::Bound(_)) {
                    let what = "a rule that is not that of IEC 61131-3; the file does not tell it";
                    problems.push(Problem::new(&codes::DIFFERENT, at.0, what));
                }
            }
        }
        other => {
            let name = other.map_or(ProfileName::default(), |p| p.name).name();
            let at = other.map_or(at, |p| p.at);
            let what =
                format!("the document runs by the rules of `{name}`, the file by those of IEC 61131-3");
            problems.push(Problem::new(&codes::DIFFERENT, at.0, what));
        }
    }
}

fn item_at(item: &Item) -> Option<g7_model::Place> {
    Some(match item {
        Item::Profile(p) => p.at,
        Item::Cycle(_, at) | Item::Target(_, at) | Item::Pre(_, at) | Item::Post(_, at) => *at,
        Item::Var(v) => v.at,
        Item::Chart(c) => c.at,
        Item::Action(a) => a.at,
        Item::Section(s) => s.at,
        Item::Function(f) => f.at,
        Item::Plant(p) => p.at,
        Item::Test(t) => t.at,
        Item::Prove(p) => p.at,
        Item::Layout(l) => l.at,
    })
}

/// Parts that no project of TC6 has.
fn leftovers(document: &Document, problems: &mut Vec<Problem>) {
    for item in &document.items {
        let Some(at) = item_at(item) else { continue };
        let what = match item {
            Item::Plant(_) => "a plant is left out",
            Item::Test(_) => "a test is left out",
            Item::Prove(_) => "a property is left out",
            Item::Target(..) => "the PLC whose limits are checked is left out",
            Item::Chart(c) if c.kind == ChartKind::Task => {
                let what = "a task, which IEC 61131-3 does not have";
                problems.push(Problem::new(&codes::NOT_CARRIED, at.0, what));
                continue;
            }
            _ => continue,
        };
        problems.push(Problem::new(&codes::LEFT_OUT, at.0, what));
    }
}

/// A program and the task that runs it.
struct Program {
    name: String,
    every: Option<i64>,
}

struct Writer<'w> {
    document: &'w Document,
    names: &'w mut Names,
    problems: &'w mut Vec<Problem>,
}

impl<'w> Writer<'w> {
    fn charts(&self) -> impl Iterator<Item = &'w Chart> + use<'w> {
        self.document.charts().filter(|c| c.kind == ChartKind::Chart)
    }

    fn variables(&self) -> impl Iterator<Item = &'w VarDecl> + Clone + use<'w> {
        self.document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None })
    }

    fn scope(&self, chart: Option<&'w Chart>) -> Scope<'w> {
        Scope { document: self.document, chart, function: None }
    }

    fn project(&mut self) -> Element {
        let bodies = self.document.items.iter().any(|i| matches!(i, Item::Pre(..) | Item::Post(..)));
        let inner = self
            .charts()
            .flat_map(|c| &c.items)
            .any(|i| matches!(i, ChartItem::Pre(..) | ChartItem::Post(..)));
        let single = self.charts().count() == 1 && !bodies && !inner;
        let mut pous = Vec::new();
        for item in &self.document.items {
            if let Item::Function(function) = item {
                pous.push(self.function(function));
            }
        }
        // Names of variables are given first: they stay as they are, if any can.
        for decl in self.variables() {
            for name in &decl.names {
                self.names.give(name);
            }
        }
        let mut programs = Vec::new();
        self.texts(true, &mut pous, &mut programs);
        for chart in self.charts() {
            let pou = self.chart(chart, single);
            pous.push(pou);
            programs.push(Program { name: chart_name(self.names, chart), every: chart.every });
        }
        self.texts(false, &mut pous, &mut programs);
        let title = self.charts().next().map_or_else(|| "Project".to_string(), |c| c.name.text.to_string());
        let resource = self.resource(single, &programs);
        let configuration = Element::new("configuration").with("name", "Configuration").child(resource);
        Element::new("project")
            .with("xmlns", "http://www.plcopen.org/xml/tc6_0201")
            .child(
                Element::new("fileHeader")
                    .with("companyName", "G7")
                    .with("productName", "G7")
                    .with("productVersion", env!("CARGO_PKG_VERSION"))
                    .with("creationDateTime", MADE),
            )
            .child(Element::new("contentHeader").with("name", title).child(coordinates()))
            .child(
                Element::new("types")
                    .child(Element::new("dataTypes"))
                    .child(Element::new("pous").children(pous)),
            )
            .child(Element::new("instances").child(Element::new("configurations").child(configuration)))
    }

    fn resource(&mut self, single: bool, programs: &[Program]) -> Element {
        let scan = self
            .document
            .items
            .iter()
            .find_map(|i| if let Item::Cycle(ns, _) = i { Some(*ns) } else { None });
        // Without a word of times the tasks have none either.
        let timed = scan.is_some() || programs.iter().any(|p| p.every.is_some());
        let scan = scan.unwrap_or(SCAN);
        let mut intervals: Vec<i64> = programs.iter().map(|p| p.every.unwrap_or(scan)).collect();
        intervals.push(scan);
        intervals.sort_unstable();
        intervals.dedup();
        let mut resource = Element::new("resource").with("name", "Resource");
        for (priority, interval) in intervals.iter().enumerate() {
            let mut task = Element::new("task").with("name", format!("Task{}", priority + 1));
            if timed {
                task = task.with("interval", duration(*interval));
            }
            task = task.with("priority", priority);
            for program in programs.iter().filter(|p| p.every.unwrap_or(scan) == *interval) {
                let instance =
                    Element::new("pouInstance").with("name", &program.name).with("typeName", &program.name);
                task.push(instance);
            }
            resource.push(task);
        }
        if !single {
            let scope = self.scope(None);
            resource = resource.children(lists(
                &self.variables().collect::<Vec<_>>(),
                true,
                self.names,
                scope,
                self.problems,
            ));
        }
        resource
    }

    /// Bodies before (or behind) the charts as programs of their own.
    fn texts(&mut self, before: bool, pous: &mut Vec<Element>, programs: &mut Vec<Program>) {
        let of_file = self.document.items.iter().filter_map(|i| match (i, before) {
            (Item::Pre(body, at), true) | (Item::Post(body, at), false) => Some((body, *at, None)),
            _ => None,
        });
        let of_charts = self.charts().flat_map(|c| c.items.iter().map(move |i| (c, i)));
        let of_charts = of_charts.filter_map(|(c, i)| match (i, before) {
            (ChartItem::Pre(body, at), true) | (ChartItem::Post(body, at), false) => {
                Some((body, *at, Some(c)))
            }
            _ => None,
        });
        let bodies: Vec<_> = of_file.chain(of_charts).collect();
        for (body, at, chart) in bodies {
            let word = if before { "Pre" } else { "Post" };
            let title = chart.map_or_else(|| word.to_string(), |c| format!("{}_{word}", c.name.text));
            let name = self.names.give(&g7_model::Name::new(title, at.0));
            if chart.is_some_and(|c| c.every.is_some()) {
                let what = "a body of a chart with a period of its own; it runs in every scan";
                self.problems.push(Problem::new(&codes::DIFFERENT, at.0, what));
            }
            let text = self.body(body, self.scope(chart));
            let interface = Element::new("interface").children(external(self.variables(), self.names));
            pous.push(
                Element::new("pou")
                    .with("name", &name)
                    .with("pouType", "program")
                    .child(interface)
                    .child(Element::new("body").child(Element::formatted("ST", &text))),
            );
            programs.push(Program { name, every: None });
        }
    }

    fn statements(&mut self, statements: &[Stmt], scope: Scope) -> String {
        Text { names: self.names, scope, problems: self.problems }.statements(statements)
    }

    fn body(&mut self, body: &Body, scope: Scope) -> String {
        match body {
            Body::St(block) => self.block(block, scope),
            // The statements that the list or ladder stands for.
            Body::Other(_, _, block) => self.block(block, scope),
        }
    }

    fn block(&mut self, block: &Block, scope: Scope) -> String {
        for local in &block.locals {
            let what = "a variable of a block's own, outside a function";
            self.problems.push(Problem::new(&codes::NOT_CARRIED, local.at.0, what));
        }
        self.statements(&block.statements, scope)
    }

    /// A chart as a program.
    fn chart(&mut self, chart: &'w Chart, single: bool) -> Element {
        let scope = self.scope(Some(chart));
        let name = chart_name(self.names, chart);
        let mut interface = Element::new("interface");
        let of_chart = lists(&chart.vars().collect::<Vec<_>>(), false, self.names, scope, self.problems);
        if single {
            let of_file =
                lists(&self.variables().collect::<Vec<_>>(), false, self.names, scope, self.problems);
            interface = interface.children(of_file).children(of_chart);
        } else {
            interface = interface.children(of_chart).children(external(self.variables(), self.names));
        }
        let mut pou = Element::new("pou").with("name", name).with("pouType", "program").child(interface);
        let actions: Vec<Element> = self.actions_of(chart).iter().map(|a| self.action(a, scope)).collect();
        if !actions.is_empty() {
            pou.push(Element::new("actions").children(actions));
        }
        let sections: Vec<Element> = self.sections_of(chart).iter().map(|s| self.section(s, scope)).collect();
        if !sections.is_empty() {
            pou.push(Element::new("transitions").children(sections));
        }
        let mut sfc = Sfc::new(self.names, scope, self.problems, final_scan(self.document));
        let body = sfc.body(chart, 0);
        pou.push(Element::new("body").child(body));
        if let Some(comment) = &chart.comment {
            pou.push(Element::formatted("documentation", comment));
        }
        pou
    }

    /// Named actions of a chart, of the expansions in it and of the file.
    fn actions_of(&self, chart: &'w Chart) -> Vec<&'w NamedAction> {
        let of = |c: &'w Chart| {
            c.items.iter().filter_map(|i| if let ChartItem::Action(a) = i { Some(a) } else { None })
        };
        let of_file =
            self.document.items.iter().filter_map(|i| if let Item::Action(a) = i { Some(a) } else { None });
        self.with_expansions(chart).flat_map(of).chain(of_file).collect()
    }

    fn sections_of(&self, chart: &'w Chart) -> Vec<&'w Section> {
        let of = |c: &'w Chart| {
            c.items.iter().filter_map(|i| if let ChartItem::Section(s) = i { Some(s) } else { None })
        };
        let of_file =
            self.document.items.iter().filter_map(|i| if let Item::Section(s) = i { Some(s) } else { None });
        self.with_expansions(chart).flat_map(of).chain(of_file).collect()
    }

    fn with_expansions(&self, chart: &'w Chart) -> impl Iterator<Item = &'w Chart> + use<'w> {
        let expansions = self.document.charts().filter(|c| c.kind == ChartKind::Expansion);
        std::iter::once(chart).chain(expansions)
    }

    fn action(&mut self, action: &NamedAction, scope: Scope) -> Element {
        let name = self.names.give(&action.name);
        let text = self.body(&action.body, scope);
        let body = Element::new("body").child(Element::formatted("ST", &text));
        let mut element = Element::new("action").with("name", name).child(body);
        if let Some(comment) = &action.comment {
            element.push(Element::formatted("documentation", comment));
        }
        element
    }

    fn section(&mut self, section: &Section, scope: Scope) -> Element {
        let name = self.names.give(&section.name);
        let text = self.block(&section.body, scope);
        let body = Element::new("body").child(Element::formatted("ST", &text));
        Element::new("transition").with("name", name).child(body)
    }

    fn function(&mut self, function: &'w Function) -> Element {
        let scope = Scope { document: self.document, chart: None, function: Some(function) };
        let name = self.names.give(&function.name);
        // Names within a function are nobody else's.
        let mut own = Names::default();
        own.give(&function.name);
        let result = type_of(function.result);
        let mut interface = Element::new("interface").child(result.renamed("returnType"));
        let mut inputs = Element::new("inputVars");
        for param in &function.params {
            inputs
                .push(Element::new("variable").with("name", own.give(&param.name)).child(type_of(param.ty)));
        }
        if !function.params.is_empty() {
            interface.push(inputs);
        }
        let mut locals = Element::new("localVars");
        for local in &function.body.locals {
            for name in &local.names {
                let mut variable =
                    Element::new("variable").with("name", own.give(name)).child(type_of(local.ty));
                if let Some(init) = &local.init {
                    variable.push(initial(&value(init, &mut own, scope, self.problems)));
                }
                locals.push(variable);
            }
        }
        if !function.body.locals.is_empty() {
            interface.push(locals);
        }
        let mut text = Text { names: &mut own, scope, problems: self.problems };
        let text = text.statements(&function.body.statements);
        self.problems.append(&mut own.renamed);
        Element::new("pou")
            .with("name", name)
            .with("pouType", "function")
            .child(interface)
            .child(Element::new("body").child(Element::formatted("ST", &text)))
    }
}

fn final_scan(document: &Document) -> bool {
    let switches = document.profile().map(|p| p.switches.as_slice()).unwrap_or(&[]);
    let set =
        switches.iter().rev().find_map(|(s, _)| if let Switch::FinalScan(on) = s { Some(*on) } else { None });
    set.unwrap_or(document.profile().is_some_and(|p| p.name == ProfileName::Iec61131))
}

fn coordinates() -> Element {
    let scaling = |tag: &str| Element::new(tag).child(Element::new("scaling").with("x", 1).with("y", 1));
    Element::new("coordinateInfo").children(["fbd", "ld", "sfc"].map(scaling))
}
