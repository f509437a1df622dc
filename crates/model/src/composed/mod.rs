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
mod blocks;
mod calls;
mod charts;
mod chosen;
mod copies;
mod declare;
mod kept;
mod paths;
mod plain;
mod returns;
mod types;
mod walk;

pub use base::Composition;
pub use blocks::{as_block, as_document, with_blocks};
pub use plain::decomposed;
pub use types::DEEP;
pub(crate) use types::{defined_twice, of_language, unknown_type};
