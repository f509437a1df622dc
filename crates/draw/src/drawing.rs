//! The drawing of a chart: a list of items, each with its bounding box and its strokes.
//!
//! The page selects the items in view by their boxes and shows the SVG of their strokes, so it needs no
//! knowledge of symbols. `svg` prints all items.

use g7_model::{LinkForm, Span};

use crate::{Bends, End, Picture, Point, Rect};

/// The drawing of one chart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drawing {
    /// The name of the chart.
    pub chart: Box<str>,
    /// The smallest box that holds the whole drawing.
    pub area: Rect,
    /// The items, in the order of painting.
    pub items: Vec<Item>,
}

/// A part of the drawing that the user can point at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Which part of the chart the item shows.
    pub part: Part,
    /// The bounding box of the item, texts included.
    pub area: Rect,
    /// The strokes of the symbol.
    pub picture: Picture,
    /// The place of this part in the text of the file; empty if it has none.
    pub at: Span,
}

impl Drawing {
    /// Puts another drawing beside the items that are there, moved by a vector.
    pub(crate) fn add(&mut self, other: Drawing, by: Point) {
        let area = shifted(other.area, by);
        self.area = if self.items.is_empty() { area } else { self.area.union(&area) };
        self.items.extend(other.items.into_iter().map(|item| item.moved(by)));
    }
}

impl Item {
    /// The item, shifted by a vector.
    #[must_use]
    pub fn moved(self, by: Point) -> Item {
        let part = match self.part {
            Part::Step { step, square } => Part::Step { step, square: shifted(square, by) },
            Part::Transition { transition, bar, text } => {
                Part::Transition { transition, bar: shifted(bar, by), text: shifted(text, by) }
            }
            Part::Comment { comment, place } => {
                Part::Comment { comment, place: Point { x: place.x + by.x, y: place.y + by.y } }
            }
            part @ (Part::Action { .. } | Part::Link { .. } | Part::Connector { .. } | Part::Text) => part,
        };
        Item { part, area: shifted(self.area, by), picture: self.picture.moved(by), at: self.at }
    }
}

fn shifted(r: Rect, by: Point) -> Rect {
    Rect { x: r.x + by.x, y: r.y + by.y, ..r }
}

/// Which part of a chart an item shows. Steps and transitions are numbered from 0 in the order of
/// the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// A step without its actions.
    Step {
        /// The number of the step.
        step: u32,
        /// The square alone.
        square: Rect,
    },
    /// An action rectangle of a step.
    Action {
        /// The number of the step.
        step: u32,
        /// The number of the action among those of its step, from 0.
        index: u32,
    },
    /// A transition: the bar, the double lines, the receptivity and the label.
    Transition {
        /// The number of the transition.
        transition: u32,
        /// The bar alone.
        bar: Rect,
        /// The box of the receptivity's text.
        text: Rect,
    },
    /// A directed link.
    Link {
        /// Index in the placement's links.
        link: u32,
        /// The end at which the link starts.
        from: End,
        /// The end at which the link arrives.
        to: End,
        /// How many segments at its start and at its end no bend moves; `None` if none can be moved.
        held: Option<[usize; 2]>,
        /// The bends that the layout section gives it.
        bends: Bends,
        /// The form that the layout section gives it.
        form: Option<LinkForm>,
    },
    /// One end of a link that is not drawn in full, with the name of its other end.
    Connector {
        /// Index in the placement's connectors.
        connector: u32,
        /// The start of the whole link.
        from: End,
        /// The end of the whole link.
        to: End,
        /// True at the start of the link, false at its end.
        leaving: bool,
        /// The form that the layout section gives the link.
        form: Option<LinkForm>,
    },
    /// A comment from the layout section.
    Comment {
        /// Its number among the comments of the chart's layout section, from 0.
        comment: u32,
        /// The upper left corner of its text.
        place: Point,
    },
    /// A page frame or a title; it cannot be edited as a symbol.
    Text,
}
