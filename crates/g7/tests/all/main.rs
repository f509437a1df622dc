//! The tests of the command line, in one program: to link a program for each file takes longer than to compile them.

mod cases;
mod check;
mod code;
#[path = "../common/mod.rs"]
mod common;
mod draw;
mod events;
mod faults;
mod field;
mod files;
mod fixes;
mod fmu;
mod guard;
mod history;
mod hosts;
mod lsp;
mod mqtt;
mod online;
mod opcua;
mod operator;
mod outputs;
mod panel;
mod plant;
mod printed;
mod project;
mod proofs;
mod prove;
mod run;
mod serve;
mod service;
mod suite;
mod testing;
mod tongues;
