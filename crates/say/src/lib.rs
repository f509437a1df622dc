//! `say!`: a text for a reader, written like the text of `format!`, that can be told in other languages.
//!
//! `model` hands it on; every check and every reader of files words its problems with it. The text as it
//! stands in the source is the key of the row in the table of languages (`crates/model/src/said`).
//!
//! It must hold: a hole in back-ticks takes whatever can be shown, for it is a name or a piece of
//! somebody's text. A hole elsewhere takes a number, a type or another text made by `say!`; a word of English
//! that no table knows does not compile there.
#![forbid(unsafe_code)]

mod expand;
mod template;

use proc_macro::TokenStream;

/// A `g7_model::Said` of a text with holes: `{}`, `{name}`, `{:?}`.
#[proc_macro]
pub fn say(input: TokenStream) -> TokenStream {
    match expand::expand(input) {
        Ok(made) => made,
        Err((at, why)) => expand::refused(at, why),
    }
}
