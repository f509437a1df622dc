//! The tests of printed code, as one program: each program is linked for itself, which takes longer than to compile it.

mod lint;
mod plc;
mod print;
mod projects;
mod runtime;
mod small;
