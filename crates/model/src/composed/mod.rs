//! Puts plain variables and statements in the place of structures and of function blocks of one's own.
//!
//! ```text
//! syntax -> Document -> instances -> here -> compile, the writers of exchange
//! ```
//!
//! A variable `m` of a structure becomes a variable `m.speed` for each member; an array of structures becomes an array
//! for each member, `m[].speed` with the elements `m[1].speed` (see [`g7_model::slot_of`](crate::slot_of)). A call of a
//! function block becomes its body, with the variables of the instance in the place of its names. So all that follows
//! knows elementary types and arrays of these only.
//!
//! # What must hold
//!
//! - A document without such types is not copied.
//! - In the result there is no [`Item::Composed`] and no variable with [`VarDecl::of`]; a path to a member is one name.
//! - All places are those of the one text. The work is bounded by `MOST`.

mod base;
mod calls;
mod charts;
mod chosen;
mod copies;
mod declare;
mod kept;
mod paths;
mod returns;
mod types;
mod walk;

use std::borrow::Cow;

use crate::{Composed, Document, Item, Problem};

pub use base::Composition;
pub use kept::{as_block, as_document, with_blocks};
pub use types::DEEP;
pub(crate) use types::{defined_twice, of_language, unknown_type};

/// Replaces the structures and function blocks of a document. Returns the problems of types and calls as well.
pub fn decomposed(document: &Document) -> (Cow<'_, Document>, Vec<Problem>) {
    let plain = without_locals(document);
    match Composition::of(&plain).map(|made| made.document(&plain)) {
        Some((document, problems)) => (Cow::Owned(document), problems),
        None => (Cow::Borrowed(document), Vec::new()),
    }
}

/// The document in which the local variables of the bodies of function blocks are variables of the blocks, which get
/// their values anew at each call.
fn without_locals(document: &Document) -> Cow<'_, Document> {
    let local = |i: &Item| match i {
        Item::Composed(Composed { body: Some(b), .. }) => {
            !b.block().locals.is_empty() || returns::in_loops(&b.block().statements)
        }
        _ => false,
    };
    if !document.items.iter().any(local) {
        return Cow::Borrowed(document);
    }
    let mut own = document.clone();
    for item in &mut own.items {
        let Item::Composed(of) = item else { continue };
        let Some(mut body) = of.body.take() else { continue };
        let block = body.block_mut();
        returns::out_of_loops(of, block);
        let locals = std::mem::take(&mut block.locals);
        of.members.extend(locals.iter().map(declare::local_member));
        let values = locals.iter().flat_map(declare::local_values).collect::<Vec<_>>();
        block.statements.splice(0..0, values);
        of.body = Some(body);
    }
    Cow::Owned(own)
}
