//! Assignments of whole structures: one for each member.

use super::base::{Composition, Env, MOST, Segment, Spot};
use super::paths::Lost;
use crate::{Expr, ExprKind, Place, Problem, Stmt, StmtKind, codes, say};

impl<'d> Composition<'d> {
    /// The assignments of all members of one structure to those of another one.
    pub(super) fn copy(&mut self, target: &Expr, value: &Expr, at: Place, env: &Env<'_, 'd>) -> Vec<Stmt> {
        match (self.spot_of(target, env), self.spot_of(value, env)) {
            (Ok(Some(to)), Ok(Some(from))) => self.copied(to, from, at, env).unwrap_or_default(),
            _ => Vec::new(),
        }
    }

    /// The same for variables that are found already.
    pub(super) fn copied(
        &mut self,
        to: Spot<'d>,
        from: Spot<'d>,
        at: Place,
        env: &Env<'_, 'd>,
    ) -> Result<Vec<Stmt>, Lost> {
        let whole = |s: &Spot<'d>| s.decl.array.as_ref().is_some_and(|_| s.own.is_empty());
        let (Some(a), Some(b)) = (to.of, from.of) else { return Err(Lost) };
        if a.name.text != b.name.text || whole(&to) != whole(&from) {
            let what = say!("`{}` and `{}` differ in bounds or type", to.shown(), from.shown());
            return Err(self.lost(Problem::new(&codes::WRONG_TYPE, at.0, what)));
        }
        if self.blocks.contains(&*a.name.text) {
            let what = say!("an instance of `{}` cannot be copied", a.name.text);
            return Err(self.lost(Problem::new(&codes::NOT_WRITABLE, at.0, what)));
        }
        let (mut targets, mut values) = (Vec::new(), Vec::new());
        // Within an element of an array, an array is copied element by element.
        let single = [&to, &from].into_iter().any(|s| !s.index.is_empty() || !s.own.is_empty());
        self.leaves(to.whole(), single, env, &mut targets)?;
        self.leaves(from.whole(), single, env, &mut values)?;
        if !self.takes(targets.len(), at.0) {
            return Err(Lost);
        }
        let mut list = Vec::new();
        for (target, value) in targets.into_iter().zip(values) {
            let (span, from) = (target.at, value.at);
            let Some(target) = self.plain(target, true) else { return Err(Lost) };
            let target = Expr { kind: target, at: span.into() };
            let value = Expr { kind: value.kind(), at: from.into() };
            list.push(Stmt { kind: StmtKind::Assign { target, value }, at });
        }
        Ok(list)
    }

    /// All variables within a structure, in the order of the members.
    fn leaves(
        &mut self,
        spot: Spot<'d>,
        single: bool,
        env: &Env<'_, 'd>,
        all: &mut Vec<Spot<'d>>,
    ) -> Result<(), Lost> {
        if all.len() > MOST {
            return Ok(());
        }
        if let Some(array) = spot.decl.array.as_ref().filter(|_| spot.own.is_empty() && single) {
            for own in self.indexes(&array.dimensions, env).ok_or(Lost)? {
                self.leaves(Spot { own, ..spot.clone() }, single, env, all)?;
            }
            return Ok(());
        }
        let Some(of) = spot.of else {
            all.push(spot);
            return Ok(());
        };
        for name in of.members.iter().flat_map(|m| &m.names) {
            let segment = Segment { name: name.clone(), index: Vec::new() };
            let at = spot.at;
            let inner = self.step(spot.clone(), &segment)?;
            self.leaves(Spot { at, ..inner }, single, env, all)?;
        }
        Ok(())
    }

    /// True if an expression is a path to something with members.
    pub(super) fn is_structure(&mut self, e: &Expr, env: &Env<'_, 'd>) -> bool {
        let told = self.problems.len();
        let is = matches!(e.kind, ExprKind::Path(_) | ExprKind::Element(..))
            && matches!(self.spot_of(e, env), Ok(Some(spot)) if spot.of.is_some());
        self.problems.truncate(told);
        is
    }
}
