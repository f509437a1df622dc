//! Values of OPC UA as values of devices, and back.

use g7_host::Kind;
use g7_model::Moment;
use g7_online::{Holds, Raw, Scaling};
use opcua::types::{DataTypeId, Variant, VariantScalarTypeId as Type};

/// The value of a variant for a variable.
///
/// # Errors
///
/// A sentence with both types: the variable cannot have it.
pub(crate) fn raw(variant: &Variant, kind: Kind) -> Result<Raw, String> {
    let raw = match variant {
        Variant::Boolean(on) => Some(Raw::Bit(*on)),
        Variant::SByte(n) => Some(Raw::Whole((*n).into())),
        Variant::Byte(n) => Some(Raw::Whole((*n).into())),
        Variant::Int16(n) => Some(Raw::Whole((*n).into())),
        Variant::UInt16(n) => Some(Raw::Whole((*n).into())),
        Variant::Int32(n) => Some(Raw::Whole((*n).into())),
        Variant::UInt32(n) => Some(Raw::Whole((*n).into())),
        Variant::Int64(n) => Some(Raw::Whole((*n).into())),
        Variant::UInt64(n) => Some(Raw::Whole((*n).into())),
        Variant::Float(x) => Some(Raw::Real((*x).into())),
        Variant::Double(x) => Some(Raw::Real(*x)),
        _ => None,
    };
    let fits = |raw: &Raw| matches!(raw, Raw::Bit(_)) == (kind == Kind::Bool);
    raw.filter(fits)
        .ok_or_else(|| format!("the node holds {}, and the variable is {}", type_of(variant), name(kind)))
}

/// The type of a variant, for messages.
pub(crate) fn type_of(variant: &Variant) -> String {
    match (variant, variant.scalar_type_id()) {
        (Variant::Empty, _) => "no value".to_owned(),
        (Variant::Array(array), _) => format!("an array of {:?}", array.value_type),
        (_, Some(of)) => format!("a value of the type {of:?}"),
        (_, None) => "a value without a type".to_owned(),
    }
}

/// The type of a variable, for messages.
pub(crate) fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Bool => "a BOOL",
        Kind::Int { bits: 8, signed: true } => "a SINT",
        Kind::Int { bits: 8, signed: false } => "a USINT",
        Kind::Int { bits: 16, signed: true } => "an INT",
        Kind::Int { bits: 16, signed: false } => "a UINT",
        Kind::Int { bits: 32, signed: true } => "a DINT",
        Kind::Int { bits: 32, signed: false } => "a UDINT",
        Kind::Int { signed: true, .. } => "an LINT",
        Kind::Int { signed: false, .. } => "a ULINT",
        Kind::Real => "a REAL",
        Kind::Lreal => "an LREAL",
        Kind::Time => "a TIME",
        Kind::Moment(Moment::Date) => "a DATE",
        Kind::Moment(Moment::Tod) => "a TOD",
        Kind::Moment(Moment::Dt) => "a DT",
        Kind::Text => "a STRING",
    }
}

/// The value of a variable for a node of a type.
///
/// # Errors
///
/// A sentence with both types, or with the value: the node cannot hold it.
pub(crate) fn variant(raw: Raw, of: Type, kind: Kind) -> Result<Variant, String> {
    let types = || format!("the node is of the type {of:?}, and the variable is {}", name(kind));
    let made = match (of, raw) {
        (Type::Boolean, Raw::Bit(on)) => return Ok(Variant::Boolean(on)),
        (Type::Float, Raw::Whole(n)) => return Ok(Variant::Float(n as f32)),
        (Type::Double, Raw::Whole(n)) => return Ok(Variant::Double(n as f64)),
        (Type::Float, Raw::Real(x)) => return Ok(Variant::Float(x as f32)),
        (Type::Double, Raw::Real(x)) => return Ok(Variant::Double(x)),
        (Type::SByte, Raw::Whole(n)) => n.try_into().ok().map(Variant::SByte),
        (Type::Byte, Raw::Whole(n)) => n.try_into().ok().map(Variant::Byte),
        (Type::Int16, Raw::Whole(n)) => n.try_into().ok().map(Variant::Int16),
        (Type::UInt16, Raw::Whole(n)) => n.try_into().ok().map(Variant::UInt16),
        (Type::Int32, Raw::Whole(n)) => n.try_into().ok().map(Variant::Int32),
        (Type::UInt32, Raw::Whole(n)) => n.try_into().ok().map(Variant::UInt32),
        (Type::Int64, Raw::Whole(n)) => n.try_into().ok().map(Variant::Int64),
        (Type::UInt64, Raw::Whole(n)) => n.try_into().ok().map(Variant::UInt64),
        _ => return Err(types()),
    };
    made.ok_or_else(|| match raw {
        Raw::Whole(n) => format!("{n} is no value of the type {of:?}"),
        Raw::Bit(_) | Raw::Real(_) => types(),
    })
}

