//! Messages of Sparkplug B: the part of its protocol buffers that is used (Sparkplug 3.0, 6.4), and
//! values as metrics.

use g7_host::Kind;
use prost::Message as _;

use crate::value::{Holds, Raw, Scaling};

/// A message.
#[derive(Clone, PartialEq, prost::Message)]
pub(super) struct Payload {
    /// Milliseconds since 1970, UTC.
    #[prost(uint64, optional, tag = "1")]
    pub(super) timestamp: Option<u64>,
    #[prost(message, repeated, tag = "2")]
    pub(super) metrics: Vec<Metric>,
    #[prost(uint64, optional, tag = "3")]
    pub(super) seq: Option<u64>,
}

/// A metric of a message.
#[derive(Clone, PartialEq, prost::Message)]
pub(super) struct Metric {
    #[prost(string, optional, tag = "1")]
    pub(super) name: Option<String>,
    #[prost(uint64, optional, tag = "2")]
    pub(super) alias: Option<u64>,
    #[prost(uint64, optional, tag = "3")]
    pub(super) timestamp: Option<u64>,
    #[prost(uint32, optional, tag = "4")]
    pub(super) datatype: Option<u32>,
    #[prost(bool, optional, tag = "7")]
    pub(super) is_null: Option<bool>,
    #[prost(oneof = "Value", tags = "10, 11, 12, 13, 14")]
    pub(super) value: Option<Value>,
}

/// The value of a metric, as far as variables have such values.
#[derive(Clone, Copy, PartialEq, prost::Oneof)]
pub(super) enum Value {
    #[prost(uint32, tag = "10")]
    Int(u32),
    #[prost(uint64, tag = "11")]
    Long(u64),
    #[prost(float, tag = "12")]
    Float(f32),
    #[prost(double, tag = "13")]
    Double(f64),
    #[prost(bool, tag = "14")]
    Boolean(bool),
}

/// The type of a metric by its number (Sparkplug 3.0, 6.4.16).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Datatype {
    Whole { bits: u8, signed: bool },
    Float,
    Double,
    Boolean,
}

impl Datatype {
    pub(super) const LONG: Datatype = Datatype::Whole { bits: 64, signed: true };

    /// The type that carries a variable. Only those are used that all hosts read alike: Eclipse Tahu extends
    /// the sign of Int8 and Int16 to 32 bits, which pysparkplug refuses, and they keep a UInt32 in different
    /// fields.
    pub(super) fn of(scaling: &Scaling) -> Datatype {
        match (scaling.holds, scaling.kind) {
            (Holds::Bit, _) => Datatype::Boolean,
            (
                Holds::Whole { bits: 8 | 16, signed: true },
                Kind::Int { .. } | Kind::Time | Kind::Moment(_),
            ) => Datatype::Whole { bits: 32, signed: true },
            (Holds::Whole { bits: 32, signed: false }, Kind::Int { .. } | Kind::Time | Kind::Moment(_)) => {
                Datatype::LONG
            }
            (Holds::Whole { bits, signed }, Kind::Int { .. } | Kind::Time | Kind::Moment(_)) => {
                Datatype::Whole { bits, signed }
            }
            (Holds::Single, _) => Datatype::Float,
            (Holds::Double | Holds::Whole { .. }, _) => Datatype::Double,
        }
    }

    pub(super) fn number(self) -> u32 {
        match self {
            Datatype::Whole { bits, signed } => {
                let size = match bits {
                    8 => 1,
                    16 => 2,
                    32 => 3,
                    _ => 4,
                };
                if signed { size } else { size + 4 }
            }
            Datatype::Float => 9,
            Datatype::Double => 10,
            Datatype::Boolean => 11,
        }
    }

