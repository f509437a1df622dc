//! Declarations: a variable for each member.

use super::base::{Composition, Env, MOST, has_fields, is_local};
use super::paths::filled;
use crate::{
    Arg, Array, Composed, Expr, ExprKind, Literal, Local, Name, Path, Place, Problem, Stmt, StmtKind,
    VarDecl, VarKind, codes, say, visit_mut, with_slot,
};

/// A part of a variable whose members are declared.
#[derive(Clone)]
struct Part<'v> {
    /// Its name, with `[]` for indexes.
    text: String,
    /// The bounds of the indexes.
    dimensions: Vec<(Expr, Expr)>,
    /// The value of each element, in the order of the indexes; one value if there are no dimensions. None where the
    /// author gives no value.
    values: Vec<Option<Expr>>,
    kind: VarKind,
    retain: bool,
    /// Its type, if that is a structure that its writer keeps.
    structure: Option<&'v Name>,
    /// The declaration of the whole variable.
    whole: &'v VarDecl,
    at: Place,
}

impl<'d> Composition<'d> {
    /// The declarations of the members of a variable; other variables keep their declaration.
    pub(super) fn declared(&mut self, mut v: VarDecl, env: &Env<'_, 'd>) -> Vec<VarDecl> {
        for e in v.init.iter_mut().chain(&mut v.safe).filter(|e| !has_fields(e)) {
            self.expr(e, env);
        }
        let Some(of) = v.of.take() else {
            if let Some(e) = v.init.take_if(|e| has_fields(e)) {
                let what = say!("values with names are those of a structure; this variable is {}", v.ty);
                self.problems.push(Problem::new(&codes::WRONG_TYPE, e.at.0, what));
            }
            return vec![v];
        };
        let Some(ty) = self.types.get(&*of.text).copied() else {
            if !self.wrong.contains(&*of.text) {
                self.unknown_type(&of);
            }
            v.init = v.init.filter(|e| !has_fields(e));
            return vec![v];
        };
        self.used.insert(&ty.name.text);
        if let Some(all) = self.stay(ty, &v, env) {
            return all;
        }
        if v.array.is_some() {
            // The parser has reported a value that is no list.
            v.init = v.init.filter(|e| matches!(e.kind, ExprKind::List(_)));
        }
        if !self.sensible(&v, ty) {
            v.address = None;
        }
        let mut all = Vec::new();
        let stays = self.kept.structures && !self.blocks.contains(&*ty.name.text);
        for name in &v.names {
            let dimensions = v.array.as_ref().map_or(Vec::new(), |a| a.dimensions.clone());
            let values = self.values(&dimensions, vec![v.init.clone()], ty, env);
            let part = Part {
                text: with_slot(&name.text, dimensions.len()),
                dimensions,
                values,
                kind: v.kind,
                retain: v.retain,
                structure: stays.then_some(&*of),
                whole: &v,
                at: name.at,
            };
            self.parts(ty, part, env, &mut all);
        }
        all
    }

    /// Reports what a variable with members cannot have.
    fn sensible(&mut self, v: &VarDecl, ty: &Composed) -> bool {
        let name = &ty.name.text;
        let block = self.blocks.contains(&**name);
        let kind = match v.kind {
            VarKind::Input => Some(say!("an input")),
            VarKind::Output => Some(say!("an output")),
            VarKind::Const => Some(say!("a constant")),
            VarKind::Var => None,
        };
        if let Some(kind) = kind.filter(|_| block) {
            let what = say!("an instance of `{name}` cannot be {kind}");
            let help = say!("declare it plainly: `var name : {name}`");
            self.problems.push(Problem::new(&codes::BAD_DECLARATION, v.at.0, what).help(help));
        }
        let at = v.address.as_ref().map(|a| a.at.0).or(v.safe.as_ref().map(|s| s.at.0));
        if let Some(at) = at.or(v.inverted.then_some(v.at.0)) {
            let what =
                say!("a variable of `{name}` has no address and no value for a stop; its members are many");
            let help = say!("give its members their channels in the io file");
            self.problems.push(Problem::new(&codes::BAD_DECLARATION, at, what).help(help));
            return false;
        }
        true
    }