/// The type of the nodes of our own that hold such values, and the type of their variants. A TIME is a
/// Duration: milliseconds as a Double (OPC 10000-3, 8.13).
pub(crate) fn own(scaling: &Scaling) -> (DataTypeId, Type) {
    if scaling.kind == Kind::Time && scaling.holds == (Holds::Whole { bits: 64, signed: true }) {
        return (DataTypeId::Duration, Type::Double);
    }
    match scaling.holds {
        Holds::Bit => (DataTypeId::Boolean, Type::Boolean),
        Holds::Single => (DataTypeId::Float, Type::Float),
        Holds::Double => (DataTypeId::Double, Type::Double),
        Holds::Whole { bits: ..=8, signed: true } => (DataTypeId::SByte, Type::SByte),
        Holds::Whole { bits: ..=8, signed: false } => (DataTypeId::Byte, Type::Byte),
        Holds::Whole { bits: ..=16, signed: true } => (DataTypeId::Int16, Type::Int16),
        Holds::Whole { bits: ..=16, signed: false } => (DataTypeId::UInt16, Type::UInt16),
        Holds::Whole { bits: ..=32, signed: true } => (DataTypeId::Int32, Type::Int32),
        Holds::Whole { bits: ..=32, signed: false } => (DataTypeId::UInt32, Type::UInt32),
        Holds::Whole { signed: true, .. } => (DataTypeId::Int64, Type::Int64),
        Holds::Whole { signed: false, .. } => (DataTypeId::UInt64, Type::UInt64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INT: Kind = Kind::Int { bits: 16, signed: true };

    #[test]
    fn a_type_that_does_not_fit_is_refused_with_both() {
        assert_eq!(raw(&Variant::Int32(-3), INT), Ok(Raw::Whole(-3)));
        assert_eq!(raw(&Variant::Float(1.5), Kind::Lreal), Ok(Raw::Real(1.5)));
        assert_eq!(raw(&Variant::Boolean(true), Kind::Bool), Ok(Raw::Bit(true)));
        for (value, kind, both) in [
            (Variant::Boolean(true), INT, ["Boolean", "INT"]),
            (Variant::Byte(1), Kind::Bool, ["Byte", "BOOL"]),
            (Variant::String("1".into()), Kind::Real, ["String", "REAL"]),
            (Variant::Empty, INT, ["no value", "INT"]),
            (Variant::from(vec![1i32, 2]), INT, ["array of Int32", "INT"]),
        ] {
            let why = raw(&value, kind).expect_err("it does not fit");
            assert!(both.iter().all(|part| why.contains(part)), "{why}");
        }
        for (value, of, kind, both) in [
            (Raw::Bit(true), Type::Int16, Kind::Bool, ["Int16", "BOOL"]),
            (Raw::Real(1.0), Type::Int16, Kind::Real, ["Int16", "REAL"]),
            (Raw::Whole(1), Type::Boolean, INT, ["Boolean", "INT"]),
            (Raw::Whole(1), Type::String, INT, ["String", "INT"]),
            (Raw::Whole(300), Type::Byte, INT, ["300", "Byte"]),
            (Raw::Whole(-1), Type::UInt64, INT, ["-1", "UInt64"]),
        ] {
            let why = variant(value, of, kind).expect_err("it does not fit");
            assert!(both.iter().all(|part| why.contains(part)), "{why}");
        }
        assert_eq!(variant(Raw::Whole(255), Type::Byte, INT), Ok(Variant::Byte(255)));
        assert_eq!(variant(Raw::Whole(2), Type::Float, INT), Ok(Variant::Float(2.0)));
    }
}
