//! The tests of the runtime, in one program: to link a program for each file takes longer than to compile them.

mod c;
mod helpers;
mod samples;
