//! Puts single variables in the place of arrays.
//!
//! ```text
//! model::Document -> here -> the writer of a format
//! ```
//!
//! `a[2]` becomes `a_2`, because an action of the standard drives a variable and no element. An array of which an
//! element is chosen while the chart runs (`a[i]`), or that is copied as a whole, is open: a format with arrays gets it
//! as an array, and its elements that actions drive as single variables, which a `post` copies into it. For a format
//! without arrays such an element stays as it is, so that the writer reports it at its place. The arrays of a variable with
//! a structure stay all together, so that it can stay one variable there (see [`g7_model::composed::with_blocks`]).

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};

use g7_iec::nodes;
use g7_iec::scopes::{Ref, Scopes, VarKey};
use g7_model::visit::Visitor as Reader;
use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    ActionKind, Block, Body, ChartItem, Document, Expr, ExprKind, Item, Name, Order, Path, Problem, Span,
    Stmt, StmtKind, Target, VarDecl, VarKind, codes, filled, say,
};

/// The name of the variable for each element of an array, by the indexes of the element.
type Elements = BTreeMap<Vec<i128>, Box<str>>;

/// The document with single variables for its arrays, and what is different there. Open arrays stay if `keeps` says that
/// the format has arrays.
pub(crate) fn singled(document: &Document, keeps: bool) -> (Cow<'_, Document>, Vec<Problem>) {
    if !variables(document).any(|(_, v)| v.array.is_some()) {
        return (Cow::Borrowed(document), Vec::new());
    }
    let mut single = Single::of(document, keeps);
    let mut own = document.clone();
    own.items = own.items.into_iter().flat_map(|item| single.item(item)).collect();
    let copies = single.copies();
    if let Some(at) = copies.first().map(|s| s.at.0) {
        let post = Item::Post(Body::St(nodes::block(copies, at)), at.into());
        let place = own.items.iter().position(|i| matches!(i, Item::Post(..))).unwrap_or(own.items.len());
        own.items.insert(place, post);
    }
    (Cow::Owned(own), single.problems)
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
    /// The elements of each array that are single variables: of an open one, those that actions drive.
    arrays: HashMap<VarKey<'d>, Elements>,
    /// The arrays that stay.
    open: HashSet<VarKey<'d>>,
    /// The variables with a structure whose members are variables of their own there, by their names in the names of
    /// members.
    apart: HashSet<VarKey<'d>>,
    locals: Locals<'d>,
    /// The chart that is being rewritten.
    chart: Option<usize>,
    problems: Vec<Problem>,
}

