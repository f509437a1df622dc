//! Enumerations of a file that is read become types of the document.
//!
//! ```text
//! sfc, plcopen (build) -> here (table, walk, values) -> Document
//! ```
//!
//! Up to here each enumeration is an [`Item::Type`] whose values may have numbers, each variable of one has
//! [`Limits::Of`], and `Mode#Auto` is one name. IEC 61131-3 lets no program compute with values (2003, 2.3.3.1), but most
//! tools do. The language of G7 has a way from a value to its number, `Mode_TO_INT(m)`, and none back. So:
//!
//! - A value or a variable that stands where a number is needed becomes that call.
//! - A written number that stands where a value is needed becomes the value with this number.
//! - An enumeration that gets any other number becomes numbers: its variables are of their type, with a constant for each
//!   value. This is told, with the place of the number.
//!
//! After this pass each enumeration is either a type, and all its uses are those that the language has, or it is gone.

mod table;
mod values;
mod walk;

use std::collections::BTreeMap;

use g7_model::{
    ChartItem, Document, Expr, ExprKind, Item, Limits, Local, Name, Problem, Span, Type, ValueType, VarDecl,
    VarKind, codes, say, visit_mut,
};

use crate::nodes;
use crate::report::Report;
use crate::variables::Variables;
use table::{Table, Value, Why};
use values::Walker;

/// Most walks through a document that find enumerations with another use. After these, all become numbers.
const ROUNDS: usize = 16;

/// Makes types of the enumerations of a document, and numbers of those that cannot be types.
pub(crate) fn settle(document: &mut Document, report: &mut Report) {
    let table = Table::of(document);
    if table.all.is_empty() {
        return;
    }
    let variables = Variables::of(document);
    let mut numbers = table.without_numbers();
    numbers.extend(table.all.iter().enumerate().filter_map(|(place, t)| {
        variables.unclear.contains(&t.of).then_some((place, (t.name.at.0, Why::Used)))
    }));
    for round in 0.. {
        let mut changed = document.clone();
        let mut walker = Walker::new(&table, &variables, &numbers);
        walker.document(&mut changed);
        if walker.found.is_empty() {
            walker.problems.into_iter().for_each(|p| report.put(p));
            *document = changed;
            break;
        }
        let found = walker.found;
        numbers.extend(found);
        if round >= ROUNDS {
            let all = table.all.iter().enumerate().map(|(place, t)| (place, (t.name.at.0, Why::Used)));
            all.for_each(|(place, why)| _ = numbers.entry(place).or_insert(why));
        }
    }
    numbers.iter().for_each(|(place, (at, why))| told(&table, *place, *at, *why, report));
    Settler { table: &table, numbers: &numbers }.document(document);
}

/// Tells that an enumeration becomes numbers.
fn told(table: &Table, place: usize, at: Span, why: Why, report: &mut Report) {
    let Some(own) = table.all.get(place).filter(|own| !own.values.is_empty()) else { return };
    let name = &own.of;
    let what = match why {
        Why::Numbers => {
            say!("the enumeration `{name}` is read as numbers: its values do not have a number of INT each")
        }
        Why::Value => say!("the enumeration `{name}` is read as numbers: here it gets one that is no value"),
        Why::Used => say!("the enumeration `{name}` is read as numbers: here it is used as one"),
    };
    let problem = Problem::new(&codes::DIFFERENT, at, what);
    report.put(problem.related(own.name.at.0, say!("the enumeration")));
}

/// Gives the declarations of a document their last form.
struct Settler<'a> {
    table: &'a Table,
    numbers: &'a BTreeMap<usize, (Span, Why)>,
}

