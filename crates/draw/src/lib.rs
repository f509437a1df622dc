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

mod chronogram;
mod draw;
mod drawing;
mod drawio;
mod geometry;
#[cfg(test)]
mod geometry_tests;
mod ink;
mod layout;
mod options;
mod pages;
mod paper;
mod placement;
mod room;
mod rungs;
mod svg;
mod symbols;
mod text;
mod together;

pub use chronogram::{Chronogram, Edge, Lane, LaneKind, chronogram_picture, chronogram_svg};
pub use draw::{ActionForms, action_forms, comments, draw, draw_all, measure, placed};
pub use drawing::{Drawing, Item, Part};
pub use drawio::{drawio, shapes};
pub use geometry::{Extent, Point, Rect, U};
pub use ink::Picture;
pub use layout::layout;
pub use options::{Look, Options};
pub use paper::{Away, Field, MM, Page, Paper, Sheet, Size, TitleBlock, sheets};
pub use placement::{Bar, Bends, Connector, End, Link, Placement, Sizes};
pub use room::make_room;
pub use rungs::{Element, Rung, rungs, rungs_svg};
pub use svg::{sheet, style, svg};
pub use text::{FONT_FAMILY, font, width};
pub use together::{Arranged, opened, together};
