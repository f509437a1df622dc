//! The tests of the controller, as one program: each program is linked for itself, which takes longer than to compile it.

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
