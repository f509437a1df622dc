//! Function blocks whose `VAR_IN_OUT` is used as a variable: read or written from outside, or left out of a call.
//!
//! ```text
//! functions -> here -> instances
//! ```
//!
//! matiec accepts such a text: it keeps an in-out in the instance, and copies it in and out at each call. Here such an
//! in-out becomes an input, and behind a call its value is copied to the variable of the caller. All other in-outs stand
//! for the variable of the caller.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Arg, Expr, ExprKind, Name, Path, Problem, Span, Stmt, StmtKind, codes, say};

use super::enabled::{File, Types, types};
use super::unit::{Part, Source, Unit, UnitKind, each, upper};
use crate::nodes;
use crate::report::Report;
use crate::st::Section;

/// For each function block with an in-out, by its name in upper case: its inputs and in-outs in the order of the text.
type Parameters = HashMap<String, Vec<(Name, Section)>>;

/// Rewrites the in-outs that are used as variables.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let parameters = parameters(source);
    if parameters.is_empty() {
        return;
    }
    let file = File::of(source);
    let globals = types(source.globals.iter().map(|v| &v.decl));
    let scope = |unit: &Unit| {
        let mut variables = globals.clone();
        variables.extend(types(unit.vars.iter().map(|v| &v.decl)));
        variables
    };
    let mut kept = HashSet::new();
    for unit in &source.units {
        let variables = scope(unit);
        each(
            &mut unit.clone(),
            &mut Uses { file: &file, variables: &variables, parameters: &parameters, kept: &mut kept },
        );
    }
    if kept.is_empty() {
        return;
    }
    for unit in &mut source.units {
        let variables = scope(unit);
        let copies = Copies { file: &file, variables: &variables, parameters: &parameters, kept: &kept };
        unit.body = copies.list(std::mem::take(&mut unit.body));
        for part in &mut unit.parts {
            if let Part::Action { body, .. } = part {
                *body = copies.list(std::mem::take(body));
            }
        }
        if !kept.contains(&upper(&unit.name)) {
            continue;
        }
        for v in unit.vars.iter_mut().filter(|v| v.section == Section::InOut) {
            v.section = Section::Input;
            let name = v.decl.names.first().map_or("", |n| &*n.text);
            let what = say!(
                "`{name}` is used as a variable of the instance: a call copies it in and out, as matiec does"
            );
            report.put(Problem::new(&codes::DIFFERENT, v.decl.at.0, what));
        }
    }
}

fn parameters(source: &Source) -> Parameters {
    let blocks = source.units.iter().filter(|u| u.kind == UnitKind::FunctionBlock && !u.is_chart());
    let blocks = blocks.filter(|u| u.vars.iter().any(|v| v.section == Section::InOut));
    let of = |u: &Unit| {
        let own = u.vars.iter().filter(|v| matches!(v.section, Section::Input | Section::InOut));
        own.flat_map(|v| v.decl.names.iter().map(|n| (n.clone(), v.section))).collect()
    };
    blocks.map(|u| (upper(&u.name), of(u))).collect()
}

/// Finds the function blocks whose in-outs are used as variables.
struct Uses<'a> {
    file: &'a File,
    variables: &'a Types,
    parameters: &'a Parameters,
    kept: &'a mut HashSet<String>,
}

impl Visitor for Uses<'_> {
    fn path(&mut self, path: &mut Path, how: Use, _: Span) {
        if how == Use::Call {
            return;
        }
        for n in 1..path.names.len() {
            let (before, behind) = path.names.split_at(n);
            let Some(of) = self.file.type_of(before, self.variables) else { continue };
            let member = behind.first().map(|m| g7_model::bare(&m.text).0.to_uppercase());
            let inout =
                |(name, section): &(Name, Section)| *section == Section::InOut && Some(upper(name)) == member;
            if self.parameters.get(of).is_some_and(|all| all.iter().any(inout)) {
                self.kept.insert(of.clone());
            }
        }
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        let StmtKind::Call(path, args) = &stmt.kind else { return };
        let Some(of) = self.file.type_of(&path.names, self.variables) else { return };
        let Some(all) = self.parameters.get(of) else { return };
        let left_out = |(k, (name, section)): (usize, &(Name, Section))| {
            *section == Section::InOut && argument(args, k, name).is_none()
        };
        if all.iter().enumerate().any(left_out) {
            self.kept.insert(of.clone());
        }
    }
}

/// The argument for a parameter, by its name or its place.
fn argument<'a>(args: &'a [Arg], place: usize, name: &Name) -> Option<&'a Arg> {
    let named =
        args.iter().find(|a| a.name.as_ref().is_some_and(|n| n.text.eq_ignore_ascii_case(&name.text)));
    named.or_else(|| args.get(place).filter(|a| a.name.is_none()))
}

/// Copies in-outs back behind the calls.
struct Copies<'a> {
    file: &'a File,
    variables: &'a Types,
    parameters: &'a Parameters,
    kept: &'a HashSet<String>,
}

impl Copies<'_> {
    fn list(&self, list: Vec<Stmt>) -> Vec<Stmt> {
        let mut made = Vec::new();
        for mut stmt in list {
            visit_mut::lists(&mut stmt, |list| *list = self.list(std::mem::take(list)));
            let behind = self.behind(&stmt);
            made.push(stmt);
            made.extend(behind);
        }
        made
    }

    fn behind(&self, stmt: &Stmt) -> Vec<Stmt> {
        let StmtKind::Call(path, args) = &stmt.kind else { return Vec::new() };
        let of = self.file.type_of(&path.names, self.variables).filter(|of| self.kept.contains(*of));
        let all = of.and_then(|of| self.parameters.get(of)).into_iter().flatten().enumerate();
        let at = stmt.at.0;
        let copied = all.filter(|(_, (_, section))| *section == Section::InOut);
        copied
            .filter_map(|(k, (name, _))| {
                let to = argument(args, k, name)?.value.clone();
                Some(nodes::assign(to, member(path, name, at), at))
            })
            .collect()
    }
}

/// A member of the instance of a call, whose index stands in the name: `d[i]`.
fn member(path: &Path, name: &Name, at: Span) -> Expr {
    let place = |_| at.start as usize..at.end as usize;
    let mut unsaid = Report::new(at.file);
    let (mut names, mut index) = (Vec::new(), Vec::new());
    for own in path.names.iter().chain([name]) {
        let Some((array, inner)) = own.text.strip_suffix(']').and_then(|t| t.split_once('[')) else {
            names.push(own.clone());
            continue;
        };
        names.push(Name::new(format!("{array}[]"), own.at.0));
        index.push(crate::st::expression(inner, &place, &mut unsaid));
    }
    let path = Path { names };
    let kind =
        if index.is_empty() { ExprKind::Path(path) } else { ExprKind::Element(Box::new(path), index, None) };
    nodes::expr(kind, at)
}
