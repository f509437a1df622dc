//! Replaces each array of function blocks with a chart by single instances, each of which becomes a chart.
//!
//! `instances` calls this file before it makes the charts, and then sees no such array.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Expr, ExprKind, Name, Path, Problem, Span, codes, say};

use super::unit::{Source, Unit, UnitKind};
use crate::report::Report;
use crate::st::Variable;
use crate::words::number;

/// The most elements of one array.
const MOST: i128 = 10_000;

/// Replaces the arrays in programs without a chart of their own.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let is_block = |u: &&Unit| u.kind == UnitKind::FunctionBlock && u.is_chart();
    let blocks: HashSet<String> =
        source.units.iter().filter(is_block).map(|u| u.name.text.to_uppercase()).collect();
    let of_chart =
        |v: &Variable| v.unknown.as_ref().is_some_and(|ty| blocks.contains(&ty.text.to_uppercase()));
    for unit in source.units.iter_mut().filter(|u| u.kind == UnitKind::Program && !u.is_chart()) {
        let mut arrays = Elements { arrays: HashMap::new(), report };
        let mut vars = Vec::new();
        for variable in std::mem::take(&mut unit.vars) {
            let Some(array) = variable.decl.array.as_ref().filter(|_| of_chart(&variable)) else {
                vars.push(variable);
                continue;
            };
            let Some(name) = variable.decl.names.first().cloned() else { continue };
            let bounds: Option<Vec<(i128, i128)>> =
                array.dimensions.iter().map(|(a, b)| a.kind.whole().zip(b.kind.whole())).collect();
            let Some([(least, most)]) = bounds.as_deref() else {
                let what =
                    say!("an array of instances with a chart has one dimension, with numbers for its bounds");
                arrays.report.put(Problem::new(&codes::NOT_CARRIED, variable.decl.at.0, what));
                continue;
            };
            if most - least >= MOST {
                let what = say!("more instances of function blocks than are read");
                arrays.report.put(Problem::new(&codes::TOO_LARGE, variable.decl.at.0, what));
                continue;
            }
            for n in *least..=*most {
                let mut one = variable.clone();
                one.decl.array = None;
                one.decl.names = vec![Name::new(element(&name.text, n), name.at.0)];
                vars.push(one);
            }
            arrays.arrays.insert(name.text.to_uppercase(), (*least, *most));
        }
        unit.vars = vars;
        if !arrays.arrays.is_empty() {
            visit_mut::stmts(&mut unit.body, &mut arrays);
        }
    }
}

/// The name of a single instance.
fn element(array: &str, index: i128) -> String {
    format!("{array}_{}", number(index))
}

/// Gives elements of arrays of instances the names of single instances.
struct Elements<'r> {
    /// The bounds of each array, by its name in upper case.
    arrays: HashMap<String, (i128, i128)>,
    report: &'r mut Report,
}

impl Elements<'_> {
    fn single(&mut self, name: &Name, index: Option<i128>) -> Option<Name> {
        let (least, most) = self.arrays.get(&name.text.to_uppercase())?;
        if let Some(n) = index.filter(|n| (least..=most).contains(&n)) {
            return Some(Name::new(element(&name.text, n), name.at.0));
        }
        let what = say!("an instance with a chart is chosen by a number within the bounds of its array");
        self.report.put(Problem::new(&codes::NOT_CARRIED, name.at.0, what));
        None
    }
}

impl Visitor for Elements<'_> {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Element(path, index, bit) = &mut e.kind else { return };
        let Some(first) = path.names.first_mut() else { return };
        let bare = Name { text: first.text.trim_end_matches("[]").into(), at: first.at };
        let number = index.first().and_then(|i| i.kind.whole());
        let Some(name) = self.single(&bare, number) else { return };
        *first = name;
        index.remove(0);
        if index.is_empty() {
            path.names.extend(bit.take().map(|b| *b));
            e.kind = ExprKind::Path(Path { names: path.names.clone() });
        }
    }

    fn path(&mut self, path: &mut Path, how: Use, _: Span) {
        let Some(first) = path.names.first_mut().filter(|_| how == Use::Call) else { return };
        let Some((array, inner)) = first.text.strip_suffix(']').and_then(|t| t.split_once('[')) else {
            return;
        };
        let bare = Name { text: array.into(), at: first.at };
        let number = inner.parse().ok();
        if let Some(name) = self.single(&bare, number) {
            *first = name;
        }
    }
}