    /// A value of this type.
    pub(super) fn value(self, raw: Raw) -> Option<Value> {
        let real = |raw| match raw {
            Raw::Whole(n) => Some(n as f64),
            Raw::Real(x) => Some(x),
            Raw::Bit(_) => None,
        };
        match (self, raw) {
            (Datatype::Boolean, Raw::Bit(on)) => Some(Value::Boolean(on)),
            // Two's complement of 32 bits, as Eclipse Tahu has it: its library for Node does not extend the
            // sign of a shorter one.
            (Datatype::Whole { bits, .. }, Raw::Whole(n)) if bits < 64 => Some(Value::Int(n as u32)),
            (Datatype::Whole { .. }, Raw::Whole(n)) => Some(Value::Long(n as u64)),
            (Datatype::Float, raw) => real(raw).map(|x| Value::Float(x as f32)),
            (Datatype::Double, raw) => real(raw).map(Value::Double),
            (Datatype::Whole { .. } | Datatype::Boolean, _) => None,
        }
    }

    /// The value that a host writes.
    pub(super) fn raw(self, value: Value) -> Option<Raw> {
        match (self, value) {
            (Datatype::Boolean, Value::Boolean(on)) => Some(Raw::Bit(on)),
            (Datatype::Whole { bits, signed }, Value::Int(n)) => Some(Raw::Whole(match (bits, signed) {
                // Some hosts extend the sign beyond the type, some do not.
                (8, true) => i128::from(n as i8),
                (16, true) => i128::from(n as i16),
                (_, true) => i128::from(n as i32),
                (_, false) => i128::from(n),
            })),
            (Datatype::Whole { signed: true, .. }, Value::Long(n)) => Some(Raw::Whole(i128::from(n as i64))),
            (Datatype::Whole { signed: false, .. }, Value::Long(n)) => Some(Raw::Whole(i128::from(n))),
            (Datatype::Float | Datatype::Double, Value::Float(x)) => Some(Raw::Real(f64::from(x))),
            (Datatype::Float | Datatype::Double, Value::Double(x)) => Some(Raw::Real(x)),
            _ => None,
        }
    }
}

impl Payload {
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.encode_to_vec()
    }

    /// Reads a message; `None` for bytes that are none.
    pub(super) fn read(bytes: &[u8]) -> Option<Payload> {
        Payload::decode(bytes).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_specification() {
        let whole = |bits, signed| Datatype::Whole { bits, signed };
        let all = [
            (whole(8, true), 1),
            (whole(16, true), 2),
            (whole(32, true), 3),
            (whole(64, true), 4),
            (whole(8, false), 5),
            (whole(16, false), 6),
            (whole(32, false), 7),
            (whole(64, false), 8),
            (Datatype::Float, 9),
            (Datatype::Double, 10),
            (Datatype::Boolean, 11),
        ];
        for (datatype, number) in all {
            assert_eq!(datatype.number(), number, "{datatype:?}");
        }
    }

    #[test]
    fn values_go_both_ways() {
        for (bits, signed, n, value) in [
            (8, true, -1, Value::Int(0xffff_ffff)),
            (16, true, -2, Value::Int(0xffff_fffe)),
            (32, true, -3, Value::Int(0xffff_fffd)),
            (64, true, -4, Value::Long(u64::MAX - 3)),
            (8, false, 255, Value::Int(255)),
            (32, false, 0xffff_ffff, Value::Int(u32::MAX)),
            (64, false, u64::MAX.into(), Value::Long(u64::MAX)),
        ] {
            let datatype = Datatype::Whole { bits, signed };
            assert_eq!(datatype.value(Raw::Whole(n)), Some(value), "{datatype:?}");
            assert_eq!(datatype.raw(value), Some(Raw::Whole(n)), "{datatype:?}");
        }
        assert_eq!(Datatype::Whole { bits: 8, signed: true }.raw(Value::Int(0xff)), Some(Raw::Whole(-1)));
        assert_eq!(Datatype::Boolean.raw(Value::Int(1)), None);
        assert_eq!(Datatype::Double.raw(Value::Boolean(true)), None);
    }

    #[test]
    fn no_bytes_make_it_panic() {
        let metric =
            Metric { name: Some("a".to_owned()), value: Some(Value::Double(1.5)), ..Metric::default() };
        let whole = Payload { timestamp: Some(1), metrics: vec![metric], seq: Some(2) }.bytes();
        assert!(Payload::read(&whole).is_some());
        for end in 0..whole.len() {
            for byte in 0..=255 {
                Payload::read(&[&whole[..end], &[byte], &whole[end..]].concat());
            }
        }
    }
}
