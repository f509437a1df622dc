//! Walks through the whole document, name by name.

use std::collections::{HashMap, HashSet};

use g7_model::instances::{own_instances, uninstantiated};
use g7_model::visit::Visitor;
use g7_model::{
    Block, Chart, ChartItem, Document, Index, Instance, InstanceNames, Item, Name, Order, Placed, Plant,
    PlantItem, Situation, Span, Step, StepKind, Transition, VarDecl, chart_in, instance_of,
};

use super::named::{Definition, Unknown, Use, Written};
use crate::ir::ChartId;
use crate::resolve::{Tracer, resolve_open};

/// Returns every name with what it refers to, and the names that refer to nothing.
pub(super) fn uses(doc: &Document) -> (Vec<Use>, Vec<Unknown>) {
    let resolved = uninstantiated(doc);
    let (mut unit, mut scopes, _) = resolve_open(&resolved, None);
    let tracer = Tracer::new(&mut unit, &mut scopes);
    let mut walk = Walk { tracer, locals: Vec::new(), plant: None, uses: Vec::new(), unknown: Vec::new() };
    let mut charts = 0;
    for item in &doc.items {
        if let Item::Chart(chart) = item {
            walk.tracer.enter(Some(ChartId(charts)));
            walk.chart(chart);
            walk.tracer.enter(None);
            charts += 1;
        } else {
            walk.item(doc, item);
        }
    }
    instances_as_charts(doc, &mut walk.uses);
    (walk.uses, walk.unknown)
}

/// The parts of an instance with a name of its own are defined in its chart with parameters.
fn instances_as_charts(doc: &Document, uses: &mut [Use]) {
    let own: HashMap<&str, &str> = own_instances(doc).collect();
    if own.is_empty() {
        return;
    }
    for used in uses {
        let home = match &mut used.definition {
            Definition::Step { chart, .. } | Definition::Transition { chart, .. } => Some(chart),
            Definition::Variable { chart, .. }
            | Definition::Action { chart, .. }
            | Definition::Section { chart, .. } => chart.as_mut(),
            Definition::Chart(_)
            | Definition::Function(_)
            | Definition::Plant(_)
            | Definition::PlantItem { .. } => None,
        };
        if let Some(home) = home
            && let Some(chart) = own.get(home.as_str())
        {
            *home = (*chart).to_owned();
        }
    }
}

struct Walk<'u, 'd> {
    tracer: Tracer<'u, 'd>,
    locals: Vec<HashSet<&'d str>>,
    /// The plant that is being walked, and its names; they hide those of the charts.
    plant: Option<(&'d Plant, HashSet<&'d str>)>,
    uses: Vec<Use>,
    unknown: Vec<Unknown>,
}

