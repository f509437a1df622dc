//! The tests of printed code, in one program: to link a program for each file takes longer than to compile them.

mod lint;
mod plc;
mod print;
mod projects;
mod runtime;
mod small;
