//! The grammars of other editors, made of the one table of words (`g7_model::words`).
//!
//! `make grammars` writes the files; `tests/tests/house/grammars.rs` sees whether they are up to date, and that they
//! read every chart of the repository.

mod charts;
mod textmate;
mod tree_sitter;
mod vim;
mod vocabulary;

pub use charts::charts;
pub use vocabulary::Vocabulary;

/// A generated file: its path from the root of the repository, and its text.
pub type Generated = (&'static str, String);

/// All generated files.
pub fn all() -> Vec<Generated> {
    let words = Vocabulary::new();
    vec![
        ("editors/vscode/syntaxes/g7.tmLanguage.json", textmate::grammar(&words)),
        ("editors/vim/syntax/g7.vim", vim::syntax(&words)),
        ("editors/tree-sitter-g7/words.json", tree_sitter::words(&words)),
        ("editors/tree-sitter-g7/queries/highlights.scm", tree_sitter::highlights(&words)),
        ("editors/zed/languages/g7/highlights.scm", tree_sitter::highlights(&words)),
    ]
}
