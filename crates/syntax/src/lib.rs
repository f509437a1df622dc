//! syntax

pub mod jgrafchart;
