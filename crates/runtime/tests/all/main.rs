//! The tests of the runtime. They are one program, because linking one for each file would take longer than compiling them.

mod c;
mod helpers;
mod samples;
