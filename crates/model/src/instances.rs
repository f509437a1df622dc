//! Puts the instances of charts with parameters in the place of these charts.
//!
//! ```text
//! syntax -> Document -> here -> compile, the writers of exchange
//! ```
//!
//! An instance is a chart of its own: the steps, transitions and variables of the chart with parameters, and a
//! constant for each parameter. So all that follows knows charts only.
//!
//! # What must hold
//!
//! - A document without parameters and instances is not copied.
//! - In the result no chart has parameters. In an instance, `Axis[i + 1]` has become `Axis[4]`; where `i` is no
//!   parameter with a whole number, the name stays as it is and is later told as an unknown one.
//! - All places are those of the one text. The work is bounded by [`MOST`].

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use crate::visit::Visitor as Reader;
use crate::visit_mut::{self, Use, Visitor};
use crate::{
    Arg, Chart, ChartItem, Document, Expr, ExprKind, Index, Instance, InstanceNames, Item, Layout, Literal,
    Name, Order, Param, Path, Problem, Span, VarDecl, VarKind, chart_in, codes, instance_of, say,
};

/// The greatest length of the text of all instances together, in MiB.
const MOST: usize = 16;

/// The document with charts for all instances, and the problems of their declarations.
pub fn instantiated(document: &Document) -> (Cow<'_, Document>, Vec<Problem>) {
    let concerned = |i: &Item| match i {
        Item::Chart(c) => !c.params.is_empty(),
        Item::Instance(_) => true,
        _ => false,
    };
    if !document.items.iter().any(concerned) {
        return (Cow::Borrowed(document), Vec::new());
    }
    let mut made = Maker::of(document);
    for item in &document.items {
        match item {
            Item::Instance(i) => made.instances(i),
            Item::Chart(c) if !c.params.is_empty() => {}
            Item::Layout(l) if made.charts.contains_key(&*l.chart.text) => {}
            item => {
                let mut item = item.clone();
                visit_mut::item(&mut item, &mut Numbered { numbers: HashMap::new(), charts: &made.charts });
                made.items.push(item);
            }
        }
    }
    made.unused(document);
    (Cow::Owned(Document { items: made.items, notes: document.notes.clone() }), made.problems)
}

/// The document for those who follow its names: a chart with parameters is one chart with constants, and `Lift` of
/// `instance Lift : Axis(7)` is a copy of it behind all other items.
pub fn uninstantiated(document: &Document) -> Cow<'_, Document> {
    if !document.charts().any(|c| !c.params.is_empty()) {
        return Cow::Borrowed(document);
    }
    let mut own = document.clone();
    for item in &mut own.items {
        if let Item::Chart(c) = item {
            let constants = std::mem::take(&mut c.params);
            let constants = constants.iter().map(|p| ChartItem::Var(constant(p, None)));
            c.items.splice(0..0, constants.collect::<Vec<_>>());
        }
    }
    let charts: HashMap<&str, &Chart> = own.charts().map(|c| (&*c.name.text, c)).collect();
    let mut room = Room::default();
    let copies: Vec<Item> = document
        .items
        .iter()
        .filter_map(|item| {
            let Item::Instance(Instance { chart, names: InstanceNames::One(name), .. }) = item else {
                return None;
            };
            let copy = charts.get(&*chart.text).filter(|c| room.takes(length(c.at.0), 1))?;
            Some(Item::Chart(Chart { name: name.clone(), ..(*copy).clone() }))
        })
        .collect();
    own.items.extend(copies);
    Cow::Owned(own)
}

/// The charts that are drawn for the names of instances.
#[derive(Debug)]
pub struct Drawings<'n> {
    /// The instances that have a name of their own, each with its chart.
    own: HashMap<&'n str, &'n str>,
    /// The charts; true for one of a function block.
    charts: HashMap<&'n str, bool>,
}

