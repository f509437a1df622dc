//! A model of the process becomes a program of its own, run by the same engine.
//!
//! # Where this sits
//!
//! ```text
//! model::Plant -> here: a document without charts -> compile -> Program
//! ```
//!
//! The document made here has the charts' outputs as inputs, the driven inputs
//! as outputs, the states as variables, and one PRE that makes a tick: arrivals,
//! then rates, then the rest in the order of the text, then the drives. Host
//! runs it before each scan of the charts.
//!
//! Every node must carry the place of the author's text that it
//! comes from, so that problems found later point there.

mod build;
mod parts;
mod program;
mod rewrite;

pub use program::{Binding, Link, PlantProgram, compile_plant};

use std::collections::HashMap;

use g7_model::{
    BinaryOp, Block, Body, Document, Expr, Item, Limits, Name, Place, Plant, PlantItem, Problem, Said, Stmt,
    Type, VarDecl, VarKind, codes, say,
};

use crate::held::Held;
use crate::ir::{Unit, Var, VarClass};
use build::At;
use parts::Table;
use rewrite::Rewrite;

/// Most parts that one queue or track holds.
const MOST_PARTS: u32 = 48;

/// A plant as a document of its own.
struct PlantDocument {
    /// To be compiled.
    document: Document,
    /// Outputs of the charts that the plant reads, by qualified name.
    reads: Vec<Box<str>>,
    /// Inputs of the charts that it drives, by qualified name.
    drives: Vec<Box<str>>,
    /// Expressions of its picture: element, attribute, value.
    bindings: Vec<(Box<str>, Box<str>, Expr)>,
    /// Its picture, as written.
    view: Option<Box<str>>,
    /// The questions, in the names of this document.
    queries: Vec<Expr>,
}

/// Makes the document of a plant; `unit` is that of the charts it answers.
fn document(doc: &Document, plant: &Plant, unit: &Unit, queries: &[Expr]) -> (PlantDocument, Vec<Problem>) {
    let mut maker = Maker {
        rewrite: Rewrite {
            charts: unit.charts.iter().map(|c| &*c.name).collect(),
            outputs: unit.vars.iter().filter(|v| v.class == VarClass::Output).map(|v| &*v.name).collect(),
            ..Rewrite::default()
        },
        vars: Vec::new(),
        own: HashMap::new(),
        arrivals: Vec::new(),
        rates: Vec::new(),
        rest: Vec::new(),
        drives: Vec::new(),
        driven: HashMap::new(),
        hidden: 0,
        unit,
    };
    for item in &plant.items {
        maker.declare(item);
    }
    let queries = queries.iter().map(|e| maker.rewrite.expr(e)).collect();
    let made = PlantDocument { queries, ..maker.make(doc, plant) };
    (made, maker.rewrite.problems)
}

struct Maker<'d> {
    rewrite: Rewrite<'d>,
    vars: Vec<VarDecl>,
    /// Names that the plant declares itself, and where.
    own: HashMap<&'d str, Place>,
    arrivals: Vec<Stmt>,
    rates: Vec<Stmt>,
    rest: Vec<Stmt>,
    drives: Vec<Stmt>,
    driven: HashMap<String, Place>,
    hidden: u32,
    unit: &'d Unit,
}

/// The first tick is over.
const STARTED: &str = "@started";
/// Seconds since the tick before, for REAL and for LREAL.
const STEP_REAL: &str = "@step";
const STEP_LREAL: &str = "@stepl";