    /// Declares the members of a part.
    fn parts(&mut self, ty: &'d Composed, part: Part<'_>, env: &Env<'_, 'd>, all: &mut Vec<VarDecl>) {
        for member in &ty.members {
            if self.full {
                return;
            }
            for name in &member.names {
                let Some(values) = self.fields(ty, member, &name.text, &part, env) else { return };
                let mut inner = Part { values, retain: part.retain || member.retain, ..part.clone() };
                if ty.block || member.kind == VarKind::Const {
                    inner.kind = if member.kind == VarKind::Const { VarKind::Const } else { VarKind::Var };
                }
                if is_local(ty, member) && !part.dimensions.is_empty() {
                    self.each((ty, member), name, &inner, env, all);
                } else {
                    inner.text = format!("{}.{}", part.text, name.text);
                    self.member((ty, member), inner, env, all);
                }
            }
        }
        self.known(&part.values, ty);
    }

    /// Declares a member for each element of its arrays, as one variable each.
    fn each(
        &mut self,
        member: (&Composed, &'d VarDecl),
        name: &Name,
        part: &Part<'_>,
        env: &Env<'_, 'd>,
        all: &mut Vec<VarDecl>,
    ) {
        let Some(indexes) = self.indexes(&part.dimensions, env) else {
            return self.wrong_bounds(&part.dimensions, env);
        };
        let count = part.values.len() / indexes.len().max(1);
        for (n, index) in indexes.iter().enumerate() {
            let values = part.values.iter().skip(n * count).take(count.max(1)).cloned().collect();
            let text = format!("{}.{}", filled(&part.text, index), name.text);
            self.member(member, Part { text, dimensions: Vec::new(), values, ..part.clone() }, env, all);
        }
    }

    /// Reports an array that cannot be, where no array is made that would be reported later.
    fn wrong_bounds(&mut self, dimensions: &[(Expr, Expr)], env: &Env<'_, 'd>) {
        for (least, most) in dimensions {
            let place = least.at.0.to(most.at.0);
            let problem = match (self.whole(least, env), self.whole(most, env)) {
                (Some(low), Some(high)) if low > high => {
                    let what = say!("an array from {low} to {high} has no elements");
                    Problem::new(&codes::EMPTY_RANGE, place, what)
                }
                (Some(_), Some(_)) => {
                    let what = say!("all arrays together have at most {MOST} elements");
                    Problem::new(&codes::OUT_OF_RANGE, place, what)
                }
                _ => {
                    let what = say!(
                        "a bound of an array is a whole number, or a constant that is declared before it"
                    );
                    Problem::new(&codes::NOT_CONSTANT, place, what)
                }
            };
            self.once(problem);
        }
    }

    /// Declares one member of a type, whose own bounds come last.
    fn member(
        &mut self,
        (of, member): (&Composed, &'d VarDecl),
        mut part: Part<'_>,
        env: &Env<'_, 'd>,
        all: &mut Vec<VarDecl>,
    ) {
        let own = bounds(of, member);
        if let Some(ty) = self.type_of(member) {
            self.used.insert(&ty.name.text);
            if let Some(stay) = self.part_stays(ty, member, &part, &own, env) {
                return all.extend(stay);
            }
            part.values = self.values(&own, part.values, ty, env);
            part.text = with_slot(&part.text, own.len());
            part.dimensions.extend(own);
            return self.parts(ty, part, env, all);
        }
        part.dimensions.extend(own);
        if self.takes(1, part.at.0) {
            all.push(leaf(member, part));
        }
    }

    /// The declarations of a member that stays an instance of a function block, or of an array of such.
    fn part_stays(
        &mut self,
        ty: &'d Composed,
        member: &VarDecl,
        part: &Part<'_>,
        own: &[(Expr, Expr)],
        env: &Env<'_, 'd>,
    ) -> Option<Vec<VarDecl>> {
        // An element of an array of structures is no variable, and calls do not see the values of the whole one.
        let given = !self.kept.initial && part.values.iter().any(Option::is_some);
        if (given || !part.dimensions.is_empty()) && self.kept.has(ty) {
            self.kept.refuse(ty);
            return None;
        }
        let array = (!own.is_empty()).then(|| Box::new(Array { dimensions: own.to_vec(), at: part.at }));
        let plain = Part { dimensions: Vec::new(), ..part.clone() };
        self.stay(ty, &VarDecl { array, ..leaf(member, plain) }, env)
    }

    /// The value of a member in each element of a part. If the member is an array, the values of its elements follow one
    /// another.
    fn fields(
        &mut self,
        ty: &Composed,
        member: &VarDecl,
        name: &str,
        part: &Part<'_>,
        env: &Env<'_, 'd>,
    ) -> Option<Vec<Option<Expr>>> {
        let mut values = Vec::new();
        for whole in &part.values {
            let given = whole.as_ref().and_then(|e| field(e, name)).cloned();
            values.push(given.map(|mut e| {
                if !has_fields(&e) {
                    self.expr(&mut e, env);
                }
                e
            }));
        }
        let usual = member.init.as_ref().map(|e| self.usual(ty, e, env));
        for value in &mut values {
            *value = value.take().or_else(|| usual.clone());
        }
        let own = &bounds(ty, member);
        if own.is_empty() || self.type_of(member).is_some() || values.iter().all(Option::is_none) {
            return Some(values);
        }
        let at = ty.name.at.0;
        let count = self.indexes(own, env)?.len();
        let lists = values.into_iter().map(|v| self.expanded(v, count)).collect::<Vec<_>>();
        let all: Vec<Option<Expr>> = lists.into_iter().flatten().collect();
        self.takes(all.len() / 16, at).then_some(all)
    }

    /// The value in the declaration of a type: it names constants of the type, or what the file has.
    fn usual(&mut self, ty: &Composed, e: &Expr, env: &Env<'_, 'd>) -> Expr {
        let mut e = e.clone();
        visit_mut::expr(&mut e, &mut Constants(ty));
        let mut names = Names(Vec::new());
        visit_mut::expr(&mut e, &mut names);
        let (chart, _) = env.root();
        for name in names.0 {
            if let Some(own) = chart.and_then(|c| self.scope(c)?.get(&*name.text)).map(|v| v.at.0) {
                self.once(super::paths::two_meanings(&name, own));
            }
        }
        e
    }

    /// The values of the elements of an array; `wholes` are the lists that the author wrote, one for each array.
    fn values(
        &mut self,
        own: &[(Expr, Expr)],
        wholes: Vec<Option<Expr>>,
        ty: &Composed,
        env: &Env<'_, 'd>,
    ) -> Vec<Option<Expr>> {
        if own.is_empty() {
            return wholes;
        }
        let Some(indexes) = self.indexes(own, env) else { return vec![None; wholes.len()] };
        if !self.takes(indexes.len() * wholes.len() / 16, ty.name.at.0) {
            return Vec::new();
        }
        wholes.into_iter().flat_map(|w| self.expanded(w, indexes.len())).collect()
    }

    /// The values of a list, each as often as it is repeated.
    fn expanded(&mut self, list: Option<Expr>, count: usize) -> Vec<Option<Expr>> {
        let mut values = Vec::new();
        match list {
            Some(Expr { kind: ExprKind::List(list), at }) => {
                for (times, value) in list {
                    let room = count.saturating_sub(values.len());
                    if times as usize > room {
                        let what = say!("there are more values than the {count} elements of the array");
                        self.once(Problem::new(&codes::OUT_OF_RANGE, at.0, what));
                    }
                    values.extend(std::iter::repeat_n(Some(value), room.min(times as usize)));
                }
            }
            Some(e) => {
                let what = say!("the values of an array stand in brackets");
                self.once(Problem::new(&codes::WRONG_TYPE, e.at.0, what));
            }
            None => {}
        }
        values.resize(count, None);
        values
    }

    /// Reports values of members that the type does not have.
    fn known(&mut self, values: &[Option<Expr>], ty: &Composed) {
        for e in values.iter().flatten() {
            let ExprKind::Call(path, fields) = &e.kind else {
                let what = say!("the values of a structure stand in brackets with their names");
                let name =
                    ty.members.first().and_then(|m| m.names.first()).map_or("a", |n| &*n.text).to_owned();
                self.once(Problem::new(&codes::WRONG_TYPE, e.at.0, what).help(say!("write `({name} := …)`")));
                continue;
            };
            let names = fields.iter().filter_map(|f| f.name.as_ref()).filter(|_| path.names.is_empty());
            for (n, name) in names.clone().enumerate() {
                if super::paths::member(ty, &name.text).is_none() {
                    let what = say!("`{}` has no member `{}`", ty.name.text, name.text);
                    self.once(Problem::new(&codes::UNKNOWN_MEMBER, name.at.0, what));
                } else if names.clone().take(n).any(|other| other.text == name.text) {
                    self.once(Problem::new(
                        &codes::WRONG_ARGUMENTS,
                        name.at.0,
                        say!("`{}` has two values", name.text),
                    ));
                }
            }
        }
    }

    /// Reports a problem that may be found for each of several elements.
    pub(super) fn once(&mut self, problem: Problem) {
        if !self.problems.iter().any(|p| p.at == problem.at && p.code.id == problem.code.id) {
            self.problems.push(problem);
        }
    }

    /// All indexes of some dimensions, the last one counting fastest; None if the bounds are not known, which is
    /// reported where the arrays are made.
    pub(super) fn indexes(
        &mut self,
        dimensions: &[(Expr, Expr)],
        env: &Env<'_, 'd>,
    ) -> Option<Vec<Vec<Expr>>> {
        let mut all: Vec<Vec<Expr>> = vec![Vec::new()];
        for (least, most) in dimensions {
            let (low, high) = (self.whole(least, env)?, self.whole(most, env)?);
            let count = usize::try_from(high.checked_sub(low)?.checked_add(1)?).ok()?;
            if count.checked_mul(all.len()).is_none_or(|n| n > MOST) {
                return None;
            }
            let numbers = |index: &Vec<Expr>| {
                let index = index.clone();
                (low..=high).map(move |n| [&index[..], &[number(n, least.at)]].concat()).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(numbers).collect();
        }
        Some(all)
    }

    /// A whole number as written, or that of a constant.
    pub(super) fn whole(&self, e: &Expr, env: &Env<'_, 'd>) -> Option<i128> {
        match &e.kind {
            ExprKind::Path(path) => match path.names.as_slice() {
                [name] => self.constant(&name.text, env),
                _ => None,
            },
            ExprKind::Binary(op, a, b) => match op {
                crate::BinaryOp::Add => self.whole(a, env)?.checked_add(self.whole(b, env)?),
                crate::BinaryOp::Sub => self.whole(a, env)?.checked_sub(self.whole(b, env)?),
                _ => None,
            },
            kind => kind.whole(),
        }
    }

    fn constant(&self, name: &str, env: &Env<'_, 'd>) -> Option<i128> {
        let own = env.instance().and_then(|i| i.of).and_then(|of| super::paths::member(of, name));
        let (chart, locals) = env.root();
        let outer = || {
            let shown = !locals.iter().any(|l| **l == *name);
            let of_chart = chart.filter(|_| shown).and_then(|c| self.scope(c)?.get(name));
            of_chart.or_else(|| self.file.get(name).filter(|_| shown)).copied()
        };
        let decl = own.or_else(outer)?;
        decl.init.as_ref().filter(|_| decl.kind == VarKind::Const)?.kind.whole()
    }
}

/// The bounds of a member, with the values of constants of its type.
pub(super) fn bounds(ty: &Composed, member: &VarDecl) -> Vec<(Expr, Expr)> {
    let mut all = member.array.as_ref().map_or(Vec::new(), |a| a.dimensions.clone());
    for (least, most) in &mut all {
        visit_mut::expr(least, &mut Constants(ty));
        visit_mut::expr(most, &mut Constants(ty));
    }
    all
}

/// Puts the written numbers and values of a type's own constants in the place of their names.
struct Constants<'c>(&'c Composed);

impl visit_mut::Visitor for Constants<'_> {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Path(path) = &e.kind else { return };
        let [name] = path.names.as_slice() else { return };
        let own = super::paths::member(self.0, &name.text).filter(|m| m.kind == VarKind::Const);
        if let Some(Expr { kind: kind @ (ExprKind::Literal(_) | ExprKind::Unary(..)), .. }) =
            own.and_then(|m| m.init.as_ref())
        {
            e.kind = kind.clone();
        }
    }
}

