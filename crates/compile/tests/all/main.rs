//! The tests of the compiler, as one program: each program is linked for itself, which takes longer than to compile it.

mod check;
mod lower;
mod plant;
