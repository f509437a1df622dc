//! Queues and tracks of parts, as plain variables: `max` places, each with its attributes and, on a
//! track, its position. Place 0 holds the part that came first; when a part in the middle leaves,
//! those behind it move up.

use g7_model::{BinaryOp, Expr, Parts, Place, Stmt, StmtKind, Type, VarDecl, VarKind};

use super::build::At;

/// The declaration of one queue or track.
pub(super) struct Table<'d> {
    pub(super) parts: &'d Parts,
}

impl<'d> Table<'d> {
    pub(super) fn name(&self) -> &'d str {
        &self.parts.name.text
    }

    pub(super) fn is_track(&self) -> bool {
        self.parts.length.is_some()
    }

    fn places(&self) -> u32 {
        self.parts.max
    }

    /// The amount of code that one search through all its parts needs.
    pub(super) fn size(&self) -> usize {
        (self.columns().len() + 1) * self.places() as usize
    }

    pub(super) fn attributes(&self) -> impl Iterator<Item = (&'d str, Type)> {
        self.parts.attributes.iter().map(|a| (&*a.name.text, a.ty.base))
    }

    /// Everything a part has: its attributes, and its position on a track.
    fn columns(&self) -> Vec<(&'d str, Type)> {
        let position = self.is_track().then_some(("position", Type::Lreal));
        self.attributes().chain(position).collect()
    }

    pub(super) fn has(&self, column: &str) -> bool {
        self.columns().iter().any(|(name, _)| *name == column)
    }

    fn cell(&self, column: &str, place: u32) -> String {
        format!("{}.{column}.{place}", self.name())
    }

    pub(super) fn count(&self) -> String {
        format!("{}.count", self.name())
    }

    pub(super) fn lost(&self) -> String {
        format!("{}.lost", self.name())
    }

    /// The variables of the table, with the initial values that the author gives.
    pub(super) fn declare(&self) -> Vec<VarDecl> {
        let at = At(self.parts.name.at);
        let full = self.parts.init.len().min(self.places() as usize);
        let mut list = vec![
            at.declare(VarKind::Var, &self.count(), Type::Int, Some(at.int(full as i128))),
            at.declare(VarKind::Var, &self.lost(), Type::Int, None),
            at.declare(VarKind::Var, &self.gone(), Type::Int, None),
        ];
        if self.is_track() {
            list.push(at.declare(VarKind::Var, &self.way(), Type::Lreal, None));
        }
        for (column, ty) in self.attributes() {
            list.push(at.declare(VarKind::Var, &self.joining(column), ty, None));
        }
        for place in 0..self.places() {
            for (k, (column, ty)) in self.columns().into_iter().enumerate() {
                let init = self.parts.init.get(place as usize).and_then(|part| part.get(k)).cloned();
                list.push(at.declare(VarKind::Var, &self.cell(column, place), ty, init));
            }
        }
        list
    }

    /// True if there is a part at a place.
    fn taken(&self, at: At, place: u32) -> Expr {
        at.binary(BinaryOp::Gt, at.var(&self.count()), at.int(i128::from(place)))
    }

    /// True if the part at a place stands in `from .. to` (the end not included).
    fn stands(&self, at: At, place: u32, range: &(Expr, Expr)) -> Expr {
        let position = at.var(&self.cell("position", place));
        let behind = at.binary(BinaryOp::Ge, position.clone(), range.0.clone());
        let before = at.binary(BinaryOp::Lt, position, range.1.clone());
        let inside = at.binary(BinaryOp::And, behind, before);
        at.binary(BinaryOp::And, self.taken(at, place), inside)
    }

    /// `T.at(from, to)`: some part stands there.
    pub(super) fn any(&self, at: At, range: &(Expr, Expr)) -> Expr {
        let any = (0..self.places())
            .map(|place| self.stands(at, place, range))
            .reduce(|a, b| at.binary(BinaryOp::Or, a, b))
            .unwrap_or_else(|| at.bool(false));
        // Said once more for all places, so that an empty track is not searched.
        at.binary(BinaryOp::And, self.taken(at, 0), any)
    }

    /// `T.colour(from, to)`: the colour of the first part there; zero of its type if there is none.
    pub(super) fn seen(&self, at: At, column: &str, range: &(Expr, Expr)) -> Expr {
        let ty = self.columns().into_iter().find(|(name, _)| *name == column).map_or(Type::Int, |(_, ty)| ty);
        (0..self.places()).rev().fold(at.zero(ty), |rest, place| {
            let here = at.var(&self.cell(column, place));
            at.call("SEL", vec![self.stands(at, place, range), rest, here])
        })
    }

    /// `T.first.colour`.
    pub(super) fn first(&self, at: At, column: &str) -> Expr {
        at.var(&self.cell(column, 0))
    }

    /// `T.last.colour`: the colour of the part that came last; zero of its type if there is none.
    pub(super) fn last(&self, at: At, column: &str) -> Expr {
        let ty = self.columns().into_iter().find(|(name, _)| *name == column).map_or(Type::Int, |(_, ty)| ty);
        (0..self.places()).fold(at.zero(ty), |rest, place| {
            at.call("SEL", vec![self.taken(at, place), rest, at.var(&self.cell(column, place))])
        })
    }

    /// `T.enter(…)`: a part enters at the back; without room it is lost.
    pub(super) fn enter(&self, at: At, values: Vec<Expr>) -> Vec<Stmt> {
        let mut body: Vec<Stmt> = self
            .attributes()
            .zip(values)
            .map(|((column, _), value)| at.assign(&self.joining(column), value))
            .collect();
        let arms = (0..self.places())
            .map(|place| {
                let mut body: Vec<Stmt> = self
                    .attributes()
                    .map(|(column, _)| at.assign(&self.cell(column, place), at.var(&self.joining(column))))
                    .collect();
                if self.is_track() {
                    body.push(at.assign(&self.cell("position", place), at.real("0.0")));
                }
                body.push(at.assign(&self.count(), at.int(i128::from(place) + 1)));
                g7_model::CaseArm { labels: vec![(at.int(i128::from(place)), None)], body }
            })
            .collect();
        let lost = at.binary(BinaryOp::Add, at.var(&self.lost()), at.int(1));
        body.push(at.stmt(StmtKind::Case(at.var(&self.count()), arms, vec![at.assign(&self.lost(), lost)])));
        body
    }

    /// An attribute of the part that is about to enter.
    fn joining(&self, column: &str) -> String {
        format!("@joins.{}.{column}", self.name())
    }

    /// The distance by which a rate moves the parts.
    pub(super) fn way(&self) -> String {
        format!("@way.{}", self.name())
    }

    /// The place of the part that is about to leave.
    fn gone(&self) -> String {
        format!("@goes.{}", self.name())
    }

    /// Removes the part at [`Table::gone`]; those behind it move up.
    fn remove(&self, at: At) -> Vec<Stmt> {
        let mut body = Vec::new();
        for to in 0..self.places().saturating_sub(1) {
            let behind = at.binary(BinaryOp::Le, at.var(&self.gone()), at.int(i128::from(to)));
            let columns = self.columns().into_iter();
            let moves = columns
                .map(|(column, _)| at.assign(&self.cell(column, to), at.var(&self.cell(column, to + 1))));
            body.push(at.when(behind, moves.collect()));
        }
        if let Some(last) = self.places().checked_sub(1) {
            for (column, ty) in self.columns() {
                body.push(at.assign(&self.cell(column, last), at.zero(ty)));
            }
        }
        body.push(at.assign(&self.count(), at.binary(BinaryOp::Sub, at.var(&self.count()), at.int(1))));
        body
    }

    /// `T.leave()`: the part that came first leaves.
    pub(super) fn leave(&self, at: At) -> Vec<Stmt> {
        vec![at.assign(&self.gone(), at.int(0)), at.when(self.taken(at, 0), self.remove(at))]
    }

    /// `T.leave_last()`: the part that came last leaves.
    pub(super) fn leave_last(&self, at: At) -> Vec<Stmt> {
        let left = at.binary(BinaryOp::Sub, at.var(&self.count()), at.int(1));
        let mut body = vec![at.assign(&self.count(), left)];
        let arms = (0..self.places())
            .map(|place| {
                let empty = self.columns().into_iter();
                let body = empty.map(|(column, ty)| at.assign(&self.cell(column, place), at.zero(ty)));
                g7_model::CaseArm { labels: vec![(at.int(i128::from(place)), None)], body: body.collect() }
            })
            .collect();
        body.push(at.stmt(StmtKind::Case(at.var(&self.count()), arms, Vec::new())));
        vec![at.when(self.taken(at, 0), body)]
    }

    /// `T.take(from, to)`: the first part there leaves.
    pub(super) fn take(&self, at: At, range: &(Expr, Expr)) -> Vec<Stmt> {
        let found = |k: u32| vec![at.assign(&self.gone(), at.int(i128::from(k)))];
        let arms = (0..self.places()).map(|k| (self.stands(at, k, range), found(k))).collect();
        let there = at.binary(BinaryOp::Lt, at.var(&self.gone()), at.int(i128::from(self.places())));
        vec![at.stmt(StmtKind::If(arms, found(self.places()))), at.when(there, self.remove(at))]
    }

    /// `T.clear()`.
    pub(super) fn clear(&self, at: At) -> Vec<Stmt> {
        let mut body = vec![at.assign(&self.count(), at.int(0))];
        for place in 0..self.places() {
            for (column, ty) in self.columns() {
                body.push(at.assign(&self.cell(column, place), at.zero(ty)));
            }
        }
        body
    }

    /// Moves every part of a track by a distance, within its length.
    pub(super) fn advance(&self, place: Place, way: &Expr, length: &Expr) -> Vec<Stmt> {
        let at = At(place);
        let moves = (0..self.places())
            .map(|k| {
                let cell = self.cell("position", k);
                let moved = at.binary(BinaryOp::Add, at.var(&cell), way.clone());
                let held = at.call("LIMIT", vec![at.real("0.0"), moved, length.clone()]);
                at.when(self.taken(at, k), vec![at.assign(&cell, held)])
            })
            .collect();
        vec![at.when(self.taken(at, 0), moves)]
    }
}
