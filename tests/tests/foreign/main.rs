//! The tests beside other programs. They are one program, because linking one for each file would take longer than compiling them.

mod families;
mod fmu;
mod interop;
mod oracles;
mod oscat;
mod peers;
mod plc;
mod readback;