impl<'d> Maker<'d> {
    fn make(&mut self, doc: &'d Document, plant: &'d Plant) -> PlantDocument {
        let at = At(plant.name.at);
        let mut limits = Vec::new();
        let mut bindings = Vec::new();
        let mut view = None;
        for item in &plant.items {
            match item {
                PlantItem::Const { .. } | PlantItem::Parts(_) => {}
                PlantItem::State(s) => limits.append(&mut self.limits(s)),
                PlantItem::Rate(r) => self.rate(plant, r),
                PlantItem::Drive(d) => self.drive(d),
                PlantItem::On(e, block, place) => self.on(e, block, *place),
                PlantItem::Each(block, _) => {
                    let mut body = self.rewrite.block(block);
                    self.rest.append(&mut body);
                }
                PlantItem::Arrivals(a) => self.arrival(a),
                PlantItem::View(v) => {
                    view = Some(v.file.clone());
                    for b in &v.bindings {
                        let value = self.rewrite.expr(&b.value);
                        bindings.push((b.element.text.clone(), b.attribute.text.clone(), value));
                    }
                }
            }
        }
        let reads = self.chart_outputs(at);
        let mut tick = vec![
            at.assign(STEP_LREAL, at.call(rewrite::DT, Vec::new())),
            at.assign(STEP_REAL, at.call("LREAL_TO_REAL", vec![at.var(STEP_LREAL)])),
        ];
        tick.append(&mut self.arrivals);
        tick.append(&mut self.rates);
        tick.extend(limits.iter().cloned());
        tick.append(&mut self.rest);
        tick.append(&mut limits);
        tick.append(&mut self.drives);
        tick.push(at.assign(STARTED, at.bool(true)));
        let mut document = Document { items: self.shared(doc), ..Document::default() };
        for (name, ty) in [(STARTED, Type::Bool), (STEP_REAL, Type::Real), (STEP_LREAL, Type::Lreal)] {
            document.items.push(Item::Var(at.declare(VarKind::Var, name, ty, None)));
        }
        self.vars.append(&mut self.rewrite.hidden);
        document.items.extend(self.vars.drain(..).map(Item::Var));
        let block = Block { locals: Vec::new(), statements: tick, at: plant.at };
        document.items.push(Item::Pre(Body::St(block), plant.at));
        PlantDocument {
            document,
            reads,
            drives: plant
                .items
                .iter()
                .filter_map(|i| match i {
                    PlantItem::Drive(d) => d.input.kind.variable().map(String::into_boxed_str),
                    _ => None,
                })
                .collect(),
            bindings,
            view,
            queries: Vec::new(),
        }
    }

    /// The parts of the file that its plants can use: constants that no name of the plant hides,
    /// and functions that it calls. Other functions may read variables of the charts, which a plant
    /// does not see.
    fn shared(&self, doc: &Document) -> Vec<Item> {
        let mut bodies: HashMap<&str, Vec<&Block>> = HashMap::new();
        for item in &doc.items {
            if let Item::Function(f) = item {
                bodies.entry(&f.name.text).or_default().push(&f.body);
            }
        }
        let mut called = self.rewrite.called.clone();
        let mut open: Vec<Box<str>> = called.iter().cloned().collect();
        while let Some(name) = open.pop() {
            let mut inside = Rewrite::default();
            for body in bodies.remove(&*name).unwrap_or_default() {
                let _ = inside.block(body);
            }
            open.extend(inside.called.iter().cloned());
            called.extend(inside.called);
        }
        let shared = |item: &Item| match item {
            Item::Type(_) => Some(item.clone()),
            Item::Function(f) => called.contains(&f.name.text).then(|| item.clone()),
            Item::Var(v) if v.kind == VarKind::Const => {
                let mut v = v.clone();
                v.names.retain(|n| !self.own.contains_key(&*n.text));
                (!v.names.is_empty()).then_some(Item::Var(v))
            }
            _ => None,
        };
        doc.items.iter().filter_map(shared).collect()
    }

    /// The outputs of the charts that no name of the plant hides.
    fn chart_outputs(&mut self, at: At) -> Vec<Box<str>> {
        let unit = self.unit;
        let outputs =
            unit.vars.iter().filter(|v| v.class == VarClass::Output && !matches!(v.ty, Type::Fb(_)));
        let mut names = Vec::new();
        for v in outputs.filter(|v| !self.own.contains_key(&*v.name)) {
            let mut decl = At(v.at.into()).declare(VarKind::Input, &v.name, v.ty, None);
            decl.at = at.0;
            decl.limits = enumeration(v);
            self.vars.push(decl);
            names.push(v.name.clone());
        }
        names
    }

    fn declare(&mut self, item: &'d PlantItem) {
        match item {
            PlantItem::Const { names, ty, value, comment, at } => {
                self.own(names);
                self.vars.push(VarDecl {
                    names: names.clone(),
                    init: Some(value.clone()),
                    comment: comment.clone(),
                    ..At(*at).declare(VarKind::Const, "", *ty, None)
                });
            }
            PlantItem::State(s) => {
                self.own(&s.names);
                self.vars.push(VarDecl {
                    names: s.names.clone(),
                    init: s.init.clone(),
                    comment: s.comment.clone(),
                    ..At(s.at).declare(VarKind::Var, "", s.ty, None)
                });
            }
            PlantItem::Parts(p) => self.parts(p),
            PlantItem::Rate(_)
            | PlantItem::Drive(_)
            | PlantItem::On(..)
            | PlantItem::Each(..)
            | PlantItem::Arrivals(_)
            | PlantItem::View(_) => {}
        }
    }

