//! Declarations of variables.

use std::collections::HashSet;

use g7_model::codes;
use g7_model::{Name, Type, VarDecl, VarKind, say};

use super::addresses::{address, channel};
use super::read::{Pou, Section, SectionKind};
use super::tree::{Xml, head};
use super::types::{self, Shapes};
use super::units::{Meaning, Plan, Unit};
use crate::report::Report;
use crate::st;

/// The variables of a unit: those of the file and those of its chart.
#[derive(Default)]
pub(super) struct Declared {
    pub(super) of_file: Vec<VarDecl>,
    pub(super) of_chart: Vec<VarDecl>,
}

/// The global variables.
pub(super) fn globals<'a>(plan: &Plan<'a>, shapes: &mut Shapes<'a>, report: &mut Report) -> Vec<VarDecl> {
    let mut seen = HashSet::new();
    let mut found = Vec::new();
    for section in &plan.project.globals {
        for variable in &section.variables {
            let Some(name) = types::name(*variable, report) else { continue };
            if !seen.insert(name.text.to_uppercase()) {
                twice(&name, report);
                continue;
            }
            if let Some(Meaning::Unit(_)) = plan.globals.get(&name.text.to_uppercase()) {
                continue;
            }
            found.extend(declaration(plan, shapes, *variable, name, section, false, report));
        }
    }
    found
}

/// The variables of a unit.
pub(super) fn of_unit<'a>(
    plan: &Plan<'a>,
    shapes: &mut Shapes<'a>,
    unit: &Unit,
    pou: &Pou<'a>,
    report: &mut Report,
) -> Declared {
    let mut declared = Declared::default();
    let mut seen = HashSet::new();
    for section in &pou.sections {
        for variable in &section.variables {
            let Some(name) = types::name(*variable, report) else { continue };
            let upper = name.text.to_uppercase();
            if section.kind == SectionKind::External {
                if plan.globals.contains_key(&upper) {
                    continue;
                }
                let what = say!("no global variable is called `{}`; it is one of its own", name.text);
                report.say(&codes::OPEN_LINK, &head(*variable), what);
            }
            if !seen.insert(upper.clone()) {
                twice(&name, report);
                continue;
            }
            if matches!(unit.names.get(&upper), Some(Meaning::Unit(_))) {
                continue;
            }
            let decl = declaration(plan, shapes, *variable, name, section, unit.program, report);
            let place =
                if unit.of_file.contains(&upper) { &mut declared.of_file } else { &mut declared.of_chart };
            place.extend(decl);
        }
    }
    for decl in plan.code.made.get(&unit.pou).into_iter().flatten() {
        let own = decl.names.iter().any(|n| unit.of_file.contains(&n.text.to_uppercase()));
        if own { &mut declared.of_file } else { &mut declared.of_chart }.push(decl.clone());
    }
    declared
}

fn twice(name: &Name, report: &mut Report) {
    let what = say!("`{}` is declared twice", name.text);
    report.put(g7_model::Problem::new(&codes::TWICE, name.at.0, what));
}

/// Declares one variable; None if its type has no counterpart.
fn declaration<'a>(
    plan: &Plan<'a>,
    shapes: &mut Shapes<'a>,
    variable: Xml<'a>,
    name: Name,
    section: &Section,
    program: bool,
    report: &mut Report,
) -> Option<VarDecl> {
    let shape = shapes.shape(variable, &name, report)?;
    let of = shape.unknown();
    if let Some(ty) = of.filter(|of| !plan.is_block(of)) {
        let what = say!("`{}` is of type `{}`, which has no counterpart", name.text, ty.text);
        report.say(&codes::NOT_CARRIED, &head(variable), what);
        return None;
    }
    let mut decl = shapes.declaration(variable, &name, &shape, report);
    decl.kind = match matches!(decl.ty, Type::Fb(_)) || of.is_some() {
        true => VarKind::Var,
        false => kind(section, channel(variable), program),
    };
    if decl.kind == VarKind::Input && section.kind == SectionKind::InOut {
        let what = say!("a variable of both directions; it is an input here");
        report.say(&codes::DIFFERENT, &head(variable), what);
    }
    decl.address = address(variable, report);
    decl.retain = section.retain && decl.kind == VarKind::Var;
    st::fit(&mut decl).into_iter().for_each(|p| report.put(p));
    Some(decl)
}

fn kind(section: &Section, channel: Option<char>, program: bool) -> VarKind {
    if section.is_constant() {
        return VarKind::Const;
    }
    // Names of lists of global variables say nothing about their use, except for the lists that we
    // write.
    let list = section.name.as_deref().filter(|_| section.kind == SectionKind::Global);
    match (section.kind, channel) {
        (_, None | Some('M')) if list == Some("Inputs") => VarKind::Input,
        (_, None | Some('M')) if list == Some("Outputs") => VarKind::Output,
        (SectionKind::Input | SectionKind::InOut, _) if program => VarKind::Input,
        (SectionKind::Output, _) if program => VarKind::Output,
        (_, Some('I')) => VarKind::Input,
        (_, Some('Q')) => VarKind::Output,
        _ => VarKind::Var,
    }
}
