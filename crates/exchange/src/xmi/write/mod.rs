//! Writes a document as an instance of the meta-model.
//!
//! An element that the meta-model cannot hold is a problem with its place in the document: a
//! warning if the rest means the same, otherwise an error.

mod actions;
mod lookup;
mod terms;

use g7_iec::signs;
use g7_iec::xml::element::Element;
use g7_model::codes::{self, Code};
use g7_model::{
    Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Item, Literal, Place, Problem, ProfileName, Said,
    Step, StepKind, Transition, Type, UnaryOp, VarDecl, VarKind, say,
};

use super::build::NAME_NOTE;
use crate::Written;
use lookup::{Asked, Lookup, Node};

/// The namespaces of the project's own files.
const NAMESPACES: [(&str, &str); 5] = [
    ("xmi:version", "2.0"),
    ("xmlns:xmi", "http://www.omg.org/XMI"),
    ("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"),
    ("xmlns:grafcet", "http://www.example.org/grafcet"),
    ("xmlns:terms", "http://www.example.org/terms"),
];

/// Writes the document.
pub(crate) fn export(document: &Document) -> Written {
    let document = &signs::in_signs(document);
    let mut writer = Writer { look: Lookup::new(document), problems: Vec::new(), ids: 0, sheet: 0 };
    let root = writer.root(document);
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    root.print(0, &mut text);
    let mut problems = writer.problems;
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

struct Writer<'d> {
    look: Lookup<'d>,
    problems: Vec<Problem>,
    /// The last identifier given to a term, sort or action.
    ids: u32,
    /// The chart that is being written.
    sheet: usize,
}

impl<'d> Writer<'d> {
    fn say(&mut self, code: &'static Code, at: Place, what: Said) {
        self.problems.push(Problem::new(code, at.0, what));
    }

    /// Reports an element with a meaning that the meta-model does not have.
    fn cannot(&mut self, at: Place, what: Said) {
        self.say(&codes::NOT_CARRIED, at, say!("{what}: the meta-model has none"));
    }

    /// Reports an element without which the chart means the same.
    fn leave_out(&mut self, at: Place, what: Said) {
        self.say(&codes::LEFT_OUT, at, say!("{what}: the meta-model has none; it is left out"));
    }

    fn id(&mut self) -> String {
        self.ids += 1;
        self.ids.to_string()
    }

    fn root(&mut self, document: &'d Document) -> Element {
        let mut root = Element::new("grafcet:Grafcet");
        for (name, value) in NAMESPACES {
            root.set(name, value);
        }
        for note in &document.notes {
            match note.text.strip_prefix(NAME_NOTE) {
                Some(name) => root.set("name", name.trim()),
                None => self.leave_out(note.at.into(), say!("a note to the reader")),
            }
        }
        for item in &document.items {
            self.item(item);
        }
        let mut container = Element::new("variableDeclarationContainer");
        for var in self.look.file_vars() {
            container.extend(self.variable(var));
        }
        let charts: Vec<&'d Chart> = self.look.charts().to_vec();
        let mut partials = Vec::with_capacity(charts.len());
        for (index, chart) in charts.into_iter().enumerate() {
            self.sheet = index;
            partials.push(self.chart(chart));
        }
        // The steps whose activity is used are known only after all charts have been written.
        for asked in self.look.take_asked() {
            container.push(match asked {
                Asked::Timed(name) => self.declaration(&name, "input", Type::Bool),
                Asked::Step(node) => {
                    let name = format!("X{}", self.look.number(node));
                    let mut declared = self.declaration(&name, "step", Type::Bool);
                    declared.set("step", &self.look.place(node));
                    declared
                }
            });
        }
        root.push(container);
        root.extend(partials);
        root
    }

    /// Writes items other than charts and variables.
    fn item(&mut self, item: &Item) {
        match item {
            Item::Var(_) | Item::Chart(_) => {}
            Item::Profile(p) if p.name == ProfileName::Iec60848 && p.switches.is_empty() => {}
            Item::Profile(p) => {
                let what = say!(
                    "the rules of evolution of `{}` or its switches; the meta-model's are those of IEC 60848",
                    p.name.name()
                );
                self.say(&codes::NOT_CARRIED, p.at, what);
            }
            Item::Cycle(_, at) => self.leave_out(*at, say!("a scan time")),
            Item::Target(_, at) => self.leave_out(*at, say!("a target")),
            // The charts of the instances stand in their place already.
            Item::Instance(_) | Item::Composed(_) | Item::Type(_) => {}
            Item::Use(u) => self.cannot(u.at, say!("a file that is used was not read")),
            Item::Action(a) => self.cannot(a.at, say!("a named action")),
            Item::Section(s) => self.cannot(s.at, say!("a transition section")),
            Item::Function(f) => self.cannot(f.at, say!("a function")),
            Item::Pre(_, at) | Item::Post(_, at) => {
                self.cannot(*at, say!("a processing before or behind the charts"))
            }
            Item::Plant(p) => self.leave_out(p.at, say!("a plant")),
            Item::Test(t) => self.leave_out(t.at, say!("a test")),
            Item::Prove(p) => self.leave_out(p.at, say!("a property")),
            Item::Layout(l) => self.leave_out(l.at, say!("a layout")),
        }
    }

