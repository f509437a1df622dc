//! The tests of the controller, in one program: to link a program for each file takes longer than to compile them.

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
