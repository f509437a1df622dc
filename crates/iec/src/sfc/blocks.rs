//! Makes function blocks of the document from the function blocks of the file that have no chart.
//!
//! ```text
//! read (Source) -> instances -> here -> build
//! ```
//!
//! Function blocks without an instance stay in the list of units; `build` reports them.

use std::collections::HashSet;

use g7_model::{
    Block, Body, Composed, Local, Name, Problem, Said, Span, Stmt, StmtKind, Type, VarDecl, VarKind, codes,
    say,
};

use super::unit::{Part, Source, Unit, UnitKind};
use crate::report::Report;
use crate::st::{Section, Variable};

/// Takes the function blocks that are used out of the units.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let used = used(source);
    if used.is_empty() {
        return;
    }
    let units = std::mem::take(&mut source.units);
    let (blocks, rest): (Vec<Unit>, Vec<Unit>) =
        units.into_iter().partition(|u| is_block(u) && used.contains(&u.name.text.to_uppercase()));
    source.units = rest;
    for block in blocks {
        let made = composed(source, &used, block, report);
        source.blocks.push(made);
    }
}

fn is_block(unit: &Unit) -> bool {
    unit.kind == UnitKind::FunctionBlock && !unit.is_chart()
}

/// The names in upper case of the function blocks of which there are instances.
fn used(source: &Source) -> HashSet<String> {
    let blocks: HashSet<String> =
        source.units.iter().filter(|u| is_block(u)).map(|u| u.name.text.to_uppercase()).collect();
    let of = |v: &VarDecl| v.of.as_ref().map(|of| of.text.to_uppercase());
    let globals = source.globals.iter().map(|v| &v.decl);
    let locals = source.units.iter().filter(|u| !is_block(u)).flat_map(|u| &u.vars).map(|v| &v.decl);
    let members = source.types.structures.iter().flat_map(|s| &s.members);
    let mut open: Vec<String> = globals.chain(locals).chain(members).filter_map(of).collect();
    let mut used = HashSet::new();
    while let Some(name) = open.pop() {
        if blocks.contains(&name) && used.insert(name.clone()) {
            let own = source.units.iter().filter(|u| is_block(u) && u.name.text.to_uppercase() == name);
            open.extend(own.flat_map(|u| &u.vars).filter_map(|v| of(&v.decl)));
        }
    }
    used
}

/// A function block of the document.
fn composed(source: &mut Source, used: &HashSet<String>, unit: Unit, report: &mut Report) -> Composed {
    let known = |name: &Name| used.contains(&name.text.to_uppercase());
    lost_actions(&unit, report);
    foreign(&unit, report);
    let (mut members, mut inouts, mut locals) = (Vec::new(), Vec::new(), Vec::new());
    for Variable { section, mut decl, unknown } in unit.vars {
        if let Some(of) = unknown.filter(|of| !known(of)) {
            report.put(Problem::new(&codes::NOT_CARRIED, decl.at.0, no_type(source, &of)));
            continue;
        }
        match section {
            Section::External => source.externals.push(Variable { section, decl, unknown: None }),
            Section::InOut => {
                decl.kind = VarKind::Var;
                inouts.push(decl);
            }
            Section::Temp if is_local(&decl) => locals.push(local(decl)),
            Section::Temp | Section::Local | Section::Global | Section::Input | Section::Output => {
                if section == Section::Temp {
                    let name = decl.names.first().map_or("", |n| &*n.text);
                    let what = say!("`{name}` keeps its value from scan to scan");
                    report.put(Problem::new(&codes::DIFFERENT, decl.at.0, what));
                }
                members.push(member(section, decl, report));
            }
        }
    }
    let mut statements = unit.body;
    ended(&mut statements);
    let body_at = if unit.body_at.is_empty() {
        Span { start: unit.at.end, ..unit.at }
    } else {
        report.span(&unit.body_at)
    };
    let body = Body::St(Block { locals, statements, at: body_at.into() });
    let at = unit.at.into();
    Composed { name: unit.name, comment: None, members, inouts, block: true, body: Some(body), at }
}

/// A local variable of a body.
pub(super) fn local(decl: VarDecl) -> Local {
    Local { ty: decl.value_type(), names: decl.names, init: decl.init, at: decl.at }
}

/// True if a variable can be a local one of a body.
fn is_local(decl: &VarDecl) -> bool {
    decl.array.is_none() && decl.of.is_none() && !matches!(decl.ty, Type::Fb(_))
}

fn member(section: Section, mut decl: VarDecl, report: &mut Report) -> VarDecl {
    if let Some(address) = decl.address.take() {
        let what = say!("a variable of a function block has no address; `{}` is left out", address.text);
        report.put(Problem::new(&codes::NOT_CARRIED, address.at.0, what));
    }
    decl.kind = match (section, decl.kind) {
        (_, VarKind::Const) => VarKind::Const,
        (Section::Input, _) => VarKind::Input,
        (Section::Output, _) => VarKind::Output,
        _ => VarKind::Var,
    };
    decl.retain &= decl.kind == VarKind::Var;
    decl
}

/// The reason why there is no variable of a type.
pub(super) fn no_type(source: &Source, ty: &Name) -> Said {
    match source.units.iter().find(|u| u.name.text.eq_ignore_ascii_case(&ty.text)) {
        Some(unit) if unit.is_chart() => say!(
            "an instance of `{}`; that chart is carried over once, on its own, and not as a part of this unit",
            ty.text
        ),
        Some(_) => say!("an instance of `{}`, which is no function block", ty.text),
        None => say!("there is no type `{}`", ty.text),
    }
}

/// Reports statements of another language in a unit that is carried over.
pub(super) fn foreign(unit: &Unit, report: &mut Report) {
    unit.foreign
        .iter()
        .for_each(|at| report.put(Problem::new(&codes::NOT_CARRIED, *at, crate::st::foreign())));
}

/// Reports actions of a unit without steps, because nothing runs them.
pub(super) fn lost_actions(unit: &Unit, report: &mut Report) {
    for part in &unit.parts {
        if let Part::Action { name, .. } = part {
            let what = say!("the action `{}` of a unit without steps is left out", name.text);
            report.put(Problem::new(&codes::LEFT_OUT, name.at.0, what));
        }
    }
}

/// RETURN at the end of a body says nothing.
fn ended(list: &mut Vec<Stmt>) {
    while list.last().is_some_and(|s| s.kind == StmtKind::Return) {
        list.pop();
    }
}
