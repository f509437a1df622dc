//! Gives the types of arrays names.
//!
//! Two arrays are of one type only if this has one name (IEC 61131-3:2003, 2.3.3): a program that names an array of the
//! configuration, and the assignment of a whole array, need it.

use std::collections::HashMap;

use g7_model::{ChartItem, Document, Expr, Item, Name, VarDecl, VarKind};

use super::identifiers::Names;
use crate::words::number;

/// Puts an [`Item::Type`] for each type of array before all variables, and its name into [`VarDecl::of`].
pub(super) fn named(document: &mut Document, names: &mut Names) {
    let mut made: Vec<Item> = Vec::new();
    let mut known: HashMap<String, Name> = HashMap::new();
    let variables = document.items.iter_mut().flat_map(|item| match item {
        Item::Var(v) => vec![v],
        Item::Composed(c) => c.members.iter_mut().chain(&mut c.inouts).collect(),
        Item::Chart(c) => c
            .items
            .iter_mut()
            .filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None })
            .collect(),
        _ => Vec::new(),
    });
    for decl in variables {
        let Some(wish) = wish(decl) else { continue };
        let name = known.entry(wish).or_insert_with_key(|wish| {
            let name = Name::new(names.free(None, wish), decl.at.0);
            let array = decl.array.clone();
            made.push(Item::Type(VarDecl {
                array,
                ..VarDecl::new(VarKind::Var, vec![name.clone()], decl.ty, decl.at)
            }));
            name
        });
        decl.of = Some(Box::new(name.clone()));
    }
    let first = document
        .items
        .iter()
        .position(|i| matches!(i, Item::Composed(_) | Item::Var(_) | Item::Chart(_)))
        .unwrap_or(0);
    document.items.splice(first..first, made);
}

/// `INT_1_3` for `ARRAY[1..3] OF INT`; None for a variable that is no array.
fn wish(decl: &VarDecl) -> Option<String> {
    let bound = |e: &Expr| e.kind.whole().map_or_else(|| "n".to_owned(), number);
    let bounds: Vec<String> = decl.array.as_ref()?.bounds().map(bound).collect();
    Some(format!("{}_{}", decl.ty, bounds.join("_")))
}
