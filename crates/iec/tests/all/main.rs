//! The tests of the formats of IEC 61131-3. They are one program, because linking one for each file would take longer than compiling them.

mod blocks;
mod enumerations;
mod plcopen;
mod returned;
mod sfc;
mod structures;
#[path = "../../../exchange/tests/support/mod.rs"]
mod support;
