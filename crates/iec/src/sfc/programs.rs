//! The programs that a configuration runs: one that runs more than once is a unit for each time, and parameters are
//! copied from and to what the configuration connects them with (IEC 61131-3:2003, 2.7.1).
//!
//! ```text
//! read (Source) -> here -> resources -> enabled
//! ```
//!
//! A parameter that is connected with an address stays: `build` gives it that address.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Expr, ExprKind, Name, Path, Problem, Span, VarKind, codes, say};

use super::unit::{Instance, Renamed, Source, Unit, UnitKind, each, upper};
use crate::nodes::{self, Taken};
use crate::report::Report;
use crate::st::{Section, Variable};

/// The most programs that a configuration runs.
const MOST_PROGRAMS: usize = 2_000;
/// The most bytes of text of all programs that run more than once, each counted as often as it runs.
const MOST_TEXT: u64 = 1 << 24;

/// Gives each program of the configuration a unit of its own, and connects its parameters.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let mut taken = source.names();
    let mut runs: HashMap<String, Vec<&mut Instance>> = HashMap::new();
    let of_resources = source.resources.iter_mut().flat_map(|r| &mut r.instances);
    for instance in source.instances.iter_mut().chain(of_resources) {
        runs.entry(upper(&instance.unit)).or_default().push(instance);
    }
    let (mut units, mut text) = (Vec::new(), 0);
    for mut unit in std::mem::take(&mut source.units) {
        let program = unit.kind == UnitKind::Program;
        let mut runs = runs.remove(&upper(&unit.name)).filter(|_| program).unwrap_or_default();
        if let [instance] = runs.as_mut_slice() {
            connect(&mut unit, instance);
        }
        if runs.len() < 2 {
            units.push(unit);
            continue;
        }
        for instance in runs {
            text += u64::from(unit.at.end.saturating_sub(unit.at.start));
            if units.len() >= MOST_PROGRAMS || text > MOST_TEXT {
                report.put(Problem::new(
                    &codes::TOO_LARGE,
                    instance.at,
                    say!("more programs run than are read"),
                ));
                break;
            }
            let name = Name::new(taken.give(&instance.name.text), instance.name.at.0);
            instance.unit = name.clone();
            let mut own = Unit { name, ..unit.clone() };
            connect(&mut own, instance);
            units.push(own);
        }
    }
    source.units = units;
}

/// Copies the connected parameters of a program: inputs before it runs, outputs behind it.
fn connect(unit: &mut Unit, instance: &mut Instance) {
    let (at_addresses, copied): (Vec<_>, Vec<_>) = std::mem::take(&mut instance.links)
        .into_iter()
        .partition(|(_, value)| matches!(value.kind, ExprKind::Direct(_) | ExprKind::Bad));
    instance.links = at_addresses;
    let (mut taken, mut renamed) = (unit.names(), HashMap::new());
    for (mut name, value) in copied {
        apart(unit, &value, &mut taken, &mut renamed);
        rename(&mut name, &renamed);
        let named = |v: &&mut Variable| v.decl.names.iter().any(|n| upper(n) == upper(&name));
        let parameter = |v: &&mut Variable| match v.section {
            Section::Input => true,
            Section::Output => matches!(value.kind, ExprKind::Path(_) | ExprKind::Element(..)),
            _ => false,
        };
        let Some(variable) = unit.vars.iter_mut().find(named).filter(parameter) else {
            instance.links.push((name, value));
            continue;
        };
        if matches!(variable.decl.kind, VarKind::Input | VarKind::Output) {
            variable.decl.kind = VarKind::Var;
        }
        let at = name.at.0;
        let own = nodes::expr(ExprKind::Path(Path { names: vec![name] }), at);
        match variable.section {
            Section::Output => unit.after.push(nodes::assign(value, own, at)),
            _ => unit.before.push(nodes::assign(own, value, at)),
        }
    }
    instance.links.iter_mut().for_each(|(name, _)| rename(name, &renamed));
}

fn rename(name: &mut Name, renamed: &HashMap<String, String>) {
    if let Some(own) = renamed.get(&upper(name)) {
        name.text = own.as_str().into();
    }
}

/// Gives variables of the unit other names where the value names global variables that they would hide.
fn apart(unit: &mut Unit, value: &Expr, taken: &mut Taken, renamed: &mut HashMap<String, String>) {
    let mut names = Names::default();
    visit_mut::expr(&mut value.clone(), &mut names);
    let mut now = HashMap::new();
    for name in
        unit.vars.iter_mut().filter(|v| v.section != Section::External).flat_map(|v| &mut v.decl.names)
    {
        if names.0.contains(&upper(name)) {
            let own = taken.give(&name.text);
            now.insert(upper(name), own.clone());
            name.text = own.into();
        }
    }
    if !now.is_empty() {
        each(unit, &mut Renamed(&now));
        renamed.extend(now);
    }
}

/// The first names of all paths, in upper case.
#[derive(Default)]
struct Names(HashSet<String>);

impl Visitor for Names {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        self.0.extend(path.names.first().map(|n| g7_model::bare(&n.text).0.to_uppercase()));
    }
}
