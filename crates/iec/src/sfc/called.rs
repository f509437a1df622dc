//! Replaces the calls of functions that became function blocks (see `functions`): each call gets an instance, which is
//! called in a statement before the one that has the call.
//!
//! ```text
//! functions -> here -> instances
//! ```
//!
//! `a := f(x) + 1` becomes `f_2(x := x); a := f_2.f + 1`. A condition of a loop is computed within the loop.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Visitor};
use g7_model::{
    Arg, Expr, ExprKind, Name, Path, Problem, Said, Span, Stmt, StmtKind, Type, VarDecl, VarKind, codes, say,
};

use super::unit::{Part, Source, Unit, callee, upper};
use crate::nodes::{self, Taken};
use crate::report::Report;
use crate::st::{Section, Variable};

/// The most conditions of ELSIF with such a call in a unit: each is an IF within the one before it, and later stages
/// recurse over these.
const MOST_ELSIF: usize = 100;

/// For each of these functions, by its name in upper case: its name as written, and its parameters in the order of a
/// call without names.
type Parameters = HashMap<String, (Name, Vec<(Name, Section)>)>;

/// Rewrites the calls of these functions.
pub(super) fn expand(source: &mut Source, wide: &HashSet<String>, report: &mut Report) {
    if wide.is_empty() {
        return;
    }
    let parameters = parameters(source, wide);
    let mut taken = source.names();
    for unit in &mut source.units {
        let mut calls = Calls {
            parameters: &parameters,
            taken: &mut taken,
            report,
            made: Vec::new(),
            before: Vec::new(),
            room: Some(MOST_ELSIF),
        };
        unit.body = calls.list(std::mem::take(&mut unit.body));
        for part in &mut unit.parts {
            match part {
                Part::Action { body, .. } => *body = calls.list(std::mem::take(body)),
                Part::Transition(t) => calls.refuse(&mut t.receptivity),
                Part::Step { .. } => {}
            }
        }
        let mut made = std::mem::take(&mut calls.made);
        unit.vars.append(&mut made);
    }
}

fn parameters(source: &Source, wide: &HashSet<String>) -> Parameters {
    let of = |unit: &Unit| {
        let all = |section: Section| {
            let own = unit.vars.iter().filter(move |v| v.section == section);
            own.flat_map(|v| &v.decl.names).map(move |n| (n.clone(), section))
        };
        let own = |(name, section): &(Name, Section)| {
            *section != Section::Output || upper(name) != upper(&unit.name)
        };
        all(Section::Input).chain(all(Section::InOut)).chain(all(Section::Output).filter(own)).collect()
    };
    let units = source.units.iter().filter(|u| wide.contains(&upper(&u.name)));
    units.map(|u| (upper(&u.name), (u.name.clone(), of(u)))).collect()
}

/// A receptivity has no statement before it that could call the instance.
pub(crate) fn in_receptivity() -> Said {
    say!("a function with structures, arrays or outputs in a receptivity; call it in an action")
}

struct Calls<'a> {
    parameters: &'a Parameters,
    taken: &'a mut Taken,
    report: &'a mut Report,
    /// The instances of the unit.
    made: Vec<Variable>,
    /// The calls before the statement that is rewritten.
    before: Vec<Stmt>,
    /// How many more ELSIFs can become an IF in an ELSE; None once it was reported that they are too many.
    room: Option<usize>,
}

