//! The words of Control Expert that the language spells differently: the reader and the writer use
//! the same tables.

use g7_model::{Arg, Expr, ExprKind, FbKind, StandardFunction, Stmt, StmtKind, Type, UnaryOp};

use g7_iec::nodes;
use g7_model::visit_mut::Visitor;

/// The edges, and the function for each; its operand is an EBOOL.
const EDGES: [(&str, UnaryOp); 2] = [("RE", UnaryOp::Rise), ("FE", UnaryOp::Fall)];

/// The calls that set and reset a Boolean.
const ASSIGNMENTS: [(&str, bool); 2] = [("SET", true), ("RESET", false)];

/// Other reserved words.
const WORDS: &str =
    "EBOOL NONE INITCHART CLEARCHART FREEZECHART SETSTEP RESETSTEP REAL_TRUNC DDT DFB EFB ANY_ARRAY";

/// The members of a step: its activity and its time.
pub(super) const ACTIVE: &str = "x";
pub(super) const TIME: &str = "t";

/// The type of a Boolean with a history. An edge needs it, and a Boolean at an address has it.
pub(super) const WITH_HISTORY: &str = "EBOOL";

/// The function of an edge.
pub(super) fn edge_word(op: UnaryOp) -> &'static str {
    EDGES.iter().find(|(_, own)| *own == op).map_or("", |(word, _)| word)
}

/// True for a word of Control Expert beside those of IEC 61131-3.
pub(super) fn is_word(name: &str) -> bool {
    let own = EDGES.iter().map(|e| e.0).chain(ASSIGNMENTS.iter().map(|a| a.0));
    own.chain(WORDS.split_whitespace()).any(|word| word.eq_ignore_ascii_case(name))
}

/// The name of a type; None where there is no such type.
pub(super) fn type_name(ty: Type) -> Option<String> {
    match ty {
        Type::Bool
        | Type::Int
        | Type::Dint
        | Type::Uint
        | Type::Udint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Real
        | Type::Time => Some(ty.name().to_string()),
        // Without a number it has another length there.
        Type::String(length) => Some(format!("STRING[{length}]")),
        Type::Fb(
            FbKind::Ctu
            | FbKind::Ctd
            | FbKind::Ctud
            | FbKind::Ton
            | FbKind::Tof
            | FbKind::Tp
            | FbKind::RTrig
            | FbKind::FTrig
            | FbKind::Sr
            | FbKind::Rs,
        ) => Some(ty.name().to_string()),
        // Its dates are numbers in BCD, to the second.
        Type::Moment(_) => None,
        Type::Sint | Type::Usint | Type::Lint | Type::Ulint | Type::Lword | Type::Lreal => None,
    }
}

/// True for a standard function that has its name of IEC 61131-3 there. Functions of texts have other names.
pub(super) fn has_function(standard: Option<StandardFunction>, upper: &str) -> bool {
    use StandardFunction as F;
    match standard {
        Some(
            F::Operator(_)
            | F::Not
            | F::Move
            | F::Abs
            | F::Sqrt
            | F::Ln
            | F::Log
            | F::Exp
            | F::Sin
            | F::Cos
            | F::Tan
            | F::Asin
            | F::Acos
            | F::Atan
            | F::Shl
            | F::Shr
            | F::Rol
            | F::Ror
            | F::Min
            | F::Max
            | F::Limit
            | F::Sel
            | F::Mux,
        ) => true,
        Some(
            F::Trunc
            | F::Len
            | F::Left
            | F::Right
            | F::Mid
            | F::Concat
            | F::Insert
            | F::Delete
            | F::Replace
            | F::Find
            | F::ConcatDateTod
            | F::DayOfWeek,
        ) => false,
        // A conversion; `Speech::printed` reports types that Control Expert does not have.
        None => upper
            .split_once("_TO_")
            .is_some_and(|(from, to)| Type::named(from).is_some() && Type::named(to).is_some()),
    }
}

/// True for an address, such as `%I0.1.3`, `%MW10`, `%M5`.
pub(super) fn is_address(text: &str) -> bool {
    let upper = text.to_ascii_uppercase();
    let Some(rest) = upper.strip_prefix('%') else { return false };
    let Some(rest) = rest.strip_prefix(['I', 'Q', 'M', 'K', 'S']) else { return false };
    let digits = rest.strip_prefix(['W', 'D', 'F']).unwrap_or(rest);
    digits.split('.').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()))
}

/// Rewrites `SET(x)`, `RESET(x)`, `RE(x)`, `FE(x)`.
pub(super) struct Words;

fn only(args: &[Arg]) -> Option<&Expr> {
    match args {
        [arg] if !arg.output => Some(&arg.value),
        _ => None,
    }
}

impl Visitor for Words {
    fn stmt(&mut self, stmt: &mut Stmt) {
        let at = stmt.at.0;
        let StmtKind::Call(path, args) = &stmt.kind else { return };
        let word = path.text();
        let Some((_, value)) = ASSIGNMENTS.iter().find(|(own, _)| own.eq_ignore_ascii_case(&word)) else {
            return;
        };
        if let Some(target) = only(args).cloned() {
            *stmt = nodes::assign(target, nodes::boolean(*value, at), at);
        }
    }

    fn expr(&mut self, e: &mut Expr) {
        let at = e.at.0;
        let ExprKind::Call(path, args) = &e.kind else { return };
        let word = path.text();
        let Some((_, op)) = EDGES.iter().find(|(own, _)| own.eq_ignore_ascii_case(&word)) else { return };
        if let Some(value) = only(args).cloned() {
            *e = nodes::unary(*op, value, at);
        }
    }
}
