//! Variables with a structure of the file, which stay one variable with a type of `TYPE … END_TYPE`.
//!
//! Up to here each member is a variable of its own, `m.speed` (see [`g7_model::composed::with_blocks`]). While the document
//! is rewritten, the members of a variable that stays get names with a point, and at the end their declarations become
//! one. So a member can stand wherever a variable can, except where an action drives one: the association of an action
//! names a variable of the program and no member (IEC 61131-3:2003, 2.6.4.3). Variables of which a step drives a member are
//! taken apart, and so are constants, because functions take the numbers in their places.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::{
    Arg, Array, ChartItem, Composed, Document, Expr, ExprKind, Item, Name, Path, Place, Problem, Span, Type,
    VarDecl, VarKind, bare, composed::DEEP, with_slot,
};

use super::blocks::{Blocks, typed};
use super::enumerations::Enumerations;
use super::form::Form;
use super::identifiers::Names;
use crate::report::renamed;
use crate::scopes::{Scopes, VarKey};

/// The structures of a document.
pub(super) struct Structures<'d> {
    types: BTreeMap<&'d str, Structure<'d>>,
    form: Form,
    /// The members whose names had to be changed, see [`Names::renamed`].
    changed: Vec<(Span, Box<str>, String)>,
}

/// A structure with its new names.
struct Structure<'d> {
    of: &'d Composed,
    name: Name,
    members: Vec<Member<'d>>,
}

/// A member of a structure.
struct Member<'d> {
    old: &'d str,
    new: Name,
    decl: &'d VarDecl,
    /// The initial values that the structure gives, of its own or those of the types of its members: of an array one for
    /// each element, else one.
    usual: Vec<Expr>,
    /// The new name of its type, if that is an enumeration that stays.
    enumeration: Option<Name>,
}

/// A member of a type that is no structure, somewhere within a structure.
struct Leaf<'s, 'd> {
    /// The names that lead to it, each behind a point: `.gears[].ratio`.
    old: String,
    new: String,
    decl: &'d VarDecl,
    /// The number of indexes, those of the member itself included.
    indexes: usize,
    usual: &'s [Expr],
}

impl<'d> Structures<'d> {
    /// The structures of a document, with the names that `blocks` has for them.
    pub(super) fn of(document: &'d Document, blocks: &Blocks, form: Form) -> Structures<'d> {
        let mut made = Structures { types: BTreeMap::new(), form, changed: Vec::new() };
        for of in document.composed().filter(|c| !c.block) {
            let mut names = Names::new(0, form.words());
            let mut members = Vec::new();
            for (decl, name) in of.members.iter().flat_map(|decl| decl.names.iter().map(move |n| (decl, n))) {
                let new = Name::new(names.give(None, name, "", ""), name.at.0);
                members.push(Member { old: &name.text, new, decl, usual: usual(decl), enumeration: None });
            }
            made.changed.append(&mut names.renamed);
            made.types.insert(&of.name.text, Structure { of, name: blocks.named(&of.name), members });
        }
        made
    }

    /// Puts the names of values in the places of their numbers.
    pub(super) fn name_values(&mut self, enumerations: &Enumerations) {
        for member in self.types.values_mut().flat_map(|t| &mut t.members) {
            member.enumeration = enumerations.of_member(member.decl, &mut member.usual);
        }
    }

    /// The problem of the members whose names had to be changed.
    pub(super) fn changed(&self) -> Option<Problem> {
        renamed(&self.changed)
    }

    /// True if the document has no structures.
    pub(super) fn is_empty(&self) -> bool {
        self.types.is_empty()
    }

    fn get(&self, name: &str) -> Option<&Structure<'d>> {
        self.types.get(name)
    }

