//! The tests beside other programs, as one program: each program is linked for itself, which takes longer than to compile it.

mod codegen;
mod families;
mod fmu;
mod interop;
mod oracles;
mod oscat;
mod peers;
mod plc;
mod readback;
