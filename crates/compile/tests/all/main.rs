//! The tests of the compiler. They are one program, because linking one for each file would take longer than compiling them.

mod check;
mod lower;
mod plant;