    /// The new name of the type of a member, if the file declares it.
    fn type_of<'m>(&'m self, m: &'m Member<'d>) -> Option<&'m Name> {
        match &m.decl.of {
            Some(of) => Some(&self.get(&of.text)?.name),
            None => m.enumeration.as_ref(),
        }
    }

    /// All members of a type, and of the structures within it.
    fn leaves(&self, of: &str) -> Vec<Leaf<'_, 'd>> {
        let mut all = Vec::new();
        self.leaves_below(of, &Below::default(), &mut all);
        all
    }

    fn leaves_below<'s>(&'s self, of: &str, below: &Below, all: &mut Vec<Leaf<'s, 'd>>) {
        let Some(structure) = self.get(of).filter(|_| below.depth < DEEP) else { return };
        for m in &structure.members {
            let indexes = below.indexes + dimensions(m.decl);
            let (old, new) = (format!("{}.{}", below.old, m.old), format!("{}.{}", below.new, m.new.text));
            match &m.decl.of {
                Some(inner) => {
                    let (old, new) =
                        (with_slot(&old, dimensions(m.decl)), with_slot(&new, dimensions(m.decl)));
                    let inside = Below { old, new, indexes, depth: below.depth + 1 };
                    self.leaves_below(&inner.text, &inside, all);
                }
                None => all.push(Leaf { old, new, decl: m.decl, indexes, usual: &m.usual }),
            }
        }
    }

    /// Replaces the declarations of the members of a variable by one declaration, and puts the structures before all other
    /// items. At this time the name of a member that stays has a point.
    pub(super) fn joined(&self, document: &mut Document) {
        let mut used = BTreeSet::new();
        self.join(
            &mut document.items,
            |i| if let Item::Var(v) = i { Some(v) } else { None },
            Item::Var,
            &mut used,
        );
        for item in &mut document.items {
            match item {
                Item::Chart(c) => self.join(
                    &mut c.items,
                    |i| if let ChartItem::Var(v) = i { Some(v) } else { None },
                    ChartItem::Var,
                    &mut used,
                ),
                Item::Composed(c) => self.join(&mut c.members, |v| Some(v), |v| v, &mut used),
                _ => {}
            }
        }
        let mut types = Vec::new();
        let mut seen = BTreeSet::new();
        used.iter().for_each(|name| self.declare(name, &mut seen, &mut types));
        document.items.splice(1..1, types.into_iter().map(Item::Composed));
    }

    /// The same in one list. Each variable stands in the place of its first member.
    fn join<T>(
        &self,
        items: &mut Vec<T>,
        get: fn(&T) -> Option<&VarDecl>,
        put: fn(VarDecl) -> T,
        used: &mut BTreeSet<Box<str>>,
    ) {
        let mut found: BTreeMap<String, Parts> = BTreeMap::new();
        for v in items.iter().filter_map(get) {
            if let Some((root, member)) = parted(v) {
                found.entry(root.to_owned()).or_default().insert(member.to_owned(), v.clone());
            }
        }
        let all = std::mem::take(items);
        for item in all {
            let Some(root) = get(&item).and_then(parted).map(|(root, _)| root.to_owned()) else {
                items.push(item);
                continue;
            };
            if let Some(parts) = found.remove(&root) {
                items.extend(self.variable(&root, &parts, used).map(put));
            }
        }
    }

    /// The declaration of a variable, of which these are the members.
    fn variable(&self, root: &str, parts: &Parts, used: &mut BTreeSet<Box<str>>) -> Option<VarDecl> {
        let first = parts.values().next()?;
        let of = first.part_of.as_ref()?;
        used.insert(of.text.clone());
        let (name, _) = bare(root);
        let bounds: Vec<(Expr, Expr)> = match slots(root) {
            0 => Vec::new(),
            n => first.array.as_ref()?.dimensions.iter().take(n).cloned().collect(),
        };
        let count = size(&bounds);
        // If matiec reads the declaration, the values are those of the type.
        let init = if self.form.is_of_matiec() {
            None
        } else {
            let given: Given = parts.iter().map(|(behind, v)| (&**behind, values(v))).collect();
            let whole = One { n: 0, all: false };
            let values = whole.within(count, |one| self.value(&of.text, "", one, &given, first.at));
            initial(values, !bounds.is_empty(), first.at)
        };
        let own: HashSet<&str> =
            self.leaves(&of.text).iter().filter_map(|l| l.decl.comment.as_deref()).collect();
        let comment = parts.values().find_map(|v| v.comment.clone().filter(|c| !own.contains(&**c)));
        let at = first.names.first()?.at;
        let array = (!bounds.is_empty()).then(|| Box::new(Array { dimensions: bounds, at }));
        Some(VarDecl {
            array,
            of: Some(Box::new(self.get(&of.text)?.name.clone())),
            init,
            retain: first.retain,
            comment,
            ..VarDecl::new(first.kind, vec![Name { text: name.into(), at }], Type::Bool, first.at)
        })
    }

    /// The initial value of one structure; `behind` are the names that lead to it. It names the members whose values are not
    /// those of the type, or all members if `one.all`. None if it would name no member.
    fn value(&self, of: &str, behind: &str, one: One, given: &Given<'_>, at: Place) -> Option<Expr> {
        let mut fields = Vec::new();
        for m in &self.get(of)?.members {
            let path = format!("{behind}.{}", m.new.text);
            let bounds = m.decl.array.as_ref().map_or(&[][..], |a| &a.dimensions);
            let each = size(bounds);
            let mut values = match &m.decl.of {
                Some(inner) => {
                    let path = with_slot(&path, bounds.len());
                    let value = |one| self.value(&inner.text, &path, one, given, at);
                    one.within(each, value)
                }
                None => {
                    let all = given.get(&*path).map_or(&[][..], Vec::as_slice);
                    let own = all.get(one.n * each..).and_then(|rest| rest.get(..each)).unwrap_or(&m.usual);
                    if own == m.usual && !one.all { Vec::new() } else { own.to_vec() }
                }
            };
            values.iter_mut().filter(|_| m.decl.of.is_none()).for_each(|e| typed(e, m.decl.ty));
            let value = initial(values, !bounds.is_empty(), at);
            fields.extend(value.map(|value| Arg::input(Some(m.new.clone()), value)));
        }
        let some = !fields.is_empty();
        some.then(|| Expr { kind: ExprKind::Call(Path { names: Vec::new() }, fields), at })
    }

    /// The declaration of a structure behind those of the structures within it.
    fn declare(&self, name: &str, seen: &mut BTreeSet<Box<str>>, made: &mut Vec<Composed>) {
        let Some(structure) = self.get(name).filter(|_| seen.insert(name.into())) else { return };
        let inner = structure.members.iter().filter_map(|m| m.decl.of.as_ref());
        inner.for_each(|inner| self.declare(&inner.text, seen, made));
        let member = |m: &Member<'d>| VarDecl {
            names: vec![m.new.clone()],
            of: self.type_of(m).cloned().map(Box::new),
            limits: None,
            init: m.initial(),
            ..m.decl.clone()
        };
        let members = structure.members.iter().map(member).collect();
        made.push(Composed { name: structure.name.clone(), members, ..structure.of.clone() });
    }
}

