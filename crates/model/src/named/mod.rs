//! Replaces declared types by plain ones, and checks what is compared with and assigned to variables of such types.
//!
//! ```text
//! syntax -> Document -> declared -> instances -> composed -> held -> compile, the writers of exchange
//! ```
//!
//! [`declared`] changes declarations: a variable of `type Percent : INT(0..100)` becomes an INT with
//! [`Limits`], and so do parameters, local variables and results ([`ValueType`]). [`held`] changes statements and expressions. It runs after the members of structures have
//! become variables. It replaces a value of an enumeration by its number, and `p := e` by `p := INT_within_0_100(e)` if
//! `p` has bounds. All that follows knows whole numbers and functions only.
//!
//! # What must hold
//!
//! - A document without such types is not copied.
//! - In the result of [`declared`], [`VarDecl::of`] names structures and function blocks only, [`ValueType::of`] is
//!   absent, and each [`Item::Type`](crate::Item::Type) is an enumeration.
//! - No variable with bounds ever holds a value outside of them. A value of an enumeration has no operation but `=` and `<>`.

mod checks;
mod concerned;
mod declare;
mod held;
mod scopes;
mod values;
mod walk;

pub use declare::{MOST as MOST_VALUES, declared, numbered};
pub use held::{Checker, held};

use crate::{Expr, Limits, Name, Place, ValueType, VarDecl, VarKind};

impl VarDecl {
    /// Variables with the type of a parameter, of a local variable or of a result.
    pub fn of_type(kind: VarKind, names: Vec<Name>, ty: &ValueType, at: Place) -> VarDecl {
        let ValueType { base, of, limits } = ty.clone();
        VarDecl { of, limits, ..VarDecl::new(kind, names, base, at) }
    }

    /// The type of these variables as that of one value.
    pub fn value_type(&self) -> ValueType {
        ValueType { base: self.ty, of: self.of.clone(), limits: self.limits.clone() }
    }

    /// See [`Limits::values`].
    pub fn values(&self) -> &[(Name, Option<Expr>)] {
        self.limits.as_deref().map_or(&[], Limits::values)
    }

    /// The names that a `type` declares: its own, and those of the values of an enumeration.
    pub fn type_names(&self) -> impl Iterator<Item = &Name> {
        self.names.iter().chain(self.values().iter().map(|(value, _)| value))
    }

    /// See [`Limits::range`].
    pub fn range(&self) -> Option<(i128, i128)> {
        self.limits.as_deref().and_then(Limits::range)
    }
}
