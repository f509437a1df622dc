//! Parameters, and the types of all that holds one value. [`crate::named`] puts the types of the file in the places of their
//! names, for these as for variables.

use crate::{Limits, Name, Type};

/// A parameter of a function or chart, or an attribute of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: ValueType,
}

/// The type of a parameter, of a local variable or of the result of a function: each holds one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValueType {
    /// The type of the language; BOOL where `of` names the type.
    pub base: Type,
    /// The name of a type that the file declares. The pass [`crate::named`] puts that type in its place.
    pub of: Option<Box<Name>>,
    /// The values that it can have, if these are not all values of `base`.
    pub limits: Option<Box<Limits>>,
}

impl ValueType {
    /// True for a type of the language with all of its values.
    pub fn is_plain(&self) -> bool {
        self.of.is_none() && self.limits.is_none()
    }

    /// See [`Limits::range`].
    pub fn range(&self) -> Option<(i128, i128)> {
        self.limits.as_deref().and_then(Limits::range)
    }
}

impl From<Type> for ValueType {
    fn from(base: Type) -> ValueType {
        ValueType { base, of: None, limits: None }
    }
}
