//! XML files: refused at the gate, or a tree whose attributes know their places;
//! and elements as they are written.

pub(crate) mod attr;
pub(crate) mod element;
mod guard;

pub(crate) use guard::{root_name, text, tree};