impl<'d> Single<'d> {
    fn of(document: &'d Document, keeps: bool) -> Single<'d> {
        let mut locals = Locals::default();
        locals.document(document);
        let scopes = Scopes::new(document);
        let (arrays, open, apart) = (HashMap::new(), HashSet::new(), HashSet::new());
        let mut made = Single { scopes, arrays, open, apart, locals, chart: None, problems: Vec::new() };
        let uses = if keeps { made.uses(document) } else { Uses::default() };
        made.open.clone_from(&uses.chosen);
        if keeps {
            made.keep_structures(document, &uses);
        }
        let mut taken: HashSet<String> =
            variables(document).flat_map(|(_, v)| &v.names).map(|n| n.text.to_lowercase()).collect();
        for (chart, v) in variables(document) {
            made.chart = chart.and_then(|c| made.scopes.chart_named(c));
            let Some(indexes) = made.indexes(v) else { continue };
            for name in &v.names {
                let key = (made.chart, &*name.text);
                let open = made.open.contains(&key);
                let mut own = indexes.clone();
                if open {
                    own.retain(|i| uses.driven.contains(&(key, i.clone())));
                }
                if uses.chosen.contains(&key) {
                    made.tell(v, name, !own.is_empty() && uses.written.contains(&key));
                }
                let elements = own.into_iter().map(|i| (i.clone(), free(&name.text, &i, &mut taken)));
                made.arrays.insert(key, elements.collect());
            }
        }
        made.chart = None;
        made
    }

    /// Lets the arrays of variables with a structure stay, as far as the structure can: actions drive none of their elements,
    /// and no statement names a member of all elements at once.
    fn keep_structures(&mut self, document: &'d Document, uses: &Uses<'d>) {
        let driven: HashSet<VarKey> = uses.driven.iter().map(|(key, _)| *key).collect();
        let mut arrays = Vec::new();
        for (chart, v) in variables(document).filter(|(_, v)| v.part_of.is_some() && v.array.is_some()) {
            let chart = chart.and_then(|c| self.scopes.chart_named(c));
            for key in v.names.iter().map(|n| (chart, &*n.text)) {
                if driven.contains(&key) || uses.whole.contains(&key) && key.1.contains(']') {
                    self.apart.insert((chart, root(key.1)));
                }
                arrays.push(key);
            }
        }
        let stays = |key: &VarKey<'d>| !self.apart.contains(&(key.0, root(key.1)));
        self.open.extend(arrays.into_iter().filter(stays));
    }

    /// Tells what is different for an array that stays.
    fn tell(&mut self, v: &VarDecl, name: &Name, both: bool) {
        let text = &name.text;
        let mut put = |what| self.problems.push(Problem::new(&codes::DIFFERENT, name.at.0, what));
        if v.kind != VarKind::Const {
            put(say!(
                "an index outside of the bounds of `{text}` is a fault here, and there whatever the PLC does"
            ));
        }
        if both {
            put(say!(
                "elements of `{text}` follow actions and are written by statements as well; the actions come last there"
            ));
        }
    }

    /// How the arrays of a document are used.
    fn uses(&mut self, document: &'d Document) -> Uses<'d> {
        let mut own = document.clone();
        let mut looking = Looking { single: self, found: Uses::default() };
        for item in &mut own.items {
            let chart = if let Item::Chart(c) = &*item { Some(&*c.name.text) } else { None };
            looking.single.chart = chart.and_then(|c| looking.single.scopes.chart_named(c));
            visit_mut::item(item, &mut looking);
            looking.driven(item);
        }
        let found = looking.found;
        self.chart = None;
        found
    }

    /// The array that a path means.
    fn array(&self, path: &Path) -> Option<VarKey<'d>> {
        let Some(Ref::Var(key)) = self.scopes.refer(self.chart, &path.names) else { return None };
        self.scopes.decl(key)?.array.as_ref().map(|_| key)
    }

    /// The assignments that copy the single variables of open arrays into these.
    fn copies(&self) -> Vec<Stmt> {
        let mut list = Vec::new();
        let mut open: Vec<_> = self.arrays.iter().filter(|(key, _)| self.open.contains(*key)).collect();
        open.sort_by_key(|(key, _)| **key);
        for (key, elements) in open {
            let at = self.scopes.decl(*key).map_or(Span::default(), |d| d.at.0);
            let chart = key.0.and_then(|c| self.scopes.chart(c)).map(|c| &*c.name.text);
            let path = |name| nodes::path(&chart.into_iter().chain([name]).collect::<Vec<_>>(), at);
            for (index, single) in elements {
                let index = index.iter().map(|n| nodes::int(*n, at)).collect();
                let element = nodes::expr(ExprKind::Element(Box::new(path(key.1)), index, None), at);
                list.push(nodes::assign(element, nodes::expr(ExprKind::Path(path(single)), at), at));
            }
        }
        list
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
        if v.names.iter().any(|n| self.apart.contains(&(self.chart, root(&n.text)))) {
            v.part_of = None;
        }
        if v.array.is_none() {
            return vec![v];
        }
        v.names.iter().flat_map(|name| self.parts(&v, name)).collect()
    }

    /// An array if it is open, and its elements that are single variables.
    fn parts(&self, v: &VarDecl, name: &Name) -> Vec<VarDecl> {
        let key = (self.chart, &*name.text);
        let (Some(elements), Some(indexes)) = (self.arrays.get(&key), self.indexes(v)) else {
            return Vec::new();
        };
        let mut given: Vec<&Expr> = Vec::new();
        if let Some(ExprKind::List(list)) = v.init.as_ref().map(|e| &e.kind) {
            given.extend(list.iter().flat_map(|(n, e)| std::iter::repeat_n(e, *n as usize)));
        }
        let value = |place: usize| given.get(place).copied().or(v.usual.as_deref()).cloned();
        let mut all = Vec::new();
        let open = self.open.contains(&key);
        if open {
            let init = if v.usual.is_some() {
                let values = (0..indexes.len()).filter_map(value).map(|e| (1, e)).collect();
                Some(nodes::expr(ExprKind::List(values), v.at.0))
            } else {
                v.init.clone()
            };
            all.push(VarDecl { names: vec![name.clone()], of: None, usual: None, init, ..v.clone() });
        }
        for (place, indexes) in indexes.iter().enumerate() {
            let Some(text) = elements.get(indexes) else { continue };
            all.push(VarDecl {
                kind: if open { VarKind::Var } else { v.kind },
                names: vec![Name::new(text.clone(), name.at.0)],
                array: None,
                of: None,
                init: value(place),
                ..v.clone()
            });
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

    fn all_bodies(&self) -> bool {
        true
    }
}

/// How the arrays of a document are used.
#[derive(Default)]
struct Uses<'d> {
    /// Those of which an element is chosen while the chart runs, or that are copied as a whole.
    chosen: HashSet<VarKey<'d>>,
    /// Those that are copied as a whole.
    whole: HashSet<VarKey<'d>>,
    /// The chosen ones that get a value.
    written: HashSet<VarKey<'d>>,
    /// The elements that actions drive.
    driven: HashSet<(VarKey<'d>, Vec<i128>)>,
}

struct Looking<'s, 'd> {
    single: &'s mut Single<'d>,
    found: Uses<'d>,
}

impl Looking<'_, '_> {
    /// Notes the elements that the actions of a chart drive.
    fn driven(&mut self, item: &Item) {
        let Item::Chart(chart) = item else { return };
        for action in chart.steps().flat_map(|s| &s.actions) {
            if let ActionKind::Qualified { target: Target::Element(e), .. } = &action.kind
                && let ExprKind::Element(path, index, _) = &e.kind
                && let Some(key) = self.single.array(path)
                && let Some(index) = index.iter().map(|e| self.single.whole(e)).collect()
            {
                self.found.driven.insert((key, index));
            }
        }
    }

    /// Notes an array that is named as a whole, or by an index that is not known.
    fn whole(&mut self, e: &Expr, how: Use) {
        let (path, open) = match &e.kind {
            ExprKind::Path(path) => (path, true),
            ExprKind::Element(path, index, _) => {
                (&**path, index.iter().any(|e| self.single.whole(e).is_none()))
            }
            _ => return,
        };
        let Some(key) = self.single.array(path).filter(|_| open) else { return };
        self.found.chosen.insert(key);
        if matches!(e.kind, ExprKind::Path(_)) {
            self.found.whole.insert(key);
        }
        if how == Use::Write {
            self.found.written.insert(key);
        }
    }
}

impl Visitor for Looking<'_, '_> {
    fn expr(&mut self, e: &mut Expr) {
        self.whole(e, Use::Read);
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        match &stmt.kind {
            StmtKind::Assign { target, .. } => self.whole(target, Use::Write),
            StmtKind::Call(_, args) => {
                args.iter().filter(|a| a.writes()).for_each(|a| self.whole(&a.value, Use::Write));
            }
            _ => {}
        }
    }

    fn all_bodies(&self) -> bool {
        true
    }
}

/// The variable in the name of a member: `m[]` in `m[].speed`.
fn root(member: &str) -> &str {
    member.split_once('.').map_or(member, |(root, _)| root)
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
    let words: Vec<String> = indexes.iter().map(|n| format!("_{}", g7_iec::words::number(*n))).collect();
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
