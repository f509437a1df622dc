//! A document without structures and function blocks.

use std::borrow::Cow;

use super::base::Composition;
use super::{declare, returns};
use crate::{Composed, Document, Item, Problem, Type, VarDecl};

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
pub(super) fn without_locals(document: &Document) -> Cow<'_, Document> {
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

impl Document {
    /// The structures and function blocks, in the order of the text.
    pub fn composed(&self) -> impl Iterator<Item = &Composed> {
        self.items.iter().filter_map(|i| if let Item::Composed(c) = i { Some(c) } else { None })
    }
}

impl VarDecl {
    /// True for an instance of a function block of the file, in a document where [`super::with_blocks`] has left
    /// no other types of the file.
    pub fn is_own_instance(&self) -> bool {
        self.of.is_some() && self.array.is_none()
    }

    /// True for an instance of a function block, one of the standard or of the file.
    pub fn is_instance(&self) -> bool {
        matches!(self.ty, Type::Fb(_)) || self.is_own_instance()
    }
}
