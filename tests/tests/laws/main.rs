//! The laws that hold for all charts, in one program: to link a program for each file takes longer than to compile them.

mod agree;
mod asked;
mod bare;
mod both;
mod broken;
mod drawio;
mod equations;
mod onlook;
mod random;
mod search;
mod states;
mod wide;
mod xmi;
