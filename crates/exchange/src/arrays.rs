//! Puts single variables in the place of arrays, for formats and tools that have none.
//!
//! ```text
//! model::Document -> here -> the writer of a format
//! ```
//!
//! `a[2]` becomes `a_2`. An element with a variable index (`a[i]`) and the assignment of a whole array stay as they
//! are, so the writer reports them at their place.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use g7_iec::scopes::{Ref, Scopes, VarKey};
use g7_model::visit::Visitor as Reader;
use g7_model::visit_mut::{self, Visitor};
use g7_model::{
    ActionKind, Block, ChartItem, Document, Expr, ExprKind, Item, Name, Order, Path, Span, Target, VarDecl,
    VarKind, filled,
};

/// The name of the variable for each element of an array, by the indexes of the element.
type Elements = HashMap<Vec<i128>, Box<str>>;

/// The document with single variables for its arrays.
pub(crate) fn singled(document: &Document) -> Cow<'_, Document> {
    if !variables(document).any(|(_, v)| v.array.is_some()) {
        return Cow::Borrowed(document);
    }
    let mut single = Single::of(document);
    let mut own = document.clone();
    own.items = own.items.into_iter().flat_map(|item| single.item(item)).collect();
    Cow::Owned(own)
}

/// All declarations, each with the name of its chart.
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

/// Collects the names of the local variables of all blocks.
#[derive(Default)]
struct Locals<'d>(HashSet<&'d str>);

impl<'d> Reader<'d> for Locals<'d> {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}

    fn enter(&mut self, block: &'d Block) {
        self.0.extend(block.locals.iter().flat_map(|l| &l.names).map(|n| &*n.text));
    }
}

struct Single<'d> {
    scopes: Scopes<'d>,
    arrays: HashMap<VarKey<'d>, Elements>,
    locals: Locals<'d>,
    /// The chart that is being rewritten.
    chart: Option<usize>,
}

impl<'d> Single<'d> {
    fn of(document: &'d Document) -> Single<'d> {
        let mut locals = Locals::default();
        locals.document(document);
        let scopes = Scopes::new(document);
        let mut made = Single { scopes, arrays: HashMap::new(), locals, chart: None };
        let mut taken: HashSet<String> =
            variables(document).flat_map(|(_, v)| &v.names).map(|n| n.text.to_lowercase()).collect();
        for (chart, v) in variables(document) {
            made.chart = chart.and_then(|c| made.scopes.chart_named(c));
            let Some(indexes) = made.indexes(v) else { continue };
            for name in &v.names {
                let elements = indexes.iter().map(|i| (i.clone(), free(&name.text, i, &mut taken))).collect();
                made.arrays.insert((made.chart, &name.text), elements);
            }
        }
        made.chart = None;
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

    /// A number that is written, or that of a constant. A name that is also that of a local variable is not
    /// taken for a constant.
    fn whole(&self, e: &Expr) -> Option<i128> {
        let ExprKind::Path(path) = &e.kind else { return e.kind.whole() };
        let hidden = path.names.first().is_none_or(|n| self.locals.0.contains(&*n.text));
        match self.scopes.refer(self.chart, &path.names) {
            Some(Ref::Var(key)) if !hidden => {
                let decl = self.scopes.decl(key).filter(|d| d.kind == VarKind::Const)?;
                decl.init.as_ref()?.kind.whole()
            }
            _ => None,
        }
    }

    fn item(&mut self, item: Item) -> Vec<Item> {
        let mut one = Document::default();
        match item {
            Item::Var(v) => return self.declared(v).into_iter().map(Item::Var).collect(),
            Item::Chart(mut chart) => {
                self.chart = self.scopes.chart_named(&chart.name.text);
                let items = chart.items.into_iter().flat_map(|item| match item {
                    ChartItem::Var(v) => self.declared(v).into_iter().map(ChartItem::Var).collect(),
                    item => vec![item],
                });
                chart.items = items.collect();
                one.items.push(Item::Chart(chart));
            }
            item => one.items.push(item),
        }
        visit_mut::document(&mut one, self);
        self.chart = None;
        one.items.iter_mut().for_each(retarget);
        one.items
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
        let indexes = self.indexes(v).unwrap_or_default();
        let mut all = Vec::new();
        for name in &v.names {
            let Some(elements) = self.arrays.get(&(self.chart, &*name.text)) else { continue };
            for (place, indexes) in indexes.iter().enumerate() {
                let Some(text) = elements.get(indexes) else { continue };
                all.push(VarDecl {
                    names: vec![Name::new(text.clone(), name.at.0)],
                    array: None,
                    of: None,
                    init: given.get(place).map(|e| (*e).clone()).or_else(|| v.usual.as_deref().cloned()),
                    ..v.clone()
                });
            }
        }
        all
    }

    /// The variable that stands for an element with known indexes.
    fn element(&self, path: &Path, index: &[Expr]) -> Option<Path> {
        let indexes: Option<Vec<i128>> = index.iter().map(|e| self.whole(e)).collect();
        let Some(Ref::Var(key)) = self.scopes.refer(self.chart, &path.names) else { return None };
        let text = self.arrays.get(&key)?.get(&indexes?)?;
        let mut names = path.names.clone();
        names.last_mut()?.text = text.clone();
        Some(Path { names })
    }
}

impl Visitor for Single<'_> {
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
    for action in steps.flat_map(|s| &mut s.actions) {
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
    let words: Vec<String> =
        indexes.iter().map(|n| format!("{}{}", if *n < 0 { "_m" } else { "_" }, n.unsigned_abs())).collect();
    // The indexes of a member stand within its name: `m_1.speed` for `m[].speed`.
    let (mut name, within) = filled(array, &words);
    if within > 0 {
        name = name.replace("[_", "_").replace(",_", "_").replace(']', "");
    }
    name.extend(words.into_iter().skip(within));
    while !taken.insert(name.to_lowercase()) {
        name.push('_');
    }
    name.into()
}
