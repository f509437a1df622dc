//! Calls of function blocks: the inputs, the body with the variables of the instance, the outputs.

use std::collections::HashMap;

use super::base::{Composition, Env, Segment, Spot};
use super::chosen::Known;
use super::declare::bounds;
use super::paths::{Lost, at_of};
use super::returns;
use crate::{
    Arg, CaseArm, Composed, Expr, ExprKind, Name, Path, Place, Problem, Stmt, StmtKind, VarDecl, VarKind,
    codes, say,
};

/// A parameter of a function block.
#[derive(Clone, Copy)]
struct Parameter<'d> {
    name: &'d Name,
    decl: &'d VarDecl,
    /// True if it stands for a variable of the caller.
    inout: bool,
}

/// A call whose instance is known.
#[derive(Clone, Copy)]
struct Call<'c, 'd> {
    of: &'d Composed,
    args: &'c [Arg],
    at: Place,
}

impl<'d> Composition<'d> {
    /// The statements of a call, whose arguments are not replaced yet.
    pub(super) fn call(&mut self, path: Path, mut args: Vec<Arg>, at: Place, env: &Env<'_, 'd>) -> Vec<Stmt> {
        let mut segments = self.segments(&path, &[], env);
        // The index of the instance itself stays as it is written: a CASE compares other indexes with it.
        if let Some((_, before)) = segments.split_last_mut() {
            self.indexed(before, env);
        }
        // Other names of calls are those of services and functions.
        let variable = segments.first().is_some_and(|s| self.is_variable(&s.name.text, env));
        let spot = match variable.then(|| self.spot(&segments, env)).transpose() {
            Ok(spot) => spot.flatten(),
            Err(Lost) => return Vec::new(),
        };
        let Some(of) = spot.as_ref().and_then(|s| s.of) else {
            let path = spot.map_or(path, |s| match s.kind() {
                ExprKind::Path(path) => path,
                // An element cannot be called; its name is told as it is written.
                _ => Path { names: segments.into_iter().map(|s| s.name).collect() },
            });
            self.args(&mut args, env);
            return vec![Stmt { kind: StmtKind::Call(path, args), at }];
        };
        let Some(spot) = spot else { return Vec::new() };
        if !of.block {
            let what = say!("`{}` is a structure; it cannot be called", spot.shown());
            self.problems.push(Problem::new(&codes::WRONG_KIND, at_of(&segments), what));
            return Vec::new();
        }
        if let Some(place) = env.uncallable().cloned() {
            let what = say!("the function block `{}` cannot be called in {place}", spot.shown());
            let help = say!("call it in an action or in a PRE section and read its outputs here");
            self.problems.push(Problem::new(&codes::NOT_HERE, at_of(&segments), what).help(help));
            return Vec::new();
        }
        let call = Call { of, args: &args, at };
        self.chosen(spot, &call, env).unwrap_or_default()
    }