impl<'n> Drawings<'n> {
    /// Those of a document.
    pub fn of(document: &'n Document) -> Drawings<'n> {
        let charts = document.charts().map(|c| (&*c.name.text, c.block.is_some()));
        Drawings { own: own_instances(document).collect(), charts: charts.collect() }
    }

    /// The chart that is drawn for a name: `Axis` for `Axis[3]`, and for `Lift` of `instance Lift : Axis(7)`; `Cycle` for
    /// `left.Cycle`, if it is a chart of a function block.
    pub fn drawn_for(&self, name: &'n str) -> &'n str {
        if let Some(chart) = self.own.get(name) {
            return chart;
        }
        let of_block =
            name.rsplit_once('.').map(|(_, own)| own).filter(|own| self.charts.get(own) == Some(&true));
        of_block.filter(|_| !self.charts.contains_key(name)).unwrap_or_else(|| chart_in(name))
    }
}

/// The instances that have a name of their own, each with its chart: `Lift` and `Axis` for `instance Lift : Axis(7)`.
pub fn own_instances(document: &Document) -> impl Iterator<Item = (&str, &str)> {
    document.items.iter().filter_map(|i| match i {
        Item::Instance(Instance { chart, names: InstanceNames::One(own), .. }) => {
            Some((&*own.text, &*chart.text))
        }
        _ => None,
    })
}

/// The length of a place in the text, in bytes.
fn length(at: Span) -> usize {
    at.bytes().len()
}

/// The text of the instances that were made.
#[derive(Default)]
struct Room {
    bytes: usize,
}

impl Room {
    /// Takes so many texts of a length; false if they would be too large.
    fn takes(&mut self, length: usize, count: usize) -> bool {
        // An instance has a size of its own, however short its text is.
        let bytes = self.bytes.saturating_add(count.saturating_mul(length + 64));
        let fits = bytes <= MOST << 20;
        if fits {
            self.bytes = bytes;
        }
        fits
    }
}

struct Maker<'d> {
    /// The charts with parameters.
    charts: HashMap<&'d str, &'d Chart>,
    /// Their layouts.
    layouts: HashMap<&'d str, Vec<&'d Layout>>,
    /// The names of the variables of the file.
    file: HashSet<&'d str>,
    /// The charts without.
    plain: HashMap<&'d str, Span>,
    /// Whole constants of the file, for the bounds of ranges.
    constants: HashMap<&'d str, i128>,
    items: Vec<Item>,
    /// The instances, each with its declaration.
    named: HashMap<Box<str>, Span>,
    /// The charts with parameters that an item `instance` names.
    used: HashSet<&'d str>,
    room: Room,
    problems: Vec<Problem>,
}

impl<'d> Maker<'d> {
    fn of(document: &'d Document) -> Maker<'d> {
        let (mut charts, mut plain) = (HashMap::new(), HashMap::new());
        for chart in document.charts() {
            if chart.params.is_empty() {
                plain.entry(&*chart.name.text).or_insert(chart.name.at.0);
            } else {
                charts.entry(&*chart.name.text).or_insert(chart);
            }
        }
        let (mut constants, mut file, mut layouts) = (HashMap::new(), HashSet::new(), HashMap::new());
        for item in &document.items {
            match item {
                Item::Var(v) => {
                    file.extend(v.names.iter().map(|n| &*n.text));
                    let value = v.init.as_ref().and_then(|e| e.kind.whole());
                    if let Some(value) = value.filter(|_| v.kind == VarKind::Const) {
                        constants.extend(v.names.iter().map(|n| (&*n.text, value)));
                    }
                }
                Item::Layout(l) if charts.contains_key(&*l.chart.text) => {
                    layouts.entry(&*l.chart.text).or_insert_with(Vec::new).push(l);
                }
                _ => {}
            }
        }
        let mut made = Maker {
            charts,
            layouts,
            file,
            plain,
            constants,
            items: Vec::new(),
            named: HashMap::new(),
            used: HashSet::new(),
            room: Room::default(),
            problems: Vec::new(),
        };
        made.twice(document);
        made.of_blocks(document);
        made
    }

    /// Reports charts with parameters whose name another chart has; charts without are compared later.
    fn twice(&mut self, document: &'d Document) {
        for chart in document.charts().filter(|c| !c.params.is_empty() && !c.name.text.is_empty()) {
            let name = &*chart.name.text;
            let first = self.charts.get(name).map(|c| c.name.at.0).filter(|at| *at != chart.name.at.0);
            if let Some(first) = first.or_else(|| self.plain.get(name).copied()) {
                self.defined_twice(&chart.name, chart.name.at.0, first);
            }
        }
    }

    /// Reports charts that have parameters and are those of a function block.
    fn of_blocks(&mut self, document: &'d Document) {
        for (chart, block) in document.charts().filter_map(|c| Some((c, c.block.as_ref()?))) {
            let Some(param) = chart.params.first() else { continue };
            let what = say!("a chart of a function block has no parameters");
            let help = say!("declare an input of `{}`", block.text);
            self.problems.push(Problem::new(&codes::BAD_DECLARATION, param.name.at.0, what).help(help));
            self.used.insert(&chart.name.text);
        }
    }

    fn defined_twice(&mut self, name: &Name, at: Span, first: Span) {
        let problem = Problem::new(&codes::DEFINED_TWICE, at, say!("`{}` is defined twice", name.text));
        self.problems.push(problem.related(first, say!("defined here first")));
    }

    fn instances(&mut self, i: &'d Instance) {
        let name = &i.chart;
        if name.text.is_empty() {
            return; // The name could not be read; the parser has reported it.
        }
        let Some(chart) = self.charts.get(&*name.text).copied() else {
            return self.no_parameters(name);
        };
        self.used.insert(&chart.name.text);
        let Some(values) = self.values(i, chart) else { return };
        match &i.names {
            InstanceNames::One(own) if self.has_room(i, chart, 1) => {
                self.instance(i, chart, own.clone(), &values)
            }
            InstanceNames::One(_) => {}
            InstanceNames::Range(least, most) => {
                let Some((first, last)) = self.bounds(chart, least, most) else { return };
                let count = usize::try_from(last.abs_diff(first)).unwrap_or(usize::MAX).saturating_add(1);
                if !self.has_room(i, chart, count) {
                    return;
                }
                let mut values = [vec![None], values].concat();
                for n in first..=last {
                    let own = Name::new(format!("{}[{n}]", name.text), name.at.0);
                    let kind = ExprKind::Literal(Literal::Int(i128::from(n), None));
                    if let Some(index) = values.first_mut() {
                        *index = Some(Expr { kind, at: least.at });
                    }
                    self.instance(i, chart, own, &values);
                }
            }
        }
    }

    /// Reports a problem if so many instances more are too large to hold.
    fn has_room(&mut self, i: &Instance, chart: &Chart, count: usize) -> bool {
        let places: usize =
            self.layouts.get(&*chart.name.text).map_or(0, |all| all.iter().map(|l| length(l.at.0)).sum());
        let fits = self.room.takes(length(chart.at.0) + places, count);
        if !fits {
            let what = say!("the charts of all instances together have more than {MOST} MiB of text");
            self.problems.push(Problem::new(&codes::TOO_LARGE, i.at.0, what));
        }
        fits
    }

    fn no_parameters(&mut self, name: &Name) {
        let problem = match self.plain.get(&*name.text) {
            Some(at) => {
                let what = say!("the chart `{}` has no parameters, so it has no instances", name.text);
                Problem::new(&codes::WRONG_KIND, name.at.0, what)
                    .related(*at, say!("declared here"))
                    .help(say!("write `chart {}(i : INT) {{ … }}`", name.text))
            }
            None => {
                let what = say!("there is no chart `{}`", name.text);
                Problem::new(&codes::UNKNOWN_CHART, name.at.0, what)
            }
        };
        self.problems.push(problem);
    }

    /// The first and the last number of a range.
    fn bounds(&mut self, chart: &Chart, least: &Expr, most: &Expr) -> Option<(i64, i64)> {
        if let Some(index) = chart.params.first()
            && !index.ty.base.is_integer()
        {
            let what = say!(
                "the numbers of a range are values of `{}`, which is a {} and no whole number",
                index.name.text,
                index.ty.base
            );
            let problem = Problem::new(&codes::WRONG_TYPE, least.at.0, what);
            self.problems.push(problem.related(index.name.at.0, say!("declared here")));
            return None;
        }
        let (first, last) = (self.bound(least)?, self.bound(most)?);
        if first > last {
            let what = say!("the range {first}..{last} has no numbers");
            self.problems.push(Problem::new(&codes::EMPTY_RANGE, least.at.0, what));
            return None;
        }
        Some((first, last))
    }

    fn bound(&mut self, e: &Expr) -> Option<i64> {
        let constant = |path: &Path| match path.names.as_slice() {
            [name] => self.constants.get(&*name.text).copied(),
            _ => None,
        };
        let value = match &e.kind {
            ExprKind::Path(path) => constant(path),
            kind => kind.whole(),
        };
        let value = value.and_then(|v| i64::try_from(v).ok());
        if value.is_none() && e.is_read() {
            let what =
                say!("the bounds of a range are whole numbers, or constants of the file that are such");
            self.problems.push(Problem::new(&codes::NOT_CONSTANT, e.at.0, what));
        }
        value
    }

    /// The value of each parameter in their order, without the first one in a range.
    fn values(&mut self, i: &Instance, chart: &Chart) -> Option<Vec<Option<Expr>>> {
        let given = usize::from(matches!(i.names, InstanceNames::Range(..)));
        let params = chart.params.get(given..).unwrap_or_default();
        let mut values = vec![None; params.len()];
        let before = self.problems.len();
        for (place, arg) in i.args.iter().enumerate() {
            let place = match &arg.name {
                Some(name) => params.iter().position(|p| p.name.text == name.text),
                None => Some(place).filter(|p| *p < params.len()),
            };
            match place.and_then(|p| values.get_mut(p)) {
                Some(value @ None) if !arg.output => *value = Some(arg.value.clone()),
                place => {
                    let again = place.is_some() && !arg.output;
                    self.wrong_argument(chart, arg, again);
                }
            }
        }
        for (value, param) in values.iter().zip(params) {
            if value.is_none() {
                let what = say!("the parameter `{}` of `{}` has no value", param.name.text, chart.name.text);
                let problem = Problem::new(&codes::WRONG_ARGUMENTS, i.chart.at.0, what);
                self.problems.push(problem.related(param.name.at.0, say!("declared here")));
            }
        }
        for arg in &i.args {
            self.captured(chart, &arg.value);
        }
        (self.problems.len() == before).then_some(values)
    }

    fn wrong_argument(&mut self, chart: &Chart, arg: &Arg, again: bool) {
        let what = match &arg.name {
            Some(name) if again => say!("`{}` has two values", name.text),
            Some(name) => {
                say!("`{}` has no parameter `{}` that can be given here", chart.name.text, name.text)
            }
            None if again => say!("this parameter of `{}` has two values", chart.name.text),
            None => say!("`{}` has fewer parameters", chart.name.text),
        };
        let at = arg.name.as_ref().map_or(arg.value.at.0, |n| n.at.0);
        let problem = Problem::new(&codes::WRONG_ARGUMENTS, at, what);
        self.problems.push(problem.related(chart.name.at.0, say!("declared here")));
    }

    /// Reports a name in the value of a parameter that means another thing inside of the chart. A parameter can be
    /// named in it, unless the file has that name as well.
    fn captured(&mut self, chart: &Chart, value: &Expr) {
        let mut names = Names(Vec::new());
        names.expr(value);
        for name in names.0 {
            let own = chart.vars().flat_map(|v| &v.names);
            let parameters = chart.params.iter().map(|p| &p.name).filter(|_| self.file.contains(&*name.text));
            if let Some(own) = own.chain(parameters).find(|n| n.text == name.text) {
                let what = say!("`{}` also has a meaning in the chart `{}`", name.text, chart.name.text);
                let problem = Problem::new(&codes::DEFINED_TWICE, name.at.0, what);
                let help = say!(
                    "a name in the value of a parameter is one of the file; give one of the two another name"
                );
                self.problems.push(problem.related(own.at.0, say!("declared here")).help(help));
            }
        }
    }

    fn instance(&mut self, i: &Instance, chart: &'d Chart, own: Name, values: &[Option<Expr>]) {
        if own.text.is_empty() {
            return; // The name could not be read; the parser has reported it.
        }
        let first = self.named.get(&own.text).or_else(|| self.plain.get(&*own.text)).copied();
        let first = first.or_else(|| self.charts.get(&*own.text).map(|c| c.name.at.0));
        if let Some(first) = first {
            let at = match i.names {
                InstanceNames::One(_) => own.at.0,
                InstanceNames::Range(..) => i.at.0,
            };
            return self.defined_twice(&own, at, first);
        }
        self.named.insert(own.text.clone(), own.at.0);
        let layouts = self.layouts.get(&*chart.name.text).into_iter().flatten();
        let layouts = layouts.map(|l| {
            let chart = Name::new(own.text.clone(), l.chart.at.0);
            Item::Layout(Layout { chart, ..(*l).clone() })
        });
        // The places of the one drawing are those of each instance.
        self.items.extend(layouts);
        let constants = chart.params.iter().zip(values).map(|(p, v)| constant(p, v.clone()));
        let mut items: Vec<ChartItem> = constants.map(ChartItem::Var).collect();
        items.extend(chart.items.iter().cloned());
        let mut made = Chart {
            // The drawing of all instances is the one chart: problems and references lead there.
            name: Name::new(own.text, chart.name.at.0),
            params: Vec::new(),
            block: None,
            comment: i.comment.clone().or_else(|| chart.comment.clone()),
            items,
            kind: chart.kind,
            every: chart.every,
            at: chart.at,
        };
        let numbers = chart.params.iter().zip(values).filter_map(|(p, v)| {
            let number = i64::try_from(v.as_ref()?.kind.whole()?).ok()?;
            Some((&*p.name.text, number))
        });
        let mut numbered = Numbered { numbers: numbers.collect(), charts: &self.charts };
        visit_mut::chart(&mut made, &mut numbered);
        for item in made.items.iter_mut() {
            if let ChartItem::Var(v) = item {
                v.init.iter_mut().chain(&mut v.safe).for_each(|e| visit_mut::expr(e, &mut numbered));
            }
        }
        self.items.push(Item::Chart(made));
    }

    fn unused(&mut self, document: &Document) {
        if document.items.iter().any(|i| matches!(i, Item::Instance(i) if i.chart.text.is_empty())) {
            return;
        }
        for chart in document.charts().filter(|c| !c.params.is_empty()) {
            if self.used.contains(&*chart.name.text) {
                continue;
            }
            let name = &chart.name.text;
            let what = say!("the chart `{name}` has parameters and no instance, so it never runs");
            let problem = Problem::new(&codes::CHART_UNUSED, chart.name.at.0, what);
            self.problems
                .push(problem.help(say!("write `instance {name}[1..6]` or `instance Left : {name}(1)`")));
        }
    }
}

/// A parameter as a constant of its instance.
fn constant(param: &Param, value: Option<Expr>) -> VarDecl {
    let plain = VarDecl::of_type(VarKind::Const, vec![param.name.clone()], &param.ty, param.name.at);
    VarDecl { init: value, ..plain }
}

/// The first names of all paths of an expression.
struct Names<'d>(Vec<&'d Name>);

impl<'d> Reader<'d> for Names<'d> {
    fn path(&mut self, names: &'d [Name]) {
        self.0.extend(names.first());
    }

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}
}

