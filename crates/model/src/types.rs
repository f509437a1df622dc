//! The table of types: the name of each, its width, and what it holds.

use crate::Moment;

/// A type of IEC 61131-3 that a variable can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    /// `FALSE` or `TRUE`.
    Bool,
    /// 8 bits, signed.
    Sint,
    /// 16 bits, signed.
    Int,
    /// 32 bits, signed.
    Dint,
    /// 64 bits, signed.
    Lint,
    /// 8 bits, unsigned.
    Usint,
    /// 16 bits, unsigned.
    Uint,
    /// 32 bits, unsigned.
    Udint,
    /// 64 bits, unsigned.
    Ulint,
    /// A string of 8 bits.
    Byte,
    /// A string of 16 bits.
    Word,
    /// A string of 32 bits.
    Dword,
    /// A string of 64 bits.
    Lword,
    /// IEEE 754, 32 bits.
    Real,
    /// IEEE 754, 64 bits.
    Lreal,
    /// A duration in signed 64-bit nanoseconds.
    Time,
    /// DATE, TOD or DT, in signed 64-bit nanoseconds.
    Moment(Moment),
    /// UTF-8 text of at most this many bytes.
    String(u16),
    /// An instance of a standard function block.
    Fb(FbKind),
}

/// The standard function blocks (IEC 61131-3:2003, 2.5.2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FbKind {
    /// Up-counter: inputs CU, R (RESET), PV; outputs Q, CV.
    Ctu,
    /// Down-counter: CD, LD (LOAD), PV; Q, CV.
    Ctd,
    /// Up-down counter: CU, CD, R, LD, PV; QU, QD, CV.
    Ctud,
    /// On-delay timer: IN, PT; Q, ET.
    Ton,
    /// Off-delay timer: IN, PT; Q, ET.
    Tof,
    /// Pulse timer: IN, PT; Q, ET.
    Tp,
    /// Rising edge: CLK; Q.
    RTrig,
    /// Falling edge: CLK; Q.
    FTrig,
    /// Bistable, set dominant: S1, R; Q1.
    Sr,
    /// Bistable, reset dominant: S, R1; Q1.
    Rs,
}

impl FbKind {
    /// Every kind, in the order of the standard's names.
    pub const ALL: [FbKind; 10] = [
        FbKind::Ctu,
        FbKind::Ctd,
        FbKind::Ctud,
        FbKind::Ton,
        FbKind::Tof,
        FbKind::Tp,
        FbKind::RTrig,
        FbKind::FTrig,
        FbKind::Sr,
        FbKind::Rs,
    ];

    /// The name as the standard has it.
    pub const fn name(self) -> &'static str {
        match self {
            FbKind::Ctu => "CTU",
            FbKind::Ctd => "CTD",
            FbKind::Ctud => "CTUD",
            FbKind::Ton => "TON",
            FbKind::Tof => "TOF",
            FbKind::Tp => "TP",
            FbKind::RTrig => "R_TRIG",
            FbKind::FTrig => "F_TRIG",
            FbKind::Sr => "SR",
            FbKind::Rs => "RS",
        }
    }

    /// The type of a member, whose name is in any case.
    pub fn type_of(self, member: &str) -> Option<Type> {
        self.members().iter().find(|m| m.0.eq_ignore_ascii_case(member)).map(|m| m.1)
    }

    /// The members in call order: inputs first, then outputs; name, type, whether an input.
    pub fn members(self) -> &'static [(&'static str, Type, bool)] {
        use Type::{Bool, Int, Time};
        match self {
            FbKind::Ctu => &[
                ("CU", Bool, true),
                ("R", Bool, true),
                ("PV", Int, true),
                ("Q", Bool, false),
                ("CV", Int, false),
            ],
            FbKind::Ctd => &[
                ("CD", Bool, true),
                ("LD", Bool, true),
                ("PV", Int, true),
                ("Q", Bool, false),
                ("CV", Int, false),
            ],
            FbKind::Ctud => &[
                ("CU", Bool, true),
                ("CD", Bool, true),
                ("R", Bool, true),
                ("LD", Bool, true),
                ("PV", Int, true),
                ("QU", Bool, false),
                ("QD", Bool, false),
                ("CV", Int, false),
            ],
            FbKind::Ton | FbKind::Tof | FbKind::Tp => {
                &[("IN", Bool, true), ("PT", Time, true), ("Q", Bool, false), ("ET", Time, false)]
            }
            FbKind::RTrig | FbKind::FTrig => &[("CLK", Bool, true), ("Q", Bool, false)],
            FbKind::Sr => &[("S1", Bool, true), ("R", Bool, true), ("Q1", Bool, false)],
            FbKind::Rs => &[("S", Bool, true), ("R1", Bool, true), ("Q1", Bool, false)],
        }
    }
}

