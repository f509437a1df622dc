//! Puts the declared types in the place of their names, and checks what is written to variables of them.
//!
//! ```text
//! syntax -> Document -> declared -> instances -> composed -> held -> compile, the writers of exchange
//! ```
//!
//! [`declared`] looks at declarations: a variable of `type Percent : INT(0..100)` becomes an INT with
//! [`Limits`](crate::Limits). [`held`] looks at statements and expressions, in which members of structures are
//! variables already: a value of an enumeration becomes its number, and an assignment to a variable with bounds becomes
//! one by a function that checks them. So all that follows knows whole numbers and functions only.
//!
//! # What must hold
//!
//! - A document without such types is not copied.
//! - In the result of [`declared`], [`VarDecl::of`](crate::VarDecl::of) names structures and function blocks alone, and the
//!   types are the enumerations.
//! - No variable with bounds ever holds a value outside of them. A value of an enumeration has no operation but `=` and `<>`.

mod checks;
mod declare;
mod held;
mod scopes;
mod walk;

pub use declare::{declared, numbered};
pub use held::{Held, held};
