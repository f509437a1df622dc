//! The types of variables.

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
    /// IEEE 754, 32 bits.
    Real,
    /// IEEE 754, 64 bits.
    Lreal,
    /// A duration in signed 64-bit nanoseconds.
    Time,
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
    pub fn name(self) -> &'static str {
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

impl Type {
    /// Whether values are whole numbers.
    pub fn is_integer(self) -> bool {
        self.bounds().is_some()
    }

    /// Smallest and largest value of an integer type.
    pub fn bounds(self) -> Option<(i128, i128)> {
        Some(match self {
            Type::Sint => (i8::MIN.into(), i8::MAX.into()),
            Type::Int => (i16::MIN.into(), i16::MAX.into()),
            Type::Dint => (i32::MIN.into(), i32::MAX.into()),
            Type::Lint => (i64::MIN.into(), i64::MAX.into()),
            Type::Usint => (0, u8::MAX.into()),
            Type::Uint => (0, u16::MAX.into()),
            Type::Udint => (0, u32::MAX.into()),
            Type::Ulint => (0, u64::MAX.into()),
            Type::Bool | Type::Real | Type::Lreal | Type::Time | Type::String(_) | Type::Fb(_) => {
                return None;
            }
        })
    }

    /// Whether values are floating-point numbers.
    pub fn is_real(self) -> bool {
        matches!(self, Type::Real | Type::Lreal)
    }
}

impl std::fmt::Display for Type {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Type::Bool => "BOOL",
            Type::Sint => "SINT",
            Type::Int => "INT",
            Type::Dint => "DINT",
            Type::Lint => "LINT",
            Type::Usint => "USINT",
            Type::Uint => "UINT",
            Type::Udint => "UDINT",
            Type::Ulint => "ULINT",
            Type::Real => "REAL",
            Type::Lreal => "LREAL",
            Type::Time => "TIME",
            Type::String(80) => "STRING",
            Type::String(n) => return write!(f, "STRING({n})"),
            Type::Fb(kind) => kind.name(),
        })
    }
}
