//! Builds the document from the routines of a project.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::{
    Chart, ChartItem, Document, Item, Layout, Nanos, Path, Profile, ProfileName, Said, Span, Stmt, Switch,
    Type, VarDecl, VarKind, codes, say,
};

use super::chart::{self, Lines, Read, Xml, kid, kids};
use super::dialect::{Presets, Words};
use super::tags::{self, Tags};
use crate::undeclared;
use g7_iec::nodes::{self, Taken};
use g7_iec::report::Report;
use g7_iec::st;
use g7_iec::xml::attr;
use g7_model::visit_mut::{self, Use, Visitor};

/// The document of a file.
pub(super) fn document(root: Xml, report: &mut Report) -> Document {
    let controller = if root.has_tag_name("Controller") { Some(root) } else { kid(root, "Controller") };
    let charts: Vec<Xml> = root.descendants().filter(|n| n.has_tag_name("SFCContent")).collect();
    if charts.is_empty() {
        let what = say!("there is no routine in SFC in the file");
        report.say(&codes::NOT_JGRAFCHART, &attr::head(root), what);
        return Document::default();
    }
    let at = report.span(&attr::head(root));
    let switches = switches(controller, report).into_iter().map(|s| (s, at.into())).collect();
    let mut document = Document::default();
    document.items.push(Item::Profile(Profile { name: ProfileName::Iec61131, switches, at: at.into() }));
    document.items.extend(cycle(root, &charts, report));
    let mut taken = Taken::default();
    let mut parts = Parts::default();
    let mut scope: Option<Scope> = None;
    for content in charts {
        let title = title(content, &mut taken);
        let program = content.ancestors().find(|n| n.has_tag_name("Program"));
        let same = scope.take_if(|s| s.program == program);
        let mut here = same.unwrap_or_else(|| Scope::of(program, controller, report));
        if let Some(before) = scope.take() {
            before.idle(report);
        }
        parts.add(content, &title, &mut here, report);
        scope = Some(here);
    }
    if let Some(last) = scope {
        last.idle(report);
    }
    document.items.extend(parts.vars.into_iter().map(Item::Var));
    document.items.extend(parts.charts.into_iter().map(Item::Chart));
    document.items.extend(parts.layouts.into_iter().map(Item::Layout));
    st::settle(&mut document);
    undeclared::declare(&mut document, report);
    st::settle(&mut document);
    undeclared::open(&mut document, report);
    document.notes = report.take_notes();
    document
}

/// The surroundings of the charts of one program.
struct Scope<'a> {
    program: Option<Xml<'a>>,
    tags: Tags<'a>,
    presets: Presets,
    routines: HashMap<String, Vec<Stmt>>,
    /// The text routines that a chart has called, in upper case.
    called: HashSet<String>,
}

impl<'a> Scope<'a> {
    fn of(program: Option<Xml<'a>>, controller: Option<Xml<'a>>, report: &mut Report) -> Scope<'a> {
        let tags = Tags::of(program, controller);
        let mut presets = Presets::default();
        tags::presets(&tags, &mut presets);
        let routines = routines(program, report);
        Scope { program, tags, presets, routines, called: HashSet::new() }
    }

    /// Reports text routines that no chart calls; they are left out.
    fn idle(&self, report: &mut Report) {
        let routines = self.program.and_then(|n| kid(n, "Routines"));
        for routine in routines.into_iter().flat_map(|n| kids(n, "Routine")) {
            let name = routine.attribute("Name").unwrap_or("");
            if routine.attribute("Type") == Some("ST") && !self.called.contains(&name.to_uppercase()) {
                let what = say!("the routine `{}` (ST) is left out, with what it writes", nodes::line(name));
                report.element(&codes::LEFT_OUT, "routine ST", &attr::head(routine), what);
            }
        }
    }
}

/// The parts of the document.
#[derive(Default)]
struct Parts {
    vars: Vec<VarDecl>,
    /// The places of the variables of the file, by name in upper case.
    declared: HashMap<String, Span>,
    charts: Vec<Chart>,
    layouts: Vec<Layout>,
}

impl Parts {
    /// Adds a chart and the tags that it names.
    fn add(&mut self, content: Xml, title: &str, scope: &mut Scope, report: &mut Report) {
        let Read { chart, layout, flags } = chart::read(content, title, &mut scope.presets, report);
        let flags = flags.into_iter().map(|n| nodes::variable(VarKind::Output, &n.text, Type::Bool, n.at.0));
        let mut part = Document { items: vec![Item::Chart(chart)], notes: Vec::new() };
        let mut words = Words::new(&scope.presets, &scope.routines, report);
        visit_mut::document(&mut part, &mut words);
        let called = words.called;
        scope.called.extend(called);
        let vars = used(&mut part, &scope.tags, flags.collect(), report);
        // A tag becomes a variable of the file, or of the chart if another program has a different
        // tag with this name.
        let mut own = Vec::new();
        for var in vars {
            let key = var.names.first().map_or_else(String::new, |n| n.text.to_uppercase());
            match self.declared.get(&key) {
                Some(other) if *other == var.at.0 => {}
                Some(_) => own.push(ChartItem::Var(var)),
                None => {
                    self.declared.insert(key, var.at.0);
                    self.vars.push(var);
                }
            }
        }
        for item in part.items {
            if let Item::Chart(mut chart) = item {
                chart.items.splice(0..0, std::mem::take(&mut own));
                self.charts.push(chart);
            }
        }
        self.layouts.push(layout);
    }
}

