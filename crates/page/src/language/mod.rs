//! What the text view asks of the language: colours, completion, what a name
//! is, where it is used. All of it comes from the same lexer, document and
//! checker as everything else.

pub(crate) mod complete;
pub(crate) mod hover;
pub(crate) mod names;
pub(crate) mod search;
pub(crate) mod symbols;
pub(crate) mod tokens;
