//! Instruction List: a way to write Structured Text.
//!
//! # Where this sits
//!
//! ```text
//! text of an `il { }` body -> read -> Instruction -> translate -> flow -> model::Stmt
//! IL of another tool (exchange) ----------^
//! model::Stmt, model::Expr -> show -> text
//! ```
//!
//! What must hold: everything behind the parser sees statements only, and these
//! do what the list does: the result of an operation is kept as the expression
//! that gave it, and is written where it is used.

mod flow;
mod show;
mod translate;

pub(crate) use flow::{Piece, negated, structure};
pub use show::{show_as_il, show_expr_as_il};
pub(crate) use translate::{assign, boolean, height, reads, size};
pub use translate::{translate, translate_expr};

use g7_model::{Arg, BinaryOp, Expr, FileId, Name, Path, Problem, Span, Stmt};

use crate::parse::Parser;

/// Reads an Instruction List of the .g7 language as the statements it stands for.
pub fn statements(text: &str, file: FileId) -> (Vec<Stmt>, Vec<Problem>) {
    statements_from(text, file, 0)
}

/// The same for a part of a file: from a byte to the end of the text.
pub(crate) fn statements_from(text: &str, file: FileId, start: usize) -> (Vec<Stmt>, Vec<Problem>) {
    let mut parser = Parser::portion(text, file, start);
    let list = parser.instructions();
    let mut problems = parser.finish().0;
    let (statements, more) = translate(&list);
    problems.extend(more);
    (statements, problems)
}

/// Reads an Instruction List of the .g7 language as the expression that is its last result.
pub fn expression(text: &str, file: FileId) -> (Expr, Vec<Problem>) {
    let mut parser = Parser::portion(text, file, 0);
    let list = parser.instructions();
    let mut problems = parser.finish().0;
    let end = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let (expr, more) = translate_expr(&list, Span { file, start: 0, end });
    problems.extend(more);
    (expr, problems)
}

/// One instruction, read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What it does.
    pub kind: InstructionKind,
    /// Where it stands.
    pub at: Span,
}

/// The operand of an operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Operand {
    /// One value, or several (`ADD a, b`).
    Values(Vec<Expr>),
    /// `(`, with the value that is loaded at once, if it stands there.
    Open(Option<Expr>),
}

/// When a jump, call or return is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In any case.
    Always,
    /// If the result is TRUE.
    True,
    /// If it is FALSE.
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
        /// Where to.
        target: Expr,
        /// STN.
        negated: bool,
    },
    /// S (TRUE) and R (FALSE).
    Latch {
        /// What is set or reset.
        target: Expr,
        /// What it becomes.
        value: bool,
    },
    /// AND, ANDN, ADD, GT, …
    Operate {
        /// The operation.
        op: BinaryOp,
        /// Whether the operand is complemented.
        negated: bool,
        /// The operand.
        operand: Operand,
    },
    /// `)`.
    Close,
    /// NOT.
    Complement,
    /// A function of the result and more values.
    Apply(Name, Vec<Expr>),
    /// JMP, JMPC, JMPCN.
    Jump(Name, When),
    /// CAL, CALC, CALCN.
    Call(Path, Vec<Arg>, When),
    /// `CU C10`: the result becomes an input of a function block, which is called.
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
    /// AND, ANDN, ADD, …; whether the operand is complemented.
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

/// The operator that a word names, in capitals.
pub fn mnemonic(word: &str) -> Option<Mnemonic> {
    use BinaryOp::{Add, And, Div, Eq, Ge, Gt, Le, Lt, Mod, Mul, Ne, Or, Sub, Xor};
    Some(match word {
        "LD" => Mnemonic::Load(false),
        "LDN" => Mnemonic::Load(true),
        "ST" => Mnemonic::Store(false),
        "STN" => Mnemonic::Store(true),
        "S" => Mnemonic::Latch(true),
        "R" => Mnemonic::Latch(false),
        "AND" | "&" => Mnemonic::Operate(And, false),
        "ANDN" | "&N" => Mnemonic::Operate(And, true),
        "OR" => Mnemonic::Operate(Or, false),
        "ORN" => Mnemonic::Operate(Or, true),
        "XOR" => Mnemonic::Operate(Xor, false),
        "XORN" => Mnemonic::Operate(Xor, true),
        "ADD" => Mnemonic::Operate(Add, false),
        "SUB" => Mnemonic::Operate(Sub, false),
        "MUL" => Mnemonic::Operate(Mul, false),
        "DIV" => Mnemonic::Operate(Div, false),
        "MOD" => Mnemonic::Operate(Mod, false),
        "GT" => Mnemonic::Operate(Gt, false),
        "GE" => Mnemonic::Operate(Ge, false),
        "EQ" => Mnemonic::Operate(Eq, false),
        "NE" => Mnemonic::Operate(Ne, false),
        "LE" => Mnemonic::Operate(Le, false),
        "LT" => Mnemonic::Operate(Lt, false),
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
        _ => return None,
    })
}

/// Whether a word names an input of a standard function block that is loaded by an instruction (table 54).
pub fn is_input(word: &str) -> bool {
    matches!(word, "S1" | "R1" | "CLK" | "CU" | "CD" | "PV" | "IN" | "PT")
}
