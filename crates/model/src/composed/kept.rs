//! Instances of function blocks that stay: their declarations, calls and members.
//!
//! The walk asks here for each instance. Where one is used as no variable can be, its type is refused (see
//! [`super::blocks`], which then begins again without it).

use super::base::{Composition, Env, Segment, Spot};
use super::paths::{filled, member};
use crate::{
    Arg, Composed, Expr, ExprKind, Name, Path, Place, Problem, Stmt, StmtKind, UnaryOp, VarDecl, VarKind,
    codes, say, with_slot,
};

/// True for a literal, also with a sign.
pub(super) fn is_written(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Unary(UnaryOp::Neg, inner) => matches!(inner.kind, ExprKind::Literal(_)),
        _ => false,
    }
}

/// True for an input or an output.
pub(super) fn is_parameter(v: &VarDecl) -> bool {
    matches!(v.kind, VarKind::Input | VarKind::Output)
}

impl<'d> Composition<'d> {
    /// From an instance of a function block that stays to one of its members.
    pub(super) fn member_of_kept(
        &mut self,
        mut spot: Spot<'d>,
        of: &'d Composed,
        decl: &'d VarDecl,
        segment: &Segment,
    ) -> Spot<'d> {
        let given = !self.kept.initial && is_given(&spot, &segment.name.text);
        let reachable = is_parameter(decl) && segment.index.is_empty() && !given;
        match self.instance(&spot) {
            Some(instance) if reachable => spot = instance,
            _ => self.kept.refuse(of),
        }
        spot.within = Some((of, segment.name.clone()));
        spot.inner |= decl.kind != VarKind::Input;
        spot.of = self.type_of(decl);
        spot.at = spot.at.to(segment.name.at.0);
        spot.decl = decl;
        spot
    }

    /// Refuses a function block if an expression means a member of an instance of it, where only a variable can stand.
    pub(super) fn no_member_of_kept(&mut self, e: &Expr, env: &Env<'_, 'd>) {
        if self.kept.names.is_empty() || !matches!(e.kind, ExprKind::Path(_) | ExprKind::Element(..)) {
            return;
        }
        if let Ok(Some(Spot { within: Some((of, _)), .. })) = self.spot_of(e, env) {
            self.kept.refuse(of);
        }
    }

    /// The variable of one instance of a function block that stays: of an element of an array, `valve[3]`. None for a whole
    /// array, for an element whose index is computed, and for an instance within another one.
    fn instance(&mut self, spot: &Spot<'d>) -> Option<Spot<'d>> {
        if let Some((outer, _)) = &spot.within {
            self.kept.refuse(outer);
            return None;
        }
        let dimensions = spot.decl.array.as_ref().map_or(0, |a| a.dimensions.len());
        let known = |e: &Expr| e.kind.whole().is_some();
        if !spot.index.is_empty() || spot.own.len() != dimensions || !spot.own.iter().all(known) {
            return None;
        }
        let text = filled(&with_slot(&spot.text, dimensions), &spot.own);
        Some(Spot { text, own: Vec::new(), ..spot.clone() })
    }

    /// The declarations of a variable whose type is a function block that stays: one, or for an array one for each element.
    /// None if the type does not stay.
    pub(super) fn stay(&mut self, of: &'d Composed, v: &VarDecl, env: &Env<'_, 'd>) -> Option<Vec<VarDecl>> {
        if !self.kept.has(of) {
            return None;
        }
        let initial = self.kept.initial;
        let given = |e: &Expr| v.array.is_none() && gives(of, e, initial);
        let dimensions = v.array.as_ref().map_or(&[][..], |a| &a.dimensions);
        let indexes = self.indexes(dimensions, env);
        let (Some(indexes), true) = (indexes, v.init.as_ref().is_none_or(given)) else {
            self.kept.refuse(of);
            return None;
        };
        let mut one =
            VarDecl { array: None, of: Some(Box::new(of.name.clone())), names: Vec::new(), ..v.clone() };
        one.init = one.init.filter(|_| initial);
        one.init.iter_mut().for_each(|e| self.expr(e, env));
        let mut all = Vec::new();
        for name in &v.names {
            let text = with_slot(&name.text, dimensions.len());
            let named = |index: &Vec<Expr>| Name { text: filled(&text, index).into(), at: name.at };
            all.extend(indexes.iter().map(|index| VarDecl { names: vec![named(index)], ..one.clone() }));
        }
        Some(all)
    }

    /// The statements for an index of a call outside of the bounds: none. Tells of it, because here it is a fault.
    pub(super) fn nothing_outside(&mut self, spot: &Spot<'d>) -> Vec<Stmt> {
        let what = say!(
            "an index outside of the bounds of `{}` is a fault here, and there nothing is called",
            spot.text
        );
        self.once(Problem::new(&codes::DIFFERENT, spot.at, what));
        Vec::new()
    }

    /// The call of a function block that stays. Outputs for variables with bounds are assigned behind it, because an
    /// assignment holds the bounds.
    pub(super) fn kept_call(
        &mut self,
        spot: &Spot<'d>,
        (of, args, at): (&'d Composed, &[Arg], Place),
        env: &Env<'_, 'd>,
    ) -> Option<Vec<Stmt>> {
        let Some(instance) = self.instance(spot) else {
            self.kept.refuse(of);
            return None;
        };
        let ExprKind::Path(path) = instance.kind() else { return None };
        let (mut made, mut behind) = (Vec::new(), Vec::new());
        if !self.kept.initial {
            made.extend(fields(spot.decl).iter().cloned());
        }
        for (n, arg) in args.iter().enumerate() {
            let (name, inout) = self.name_of_argument(of, n, arg)?;
            if made.iter().any(|m| m.name.as_ref().is_some_and(|m| m.text == name.text)) {
                // Before this call, the input has the initial value.
                self.kept.refuse(of);
            }
            let mut value = arg.value.clone();
            if arg.output || inout {
                self.no_member_of_kept(&value, env);
                let held = arg.output && self.has_limits(&value, env);
                self.target(&mut value, env);
                if held {
                    let names = path.names.iter().chain([name]).cloned().collect();
                    let output = Expr { kind: ExprKind::Path(Path { names }), at: value.at };
                    behind.push(Stmt { kind: StmtKind::Assign { target: value, value: output }, at });
                    continue;
                }
            } else {
                self.expr(&mut value, env);
            }
            let name = Name { text: name.text.clone(), at: value.at };
            made.push(Arg { name: Some(name), output: arg.output, inout, value });
        }
        behind.insert(0, Stmt { kind: StmtKind::Call(path, made), at });
        Some(behind)
    }

    /// True if an expression is a variable that cannot have all values of its type.
    fn has_limits(&mut self, e: &Expr, env: &Env<'_, 'd>) -> bool {
        matches!(self.spot_of(e, env), Ok(Some(spot)) if spot.decl.limits.is_some())
    }
}

/// True if the initial values of an instance can be given: as values of its parameters if `initial`, else in each call, as
/// inputs with a written value.
fn gives(of: &Composed, init: &Expr, initial: bool) -> bool {
    let ExprKind::Call(path, fields) = &init.kind else { return false };
    let fits = |f: &Arg| {
        let decl = f.name.as_ref().and_then(|n| member(of, &n.text)).filter(|d| is_parameter(d));
        decl.is_some_and(|d| initial || d.kind == VarKind::Input && is_written(&f.value))
    };
    path.names.is_empty() && fields.iter().all(fits)
}

/// The initial values in the declaration of an instance.
fn fields(instance: &VarDecl) -> &[Arg] {
    match &instance.init {
        Some(Expr { kind: ExprKind::Call(_, fields), .. }) => fields,
        _ => &[],
    }
}

/// True if the declaration of an instance gives a member its initial value.
fn is_given(instance: &Spot<'_>, member: &str) -> bool {
    fields(instance.decl).iter().any(|f| f.name.as_ref().is_some_and(|n| *n.text == *member))
}
