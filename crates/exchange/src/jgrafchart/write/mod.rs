//! Writes a document as a file of JGrafchart.
//!
//! The first chart becomes the workspace of the file, every other chart a workspace object in it;
//! macro-steps contain their expansions. An element that JGrafchart does not have is a problem with
//! its place in the document: a warning if the rest means the same, otherwise an error.

mod actions;
mod chart;
mod declare;
mod guards;
mod lookup;
mod symbols;
mod text;

use std::collections::HashMap;

use g7_model::codes::{self, Code};
use g7_model::{
    Body, ChartItem, ChartKind, Document, ExprKind, Item, Nanos, Place, Problem, ProfileName, Said, Stmt,
    StmtKind, VarKind, say,
};

use crate::Written;
use g7_iec::signs;
use g7_iec::xml::element::Element;
use guards::Guards;
use lookup::{Look, Meaning, Thing, VarId};
use text::Speech;

/// The nominal scan time of a document without one, as everywhere in G7.
const SCAN: Nanos = Nanos::from_millis(10);
/// The attributes of a new workspace.
const WORKSPACE: [(&str, &str); 14] = [
    ("color", "-1"),
    ("dimTicks", "25"),
    ("dpwsInterface", ""),
    ("dpwsPort", "-1"),
    ("horizontalScrollBar", "1"),
    ("modifiable", "1"),
    ("saveVersion", "8"),
    ("simulationMode", "1"),
    ("socketHost", ""),
    ("socketIsServer", "0"),
    ("socketPort", "-1"),
    ("socketSendMode", "Changed"),
    ("tokenLuminance", "0"),
    ("verticalScrollBar", "1"),
];

/// Writes the document.
pub(crate) fn export(document: &Document) -> Written {
    let document = &signs::in_signs(document);
    let mut look = Look::new(document);
    let guards = Guards::find(&mut look);
    let mut writer = Writer::new(document, look, guards);
    let mut root = writer.root();
    // The names that texts cannot hold are known only after all texts have been written.
    if !writer.look.unspeakable.is_empty() {
        writer.look.rename();
        writer = Writer::new(document, writer.look, writer.guards);
        root = writer.root();
        writer.tell_renamed();
    }
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n");
    root.print(0, &mut text);
    let mut problems = writer.problems;
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

struct Writer<'d> {
    document: &'d Document,
    look: Look<'d>,
    guards: Guards,
    problems: Vec<Problem>,
    /// The number of identifiers given so far.
    ids: u64,
    /// Variables that follow an expression, with its text.
    follows: HashMap<VarId, String>,
    /// The scan time.
    scan: Nanos,
    /// Charts in the order in which they are written.
    order: Vec<usize>,
    /// The places of the steps of the charts written so far.
    spots: HashMap<usize, Vec<symbols::Spot>>,
}

