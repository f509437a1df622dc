//! Structures and function blocks of one's own. A member is a variable with the name `m[1].speed`; a call runs the
//! body while the names of the block mean the members of one instance.

use std::collections::BTreeMap;

use g7_model::{Arg, Body, Composed, Expr, ExprKind, Index, Name, Path, VarDecl, VarKind, instance_of};

use super::exec::Exec;
use super::exec::Frame;
use super::model::{FILE, Model, ScopeId};
use super::named::held;
use super::resolve::Ref;
use super::value::{Run, bad};

/// Where a variable or something with members stands: its scope, and its name there.
pub(super) type Stands = (ScopeId, String);

/// A function block whose body runs.
pub(super) struct Running {
    stands: Stands,
    ty: String,
    /// The variables of the caller, by the names of the parameters.
    inouts: BTreeMap<String, Stands>,
}

impl Model {
    /// A path with numbers for the constants in its names: `coil[1].open` for `coil[left].open`.
    pub(super) fn constants_in(&self, scope: ScopeId, path: &Path) -> Path {
        let mut path = path.clone();
        for name in &mut path.names {
            let Some((bare, Index::Parameter(constant, added))) = instance_of(&name.text) else { continue };
            let value =
                self.variable_named(scope, constant).and_then(|v| self.vars[v].init.as_ref()?.kind.whole());
            if let Some(n) = value {
                *name = Name::new(format!("{bare}[{}]", n + i128::from(added)), name.at.0);
            }
        }
        path
    }

    /// Declares the members of a variable.
    pub(super) fn declare_composed(&mut self, scope: ScopeId, v: &VarDecl, ty: &str) {
        for single in self.singles(scope, v) {
            for (name, whole) in single.names.iter().zip(&v.names) {
                self.composed.insert((scope, whole.text.to_string()), ty.to_owned());
                self.composed.insert((scope, name.text.to_string()), ty.to_owned());
                self.declare_members(scope, name, &single, ty);
            }
        }
    }

    fn declare_members(&mut self, scope: ScopeId, prefix: &Name, whole: &VarDecl, ty: &str) {
        let Some(ty) = self.types.get(ty).cloned() else { return };
        for member in &ty.members {
            for name in &member.names {
                let init = whole.init.as_ref().and_then(|e| field(e, &name.text)).or(member.init.as_ref());
                let kind = match (member.kind, ty.block) {
                    (VarKind::Const, _) => VarKind::Const,
                    (_, true) => VarKind::Var,
                    (_, false) => whole.kind,
                };
                let names = vec![Name::new(format!("{}.{}", prefix.text, name.text), name.at.0)];
                let init = init.map(|e| with_constants(&ty, e));
                let mut array = member.array.clone();
                for (least, most) in array.iter_mut().flat_map(|a| &mut a.dimensions) {
                    (*least, *most) = (with_constants(&ty, least), with_constants(&ty, most));
                }
                let retain = whole.retain || member.retain;
                self.declare(scope, &VarDecl { names, init, array, kind, retain, ..member.clone() });
            }
        }
    }
}

/// The value of a member in `(speed := 2.0)`.
fn field<'e>(e: &'e Expr, name: &str) -> Option<&'e Expr> {
    let ExprKind::Call(_, fields) = &e.kind else { return None };
    fields.iter().find(|f| f.name.as_ref().is_some_and(|n| &*n.text == name)).map(|f| &f.value)
}

/// The value of a constant of the type, where an expression is the name of one.
pub(super) fn with_constants(ty: &Composed, e: &Expr) -> Expr {
    let ExprKind::Path(path) = &e.kind else { return e.clone() };
    let named = |m: &&VarDecl| m.kind == VarKind::Const && m.names.iter().any(|n| *n.text == path.text());
    ty.members.iter().find(named).and_then(|m| m.init.clone()).unwrap_or_else(|| e.clone())
}

fn has(ty: &Composed, name: &str) -> bool {
    ty.members.iter().any(|m| m.names.iter().any(|n| &*n.text == name))
}

