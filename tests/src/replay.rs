//! Replays a trace of a case on a subject and compares it row by row.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Document, ProfileName, Type};

use crate::case::{End, Line, Row, Trace, demand, expression};
use crate::naive::{Naive, Value};
use crate::subject::{Backend, Fault, Subject};

/// Replays a trace; an error names the line in which it fails.
///
/// # Errors
///
/// The first difference.
pub fn replay(doc: &Document, profile: ProfileName, trace: &Trace, backend: Backend) -> Result<(), String> {
    let mut subject = backend(doc, Some(profile), &queries(trace)?)?;
    // The naive engine knows the declarations: the types of inputs and of literals.
    let names = Naive::new(doc, Some(profile))?;
    let inputs = names.inputs();
    let mut ended = false;
    for line in &trace.lines {
        match line {
            Line::Restart { cold } => {
                subject.restart(*cold);
                ended = false;
            }
            Line::Row(row) if ended => return Err(format!("line {}: a row behind a fault", row.line)),
            Line::Row(row) => {
                let values = input_values(row, &inputs, &names)?;
                let verdict = subject.scan(&values, row.at);
                ended = verdict.is_err();
                check(row, verdict, &mut *subject, &names)
                    .map_err(|why| format!("line {}: {why}", row.line))?;
            }
        }
    }
    Ok(())
}

/// All expressions that the rows need.
fn queries(trace: &Trace) -> Result<Vec<g7_model::Expr>, String> {
    let mut all = Vec::new();
    for line in &trace.lines {
        let Line::Row(row) = line else { continue };
        // Bits that the terminal sets are there, as if the chart named them.
        for (name, _) in row.inputs.iter().filter(|(name, _)| name.starts_with('%')) {
            let e = expression(name)?;
            if !all.contains(&e) {
                all.push(e);
            }
        }
        let out = row.out.iter().flatten().filter(|item| item.contains('='));
        for item in row.vars.iter().chain(out) {
            let e = demand(item)?;
            if !all.contains(&e) {
                all.push(e);
            }
        }
    }
    Ok(all)
}

pub(crate) fn input_values(
    row: &Row,
    inputs: &[(String, Type)],
    names: &Naive,
) -> Result<BTreeMap<String, Value>, String> {
    let mut values: BTreeMap<String, Value> = BTreeMap::new();
    for (name, ty) in inputs {
        if *ty == Type::Bool {
            values.insert(name.clone(), Value::Bool(false));
        }
    }
    for (name, value) in &row.inputs {
        // A system bit keeps its value where the row does not name it.
        if name.starts_with("%S") {
            let ty = if name.starts_with("%SW") { Type::Uint } else { Type::Bool };
            let value = match value {
                None if ty == Type::Bool => Value::Bool(true),
                None => return Err(format!("line {}: `{name}` needs a value", row.line)),
                Some(text) => names.constant(&expression(text)?, ty).map_err(|f| format!("{f:?}"))?,
            };
            values.insert(name.clone(), value);
            continue;
        }
        let mut fits = inputs.iter().filter(|(n, _)| matches(n, name));
        let (Some((full, ty)), None) = (fits.next(), fits.next()) else {
            return Err(format!("line {}: no input `{name}`", row.line));
        };
        let value = match value {
            None if *ty == Type::Bool => Value::Bool(true),
            None => return Err(format!("line {}: `{name}` needs a value", row.line)),
            Some(text) => names.constant(&expression(text)?, *ty).map_err(|f| format!("{f:?}"))?,
        };
        values.insert(full.clone(), value);
    }
    Ok(values)
}

/// True if the last parts of a qualified name are those of `meant`.
fn matches(qualified: &str, meant: &str) -> bool {
    qualified == meant || qualified.strip_suffix(meant).is_some_and(|rest| rest.ends_with('.'))
}

fn check(
    row: &Row,
    verdict: Result<(), Fault>,
    subject: &mut dyn Subject,
    names: &Naive,
) -> Result<(), String> {
    match (&row.end, &verdict) {
        (End::Situation(want), Ok(())) => situation(want, &subject.active())?,
        (End::Situation(_), Err(fault)) => return Err(format!("fault {fault:?}")),
        (End::Fault(kind, _), Ok(())) => {
            return Err(format!("no fault {kind}, but {:?}", subject.active()));
        }
        (End::Fault(kind, cycle), Err(fault)) => {
            if fault.kind() != kind {
                return Err(format!("want fault {kind}, got {fault:?}"));
            }
            if let Fault::Unstable(got) = fault
                && !cycle.is_empty()
            {
                same_cycle(cycle, got)?;
            }
        }
    }
    if let Some(want) = &row.out {
        outputs(want, subject, names)?;
    }
    for item in &row.vars {
        if !subject.holds(&demand(item)?)? {
            let name = item.split_once('=').map_or(&**item, |(n, _)| n);
            let value = subject.variables().remove(name);
            return Err(format!("`{item}` does not hold ({value:?}), in {:?}", subject.active()));
        }
    }
    let conflicts = subject.conflicts();
    for name in &row.conflicts {
        if !conflicts.iter().any(|c| matches(c, name)) {
            return Err(format!("no diagnostic conflicting {name}, but {conflicts:?}"));
        }
    }
    Ok(())
}

fn situation(want: &[String], got: &BTreeSet<String>) -> Result<(), String> {
    let mut left: Vec<&String> = got.iter().collect();
    for name in want {
        let Some(i) = left.iter().position(|g| matches(g, name)) else {
            return Err(format!("want {want:?}, got {got:?}"));
        };
        left.remove(i);
    }
    if left.is_empty() { Ok(()) } else { Err(format!("want {want:?}, got {got:?}")) }
}

/// Compares cycles; a cycle may start with any of its situations.
fn same_cycle(want: &[Vec<String>], got: &[BTreeSet<String>]) -> Result<(), String> {
    let fits = |turn: usize| {
        want.iter()
            .enumerate()
            .all(|(i, w)| got.get((i + turn) % got.len().max(1)).is_some_and(|g| situation(w, g).is_ok()))
    };
    if want.len() == got.len() && (0..got.len()).any(fits) {
        Ok(())
    } else {
        Err(format!("want the cycle {want:?}, got {got:?}"))
    }
}

fn outputs(want: &[String], subject: &dyn Subject, names: &Naive) -> Result<(), String> {
    let all = subject.outputs();
    let mut left: BTreeSet<String> =
        all.iter().filter(|(_, v)| **v == Value::Bool(true)).map(|(n, _)| n.clone()).collect();
    let on = left.clone();
    for item in want {
        if let Some((name, value)) = item.split_once('=') {
            // The value that the plant receives; after a fault it differs from the chart's own.
            let Some((full, got)) = all.iter().find(|(n, _)| matches(n, name)) else {
                return Err(format!("no output `{name}`"));
            };
            let ty = names.variables().into_iter().find(|(n, ..)| n == full).map(|(_, ty, _)| ty);
            let ty = ty.ok_or_else(|| format!("no type of `{name}`"))?;
            let want = names.constant(&expression(value)?, ty).map_err(|f| format!("{f:?}"))?;
            if *got != want {
                return Err(format!("output `{item}` wanted, got {got:?}"));
            }
            left.remove(full);
            continue;
        }
        let Some(name) = left.iter().find(|n| matches(n, item)).cloned() else {
            return Err(format!("want outputs {want:?}, got {on:?} in {:?}", subject.active()));
        };
        left.remove(&name);
    }
    if left.is_empty() {
        Ok(())
    } else {
        Err(format!("want outputs {want:?}, got {on:?} in {:?}", subject.active()))
    }
}