/// The kind of values of an elementary type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Holds {
    /// FALSE and TRUE.
    Truth,
    /// Whole numbers with a sign.
    Signed,
    /// Whole numbers from 0.
    Unsigned,
    /// A string of bits.
    Bits,
    /// Floating-point numbers.
    Real,
    /// A duration.
    Time,
    /// A date, a time of day, or a date with a time.
    Moment(Moment),
    /// Text.
    Text,
}

/// A row of the table of elementary types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elementary {
    /// The name as the standard has it.
    pub name: &'static str,
    /// Bits of a value; of a text, those of one character.
    pub bits: u8,
    /// The kind of its values.
    pub holds: Holds,
}

impl Type {
    /// STRING without a length has room for this many bytes.
    pub const STRING: Type = Type::String(80);

    /// The elementary types (IEC 61131-3:2003, table 10), STRING with its usual length.
    pub const ELEMENTARY: [Type; 20] = [
        Type::Bool,
        Type::Sint,
        Type::Int,
        Type::Dint,
        Type::Lint,
        Type::Usint,
        Type::Uint,
        Type::Udint,
        Type::Ulint,
        Type::Byte,
        Type::Word,
        Type::Dword,
        Type::Lword,
        Type::Real,
        Type::Lreal,
        Type::Time,
        Type::Moment(Moment::Date),
        Type::Moment(Moment::Tod),
        Type::Moment(Moment::Dt),
        Type::STRING,
    ];

    /// The row of an elementary type; a function block has none.
    pub const fn elementary(self) -> Option<Elementary> {
        let (name, bits, holds) = match self {
            Type::Bool => ("BOOL", 1, Holds::Truth),
            Type::Sint => ("SINT", 8, Holds::Signed),
            Type::Int => ("INT", 16, Holds::Signed),
            Type::Dint => ("DINT", 32, Holds::Signed),
            Type::Lint => ("LINT", 64, Holds::Signed),
            Type::Usint => ("USINT", 8, Holds::Unsigned),
            Type::Uint => ("UINT", 16, Holds::Unsigned),
            Type::Udint => ("UDINT", 32, Holds::Unsigned),
            Type::Ulint => ("ULINT", 64, Holds::Unsigned),
            Type::Byte => ("BYTE", 8, Holds::Bits),
            Type::Word => ("WORD", 16, Holds::Bits),
            Type::Dword => ("DWORD", 32, Holds::Bits),
            Type::Lword => ("LWORD", 64, Holds::Bits),
            Type::Real => ("REAL", 32, Holds::Real),
            Type::Lreal => ("LREAL", 64, Holds::Real),
            Type::Time => ("TIME", 64, Holds::Time),
            Type::Moment(moment) => (moment.name(), 64, Holds::Moment(moment)),
            Type::String(_) => ("STRING", 8, Holds::Text),
            Type::Fb(_) => return None,
        };
        Some(Elementary { name, bits, holds })
    }

    /// The bit string with as many bits as an integer type.
    pub const fn bit_string(self) -> Option<Type> {
        match self {
            Type::Usint | Type::Sint => Some(Type::Byte),
            Type::Uint | Type::Int => Some(Type::Word),
            Type::Udint | Type::Dint => Some(Type::Dword),
            Type::Ulint | Type::Lint => Some(Type::Lword),
            _ => None,
        }
    }

    /// The unsigned integer type with as many bits as this bit string: UINT for WORD.
    pub const fn unsigned(self) -> Option<Type> {
        match self {
            Type::Byte => Some(Type::Usint),
            Type::Word => Some(Type::Uint),
            Type::Dword => Some(Type::Udint),
            Type::Lword => Some(Type::Ulint),
            _ => None,
        }
    }

    /// True for BYTE, WORD, DWORD and LWORD.
    pub const fn is_bits(self) -> bool {
        matches!(self.holds(), Some(Holds::Bits))
    }

