//! Enumerations and bounds, as declarations write them; [`crate::named`] works with them.

use crate::{Expr, Name};

/// The values that variables of a whole-number type can have, if these are not all of the type (IEC 61131-3:2003, 2.3.3.1).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Limits {
    /// A subrange such as `INT(0..100)`: the least and the greatest value.
    Range(Expr, Expr),
    /// The values of an enumeration, as in `(Manual, Automatic := 5)`, and the numbers that are written behind them. It
    /// stands only in the declaration of the type.
    Values(Vec<(Name, Option<Expr>)>),
    /// The values of the enumeration with this name. The pass [`crate::named`] makes it; the parser never does.
    Of(Name),
}

impl Limits {
    /// The values that the declaration of an enumeration lists; else nothing.
    pub fn values(&self) -> &[(Name, Option<Expr>)] {
        match self {
            Limits::Values(values) => values,
            Limits::Range(..) | Limits::Of(_) => &[],
        }
    }

    /// The least and the greatest value of bounds, where both are written numbers.
    pub fn range(&self) -> Option<(i128, i128)> {
        match self {
            Limits::Range(least, most) => least.kind.whole().zip(most.kind.whole()),
            Limits::Values(_) | Limits::Of(_) => None,
        }
    }
}
