//! Arrays: an element is the variable whose name has the indexes behind it, as in `a[1,2]`.

use g7_model::{Expr, ExprKind, Name, Path, VarDecl};

use super::exec::Exec;
use super::model::{FILE, Model, ScopeId};
use super::resolve::Ref;
use super::value::{NaiveFault, Run, bad};

/// The path of the element with these indexes: each `[]` takes those that it has room for, the last name the rest.
pub(super) fn element(path: &Path, indexes: &[i128]) -> Path {
    let mut rest: Vec<String> = indexes.iter().map(i128::to_string).collect();
    let mut names = path.names.clone();
    let last = names.len().saturating_sub(1);
    for (k, name) in names.iter_mut().enumerate() {
        let slot = name.text.rsplit_once('[').filter(|_| k < last);
        let taken = match slot {
            Some((_, commas)) if commas.strip_suffix(']').is_some_and(|c| c.bytes().all(|b| b == b',')) => {
                commas.len()
            }
            None if k == last => rest.len(),
            _ => 0,
        };
        let bare = slot.filter(|_| taken > 0).map_or(&*name.text, |(bare, _)| bare);
        let own: Vec<String> = rest.drain(..taken.min(rest.len())).collect();
        if !own.is_empty() {
            *name = Name::new(format!("{bare}[{}]", own.join(",")), name.at.0);
        }
    }
    Path { names }
}

/// Each place of a list of values, with its value.
fn values(init: Option<&Expr>) -> Vec<Expr> {
    match init.map(|e| &e.kind) {
        Some(ExprKind::List(list)) => {
            list.iter().flat_map(|(n, e)| std::iter::repeat_n(e.clone(), *n as usize)).collect()
        }
        _ => Vec::new(),
    }
}

impl Model {
    /// The variables that a declaration stands for: one for each element, or the one itself.
    pub(super) fn singles(&self, scope: ScopeId, v: &VarDecl) -> Vec<VarDecl> {
        let Some(array) = &v.array else { return vec![v.clone()] };
        let mut all: Vec<Vec<i128>> = vec![Vec::new()];
        for (least, most) in &array.dimensions {
            let (least, most) = (self.bound(scope, least), self.bound(scope, most));
            all =
                all.iter().flat_map(|before| (least..=most).map(|n| [&before[..], &[n]].concat())).collect();
        }
        let given = values(v.init.as_ref());
        let single = |(place, indexes): (usize, &Vec<i128>)| VarDecl {
            names: v
                .names
                .iter()
                .flat_map(|n| element(&Path { names: vec![n.clone()] }, indexes).names)
                .collect(),
            array: None,
            init: given.get(place).cloned().or_else(|| v.usual.as_deref().cloned()),
            ..v.clone()
        };
        all.iter().enumerate().map(single).collect()
    }

    /// A number, or that of a constant that is seen from a scope.
    pub(super) fn bound(&self, scope: ScopeId, e: &Expr) -> i128 {
        let constant = |path: &Path| {
            let v = self.variable_named(scope, &path.text())?;
            self.vars[v].init.as_ref()?.kind.whole()
        };
        match &e.kind {
            ExprKind::Path(path) => constant(path),
            kind => kind.whole(),
        }
        .expect("a bound")
    }

    /// The elements of an array, without the name before the indexes.
    pub(super) fn array(&self, scope: ScopeId, path: &Path) -> Option<&[String]> {
        let own = |s: ScopeId, name: &str| self.scopes[s].arrays.get(name).map(Vec::as_slice);
        match &path.names[..] {
            [name] => own(scope, &name.text).or_else(|| own(FILE, &name.text)),
            [chart, name] => own(self.chart_named(scope, &chart.text)?, &name.text),
            _ => None,
        }
    }
}

impl Exec<'_> {
    pub(super) fn indexes(&mut self, scope: ScopeId, index: &[Expr]) -> Run<Vec<i128>> {
        index.iter().map(|e| self.eval(scope, e)?.whole()).collect()
    }

    /// An element, or a bit of one.
    pub(super) fn element(
        &mut self,
        scope: ScopeId,
        path: &Path,
        indexes: &[i128],
        bit: Option<&Name>,
    ) -> Run<Ref> {
        let mut path = element(&self.numbered(scope, path)?, indexes);
        path.names.extend(bit.cloned());
        self.resolve(scope, &path).ok_or(NaiveFault::Index)
    }

    /// `a := b` of whole arrays.
    pub(super) fn copied(&mut self, scope: ScopeId, to: &Expr, from: &Expr) -> Option<Run<()>> {
        let (ExprKind::Path(to), ExprKind::Path(from)) = (&to.kind, &from.kind) else { return None };
        if self.is_own(to) {
            return None; // An array of the file can have the same name.
        }
        let elements = self.m.array(scope, to)?.to_vec();
        let single = |path: &Path, indexes: &str| {
            let mut names = path.names.clone();
            if let Some(last) = names.last_mut() {
                *last = Name::new(format!("{}{indexes}", last.text), last.at.0);
            }
            ExprKind::Path(Path { names })
        };
        for indexes in &elements {
            let at = to.names.first().map(|n| n.at)?;
            let value = match self.eval(scope, &Expr { kind: single(from, indexes), at }) {
                Ok(value) => value,
                Err(fault) => return Some(Err(fault)),
            };
            if let Err(fault) = self.assign(scope, &Expr { kind: single(to, indexes), at }, &value) {
                return Some(Err(fault));
            }
        }
        Some(Ok(()))
    }

    /// The element that an action drives; its indexes are written numbers or constants.
    pub(super) fn known_element(m: &Model, scope: ScopeId, e: &Expr) -> Run<Ref> {
        let ExprKind::Element(path, index, None) = &e.kind else { return bad("no element") };
        let indexes: Vec<i128> = index.iter().map(|e| m.bound(scope, e)).collect();
        m.resolve(scope, &element(path, &indexes)).ok_or(NaiveFault::Index)
    }
}
