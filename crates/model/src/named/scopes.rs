//! The meaning of names for the checks: enumerations and their values, and the values that each variable can have.

use std::collections::HashMap;

use super::declare::numbered;
use crate::{ChartItem, Document, Item, Limits, Name, Path, Type, VarDecl, VarKind, normal_address};

/// The values that a variable can have.
#[derive(Clone, Copy, Debug)]
pub(super) enum Admits<'d> {
    /// All values of its type.
    All,
    /// The values of this enumeration.
    Values(&'d str),
    /// The whole numbers within bounds, of this type.
    Range(i128, i128, Type),
}

/// A variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Var<'d> {
    pub(super) admits: Admits<'d>,
    pub(super) array: bool,
    /// Of an instance of a function block of the file that stays, this.
    of: Option<&'d str>,
    /// Of a constant with a written number, that.
    pub(super) number: Option<i128>,
}

/// The meaning of a name.
pub(super) enum Found<'d> {
    /// A variable. The flag is true if the path goes on behind it, to a bit or a member.
    Var(Var<'d>, bool),
    /// A value of an enumeration, and its number.
    Value(&'d str, i128),
    /// An enumeration that has no such value.
    NoValue(&'d str),
    /// A value of two enumerations.
    Both(&'d str, &'d str),
    /// Something else.
    Other,
}

/// Where an expression stands.
#[derive(Clone, Copy)]
pub(super) struct Around<'e> {
    pub(super) chart: Option<&'e str>,
    /// The local variables. They hide other names, and they are plain: none is of a declared type.
    pub(super) locals: &'e [Box<str>],
}

type Vars<'d> = HashMap<&'d str, Var<'d>>;

/// The enumerations and variables of a document.
pub(super) struct Scopes<'d> {
    file: Vars<'d>,
    charts: HashMap<&'d str, Vars<'d>>,
    /// The members of the function blocks that stay.
    blocks: HashMap<&'d str, Vars<'d>>,
    /// The variables with limits that have a direct address, by that.
    addresses: HashMap<String, Var<'d>>,
    pub(super) enumerations: HashMap<&'d str, Vec<(&'d Name, i128)>>,
    /// Each value, with the enumerations that have it.
    values: HashMap<&'d str, Vec<(&'d str, i128)>>,
}

