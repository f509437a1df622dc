//! The table of operators: how each is written, how tightly it binds, what it stands between.
//!
//! Parsers, printers, the checker, the typesetter and Instruction List read this table.

/// Operators before an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// Boolean complement.
    Not,
    /// Arithmetic minus.
    Neg,
    /// Rising edge, `↑e`.
    Rise,
    /// Falling edge, `↓e`.
    Fall,
}

/// Operators between operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    /// `or`.
    Or,
    /// `xor`.
    Xor,
    /// `and`, `&`.
    And,
    /// `·`: AND with the precedence of a product.
    Dot,
    /// `=`.
    Eq,
    /// `<>`.
    Ne,
    /// `<`.
    Lt,
    /// `<=`.
    Le,
    /// `>`.
    Gt,
    /// `>=`.
    Ge,
    /// `+`: OR between Booleans.
    Add,
    /// `-`.
    Sub,
    /// `*`: AND between Booleans.
    Mul,
    /// `/`.
    Div,
    /// `mod`.
    Mod,
    /// `**`.
    Pow,
}

/// The operands that an operator joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operands {
    /// Booleans; the result is one.
    Logic,
    /// Two values of one type; the result is a Boolean.
    Comparison,
    /// Numbers; the result is one. `+` and `*` are OR and AND between Booleans.
    Arithmetic,
}

/// A row of the table of operators between operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// As .g7 text writes it.
    pub sign: &'static str,
    /// As Structured Text of IEC 61131-3:2003, table 55, writes it.
    pub standard: &'static str,
    /// The function of the standard that does the same (tables 24 to 28); Instruction List has an
    /// operator of that name, but for EXPT.
    pub function: &'static str,
    /// As a drawn GRAFCET has it.
    pub drawn: &'static str,
    /// Binding strength: the highest binds most tightly, and equal ones from left to right.
    pub strength: u8,
    /// The operands that it joins.
    pub operands: Operands,
}

impl UnaryOp {
    /// As .g7 text writes it; a word is followed by a blank.
    pub const fn sign(self) -> &'static str {
        match self {
            UnaryOp::Not => "not",
            UnaryOp::Neg => "-",
            UnaryOp::Rise => "↑",
            UnaryOp::Fall => "↓",
        }
    }
}

impl BinaryOp {
    /// All of them, from the loosest to the tightest.
    pub const ALL: [BinaryOp; 16] = [
        BinaryOp::Or,
        BinaryOp::Xor,
        BinaryOp::And,
        BinaryOp::Eq,
        BinaryOp::Ne,
        BinaryOp::Lt,
        BinaryOp::Le,
        BinaryOp::Gt,
        BinaryOp::Ge,
        BinaryOp::Add,
        BinaryOp::Sub,
        BinaryOp::Mul,
        BinaryOp::Div,
        BinaryOp::Mod,
        BinaryOp::Dot,
        BinaryOp::Pow,
    ];

    /// Binding strength of an operand that no operator joins.
    pub const TIGHTEST: u8 = 9;

    /// The row of an operator.
    pub const fn row(self) -> Operator {
        use Operands::{Arithmetic, Comparison, Logic};
        let (sign, standard, function, drawn, strength, operands) = match self {
            BinaryOp::Or => ("or", "OR", "OR", "+", 1, Logic),
            BinaryOp::Xor => ("xor", "XOR", "XOR", "⊕", 2, Logic),
            BinaryOp::And => ("and", "AND", "AND", "·", 3, Logic),
            BinaryOp::Eq => ("=", "=", "EQ", "=", 4, Comparison),
            BinaryOp::Ne => ("<>", "<>", "NE", "≠", 4, Comparison),
            BinaryOp::Lt => ("<", "<", "LT", "<", 5, Comparison),
            BinaryOp::Le => ("<=", "<=", "LE", "≤", 5, Comparison),
            BinaryOp::Gt => (">", ">", "GT", ">", 5, Comparison),
            BinaryOp::Ge => (">=", ">=", "GE", "≥", 5, Comparison),
            BinaryOp::Add => ("+", "+", "ADD", "+", 6, Arithmetic),
            BinaryOp::Sub => ("-", "-", "SUB", "−", 6, Arithmetic),
            BinaryOp::Mul => ("*", "*", "MUL", "·", 7, Arithmetic),
            BinaryOp::Div => ("/", "/", "DIV", "/", 7, Arithmetic),
            BinaryOp::Mod => ("mod", "MOD", "MOD", "mod", 7, Arithmetic),
            // The standard has no such sign: printed for others it is an AND.
            BinaryOp::Dot => ("·", "AND", "AND", "·", 7, Logic),
            BinaryOp::Pow => ("**", "**", "EXPT", "**", 8, Arithmetic),
        };
        Operator { sign, standard, function, drawn, strength, operands }
    }

    /// Binding strength: the highest binds most tightly.
    pub const fn strength(self) -> u8 {
        self.row().strength
    }

    /// The operator that is a word, by that word in lower or in upper case.
    pub fn of_word(word: &str) -> Option<BinaryOp> {
        const WORDS: [BinaryOp; 4] = [BinaryOp::And, BinaryOp::Or, BinaryOp::Xor, BinaryOp::Mod];
        WORDS.into_iter().find(|op| word == op.row().sign || word == op.row().standard)
    }

    /// The operator that Structured Text of IEC 61131-3 writes so, in capitals.
    pub fn of_standard(sign: &str) -> Option<BinaryOp> {
        BinaryOp::ALL.into_iter().find(|op| op.row().standard == sign)
    }
}

#[cfg(test)]
mod tests {
    use super::BinaryOp;

    #[test]
    fn an_operator_is_found_by_each_of_its_spellings() {
        for op in BinaryOp::ALL {
            let found = if op == BinaryOp::Dot { BinaryOp::And } else { op };
            assert_eq!(BinaryOp::of_standard(op.row().standard), Some(found));
            let is_word = op.row().sign.chars().all(char::is_alphabetic) && op != BinaryOp::Dot;
            assert_eq!(BinaryOp::of_word(op.row().sign), is_word.then_some(op), "{op:?}");
        }
        assert_eq!(BinaryOp::of_word("And"), None);
    }

    #[test]
    fn strength_grows_along_the_list_and_stays_below_that_of_an_operand() {
        let strengths: Vec<u8> = BinaryOp::ALL.iter().map(|op| op.strength()).collect();
        assert!(strengths.is_sorted());
        assert_eq!(strengths.last().map(|s| s + 1), Some(BinaryOp::TIGHTEST));
    }
}