/// The rules by which the controller runs its charts.
fn switches(controller: Option<Xml>, report: &mut Report) -> Vec<Switch> {
    let mut switches = Vec::new();
    let set = |name: &str| controller.and_then(|n| n.attribute_node(name));
    if set("SFCExecutionControl").is_some_and(|a| a.value() == "UntilFalse") {
        switches.push(Switch::Stable(true));
    }
    match set("SFCLastScan") {
        Some(a) if a.value() == "Programmatic" => {}
        Some(a) if a.value() == "AutoReset" => {
            switches.push(Switch::FinalScan(false));
            let what = say!(
                "the last scan of a step resets what its actions set (automatic reset); there is none here"
            );
            report.say(&codes::DIFFERENT, &a.range_value(), what);
        }
        _ => switches.push(Switch::FinalScan(false)),
    }
    switches
}

/// The period of the task that runs the program of the first chart.
fn cycle(root: Xml, charts: &[Xml], report: &Report) -> Option<Item> {
    let program = charts.first()?.ancestors().find(|n| n.has_tag_name("Program"))?.attribute("Name")?;
    let task = root.descendants().filter(|n| n.has_tag_name("Task")).find(|t| {
        t.descendants().any(|n| n.has_tag_name("ScheduledProgram") && n.attribute("Name") == Some(program))
    })?;
    let rate: f64 = task.attribute("Rate")?.trim().parse().ok()?;
    if task.attribute("Type") != Some("PERIODIC") || !(0.1..=3_600_000.0).contains(&rate) {
        return None;
    }
    let ns: i64 = format!("{:.0}", rate * 1e6).parse().ok()?;
    Some(Item::Cycle(Nanos::new(ns), report.span(&attr::head(task)).into()))
}

fn title(content: Xml, taken: &mut Taken) -> String {
    let name = |tag: &str| {
        let node = content.ancestors().find(|n| n.has_tag_name(tag))?;
        node.attribute("Name").map(|n| nodes::line(&n.replace('`', "'")))
    };
    let own = name("Routine").filter(|n| !n.is_empty()).unwrap_or_else(|| "SFC".to_string());
    let program = name("Program").unwrap_or_default();
    if taken.has(&own) { taken.give(&format!("{program}_{own}")) } else { taken.give(&own) }
}

/// The text routines of a chart's program; those in other languages are left out.
fn routines(program: Option<Xml>, report: &mut Report) -> HashMap<String, Vec<Stmt>> {
    let mut found = HashMap::new();
    for routine in program.and_then(|n| kid(n, "Routines")).into_iter().flat_map(|n| kids(n, "Routine")) {
        let name = routine.attribute("Name").unwrap_or("");
        match routine.attribute("Type") {
            Some("SFC") => {}
            Some("ST") => {
                // Their problems are reported where they are called.
                let mut silent = Report::new(report.span(&(0..0)).file);
                found.insert(name.to_uppercase(), Lines::of(Some(routine)).statements(&mut silent));
            }
            ty => {
                let ty = Said::foreign(ty.unwrap_or("?"));
                let what =
                    say!("the routine `{}` ({ty}) is left out, with what it writes", nodes::line(name));
                report.element(&codes::LEFT_OUT, &format!("routine {ty}"), &attr::head(routine), what);
            }
        }
    }
    found
}

/// Declarations of the tags that a chart names; aliases are replaced by their targets.
fn used(part: &mut Document, tags: &Tags, flags: Vec<VarDecl>, report: &mut Report) -> Vec<VarDecl> {
    struct Aliases<'a, 'b>(&'a Tags<'b>);
    impl Visitor for Aliases<'_, '_> {
        fn path(&mut self, path: &mut Path, _: Use, at: Span) {
            let Some((first, rest)) = path.names.split_first() else { return };
            let Some(names) = self.0.alias(&first.text) else { return };
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let mut whole = nodes::path(&names, at);
            whole.names.extend(rest.iter().cloned());
            *path = whole;
        }
    }
    #[derive(Default)]
    struct Found(BTreeMap<String, Vec<String>>);
    impl Visitor for Found {
        fn path(&mut self, path: &mut Path, _: Use, _: Span) {
            let names: Vec<String> = path.names.iter().map(|n| n.text.to_string()).collect();
            self.0.entry(names.join(".").to_uppercase()).or_insert(names);
        }
    }
    visit_mut::document(part, &mut Aliases(tags));
    let mut found = Found::default();
    visit_mut::document(part, &mut found);
    let steps: HashSet<String> =
        part.charts().flat_map(|c| c.steps()).map(|s| s.name.text.to_uppercase()).collect();
    let actions: HashSet<String> = part
        .charts()
        .flat_map(|c| &c.items)
        .filter_map(|i| if let ChartItem::Action(a) = i { Some(a.name.text.to_uppercase()) } else { None })
        .collect();
    let own: HashSet<String> = flags.iter().flat_map(|v| &v.names).map(|n| n.text.to_uppercase()).collect();
    let mut vars = flags;
    for (key, names) in &found.0 {
        let first = names.first().map_or("", String::as_str).to_uppercase();
        if own.contains(key) || steps.contains(&first) || (actions.contains(&first) && names.len() == 1) {
            continue;
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        vars.extend(tags.declare(&names, report));
    }
    vars
}
