//! The instructions of an Instruction List, after parsing.

use g7_model::{Arg, BinaryOp, Expr, Name, Operands, Path, Span, StandardFunction};

/// One instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// The operation with its operands.
    pub kind: InstructionKind,
    /// Its place in the text.
    pub at: Span,
}

/// The operand of an operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Operand {
    /// One value, or several (`ADD a, b`).
    Values(Vec<Expr>),
    /// `(`, with the value to load if it stands directly behind the bracket.
    Open(Option<Expr>),
}

/// The condition of a jump, call or return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Unconditionally.
    Always,
    /// If the current result is TRUE.
    True,
    /// If the current result is FALSE.
    False,
}

/// The instructions of IEC 61131-3:2003, table 52.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InstructionKind {
    /// `name:`.
    Label(Name),
    /// LD and LDN.
    Load {
        /// The value.
        value: Expr,
        /// LDN.
        negated: bool,
    },
    /// ST and STN, to a path or direct name.
    Store {
        /// The variable that is written.
        target: Expr,
        /// STN.
        negated: bool,
    },
    /// S (TRUE) and R (FALSE).
    Latch {
        /// The variable that is set or reset.
        target: Expr,
        /// TRUE for S, FALSE for R.
        value: bool,
    },
    /// AND, ANDN, ADD, GT, …
    Operate {
        /// The operation.
        op: BinaryOp,
        /// True if the operand is complemented.
        negated: bool,
        /// The operand.
        operand: Operand,
    },
    /// `)`.
    Close,
    /// NOT.
    Complement,
    /// A function of the current result and further values.
    Apply(Name, Vec<Expr>),
    /// JMP, JMPC, JMPCN.
    Jump(Name, When),
    /// CAL, CALC, CALCN.
    Call(Path, Vec<Arg>, When),
    /// `CU C10`: the current result becomes an input of a function block, which is called.
    Input(Name, Path),
    /// RET, RETC, RETCN.
    Return(When),
}

/// An operator by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mnemonic {
    /// LD, LDN.
    Load(bool),
    /// ST, STN.
    Store(bool),
    /// S, R.
    Latch(bool),
    /// AND, ANDN, ADD, …; true if the operand is complemented.
    Operate(BinaryOp, bool),
    /// NOT.
    Complement,
    /// JMP, JMPC, JMPCN.
    Jump(When),
    /// CAL, CALC, CALCN.
    Call(When),
    /// RET, RETC, RETCN.
    Return(When),
}

/// The operator with this name, which is in upper case.
pub fn mnemonic(word: &str) -> Option<Mnemonic> {
    Some(match word {
        "LD" => Mnemonic::Load(false),
        "LDN" => Mnemonic::Load(true),
        "ST" => Mnemonic::Store(false),
        "STN" => Mnemonic::Store(true),
        "S" => Mnemonic::Latch(true),
        "R" => Mnemonic::Latch(false),
        "&" => Mnemonic::Operate(BinaryOp::And, false),
        "&N" => Mnemonic::Operate(BinaryOp::And, true),
        "NOT" => Mnemonic::Complement,
        "JMP" => Mnemonic::Jump(When::Always),
        "JMPC" => Mnemonic::Jump(When::True),
        "JMPCN" | "JMPNC" => Mnemonic::Jump(When::False),
        "CAL" => Mnemonic::Call(When::Always),
        "CALC" => Mnemonic::Call(When::True),
        "CALCN" | "CALNC" => Mnemonic::Call(When::False),
        "RET" => Mnemonic::Return(When::Always),
        "RETC" => Mnemonic::Return(When::True),
        "RETCN" | "RETNC" => Mnemonic::Return(When::False),
        _ => return operation(word),
    })
}

/// `ADD`, `GT`, and of the logical ones `ANDN` too; the list has no EXPT.
fn operation(word: &str) -> Option<Mnemonic> {
    if let Some(op) = StandardFunction::operator(word) {
        return (op != BinaryOp::Pow).then_some(Mnemonic::Operate(op, false));
    }
    let op = StandardFunction::operator(word.strip_suffix('N')?)?;
    (op.row().operands == Operands::Logic).then_some(Mnemonic::Operate(op, true))
}

/// True if the word names an input of a standard function block that an instruction can load (table
/// 54).
pub fn is_input(word: &str) -> bool {
    matches!(word, "S1" | "R1" | "CLK" | "CU" | "CD" | "PV" | "IN" | "PT")
}
