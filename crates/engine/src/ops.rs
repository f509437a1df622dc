//! The instructions of receptivities, conditions and bodies: a stack machine.
//!
//! A value is one 64-bit word: BOOL 0 or 1; integers sign- or zero-extended;
//! TIME signed nanoseconds; REAL and LREAL as the bits of `f32` and `f64`;
//! STRING as the address of its first word. Code is structured: each jump comes
//! from an IF, a CASE or a loop.

/// Words of stack that code may use.
pub const STACK: usize = 64;

/// Rounds of loops that the code of one scan may make; more are taken for an endless loop.
pub const WORK: u32 = 1_000_000;

/// Longest STRING, in bytes.
pub const TEXT: u16 = 4096;

/// A word of the variable area of a state, `0..program.words`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Addr(pub u32);

/// A step of the program, `0..program.steps`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StepId(pub u32);

/// A watched expression (`↑e`) or timer (`t1/e/t2`), `0..program.watches`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WatchId(pub u32);

/// A set of contiguous steps, `0..program.groups`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GroupId(pub u32);

/// Instructions `start..end` of [`crate::Tables::code`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Code {
    /// First instruction.
    pub start: u32,
    /// One past the last.
    pub end: u32,
}

impl Code {
    /// True if there is no instruction.
    pub const fn is_empty(self) -> bool {
        self.start >= self.end
    }
}

/// How a word is read as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Num {
    /// BOOL.
    Bool,
    /// SINT.
    I8,
    /// INT.
    I16,
    /// DINT.
    I32,
    /// LINT, TIME.
    I64,
    /// USINT.
    U8,
    /// UINT.
    U16,
    /// UDINT.
    U32,
    /// ULINT.
    U64,
    /// REAL.
    F32,
    /// LREAL.
    F64,
}

/// Arithmetic between two values of one kind; the right operand is on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arith {
    /// Sum.
    Add,
    /// Difference.
    Sub,
    /// Product.
    Mul,
    /// Quotient, toward zero for integers.
    Div,
    /// Remainder with the sign of the dividend.
    Mod,
    /// Power (F64 only).
    Pow,
}

/// Comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cmp {
    /// Equal.
    Eq,
    /// Not equal.
    Ne,
    /// Less.
    Lt,
    /// Less or equal.
    Le,
    /// Greater.
    Gt,
    /// Greater or equal.
    Ge,
}

/// The standard functions (IEC 61131-3:2003, 2.5.1.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Builtin {
    /// Absolute value, of any number; overflow is a fault.
    Abs,
    /// Square root (REAL, LREAL).
    Sqrt,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 10.
    Log,
    /// e to the power.
    Exp,
    /// Sine, radians.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Arc sine.
    Asin,
    /// Arc cosine.
    Acos,
    /// Arc tangent.
    Atan,
    /// Smaller of two (numbers, TIME).
    Min,
    /// Larger of two.
    Max,
    /// `LIMIT(mn, in, mx)`.
    Limit,
    /// `SEL(g, in0, in1)`; any type of one word, and STRING.
    Sel,
    /// `MUX(k, in0, in1, …)`: K is LINT; out of range is a fault.
    Mux,
    /// `SHL(in, n)`, of unsigned kinds: `n` bits to the left, zeros behind; N is LINT, and
    /// negative it is a fault.
    Shl,
    /// `SHR(in, n)`: to the right, zeros before.
    Shr,
    /// `ROL(in, n)`: to the left in a ring of the bits of the kind.
    Rol,
    /// `ROR(in, n)`: to the right in a ring.
    Ror,
    /// AND of two values of an unsigned kind, bit by bit.
    BitAnd,
    /// OR, bit by bit.
    BitOr,
    /// XOR, bit by bit.
    BitXor,
    /// The lowest bits of a whole number of any kind, as the kind of the call.
    Transfer,
    /// `LEN(s)`: the number of Unicode characters (INT).
    Len,
    /// `LEFT(s, n)`.
    Left,
    /// `RIGHT(s, n)`.
    Right,
    /// `MID(s, len, pos)`, positions from 1.
    Mid,
    /// `CONCAT(a, b)`.
    Concat,
    /// `INSERT(a, b, pos)`.
    Insert,
    /// `DELETE(s, len, pos)`.
    Delete,
    /// `REPLACE(a, b, len, pos)`.
    Replace,
    /// `FIND(a, b)`, 0 where absent (INT).
    Find,
}

impl Builtin {
    /// Moves bits by a number of places, its second argument.
    pub const fn shifts(self) -> bool {
        matches!(self, Builtin::Shl | Builtin::Shr | Builtin::Rol | Builtin::Ror)
    }

    /// A function of texts: [`Op::Text`], not [`Op::Call`].
    pub const fn is_of_texts(self) -> bool {
        matches!(
            self,
            Builtin::Len
                | Builtin::Left
                | Builtin::Right
                | Builtin::Mid
                | Builtin::Concat
                | Builtin::Insert
                | Builtin::Delete
                | Builtin::Replace
                | Builtin::Find
        )
    }
}

