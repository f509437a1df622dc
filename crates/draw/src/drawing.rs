//! A chart drawn: a list of items, each with its box and its SVG.
//!
//! The page culls by box and puts the fragments of what is in sight on the
//! screen, so it needs to know nothing of symbols. `svg` prints all of them.

use g7_model::Span;

use crate::{End, Point, Rect};

/// One chart, drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drawing {
    /// The chart's name.
    pub chart: Box<str>,
    /// What all of it covers.
    pub area: Rect,
    /// In the order in which they are painted.
    pub items: Vec<Item>,
}

/// A thing that can be pointed at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub part: Part,
    /// What it covers, texts included.
    pub area: Rect,
    /// Its symbol, in coordinates of the drawing; classes, no colours.
    pub svg: String,
    /// Path data for a far view: lines without texts; may be empty.
    pub far: String,
    /// Its place in the text; empty for what has none.
    pub at: Span,
}

/// What an item is. Steps and transitions are numbered as in the text of the chart, from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// A step without its actions.
    Step {
        /// Its number.
        step: u32,
        /// The square alone.
        square: Rect,
    },
    /// An action rectangle of a step.
    Action {
        /// The step.
        step: u32,
        /// Which of its actions, from 0.
        index: u32,
    },
    /// A transition: bar, double lines, receptivity, label.
    Transition {
        /// Its number.
        transition: u32,
        /// The bar alone.
        bar: Rect,
        /// The text of the receptivity.
        text: Rect,
    },
    /// A directed link.
    Link {
        /// Index in the placement's links.
        link: u32,
        /// Where it comes from.
        from: End,
        /// Where it leads to.
        to: End,
    },
    /// A broken-off end of a link.
    Connector {
        /// Index in the placement's connectors.
        connector: u32,
        /// The link's own ends.
        from: End,
        /// Where it leads to.
        to: End,
        /// The end that goes away; else the one that arrives.
        leaving: bool,
    },
    /// A comment of the layout section.
    Comment {
        /// Its number among the comments of the chart's layout, from 0.
        comment: u32,
        /// The upper left corner of its text.
        place: Point,
    },
    /// A frame of a page, a title: nothing that can be edited as a symbol.
    Text,
}