impl Settler<'_> {
    fn document(&self, document: &mut Document) {
        let items = std::mem::take(&mut document.items);
        for item in items {
            match item {
                Item::Type(t) => match self.table.declared_by(&t) {
                    Some(place) if self.numbers.contains_key(&place) => {
                        document.items.extend(self.constants(place));
                    }
                    Some(place) => document.items.push(self.kept(place, t)),
                    None => document.items.push(Item::Type(t)),
                },
                other => document.items.push(other),
            }
        }
        for item in &mut document.items {
            match item {
                Item::Var(v) => self.declaration(v),
                Item::Chart(c) => {
                    for item in &mut c.items {
                        if let ChartItem::Var(v) = item {
                            self.declaration(v);
                        }
                    }
                }
                Item::Composed(c) => {
                    c.members.iter_mut().chain(&mut c.inouts).for_each(|v| self.declaration(v));
                }
                Item::Function(f) => {
                    f.params.iter_mut().for_each(|p| self.value_type(&mut p.ty));
                    self.value_type(&mut f.result);
                }
                _ => {}
            }
            visit_mut::blocks(item, &mut |block| block.locals.iter_mut().for_each(|l| self.local(l)));
        }
    }

    /// A parameter or a result.
    fn value_type(&self, ty: &mut ValueType) {
        self.of_type(&mut ty.base, &mut ty.of, &mut ty.limits);
    }

    fn local(&self, local: &mut Local) {
        if let Some(place) = self.of_type(&mut local.ty.base, &mut local.ty.of, &mut local.ty.limits) {
            local.init.take_if(|e| self.is_usual(place, e));
        }
    }

    /// If the enumeration is kept as a type, the variable gets it as its type, and its place in the table is returned.
    /// Otherwise the variable keeps the number type.
    fn of_type(
        &self,
        ty: &mut Type,
        of: &mut Option<Box<Name>>,
        limits: &mut Option<Box<Limits>>,
    ) -> Option<usize> {
        let Limits::Of(name) = *limits.take_if(|l| matches!(**l, Limits::Of(_)))? else { return None };
        let place = self.table.place(&name.text)?;
        let own = self.table.all.get(place).filter(|_| !self.numbers.contains_key(&place))?;
        *ty = Type::Bool;
        *of = Some(Box::new(own.name.clone()));
        Some(place)
    }

    /// True if `e` is the value that variables of this enumeration have before anything is assigned.
    fn is_usual(&self, place: usize, e: &Expr) -> bool {
        let usual = self.table.all.get(place).map(|own| own.usual);
        self.value(place, e).is_some_and(|v| Some(v.number) == usual)
    }

    /// A constant for each value of an enumeration.
    fn constants(&self, place: usize) -> Vec<Item> {
        let Some(own) = self.table.all.get(place) else { return Vec::new() };
        let constant = |value: &Value| {
            let at = value.name.at;
            let init = Some(nodes::int(value.number, at.0));
            let names = vec![Name { text: value.constant.clone(), at }];
            Item::Var(VarDecl { init, ..VarDecl::new(VarKind::Const, names, own.ty, at) })
        };
        own.values.iter().map(constant).collect()
    }

    fn kept(&self, place: usize, mut t: VarDecl) -> Item {
        if let Some(own) = self.table.all.get(place) {
            t.names = vec![own.name.clone()];
            // In the declaration of its own type a value needs no type.
            let usual = own.numbered(own.usual).filter(|v| v.number != own.first());
            t.init = usual.zip(t.init).map(|(value, e)| nodes::name(&[&value.name.text], e.at.0));
        }
        t.ty = Type::Int;
        Item::Type(t)
    }

    /// The value that an expression of the document names.
    fn value(&self, place: usize, e: &Expr) -> Option<&Value> {
        let ExprKind::Path(path) = &e.kind else { return None };
        let name = &path.names.last()?.text;
        self.table.all.get(place)?.values.iter().find(|v| v.name.text == *name)
    }

    fn declaration(&self, decl: &mut VarDecl) {
        let Some(place) = self.of_type(&mut decl.ty, &mut decl.of, &mut decl.limits) else { return };
        let usual = |e: &Expr| self.is_usual(place, e);
        let same = match decl.init.as_ref().map(|e| (e, &e.kind)) {
            Some((_, ExprKind::List(values))) => values.iter().all(|(_, e)| usual(e)),
            Some((e, _)) => usual(e),
            None => false,
        };
        // The type gives this value, except to constants, which are written with one.
        if same && decl.kind != VarKind::Const {
            decl.init = None;
        }
    }
}