    fn variable(&mut self, var: &VarDecl) -> Vec<Element> {
        let kind = match var.kind {
            VarKind::Input => "input",
            VarKind::Output => "output",
            VarKind::Var => "internal",
            // The value of a constant is written where it is used.
            VarKind::Const => return Vec::new(),
        };
        match var.ty {
            Type::Bool | Type::Dint => {}
            ty if ty.is_integer() => {
                let what = say!("a variable of the type {ty}: an integer of the meta-model is a DINT");
                self.say(&codes::DIFFERENT, var.at, what);
            }
            ty => return self.cannot_declare(var.at, say!("a variable of the type {ty}")),
        }
        if var.init.as_ref().is_some_and(|e| !is_zero(e)) {
            self.cannot(var.at, say!("an initial value"));
        }
        if var.inverted {
            self.cannot(var.at, say!("an inverted channel"));
        }
        if var.safe.as_ref().is_some_and(|e| !is_zero(e)) {
            self.leave_out(var.at, say!("a safe value"));
        }
        for (there, what) in [
            (var.address.is_some(), say!("an address")),
            (var.retain, say!("a value that is kept over a restart")),
            (var.comment.is_some(), say!("a comment")),
        ] {
            if there {
                self.leave_out(var.at, what);
            }
        }
        var.names.iter().map(|n| self.declaration(&n.text, kind, var.ty)).collect()
    }

    fn cannot_declare(&mut self, at: Place, what: Said) -> Vec<Element> {
        self.cannot(at, what);
        Vec::new()
    }

    fn declaration(&mut self, name: &str, kind: &str, ty: Type) -> Element {
        let mut declared = Element::new("variableDeclarations");
        declared.set("name", name);
        if kind != "input" {
            declared.set("variableDeclarationType", kind);
        }
        declared.push(self.sort("sort", ty));
        declared
    }

    /// `<sort xsi:type="terms:Bool" id="7"/>`.
    fn sort(&mut self, tag: &'static str, ty: Type) -> Element {
        let mut sort = Element::new(tag);
        sort.set("xsi:type", if ty == Type::Bool { "terms:Bool" } else { "terms:Integer" });
        sort.set("id", &self.id());
        sort
    }

