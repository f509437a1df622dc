//! The tests beside other programs, in one program: to link a program for each file takes longer than to compile them.

mod codegen;
mod families;
mod fmu;
mod interop;
mod oracles;
mod oscat;
mod peers;
mod plc;
mod readback;
