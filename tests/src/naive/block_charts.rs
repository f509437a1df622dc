//! The charts of function blocks, as charts of the naive engine: one for each instance that a variable holds.

use g7_model::{Composed, Document, Expr, Item, Name, Path, VarDecl};

use super::arrays::element;
use super::composed::{Stands, with_constants};
use super::instances::{Made, whole};
use super::model::{FILE, Model, ScopeId};
use super::value::Run;

/// The instance of a function block that has a chart.
#[derive(Clone)]
pub(super) struct Home {
    /// The chart that declares its variable; none for a variable of the file.
    pub(super) chart: Option<String>,
    /// Its name there: `left`, `cell.side[2]`.
    pub(super) name: String,
    pub(super) block: String,
}

/// The charts of all instances in the variables of a file or chart.
pub(super) fn charts_of_var<'d>(doc: &'d Document, chart: Option<&str>, v: &VarDecl) -> Run<Vec<Made<'d>>> {
    let mut found = Vec::new();
    let Some(ty) = composed(doc, v) else { return Ok(found) };
    for name in &v.names {
        inside(doc, chart, (ty, None), (&name.text, v), &mut found)?;
    }
    Ok(found)
}

fn composed<'d>(doc: &'d Document, v: &VarDecl) -> Option<&'d Composed> {
    let of = v.of.as_ref()?;
    doc.items.iter().find_map(|i| match i {
        Item::Composed(c) if c.name.text == of.text => Some(c),
        _ => None,
    })
}

fn inside<'d>(
    doc: &'d Document,
    chart: Option<&str>,
    (ty, outer): (&'d Composed, Option<&'d Composed>),
    (name, v): (&str, &VarDecl),
    found: &mut Vec<Made<'d>>,
) -> Run<()> {
    let mut all: Vec<Vec<i128>> = vec![Vec::new()];
    for (least, most) in v.array.iter().flat_map(|a| &a.dimensions) {
        let bound = |e: &Expr| whole(doc, &outer.map_or_else(|| e.clone(), |of| with_constants(of, e)));
        let (least, most) = (bound(least)?, bound(most)?);
        all = all.iter().flat_map(|own| (least..=most).map(|n| [&own[..], &[n]].concat())).collect();
    }
    for own in all {
        let path = element(&Path { names: vec![Name::new(name, v.at.0)] }, &own).text();
        let prefix = chart.map_or(String::new(), |c| format!("{c}."));
        let charts = doc.charts().filter(|c| c.block.as_ref().is_some_and(|b| b.text == ty.name.text));
        for of_block in charts {
            let name = format!("{prefix}{path}.{}", of_block.name.text);
            let home =
                Home { chart: chart.map(str::to_owned), name: path.clone(), block: ty.name.text.to_string() };
            found.push(Made { chart: of_block, name: name.clone(), constants: Vec::new(), home: Some(home) });
            for v in of_block.vars() {
                found.extend(charts_of_var(doc, Some(&name), v)?);
            }
        }
        for member in &ty.members {
            let Some(inner) = composed(doc, member) else { continue };
            for name in &member.names {
                let part = format!("{path}.{}", name.text);
                inside(doc, chart, (inner, Some(ty)), (&part, member), found)?;
            }
        }
    }
    Ok(())
}

/// The charts that the variables of a chart have.
pub(super) fn charts_within<'d>(doc: &'d Document, made: &Made<'d>) -> Run<Vec<Made<'d>>> {
    let mut all = Vec::new();
    for v in made.chart.vars() {
        all.extend(charts_of_var(doc, Some(&made.name), v)?);
    }
    Ok(all)
}

impl Model {
    /// The meaning of a name in the chart of an instance, if it is a variable of the instance: in the chart of `left`,
    /// `close` means `left.close`. Returns the scope that declares the instance, and the path from there.
    pub(super) fn of_block(&self, scope: ScopeId, names: &[&str]) -> Option<(ScopeId, Vec<String>)> {
        let home = self.scopes[scope].home.as_ref()?;
        let (first, rest) = names.split_first()?;
        let bare = first.split('[').next()?;
        let ty = self.types.get(&home.block)?;
        ty.members.iter().find(|m| m.names.iter().any(|n| *n.text == *bare))?;
        let (at, name) = self.home_of(home)?;
        let joined = std::iter::once(format!("{name}.{first}")).chain(rest.iter().map(|n| (*n).to_owned()));
        Some((at, joined.collect()))
    }

    fn home_of(&self, home: &Home) -> Option<Stands> {
        let at = match &home.chart {
            None => FILE,
            Some(chart) => self.scopes.iter().position(|s| s.name == *chart)?,
        };
        Some((at, home.name.clone()))
    }

    /// The chart of an instance that a path begins with, and the number of its names.
    pub(super) fn block_chart(&self, scope: ScopeId, names: &[&str]) -> Option<(ScopeId, usize)> {
        (1..=names.len()).find_map(|k| Some((self.chart_named(scope, &names[..k].join("."))?, k)))
    }

    /// The path to a chart of the block whose body runs, from outside: `left.Cycle.X1` for `Cycle.X1`.
    pub(super) fn block_chart_of(&self, (scope, name): &Stands, path: &Path) -> Option<Path> {
        let prefix = if *scope == FILE { String::new() } else { format!("{}.", self.scopes[*scope].name) };
        let (first, rest) = path.names.split_first()?;
        let full = format!("{prefix}{name}.{}", first.text);
        self.chart_named(FILE, &full)?;
        let first = Name::new(full, first.at.0);
        Some(Path { names: std::iter::once(first).chain(rest.iter().cloned()).collect() })
    }

    /// The names under which a chart can be known in a scope: as a chart of the same instance, in a variable of the
    /// chart itself, and its full name.
    pub(super) fn chart_names(&self, scope: ScopeId, name: &str) -> Vec<String> {
        let s = &self.scopes[scope];
        let mut all = Vec::new();
        if let Some(home) = &s.home {
            let prefix = home.chart.as_ref().map_or(String::new(), |c| format!("{c}."));
            all.push(format!("{prefix}{}.{name}", home.name));
        }
        if scope != FILE {
            all.push(format!("{}.{name}", s.name));
        }
        all.push(name.to_owned());
        all
    }
}
