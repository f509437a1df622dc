//! Questions of an editor about a file, answered as plain data.
//!
//! # Where this sits
//!
//! ```text
//! text -> File: syntax, rig (problems), edit (history)
//!           |-> queries: completion, hover, references, outline, tokens, fixes, logic …
//!                 |-> page (JSON, code units)      -> the editor in the browser
//!                 |-> g7 lsp (JSON-RPC, lines)     -> the editors that people already use
//! ```
//!
//! A query is a function of a [`File`]; a place is a byte of its text. Only the two doors know JSON
//! and count in other units, for which [`Positions`] is there.
//!
//! # What must hold
//!
//! - No text and no place makes a query panic: a place beyond the end is the end.
//! - A query never changes the file. [`File::change`], [`File::make`], [`File::take`] and [`File::travel`] alone do.
//! - If the text has syntax errors, names come from the latest text without them.
#![forbid(unsafe_code)]

pub mod across;
pub mod cases;
pub mod completion;
mod file;
pub mod fixes;
mod format;
pub mod gestures;
pub mod hover;
pub mod ids;
pub mod inlays;
pub mod lenses;
pub mod logic;
pub mod names;
pub mod outline;
mod positions;
pub mod references;
pub mod rules;
pub mod search;
pub mod tables;
pub mod tokens;
pub mod undeclared;

pub use file::{File, OWN, Readable, Texts, convert};
pub use format::format;
pub use positions::Positions;
