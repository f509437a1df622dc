//! The meaning of names for the checks: enumerations and their values, and the values that each variable can have.

use std::collections::HashMap;

use super::declare::numbered;
use crate::{
    Arg, ChartItem, Document, Item, Limits, Name, Path, Type, ValueType, VarDecl, VarKind, normal_address,
};

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
pub(super) struct Around<'e, 'd> {
    pub(super) chart: Option<&'e str>,
    /// The local variables, the innermost last. They hide other names.
    pub(super) locals: &'e [Local<'d>],
}

/// A local variable, a parameter, or the result of a function.
#[derive(Clone, Debug)]
pub(super) struct Local<'d> {
    name: Box<str>,
    var: Var<'d>,
}

impl<'d> Local<'d> {
    /// The values that it can have.
    pub(super) fn admits(&self) -> Admits<'d> {
        self.var.admits
    }
}

/// The parameters and the result of a function, by the values that they can have.
#[derive(Clone, Debug)]
pub(super) struct Signature<'d> {
    /// The name of each parameter, and the values that the parameter can have.
    params: Vec<(&'d str, Admits<'d>)>,
    pub(super) result: Admits<'d>,
}

impl<'d> Signature<'d> {
    /// The values that an argument can have: the one with this name, or at this place.
    pub(super) fn of(&self, arg: &Arg, place: usize) -> Admits<'d> {
        let found = match &arg.name {
            Some(name) => self.params.iter().find(|(param, _)| **param == *name.text),
            None => self.params.get(place),
        };
        found.map_or(Admits::All, |(_, admits)| *admits)
    }
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
    functions: HashMap<&'d str, Signature<'d>>,
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
            functions: HashMap::new(),
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
                Item::Function(f) => {
                    let params = f.params.iter().map(|p| (&*p.name.text, admits_of(&p.ty))).collect();
                    let signature = Signature { params, result: admits_of(&f.result) };
                    made.functions.entry(&*f.name.text).or_insert(signature);
                }
                _ => {}
            }
        }
        made
    }

    /// The function that a path calls.
    pub(super) fn function(&self, path: &Path) -> Option<&Signature<'d>> {
        match path.names.as_slice() {
            [name] => self.functions.get(&*name.text),
            _ => None,
        }
    }

    /// A local variable, a parameter or a result with this name and type.
    pub(super) fn local(&self, name: &Name, ty: &ValueType) -> Local<'d> {
        let admits = match within(ty.limits.as_deref(), ty.base) {
            Admits::All => Admits::All,
            Admits::Range(least, most, ty) => Admits::Range(least, most, ty),
            // The key lives as long as the document; the name in the type may be that of a copy.
            Admits::Values(of) => match self.enumerations.get_key_value(of) {
                Some((of, _)) => Admits::Values(of),
                None => Admits::All,
            },
        };
        Local { name: name.text.clone(), var: Var { admits, array: false, of: None, number: None } }
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
    pub(super) fn find(&self, path: &Path, around: Around<'_, 'd>) -> Found<'d> {
        let names = path.names.as_slice();
        let Some(first) = names.first().map(|n| &*n.text) else { return Found::Other };
        if let Some(local) = around.locals.iter().rev().find(|l| *l.name == *first) {
            return Found::Var(local.var, names.len() > 1);
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
    pub(super) fn parameter(&self, instance: &Path, name: &Name, around: Around<'_, 'd>) -> Option<&'d str> {
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
    within(v.limits.as_deref(), v.ty)
}

/// The same for a parameter or a result.
fn admits_of(ty: &ValueType) -> Admits<'_> {
    within(ty.limits.as_deref(), ty.base)
}

fn within(limits: Option<&Limits>, ty: Type) -> Admits<'_> {
    match (limits, limits.and_then(Limits::range)) {
        (Some(Limits::Of(name)), _) => Admits::Values(&name.text),
        (_, Some((least, most))) => Admits::Range(least, most, ty),
        _ => Admits::All,
    }
}