    fn own(&mut self, names: &'d [Name]) {
        for name in names {
            // The resolver reports two variables of one name; it does not know parts.
            let before = self.own.insert(&name.text, name.at);
            if let (Some(before), true) = (before, self.rewrite.tables.contains_key(&*name.text)) {
                self.twice(name, before);
            }
        }
    }

    fn twice(&mut self, name: &Name, before: Place) {
        let what = say!("`{}` is defined twice", name.text);
        self.rewrite.problems.push(
            Problem::new(&codes::DEFINED_TWICE, name.at.0, what)
                .related(before.0, say!("defined here first")),
        );
    }

    fn parts(&mut self, p: &'d g7_model::Parts) {
        if let Some(before) = self.own.insert(&p.name.text, p.name.at) {
            return self.twice(&p.name, before);
        }
        let at = p.name.at.0;
        let mut bad = |what: Said| self.rewrite.problems.push(Problem::new(&codes::BAD_PARTS, at, what));
        if p.max == 0 || p.max > MOST_PARTS {
            return bad(say!("`{}` holds {} parts: 1 to {MOST_PARTS} are possible", p.name.text, p.max));
        }
        if p.init.len() > p.max as usize {
            bad(say!("`{}` begins with {} parts but holds {}", p.name.text, p.init.len(), p.max));
        }
        // After its attributes, a part on a track may give its position.
        let (least, most) = (p.attributes.len(), p.attributes.len() + usize::from(p.length.is_some()));
        if p.init.iter().any(|part| part.len() < least || part.len() > most) {
            let track = if most > least { say!(", and perhaps its position") } else { Said::default() };
            bad(say!("each part of `{}` has {least} attribute(s){track}", p.name.text));
        }
        if let Some(a) = p.attributes.iter().find(|a| !a.ty.is_plain()) {
            return bad(say!("the attribute `{}` of a part has a type of the language", a.name.text));
        }
        if let Some(a) = p.attributes.iter().find(|a| matches!(a.ty.base, Type::String(_) | Type::Fb(_))) {
            return bad(say!("a part cannot carry a {}", a.ty.base));
        }
        let table = Table { parts: p };
        self.vars.extend(table.declare());
        self.rewrite.tables.insert(&p.name.text, table);
    }

    fn limits(&mut self, s: &g7_model::StateVar) -> Vec<Stmt> {
        let Some((least, most)) = &s.limits else { return Vec::new() };
        let at = At(s.at);
        s.names
            .iter()
            .map(|n| {
                let held = at.call("LIMIT", vec![least.clone(), at.var(&n.text), most.clone()]);
                at.assign(&n.text, held)
            })
            .collect()
    }

    fn rate(&mut self, plant: &Plant, r: &g7_model::Rate) {
        let at = At(r.at);
        let value = self.rewrite.expr(&r.value);
        let name = &*r.state.text;
        let body = if let Some(t) = self.rewrite.tables.get(name) {
            let Some(length) = t.parts.length.clone() else {
                let what = say!("the parts of `{name}` have no positions");
                self.rewrite.problems.push(
                    Problem::new(&codes::BAD_RATE, r.state.at.0, what)
                        .help(say!("give the parts a `length` to move along")),
                );
                return;
            };
            // Made once for all parts: they move at the same rate.
            let way = t.way();
            let mut body = vec![at.assign(&way, at.binary(BinaryOp::Mul, value, at.var(STEP_LREAL)))];
            body.extend(t.advance(r.at, &at.var(&way), &length));
            body
        } else {
            let ty = plant.items.iter().find_map(|i| match i {
                PlantItem::State(s) if s.names.iter().any(|n| *n.text == *name) => Some(s.ty),
                _ => None,
            });
            let step = match ty {
                Some(Type::Real) => STEP_REAL,
                Some(Type::Lreal) => STEP_LREAL,
                Some(_) | None => {
                    let what = say!("`{name}` is no state of type REAL or LREAL, nor a track");
                    self.rewrite.problems.push(Problem::new(&codes::BAD_RATE, r.state.at.0, what));
                    return;
                }
            };
            let way = at.binary(BinaryOp::Mul, value, at.var(step));
            let mut target = at.var(name);
            if let g7_model::ExprKind::Path(p) = &mut target.kind {
                p.names = vec![r.state.clone()];
            }
            let sum = at.binary(BinaryOp::Add, target.clone(), way);
            vec![at.stmt(g7_model::StmtKind::Assign { target, value: sum })]
        };
        let body = match &r.when {
            Some(when) => vec![at.when(self.rewrite.expr(when), body)],
            None => body,
        };
        self.rates.extend(body);
    }

