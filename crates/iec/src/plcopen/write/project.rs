//! The whole project: programs, functions, tasks.

use std::collections::HashSet;

use g7_model::{
    Block, Body, Chart, ChartItem, ChartKind, Composed, Document, Function, Item, NamedAction, Nanos,
    Problem, Section, StepKind, Switch, VarDecl,
};

use super::codesys::{by_flags, from_outside, is_given, steps_alone};
use super::control::control;
use super::declare::{data_types, external, in_order, initial, lists, parameters, type_of, type_of_value};
use super::sfc::Sfc;
use crate::Written;
use crate::nodes::Taken;
use crate::plcopen::Dialect;
use crate::st::{Known, Writer};
use crate::standard::{Form, standard};
use crate::xml::element::Element;

/// The nominal scan time where the document has none.
const SCAN: Nanos = Nanos::from_millis(10);
/// The format wants a date of creation. It is fixed, so that the same document gives the same file.
const MADE: &str = "2026-01-01T00:00:00";

/// Writes a document.
pub(crate) fn export(document: &Document, dialect: Dialect) -> Written {
    let (mut document, mut problems, bare) = in_form(document, dialect);
    if dialect.is_of_matiec() {
        document = control(document, &mut problems);
    }
    let outside = if dialect == Dialect::Codesys { from_outside(&document) } else { HashSet::new() };
    let whole = Project { document: &document, problems: &mut problems, dialect, bare, outside };
    let mut project = whole.element();
    if dialect.is_of_matiec() {
        project = project.in_paragraphs();
    }
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
    project.print(0, &mut text);
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

/// The document in the form that a dialect has; true if bodies stand beside their steps without qualifiers.
fn in_form(document: &Document, dialect: Dialect) -> (Document, Vec<Problem>, bool) {
    if dialect != Dialect::Codesys {
        let form = if dialect.is_of_matiec() && has_parts(document) {
            Form::Networks { drawn: true }
        } else {
            Form::Charts
        };
        let (document, problems) = standard(document, form);
        return (document, problems, false);
    }
    let mut document = document.clone();
    let mut of_flags = Vec::new();
    by_flags(&mut document, &mut of_flags);
    let no_final_scan = |p: &g7_model::Profile| {
        let of = p.switches.iter().rev().find_map(|(s, _)| match s {
            Switch::FinalScan(on) => Some(!on),
            _ => None,
        });
        of == Some(true)
    };
    if document.profile().is_some_and(no_final_scan) && steps_alone(&document) {
        let (made, mut problems) = standard(&document, Form::Codesys { bare: true });
        // Steps that drive something more have a block of actions, and then the rule is the standard's.
        if steps_alone(&made) {
            problems.append(&mut of_flags);
            return (made, problems, true);
        }
    }
    let (document, mut problems) = standard(&document, Form::Codesys { bare: false });
    problems.append(&mut of_flags);
    (document, problems, false)
}

/// True if a document has macro-steps, transition sections, or several charts, which evolve together only
/// in one program.
fn has_parts(document: &Document) -> bool {
    let section = |c: &Chart| c.items.iter().any(|i| matches!(i, ChartItem::Section(_)));
    document.charts().count() > 1
        || document.charts().any(section)
        || document.items.iter().any(|i| matches!(i, Item::Section(_)))
}

/// A program and the task that runs it.
struct Program {
    name: String,
    every: Option<Nanos>,
}

struct Project<'w> {
    document: &'w Document,
    problems: &'w mut Vec<Problem>,
    dialect: Dialect,
    /// True if the bodies of steps stand beside them without qualifiers, as CODESYS has them.
    bare: bool,
    /// The variables of each program that others write.
    outside: HashSet<(String, String)>,
}

impl<'w> Project<'w> {
    fn charts(&self) -> impl Iterator<Item = &'w Chart> + use<'w> {
        self.document.charts().filter(|c| c.kind == ChartKind::Chart)
    }