impl Exec<'_> {
    /// The meaning of a path where the statement in hand stands.
    pub(super) fn resolve(&self, scope: ScopeId, path: &Path) -> Option<Ref> {
        let Some(running) = self.running.last() else { return self.m.resolve(scope, path) };
        match self.within(running, &texts(path)) {
            Some((scope, text)) => self.m.resolve(scope, &Path { names: split_member(self.m, scope, &text) }),
            None => {
                let own = self.m.block_chart_of(&running.stands, path);
                self.m.resolve(FILE, own.as_ref().unwrap_or(path))
            }
        }
    }

    /// True if a name is one of the function block whose body runs.
    pub(super) fn is_own(&self, path: &Path) -> bool {
        self.running.last().is_some_and(|running| self.within(running, &texts(path)).is_some())
    }

    /// A name that the block itself declares.
    fn within(&self, running: &Running, names: &[String]) -> Option<Stands> {
        let (first, rest) = names.split_first()?;
        let (bare, index) = first.split_at(first.find('[').unwrap_or(first.len()));
        let behind = |(scope, text): &Stands, own: &str| {
            let rest: String = rest.iter().map(|n| format!(".{n}")).collect();
            (*scope, format!("{text}{own}{rest}"))
        };
        if let Some(outer) = running.inouts.get(bare) {
            return Some(behind(outer, index));
        }
        has(&self.m.types[&running.ty], bare).then(|| behind(&running.stands, &format!(".{first}")))
    }

    /// A path with numbers for the indexes in its names: `d[4].x` for `d[i + 1].x`.
    pub(super) fn numbered(&mut self, scope: ScopeId, path: &Path) -> Run<Path> {
        let mut path = path.clone();
        for name in &mut path.names {
            let Some((bare, Index::Parameter(parameter, added))) = instance_of(&name.text) else { continue };
            let index = Path { names: vec![Name::new(parameter, name.at.0)] };
            let index = Expr { kind: ExprKind::Path(index), at: name.at };
            if let Ok(n) = self.eval(scope, &index) {
                *name = Name::new(format!("{bare}[{}]", n.whole()? + i128::from(added)), name.at.0);
            }
        }
        Ok(path)
    }

    /// Where something stands that a path names, with the indexes in its names evaluated.
    fn stands(&mut self, scope: ScopeId, path: &Path) -> Run<Option<Stands>> {
        let path = self.numbered(scope, path)?;
        let names = texts(&path);
        let known = |m: &Model, at: &Stands| {
            m.composed.contains_key(at)
                || m.scopes[at.0].vars.contains_key(&at.1)
                || m.scopes[at.0].arrays.contains_key(&at.1)
        };
        if let Some(running) = self.running.last() {
            let found = self.within(running, &names).unwrap_or((FILE, names.join(".")));
            return Ok(Some(found).filter(|at| known(self.m, at)));
        }
        let short: Vec<&str> = names.iter().map(String::as_str).collect();
        if let Some((home, names)) = self.m.of_block(scope, &short) {
            return Ok(Some((home, names.join("."))).filter(|at| known(self.m, at)));
        }
        for s in self.m.chain(scope) {
            let at = (s, names.join("."));
            if known(self.m, &at) {
                return Ok(Some(at));
            }
        }
        let Some((first, rest)) = names.split_first() else { return Ok(None) };
        let chart = self.m.chart_named(scope, first);
        Ok(chart.map(|c| (c, rest.join("."))).filter(|at| known(self.m, at)))
    }

    fn stands_of(&mut self, scope: ScopeId, e: &Expr) -> Run<Option<Stands>> {
        match &e.kind {
            ExprKind::Path(path) => self.stands(scope, path),
            ExprKind::Element(path, index, None) => {
                let indexes = self.indexes(scope, index)?;
                self.stands(scope, &super::arrays::element(path, &indexes))
            }
            _ => Ok(None),
        }
    }

    /// `a := b` of whole structures.
    pub(super) fn copied_whole(&mut self, scope: ScopeId, to: &Expr, from: &Expr) -> Run<bool> {
        let (to, from) = (self.stands_of(scope, to)?, self.stands_of(scope, from)?);
        match (to, from) {
            (Some(to), Some(from))
                if self.m.composed.contains_key(&to) && self.m.composed.contains_key(&from) =>
            {
                self.copy_members(&to, &from).map(|()| true)
            }
            _ => Ok(false),
        }
    }

    fn copy_members(&mut self, to: &Stands, from: &Stands) -> Run<()> {
        let m = self.m;
        for (name, v) in &m.scopes[to.0].vars {
            let Some(rest) = name.strip_prefix(&*to.1).filter(|r| r.starts_with(['.', '['])) else {
                continue;
            };
            let Some(source) = m.scopes[from.0].vars.get(&format!("{}{rest}", from.1)) else {
                return bad(format!("{}{rest} is nothing", from.1));
            };
            self.s.vars[*v] = self.s.vars[*source].clone();
            self.written.push(*v);
        }
        Ok(())
    }

    /// Runs a call of a function block of one's own; false if the path names none.
    pub(super) fn call_own(&mut self, scope: ScopeId, path: &Path, args: &[Arg]) -> Run<bool> {
        let m = self.m;
        let Some(stands) = self.stands(scope, path)? else { return self.outside(scope, path) };
        let Some(ty) = m.composed.get(&stands) else { return Ok(false) };
        let block = &m.types[ty];
        if !block.block {
            return Ok(false);
        }
        let member = |name: &Name| (stands.0, format!("{}.{}", stands.1, name.text));
        let mut inouts = BTreeMap::new();
        for (k, arg) in args.iter().enumerate().filter(|(_, a)| !a.output) {
            let Some((decl, name, inout)) = parameter(block, k, arg) else { return bad("no such parameter") };
            if inout {
                let Some(outer) = self.stands_of(scope, &arg.value)? else { return bad("no variable") };
                inouts.insert(name.text.to_string(), outer);
            } else if decl.of.as_ref().is_some_and(|of| m.types.contains_key(&*of.text)) {
                let Some(from) = self.stands_of(scope, &arg.value)? else { return bad("no structure") };
                self.copy_members(&member(name), &from)?;
            } else {
                let value = self.eval(scope, &arg.value)?;
                self.put_member(&member(name), &value)?;
            }
        }
        self.running.push(Running { stands: stands.clone(), ty: ty.clone(), inouts });
        let mut frame = Frame::default();
        let body = block.body.as_ref().map(Body::block);
        let ran = body.map_or(Ok(()), |body| {
            self.locals(scope, body, &mut frame)?;
            self.frames.push(frame);
            let ran = self.block(FILE, &body.statements);
            self.frames.pop();
            ran.map(drop)
        });
        self.running.pop();
        ran?;
        for arg in args.iter().filter(|a| a.output) {
            let Some(name) = &arg.name else { return bad("an output without a name") };
            let (s, text) = member(name);
            if m.composed.contains_key(&(s, text.clone())) {
                let Some(to) = self.stands_of(scope, &arg.value)? else { return bad("no structure") };
                self.copy_members(&to, &(s, text))?;
                continue;
            }
            let Some(v) = m.scopes[s].vars.get(&text) else { return bad("no such output") };
            let value = self.read(&Ref::Var(*v))?;
            self.assign(scope, &arg.value, &value)?;
        }
        Ok(true)
    }

    /// A call by an index that no instance has is the fault `range`.
    fn outside(&self, scope: ScopeId, path: &Path) -> Run<bool> {
        let bare = |n: &Name| n.text.split('[').next().unwrap_or_default().to_owned();
        let indexed = path.names.iter().any(|n| n.text.contains('['));
        let names: Vec<String> = path.names.iter().map(bare).collect();
        let array = match self.running.last() {
            Some(running) => self.within(running, &names),
            None => self
                .m
                .chain(scope)
                .into_iter()
                .map(|s| (s, names.join(".")))
                .find(|at| self.m.composed.contains_key(at)),
        };
        let is = array.is_some_and(|at| self.m.composed.contains_key(&at));
        if indexed && is { Err(super::value::NaiveFault::Index) } else { Ok(false) }
    }

    fn put_member(&mut self, (scope, text): &Stands, value: &super::value::Typed) -> Run<()> {
        let Some(&v) = self.m.scopes[*scope].vars.get(text) else { return bad(format!("{text} is nothing")) };
        self.s.vars[v] = held(self.m.vars[v].range, value.to(self.m.vars[v].ty)?)?;
        self.written.push(v);
        Ok(())
    }
}

