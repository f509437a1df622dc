//! Puts single variables in the place of arrays, for formats and tools that have none.
//!
//! ```text
//! model::Document -> here -> the writer of a format
//! ```
//!
//! `a[2]` becomes `a_2`. An element that the run chooses (`a[i]`) and the assignment of a whole array stay as
//! they are, so the writer reports them at their place.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Visitor};
use g7_model::{
    ActionKind, ChartItem, Document, Expr, ExprKind, Item, Name, Path, Step, Target, VarDecl, VarKind,
};

/// The chart, or none for the file, and the name of an array.
type Key = (Option<Box<str>>, Box<str>);

/// The elements of an array, each with its indexes and its name.
type Elements = HashMap<Vec<i128>, Box<str>>;

/// A document without arrays, except for elements that the run chooses.
pub(crate) fn singled(document: &Document) -> Cow<'_, Document> {
    if !variables(document).any(|(_, v)| v.array.is_some()) {
        return Cow::Borrowed(document);
    }
    let mut single = Single::of(document);
    let mut own = document.clone();
    own.items = std::mem::take(&mut own.items).into_iter().flat_map(|item| single.item(item)).collect();
    Cow::Owned(own)
}

fn variables(document: &Document) -> impl Iterator<Item = (Option<&str>, &VarDecl)> {
    document.items.iter().flat_map(|item| {
        let (chart, items): (_, &[ChartItem]) = match item {
            Item::Chart(c) => (Some(&*c.name.text), &c.items),
            _ => (None, &[]),
        };
        let file = if let Item::Var(v) = item { Some((None, v)) } else { None };
        let inner =
            items.iter().filter_map(move |i| if let ChartItem::Var(v) = i { Some((chart, v)) } else { None });
        file.into_iter().chain(inner)
    })
}

struct Single {
    arrays: HashMap<Key, Elements>,
    constants: HashMap<Box<str>, i128>,
    chart: Option<Box<str>>,
}

impl Single {
    fn of(document: &Document) -> Single {
        let mut made = Single { arrays: HashMap::new(), constants: HashMap::new(), chart: None };
        let mut taken: HashSet<String> = HashSet::new();
        for (_, v) in variables(document) {
            taken.extend(v.names.iter().map(|n| n.text.to_lowercase()));
            if let (VarKind::Const, Some(n)) = (v.kind, v.init.as_ref().and_then(|e| e.kind.whole())) {
                made.constants.extend(v.names.iter().map(|name| (name.text.clone(), n)));
            }
        }
        for (chart, v) in variables(document) {
            let Some(indexes) = made.indexes(v) else { continue };
            for name in &v.names {
                let elements = indexes.iter().map(|i| (i.clone(), free(&name.text, i, &mut taken))).collect();
                made.arrays.insert((chart.map(Box::from), name.text.clone()), elements);
            }
        }
        made
    }

    /// The indexes of all elements, in their order.
    fn indexes(&self, v: &VarDecl) -> Option<Vec<Vec<i128>>> {
        let mut all: Vec<Vec<i128>> = vec![Vec::new()];
        for (least, most) in &v.array.as_ref()?.dimensions {
            let (least, most) = (self.whole(least)?, self.whole(most)?);
            all = all.iter().flat_map(|a| (least..=most).map(move |n| [&a[..], &[n]].concat())).collect();
        }
        Some(all)
    }

    /// A number that is written, or that of a constant.
    fn whole(&self, e: &Expr) -> Option<i128> {
        match &e.kind {
            ExprKind::Path(path) => self.constants.get(&path.names.last()?.text).copied(),
            kind => kind.whole(),
        }
    }