impl<'d> Writer<'d> {
    fn new(document: &'d Document, look: Look<'d>, guards: Guards) -> Writer<'d> {
        let scan = document.cycle();
        Writer {
            document,
            look,
            guards,
            problems: Vec::new(),
            ids: 0,
            follows: HashMap::new(),
            scan: scan.unwrap_or(SCAN),
            order: Vec::new(),
            spots: HashMap::new(),
        }
    }

    fn say(&mut self, code: &'static Code, at: Place, what: Said) {
        self.problems.push(Problem::new(code, at.0, what));
    }

    /// Reports an element with a meaning that JGrafchart does not have.
    fn cannot(&mut self, at: Place, what: Said) {
        self.say(&codes::NOT_CARRIED, at, say!("{what}: JGrafchart has none"));
    }

    /// Reports an element without which the chart means the same.
    fn leave_out(&mut self, at: Place, what: Said) {
        self.say(&codes::LEFT_OUT, at, say!("{what}: JGrafchart has none; it is left out"));
    }

    /// A new identifier, in the style of newer files.
    fn id(&mut self) -> String {
        self.ids += 1;
        format!("00000000-0000-4000-8000-{:012x}", self.ids)
    }

    fn root(&mut self) -> Element {
        let document = self.document;
        for note in &document.notes {
            self.leave_out(note.at.into(), say!("a note to the reader"));
        }
        document.items.iter().for_each(|i| self.item(i));
        self.processing();
        let top = self.look.top;
        let mut root = Element::new("GCDocument");
        for (name, value) in WORKSPACE {
            root = root.with(name, value);
        }
        let name = self.look.charts.get(top).map_or("", |c| &*c.name.text);
        root = root
            .with("name", name)
            .with("threadSpeed", (self.scan.count() / Nanos::MILLISECOND.count()).max(1));
        let root = window(root);
        let content = self.workspace(top);
        let mut objects = Vec::new();
        for index in 0..self.look.charts.len() {
            let Some(chart) = self.look.charts.get(index).copied() else { break };
            let alone = index != top && self.look.owner.get(index) == Some(&None);
            match chart.kind {
                ChartKind::Chart if alone => objects.push(self.object(index)),
                ChartKind::Task => self.cannot(chart.at, say!("a task")),
                ChartKind::Expansion if alone => {
                    self.leave_out(chart.at, say!("an expansion without a macro-step"));
                }
                _ => {}
            }
        }
        self.in_order();
        let (parts, links): (Vec<Element>, Vec<Element>) = content;
        root.children(parts).children(objects).children(links)
    }

    /// Writes items other than charts and variables.
    fn item(&mut self, item: &Item) {
        match item {
            Item::Var(_)
            | Item::Chart(_)
            | Item::Instance(_)
            | Item::Composed(_)
            | Item::Type(_)
            | Item::Layout(_)
            | Item::Pre(..) => {}
            Item::Profile(p) if p.name == ProfileName::Jgrafchart && p.switches.is_empty() => {}
            Item::Profile(p) => {
                let what = say!(
                    "the rules of evolution of `{}` or its switches; JGrafchart has its own",
                    p.name.name()
                );
                self.say(&codes::NOT_CARRIED, p.at, what);
            }
            Item::Cycle(time, at) if time.whole(Nanos::MILLISECOND).is_none_or(|ms| ms < 1) => {
                self.cannot(*at, say!("a scan time that is no whole number of milliseconds"));
            }
            Item::Cycle(..) => {}
            Item::Target(_, at) => self.leave_out(*at, say!("a target")),
            Item::Use(u) => self.cannot(u.at, say!("a file that is used was not read")),
            Item::Action(a) => self.cannot(a.at, say!("a named action")),
            Item::Section(s) => self.cannot(s.at, say!("a transition section")),
            Item::Function(f) => self.cannot(f.at, say!("a function")),
            Item::Post(_, at) => self.cannot(*at, say!("processing behind the evolution")),
            Item::Plant(p) => self.leave_out(p.at, say!("a plant")),
            Item::Test(t) => self.leave_out(t.at, say!("a test")),
            Item::Prove(p) => self.leave_out(p.at, say!("a property")),
        }
    }

    /// Processing before the evolution: a variable may follow an expression there.
    fn processing(&mut self) {
        let document = self.document;
        let top = self.look.top;
        if !document.items.iter().any(|i| matches!(i, Item::Profile(_))) {
            let what = say!("the rules of evolution of `iec60848`; JGrafchart has its own");
            self.say(&codes::NOT_CARRIED, Place::default(), what);
        }
        for item in &document.items {
            if let Item::Pre(body, at) = item {
                self.before(top, body, *at);
            }
        }
        for (index, chart) in self.look.charts.clone().into_iter().enumerate() {
            for item in &chart.items {
                if let ChartItem::Pre(body, at) = item {
                    self.before(index, body, *at);
                }
            }
        }
    }

    fn before(&mut self, chart: usize, body: &Body, at: Place) {
        let Body::St(block) = body else {
            return self.cannot(at, say!("processing before the evolution in another language"));
        };
        if !block.locals.is_empty() {
            self.cannot(at, say!("variables of a body"));
        }
        for statement in &block.statements {
            if !self.follow(chart, statement) {
                let what = say!("processing before the evolution other than one assignment to a variable");
                self.cannot(statement.at, what);
            }
        }
    }

    fn follow(&mut self, chart: usize, statement: &Stmt) -> bool {
        let StmtKind::Assign { target, value } = &statement.kind else { return false };
        let ExprKind::Path(path) = &target.kind else { return false };
        let Some(Meaning::Var(var)) = self.look.path(chart, path) else { return false };
        if self.guards.is_flag(var) {
            return true;
        }
        let Some(decl) = self.look.decl(var).filter(|d| d.kind == VarKind::Var) else { return false };
        let home = var.chart.unwrap_or(self.look.top);
        if self.follows.contains_key(&var) {
            return false;
        }
        match (Speech { look: &mut self.look, chart, home }).value(value, decl.ty) {
            Ok(text) => {
                self.follows.insert(var, text);
            }
            Err((at, what)) => self.cannot(at, what),
        }
        true
    }

    /// Transitions are evaluated in the order of the file, so charts are sorted.
    fn in_order(&mut self) {
        let mut last = None;
        for index in std::mem::take(&mut self.order) {
            if last.is_some_and(|l| l > index)
                && let Some(chart) = self.look.charts.get(index)
            {
                let what = say!(
                    "`{}` comes behind charts that stand before it; transitions fire in the order of the file",
                    chart.name.text
                );
                return self.say(&codes::DIFFERENT, chart.name.at, what);
            }
            last = Some(index);
        }
    }

    /// Reports the names that had to be changed.
    fn tell_renamed(&mut self) {
        let renamed: Vec<(Thing, String)> =
            self.look.renamed.iter().map(|(thing, name)| (*thing, name.clone())).collect();
        for (thing, new) in renamed {
            let old = match thing {
                Thing::Var(var) => self.look.decl(var).and_then(|d| d.names.get(var.name)).cloned(),
                Thing::Step((chart, step)) => self.look.step_at((chart, step)).map(|s| s.name.clone()),
            };
            if let Some(old) = old {
                let what =
                    say!("texts of JGrafchart cannot hold the name `{}`; it becomes `{new}`", old.text);
                self.say(&codes::RENAMED, old.at, what);
            }
        }
    }
}

/// The place and size of a workspace's window.
fn window(element: Element) -> Element {
    let numbers =
        [("viewPositionX", 0), ("viewPositionY", 0), ("width", 900), ("height", 700), ("x", 0), ("y", 0)];
    numbers.into_iter().fold(element.with("scale", "1.0"), |e, (name, value)| e.with(name, value))
}
