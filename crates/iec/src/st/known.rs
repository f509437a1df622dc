//! The types of the names in a text that is printed.

use std::borrow::Cow;
use std::collections::HashMap;

use g7_model::{
    Chart, Composed, Document, Function, Item, Name, Path, Type, VarDecl, bare, composed::DEEP, with_slot,
};

/// The types of names.
#[derive(Debug, Default)]
pub struct Types<'d> {
    names: HashMap<Cow<'d, str>, Named<'d>>,
    functions: HashMap<&'d str, &'d Function>,
    /// The structures and function blocks of the file, by their names.
    composed: HashMap<&'d str, &'d Composed>,
    /// The types of arrays.
    arrays: HashMap<&'d str, &'d VarDecl>,
    /// The charts, whose variables other programs name with the name of the chart before them.
    charts: HashMap<&'d str, &'d Chart>,
}

/// The type of a name.
#[derive(Clone, Copy, Debug)]
enum Named<'d> {
    Of(Type),
    /// An instance of a function block of the file.
    Instance(&'d Composed),
}

impl<'d> Types<'d> {
    /// The types of the names of the file and, if given, of a chart.
    pub fn new(document: &'d Document, chart: Option<&'d Chart>) -> Types<'d> {
        let mut types = Types::default();
        for item in &document.items {
            match item {
                Item::Function(f) => _ = types.functions.insert(&f.name.text, f),
                Item::Composed(c) => _ = types.composed.insert(&c.name.text, c),
                Item::Chart(c) => _ = types.charts.insert(&c.name.text, c),
                Item::Type(t) => types.arrays.extend(t.names.iter().map(|n| (&*n.text, t))),
                _ => {}
            }
        }
        let of_file = document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
        of_file.for_each(|v| types.declare(v));
        chart.into_iter().flat_map(Chart::vars).for_each(|v| types.declare(v));
        types
    }

    /// The types of the names in the body of a function block of the file.
    pub fn of_block(document: &'d Document, block: &'d Composed) -> Types<'d> {
        let mut types = Types::new(document, None);
        types.names.clear();
        block.members.iter().chain(&block.inouts).for_each(|v| types.declare(v));
        types
    }

    fn declare(&mut self, decl: &'d VarDecl) {
        decl.names.iter().for_each(|n| self.declare_as(Cow::Borrowed(&n.text), decl, 0));
    }

    /// Adds a variable, or a member of a structure; of a structure that is one, all members: `m[].speed`.
    fn declare_as(&mut self, name: Cow<'d, str>, decl: &'d VarDecl, depth: usize) {
        let named = match self.type_of(decl) {
            Some(structure) if !structure.block => {
                let name = with_slot(&name, decl.array.as_ref().map_or(0, |a| a.dimensions.len()));
                for member in structure.members.iter().filter(|_| depth < DEEP) {
                    for n in &member.names {
                        self.declare_as(format!("{name}.{}", n.text).into(), member, depth + 1);
                    }
                }
                return;
            }
            Some(block) => Named::Instance(block),
            None => Named::Of(decl.ty),
        };
        self.names.insert(name, named);
    }

    /// The type of a variable, if that is a structure or a function block; for an array, the type of its elements.
    fn type_of(&self, decl: &VarDecl) -> Option<&'d Composed> {
        let of = decl.of.as_ref()?;
        let of = match self.arrays.get(&*of.text) {
            Some(array) => array.of.as_ref()?,
            None => of,
        };
        self.composed.get(&*of.text).copied()
    }

    /// The type of a variable of another program, or of a member of its structure.
    fn of_chart(&self, chart: &Name, name: &str) -> Option<Type> {
        let chart = self.charts.get(&*chart.text)?;
        let mut names = name.split('.').map(|n| bare(n).0);
        let has = |decl: &&VarDecl, name: &str| decl.names.iter().any(|n| *n.text == *name);
        let first = names.next()?;
        let mut decl = chart.vars().find(|v| has(v, first))?;
        for name in names {
            decl = self.type_of(decl)?.members.iter().find(|m| has(m, name))?;
        }
        self.type_of(decl).is_none().then_some(decl.ty)
    }

    /// Adds a name of a function, which hides all others.
    pub fn own(mut self, name: &'d str, ty: Type) -> Types<'d> {
        self.names.insert(name.into(), Named::Of(ty));
        self
    }

    /// The type of a variable, of a member of an instance, or of the activity or the time of a step.
    pub(super) fn of(&self, names: &[Name]) -> Option<Type> {
        match names {
            [one] => match self.names.get(&*one.text)? {
                Named::Of(ty) => Some(*ty),
                Named::Instance(_) => None,
            },
            [first, second] if self.names.contains_key(&*first.text) => self.of_member(first, &second.text),
            [_, second] if second.text.eq_ignore_ascii_case("X") => Some(Type::Bool),
            [_, second] if second.text.eq_ignore_ascii_case("T") => Some(Type::Time),
            [chart, variable] => self.of_chart(chart, &variable.text),
            _ => None,
        }
    }

    /// The type of a member of an instance.
    fn of_member(&self, instance: &Name, member: &str) -> Option<Type> {
        match self.names.get(&*instance.text)? {
            Named::Of(Type::Fb(kind)) => kind.type_of(member),
            Named::Of(_) => None,
            Named::Instance(block) => {
                let named = |v: &&VarDecl| v.names.iter().any(|n| *n.text == *member);
                block.members.iter().chain(&block.inouts).find(named).map(|v| v.ty)
            }
        }
    }

    /// The type of a parameter of the function block that a path calls.
    pub(super) fn of_parameter(&self, called: &Path, name: &str) -> Option<Type> {
        let [instance] = called.names.as_slice() else { return None };
        self.of_member(instance, name)
    }

    /// A function of the file.
    pub(super) fn function(&self, name: &str) -> Option<&'d Function> {
        self.functions.get(name).copied()
    }
}
