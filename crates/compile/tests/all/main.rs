//! The tests of the compiler, in one program: to link a program for each file takes longer than to compile them.

mod check;
mod lower;
mod plant;