    /// The name of the type, without the length of a text.
    pub const fn name(self) -> &'static str {
        match (self, self.elementary()) {
            (Type::Fb(kind), _) => kind.name(),
            (_, Some(row)) => row.name,
            (_, None) => "",
        }
    }

    /// All names: elementary types, then function blocks.
    pub fn names() -> impl Iterator<Item = &'static str> {
        let blocks = FbKind::ALL.into_iter().map(FbKind::name);
        Type::ELEMENTARY.into_iter().map(Type::name).chain(blocks)
    }

    /// Other names of types: the long names of IEC 61131-3:2003, and the names of IEC 61131-3:2013 for types of 64 bits. The
    /// types with the short names have 64 bits here (decision 65).
    pub const OTHER_NAMES: [(&'static str, Type); 8] = [
        ("LTIME", Type::Time),
        ("LDATE", Type::Moment(Moment::Date)),
        ("TIME_OF_DAY", Type::Moment(Moment::Tod)),
        ("LTOD", Type::Moment(Moment::Tod)),
        ("LTIME_OF_DAY", Type::Moment(Moment::Tod)),
        ("DATE_AND_TIME", Type::Moment(Moment::Dt)),
        ("LDT", Type::Moment(Moment::Dt)),
        ("LDATE_AND_TIME", Type::Moment(Moment::Dt)),
    ];

    /// The type of this name in capitals, elementary or a function block.
    pub fn named(name: &str) -> Option<Type> {
        let elementary = Type::ELEMENTARY.into_iter().find(|ty| ty.name() == name);
        let other = || Type::OTHER_NAMES.into_iter().find(|(n, _)| *n == name).map(|(_, ty)| ty);
        let block = || FbKind::ALL.into_iter().find(|k| k.name() == name).map(Type::Fb);
        elementary.or_else(other).or_else(block)
    }

    /// The type that a value has in a run: a date and a time of day are durations there (decision 65).
    pub const fn stored(self) -> Type {
        match self {
            Type::Moment(_) => Type::Time,
            other => other,
        }
    }

    /// True for DATE, TOD and DT.
    pub const fn is_moment(self) -> bool {
        matches!(self, Type::Moment(_))
    }

    /// The kind of its values, for an elementary type.
    pub const fn holds(self) -> Option<Holds> {
        match self.elementary() {
            Some(row) => Some(row.holds),
            None => None,
        }
    }

    /// True if values are whole numbers.
    pub const fn is_integer(self) -> bool {
        matches!(self.holds(), Some(Holds::Signed | Holds::Unsigned))
    }

    /// Smallest and largest value of an integer type. A bit string counts as the unsigned integer of its bits.
    pub const fn bounds(self) -> Option<(i128, i128)> {
        match self.elementary() {
            Some(Elementary { bits, holds: Holds::Signed, .. }) => {
                let half = 1 << (bits - 1);
                Some((-half, half - 1))
            }
            Some(Elementary { bits, holds: Holds::Unsigned | Holds::Bits, .. }) => Some((0, (1 << bits) - 1)),
            _ => None,
        }
    }

    /// True if values are floating-point numbers.
    pub const fn is_real(self) -> bool {
        matches!(self.holds(), Some(Holds::Real))
    }

    /// True if values are numbers, whole or real.
    pub const fn is_number(self) -> bool {
        self.is_integer() || self.is_real()
    }
}

impl std::fmt::Display for Type {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Type::String(n) if *self != Type::STRING => write!(f, "{}({n})", self.name()),
            _ => f.write_str(self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{FbKind, Type};

    #[test]
    fn every_type_is_found_by_its_name() {
        for ty in Type::ELEMENTARY.into_iter().chain(FbKind::ALL.map(Type::Fb)) {
            assert_eq!(Type::named(ty.name()), Some(ty));
        }
        assert_eq!(Type::named("Int"), None);
        assert_eq!(Type::names().count(), 30);
        for (name, ty) in Type::OTHER_NAMES {
            assert_eq!((Type::named(name), ty.elementary().map(|row| row.bits)), (Some(ty), Some(64)));
        }
        assert_eq!(
            (Type::STRING.to_string(), Type::String(9).to_string()),
            ("STRING".into(), "STRING(9)".into())
        );
    }

    #[test]
    fn bounds_are_those_of_the_standard() {
        // IEC 61131-3:2003, table 10: N bits hold -(2**(N-1)) to 2**(N-1)-1, unsigned 0 to 2**N-1.
        let bounds = [
            (Type::Sint, Some((-128, 127))),
            (Type::Int, Some((-32_768, 32_767))),
            (Type::Dint, Some((-2_147_483_648, 2_147_483_647))),
            (Type::Lint, Some((-9_223_372_036_854_775_808, 9_223_372_036_854_775_807))),
            (Type::Usint, Some((0, 255))),
            (Type::Uint, Some((0, 65_535))),
            (Type::Udint, Some((0, 4_294_967_295))),
            (Type::Ulint, Some((0, 18_446_744_073_709_551_615))),
            (Type::Word, Some((0, 65_535))),
            (Type::Lword, Some((0, 18_446_744_073_709_551_615))),
            (Type::Bool, None),
            (Type::Real, None),
            (Type::Time, None),
            (Type::Fb(FbKind::Ton), None),
        ];
        for (ty, wanted) in bounds {
            assert_eq!(ty.bounds(), wanted, "{ty}");
        }
    }
}