    fn variables(&self) -> impl Iterator<Item = &'w VarDecl> + Clone + use<'w> {
        self.document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None })
    }

    fn element(mut self) -> Element {
        let document = self.document;
        let bodies = document.items.iter().any(|i| matches!(i, Item::Pre(..) | Item::Post(..)));
        let single = self.charts().count() == 1 && !bodies;
        let mut pous = Vec::new();
        let mut programs = Vec::new();
        for item in &document.items {
            if let Item::Function(function) = item {
                pous.push(self.function(function));
            }
        }
        for item in &document.items {
            if let Item::Composed(block) = item
                && block.block
            {
                pous.push(self.function_block(block));
            }
        }
        for item in &document.items {
            if let Item::Pre(body, _) = item {
                self.text("Pre", body, &mut pous, &mut programs);
            }
        }
        for chart in self.charts() {
            let pou = self.chart(chart, single);
            pous.push(pou);
            programs.push(Program { name: chart.name.text.to_string(), every: chart.every });
        }
        for item in &document.items {
            if let Item::Post(body, _) = item {
                self.text("Post", body, &mut pous, &mut programs);
            }
        }
        let title = self.charts().next().map_or_else(|| "Project".to_string(), |c| c.name.text.to_string());
        let mut taken = self.taken(&programs);
        let configuration = Element::new("configuration").with("name", taken.give("Config0"));
        let configuration = configuration.child(self.resource(single, &programs, &mut taken));
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
                    .child(data_types(self.document))
                    .child(Element::new("pous").children(pous)),
            )
            .child(Element::new("instances").child(Element::new("configurations").child(configuration)))
    }

    /// The names that nothing else of the project may have: many tools tell no name of a
    /// configuration from one of a program or a variable.
    fn taken(&self, programs: &[Program]) -> Taken {
        let mut taken = Taken::default();
        let mut take = |name: &g7_model::Name| _ = taken.take(&name.text);
        for item in &self.document.items {
            match item {
                Item::Var(v) => v.names.iter().for_each(&mut take),
                Item::Function(f) => take(&f.name),
                Item::Composed(c) => take(&c.name),
                Item::Type(t) => t.type_names().for_each(&mut take),
                Item::Chart(c) => {
                    c.vars().flat_map(|v| &v.names).for_each(&mut take);
                    c.steps().for_each(|s| take(&s.name));
                }
                _ => {}
            }
        }
        programs.iter().for_each(|p| _ = taken.take(&p.name));
        taken
    }

    fn resource(&mut self, single: bool, programs: &[Program], taken: &mut Taken) -> Element {
        let scan = self.document.cycle().unwrap_or(SCAN);
        let mut intervals: Vec<Nanos> = programs.iter().map(|p| p.every.unwrap_or(scan)).collect();
        intervals.push(scan);
        intervals.sort_unstable();
        intervals.dedup();
        let mut resource = Element::new("resource").with("name", taken.give("Res0"));
        for (priority, interval) in intervals.iter().enumerate() {
            let mut task = Element::new("task").with("name", taken.give(&format!("Task{}", priority + 1)));
            // CODESYS runs a task without an interval as well; beside charts with a period it needs one.
            let paced = programs.iter().any(|p| p.every.is_some()) || self.document.cycle().is_some();
            if self.dialect != Dialect::Codesys || paced {
                task = task.with("interval", format!("{interval:#}"));
            }
            task = task.with("priority", priority);
            for program in programs.iter().filter(|p| p.every.unwrap_or(scan) == *interval) {
                // An instance is not called like its program, which compilers would take for the type.
                let instance = Element::new("pouInstance")
                    .with("name", taken.give(&format!("{}_run", program.name)))
                    .with("typeName", &program.name);
                task.push(instance);
            }
            resource.push(task);
        }
        if !single {
            resource = resource.children(lists(&self.variables().collect::<Vec<_>>(), true));
        }
        resource
    }

    /// Writes a body before or behind the charts as a program of its own.
    fn text(&self, title: &str, body: &Body, pous: &mut Vec<Element>, programs: &mut Vec<Program>) {
        let taken = |name: &str| {
            let named = |n: &g7_model::Name| n.text.eq_ignore_ascii_case(name);
            self.document.items.iter().any(|i| match i {
                Item::Var(v) => v.names.iter().any(named),
                Item::Function(f) => named(&f.name),
                Item::Composed(c) => named(&c.name),
                Item::Chart(c) => named(&c.name),
                Item::Type(t) => t.type_names().any(named),
                _ => false,
            })
        };
        let mut name = title.to_string();
        while taken(&name) {
            name.push('_');
        }
        let types = Known::new(self.document, None);
        let text = Writer { types: &types }.body(&body.block().statements);
        let interface = Element::new("interface").children(external(self.variables()));
        pous.push(
            Element::new("pou")
                .with("name", &name)
                .with("pouType", "program")
                .child(interface)
                .child(Element::new("body").child(Element::formatted("ST", &text))),
        );
        programs.push(Program { name, every: None });
    }

    /// A chart as a program.
    fn chart(&mut self, chart: &'w Chart, single: bool) -> Element {
        let document = self.document;
        let types = Known::new(document, Some(chart));
        let writer = || Writer { types: &types };
        let mut interface = Element::new("interface");
        let of_chart = if self.dialect == Dialect::Codesys && !single {
            in_order(chart.vars(), |v| is_given(v, &chart.name.text, &self.outside))
        } else {
            lists(&chart.vars().collect::<Vec<_>>(), false)
        };
        if single {
            let of_file = lists(&self.variables().collect::<Vec<_>>(), false);
            interface = interface.children(of_file).children(of_chart);
        } else {
            interface = interface.children(of_chart).children(external(self.variables()));
        }
        if self.dialect.is_of_matiec() && chart.vars().chain(self.variables()).next().is_none() {
            let mut taken = Taken::default();
            chart.steps().for_each(|s| _ = taken.take(&s.name.text));
            taken.take(&chart.name.text);
            let unused = Element::new("variable").with("name", taken.give("Unused"));
            interface.push(Element::new("localVars").child(unused.child(type_of(g7_model::Type::Bool))));
        }
        if self.dialect.is_of_matiec() {
            self.problems.extend(crate::standard::without_steps(chart));
        }
        let mut pou =
            Element::new("pou").with("name", &chart.name.text).with("pouType", "program").child(interface);
        let actions: Vec<Element> = self.actions_of(chart).iter().map(|a| action(a, &writer())).collect();
        if !actions.is_empty() {
            pou.push(Element::new("actions").children(actions));
        }
        let sections: Vec<Element> = self.sections_of(chart).iter().map(|s| section(s, &writer())).collect();
        if !sections.is_empty() {
            pou.push(Element::new("transitions").children(sections));
        }
        let mut sfc = Sfc {
            document,
            chart,
            writer: writer(),
            problems: self.problems,
            dialect: self.dialect,
            bare: self.bare,
            next: 0,
        };
        let body = sfc.body(chart, 0);
        pou.push(Element::new("body").child(body));
        if let Some(comment) = &chart.comment {
            pou.push(Element::formatted("documentation", comment));
        }
        pou
    }

    /// A chart with the expansions in it, at all levels.
    fn with_expansions(&self, chart: &'w Chart) -> Vec<&'w Chart> {
        let mut all = vec![chart];
        let mut next = 0;
        while let Some(one) = all.get(next).copied() {
            next += 1;
            for step in one.steps() {
                let StepKind::Macro(name) = &step.kind else { continue };
                let inner = self.document.charts().find(|c| c.name.text == name.text);
                if let Some(inner) = inner.filter(|i| !all.iter().any(|a| std::ptr::eq(*a, *i))) {
                    all.push(inner);
                }
            }
        }
        all
    }

    fn actions_of(&self, chart: &'w Chart) -> Vec<&'w NamedAction> {
        let of = |c: &'w Chart| {
            c.items.iter().filter_map(|i| if let ChartItem::Action(a) = i { Some(a) } else { None })
        };
        self.with_expansions(chart).into_iter().flat_map(of).collect()
    }

    fn sections_of(&self, chart: &'w Chart) -> Vec<&'w Section> {
        let of = |c: &'w Chart| {
            c.items.iter().filter_map(|i| if let ChartItem::Section(s) = i { Some(s) } else { None })
        };
        self.with_expansions(chart).into_iter().flat_map(of).collect()
    }

    fn function_block(&self, block: &'w Composed) -> Element {
        let types = Known::of_block(self.document, block);
        let statements = block.body.as_ref().map_or(&[][..], |b| &b.block().statements);
        let text = Writer { types: &types }.body(statements);
        let mut pou = Element::new("pou")
            .with("name", &block.name.text)
            .with("pouType", "functionBlock")
            .child(Element::new("interface").children(parameters(block)))
            .child(Element::new("body").child(Element::formatted("ST", &text)));
        if let Some(comment) = &block.comment {
            pou.push(Element::formatted("documentation", comment));
        }
        pou
    }

    fn function(&self, function: &'w Function) -> Element {
        let mut types = Known::new(self.document, None).own(&function.name.text, function.result.base);
        let result = type_of_value(&function.result);
        let mut interface = Element::new("interface").child(result.renamed("returnType"));
        let mut inputs = Element::new("inputVars");
        for param in &function.params {
            types = types.own(&param.name.text, param.ty.base);
            inputs.push(
                Element::new("variable").with("name", &param.name.text).child(type_of_value(&param.ty)),
            );
        }
        if !function.params.is_empty() {
            interface.push(inputs);
        }
        let mut locals = Element::new("localVars");
        for local in &function.body.locals {
            for name in &local.names {
                types = types.own(&name.text, local.ty.base);
                let mut variable =
                    Element::new("variable").with("name", &name.text).child(type_of_value(&local.ty));
                if let Some(init) = &local.init {
                    variable.push(initial(init, local.ty.base));
                }
                locals.push(variable);
            }
        }
        if !function.body.locals.is_empty() {
            interface.push(locals);
        }
        let text = Writer { types: &types }.body(&function.body.statements);
        Element::new("pou")
            .with("name", &function.name.text)
            .with("pouType", "function")
            .child(interface)
            .child(Element::new("body").child(Element::formatted("ST", &text)))
    }
}

fn action(action: &NamedAction, writer: &Writer) -> Element {
    let text = block(action.body.block(), writer);
    let body = Element::new("body").child(Element::formatted("ST", &text));
    let mut element = Element::new("action").with("name", &action.name.text).child(body);
    if let Some(comment) = &action.comment {
        element.push(Element::formatted("documentation", comment));
    }
    element
}

fn section(section: &Section, writer: &Writer) -> Element {
    let text = block(&section.body, writer);
    let body = Element::new("body").child(Element::formatted("ST", &text));
    Element::new("transition").with("name", &section.name.text).child(body)
}

fn block(block: &Block, writer: &Writer) -> String {
    writer.body(&block.statements)
}

fn coordinates() -> Element {
    let scaling = |tag: &str| Element::new(tag).child(Element::new("scaling").with("x", 1).with("y", 1));
    Element::new("coordinateInfo").children(["fbd", "ld", "sfc"].map(scaling))
}
