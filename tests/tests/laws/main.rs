//! The laws that hold for all charts, as one program: each program is linked for itself, which takes longer than to compile it.

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
