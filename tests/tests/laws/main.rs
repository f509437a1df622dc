//! The laws that hold for all charts. They are one program, because linking one for each file would take longer than compiling them.

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