/// The parameter of an argument: its declaration, its name, and whether it stands for a variable of the caller.
fn parameter<'c>(block: &'c Composed, k: usize, arg: &Arg) -> Option<(&'c VarDecl, &'c Name, bool)> {
    let inputs = block.members.iter().filter(|m| m.kind == VarKind::Input).map(|m| (m, false));
    let all = inputs.chain(block.inouts.iter().map(|m| (m, true)));
    let mut all: Vec<_> = all.flat_map(|(m, inout)| m.names.iter().map(move |n| (m, n, inout))).collect();
    all.sort_by_key(|(_, n, _)| n.at.0.start);
    match &arg.name {
        Some(name) => all.into_iter().find(|(_, n, _)| n.text == name.text),
        None => all.into_iter().nth(k),
    }
}

fn texts(path: &Path) -> Vec<String> {
    path.names.iter().map(|n| n.text.to_string()).collect()
}

/// A name in a scope, with a bit or a member of a block of the standard as a name of its own.
fn split_member(m: &Model, scope: ScopeId, text: &str) -> Vec<Name> {
    let name = |t: &str| Name::new(t, g7_model::Span::default());
    match text.rsplit_once('.') {
        Some((before, last)) if !m.scopes[scope].vars.contains_key(text) => vec![name(before), name(last)],
        _ => vec![name(text)],
    }
}
