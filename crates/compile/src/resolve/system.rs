//! System bits and words: their types, and who writes them.

use g7_model::{Document, Expr as Written, ExprKind, ProfileName, Span, StepKind, Type};

use super::rules;

/// The type of a system bit or word, upper case without `%` (SEMANTICS section 6).
pub(super) fn type_of(text: &str) -> Option<Type> {
    match text {
        "S0" | "S1" | "S21" | "S22" | "S23" | "S24" | "S25" => Some(Type::Bool),
        "SW20" | "SW21" => Some(Type::Int),
        // Masks of macro-steps use all sixteen bits.
        "SW22" | "SW23" | "SW24" | "SW25" => Some(Type::Uint),
        _ => None,
    }
}

/// True if the system alone writes this bit or word, named with its `%` (`%S1`, the counts).
pub fn kept_by_system(name: &str) -> bool {
    matches!(name, "%S1" | "%SW20" | "%SW21")
}

/// True if a user may set this system bit or word, named with its `%`, as the terminal of a
/// PLC does: whatever the program may write.
pub fn set_by_terminal(name: &str) -> bool {
    name.strip_prefix('%').is_some_and(|text| type_of(text).is_some()) && !kept_by_system(name)
}

/// The system bits and words that the terminal sets under the profile of a document (or
/// `instead` of it) although the text need not name them. Asked as questions beside the text,
/// they exist in the program. Those of macro-steps are left out where there are none.
pub fn terminal(doc: &Document, instead: Option<ProfileName>) -> Vec<Written> {
    let profile = instead.or(doc.profile().map(|p| p.name)).unwrap_or_default();
    let macros = doc.charts().flat_map(|c| c.steps()).any(|s| matches!(s.kind, StepKind::Macro(_)));
    let bit = |name: &&str| Written { kind: ExprKind::Direct((*name).into()), at: Span::default().into() };
    let names = rules::of_terminal(profile).iter();
    names.filter(|name| macros || !name.starts_with("SW") && **name != "S24").map(bit).collect()
}
