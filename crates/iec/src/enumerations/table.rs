//! The enumerations of a document that is read, with the names that they and their values have in it.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::named::{MOST_VALUES, numbered};
use g7_model::visit::Visitor;
use g7_model::{
    Block, ChartItem, Document, Expr, ExprKind, Item, Limits, Name, Order, Span, Type, VarDecl,
    normal_address,
};

use crate::nodes;

/// Why an enumeration becomes numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// Its values have no numbers, or the same ones.
    Numbers,
    /// One of its variables gets a number that no value has, or one that nobody knows.
    Value,
    /// One of its variables is used as a number in a place that takes no call.
    Used,
}

/// A value of an enumeration.
pub(super) struct Value {
    pub(super) name: Name,
    pub(super) number: i128,
    /// True if its name alone means nothing else, anywhere in the document.
    bare: bool,
    /// The name of the constant for it, if the enumeration becomes numbers.
    pub(super) constant: Box<str>,
}

/// An enumeration.
pub(super) struct Enumeration {
    /// Its name in the file.
    pub(super) of: Box<str>,
    /// Its name in the document.
    pub(super) name: Name,
    /// The type of its numbers.
    pub(super) ty: Type,
    pub(super) values: Vec<Value>,
    /// The number that its variables begin with.
    pub(super) usual: i128,
    /// True if some value has no number of INT, or the number of another one.
    unfit: bool,
}

impl Enumeration {
    /// The number of the first value.
    pub(super) fn first(&self) -> i128 {
        self.values.first().map_or(0, |v| v.number)
    }

    /// A value as the document names it.
    pub(super) fn written(&self, value: &Value, at: Span) -> Expr {
        match value.bare {
            true => nodes::name(&[&value.name.text], at),
            false => nodes::name(&[&self.name.text, &value.name.text], at),
        }
    }

    /// The value with a number.
    pub(super) fn numbered(&self, number: i128) -> Option<&Value> {
        self.values.iter().find(|v| v.number == number)
    }
}

/// The enumerations of a document.
#[derive(Default)]
pub(super) struct Table {
    pub(super) all: Vec<Enumeration>,
    places: HashMap<Box<str>, usize>,
    /// The values by their names with the type, `Mode#Auto`: the index of the enumeration, and that of the value in it.
    typed: HashMap<String, (usize, usize)>,
    /// The values by their names alone. Several enumerations can have one of that name.
    bare: HashMap<Box<str>, Vec<(usize, usize)>>,
    /// The functions from a value to its number that the file does not declare itself, in upper case.
    conversions: HashMap<String, usize>,
    /// The enumerations of variables that have a direct address, by the address.
    addresses: HashMap<String, usize>,
}

impl Table {
    pub(super) fn of(document: &Document) -> Table {
        let mut table = Table::default();
        for item in &document.items {
            if let Item::Type(t) = item
                && let Some(name) =
                    t.names.first().filter(|_| matches!(t.limits.as_deref(), Some(Limits::Values(_))))
            {
                table.enumeration(name, t);
            }
        }
        if !table.all.is_empty() {
            let taken = declared(document);
            taken.iter().for_each(|name| _ = table.conversions.remove(&name.to_uppercase()));
            table.name(taken);
            table.stand(document);
        }
        table
    }

    fn enumeration(&mut self, name: &Name, t: &VarDecl) {
        let place = self.all.len();
        let mut values: Vec<Value> = Vec::new();
        let mut numbers = HashSet::new();
        let mut unfit = t.values().len() > MOST_VALUES;
        let mut next = 0;
        for ((value, own), (_, written)) in numbered(t.values()).into_iter().zip(t.values()) {
            // A number beyond INT is none for `numbered`.
            let number = own.or_else(|| written.as_ref()?.kind.whole()).unwrap_or(next);
            next = number.saturating_add(1);
            unfit |= own.is_none() || !numbers.insert(number);
            let key = format!("{}#{}", name.text, value.text);
            self.typed.entry(key).or_insert((place, values.len()));
            let same = self.bare.entry(value.text.clone()).or_default();
            if same.last().is_none_or(|(before, _)| *before != place) {
                same.push((place, values.len()));
            }
            let constant = value.text.clone();
            values.push(Value { name: value.clone(), number, bare: false, constant });
        }
        let first = values.first().map_or(0, |v| v.number);
        let usual = match &t.init {
            None => Some(first),
            Some(e) => self.number(place, &values, e),
        };
        unfit |= usual.is_none();
        let of = name.text.clone();
        self.places.entry(of.clone()).or_insert(place);
        self.conversions.entry(format!("{of}_TO_{}", t.ty.name()).to_uppercase()).or_insert(place);
        let usual = usual.unwrap_or(first);
        self.all.push(Enumeration { of, name: name.clone(), ty: t.ty, values, usual, unfit });
    }

    /// The number of the value that the declaration of an enumeration gives its variables; None if it is no value.
    fn number(&self, place: usize, values: &[Value], e: &Expr) -> Option<i128> {
        let number = match &e.kind {
            ExprKind::Path(path) => {
                let (own, value) = *self.typed.get(&*path.names.first()?.text)?;
                values.get(value).filter(|_| own == place)?.number
            }
            kind => kind.whole()?,
        };
        values.iter().any(|v| v.number == number).then_some(number)
    }