    fn chart(&mut self, chart: &'d Chart) -> Element {
        let mut partial = Element::new("partialGrafcets");
        let class = match chart.kind {
            ChartKind::Expansion => "grafcet:MacrostepExpansion",
            ChartKind::Chart | ChartKind::Task => "grafcet:PartialGrafcet",
        };
        partial.set("xsi:type", class);
        partial.set("name", &chart.name.text);
        if chart.kind == ChartKind::Task {
            self.cannot(chart.at, say!("a task"));
        }
        if chart.comment.is_some() {
            self.leave_out(chart.at, say!("a comment"));
        }
        if chart.every.is_some() {
            self.cannot(chart.at, say!("a period of a chart"));
        }
        if let Some(place) = self.look.enclosing(&chart.name.text) {
            partial.set("enclosingStep", &place);
        }
        let mut vars = Vec::new();
        let mut web = Web::default();
        let mut transitions = 0;
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => vars.extend(self.variable(v)),
                ChartItem::Step(s) => self.step(s, &mut web),
                ChartItem::Transition(t) => {
                    self.transition(t, transitions, &mut web);
                    transitions += 1;
                }
                ChartItem::Pre(_, at) | ChartItem::Post(_, at) => {
                    self.cannot(*at, say!("a processing before or behind a chart"));
                }
                ChartItem::Action(a) => self.cannot(a.at, say!("a named action")),
                ChartItem::Section(s) => self.cannot(s.at, say!("a transition section")),
            }
        }
        if !vars.is_empty() {
            let mut container = Element::new("variableDeclarationContainer");
            container.extend(vars);
            partial.push(container);
        }
        partial.extend(web.finish());
        partial
    }

    fn step(&mut self, step: &'d Step, web: &mut Web) {
        let Some(node) = self.look.step_node(self.sheet, &step.name.text) else { return };
        let number = self.look.number(node);
        if self.look.renumbered(node) {
            let what = say!(
                "the meta-model numbers its steps: `{}` becomes {}",
                step.name.text,
                Said::foreign(&*number)
            );
            self.say(&codes::RENAMED, step.name.at, what);
        }
        if step.comment.is_some() {
            self.leave_out(step.at, say!("a comment"));
        }
        let (tag, class) = match &step.kind {
            StepKind::Plain => ("steps", Some("grafcet:Step")),
            StepKind::Enclosing => ("steps", Some("grafcet:EnclosingStep")),
            StepKind::Macro(_) => ("macrosteps", None),
            StepKind::Entry => ("entryStep", None),
            StepKind::Exit => ("exitStep", None),
        };
        let mut element = Element::new(tag);
        if let Some(class) = class {
            element.set("xsi:type", class);
        }
        element.set("id", &number);
        if let StepKind::Macro(expansion) = &step.kind
            && let Some(place) = self.look.chart_place(&expansion.text)
        {
            element.set("expansion", &place);
        }
        for (there, name) in [(step.initial, "initial"), (step.linked, "activationLink")] {
            match (there, class) {
                (true, Some(_)) => element.set(name, "true"),
                (true, None) => {
                    self.cannot(step.at, say!("an initial or linked macro-step, entry or exit step"))
                }
                (false, _) => {}
            }
        }
        let enclosed = self.look.enclosed_by(step);
        if !enclosed.is_empty() {
            element.set("partialGrafcets", &enclosed);
        }
        match tag {
            "steps" => web.steps.push(element),
            "macrosteps" => web.macros.push(element),
            _ => web.ends.push(element),
        }
        self.actions(step, node, web);
    }

    fn transition(&mut self, transition: &'d Transition, number: usize, web: &mut Web) {
        let place = format!("//@partialGrafcets.{}/@transitions.{number}", self.sheet);
        let mut element = Element::new("transitions");
        match transition.label.as_ref().map(|l| (l, l.text.strip_prefix('T'))) {
            None => {}
            Some((_, Some(id))) if id.parse::<i32>().is_ok_and(|n| n.to_string() == id) => {
                element.set("id", id)
            }
            Some((label, _)) => {
                let what =
                    say!("the meta-model numbers its transitions: the label `{}` is left out", label.text);
                self.say(&codes::RENAMED, label.at, what);
            }
        }
        if transition.comment.is_some() {
            self.leave_out(transition.at, say!("a comment"));
        }
        if transition.priority.is_some() {
            self.leave_out(transition.at, say!("a priority"));
        }
        if transition.on_clearing.is_some() {
            self.cannot(transition.at, say!("a stored action on clearing"));
        }
        let term = self.timed(&transition.receptivity, &format!("{place}/@term"), &mut element);
        element.extend(term);
        web.transitions.push(element);
        let nodes = |names: &[g7_model::Name]| -> Vec<Node> {
            names.iter().filter_map(|n| self.look.step_node(self.sheet, &n.text)).collect()
        };
        let (from, to) = (nodes(&transition.from), nodes(&transition.to));
        for (steps, before) in [(from, true), (to, false)] {
            let many = steps.len() > 1;
            let sync = format!("//@partialGrafcets.{}/@synchronizations.{}", self.sheet, web.syncs.len());
            let through = if many { &sync } else { &place };
            for node in steps {
                web.arc(before, &self.look.place(node), through);
            }
            if many {
                web.syncs.push(Element::new("synchronizations"));
                web.arc(before, &sync, &place);
            }
        }
    }
}

/// The parts of a chart, each in its own list, because references count positions there.
#[derive(Default)]
struct Web {
    steps: Vec<Element>,
    transitions: Vec<Element>,
    syncs: Vec<Element>,
    macros: Vec<Element>,
    arcs: Vec<Element>,
    actions: Vec<Element>,
    links: Vec<Element>,
    ends: Vec<Element>,
}

impl Web {
    /// An arc towards `inner`, or away from it.
    fn arc(&mut self, towards: bool, outer: &str, inner: &str) {
        let mut arc = Element::new("arcs");
        let (source, target) = if towards { (outer, inner) } else { (inner, outer) };
        arc.set("source", source);
        arc.set("target", target);
        self.arcs.push(arc);
    }

    fn finish(self) -> impl Iterator<Item = Element> {
        let lists = [
            self.steps,
            self.transitions,
            self.syncs,
            self.macros,
            self.arcs,
            self.actions,
            self.links,
            self.ends,
        ];
        lists.into_iter().flatten()
    }
}

/// True if a value is the default of its variable.
fn is_zero(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) => !b,
        ExprKind::Literal(Literal::Int(n, _)) => *n == 0,
        ExprKind::Unary(UnaryOp::Neg, e) => is_zero(e),
        _ => false,
    }
}
