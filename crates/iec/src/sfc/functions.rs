//! Rewrites the functions of a file: a function of G7 has elementary inputs and one elementary result, and changes no
//! variable.
//!
//! ```text
//! read (Source) -> enabled -> here, called -> instances -> blocks -> build
//! ```
//!
//! - An input to which the body gives a value becomes a local variable with the value of the input.
//! - A call that leaves an input out gives it the value of its declaration (IEC 61131-3:2003, 2.5.1.1).
//! - A function with a structure, an array, an output or an `inout` becomes a function block that gives all its
//!   variables their first values in each call; [`super::called`] gives each call of it an instance.
//! - `TIME()`, the time since the start in CODESYS and TwinCAT, is read from a timer of the file.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    Arg, Expr, ExprKind, FbKind, Name, Nanos, Path, Problem, Span, Stmt, StmtKind, Type, UnaryOp, VarDecl,
    VarKind, codes, say,
};

use super::called;
use super::unit::{Renamed, Source, Unit, UnitKind, callee, each, upper};
use crate::nodes;
use crate::report::Report;
use crate::st::{Section, Variable};

/// A count of milliseconds in 32 bits starts anew behind this one.
const MOST_MILLISECONDS: i64 = u32::MAX as i64;

/// Rewrites the functions of a file and their calls.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    clock(source);
    let defaults = defaults(source);
    for unit in &mut source.units {
        each(unit, &mut Omitted { defaults: &defaults });
        if unit.kind == UnitKind::Function {
            own_inputs(unit);
        }
    }
    let wide = wide(source);
    for unit in source.units.iter_mut().filter(|u| wide.contains(&upper(&u.name))) {
        into_block(unit, report);
    }
    called::expand(source, &wide, report);
}

/// Gives a file that calls `TIME()` a timer that runs from the start.
fn clock(source: &mut Source) {
    if source.units.iter().any(|u| u.name.text.eq_ignore_ascii_case("TIME")) {
        return;
    }
    let name = source.names().give("plc_time");
    let mut clock = Clock { name: &name, at: None };
    source.units.iter_mut().for_each(|u| each(u, &mut clock));
    let Some(at) = clock.at else { return };
    let decl = nodes::variable(VarKind::Var, &name, Type::Fb(FbKind::Ton), at);
    source.globals.push(Variable { section: Section::Global, decl, unknown: None });
    let running = nodes::unary(UnaryOp::Not, nodes::name(&[&name, "Q"], at), at);
    let most = Nanos::from_millis(MOST_MILLISECONDS);
    let args = vec![("IN", running), ("PT", nodes::time(most, at))];
    source.before.push(nodes::invoke(nodes::path(&[&name], at), args, at));
}

/// Reads the timer instead of `TIME()`.
struct Clock<'n> {
    name: &'n str,
    at: Option<Span>,
}

impl Visitor for Clock<'_> {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Call(path, args) = &e.kind else { return };
        if args.is_empty() && callee(path).is_some_and(|n| n == "TIME") {
            self.at.get_or_insert(e.at.0);
            *e = nodes::name(&[self.name, "ET"], e.at.0);
        }
    }
}

/// The inputs of the functions in their order, with the values that they have without one.
type Defaults = HashMap<String, Vec<(Name, Option<Expr>)>>;

fn defaults(source: &Source) -> Defaults {
    let of = |v: &Variable| {
        let plain = v.decl.array.is_none() && v.decl.of.is_none() && v.unknown.is_none();
        let value = v.decl.init.clone().or_else(|| plain.then(|| Expr::zero(v.decl.ty, v.decl.at)));
        v.decl.names.iter().map(move |n| (n.clone(), value.clone())).collect::<Vec<_>>()
    };
    let functions = source.units.iter().filter(|u| u.kind == UnitKind::Function);
    let inputs = |u: &Unit| u.vars.iter().filter(|v| v.section == Section::Input).flat_map(of).collect();
    functions.map(|u| (upper(&u.name), inputs(u))).collect()
}

/// Gives values to inputs that a call leaves out.
struct Omitted<'d> {
    defaults: &'d Defaults,
}

impl Omitted<'_> {
    fn complete(&self, path: &Path, args: &mut Vec<Arg>) {
        let Some(inputs) = callee(path).and_then(|n| self.defaults.get(&n)) else { return };
        let named = args.iter().all(|a| a.name.is_some());
        for (number, (name, value)) in inputs.iter().enumerate() {
            let given = |a: &Arg| a.name.as_ref().is_some_and(|n| n.text.eq_ignore_ascii_case(&name.text));
            if args.len() > number && !named || args.iter().any(given) {
                continue;
            }
            if let Some(value) = value.clone() {
                args.push(Arg::input(Some(name.clone()).filter(|_| named), value));
            }
        }
    }
}

impl Visitor for Omitted<'_> {
    fn expr(&mut self, e: &mut Expr) {
        if let ExprKind::Call(path, args) = &mut e.kind {
            self.complete(path, args);
        }
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        if let StmtKind::Call(path, args) = &mut stmt.kind {
            self.complete(path, args);
        }
    }
}

