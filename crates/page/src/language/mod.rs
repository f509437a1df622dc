//! Services for the text view: colours, completion, explanations, search. They use the same lexer,
//! document and checker as everything else.

pub(crate) mod complete;
pub(crate) mod definitions;
pub(crate) mod hover;
pub(crate) mod search;
pub(crate) mod symbols;
pub(crate) mod tokens;
