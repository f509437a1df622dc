//! The enumerations and the composed types of the variables of a document, by the paths that name them.
//!
//! ```text
//! readers: sfc, plcopen -> enumerations -> asks here
//! writers: standard     -> enumerations -> asks here
//! ```
//!
//! A variable of an enumeration has [`Limits::Of`]; one of a structure or function block of the file names it in `of`.

use std::collections::{BTreeSet, HashMap};

use g7_model::{Arg, ChartKind, Document, Item, Limits, Name, Path, ValueType, VarDecl, VarKind, bare};

/// Where a name is declared: in the file, in a chart, or in a structure or function block.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Home {
    File,
    Chart(Box<str>),
    Block(Box<str>),
}

/// A declaration, as far as it matters here.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Declared {
    /// The enumeration of a variable.
    pub(crate) of: Option<Box<str>>,
    /// The structure of a variable, or the function block of an instance.
    pub(crate) block: Option<Box<str>>,
    pub(crate) array: bool,
    pub(crate) inout: bool,
}

/// The declarations of the parameters of a function and of its result.
pub(crate) struct Signature {
    params: Vec<(Box<str>, Declared)>,
    pub(crate) result: Declared,
}

impl Signature {
    /// The parameter that gets an argument, which stands at this place in a call.
    pub(crate) fn parameter(&self, arg: &Arg, place: usize) -> Option<&Declared> {
        let found = match &arg.name {
            Some(name) => self.params.iter().find(|(param, _)| param.eq_ignore_ascii_case(&name.text)),
            None => self.params.get(place),
        };
        found.map(|(_, declared)| declared)
    }
}

/// All variables of a document.
#[derive(Default)]
pub(crate) struct Variables {
    all: HashMap<(Home, Box<str>), Declared>,
    functions: HashMap<Box<str>, Signature>,
    /// The inputs and in-outs of each function block, in the order of the text, in which a call can name none.
    inputs: HashMap<Box<str>, Vec<Box<str>>>,
    /// Those of charts, by their names alone: an expansion names variables of its program. Those that several charts
    /// declare otherwise are left out.
    of_charts: HashMap<Box<str>, Declared>,
    /// The enumerations of the variables that `of_charts` leaves out.
    pub(crate) unclear: BTreeSet<Box<str>>,
}

impl Variables {
    pub(crate) fn of(document: &Document) -> Variables {
        let mut made = Variables::default();
        let parts = document.charts().any(|c| c.kind != ChartKind::Chart);
        for item in &document.items {
            match item {
                Item::Var(v) => made.add(&Home::File, v, false),
                Item::Chart(c) => {
                    for v in c.vars() {
                        made.add(&Home::Chart(c.name.text.clone()), v, false);
                        if parts {
                            made.add_of_chart(v);
                        }
                    }
                }
                Item::Composed(c) => {
                    let home = Home::Block(c.name.text.clone());
                    c.members.iter().for_each(|v| made.add(&home, v, false));
                    c.inouts.iter().for_each(|v| made.add(&home, v, true));
                    let given = c.members.iter().filter(|m| m.kind == VarKind::Input).chain(&c.inouts);
                    let mut given: Vec<&Name> = given.flat_map(|v| &v.names).collect();
                    given.sort_by_key(|n| n.at.0.start);
                    let given = given.into_iter().map(|n| n.text.clone()).collect();
                    made.inputs.insert(c.name.text.clone(), given);
                }
                Item::Function(f) => {
                    let params = f.params.iter().map(|p| (p.name.text.clone(), of_value(&p.ty))).collect();
                    let signature = Signature { params, result: of_value(&f.result) };
                    made.functions.insert(f.name.text.clone(), signature);
                }
                _ => {}
            }
        }
        made
    }

    /// The enumerations of parameters and results of functions.
    pub(crate) fn of_functions(&self) -> impl Iterator<Item = &str> {
        let types = self.functions.values().flat_map(|f| f.params.iter().map(|(_, p)| p).chain([&f.result]));
        types.filter_map(|declared| declared.of.as_deref())
    }

