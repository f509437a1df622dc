//! Where the symbols of one chart stand and how its links run: what the layout
//! hands to the symbols. Nothing here knows how a symbol looks.

use crate::{Extent, Point, Rect};

/// How much room each symbol needs, in the order of the text of the chart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Of each step, with its actions and comment.
    pub steps: Vec<Extent>,
    /// Of each transition, with its receptivity, label and comment.
    pub transitions: Vec<Extent>,
    /// Width of the text of a connector that names this step.
    pub connectors: Vec<i32>,
}

/// One end of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// A step, by its number in the text of the chart, from 0.
    Step(u32),
    /// A transition, likewise.
    Transition(u32),
}

/// A directed link between a step and a transition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Where it comes from.
    pub from: End,
    /// Where it leads to.
    pub to: End,
    /// Corners, first to last; each piece is horizontal or vertical.
    pub points: Vec<Point>,
    /// Points at which an arrow is needed, with the direction (dx, dy) it points
    /// to: links that run upward (IEC 60848, directed links).
    pub arrows: Vec<(Point, (i8, i8))>,
}

/// A double line (IEC 60848, synchronisation) above or below a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Bar {
    /// The transition it belongs to.
    pub transition: u32,
    /// Above the transition (several preceding steps), else below.
    pub join: bool,
    /// Left end of the upper line.
    pub at: Point,
    /// Length.
    pub w: i32,
}

/// A link that is broken off and named at both ends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Connector {
    /// The link's own ends.
    pub from: End,
    /// Where it leads to.
    pub to: End,
    /// Stands at the end that goes away (a source connector names the step or
    /// transition it leads to); false at the end that arrives.
    pub leaving: bool,
    /// The tip of its arrow.
    pub at: Point,
    /// What is left of the link, to the tip; where empty, a short piece above it.
    pub points: Vec<Point>,
    /// The box of its text, to the right of the arrow.
    pub text: Rect,
}

/// A laid-out chart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Placement {
    /// Anchor of each step: the middle of the upper edge of its square.
    pub steps: Vec<Point>,
    /// Anchor of each transition: the middle of its bar.
    pub transitions: Vec<Point>,
    /// The double lines.
    pub bars: Vec<Bar>,
    /// The links that are drawn.
    pub links: Vec<Link>,
    /// The links that are not.
    pub connectors: Vec<Connector>,
    /// What all of it covers, texts included.
    pub area: Rect,
}