/// The first names of all paths in an expression.
struct Names(Vec<Name>);

impl visit_mut::Visitor for Names {
    fn path(&mut self, path: &mut Path, _: visit_mut::Use, _: crate::Span) {
        self.0.extend(path.names.first().cloned());
    }
}

/// A member of a declaration as one variable or array.
fn leaf(member: &VarDecl, part: Part<'_>) -> VarDecl {
    let constant = part.kind == VarKind::Const;
    let list = constant || part.values.iter().any(Option::is_some);
    let init = match part.dimensions.is_empty() {
        true => {
            let value = part.values.into_iter().next().flatten();
            value.or_else(|| constant.then(|| Expr::zero(member.ty, part.at)))
        }
        false => list.then(|| {
            let zero = member.usual.as_deref().cloned().unwrap_or_else(|| Expr::zero(member.ty, part.at));
            let values = part.values.into_iter().map(|v| (1, v.unwrap_or_else(|| zero.clone()))).collect();
            Expr { kind: ExprKind::List(values), at: part.at }
        }),
    };
    let array =
        (!part.dimensions.is_empty()).then(|| Box::new(Array { dimensions: part.dimensions, at: part.at }));
    VarDecl {
        array,
        part_of: part.structure.cloned().map(Box::new),
        limits: member.limits.clone(),
        usual: member.usual.clone(),
        init,
        retain: part.retain && part.kind == VarKind::Var,
        comment: member.comment.clone().or_else(|| part.whole.comment.clone()),
        ..VarDecl::new(
            part.kind,
            vec![Name { text: part.text.into(), at: part.at }],
            member.ty,
            part.whole.at,
        )
    }
}

