//! The forms of numbers outside the program.

use g7_host::Kind;

use crate::setup::Encoding;
use crate::value::Holds;

/// The numbers that a form can hold.
pub(crate) fn holds(encoding: Encoding) -> Holds {
    match encoding {
        Encoding::Unsigned(n) => Holds::Whole { bits: n * 16, signed: false },
        Encoding::Signed(n) => Holds::Whole { bits: n * 16, signed: true },
        Encoding::F32 => Holds::Single,
        Encoding::F64 => Holds::Double,
    }
}

/// How registers hold a variable where the file does not say it.
pub(crate) fn usual(kind: Kind) -> Encoding {
    match kind {
        Kind::Int { bits, signed } => {
            let registers = bits.div_ceil(16);
            if signed { Encoding::Signed(registers) } else { Encoding::Unsigned(registers) }
        }
        Kind::Real => Encoding::F32,
        Kind::Lreal => Encoding::F64,
        Kind::Time | Kind::Moment(_) | Kind::Bool | Kind::Text => Encoding::Signed(2),
    }
}