impl<'d> Walk<'_, 'd> {
    fn add(&mut self, at: Span, definition: Definition, written: Written) {
        self.uses.push(Use { at, definition, written, before: 0 });
    }

    fn name(&mut self, name: &Name, definition: Option<Definition>, written: Written) {
        match definition {
            Some(definition) => self.add(name.at.0, definition, written),
            None => self.unknown.push(Unknown { at: name.at.0, step_of: None }),
        }
    }

    /// `Axis.X12` for `Axis[3].X12`, if there is such a chart: a variable in back-ticks can have a name of this form.
    fn of_instance(&self, names: &[Name]) -> Option<Vec<Name>> {
        let [first, members @ ..] = names else { return None };
        let (chart, _) = instance_of(&first.text).filter(|_| !members.is_empty())?;
        self.tracer.chart(chart)?;
        Some(std::iter::once(Name::new(chart, first.at.0)).chain(members.iter().cloned()).collect())
    }

    /// The parameter in the name of an instance, `Axis[i + 1]`: it stands right behind the bracket.
    fn index(&mut self, name: &Name) {
        let Some((_, Index::Parameter(parameter, _))) = instance_of(&name.text) else { return };
        let start = name.at.0.end + 1;
        let at = Span { start, end: start + parameter.len() as u32, ..name.at.0 };
        let found = self.tracer.path(&[Name::new(parameter, at)], &self.locals).names.into_iter().next();
        match found {
            Some((_, definition, _)) => self.add(at, definition, Written::Name),
            None => self.unknown.push(Unknown { at, step_of: None }),
        }
    }

    /// A name that can only be that of a step of a chart.
    fn step_name(&mut self, chart: &str, name: &Name, written: Written) {
        match self.tracer.step_of(chart, &name.text) {
            Some(step) => self.add(name.at.0, step, written),
            None => self.unknown.push(Unknown { at: name.at.0, step_of: Some(chart.to_owned()) }),
        }
    }

    // The file

    fn item(&mut self, doc: &'d Document, item: &'d Item) {
        match item {
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Chart(_) => {}
            Item::Instance(i) => self.named_instance(i),
            Item::Var(v) => self.variable(None, v),
            Item::Action(a) => self.named(None, a),
            Item::Section(s) => self.section(None, s),
            Item::Function(f) => {
                self.name(&f.name, Some(Definition::Function(f.name.text.to_string())), Written::Declared);
                let mut own: HashSet<&str> = f.params.iter().map(|p| &*p.name.text).collect();
                own.insert(&f.name.text);
                self.locals.push(own);
                self.block(&f.body);
                self.locals.pop();
            }
            Item::Pre(body, _) | Item::Post(body, _) => self.body(body),
            Item::Plant(p) => self.plant(p),
            Item::Test(t) => {
                let plant = t.plant.as_ref().and_then(|n| plant_named(doc, &n.text));
                if let (Some(name), Some(p)) = (&t.plant, plant) {
                    self.name(name, Some(Definition::Plant(p.name.text.to_string())), Written::Name);
                }
                // A condition refers to the plant if the plant declares the name.
                self.plant = plant.map(|p| (p, plant_names(p)));
                t.body.iter().for_each(|s| self.test(s));
                self.plant = None;
            }
            Item::Prove(p) => self.property(&p.kind),
            Item::Layout(l) => {
                let chart = self.tracer.chart(&l.chart.text);
                self.name(&l.chart, chart, Written::Name);
                for place in &l.places {
                    match &place.what {
                        Placed::Step(name) => self.step_name(&l.chart.text, name, Written::Name),
                        Placed::Transition(label) => {
                            let (chart, text) = (l.chart.text.to_string(), label.text.to_string());
                            let def = Definition::Transition { chart, label: text };
                            self.name(label, Some(def), Written::Name);
                        }
                        Placed::TransitionNumber(_) | Placed::Comment(_) => {}
                    }
                }
            }
        }
    }

    fn named_instance(&mut self, i: &'d Instance) {
        let chart = self.tracer.chart(&i.chart.text);
        self.name(&i.chart, chart, Written::Name);
        if let InstanceNames::One(name) = &i.names {
            self.add(name.at.0, Definition::Chart(name.text.to_string()), Written::Declared);
        }
        for name in i.args.iter().filter_map(|a| a.name.as_ref()) {
            let def =
                Definition::Variable { chart: Some(i.chart.text.to_string()), name: name.text.to_string() };
            self.add(name.at.0, def, Written::Name);
        }
        self.instance(i);
    }

    fn variable(&mut self, chart: Option<&str>, v: &'d VarDecl) {
        for name in &v.names {
            let def = Definition::Variable { chart: chart.map(str::to_owned), name: name.text.to_string() };
            self.add(name.at.0, def, Written::Declared);
        }
        v.init.iter().chain(&v.safe).for_each(|e| self.expr(e));
    }

    fn named(&mut self, chart: Option<&str>, a: &'d g7_model::NamedAction) {
        let def = Definition::Action { chart: chart.map(str::to_owned), name: a.name.text.to_string() };
        self.add(a.name.at.0, def, Written::Declared);
        self.body(&a.body);
    }

    fn section(&mut self, chart: Option<&str>, s: &'d g7_model::Section) {
        let def = Definition::Section { chart: chart.map(str::to_owned), name: s.name.text.to_string() };
        self.add(s.name.at.0, def, Written::Declared);
        self.block(&s.body);
    }

    // Charts

    fn chart(&mut self, chart: &'d Chart) {
        let home = chart.name.text.to_string();
        self.add(chart.name.at.0, Definition::Chart(home.clone()), Written::Declared);
        for param in &chart.params {
            let def = Definition::Variable { chart: Some(home.clone()), name: param.name.text.to_string() };
            self.add(param.name.at.0, def, Written::Declared);
        }
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => self.variable(Some(&home), v),
                ChartItem::Step(s) => self.step(&home, s),
                ChartItem::Transition(t) => self.transition(&home, t),
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body),
                ChartItem::Action(a) => self.named(Some(&home), a),
                ChartItem::Section(s) => self.section(Some(&home), s),
            }
        }
    }

    fn step(&mut self, chart: &str, step: &'d Step) {
        let def = Definition::Step { chart: chart.to_owned(), name: step.name.text.to_string() };
        self.add(step.name.at.0, def, Written::Declared);
        if let StepKind::Macro(expansion) = &step.kind {
            self.index(expansion);
            let chart = self.tracer.chart(chart_in(&expansion.text));
            self.name(expansion, chart, Written::Name);
        }
        step.actions.iter().for_each(|a| self.action(a));
    }

    fn transition(&mut self, chart: &str, t: &'d Transition) {
        if let Some(label) = &t.label {
            let def = Definition::Transition { chart: chart.to_owned(), label: label.text.to_string() };
            self.add(label.at.0, def, Written::Declared);
        }
        // In a chain the preceding steps are those that the transition before it leads to.
        let before: &[Name] = if t.chained { &[] } else { &t.from };
        for name in before.iter().chain(&t.to) {
            match self.tracer.own_step(&name.text) {
                Some(step) => self.add(name.at.0, step, Written::Step),
                None => self.unknown.push(Unknown { at: name.at.0, step_of: Some(chart.to_owned()) }),
            }
        }
        self.expr(&t.receptivity);
        t.on_clearing.iter().for_each(|b| self.block(b));
    }

    fn plant(&mut self, plant: &'d Plant) {
        let home = plant.name.text.to_string();
        self.add(plant.name.at.0, Definition::Plant(home.clone()), Written::Declared);
        self.plant = Some((plant, plant_names(plant)));
        for item in &plant.items {
            for n in declared(item) {
                let own = Definition::PlantItem { plant: home.clone(), name: n.text.to_string() };
                self.add(n.at.0, own, Written::Declared);
            }
            self.plant_item(item);
        }
        self.plant = None;
    }
}