/// Replaces inputs that the body writes by local variables.
fn own_inputs(unit: &mut Unit) {
    let mut written = Written::default();
    visit_mut::stmts(&mut unit.body, &mut written);
    let mut taken = unit.names();
    let mut own = HashMap::new();
    let (mut copies, mut first) = (Vec::new(), Vec::new());
    for v in unit.vars.iter().filter(|v| v.section == Section::Input) {
        for name in v.decl.names.iter().filter(|n| written.0.contains(&upper(n))) {
            let local = taken.give(&name.text);
            let names = vec![Name::new(local.clone(), name.at.0)];
            let decl = VarDecl { names, kind: VarKind::Var, init: None, ..v.decl.clone() };
            copies.push(Variable { section: Section::Local, decl, unknown: v.unknown.clone() });
            let at = name.at.0;
            first.push(nodes::assign(nodes::name(&[&local], at), nodes::name(&[&name.text], at), at));
            own.insert(upper(name), local);
        }
    }
    if own.is_empty() {
        return;
    }
    visit_mut::stmts(&mut unit.body, &mut Renamed(&own));
    unit.body.splice(0..0, first);
    unit.vars.append(&mut copies);
}

/// The first names of what is written, in upper case.
#[derive(Default)]
struct Written(HashSet<String>);

impl Visitor for Written {
    fn path(&mut self, path: &mut Path, how: Use, _: Span) {
        if let Some(first) = path.names.first().filter(|_| how == Use::Write) {
            self.0.insert(g7_model::bare(&first.text).0.to_uppercase());
        }
    }
}

/// The functions that become function blocks, in upper case: those that have an array, a structure, an output or an
/// in-out, and those that call such a function.
fn wide(source: &Source) -> HashSet<String> {
    let functions = || source.units.iter().filter(|u| u.kind == UnitKind::Function);
    let of_type = |v: &VarDecl| v.array.is_some() || v.of.is_some();
    let is_wide = |u: &&Unit| {
        let outward = |v: &Variable| matches!(v.section, Section::Output | Section::InOut);
        u.result.as_ref().is_some_and(|r| of_type(&r.decl))
            || u.vars.iter().any(|v| of_type(&v.decl) || outward(v))
    };
    let mut open: Vec<String> = functions().filter(is_wide).map(|u| upper(&u.name)).collect();
    let mut callers: HashMap<String, Vec<String>> = HashMap::new();
    for unit in functions().filter(|_| !open.is_empty()) {
        let mut calls = Calls::default();
        visit_mut::stmts(&mut unit.body.clone(), &mut calls);
        calls.0.into_iter().for_each(|called| callers.entry(called).or_default().push(upper(&unit.name)));
    }
    let mut wide = HashSet::new();
    while let Some(name) = open.pop() {
        if wide.insert(name.clone()) {
            open.extend(callers.remove(&name).unwrap_or_default());
        }
    }
    wide
}

/// The functions that are called, in upper case.
#[derive(Default)]
struct Calls(HashSet<String>);

impl Visitor for Calls {
    fn expr(&mut self, e: &mut Expr) {
        if let ExprKind::Call(path, _) = &e.kind {
            self.0.extend(callee(path));
        }
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        if let StmtKind::Call(path, _) = &stmt.kind {
            self.0.extend(callee(path));
        }
    }
}

/// Makes a function block of a function. It remembers nothing: its variables get their first values in each call.
fn into_block(unit: &mut Unit, report: &mut Report) {
    unit.kind = UnitKind::FunctionBlock;
    let mut taken = unit.names();
    let (mut vars, mut first) = (Vec::new(), Vec::new());
    let result = unit.result.take();
    for mut v in std::mem::take(&mut unit.vars).into_iter().chain(result) {
        let constant = v.decl.kind == VarKind::Const;
        let kept = matches!(v.section, Section::Input | Section::InOut | Section::External) || constant;
        if matches!(v.decl.ty, Type::Fb(_)) {
            let what = say!("a function has no memory, and so no function block");
            report.put(Problem::new(&codes::NOT_CARRIED, v.decl.at.0, what));
        }
        let plain = v.decl.array.is_none() && v.decl.of.is_none();
        if v.section == Section::Local && plain && !constant {
            v.section = Section::Temp;
        } else if !kept {
            let at = v.decl.at.0;
            for name in &v.decl.names {
                let value = if plain {
                    v.decl.init.clone().unwrap_or_else(|| Expr::zero(v.decl.ty, v.decl.at))
                } else {
                    let blank = taken.give(&format!("{}_first", name.text));
                    let names = vec![Name::new(blank.clone(), at)];
                    let decl = VarDecl { names, ..v.decl.clone() };
                    vars.push(Variable { section: Section::Local, decl, unknown: v.unknown.clone() });
                    nodes::name(&[&blank], at)
                };
                first.push(nodes::assign(nodes::name(&[&name.text], at), value, at));
            }
        }
        vars.push(v);
    }
    unit.vars = vars;
    unit.body.splice(0..0, first);
}
