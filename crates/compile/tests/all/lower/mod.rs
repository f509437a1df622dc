//! The lowering of each construct: from text to the rows of the tables, and,
//! where rows would say little, to what the engine then does.

mod actions;
mod code;
mod names;
mod structure;
mod support;
mod transitions;