impl<'d> Visitor<'d> for Walk<'_, 'd> {
    fn path(&mut self, names: &'d [Name]) {
        let local = |w: &Self, n: &Name| w.locals.iter().any(|l| l.contains(&*n.text));
        let of_plant = match (names.first(), &self.plant) {
            (Some(first), Some((p, own))) if own.contains(&*first.text) && !local(self, first) => {
                let plant = p.name.text.to_string();
                Some((first.at.0, Definition::PlantItem { plant, name: first.text.to_string() }))
            }
            _ => None,
        };
        let only = names.len() == 1;
        if let Some((at, def)) = of_plant {
            return self.add(at, def, Written::Path { first: true, only });
        }
        let named = self.of_instance(names);
        if named.is_some() {
            names.first().into_iter().for_each(|n| self.index(n));
        }
        let followed = self.tracer.path(named.as_deref().unwrap_or(names), &self.locals);
        if !followed.whole {
            let known = |k: usize| followed.names.iter().any(|(of, ..)| *of == k);
            let missing = names.iter().enumerate().filter(|(k, _)| !known(*k));
            self.unknown.extend(missing.map(|(_, name)| Unknown { at: name.at.0, step_of: None }));
        }
        for (k, definition, before) in followed.names {
            if let Some(name) = names.get(k) {
                let written = Written::Path { first: k == 0, only };
                self.uses.push(Use { at: name.at.0, definition, written, before });
            }
        }
    }

    fn direct(&mut self, text: &'d str, at: Span) {
        let found = self.tracer.direct(text);
        if found.is_empty() {
            self.unknown.push(Unknown { at, step_of: None });
        }
        for (_, def, _) in found {
            self.add(at, def, Written::Direct);
        }
    }

    fn order(&mut self, order: &'d Order) {
        let name = match order {
            Order::Force(name, situation) => {
                if let Situation::Steps(steps) = situation {
                    steps.iter().for_each(|step| self.step_name(chart_in(&name.text), step, Written::Step));
                }
                name
            }
            Order::Enable(name) | Order::Mask(name) | Order::Call(name) | Order::Enclose(name) => name,
        };
        self.index(name);
        let chart = self.tracer.chart(chart_in(&name.text));
        let output = matches!(order, Order::Mask(_)) && chart.is_none();
        if output {
            let def = self.tracer.path(std::slice::from_ref(name), &self.locals).names.into_iter().next();
            return self.name(name, def.map(|d| d.1), Written::Name);
        }
        self.name(name, chart, Written::Name);
    }

    fn enter(&mut self, block: &'d Block) {
        let own = block.locals.iter().flat_map(|l| &l.names).map(|n| &*n.text).collect();
        self.locals.push(own);
    }

    fn leave(&mut self) {
        self.locals.pop();
    }
}

fn plant_named<'d>(doc: &'d Document, name: &str) -> Option<&'d Plant> {
    doc.items.iter().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *name => Some(p),
        _ => None,
    })
}

/// The names that a plant declares itself.
fn plant_names(plant: &Plant) -> HashSet<&str> {
    plant.items.iter().flat_map(declared).map(|n| &*n.text).collect()
}

/// The names that an item of a plant declares.
fn declared(item: &PlantItem) -> &[Name] {
    match item {
        PlantItem::Const { names, .. } => names,
        PlantItem::State(s) => &s.names,
        PlantItem::Parts(p) => std::slice::from_ref(&p.name),
        PlantItem::Arrivals(a) => std::slice::from_ref(&a.name),
        PlantItem::Rate(_)
        | PlantItem::Drive(_)
        | PlantItem::On(..)
        | PlantItem::Each(..)
        | PlantItem::View(_) => &[],
    }
}