    /// The call of one instance, or of the one that an index chooses.
    fn chosen(&mut self, spot: Spot<'d>, call: &Call<'_, 'd>, env: &Env<'_, 'd>) -> Option<Vec<Stmt>> {
        let dimensions = spot.decl.array.as_ref().map_or(&[][..], |a| &a.dimensions);
        if spot.own.len() != dimensions.len() {
            let (has, given) = (dimensions.len(), spot.own.len());
            let what = say!("the number of indexes of `{}` is {has}; {given} stand here", spot.shown());
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, spot.at, what));
        }
        let known: Option<Vec<Expr>> = spot
            .own
            .iter()
            .map(|e| {
                Some(Expr {
                    kind: ExprKind::Literal(crate::Literal::Int(self.whole(e, env)?, None)),
                    at: e.at,
                })
            })
            .collect();
        let all = self.indexes(dimensions, env)?;
        if let Some(own) = known {
            if !all.iter().any(|index| index.iter().zip(&own).all(|(a, b)| a.kind.whole() == b.kind.whole()))
            {
                let what = say!("`{}` has no such element", spot.shown());
                return self.report(Problem::new(&codes::OUT_OF_RANGE, spot.at, what));
            }
            return self.inlined(Spot { own, ..spot }, call, env);
        }
        let [written] = spot.own.as_slice() else { return None };
        let mut selector = written.clone();
        self.expr(&mut selector, env);
        let mut arms = Vec::new();
        for own in all.iter().cloned() {
            let labels = own.iter().map(|n| (n.clone(), None)).collect();
            let known = own.first().and_then(|n| Known::of(written, n.kind.whole()?));
            let args = known.map_or_else(|| call.args.to_vec(), |k| k.arguments(call.args));
            let body = self.inlined(Spot { own, ..spot.clone() }, &Call { args: &args, ..*call }, env)?;
            arms.push(CaseArm { labels, body });
        }
        let bound = |index: Option<&Vec<Expr>>| index.and_then(|i| i.first()).and_then(|e| e.kind.whole());
        let within = bound(all.first()).zip(bound(all.last()));
        let otherwise = match within {
            Some((least, most)) if self.stays_within(written, least, most) => Vec::new(),
            _ if self.kept.has(call.of) => self.nothing_outside(&spot),
            _ => self.outside(&spot, &selector, call),
        };
        Some(vec![Stmt { kind: StmtKind::Case(selector, arms, otherwise), at: call.at }])
    }

    /// The statements for an index outside of the bounds: reading an array with it is the fault `range`.
    fn outside(&mut self, spot: &Spot<'d>, selector: &Expr, call: &Call<'_, 'd>) -> Vec<Stmt> {
        let shared = |m: &&VarDecl| {
            matches!(m.kind, VarKind::Input | VarKind::Output) && m.array.is_none() && m.of.is_none()
        };
        let Some(name) = call.of.members.iter().find(shared).and_then(|m| m.names.first()) else {
            return Vec::new();
        };
        let segment = Segment { name: name.clone(), index: Vec::new() };
        let Ok(inner) = self.step(Spot { own: vec![selector.clone()], ..spot.clone() }, &segment) else {
            return Vec::new();
        };
        let e = Expr { kind: inner.kind(), at: call.at };
        vec![Stmt { kind: StmtKind::Assign { target: e.clone(), value: e }, at: call.at }]
    }

    fn inlined(&mut self, spot: Spot<'d>, call: &Call<'_, 'd>, env: &Env<'_, 'd>) -> Option<Vec<Stmt>> {
        let Call { of, args, at } = *call;
        if self.kept.has(of)
            && let Some(list) = self.kept_call(&spot, (of, args, at), env)
        {
            return Some(list);
        }
        if !self.takes(1 + args.len(), at.0) {
            return None;
        }
        let (mut list, mut behind, mut inouts) = (Vec::new(), Vec::new(), HashMap::new());
        let told = self.problems.len();
        let mut given: Vec<&str> = Vec::new();
        for (n, arg) in args.iter().enumerate() {
            let Some(parameter) = self.parameter(of, n, arg) else { continue };
            if given.contains(&&*parameter.name.text) {
                let place = arg.name.as_ref().map_or(arg.value.at.0, |n| n.at.0);
                self.once(Problem::new(&codes::WRONG_ARGUMENTS, place, say!("given twice in one call")));
                continue;
            }
            given.push(&parameter.name.text);
            let segment = Segment { name: parameter.name.clone(), index: Vec::new() };
            if parameter.inout {
                inouts.extend(
                    self.alias(of, parameter, &arg.value, env).map(|path| (&*parameter.name.text, path)),
                );
            } else if let Ok(inner) = self.step(spot.clone(), &segment) {
                let inner = Spot { at: arg.value.at.0, ..inner };
                if arg.output {
                    behind.push((arg, inner));
                } else {
                    self.input(arg, inner, at, env, &mut list);
                }
            }
        }
        for (decl, name) in of.inouts.iter().flat_map(|d| d.names.iter().map(move |n| (d, n))) {
            if !given.contains(&&*name.text) {
                let what = say!("the parameter `{}` of `{}` has no value", name.text, of.name.text);
                self.once(
                    Problem::new(&codes::WRONG_ARGUMENTS, at.0, what)
                        .related(decl.at.0, say!("declared here")),
                );
            }
        }
        let meant = |n: &Name| inouts.contains_key(&*n.text);
        if self.problems.len() > told || !of.inouts.iter().flat_map(|d| &d.names).all(meant) {
            return None; // A name that has no meaning would be told again at each of its places.
        }
        let inner = Env::Block { instance: spot, inouts, outer: env };
        let statements = of.body.as_ref().map_or(Vec::new(), |body| body.block().statements.clone());
        match returns::without(statements) {
            Ok(statements) => {
                // The body does not see the loop variables of its caller.
                let loops = std::mem::take(&mut self.loops);
                list.extend(self.statements(statements, &inner));
                self.loops = loops;
            }
            Err(problem) => {
                self.once(problem);
                return None;
            }
        }
        for (arg, output) in behind {
            self.output(arg, output, at, env, &mut list);
        }
        Some(list)
    }

    /// The name of the parameter that an argument is for, and true if it is an in-out.
    pub(super) fn name_of_argument(
        &mut self,
        of: &'d Composed,
        n: usize,
        arg: &Arg,
    ) -> Option<(&'d Name, bool)> {
        self.parameter(of, n, arg).map(|p| (p.name, p.inout))
    }

    /// The parameter that an argument is for.
    fn parameter(&mut self, of: &'d Composed, n: usize, arg: &Arg) -> Option<Parameter<'d>> {
        let members = of.members.iter().filter(|m| matches!(m.kind, VarKind::Input | VarKind::Output));
        let all = members.map(|d| (d, false)).chain(of.inouts.iter().map(|d| (d, true)));
        let mut all: Vec<Parameter<'d>> = all
            .flat_map(|(decl, inout)| decl.names.iter().map(move |name| Parameter { name, decl, inout }))
            .collect();
        all.sort_by_key(|p| p.name.at.0.start);
        all.retain(|p| p.inout && !arg.output || (p.decl.kind == VarKind::Output) == arg.output);
        let found = match &arg.name {
            Some(name) => all.iter().find(|p| p.name.text == name.text),
            None => all.get(n),
        };
        if let Some(found) = found {
            return Some(*found);
        }
        let names: Vec<&str> = all.iter().map(|p| &*p.name.text).collect();
        let side = if arg.output { say!("output") } else { say!("input") };
        let problem = match &arg.name {
            Some(name) => {
                let what = say!("{} has no {side} `{}`", crate::Said::foreign(&*of.name.text), name.text);
                let problem = Problem::new(&codes::WRONG_ARGUMENTS, name.at.0, what);
                match crate::similar(&name.text, &names) {
                    Some(near) => problem.meant(near),
                    None => problem.help(say!("its {side}s are {}", crate::Said::foreign(names.join(", ")))),
                }
            }
            None => {
                let list = crate::Said::foreign(names.join(", "));
                let what =
                    say!("{} takes {} inputs: {}", crate::Said::foreign(&*of.name.text), names.len(), list);
                Problem::new(&codes::WRONG_ARGUMENTS, arg.value.at.0, what)
            }
        };
        self.once(problem);
        None
    }

    fn input(&mut self, arg: &Arg, inner: Spot<'d>, at: Place, env: &Env<'_, 'd>, list: &mut Vec<Stmt>) {
        let mut value = arg.value.clone();
        if inner.of.is_some() && self.is_structure(&value, env) {
            if let Ok(Some(from)) = self.spot_of(&value, env) {
                list.extend(self.copied(inner, from, at, env).unwrap_or_default());
            }
            return;
        }
        self.expr(&mut value, env);
        let span = value.at;
        if let Some(kind) = self.plain(inner, false) {
            let target = Expr { kind, at: span };
            list.push(Stmt { kind: StmtKind::Assign { target, value }, at });
        }
    }

    fn output(&mut self, arg: &Arg, inner: Spot<'d>, at: Place, env: &Env<'_, 'd>, list: &mut Vec<Stmt>) {
        let mut target = arg.value.clone();
        if inner.of.is_some() && self.is_structure(&target, env) {
            if let Ok(Some(to)) = self.spot_of(&target, env) {
                list.extend(self.copied(to, inner, at, env).unwrap_or_default());
            }
            return;
        }
        if !matches!(target.kind, ExprKind::Path(_) | ExprKind::Element(..) | ExprKind::Direct(_)) {
            let what = say!("an output needs a variable to go to");
            return self.once(Problem::new(&codes::WRONG_ARGUMENTS, target.at.0, what));
        }
        self.target(&mut target, env);
        let span = target.at;
        if let Some(kind) = self.plain(inner, false) {
            let value = Expr { kind, at: span };
            list.push(Stmt { kind: StmtKind::Assign { target, value }, at });
        }
    }

    /// The variable for which a parameter stands: its path, with indexes that are numbers.
    fn alias(
        &mut self,
        of: &Composed,
        parameter: Parameter<'d>,
        value: &Expr,
        env: &Env<'_, 'd>,
    ) -> Option<Vec<Segment>> {
        let (path, index) = match &value.kind {
            ExprKind::Path(path) => (path, &[][..]),
            ExprKind::Element(path, index, None) => (&**path, index.as_slice()),
            _ => return self.no_variable(parameter, value),
        };
        let mut segments = self.segments(path, index, env);
        for e in segments.iter_mut().flat_map(|s| &mut s.index) {
            let Some(n) = self.whole(e, env) else {
                let what =
                    say!("`{}` stands for one variable, so the index is a number", parameter.name.text);
                self.once(Problem::new(&codes::NOT_CONSTANT, e.at.0, what));
                return None;
            };
            e.kind = ExprKind::Literal(crate::Literal::Int(n, None));
        }
        let Ok(Some(spot)) = self.spot(&segments, env) else { return self.no_variable(parameter, value) };
        let dimensions = spot.decl.array.as_ref().map_or(&[][..], |a| &a.dimensions);
        let left = dimensions.get(spot.own.len()..).unwrap_or_default();
        let wanted = bounds(of, parameter.decl);
        let equal = |a: &Expr, b: &Expr| self.whole(a, env) == self.whole(b, env);
        let fits = left.len() == wanted.len()
            && left.iter().zip(&wanted).all(|(a, b)| equal(&a.0, &b.0) && equal(&a.1, &b.1));
        let same = match (spot.of, self.type_of(parameter.decl)) {
            (Some(a), Some(b)) => a.name.text == b.name.text,
            (None, None) => spot.decl.ty == parameter.decl.ty && spot.decl.limits == parameter.decl.limits,
            _ => false,
        };
        if !same || !fits || spot.own.len() > dimensions.len() || spot.decl.kind == VarKind::Const {
            let what = say!("`{}` does not fit the parameter `{}`", spot.shown(), parameter.name.text);
            let help = say!("it stands for a variable of the same type and bounds");
            let problem = Problem::new(&codes::WRONG_TYPE, value.at.0, what).help(help);
            self.once(problem.related(parameter.decl.at.0, say!("declared here")));
            return None;
        }
        Some(segments)
    }

    fn no_variable<T>(&mut self, parameter: Parameter<'d>, value: &Expr) -> Option<T> {
        let what = say!("`{}` stands for a variable of the caller", parameter.name.text);
        let help = say!("write the name of a variable");
        self.once(Problem::new(&codes::WRONG_ARGUMENTS, value.at.0, what).help(help));
        None
    }

    fn args(&mut self, args: &mut [Arg], env: &Env<'_, 'd>) {
        for arg in args {
            if arg.output {
                self.target(&mut arg.value, env);
            } else {
                self.expr(&mut arg.value, env);
            }
        }
    }
}
