//! The variables of a document, one by one.

use g7_iec::scopes::VarKey;
use g7_model::{ChartItem, Document, Item, Name, VarDecl};

use super::names::Names;

/// The variables under their names in the file, for the printer of texts.
pub(super) fn renamed<'d>(list: &[(VarKey<'d>, &'d VarDecl)], names: &Names<'d>) -> Document {
    let item = |(key, decl): &(VarKey<'d>, &'d VarDecl)| {
        let name = Name::new(names.var(*key), decl.at.0);
        Item::Var(VarDecl { names: vec![name], init: None, ..(*decl).clone() })
    };
    Document { items: list.iter().map(item).collect(), notes: Vec::new() }
}

/// All variables, in the order of the document, each name by itself.
pub(super) fn variables(document: &Document) -> Vec<(VarKey<'_>, &VarDecl)> {
    let mut list = Vec::new();
    let mut charts = 0;
    for item in &document.items {
        match item {
            Item::Var(v) => list.extend(v.names.iter().map(|n| ((None, &*n.text), v))),
            Item::Chart(c) => {
                for item in &c.items {
                    if let ChartItem::Var(v) = item {
                        list.extend(v.names.iter().map(|n| ((Some(charts), &*n.text), v)));
                    }
                }
                charts += 1;
            }
            _ => {}
        }
    }
    list
}
