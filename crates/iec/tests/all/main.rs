//! The tests of the formats of IEC 61131-3, in one program: to link a program for each file takes longer than to compile them.

mod plcopen;
mod returned;
mod sfc;
#[path = "../../../exchange/tests/support/mod.rs"]
mod support;
