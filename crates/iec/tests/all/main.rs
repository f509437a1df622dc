//! The tests of the formats of IEC 61131-3, as one program: each program is linked for itself, which takes longer than to compile it.

mod plcopen;
mod returned;
mod sfc;
#[path = "../../../exchange/tests/support/mod.rs"]
mod support;
