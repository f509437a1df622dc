//! Finds inputs and outputs that no chart names: an input that nothing reads, an output that nothing
//! drives.
//!
//! Plants and tests are not counted: they move the inputs and look at the outputs of any chart.
//! Names are compared as written, wherever they stand, so every reported variable is unused.

use std::collections::HashSet;

use g7_model::{Document, Item, Problem, VarDecl, VarKind, codes, say};

use super::named::names_of_charts;

#[inline(never)]
pub(super) fn check(doc: &Document, problems: &mut Vec<Problem>) {
    let declared = doc.items.iter().filter_map(|i| match i {
        Item::Var(v) if matches!(v.kind, VarKind::Input | VarKind::Output) => Some(v),
        _ => None,
    });
    let declared: Vec<&VarDecl> = declared.collect();
    // A file without a chart only declares what other files use.
    if declared.is_empty() || doc.charts().next().is_none() {
        return;
    }
    let named: HashSet<&str> = names_of_charts(doc);
    for v in declared {
        let address = v.address.as_ref().map(|a| a.text.trim_start_matches('%'));
        if address.is_some_and(|a| named.contains(a)) {
            continue;
        }
        for name in v.names.iter().filter(|n| !n.text.is_empty() && !named.contains(&*n.text)) {
            let (code, what, help) = if v.kind == VarKind::Input {
                let what = say!("no chart reads the input `{}`", name.text);
                (&codes::INPUT_UNREAD, what, say!("read it in a receptivity, or delete it"))
            } else {
                let what = say!("no chart drives the output `{}`", name.text);
                (&codes::OUTPUT_UNDRIVEN, what, say!("drive it by an action, or delete it"))
            };
            problems.push(Problem::new(code, name.at.0, what).help(help));
        }
    }
}
