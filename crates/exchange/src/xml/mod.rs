//! XML files: refused at the gate, or a tree whose attributes know their places.

pub(crate) mod attr;
mod guard;

pub(crate) use guard::{root_name, text, tree};