/// The standard function blocks. The words of an instance are the members, in the order
/// of the standard's call, and then the memory (`fb.rs`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Block {
    /// CU, R, PV, Q, CV; memory of CU.
    Ctu,
    /// CD, LD, PV, Q, CV; memory of CD.
    Ctd,
    /// CU, CD, R, LD, PV, QU, QD, CV; memories of CU and CD.
    Ctud,
    /// IN, PT, Q, ET; start, memory of IN.
    Ton,
    /// IN, PT, Q, ET; start, memory of IN.
    Tof,
    /// IN, PT, Q, ET; start, memory of IN.
    Tp,
    /// CLK, Q; memory of CLK.
    RTrig,
    /// CLK, Q; memory of CLK.
    FTrig,
    /// S1, R, Q1.
    Sr,
    /// S, R1, Q1.
    Rs,
}

impl Block {
    /// Words of an instance, members first, then memory.
    pub const fn words(self) -> u32 {
        match self {
            Block::Ctu | Block::Ctd | Block::Ton | Block::Tof | Block::Tp => 6,
            Block::Ctud => 10,
            Block::RTrig | Block::FTrig | Block::Sr | Block::Rs => 3,
        }
    }
}

/// Requests to the service point between PRE and the evolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Service {
    /// All charts take the situation of the start ([`crate::Tables::initial`]),
    /// whatever else is asked for.
    Start,
    /// The group takes its initial situation.
    Init(GroupId),
    /// All steps of the group are deactivated.
    Clear(GroupId),
    /// The step is activated.
    Set(StepId),
    /// The step is deactivated.
    Reset(StepId),
    /// All step times become 0 (at once, not at the service point).
    ResetTimes,
}

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Pushes a constant.
    Push(u64),
    /// Pushes a word.
    Load(Addr),
    /// Pops into a word.
    Store(Addr),
    /// Pops an index; pushes word `base + index`; a fault unless `0 <= index < len`.
    LoadAt {
        /// First word.
        base: Addr,
        /// Number of words.
        len: u32,
    },
    /// Pops a value, then an index; writes word `base + index`; a fault unless `0 <= index < len`.
    StoreAt {
        /// First word.
        base: Addr,
        /// Number of words.
        len: u32,
    },
    /// Pushes the activity of a step.
    Active(StepId),
    /// Pushes the activity of a step as the pass began.
    WasActive(StepId),
    /// Pushes whether any step of a group is active.
    GroupActive(GroupId),
    /// Pushes the time since activation, ns; scans under the scan clock.
    StepTime(StepId),
    /// Pushes `min(time / 100 ms, 9999)`.
    StepTenths(StepId),
    /// Pushes the time since a step of the group became active while none was,
    /// ns; scans under the scan clock.
    GroupTime(GroupId),
    /// Pushes the time since activation, ns, under the scan clock too.
    StepAge(StepId),
    /// As [`Op::StepAge`], of a group.
    GroupAge(GroupId),
    /// Pushes whether this row of [`crate::Tables::periods`] is due in this scan.
    Due(u32),
    /// Pushes whether the watched expression rose in this pass.
    Rise(WatchId),
    /// Pushes whether it fell in this pass.
    Fall(WatchId),
    /// Pushes the output of a timer.
    Timer(WatchId),
    /// BOOL complement.
    Not,
    /// AND of two BOOL.
    And,
    /// OR.
    Or,
    /// XOR.
    Xor,
    /// Minus; overflow is a fault.
    Neg(Num),
    /// Arithmetic; overflow and division by zero are faults.
    Arith(Arith, Num),
    /// Pushes 1 or 0.
    Compare(Cmp, Num),
    /// Converts the top from the first kind to the second; out of range is a fault; reals
    /// are rounded half to even.
    Convert(Num, Num),
    /// Converts the top toward zero, from the first (real) to the second (integer) kind.
    Trunc(Num, Num),
    /// A function of `n` arguments on numbers of one kind (for SEL and MUX the
    /// kind does not matter; the N of a shift is I64). String functions are [`Op::Text`].
    Call(Builtin, Num, u8),
    /// A string function of `n` arguments; writes to the string at `to` of
    /// capacity `cap` bytes and pushes `to`; LEN and FIND push a number instead.
    Text {
        /// The function.
        function: Builtin,
        /// First word of the result.
        to: Addr,
        /// Bytes it can hold.
        cap: u16,
    },
    /// Pops the addresses of two strings; pushes the result of comparing their bytes.
    CompareText(Cmp),
    /// Pops a string's address; copies the string to `to`, cut between two characters to
    /// at most `cap` bytes.
    StoreText {
        /// First word.
        to: Addr,
        /// Bytes it can hold.
        cap: u16,
    },
    /// Pops a value of the kind; writes it as text to `to`; pushes `to`.
    ToText {
        /// Kind of the value; I64 prints a plain number.
        from: Num,
        /// True if it is TIME.
        time: bool,
        /// First word of the result.
        to: Addr,
        /// Bytes it can hold.
        cap: u16,
    },
    /// Pops a string's address; pushes the number that it spells; no number is a fault.
    FromText(Num),
    /// Runs a function block instance on its words.
    Fb(Block, Addr),
    /// Goes on at an instruction of the same code.
    Jump(u32),
    /// Pops a BOOL; goes on there unless it is true.
    JumpUnless(u32),
    /// Ends this code (of a body; never inside an inlined function).
    Return,
    /// Makes a request.
    Service(Service),
    /// Pushes the time since the preceding scan, ns (0 at the first).
    ScanTime,
    /// Pushes a random number in 0..1 (F64) from the generator whose word this is.
    Random(Addr),
    /// Drops the top.
    Drop,
}
