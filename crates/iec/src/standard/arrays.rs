//! Gives the types of arrays names.
//!
//! Two arrays are of one type only if this has one name (IEC 61131-3:2003, 2.3.3): a program that names an array of the
//! configuration, and the assignment of a whole array, need it.

use std::collections::HashMap;

use g7_model::{ChartItem, Document, Expr, Item, Name, VarDecl, VarKind};

use super::identifiers::Names;
use crate::words::number;

/// Puts an [`Item::Type`] for each type of array before all variables, and its name into [`VarDecl::of`]. The structures
/// stand among these types, each type behind those that it names.
pub(super) fn named(document: &mut Document, names: &mut Names) {
    let mut types = Types { names, known: HashMap::new(), made: Vec::new() };
    let mut items = Vec::new();
    for mut item in std::mem::take(&mut document.items) {
        match &mut item {
            Item::Composed(c) if !c.block => {
                c.members.iter_mut().for_each(|v| types.name(v));
                types.made.push(item);
                continue;
            }
            Item::Composed(c) => c.members.iter_mut().chain(&mut c.inouts).for_each(|v| types.name(v)),
            Item::Var(v) => types.name(v),
            Item::Chart(c) => {
                let variables = c.items.iter_mut();
                let variables =
                    variables.filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None });
                variables.for_each(|v| types.name(v));
            }
            _ => {}
        }
        items.push(item);
    }
    let first = items.iter().position(|i| matches!(i, Item::Composed(_) | Item::Var(_) | Item::Chart(_)));
    let first = first.unwrap_or(0);
    items.splice(first..first, types.made);
    document.items = items;
}

/// The types so far, in their order.
struct Types<'n> {
    names: &'n mut Names,
    /// The name of each type of array, by the wish for it.
    known: HashMap<String, Name>,
    made: Vec<Item>,
}

impl Types<'_> {
    /// Gives the type of a variable its name, if that is an array.
    fn name(&mut self, decl: &mut VarDecl) {
        let Some(wish) = wish(decl) else { return };
        let name = match self.known.get(&wish) {
            Some(name) => name.clone(),
            None => {
                let name = Name::new(self.names.free(None, &wish), decl.at.0);
                let array = decl.array.clone();
                let of = decl.of.clone();
                let ty =
                    VarDecl { array, of, ..VarDecl::new(VarKind::Var, vec![name.clone()], decl.ty, decl.at) };
                self.made.push(Item::Type(ty));
                self.known.insert(wish, name.clone());
                name
            }
        };
        decl.of = Some(Box::new(name));
    }
}

/// `INT_1_3` for `ARRAY[1..3] OF INT`; None for a variable that is no array.
fn wish(decl: &VarDecl) -> Option<String> {
    let bound = |e: &Expr| e.kind.whole().map_or_else(|| "n".to_owned(), number);
    let bounds: Vec<String> = decl.array.as_ref()?.bounds().map(bound).collect();
    let of = decl.of.as_ref().map_or_else(|| decl.ty.to_string(), |of| of.text.to_string());
    Some(format!("{of}_{}", bounds.join("_")))
}
