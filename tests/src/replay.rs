//! A trace of a case, replayed on a subject and compared row by row.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Document, ProfileName, Type};

use crate::case::{End, Line, Row, Trace, demand, expression};
use crate::naive::{Naive, Value};
use crate::subject::{Backend, Fault, Subject};

/// Runs a trace and says in which line it fails.
///
/// # Errors
///
/// The first disagreement.
pub fn replay(doc: &Document, profile: ProfileName, trace: &Trace, backend: Backend) -> Result<(), String> {
    let mut subject = backend(doc, Some(profile))?;
    // The naive engine knows the declarations: types of inputs and literals.
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
                check(row, verdict, &mut *subject).map_err(|why| format!("line {}: {why}", row.line))?;
            }
        }
    }
    Ok(())
}

fn input_values(
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

/// Whether a qualified name is meant by its last parts.
fn matches(qualified: &str, meant: &str) -> bool {
    qualified == meant || qualified.strip_suffix(meant).is_some_and(|rest| rest.ends_with('.'))
}

fn check(row: &Row, verdict: Result<(), Fault>, subject: &mut dyn Subject) -> Result<(), String> {
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
        outputs(want, subject)?;
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

/// The same cycle from any of its situations.
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

fn outputs(want: &[String], subject: &mut dyn Subject) -> Result<(), String> {
    let mut left: BTreeSet<String> =
        subject.outputs().into_iter().filter(|(_, v)| *v == Value::Bool(true)).map(|(n, _)| n).collect();
    let on = left.clone();
    for item in want {
        if item.contains('=') {
            if !subject.holds(&demand(item)?)? {
                return Err(format!("`{item}` does not hold"));
            }
            let name = item.split_once('=').map_or(&**item, |(n, _)| n).to_owned();
            left.retain(|n| !matches(n, &name));
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