impl Member<'_> {
    /// The initial value in the declaration of the structure.
    fn initial(&self) -> Option<Expr> {
        let mut values = self.usual.clone();
        let zero = Expr::zero(self.decl.ty, self.decl.at);
        if values.iter().all(|e| *e == zero) {
            return None;
        }
        values.iter_mut().for_each(|e| typed(e, self.decl.ty));
        initial(values, self.decl.array.is_some(), self.decl.at)
    }
}

/// One element among the structures to which the same names lead.
#[derive(Clone, Copy)]
struct One {
    n: usize,
    /// True if all its members have a value.
    all: bool,
}

impl One {
    /// The values of the `each` structures within this one: nothing if none of them has a value, otherwise a value for each.
    fn within(self, each: usize, value: impl Fn(One) -> Option<Expr>) -> Vec<Expr> {
        let number = |k| One { n: self.n * each + k, all: self.all };
        let values: Vec<Option<Expr>> = (0..each).map(|k| value(number(k))).collect();
        if values.iter().all(Option::is_none) {
            return Vec::new();
        }
        let whole =
            |(k, given): (usize, Option<Expr>)| given.or_else(|| value(One { all: true, ..number(k) }));
        values.into_iter().enumerate().filter_map(whole).collect()
    }
}

/// The initial values in the declaration of a member: of an array one for each element, else one; of a structure none.
fn usual(decl: &VarDecl) -> Vec<Expr> {
    if decl.of.is_some() {
        return Vec::new();
    }
    let bounds = decl.array.as_ref().map_or(&[][..], |a| &a.dimensions);
    let zero = || decl.usual.as_deref().cloned().unwrap_or_else(|| Expr::zero(decl.ty, decl.at));
    let mut all = values(decl);
    all.resize_with(size(bounds), zero);
    all
}