    /// Gives the enumerations, their values and the constants for these names that mean nothing else.
    fn name(&mut self, mut taken: BTreeSet<Box<str>>) {
        for own in &mut self.all {
            let mut text = own.name.text.to_string();
            let converts = |text: &str| taken.contains(&*format!("{text}_TO_INT"));
            while taken.contains(&*text)
                || converts(&text)
                || Type::named(&text.to_ascii_uppercase()).is_some()
            {
                text.push_str(if text.len() == own.of.len() { "_type" } else { "_" });
            }
            own.name.text = text.into();
            taken.insert(own.name.text.clone());
        }
        let several = |name: &str| self.bare.get(name).is_some_and(|all| all.len() > 1);
        for own in &mut self.all {
            for value in &mut own.values {
                value.bare = !taken.contains(&value.name.text) && !several(&value.name.text);
                if value.bare {
                    continue;
                }
                let mut text = format!("{}_{}", own.of, value.name.text);
                while taken.contains(&*text) || self.bare.contains_key(&*text) {
                    text.push('_');
                }
                value.constant = text.into();
            }
        }
    }

    /// Notes the addresses of variables.
    fn stand(&mut self, document: &Document) {
        let mut found = Vec::new();
        for item in &document.items {
            match item {
                Item::Var(v) => found.push(v),
                Item::Chart(c) => found.extend(c.vars()),
                _ => {}
            }
        }
        for v in found {
            let Some(Limits::Of(of)) = v.limits.as_deref() else { continue };
            if let (Some(address), Some(place)) = (&v.address, self.places.get(&of.text)) {
                self.addresses.entry(normal_address(&address.text)).or_insert(*place);
            }
        }
    }

    /// The index in [`Table::all`] of an enumeration, by its name in the file.
    pub(super) fn place(&self, of: &str) -> Option<usize> {
        self.places.get(of).copied()
    }

    /// The index in [`Table::all`] of the enumeration that a `type` declares.
    pub(super) fn declared_by(&self, t: &VarDecl) -> Option<usize> {
        self.place(&t.names.first()?.text)
    }

    pub(super) fn value(&self, place: usize, value: usize) -> Option<&Value> {
        self.all.get(place)?.values.get(value)
    }

    /// The value with its type, `Mode#Auto`; Err if the enumeration has no such value.
    pub(super) fn typed(&self, name: &str) -> Option<Result<(usize, usize), usize>> {
        let (of, _) = name.split_once('#')?;
        let place = self.place(of)?;
        Some(self.typed.get(name).copied().ok_or(place))
    }

    /// The values of this name.
    pub(super) fn bare(&self, name: &str) -> &[(usize, usize)] {
        self.bare.get(name).map_or(&[], Vec::as_slice)
    }

    /// The enumeration whose values a function turns into their numbers.
    pub(super) fn conversion(&self, function: &str) -> Option<usize> {
        self.conversions.get(&function.to_uppercase()).copied()
    }

    /// The enumeration of a variable at an address, or of one that a bit belongs to.
    pub(super) fn at_address(&self, text: &str) -> Option<usize> {
        let word = text.split_once(':').map_or(text, |(word, _)| word);
        self.addresses.get(&normal_address(word)).copied()
    }

    /// The enumerations that no type can hold.
    pub(super) fn without_numbers(&self) -> BTreeMap<usize, (Span, Why)> {
        let unfit = self.all.iter().enumerate().filter(|(_, own)| own.unfit || own.values.is_empty());
        unfit.map(|(place, own)| (place, (own.name.at.0, Why::Numbers))).collect()
    }
}

/// All names that a document declares, except for steps and enumerations.
fn declared(document: &Document) -> BTreeSet<Box<str>> {
    let mut names = Declared(BTreeSet::new());
    for item in &document.items {
        match item {
            Item::Var(v) => names.variable_names(v),
            Item::Action(a) => names.add(&a.name),
            Item::Function(f) => {
                names.add(&f.name);
                f.params.iter().for_each(|p| names.add(&p.name));
            }
            Item::Composed(c) => {
                names.add(&c.name);
                c.members.iter().chain(&c.inouts).for_each(|v| names.variable_names(v));
            }
            Item::Chart(c) => {
                names.add(&c.name);
                for item in &c.items {
                    match item {
                        ChartItem::Var(v) => names.variable_names(v),
                        ChartItem::Action(a) => names.add(&a.name),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
        names.item(item);
    }
    names.0
}

struct Declared(BTreeSet<Box<str>>);

impl Declared {
    fn add(&mut self, name: &Name) {
        self.0.insert(name.text.clone());
    }

    fn variable_names(&mut self, decl: &VarDecl) {
        decl.names.iter().for_each(|n| self.add(n));
    }
}

impl<'d> Visitor<'d> for Declared {
    fn path(&mut self, _: &'d [Name]) {}

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}

    fn enter(&mut self, block: &'d Block) {
        self.0.extend(block.locals.iter().flat_map(|l| &l.names).map(|n| n.text.clone()));
    }
}
