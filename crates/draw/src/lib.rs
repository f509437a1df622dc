//! Charts as pictures.
//!
//! # Where this sits
//!
//! ```text
//! model::Chart -> measure (texts, symbols) -> layout -> Placement -> Drawing -> SVG
//! ```
//!
//! # Invariants
//!
//! - A picture never decides behaviour, and the same chart gives the same
//!   picture, byte for byte, on every machine.
//! - No symbol or text overlaps another where the layout is automatic.
#![forbid(unsafe_code)]

mod drawing;
mod geometry;
mod placement;

pub use drawing::{Drawing, Item, Part};
pub use geometry::{Extent, Point, Rect, U};
pub use placement::{Bar, Connector, End, Link, Placement, Sizes};