    /// The function of the file that a path calls.
    pub(crate) fn function(&self, called: &Path) -> Option<&Signature> {
        match called.names.as_slice() {
            [name] => self.functions.get(&name.text),
            _ => None,
        }
    }

    fn add(&mut self, home: &Home, decl: &VarDecl, inout: bool) {
        let declared = Declared { inout, ..declared(decl) };
        self.all.extend(decl.names.iter().map(|n| ((home.clone(), n.text.clone()), declared.clone())));
    }

    fn add_of_chart(&mut self, decl: &VarDecl) {
        let declared = declared(decl);
        for name in &decl.names {
            let known = self.of_charts.entry(name.text.clone()).or_insert_with(|| declared.clone());
            if *known != declared {
                self.unclear.extend([known.of.take(), declared.of.clone()].into_iter().flatten());
                known.block = None;
            }
        }
    }

    /// The names of the variables that have an enumeration, and that.
    pub(crate) fn enumerated(&self) -> impl Iterator<Item = (&str, &str)> {
        self.all.iter().filter_map(|((_, name), d)| Some((&**name, d.of.as_deref()?)))
    }

    fn find(&self, home: &Home, name: &str) -> Option<&Declared> {
        let within = |home: &Home, name: &str| self.all.get(&(home.clone(), name.into()));
        // The index of an element, or its place, stands in the name: `d[i].open`, `m[].speed`.
        let exact = |home: &Home| within(home, name).or_else(|| within(home, bare(name).0));
        match home {
            Home::File | Home::Block(_) => exact(home),
            Home::Chart(_) => exact(home).or_else(|| exact(&Home::File)).or_else(|| self.of_charts.get(name)),
        }
    }

    /// The variable that names of a path name in a chart, a function block or the file.
    pub(crate) fn declared(&self, home: &Home, names: &[Name]) -> Option<&Declared> {
        let (first, rest) = names.split_first()?;
        // The body of a function block names variables of the file, too.
        let near = self.find(home, &first.text).or_else(|| self.find(&Home::File, &first.text));
        let near = near.and_then(|found| self.behind(found, rest));
        near.or_else(|| {
            let (second, rest) = rest.split_first()?;
            self.behind(self.find(&Home::Chart(first.text.clone()), &second.text)?, rest)
        })
    }

    /// The member that names behind a variable name.
    fn behind<'v>(&'v self, variable: &'v Declared, names: &[Name]) -> Option<&'v Declared> {
        names
            .iter()
            .try_fold(variable, |found, name| self.find(&Home::Block(found.block.clone()?), &name.text))
    }

    /// The enumeration of a variable that a path names in a chart, a function block or the file.
    pub(crate) fn of_path(&self, home: &Home, path: &Path) -> Option<&str> {
        self.declared(home, &path.names)?.of.as_deref()
    }

    /// The input or in-out at a place of the call of a function block.
    pub(crate) fn input(&self, home: &Home, called: &Path, place: usize) -> Option<&Declared> {
        let block = self.declared(home, &called.names)?.block.clone()?;
        let name = self.inputs.get(&block)?.get(place)?;
        self.find(&Home::Block(block), name)
    }

    /// The parameter of the function block that a path calls.
    pub(crate) fn parameter(&self, home: &Home, called: &Path, name: &str) -> Option<&Declared> {
        let block = self.declared(home, &called.names)?.block.clone()?;
        self.find(&Home::Block(block), name)
    }

    /// The enumeration of a parameter of the function block that a path calls.
    pub(crate) fn of_parameter(&self, home: &Home, called: &Path, name: &str) -> Option<&str> {
        self.parameter(home, called, name)?.of.as_deref()
    }
}

fn declared(decl: &VarDecl) -> Declared {
    Declared { array: decl.array.is_some(), ..of_value(&decl.value_type()) }
}

/// A parameter, a local variable or a result as a declaration.
pub(crate) fn of_value(ty: &ValueType) -> Declared {
    let of = if let Some(Limits::Of(of)) = ty.limits.as_deref() { Some(of.text.clone()) } else { None };
    let block = ty.of.as_ref().map(|of| of.text.clone());
    Declared { of, block, array: false, inout: false }
}
