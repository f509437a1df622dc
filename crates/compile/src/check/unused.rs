//! Finds variables that nothing in the document names: neither charts nor plants, tests or
//! properties.
//!
//! Names are compared as written, wherever they stand. A name that means something else still
//! counts as a use, so every reported variable is unused. Inputs, outputs and constants are the
//! interface of the chart and are not reported. Variables with an address or a comment are meant to
//! be watched and are not reported either.

use std::collections::HashSet;

use g7_model::{ChartItem, Document, Item, Problem, VarDecl, VarKind, codes, say};

use super::named::names;

#[inline(never)]
pub(super) fn check(doc: &Document, problems: &mut Vec<Problem>) {
    let mut declared: Vec<&VarDecl> = Vec::new();
    for item in &doc.items {
        match item {
            Item::Var(v) => declared.push(v),
            Item::Chart(c) => {
                declared.extend(c.items.iter().filter_map(|i| match i {
                    ChartItem::Var(v) => Some(v),
                    _ => None,
                }));
            }
            _ => {}
        }
    }
    declared.retain(|v| v.kind == VarKind::Var && v.address.is_none() && v.comment.is_none());
    if declared.is_empty() {
        return;
    }
    let named: HashSet<&str> = names(doc);
    for name in declared.iter().flat_map(|v| &v.names) {
        if !name.text.is_empty() && !named.contains(&*name.text) {
            problems.push(
                Problem::new(
                    &codes::UNUSED_VARIABLE,
                    name.at.0,
                    say!("nothing names the variable `{}`", name.text),
                )
                .help(say!("delete it")),
            );
        }
    }
}
