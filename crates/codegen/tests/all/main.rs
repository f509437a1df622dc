//! The tests of printed code. They are one program, because linking one for each file would take longer than compiling them.

mod lint;
mod plc;
mod print;
mod projects;
mod runtime;
mod small;
