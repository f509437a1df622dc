//! Declarations of variables.

use std::collections::HashSet;

use g7_model::codes;
use g7_model::{Array, Expr, Name, Type, VarDecl, VarKind, say};

use super::read::{Pou, Section, SectionKind};
use super::tree::{Xml, documentation, head, kid, text};
use super::types::{self, Known};
use super::units::{Meaning, Plan, Unit, name_of};
use crate::nodes::line;
use crate::report::Report;
use crate::xml::attr::Text;

/// The variables of a unit: those of the file and those of its chart.
#[derive(Default)]
pub(super) struct Declared {
    pub(super) of_file: Vec<VarDecl>,
    pub(super) of_chart: Vec<VarDecl>,
}

/// The global variables.
pub(super) fn globals(plan: &Plan, report: &mut Report) -> Vec<VarDecl> {
    let mut seen = HashSet::new();
    let mut found = Vec::new();
    for section in &plan.project.globals {
        for variable in &section.variables {
            let Some(name) = named(*variable, report) else { continue };
            if !seen.insert(name.text.to_uppercase()) {
                twice(&name, report);
                continue;
            }
            if let Some(Meaning::Unit(_)) = plan.globals.get(&name.text.to_uppercase()) {
                continue;
            }
            found.extend(declaration(plan, *variable, name, section, false, report));
        }
    }
    found
}

/// The variables of a unit.
pub(super) fn of_unit(plan: &Plan, unit: &Unit, pou: &Pou, report: &mut Report) -> Declared {
    let mut declared = Declared::default();
    let mut seen = HashSet::new();
    for section in &pou.sections {
        for variable in &section.variables {
            let Some(name) = named(*variable, report) else { continue };
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
            let decl = declaration(plan, *variable, name, section, unit.program, report);
            let place =
                if unit.of_file.contains(&upper) { &mut declared.of_file } else { &mut declared.of_chart };
            place.extend(decl);
        }
    }
    declared
}

fn twice(name: &Name, report: &mut Report) {
    let what = say!("`{}` is declared twice", name.text);
    report.put(g7_model::Problem::new(&codes::TWICE, name.at.0, what));
}

fn named(variable: Xml, report: &mut Report) -> Option<Name> {
    let Some(name) = name_of(variable) else {
        report.say(&codes::LEFT_OUT, &head(variable), say!("a variable without a name; it is left out"));
        return None;
    };
    let at = text(variable, "name").map_or_else(|| head(variable), |t| t.at);
    Some(Name::new(name, report.span(&at)))
}

/// Declares one variable; None if its type has no counterpart.
fn declaration<'a>(
    plan: &Plan<'a>,
    variable: Xml<'a>,
    name: Name,
    section: &Section,
    program: bool,
    report: &mut Report,
) -> Option<VarDecl> {
    types::judge(variable, report);
    let at = report.span(&head(variable));
    let (bounds, of_elements) = types::array(variable, &plan.project.types, report).unzip();
    let array = bounds.map(|dimensions| Box::new(Array { dimensions, at: at.into() }));
    let ty = match of_elements.map_or_else(|| types::meant(variable, &plan.project.types), Known::Type) {
        Known::Type(ty) => ty,
        Known::Derived(ty) => {
            let what = say!("`{}` is of type `{}`, which has no counterpart", name.text, line(&ty));
            report.say(&codes::NOT_CARRIED, &head(variable), what);
            return None;
        }
        Known::None => {
            let what = say!("`{}` is of a type that has no counterpart", name.text);
            report.say(&codes::NOT_CARRIED, &head(variable), what);
            return None;
        }
    };
    let address = address(variable, report);
    let kind = kind(section, ty, channel(variable), program);
    let mut init = types::initial(variable, ty, report);
    if kind == VarKind::Const && init.is_none() && array.is_none() {
        init = Some(Expr::zero(ty, at.into()));
    }
    if kind == VarKind::Input && section.kind == SectionKind::InOut {
        let what = say!("a variable of both directions; it is an input here");
        report.say(&codes::DIFFERENT, &head(variable), what);
    }
    Some(VarDecl {
        array,
        init,
        address: address.filter(|_| kind != VarKind::Const),
        retain: section.retain && kind == VarKind::Var,
        comment: documentation(variable).map(Into::into),
        ..VarDecl::new(kind, vec![name], ty, at.into())
    })
}

fn kind(section: &Section, ty: Type, channel: Option<char>, program: bool) -> VarKind {
    if types::is_block(Some(ty)).is_some() {
        return VarKind::Var;
    }
    if section.constant && section.kind != SectionKind::External {
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

fn written(variable: Xml) -> Option<Text> {
    let inner = || kid(variable, "address").and_then(|a| text(a, "address").or_else(|| text(a, "value")));
    text(variable, "address").or_else(inner).filter(|t| !t.text.trim().is_empty())
}

/// The direction of an address: `I`, `Q` or `M`. An incomplete address (`%I*`) tells it too.
fn channel(variable: Xml) -> Option<char> {
    written(variable)?.text.trim().chars().nth(1).map(|c| c.to_ascii_uppercase())
}

/// The address with its `%`. An incomplete address (`%I*`) counts as none.
fn address(variable: Xml, report: &mut Report) -> Option<Name> {
    let text = written(variable)?;
    let word = line(text.text.trim());
    if let Some(kind) = word.strip_suffix('*') {
        let what = say!("an address that is given elsewhere (`{kind}*`); the variable has none");
        report.element(&codes::LEFT_OUT, "address", &text.at, what);
        return None;
    }
    Some(Name::new(word, report.span(&text.at)))
}
