//! The types of a document, and how a variable or a part of one is described while names are replaced.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::{
    Chart, ChartItem, Composed, Document, Expr, ExprKind, Item, Layout, Name, Problem, Said, Span, Type,
    VarDecl, VarKind,
};

/// The variables of all members together, and the statements of all calls together.
pub(super) const MOST: usize = 1 << 16;

/// The variables that are declared in one place.
pub(super) type Scope<'d> = HashMap<&'d str, &'d VarDecl>;

/// The values that the variable of a loop goes through.
pub(super) struct Loop {
    pub(super) name: Box<str>,
    pub(super) least: i128,
    pub(super) most: i128,
}

/// The function blocks that stay, see [`super::blocks`].
#[derive(Clone, Default)]
pub(super) struct Kept {
    pub(super) names: BTreeSet<Box<str>>,
    /// Those of them that cannot stay after all.
    pub(super) refused: BTreeSet<Box<str>>,
    /// True if an instance can have initial values. Otherwise its calls give its inputs the values.
    pub(super) initial: bool,
    /// True if members of structures are marked as such, by [`VarDecl::part_of`].
    pub(super) structures: bool,
}

impl Kept {
    pub(super) fn has(&self, of: &Composed) -> bool {
        self.names.contains(&of.name.text)
    }

    pub(super) fn refuse(&mut self, of: &Composed) {
        self.refused.insert(of.name.text.clone());
    }
}

/// The types of a document, and the variables that can have them.
pub struct Composition<'d> {
    pub(super) types: HashMap<&'d str, &'d Composed>,
    pub(super) file: Scope<'d>,
    pub(super) charts: HashMap<&'d str, Scope<'d>>,
    /// The charts of each function block that has some.
    pub(super) owned: HashMap<&'d str, Vec<&'d Chart>>,
    /// The types with charts: function blocks that have some, and types with a member of such a type.
    pub(super) holders: HashSet<&'d str>,
    /// The places of the elements of charts on the drawing.
    pub(super) layouts: HashMap<&'d str, Vec<&'d Layout>>,
    /// The transition sections of the file.
    pub(super) sections: HashSet<&'d str>,
    /// The types that stand in themselves or too deep in each other. They are reported already.
    pub(super) wrong: HashSet<&'d str>,
    /// The types that hold a function block, their own or one of the standard.
    pub(super) blocks: HashSet<&'d str>,
    /// The names of the other types of the file.
    pub(super) enumerations: HashSet<&'d str>,
    /// Their values.
    values: HashSet<&'d str>,
    /// The types of which there are variables.
    pub(super) used: HashSet<&'d str>,
    /// The function blocks that stay, see [`super::blocks`].
    pub(super) kept: Kept,
    /// How many variables and statements can still be made.
    pub(super) room: usize,
    pub(super) full: bool,
    /// The loops in which the current statement stands.
    pub(super) loops: Vec<Loop>,
    pub(super) problems: Vec<Problem>,
}

/// A name of a path with the indexes behind it.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub(super) name: Name,
    pub(super) index: Vec<Expr>,
}

/// A variable, or a part of one.
#[derive(Clone)]
pub(super) struct Spot<'d> {
    /// The chart that the path names before it.
    pub(super) chart: Option<Name>,
    /// The chart that declares the variable; None for one of the file.
    pub(super) home: Option<Box<str>>,
    /// The name so far, with `[]` for indexes.
    pub(super) text: String,
    /// These indexes.
    pub(super) index: Vec<Expr>,
    /// The indexes behind the name.
    pub(super) own: Vec<Expr>,
    pub(super) decl: &'d VarDecl,
    pub(super) of: Option<&'d Composed>,
    /// The instance of a function block that stays, and the member of it that is meant.
    pub(super) within: Option<(&'d Composed, Name)>,
    /// True if only the function block itself can write it.
    pub(super) inner: bool,
    /// The names behind a variable: a bit, or a member of a function block of the standard.
    pub(super) tail: Vec<Name>,
    /// True if the indexes that are left out mean whole arrays.
    pub(super) whole: bool,
    pub(super) at: Span,
}