    fn drive(&mut self, d: &'d g7_model::Drive) {
        let Some(name) = self.rewrite.charts_variable(&d.input) else { return };
        let at = d.input.at;
        if let Some(first) = self.driven.insert(name.clone(), at) {
            let what = say!("input `{name}` is driven twice");
            self.rewrite.problems.push(
                Problem::new(&codes::BAD_DRIVE, at.0, what).related(first.0, say!("driven here first")),
            );
            return;
        }
        let input = self.unit.vars.iter().find(|v| v.class == VarClass::Input && *v.name == *name);
        let Some(input) = input else {
            let what = say!("`{name}` is no input of the charts");
            self.rewrite.problems.push(Problem::new(&codes::BAD_DRIVE, at.0, what));
            return;
        };
        let hidden = driven(&name);
        let value = self.rewrite.expr(&d.value);
        let limits = enumeration(input);
        self.vars.push(VarDecl { limits, ..At(d.at).declare(VarKind::Output, &hidden, input.ty, None) });
        self.drives.push(At(d.at).assign(&hidden, value));
    }

    /// Runs a block each time a condition becomes true; not at the first tick.
    fn on(&mut self, e: &Expr, block: &Block, place: Place) {
        let at = At(place);
        let (now, before) = (self.hide(place), self.hide(place));
        let condition = self.rewrite.expr(e);
        let body = self.rewrite.block(block);
        self.rest.push(at.assign(&now, condition));
        let rose = at.binary(BinaryOp::And, at.var(&now), at.not(at.var(&before)));
        self.rest.push(at.when(at.binary(BinaryOp::And, rose, at.var(STARTED)), body));
        self.rest.push(at.assign(&before, at.var(&now)));
    }

    fn hide(&mut self, place: Place) -> String {
        self.hidden += 1;
        let name = format!("@{}", self.hidden);
        self.vars.push(At(place).declare(VarKind::Var, &name, Type::Bool, None));
        name
    }

    /// Counts down a waiting time, chosen at random between `least` and `most`.
    fn arrival(&mut self, a: &g7_model::Arrivals) {
        let at = At(a.at);
        let left = format!("{}.wait", a.name.text);
        self.vars.push(at.declare(VarKind::Var, &left, Type::Time, None));
        let least = self.rewrite.expr(&a.least);
        let wait = match &a.most {
            None => least,
            Some(most) => {
                let most = self.rewrite.expr(most);
                let spread = at.binary(BinaryOp::Sub, most, least.clone());
                let part = at.binary(BinaryOp::Mul, spread, at.call(rewrite::RANDOM, Vec::new()));
                at.binary(BinaryOp::Add, least, part)
            }
        };
        let step = at.call("@tick", Vec::new());
        let less = at.assign(&left, at.binary(BinaryOp::Sub, at.var(&left), step));
        let zero = at.zero(Type::Time);
        let mut body = self.rewrite.block(&a.body);
        let again = at.binary(BinaryOp::Add, at.var(&left), wait.clone());
        body.insert(0, at.assign(&left, again));
        let due = at.when(at.binary(BinaryOp::Le, at.var(&left), zero), body);
        let going = match &a.when {
            Some(when) => vec![at.when(self.rewrite.expr(when), vec![less, due])],
            None => vec![less, due],
        };
        let first = vec![at.assign(&left, wait)];
        self.arrivals.push(at.stmt(g7_model::StmtKind::If(vec![(at.var(STARTED), going)], first)));
    }
}

/// The name of the plant's output that drives an input of the charts; the plant may have a state
/// with the name of the input.
fn driven(input: &str) -> String {
    format!("@drive.{input}")
}

/// The enumeration of a variable of the charts.
fn enumeration(v: &Var) -> Option<Box<Limits>> {
    match v.held.as_deref() {
        Some(Held::Names(name, _)) => {
            Some(Box::new(Limits::Of(Name { text: name.clone(), at: v.at.into() })))
        }
        Some(Held::Range(..)) | None => None,
    }
}

/// Plants of a document, in the order of the text.
pub fn plants(doc: &Document) -> impl Iterator<Item = &Plant> {
    doc.items.iter().filter_map(|i| if let Item::Plant(p) = i { Some(p) } else { None })
}

/// The plant with a name, or the only one.
pub fn find<'d>(doc: &'d Document, name: Option<&Name>) -> Option<&'d Plant> {
    match name {
        Some(n) => plants(doc).find(|p| p.name.text == n.text),
        None => {
            let mut all = plants(doc);
            all.next().filter(|_| all.next().is_none())
        }
    }
}
