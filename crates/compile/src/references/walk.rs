//! Walks through the whole document, name by name.

use std::collections::{HashMap, HashSet};

use g7_model::instances::{own_instances, uninstantiated};
use g7_model::visit::Visitor;
use g7_model::{
    Arg, Block, Chart, ChartItem, Composed, Document, Expr, ExprKind, Index, Instance, InstanceNames, Item,
    Name, Order, Path, Placed, Plant, Situation, Span, Step, StepKind, Transition, ValueType, VarDecl,
    chart_in, instance_of, slot_of,
};

use super::members::{Kind, Member, Types, values};
use super::named::{Definition, Unknown, Use, Written};
use super::plants::{declared, plant_named, plant_names};
use crate::ir::ChartId;
use crate::resolve::{Followed, Traced, Tracer, resolve_open};

/// Returns every name with what it refers to, and the names that refer to nothing.
pub(super) fn uses(doc: &Document) -> (Vec<Use>, Vec<Unknown>) {
    let resolved = uninstantiated(doc);
    let (mut unit, mut scopes, _) = resolve_open(&resolved, None);
    let tracer = Tracer::new(&mut unit, &mut scopes);
    let mut walk = Walk {
        tracer,
        types: Types::of(&resolved),
        within: None,
        block: None,
        locals: Vec::new(),
        plant: None,
        uses: Vec::new(),
        unknown: Vec::new(),
    };
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
            | Definition::Type(_)
            | Definition::Value { .. }
            | Definition::Member { .. }
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
    types: Types<'d>,
    /// The function block whose body is being walked; its names hide all others.
    within: Option<&'d Composed>,
    /// The function block of the chart that is being walked, if it is a chart of a function block.
    block: Option<&'d Composed>,
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

    /// The variable in an index that is part of a name, `Axis[i + 1]`: it stands right behind the bracket.
    fn index(&mut self, name: &Name) {
        let Some((_, Index::Parameter(parameter, _))) = instance_of(&name.text) else { return };
        if !is_before_index(name) {
            return;
        }
        let start = name.at.0.end + 1;
        let at = Span { start, end: start + parameter.len() as u32, ..name.at.0 };
        let found = self.follow(&[Name::new(parameter, at)]).0.names.into_iter().next();
        match found {
            Some((_, definition, _)) => self.add(at, definition, Written::Name),
            None if self.is_local(parameter) => {}
            None => self.unknown.push(Unknown { at, step_of: None }),
        }
    }

    fn is_local(&self, name: &str) -> bool {
        self.locals.iter().any(|l| l.contains(name))
    }

    /// Finds what the names of a path refer to, and what the whole of it is, as far as the file declares its type.
    fn follow(&self, names: &[Name]) -> (Followed, Kind<'d>) {
        if let Some(found) = self.part(names) {
            return found;
        }
        let named = self.of_instance(names);
        let found = self.tracer.path(named.as_deref().unwrap_or(names), &self.locals);
        let value = if found.names.is_empty() { self.types.value(names) } else { Vec::new() };
        match value.is_empty() {
            true => (found, Kind::Unknown),
            false => (Followed { whole: value.len() == names.len(), names: value }, Kind::Unknown),
        }
    }

    /// The same for a path to a variable of a type that the file declares, to a member of one, and behind an index;
    /// None for other paths.
    fn part(&self, names: &[Name]) -> Option<(Followed, Kind<'d>)> {
        let indexed = names.iter().any(|n| n.text.ends_with(']'));
        if self.types.is_empty() && !indexed {
            return None;
        }
        let names = self.bare(names);
        let first = names.first()?;
        if self.is_local(&first.text) {
            return Some((Followed::whole(Vec::new()), Kind::Unknown));
        }
        let own = self.within.or(self.block).and_then(|of| Member::named(of, &first.text));
        let (mut found, kind) = match own {
            Some(member) => (vec![(0, member.definition(), 0)], self.types.kind_of(&member)),
            None => self.variable_at(&names, indexed)?,
        };
        if let Some(found) = self.chart_behind(&names, &found, kind) {
            return Some((found, Kind::Unknown));
        }
        let behind: Vec<&str> = names.iter().skip(found.len()).map(|n| &*n.text).collect();
        let (members, kind) = self.types.behind(kind, &behind);
        let from = found.len();
        found.extend(members.iter().enumerate().map(|(k, member)| (from + k, member.definition(), 0)));
        let whole = match (names.get(found.len()..).unwrap_or_default(), kind) {
            ([], _) => true,
            ([part], Kind::Plain(ty)) => Tracer::has_part(ty, &part.text),
            _ => false,
        };
        Some((Followed { names: found, whole }, kind))
    }

    /// The path to a chart of an instance and behind it: `left.Cycle.X12`, `cell.gripper[2].Cycle`.
    fn chart_behind(&self, names: &[Name], found: &[Traced], kind: Kind<'d>) -> Option<Followed> {
        let (mut all, mut kind) = (found.to_vec(), kind);
        loop {
            let Kind::Composed(of) = kind else { return None };
            let next = names.get(all.len())?;
            let Some(member) = Member::named(of, &next.text) else { break };
            all.push((all.len(), member.definition(), 0));
            kind = self.types.kind_of(&member);
        }
        let Kind::Composed(of) = kind else { return None };
        let (from, chart) = (all.len(), names.get(all.len())?);
        self.types.charts(of).find(|c| c.name.text == chart.text)?;
        let rest = names.get(from..)?;
        let inner = match rest {
            [_] => {
                let chart = self.tracer.chart(&chart.text).map(|d| (0, d, 0));
                Followed::whole(chart.into_iter().collect())
            }
            rest => self.part(rest).map_or_else(|| self.tracer.path(rest, &[]), |(found, _)| found),
        };
        all.extend(inner.names.into_iter().map(|(k, definition, before)| (from + k, definition, before)));
        Some(Followed { names: all, whole: inner.whole })
    }

    /// The variable with which a path begins, after its chart if that is named; None if no member can follow it.
    fn variable_at(&self, names: &[Name], indexed: bool) -> Option<(Vec<Traced>, Kind<'d>)> {
        let chart = names.first().and_then(|n| self.tracer.chart(&n.text));
        let of_chart = names.get(..2).filter(|_| chart.is_some());
        [of_chart, names.get(..1)].into_iter().flatten().find_map(|begin| {
            let found = self.tracer.path(begin, &[]).names;
            let Some((_, Definition::Variable { chart, name }, _)) = found.last() else { return None };
            let v = self.types.variable(chart.as_deref(), name)?;
            let fits = found.len() == begin.len() && (v.of.is_some() || indexed);
            fits.then(|| (found, self.types.kind(v)))
        })
    }

    /// The names of a path without their indexes.
    fn bare(&self, names: &[Name]) -> Vec<Name> {
        let last = names.len().saturating_sub(1);
        let one = |(k, name): (usize, &Name)| {
            let slot = slot_of(&name.text).filter(|_| k < last).map(|(bare, _)| bare);
            let numbered = || instance_of(&name.text).filter(|_| is_before_index(name)).map(|(bare, _)| bare);
            let text = slot.or_else(numbered).unwrap_or(&name.text);
            Name { text: text.into(), at: name.at }
        };
        names.iter().enumerate().map(one).collect()
    }

    /// Adds the names of a path; returns what the whole of it is.
    fn add_path(&mut self, names: &[Name]) -> Kind<'d> {
        names.iter().for_each(|n| self.index(n));
        let only = names.len() == 1;
        let first = self.plant.iter().find_map(|(p, own)| {
            let first = self.bare(names).into_iter().next()?;
            (own.contains(&*first.text) && !self.is_local(&first.text)).then_some((first, *p))
        });
        if let Some((first, plant)) = first {
            let (plant, name) = (plant.name.text.to_string(), first.text.to_string());
            let written = Written::Path { first: true, only };
            self.add(first.at.0, Definition::PlantItem { plant, name }, written);
            return Kind::Unknown;
        }
        let (followed, kind) = self.follow(names);
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
        kind
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
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Use(_) | Item::Chart(_) => {}
            Item::Instance(i) => self.named_instance(i),
            Item::Composed(c) => self.composed(c),
            Item::Type(t) => self.type_declaration(t),
            Item::Var(v) => self.variable(None, v),
            Item::Action(a) => self.named(None, a),
            Item::Section(s) => self.section(None, s),
            Item::Function(f) => {
                self.name(&f.name, Some(Definition::Function(f.name.text.to_string())), Written::Declared);
                self.params(&f.params);
                self.value_type(&f.result);
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
                for symbol in l.places.iter().flat_map(|p| p.what.symbols()) {
                    match symbol {
                        Placed::Step(name) => self.step_name(&l.chart.text, name, Written::Name),
                        Placed::Transition(label) => {
                            let (chart, text) = (l.chart.text.to_string(), label.text.to_string());
                            let def = Definition::Transition { chart, label: text };
                            self.name(label, Some(def), Written::Name);
                        }
                        _ => {}
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
        self.declaration(v);
    }

    /// All of a declaration but the names that it declares.
    fn declaration(&mut self, v: &'d VarDecl) {
        v.of.iter().for_each(|of| self.type_name(of));
        self.exprs(v.array.iter().flat_map(|a| a.bounds()));
        v.limits.iter().for_each(|l| self.limits(l));
        v.init.iter().for_each(|e| self.initial(e, self.types.kind(v)));
        self.exprs(&v.safe);
    }

    /// The name of a type where something is of that type.
    fn type_name(&mut self, of: &Name) {
        let known = self.types.has(&of.text).then(|| Definition::Type(of.text.to_string()));
        self.name(of, known, Written::Name);
    }

    /// An initial value, `(speed := 2.0)` or a list of such for a variable with members.
    fn initial(&mut self, e: &'d Expr, kind: Kind<'d>) {
        match &e.kind {
            ExprKind::List(values) => values.iter().for_each(|(_, e)| self.initial(e, kind)),
            ExprKind::Call(path, fields) if path.names.is_empty() => {
                for field in fields {
                    let inner = self.argument(field, kind);
                    self.initial(&field.value, inner);
                }
            }
            _ => self.expr(e),
        }
    }

    /// The name of an argument or of a field, which is a member of a type; returns what that member is.
    fn argument(&mut self, arg: &Arg, kind: Kind<'d>) -> Kind<'d> {
        let Some(name) = &arg.name else { return Kind::Unknown };
        let member = match kind {
            Kind::Composed(of) => Member::named(of, &name.text),
            Kind::Plain(_) | Kind::Unknown => None,
        };
        self.name(name, member.map(|m| m.definition()), Written::Name);
        member.map_or(Kind::Unknown, |m| self.types.kind_of(&m))
    }

    /// A type, and the values of an enumeration.
    fn type_declaration(&mut self, t: &'d VarDecl) {
        for name in &t.names {
            self.add(name.at.0, Definition::Type(name.text.to_string()), Written::Declared);
        }
        for (of, name) in values(t) {
            self.add(name.at.0, Definition::value(of, name), Written::Declared);
        }
        // In `type Mode : (Off, …) := Off` the value is that of this type, also if another type has such a value.
        let first = match t.init.as_ref().map(|e| &e.kind) {
            Some(ExprKind::Path(path)) if path.names.len() == 1 => path.names.first(),
            _ => None,
        };
        let own = first.and_then(|name| values(t).find(|(_, v)| v.text == name.text).zip(Some(name)));
        match own {
            Some(((of, _), name)) => {
                self.add(name.at.0, Definition::value(of, name), Written::Path { first: true, only: true });
            }
            None => self.declaration(t),
        }
    }

    /// A structure or function block.
    fn composed(&mut self, c: &'d Composed) {
        self.add(c.name.at.0, Definition::Type(c.name.text.to_string()), Written::Declared);
        for member in Member::all(c) {
            self.add(member.name.at.0, member.definition(), Written::Declared);
        }
        // The values of members see the file alone: they are written where a variable is declared.
        c.members.iter().chain(&c.inouts).for_each(|v| self.declaration(v));
        self.within = Some(c);
        c.body.iter().for_each(|b| self.body(b));
        self.within = None;
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
        if let Some(block) = &chart.block {
            self.block = self.types.named(&block.text);
            let known = self.block.map(|of| Definition::Type(of.name.text.to_string()));
            self.name(block, known, Written::Name);
        }
        self.params(&chart.params);
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
        self.block = None;
    }

    /// The name of a chart that an order or a macro-step uses; returns the chart that is drawn for it.
    fn chart_name<'n>(&mut self, name: &'n Name) -> (&'n str, Option<Definition>) {
        self.index(name);
        let drawn = chart_in(&name.text);
        let Some(chart) = self.tracer.chart(drawn) else {
            let parts = parts_of(name);
            if let Some(followed) = self.part(&parts).map(|(f, _)| f).filter(|f| f.whole && parts.len() > 1) {
                let last = followed.names.last().map(|(_, d, _)| d.clone());
                self.add_path(&parts);
                return (name.text.rsplit('.').next().unwrap_or_default(), last);
            }
            return (drawn, None);
        };
        self.name(name, Some(chart.clone()), Written::Name);
        (drawn, Some(chart))
    }

    fn step(&mut self, chart: &str, step: &'d Step) {
        let def = Definition::Step { chart: chart.to_owned(), name: step.name.text.to_string() };
        self.add(step.name.at.0, def, Written::Declared);
        if let StepKind::Macro(expansion) = &step.kind
            && self.chart_name(expansion).1.is_none()
        {
            self.name(expansion, None, Written::Name);
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
        self.add_path(names);
    }

    fn value_type(&mut self, ty: &'d ValueType) {
        ty.of.iter().for_each(|of| self.type_name(of));
        ty.limits.iter().for_each(|l| self.limits(l));
    }

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        let kind = self.add_path(&path.names);
        // The parameters of functions and of function blocks of the standard are not followed.
        if matches!(kind, Kind::Composed(_)) || path.names.is_empty() {
            args.iter().for_each(|a| _ = self.argument(a, kind));
        }
        self.exprs(args.iter().map(|a| &a.value));
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
        let (Order::Force(name, _)
        | Order::Enable(name)
        | Order::Mask(name)
        | Order::Call(name)
        | Order::Enclose(name)) = order;
        let (drawn, chart) = self.chart_name(name);
        if let Order::Force(_, Situation::Steps(steps)) = order {
            steps.iter().for_each(|step| self.step_name(drawn, step, Written::Step));
        }
        if chart.is_none() {
            let output = matches!(order, Order::Mask(_));
            let mut found = self.tracer.path(std::slice::from_ref(name), &self.locals).names.into_iter();
            self.name(name, found.next().map(|d| d.1).filter(|_| output), Written::Name);
        }
    }

    fn enter(&mut self, block: &'d Block) {
        // Those of a function block are its members.
        let locals = if self.within.is_some() { &[][..] } else { &block.locals };
        self.locals.push(locals.iter().flat_map(|l| &l.names).map(|n| &*n.text).collect());
    }

    fn leave(&mut self) {
        self.locals.pop();
    }
}

/// True if an index that belongs to the name stands behind it in the text. In back-ticks a name can have this form too;
/// these then enclose all of it.
fn is_before_index(name: &Name) -> bool {
    name.at.0.bytes().len() < name.text.len()
}

/// The names in that of a chart of an instance, `gripper[2].Cycle`, each with its place.
fn parts_of(name: &Name) -> Vec<Name> {
    let mut start = name.at.0.start;
    let one = |part: &str| {
        let bare = chart_in(part).len() as u32;
        let at = Span { start, end: start + bare, ..name.at.0 };
        start += part.len() as u32 + 1;
        Name::new(part, at)
    };
    // Blanks in the brackets stand between the names and their places.
    let plain = name.at.0.bytes().len() == name.text.len();
    if plain { name.text.split('.').map(one).collect() } else { vec![name.clone()] }
}
