//! The tests of the runtime, as one program: each program is linked for itself, which takes longer than to compile it.

mod c;
mod helpers;
mod samples;
