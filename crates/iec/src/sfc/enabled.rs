//! Calls of function blocks with `EN` and `ENO` (IEC 61131-3:2003, 2.5.1.2): the call runs while `EN` is true, and `ENO`
//! tells whether it ran.
//!
//! ```text
//! read (Source) -> here -> instances
//! ```
//!
//! A function block that declares a variable `EN` has that as any other input.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::Visitor;
use g7_model::{Arg, Expr, ExprKind, Name, Path, Problem, Stmt, StmtKind, VarDecl, codes, say};

use super::unit::{Source, each};
use crate::nodes;
use crate::report::Report;

/// The types of variables that are of a type of the file; all names in upper case.
pub(super) type Types = HashMap<String, String>;

/// Rewrites the calls of all units.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let file = File::of(source);
    let globals = types(source.globals.iter().map(|v| &v.decl));
    for unit in &mut source.units {
        let mut variables = globals.clone();
        variables.extend(types(unit.vars.iter().map(|v| &v.decl)));
        let mut enabled = Enabled { file: &file, variables, report };
        each(unit, &mut enabled);
    }
}

pub(super) fn types<'v>(variables: impl Iterator<Item = &'v VarDecl>) -> Types {
    let of =
        |v: &'v VarDecl| Some((v.names.first()?.text.to_uppercase(), v.of.as_ref()?.text.to_uppercase()));
    variables.filter_map(of).collect()
}

/// The function blocks and structures of a file.
pub(super) struct File {
    /// The types of their members, by the name of the function block or structure in upper case.
    members: HashMap<String, Types>,
    /// The function blocks and functions, in upper case, that declare a variable `EN` of their own.
    own: HashSet<String>,
}

impl File {
    pub(super) fn of(source: &Source) -> File {
        let declares = |v: &VarDecl| v.names.iter().any(|n| n.text.eq_ignore_ascii_case("EN"));
        let mut file = File { members: HashMap::new(), own: HashSet::new() };
        for unit in &source.units {
            let name = unit.name.text.to_uppercase();
            if unit.vars.iter().any(|v| declares(&v.decl)) {
                file.own.insert(name.clone());
            }
            file.members.insert(name, types(unit.vars.iter().map(|v| &v.decl)));
        }
        for structure in &source.types.structures {
            file.members.insert(structure.name.text.to_uppercase(), types(structure.members.iter()));
        }
        file
    }

    /// The type of the variable that a path names, in upper case. None if the file does not declare that type.
    pub(super) fn type_of<'t>(&'t self, names: &[Name], variables: &'t Types) -> Option<&'t String> {
        let mut names = names.iter().map(|n| g7_model::bare(&n.text).0.to_uppercase());
        let first = names.next().and_then(|n| variables.get(&n));
        names.fold(first, |of, member| self.members.get(of?)?.get(&member))
    }
}

struct Enabled<'f> {
    file: &'f File,
    variables: Types,
    report: &'f mut Report,
}

impl Enabled<'_> {
    /// True if the function block that a path names declares `EN`.
    fn declares(&self, path: &Path) -> bool {
        self.file.type_of(&path.names, &self.variables).is_some_and(|of| self.file.own.contains(of))
    }
}

/// Takes the value of a parameter out of the arguments.
fn taken(args: &mut Vec<Arg>, name: &str, output: bool) -> Option<Expr> {
    let named = |a: &Arg| a.name.as_ref().is_some_and(|n| n.text.eq_ignore_ascii_case(name));
    let place = args.iter().position(|a| a.output == output && named(a))?;
    Some(args.remove(place).value)
}

impl Visitor for Enabled<'_> {
    fn stmt(&mut self, stmt: &mut Stmt) {
        let StmtKind::Call(path, args) = &mut stmt.kind else { return };
        if self.declares(path) {
            return;
        }
        let (en, eno) = (taken(args, "EN", false), taken(args, "ENO", true));
        if en.is_none() && eno.is_none() {
            return;
        }
        let at = stmt.at.0;
        let tell = |on| eno.iter().map(|e| nodes::assign(e.clone(), nodes::boolean(on, at), at)).collect();
        let not: Vec<Stmt> = tell(false);
        let run = std::iter::once(stmt.clone()).chain(tell(true)).collect();
        *stmt = nodes::when(en.unwrap_or_else(|| nodes::boolean(true, at)), run, not, at);
    }
    /// The call of a function in an expression always runs.
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Call(path, args) = &mut e.kind else { return };
        if path.names.first().is_some_and(|n| self.file.own.contains(&n.text.to_uppercase())) {
            return;
        }
        let (en, eno) = (taken(args, "EN", false), taken(args, "ENO", true));
        let other = en.filter(|e| nodes::truth(e) != Some(true)).or(eno);
        if let Some(other) = other {
            let what =
                say!("`EN` of a function in an expression is TRUE, and `ENO` is not read; write an IF");
            self.report.put(Problem::new(&codes::NOT_CARRIED, other.at.0, what));
        }
    }
}