impl<'d> Composition<'d> {
    /// The types of a document; None if it has none and no variable names one.
    pub fn of(document: &'d Document) -> Option<Composition<'d>> {
        let vars = |c: &'d Chart| {
            c.items.iter().filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None })
        };
        let concerned = |item: &'d Item| match item {
            Item::Composed(_) => true,
            Item::Var(v) => is_composed(v),
            Item::Chart(c) => c.block.is_some() || vars(c).any(is_composed),
            _ => false,
        };
        if !document.items.iter().any(concerned) {
            return None;
        }
        let mut made = Composition {
            types: HashMap::new(),
            file: HashMap::new(),
            charts: HashMap::new(),
            owned: HashMap::new(),
            holders: HashSet::new(),
            layouts: HashMap::new(),
            sections: HashSet::new(),
            wrong: HashSet::new(),
            blocks: HashSet::new(),
            enumerations: HashSet::new(),
            values: HashSet::new(),
            used: HashSet::new(),
            kept: Kept::default(),
            room: MOST,
            full: false,
            loops: Vec::new(),
            problems: Vec::new(),
        };
        for item in &document.items {
            match item {
                Item::Var(v) => declare(&mut made.file, v),
                Item::Type(t) => {
                    made.enumerations.extend(t.names.first().map(|n| &*n.text));
                    made.values.extend(t.values().iter().map(|(name, _)| &*name.text));
                }
                Item::Section(s) => _ = made.sections.insert(&s.name.text),
                Item::Chart(c) => {
                    let scope = made.charts.entry(&*c.name.text).or_default();
                    vars(c).for_each(|v| declare(scope, v));
                    if let Some(block) = &c.block {
                        made.owned.entry(&*block.text).or_default().push(c);
                    }
                }
                Item::Layout(l) => made.layouts.entry(&*l.chart.text).or_default().push(l),
                _ => {}
            }
        }
        made.types(document);
        made.owners(document);
        Some(made)
    }

    /// An expression that stands outside of all charts, with plain names.
    pub fn query(&mut self, e: &Expr) -> (Expr, Vec<Problem>) {
        let mut e = e.clone();
        // Those of the types are told with the document.
        self.problems.clear();
        self.expr(&mut e, &Env::outside());
        (e, std::mem::take(&mut self.problems))
    }

    /// True if a path in a function block can begin with this name of the file: a section, an enumeration or its value.
    pub(super) fn is_known(&self, name: &str) -> bool {
        self.sections.contains(name) || self.values.contains(name) || self.enumerations.contains(name)
    }

    /// The type of a variable, if it is one that the file declares.
    pub(super) fn type_of(&self, v: &VarDecl) -> Option<&'d Composed> {
        self.types.get(&*v.of.as_ref()?.text).copied()
    }

    pub(super) fn report<T>(&mut self, problem: Problem) -> Option<T> {
        self.problems.push(problem);
        None
    }

    /// Takes room for so many variables or statements; false if there is no more.
    pub(super) fn takes(&mut self, count: usize, at: Span) -> bool {
        match self.room.checked_sub(count) {
            Some(left) => self.room = left,
            None if self.full => {}
            None => {
                (self.full, self.room) = (true, 0);
                self.too_large(at);
            }
        }
        !self.full
    }
}

/// True for a variable of a type that the file declares, and for one with the values of such a type.
fn is_composed(v: &VarDecl) -> bool {
    v.of.is_some() || v.init.as_ref().is_some_and(has_fields)
}

fn declare<'d>(scope: &mut Scope<'d>, v: &'d VarDecl) {
    for name in &v.names {
        scope.entry(&*name.text).or_insert(v);
    }
}

/// True for the members of a function block that each instance has for itself: an index of an array of instances is
/// part of their names.
pub(super) fn is_local(of: &Composed, member: &VarDecl) -> bool {
    let block = member.of.is_none() && matches!(member.ty, Type::Fb(_));
    block || of.block && matches!(member.kind, VarKind::Var | VarKind::Const)
}

/// The names that an expression or statement can see.
pub(super) enum Env<'e, 'd> {
    /// Those of a chart, or of the file alone.
    Outer {
        chart: Option<&'e str>,
        /// Local variables, which hide others.
        locals: Vec<Box<str>>,
        /// Why no function block can be called here.
        uncallable: Option<Said>,
    },
    /// Those of a chart of a function block, of the block and of the file.
    Chart {
        instance: Spot<'d>,
        /// The chart of the block.
        chart: &'d str,
        /// The name of that of the instance.
        full: &'e Name,
        locals: Vec<Box<str>>,
        uncallable: Option<Said>,
    },
    /// Those of a function block.
    Block { instance: Spot<'d>, inouts: HashMap<&'d str, Vec<Segment>>, outer: &'e Env<'e, 'd> },
}

impl<'e, 'd> Env<'e, 'd> {
    /// The names of the file alone.
    pub(super) fn outside() -> Env<'e, 'd> {
        Env::of(None)
    }

    /// The names of a chart and of the file.
    pub(super) fn of(chart: Option<&'e str>) -> Env<'e, 'd> {
        Env::Outer { chart, locals: Vec::new(), uncallable: None }
    }

    /// The same names behind those of a body.
    pub(super) fn within(&self, own: Vec<Box<str>>, why: Option<Said>) -> Env<'e, 'd> {
        match self {
            Env::Outer { chart, .. } => Env::Outer { chart: *chart, locals: own, uncallable: why },
            Env::Chart { instance, chart, full, .. } => {
                Env::Chart { instance: instance.clone(), chart, full, locals: own, uncallable: why }
            }
            // A body stands in no other one.
            Env::Block { outer, .. } => outer.within(own, why),
        }
    }

    /// The instance whose names these are.
    pub(super) fn instance(&self) -> Option<&Spot<'d>> {
        match self {
            Env::Outer { .. } => None,
            Env::Chart { instance, .. } | Env::Block { instance, .. } => Some(instance),
        }
    }

    /// The name of the chart round it all.
    pub(super) fn home(&self) -> Option<&str> {
        match self {
            Env::Outer { chart, .. } => *chart,
            Env::Chart { full, .. } => Some(&full.text),
            Env::Block { outer, .. } => outer.home(),
        }
    }

    /// The chart round it all, and the local variables there.
    pub(super) fn root(&self) -> (Option<&str>, &[Box<str>]) {
        match self {
            Env::Outer { chart, locals, .. } => (*chart, locals),
            Env::Chart { chart, locals, .. } => (Some(chart), locals),
            Env::Block { outer, .. } => outer.root(),
        }
    }

    pub(super) fn uncallable(&self) -> Option<&Said> {
        match self {
            Env::Outer { uncallable, .. } | Env::Chart { uncallable, .. } => uncallable.as_ref(),
            Env::Block { outer, .. } => outer.uncallable(),
        }
    }
}

/// True if an initial value is that of a structure, or a list of such.
pub(super) fn has_fields(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Call(path, _) => path.names.is_empty(),
        ExprKind::List(values) => values.iter().any(|(_, e)| has_fields(e)),
        _ => false,
    }
}