/// The members of a variable, by the names that lead to them.
type Parts = BTreeMap<String, VarDecl>;

/// The initial values of each of these members: of an array one for each element.
type Given<'p> = HashMap<&'p str, Vec<Expr>>;

/// The names above the members of a structure.
#[derive(Default)]
struct Below {
    old: String,
    new: String,
    indexes: usize,
    depth: usize,
}

/// The variables of a document that stay one variable each.
#[derive(Default)]
pub(super) struct Whole<'d> {
    /// The names behind the variable that lead to each of their members there.
    members: HashMap<VarKey<'d>, String>,
}

impl<'d> Whole<'d> {
    /// Finds the variables with a structure that can stay one variable. A variable cannot if one of its members is in `apart`.
    pub(super) fn of(
        document: &'d Document,
        scopes: &Scopes<'d>,
        structures: &Structures<'_>,
        apart: impl Iterator<Item = VarKey<'d>>,
    ) -> Whole<'d> {
        let mut found: BTreeMap<VarKey<'d>, Vec<&'d VarDecl>> = BTreeMap::new();
        let of_file =
            document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some((None, v)) } else { None });
        let charts = scopes.charts.iter().enumerate();
        let of_charts = charts.flat_map(|(n, c)| c.vars().map(move |v| (Some(n), v)));
        for (chart, v) in of_file.chain(of_charts) {
            if let Some((root, _)) = parted(v) {
                found.entry((chart, root)).or_default().push(v);
            }
        }
        let apart: HashSet<VarKey> = apart.map(root).collect();
        let mut whole = Whole::default();
        for (key, members) in found.into_iter().filter(|(key, _)| !apart.contains(key)) {
            whole.members.extend(stays(key, &members, structures).into_iter().flatten());
        }
        whole
    }

    /// If the set has one member of a variable that stays, this adds all other members of that variable.
    pub(super) fn all_or_none(&self, keys: &mut HashSet<VarKey<'d>>) {
        let roots: HashSet<VarKey> =
            keys.iter().filter(|k| self.members.contains_key(*k)).map(|k| root(*k)).collect();
        keys.extend(self.members.keys().filter(|k| roots.contains(&root(**k))));
    }

    /// For a member of a variable that stays: the name of the variable, the place of its indexes, and the names behind it.
    pub(super) fn member(&self, key: VarKey<'d>) -> Option<(&'d str, &'d str, &str)> {
        let behind = self.members.get(&key)?;
        let (name, slot) = bare(root(key).1);
        Some((name, slot, behind))
    }
}

