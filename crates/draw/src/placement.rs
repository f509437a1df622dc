//! Where the symbols of a chart stand and how its links run: the result of the layout. Nothing here
//! depends on how a symbol looks.

use g7_model::LinkForm;

use crate::{Extent, Point, Rect};

/// The room that each symbol needs, in the order of the text of the chart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// The room of each step, with its actions and comment.
    pub steps: Vec<Extent>,
    /// The room of each transition, with its receptivity, label and comment.
    pub transitions: Vec<Extent>,
    /// For each step the width of a connector's text that names it.
    pub connectors: Vec<i32>,
}

/// One end of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// A step, by its number in the text of the chart, from 0.
    Step(u32),
    /// A transition, by its number in the text of the chart, from 0.
    Transition(u32),
}

/// A directed link between a step and a transition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// The end at which it starts.
    pub from: End,
    /// The end at which it arrives.
    pub to: End,
    /// The corners, from first to last; each segment is horizontal or vertical.
    pub points: Vec<Point>,
    /// Points at which an arrow is needed, with the direction (dx, dy) of the arrow: links that run
    /// upward need one (IEC 60848, directed links).
    pub arrows: Vec<(Point, (i8, i8))>,
    /// How many segments at its start and at its end no bend moves; `None` if those between cannot be moved or there
    /// are none.
    pub held: Option<[usize; 2]>,
    /// The bends that the layout section gives it.
    pub bends: Bends,
    /// The form that the layout section gives it.
    pub form: Option<LinkForm>,
}

impl Link {
    /// A link whose way is that of the layout.
    pub(crate) fn new(from: End, to: End, points: Vec<Point>, arrows: Vec<(Point, (i8, i8))>) -> Link {
        Link { from, to, points, arrows, held: None, bends: Bends::None, form: None }
    }
}

/// How a link takes the bends that the layout section gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Bends {
    /// There are none: it goes the way of the layout.
    #[default]
    None,
    /// It follows them.
    Followed,
    /// They do not fit at present, so it goes the way of the layout.
    Waived,
}

/// A double line (IEC 60848, synchronisation) above or below a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Bar {
    /// The transition that it belongs to.
    pub transition: u32,
    /// True above the transition (several preceding steps), false below it.
    pub join: bool,
    /// Left end of the upper line.
    pub at: Point,
    /// Length.
    pub w: i32,
}

/// One end of a link that is not drawn in full; it shows the name of the other end.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Connector {
    /// The start of the whole link.
    pub from: End,
    /// The end of the whole link.
    pub to: End,
    /// True at the start of the link (the connector names the step or transition that the link
    /// leads to), false at its end.
    pub leaving: bool,
    /// The tip of its arrow.
    pub at: Point,
    /// The drawn part of the link, up to the tip; if empty, a short piece above the tip is drawn.
    pub points: Vec<Point>,
    /// The box of its text, to the right of the arrow.
    pub text: Rect,
    /// The form that the layout section gives the link.
    pub form: Option<LinkForm>,
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
    /// The links that are drawn in full.
    pub links: Vec<Link>,
    /// The ends of the links that are broken.
    pub connectors: Vec<Connector>,
    /// The bounding box of everything, texts included.
    pub area: Rect,
}