impl<'d> Scopes<'d> {
    pub(super) fn of(document: &'d Document) -> Scopes<'d> {
        let mut made = Scopes {
            file: HashMap::new(),
            charts: HashMap::new(),
            blocks: HashMap::new(),
            addresses: HashMap::new(),
            enumerations: HashMap::new(),
            values: HashMap::new(),
        };
        for item in &document.items {
            match item {
                Item::Type(t) => made.enumeration(t),
                Item::Composed(c) => {
                    let vars = made.blocks.entry(&*c.name.text).or_default();
                    c.members.iter().chain(&c.inouts).for_each(|m| declare(vars, m));
                }
                Item::Var(v) => {
                    declare(&mut made.file, v);
                    made.place(v);
                }
                Item::Chart(c) => {
                    let vars = made.charts.entry(&*c.name.text).or_default();
                    for item in &c.items {
                        if let ChartItem::Var(v) = item {
                            declare(vars, v);
                        }
                    }
                    c.vars().for_each(|v| made.place(v));
                }
                _ => {}
            }
        }
        made
    }

    fn place(&mut self, v: &'d VarDecl) {
        let address = v.address.as_ref().filter(|a| v.limits.is_some() && a.text.starts_with('%'));
        if let Some(address) = address {
            let var = Var { admits: admits(v), array: false, of: None, number: None };
            self.addresses.entry(normal_address(&address.text)).or_insert(var);
        }
    }

    /// The variable with limits at a direct address, and true if only a bit of it is meant.
    pub(super) fn at_address(&self, text: &str) -> Option<(Var<'d>, bool)> {
        let (word, bit) = text.split_once(':').map_or((text, false), |(word, _)| (word, true));
        self.addresses.get(&normal_address(word)).map(|var| (*var, bit))
    }

    fn enumeration(&mut self, t: &'d VarDecl) {
        let Some(name) = t.names.first() else { return };
        // A value whose number is wrong has been reported.
        let all: Vec<(&Name, i128)> =
            numbered(t.values()).into_iter().map(|(name, number)| (name, number.unwrap_or(0))).collect();
        for (value, number) in &all {
            let of = self.values.entry(&*value.text).or_default();
            if of.iter().all(|(before, _)| **before != *name.text) {
                of.push((&name.text, *number));
            }
        }
        self.enumerations.insert(&name.text, all);
    }

    /// The meaning of a path.
    pub(super) fn find(&self, path: &Path, around: Around<'_>) -> Found<'d> {
        let names = path.names.as_slice();
        let Some(first) = names.first().map(|n| &*n.text) else { return Found::Other };
        if around.locals.iter().any(|l| **l == *first) {
            return Found::Other;
        }
        let own = around.chart.and_then(|c| self.charts.get(c)?.get(first)).or_else(|| self.file.get(first));
        if let Some(var) = own {
            return self.behind(*var, names.get(1..).unwrap_or_default());
        }
        match names {
            [value] => match self.values.get(&*value.text).map(Vec::as_slice) {
                Some([(ty, number)]) => Found::Value(ty, *number),
                Some([(one, _), (other, _), ..]) => Found::Both(one, other),
                Some([]) | None => Found::Other,
            },
            [ty, value, ..] => {
                if let Some((ty, values)) = self.enumerations.get_key_value(&*ty.text) {
                    let number = values.iter().find(|(name, _)| name.text == value.text).map(|(_, n)| *n);
                    return match number {
                        Some(number) if names.len() == 2 => Found::Value(ty, number),
                        Some(_) => Found::Other,
                        None => Found::NoValue(ty),
                    };
                }
                match self.charts.get(&*ty.text).and_then(|vars| vars.get(&*value.text)) {
                    Some(var) => self.behind(*var, names.get(2..).unwrap_or_default()),
                    None => Found::Other,
                }
            }
            [] => Found::Other,
        }
    }

    /// A variable, or what the names behind it mean.
    fn behind(&self, var: Var<'d>, names: &[Name]) -> Found<'d> {
        let members = var.of.and_then(|of| self.blocks.get(of));
        let member = members.zip(names.first()).and_then(|(members, name)| members.get(&*name.text));
        match member {
            Some(member) => Found::Var(*member, names.len() > 1),
            None => Found::Var(var, !names.is_empty()),
        }
    }

    /// The enumeration of a parameter of the function block that a path calls.
    pub(super) fn parameter(&self, instance: &Path, name: &Name, around: Around<'_>) -> Option<&'d str> {
        let path = Path { names: instance.names.iter().chain([name]).cloned().collect() };
        match self.find(&path, around) {
            Found::Var(Var { admits: Admits::Values(ty), .. }, false) => Some(ty),
            _ => None,
        }
    }

    /// The names of the values of an enumeration.
    pub(super) fn names_of(&self, ty: &str) -> Vec<&'d str> {
        self.enumerations.get(ty).map_or(Vec::new(), |all| all.iter().map(|(name, _)| &*name.text).collect())
    }
}

fn declare<'d>(vars: &mut Vars<'d>, v: &'d VarDecl) {
    let number = v.init.as_ref().filter(|_| v.kind == VarKind::Const).and_then(|e| e.kind.whole());
    let of = v.of.as_ref().map(|of| &*of.text);
    let var = Var { admits: admits(v), array: v.array.is_some(), of, number };
    for name in &v.names {
        vars.entry(&*name.text).or_insert(var);
    }
}

/// The values that the variables of a declaration can have.
pub(super) fn admits(v: &VarDecl) -> Admits<'_> {
    match (v.limits.as_deref(), v.range()) {
        (Some(Limits::Of(name)), _) => Admits::Values(&name.text),
        (_, Some((least, most))) => Admits::Range(least, most, v.ty),
        _ => Admits::All,
    }
}
