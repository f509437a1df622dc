//! The tests of the controller. They are one program, because linking one for each file would take longer than compiling them.

mod catalogue;
mod change;
#[path = "../common/mod.rs"]
mod common;
mod edit;
mod faults;
mod forces;
mod late;
mod masters;
mod notes;
mod pages;
mod slots;
