//! From a document to its typed form: every name to a row, every expression to a type.
//!
//! ```text
//! model::Document -> resolve -> ir::Unit -> check, lower
//! ```
//!
//! Order of work: rules; charts and steps; variables, with their values;
//! nesting of charts; functions, sections and bodies; actions and transitions.
//!
//! # What must hold
//!
//! - It never fails: what has no meaning is left out and reported, once.
//! - Whatever is in the [`Unit`] is well typed (see [`crate::ir`]), charts nest
//!   without circles, functions call without circles.
//! - The work is linear in the document: every lookup is by hash.

mod actions;
mod arrays;
mod bcd;
mod bits;
mod bodies;
mod call;
mod charts;
mod constant;
mod expr;
mod fb;
mod literals;
mod made;
mod moments;
mod operator;
mod process;
mod refer;
mod resolver;
mod rules;
mod scopes;
mod standard;
mod stmt;
mod system;
#[cfg(test)]
mod tests;
mod trace;
mod types;
mod vars;

use g7_model::{
    Chart, ChartItem, Document, Expr as Written, Item, Nanos, Problem, ProfileName, Type, codes, say,
};

use crate::held;
use crate::ir::{ChartId, Expr, Unit};
pub use call::conversion;
use resolver::{Frame, Resolver, Role};
pub use rules::{of_profile, with_switch};
pub use scopes::Scopes;
pub use system::{kept_by_system, set_by_terminal, terminal};
pub(crate) use trace::{Followed, Traced, Tracer};
pub use types::common;

/// Nominal scan time where none is written: 10 ms.
const CYCLE: Nanos = Nanos::from_millis(10);

/// Resolves a document. A profile given here replaces the one of the document, switches included.
pub fn resolve(doc: &Document, profile: Option<ProfileName>) -> (Unit, Vec<Problem>) {
    let (unit, _, problems) = resolve_open(doc, profile);
    (unit, problems)
}

/// Resolves a document and keeps the names for later questions ([`resolve_query`]).
pub fn resolve_open(doc: &Document, profile: Option<ProfileName>) -> (Unit, Scopes<'_>, Vec<Problem>) {
    let mut unit = Unit::default();
    let mut scopes = Scopes::default();
    let mut problems = Vec::new();
    (unit.profile, unit.rules) = rules::of_document(doc, profile, &mut problems);
    settings(doc, &mut unit, &mut problems);
    let charts: Vec<&Chart> = doc.charts().collect();
    let mut r = Resolver::new(&mut unit, &mut scopes);
    r.declare_charts(&charts);
    declare_names(&mut r, doc, &charts);
    r.link_charts(&charts);
    r.fill_bodies(doc);
    for (k, chart) in charts.iter().enumerate() {
        let id = ChartId(k as u32);
        r.in_chart(Some(id), |r| r.fill_chart(id, chart));
    }
    r.unused_sections();
    problems.append(&mut r.problems);
    problems.sort_by_key(|p| p.at);
    (unit, scopes, problems)
}

/// Resolves an expression of a test or of the debugger, seen from a chart or from the file, in its
/// own type or in the one given. It can read any variable and any step. It has no edges and no
/// delays, because these need a scan before.
pub fn resolve_query<'d>(
    unit: &mut Unit,
    scopes: &mut Scopes<'d>,
    e: &Written,
    chart: Option<ChartId>,
    ty: Option<Type>,
) -> (Option<Expr>, Vec<Problem>) {
    let mut r = Resolver::new(unit, scopes);
    r.frame = Frame { chart, role: Role::Query, ..Frame::default() };
    let expr = match ty {
        Some(ty) => r.value(e, ty),
        None => r.any_value(e),
    };
    (expr, r.problems)
}

/// Scan time and target.
#[inline(never)]
fn settings(doc: &Document, unit: &mut Unit, problems: &mut Vec<Problem>) {
    let (mut cycle, mut target) = (None, None);
    for item in &doc.items {
        let (what, at, before) = match item {
            Item::Cycle(time, at) => {
                unit.cycle = if cycle.is_none() { *time } else { unit.cycle };
                if *time <= Nanos::ZERO {
                    problems.push(Problem::new(
                        &codes::OUT_OF_RANGE,
                        at.0,
                        say!("a scan takes more than no time"),
                    ));
                }
                (say!("the scan time"), at.0, cycle.replace(at.0))
            }
            Item::Target(plc, at) => {
                unit.target = unit.target.or(Some(*plc));
                (say!("the target"), at.0, target.replace(at.0))
            }
            _ => continue,
        };
        if let Some(before) = before {
            let problem = Problem::new(&codes::DEFINED_TWICE, at, say!("{what} is given twice"));
            problems.push(problem.related(before, say!("given here first")));
        }
    }
    if unit.cycle <= Nanos::ZERO {
        unit.cycle = CYCLE;
    }
}

/// Declares all names except those of charts and steps; then resolves the values of the variables,
/// those of the file first.
#[inline(never)]
fn declare_names<'d>(r: &mut Resolver<'_, 'd>, doc: &'d Document, charts: &[&'d Chart]) {
    let types =
        doc.items.iter().filter_map(|i| if let Item::Type(t) = i { held::enumeration(t) } else { None });
    r.scopes.enumerations = types.collect();
    let mut declared = Vec::new();
    for item in &doc.items {
        match item {
            Item::Var(d) => declared.push((None, d, r.declare(None, d))),
            Item::Action(a) => r.declare_action(None, a),
            Item::Section(s) => r.declare_section(None, s),
            Item::Function(f) => r.declare_function(f),
            _ => {}
        }
    }
    for (k, chart) in charts.iter().enumerate() {
        let id = Some(ChartId(k as u32));
        for item in &chart.items {
            match item {
                ChartItem::Var(d) => declared.push((id, d, r.declare(id, d))),
                ChartItem::Action(a) => r.declare_action(id, a),
                ChartItem::Section(s) => r.declare_section(id, s),
                ChartItem::Step(_) | ChartItem::Transition(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
            }
        }
    }
    r.name_elements_once();
    for (chart, decl, ids) in declared {
        r.give_values(chart, decl, &ids);
    }
}