    fn item(&mut self, item: Item) -> Vec<Item> {
        match item {
            Item::Var(v) => self.declared(v).into_iter().map(Item::Var).collect(),
            Item::Chart(mut chart) => {
                self.chart = Some(chart.name.text.clone());
                chart.items = std::mem::take(&mut chart.items)
                    .into_iter()
                    .flat_map(|item| match item {
                        ChartItem::Var(v) => self.declared(v).into_iter().map(ChartItem::Var).collect(),
                        item => vec![item],
                    })
                    .collect();
                let mut one = Document { items: vec![Item::Chart(chart)], ..Document::default() };
                visit_mut::document(&mut one, self);
                self.chart = None;
                one.items.iter_mut().for_each(retarget);
                one.items
            }
            item => {
                let mut one = Document { items: vec![item], ..Document::default() };
                visit_mut::document(&mut one, self);
                one.items
            }
        }
    }

    /// The declaration, or one for each element.
    fn declared(&mut self, mut v: VarDecl) -> Vec<VarDecl> {
        v.init.iter_mut().chain(&mut v.safe).for_each(|e| visit_mut::expr(e, self));
        if v.array.is_some() { self.elements(&v) } else { vec![v] }
    }

    fn elements(&self, v: &VarDecl) -> Vec<VarDecl> {
        let mut given: Vec<&Expr> = Vec::new();
        if let Some(ExprKind::List(list)) = v.init.as_ref().map(|e| &e.kind) {
            given.extend(list.iter().flat_map(|(n, e)| std::iter::repeat_n(e, *n as usize)));
        }
        let mut all = Vec::new();
        for name in &v.names {
            let Some(elements) = self.arrays.get(&(self.chart.clone(), name.text.clone())) else { continue };
            for (place, indexes) in self.indexes(v).into_iter().flatten().enumerate() {
                let Some(text) = elements.get(&indexes) else { continue };
                all.push(VarDecl {
                    names: vec![Name::new(text.clone(), name.at.0)],
                    array: None,
                    init: given.get(place).map(|e| (*e).clone()),
                    ..v.clone()
                });
            }
        }
        all
    }

    /// The variable that stands for an element with known indexes.
    fn element(&self, path: &Path, index: &[Expr]) -> Option<Path> {
        let indexes: Option<Vec<i128>> = index.iter().map(|e| self.whole(e)).collect();
        let indexes = indexes?;
        let own = |chart: Option<&Box<str>>, name: &Name| {
            self.arrays.get(&(chart.cloned(), name.text.clone()))?.get(&indexes)
        };
        let found = match path.names.as_slice() {
            [name] => own(self.chart.as_ref(), name).or_else(|| own(None, name)),
            [chart, name] => own(Some(&chart.text), name),
            _ => None,
        };
        let mut names = path.names.clone();
        names.last_mut()?.text = found?.clone();
        Some(Path { names })
    }
}

impl Visitor for Single {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Element(path, index, bit) = &e.kind else { return };
        if let Some(mut single) = self.element(path, index) {
            single.names.extend(bit.as_deref().cloned());
            e.kind = ExprKind::Path(single);
        }
    }
}

/// An action on an element drives a variable now.
fn retarget(item: &mut Item) {
    let Item::Chart(chart) = item else { return };
    let steps =
        chart.items.iter_mut().filter_map(|i| if let ChartItem::Step(s) = i { Some(s) } else { None });
    for action in steps.flat_map(|s: &mut Step| &mut s.actions) {
        if let ActionKind::Qualified { target, .. } = &mut action.kind
            && let Target::Element(e) = target
            && let ExprKind::Path(path) = &e.kind
        {
            *target = Target::Path(path.clone());
        }
    }
}

/// `a_1_m2` for `a[1, -2]`, or a name like it that is not taken.
fn free(array: &str, indexes: &[i128], taken: &mut HashSet<String>) -> Box<str> {
    let mut name = array.to_owned();
    for n in indexes {
        name.push_str(if *n < 0 { "_m" } else { "_" });
        name.push_str(&n.unsigned_abs().to_string());
    }
    while !taken.insert(name.to_lowercase()) {
        name.push('_');
    }
    name.into()
}
