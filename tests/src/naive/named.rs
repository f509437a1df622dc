//! Types with a name. A value of an enumeration is looked up where it is read; bounds are held where a variable is
//! written.

use std::collections::BTreeMap;

use g7_model::{Array, Document, Expr, ExprKind, Item, Limits, Literal, VarDecl};

use super::model::{Model, ScopeId};
use super::resolve::Ref;
use super::value::{NaiveFault, Run, Typed, Value};

/// The types of a file that are no structures and function blocks.
pub(super) fn named(doc: &Document) -> BTreeMap<String, VarDecl> {
    let one =
        |i: &Item| if let Item::Type(t) = i { Some((t.names[0].text.to_string(), t.clone())) } else { None };
    doc.items.iter().filter_map(one).collect()
}

/// The numbers of the values of an enumeration: as written, or one more than the value before.
fn numbers(t: &VarDecl) -> Vec<(String, i128)> {
    let mut next = 0;
    let mut all = Vec::new();
    for (name, written) in t.values() {
        let number = written.as_ref().and_then(|e| e.kind.whole()).unwrap_or(next);
        all.push((name.text.to_string(), number));
        next = number + 1;
    }
    all
}

impl Model {
    /// The declaration with the type, the bounds and the values that its named type declares, in the place of the name.
    pub(super) fn with_type(&self, v: &VarDecl) -> VarDecl {
        let mut own = v.clone();
        while let Some(t) = own.of.as_ref().and_then(|of| self.named.get(&*of.text)) {
            let (inner, many) = (t.clone(), own.array.is_some());
            own.ty = inner.ty;
            own.of = inner.of;
            own.limits = inner.limits.or(own.limits);
            if let Some(array) = inner.array {
                let before = own.array.take().map_or(Vec::new(), |a| a.dimensions);
                own.array =
                    Some(Box::new(Array { dimensions: [before, array.dimensions].concat(), at: array.at }));
            }
            if many {
                own.usual = own.usual.or(inner.init.map(Box::new));
            } else {
                own.init = own.init.or(inner.init);
            }
        }
        let first = match own.limits.as_deref() {
            Some(Limits::Range(least, _)) => Some(least.clone()),
            Some(Limits::Values(_)) => numbers(&own)
                .first()
                .map(|(_, n)| Expr { kind: ExprKind::Literal(Literal::Int(*n, None)), at: own.at }),
            _ => None,
        };
        match own.array {
            Some(_) => own.usual = own.usual.or(first.map(Box::new)),
            None => own.init = own.init.or(first),
        }
        own
    }

    /// The bounds of a declaration.
    pub(super) fn range(&self, scope: ScopeId, v: &VarDecl) -> Option<(i128, i128)> {
        match v.limits.as_deref() {
            Some(Limits::Range(least, most)) => Some((self.bound(scope, least), self.bound(scope, most))),
            _ => None,
        }
    }

    /// The number of `Automatic` or `Mode.Automatic`.
    pub(super) fn value_named(&self, names: &[&str]) -> Option<Ref> {
        let (ty, value) = match *names {
            [value] => (None, value),
            [ty, value] => (Some(ty), value),
            _ => return None,
        };
        let mut of = self.named.iter().filter(|(name, _)| ty.is_none_or(|ty| **name == *ty));
        of.find_map(|(_, t)| numbers(t).into_iter().find(|(name, _)| name == value))
            .map(|(_, n)| Ref::Value(n))
    }
}

/// The value of `Mode_TO_INT(mode)`, if this is such a call.
pub(super) fn number_of(m: &Model, name: &str, args: &[Typed]) -> Option<Typed> {
    let ty = name.strip_suffix("_TO_INT")?;
    m.named.contains_key(ty).then(|| args[0].clone())
}

/// A value for a variable with bounds.
pub(super) fn held(range: Option<(i128, i128)>, value: Value) -> Run<Value> {
    match (range, &value) {
        (Some((least, most)), Value::Int(n)) if !(least..=most).contains(n) => Err(NaiveFault::Index),
        _ => Ok(value),
    }
}