impl Calls<'_> {
    fn list(&mut self, list: Vec<Stmt>) -> Vec<Stmt> {
        let mut made = Vec::new();
        for mut stmt in list {
            let outer = std::mem::take(&mut self.before);
            self.stmt_of(&mut stmt);
            made.append(&mut self.before);
            made.push(stmt);
            self.before = outer;
        }
        made
    }

    /// Rewrites a statement; leaves the calls that come before it in `before`.
    fn stmt_of(&mut self, stmt: &mut Stmt) {
        let at = stmt.at.0;
        match &mut stmt.kind {
            StmtKind::Assign { target, value } => {
                if let ExprKind::Element(_, index, _) = &mut target.kind {
                    index.iter_mut().for_each(|e| visit_mut::expr(e, self));
                }
                visit_mut::expr(value, self);
            }
            StmtKind::Call(path, args) => {
                args.iter_mut().filter(|a| !a.output).for_each(|a| visit_mut::expr(&mut a.value, self));
                if let Some(call) = self.call(path, args, at) {
                    *stmt = call;
                }
            }
            StmtKind::If(arms, otherwise) => self.arms(arms, otherwise, at),
            StmtKind::Case(selector, ..) => {
                visit_mut::expr(selector, self);
                self.lists_of(stmt);
            }
            StmtKind::For { from, to, by, .. } => {
                [from, to].into_iter().chain(by).for_each(|e| visit_mut::expr(e, self));
                self.lists_of(stmt);
            }
            StmtKind::While(condition, body) => {
                let before = self.within(condition);
                *body = self.list(std::mem::take(body));
                if !before.is_empty() {
                    let going = std::mem::replace(condition, nodes::boolean(true, at));
                    let exit = Stmt { kind: StmtKind::Exit, at: at.into() };
                    let ends = nodes::when(nodes::not(going, at), vec![exit], Vec::new(), at);
                    body.splice(0..0, before.into_iter().chain([ends]));
                }
            }
            StmtKind::Repeat(body, condition) => {
                *body = self.list(std::mem::take(body));
                let mut before = self.within(condition);
                body.append(&mut before);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn lists_of(&mut self, stmt: &mut Stmt) {
        visit_mut::lists(stmt, |list| *list = self.list(std::mem::take(list)));
    }

    /// Rewrites an expression; returns the calls that come before it.
    fn within(&mut self, e: &mut Expr) -> Vec<Stmt> {
        let outer = std::mem::take(&mut self.before);
        visit_mut::expr(e, self);
        std::mem::replace(&mut self.before, outer)
    }

    /// The arms of an IF: calls in the condition of a later arm run where the earlier ones did not hold.
    fn arms(&mut self, arms: &mut Vec<(Expr, Vec<Stmt>)>, otherwise: &mut Vec<Stmt>, at: Span) {
        *otherwise = self.list(std::mem::take(otherwise));
        // The last arm first.
        let mut kept = Vec::new();
        for (number, (mut condition, body)) in std::mem::take(arms).into_iter().enumerate().rev() {
            let before = self.within(&mut condition);
            let place = condition.at.0;
            kept.push((condition, self.list(body)));
            if before.is_empty() {
                continue;
            }
            if number == 0 {
                self.before.extend(before);
                continue;
            }
            let Some(room) = self.room else { continue };
            self.room = room.checked_sub(1);
            if self.room.is_none() {
                let what =
                    say!("more than {MOST_ELSIF} calls of functions with outputs in conditions of ELSIF");
                self.report.put(Problem::new(&codes::TOO_DEEP, place, what));
                continue;
            }
            kept.reverse();
            let rest = std::mem::take(otherwise);
            let inner = Stmt { kind: StmtKind::If(std::mem::take(&mut kept), rest), at: at.into() };
            *otherwise = before.into_iter().chain([inner]).collect();
        }
        kept.reverse();
        *arms = kept;
    }

    /// The call of a new instance, if the path is one of the functions.
    fn call(&mut self, path: &Path, args: &[Arg], at: Span) -> Option<Stmt> {
        let (name, parameters) = self.parameters.get(&callee(path)?)?;
        let own = self.taken.give(&name.text);
        let args = args.iter().enumerate().map(|(k, arg)| {
            let Some((name, section)) = parameters.get(k).filter(|_| arg.name.is_none()) else {
                return arg.clone();
            };
            Arg { name: Some(name.clone()), output: *section == Section::Output, ..arg.clone() }
        });
        let instance = nodes::path(&[&own], at);
        let call = Stmt { kind: StmtKind::Call(instance, args.collect()), at: at.into() };
        let decl = VarDecl {
            of: Some(Box::new(name.clone())),
            ..VarDecl::new(VarKind::Var, vec![Name::new(own, at)], Type::Bool, at.into())
        };
        self.made.push(Variable { section: Section::Local, decl, unknown: Some(name.clone()) });
        Some(call)
    }

    /// A receptivity has no statement before it.
    fn refuse(&mut self, receptivity: &mut Expr) {
        if !self.within(receptivity).is_empty() {
            self.report.put(Problem::new(&codes::NOT_CARRIED, receptivity.at.0, in_receptivity()));
        }
    }
}

impl Visitor for Calls<'_> {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Call(path, args) = &e.kind else { return };
        let Some(function) = callee(path).and_then(|n| self.parameters.get(&n)).map(|f| f.0.clone()) else {
            return;
        };
        let Some(call) = self.call(path, args, e.at.0) else { return };
        let StmtKind::Call(instance, _) = &call.kind else { return };
        let mut names = instance.names.clone();
        names.push(function);
        self.before.push(call);
        e.kind = ExprKind::Path(Path { names });
    }
}
