//! Plants: what their words do from tick to tick, and what is wrong with some.

mod bead_sorter;
mod chance;
mod moving;
mod parts;
mod problems;
mod support;