/// The local variables of a declaration in a body as members.
pub(super) fn local_member(local: &Local) -> VarDecl {
    VarDecl::of_type(VarKind::Var, local.names.clone(), &local.ty, local.at)
}

/// The assignments of their initial values to the local variables of a declaration.
pub(super) fn local_values(local: &Local) -> Vec<Stmt> {
    let value = local.init.clone().unwrap_or_else(|| Expr::zero(local.ty.base, local.at));
    let assigned = |name: &Name| {
        let target = Expr { kind: ExprKind::Path(Path { names: vec![name.clone()] }), at: name.at };
        Stmt { kind: StmtKind::Assign { target, value: value.clone() }, at: local.at }
    };
    local.names.iter().map(assigned).collect()
}

fn number(n: i128, at: Place) -> Expr {
    Expr { kind: ExprKind::Literal(Literal::Int(n, None)), at }
}

/// The value of a member in the values of a structure.
fn field<'e>(e: &'e Expr, name: &str) -> Option<&'e Expr> {
    let ExprKind::Call(path, fields) = &e.kind else { return None };
    let named = |f: &&Arg| f.name.as_ref().is_some_and(|n| &*n.text == name);
    fields.iter().find(named).filter(|_| path.names.is_empty()).map(|f| &f.value)
}