/// Puts the number of a parameter into the names of instances: `Axis[i + 1]` becomes `Axis[4]`. Outside of
/// instances there are no parameters.
struct Numbered<'n, 'd> {
    numbers: HashMap<&'d str, i64>,
    charts: &'n HashMap<&'d str, &'d Chart>,
}

impl Visitor for Numbered<'_, '_> {
    /// The parser reads an instance as an argument, `INITCHART(Axis[3])`, as an element of an array.
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Element(path, index, None) = &e.kind else { return };
        let ([name], [index]) = (path.names.as_slice(), index.as_slice()) else { return };
        if !self.charts.contains_key(&*name.text) {
            return;
        }
        let number = match &index.kind {
            ExprKind::Path(path) if path.names.len() == 1 => self.numbers.get(&*path.text()).copied(),
            kind => kind.whole().and_then(|n| i64::try_from(n).ok()),
        };
        if let Some(number) = number {
            let name = Name::new(format!("{}[{number}]", name.text), name.at.0);
            e.kind = ExprKind::Path(Path { names: vec![name] });
        }
    }

    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        if path.names.len() > 1 {
            path.names.first_mut().into_iter().for_each(|n| self.chart_name(n));
        }
    }

    fn chart_name(&mut self, name: &mut Name) {
        let numbered = |part: &str| {
            let (chart, Index::Parameter(parameter, added)) = instance_of(part)? else { return None };
            let number = self.numbers.get(parameter)?.checked_add(added)?;
            Some(format!("{chart}[{number}]"))
        };
        let parts: Vec<&str> = name.text.split('.').collect();
        let new: Vec<Option<String>> = parts.iter().map(|p| numbered(p)).collect();
        if new.iter().any(Option::is_some) {
            let joined = parts.into_iter().zip(new).map(|(part, new)| new.unwrap_or_else(|| part.to_owned()));
            name.text = joined.collect::<Vec<_>>().join(".").into();
        }
    }

    fn all_bodies(&self) -> bool {
        true
    }
}
