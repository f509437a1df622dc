//! Calls of function blocks with `EN` and `ENO` (IEC 61131-3:2003, 2.5.1.2): the call runs while `EN` is true, and `ENO`
//! tells whether it ran.
//!
//! ```text
//! read (Source) -> here -> instances
//! ```
//!
//! A function block that declares a variable `EN` has that as any other input.

use std::collections::HashSet;

use g7_model::visit_mut::{self, Visitor};
use g7_model::{Arg, Expr, Stmt, StmtKind, VarDecl};

use super::unit::{Part, Source};
use crate::nodes;

/// Rewrites the calls of all units.
pub(super) fn expand(source: &mut Source) {
    let named = |decl: &VarDecl, name: &str| decl.names.iter().any(|n| n.text.eq_ignore_ascii_case(name));
    let own: HashSet<String> = source
        .units
        .iter()
        .filter(|u| u.vars.iter().any(|v| named(&v.decl, "EN")))
        .map(|u| u.name.text.to_uppercase())
        .collect();
    let is_own = |decl: &VarDecl| decl.of.as_ref().is_some_and(|of| own.contains(&of.text.to_uppercase()));
    let globals: Vec<&VarDecl> = source.globals.iter().map(|v| &v.decl).filter(|d| is_own(d)).collect();
    let names = |decls: &mut dyn Iterator<Item = &VarDecl>| -> HashSet<String> {
        decls.flat_map(|d| &d.names).map(|n| n.text.to_uppercase()).collect()
    };
    for unit in &mut source.units {
        let locals = unit.vars.iter().map(|v| &v.decl).filter(|d| is_own(d));
        let mut enabled = Enabled { own: names(&mut globals.iter().copied().chain(locals)) };
        visit_mut::stmts(&mut unit.body, &mut enabled);
        for part in &mut unit.parts {
            if let Part::Action { body, .. } = part {
                visit_mut::stmts(body, &mut enabled);
            }
        }
    }
}

struct Enabled {
    /// The instances in upper case whose type declares `EN`.
    own: HashSet<String>,
}

/// Takes the value of a parameter out of the arguments.
fn taken(args: &mut Vec<Arg>, name: &str, output: bool) -> Option<Expr> {
    let named = |a: &Arg| a.name.as_ref().is_some_and(|n| n.text.eq_ignore_ascii_case(name));
    let place = args.iter().position(|a| a.output == output && named(a))?;
    Some(args.remove(place).value)
}

impl Visitor for Enabled {
    fn stmt(&mut self, stmt: &mut Stmt) {
        let StmtKind::Call(path, args) = &mut stmt.kind else { return };
        let first = path.names.first().map_or("", |n| n.text.split('[').next().unwrap_or(""));
        if self.own.contains(&first.to_uppercase()) {
            return;
        }
        let (en, eno) = (taken(args, "EN", false), taken(args, "ENO", true));
        if en.is_none() && eno.is_none() {
            return;
        }
        let at = stmt.at.0;
        let told = |on| eno.iter().map(|e| nodes::assign(e.clone(), nodes::boolean(on, at), at)).collect();
        let mut run = vec![stmt.clone()];
        run.extend::<Vec<Stmt>>(told(true));
        *stmt = nodes::when(en.unwrap_or_else(|| nodes::boolean(true, at)), run, told(false), at);
    }
}
