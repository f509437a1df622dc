//! Joins the resources of a configuration: one controller runs all programs here.
//!
//! ```text
//! read (Source) -> here -> enabled
//! ```
//!
//! Tasks belong to their resource, and so do its global variables: one whose name something else has is called
//! `resource_name`, in the programs of that resource as well.

use std::collections::{HashMap, HashSet};

use g7_model::{Name, Problem, codes, say};

use super::unit::{Renamed, Resource, Source, Unit, UnitKind, each, upper};
use crate::nodes::Taken;
use crate::report::Report;
use crate::st::{Section, Variable};

/// Moves what the resources have to the file.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let resources = std::mem::take(&mut source.resources);
    if let Some(second) = resources.get(1) {
        let what = say!("the programs of all resources run in one controller here, one behind the other");
        report.put(Problem::new(&codes::DIFFERENT, second.name.at.0, what));
    }
    let mut taken = Taken::default();
    source.globals.iter().flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
    let several = resources.len() > 1;
    for mut resource in resources {
        if several {
            own_tasks(&mut resource);
            let renamed = own_globals(&mut resource, &mut taken);
            rename(source, &resource, &renamed, report);
        }
        source.globals.append(&mut resource.globals);
        source.tasks.append(&mut resource.tasks);
        source.instances.append(&mut resource.instances);
    }
}

/// Two resources can have a task of one name.
fn own_tasks(resource: &mut Resource) {
    let full = |name: &Name| Name::new(format!("{}.{}", resource.name.text, name.text), name.at.0);
    for task in resource.instances.iter_mut().filter_map(|i| i.task.as_mut()) {
        if resource.tasks.iter().any(|t| upper(&t.name) == upper(task)) {
            *task = full(task);
        }
    }
    resource.tasks.iter_mut().for_each(|t| t.name = full(&t.name));
}

/// The new names of the global variables of a resource, by the old ones in upper case.
fn own_globals(resource: &mut Resource, taken: &mut Taken) -> HashMap<String, String> {
    let mut renamed = HashMap::new();
    for name in resource.globals.iter_mut().flat_map(|v| &mut v.decl.names) {
        if !taken.take(&name.text) {
            let own = taken.give(&format!("{}_{}", resource.name.text, name.text));
            renamed.insert(upper(name), own.clone());
            name.text = own.into();
        }
    }
    renamed
}

/// Gives the programs of a resource the new names of its variables.
fn rename(source: &mut Source, resource: &Resource, renamed: &HashMap<String, String>, report: &mut Report) {
    if renamed.is_empty() {
        return;
    }
    let runs: HashSet<String> = resource.instances.iter().map(|i| upper(&i.unit)).collect();
    let external = |v: &Variable| v.section == Section::External;
    let meant = |v: &Variable| v.decl.names.iter().any(|n| renamed.contains_key(&upper(n)));
    for unit in &mut source.units {
        if unit.kind == UnitKind::Program {
            if runs.contains(&upper(&unit.name)) {
                in_program(unit, renamed);
            }
            continue;
        }
        if let Some(v) = unit.vars.iter().find(|v| external(v) && meant(v)) {
            let name = v.decl.names.first().map_or("", |n| &*n.text);
            let what = say!(
                "`{name}` is a variable of several resources; a function block can name one of them alone"
            );
            report.put(Problem::new(&codes::NOT_CARRIED, v.decl.at.0, what));
        }
    }
}

fn in_program(unit: &mut Unit, renamed: &HashMap<String, String>) {
    let hidden = |v: &&Variable| v.section != Section::External;
    let own: HashSet<String> =
        unit.vars.iter().filter(hidden).flat_map(|v| &v.decl.names).map(upper).collect();
    let meant: HashMap<String, String> =
        renamed.iter().filter(|(n, _)| !own.contains(*n)).map(|(n, own)| (n.clone(), own.clone())).collect();
    for name in unit.vars.iter_mut().flat_map(|v| &mut v.decl.names) {
        if let Some(own) = meant.get(&upper(name)) {
            name.text = own.as_str().into();
        }
    }
    each(unit, &mut Renamed(&meant));
}