/// The members of a variable with the names that lead to them there; None if the variable cannot stay.
fn stays<'d>(
    root: VarKey<'d>,
    members: &[&'d VarDecl],
    structures: &Structures<'_>,
) -> Option<Vec<(VarKey<'d>, String)>> {
    let first = members.first()?;
    let leaves = structures.leaves(&first.part_of.as_ref()?.text);
    let by_name: HashMap<&str, &VarDecl> = members.iter().filter_map(|v| Some((parted(v)?.1, *v))).collect();
    let outer = slots(root.1);
    let alike = |v: &VarDecl| {
        let free = v.address.is_none() && v.safe.is_none() && !v.inverted;
        free && v.kind == first.kind && v.retain == first.retain && v.kind != VarKind::Const
    };
    let text = |ty: Type| matches!(ty, Type::String(_)) && ty != Type::STRING;
    // matiec has no lengths of texts in a structure, and takes no initial value of one but its first member's.
    let of_matiec = structures.form.is_of_matiec();
    let takes = |leaf: &Leaf<'_, '_>, v: &VarDecl| {
        !of_matiec
            || !text(leaf.decl.ty) && values(v).chunks(leaf.usual.len().max(1)).all(|own| own == leaf.usual)
    };
    let fits = |leaf: &Leaf<'_, '_>| {
        let written = |(low, high): &(Expr, Expr)| low.kind.whole().is_some() && high.kind.whole().is_some();
        let known = |v: &VarDecl| v.array.iter().flat_map(|a| &a.dimensions).all(written);
        by_name.get(&*leaf.old).is_some_and(|v| {
            v.ty == leaf.decl.ty
                && dimensions(v) == outer + leaf.indexes
                && alike(v)
                && known(v)
                && known(leaf.decl)
                && takes(leaf, v)
        })
    };
    if leaves.len() != members.len() || !leaves.iter().all(fits) {
        return None;
    }
    let named = |leaf: Leaf<'_, '_>| {
        let decl = by_name.get(&*leaf.old)?;
        Some(((root.0, &*decl.names.first()?.text), leaf.new))
    };
    leaves.into_iter().map(named).collect()
}

/// The variable of a member.
fn root((chart, name): VarKey<'_>) -> VarKey<'_> {
    (chart, name.split_once('.').map_or(name, |(root, _)| root))
}

/// The variable in the name of a member of a structure, and what stands behind it: `m[]` and `.speed`.
fn parted(v: &VarDecl) -> Option<(&str, &str)> {
    v.part_of.as_ref()?;
    let name = &*v.names.first()?.text;
    Some(name.split_at(name.find('.')?))
}

fn dimensions(v: &VarDecl) -> usize {
    v.array.as_ref().map_or(0, |a| a.dimensions.len())
}

/// The number of indexes in the name of a variable: 2 for `m[,]`.
fn slots(name: &str) -> usize {
    bare(name).1.chars().filter(|c| matches!(c, '[' | ',')).count()
}

/// The number of elements within bounds; 1 if there are none.
fn size(bounds: &[(Expr, Expr)]) -> usize {
    let one = |(low, high): &(Expr, Expr)| {
        usize::try_from(high.kind.whole()?.checked_sub(low.kind.whole()?)?.checked_add(1)?).ok()
    };
    bounds.iter().map(|b| one(b).unwrap_or(0)).product()
}

/// The values of a declaration, one after the other.
fn values(v: &VarDecl) -> Vec<Expr> {
    match v.init.as_ref().map(|e| (e, &e.kind)) {
        Some((_, ExprKind::List(list))) => {
            list.iter().flat_map(|(n, e)| std::iter::repeat_n(e.clone(), *n as usize)).collect()
        }
        Some((e, _)) => vec![e.clone()],
        None => Vec::new(),
    }
}

/// The initial value of a variable, or of an array with such elements. Equal values that follow one another stand there
/// once.
fn initial(mut values: Vec<Expr>, array: bool, at: Place) -> Option<Expr> {
    if values.is_empty() || !array {
        return values.pop();
    }
    let mut all: Vec<(u32, Expr)> = Vec::new();
    for value in values {
        match all.last_mut().filter(|(_, last)| *last == value) {
            Some((times, _)) => *times += 1,
            None => all.push((1, value)),
        }
    }
    Some(Expr { kind: ExprKind::List(all), at })
}
