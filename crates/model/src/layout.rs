//! The layout section of a chart: the places of symbols, the bends of links and the comments that belong to no
//! symbol.
//!
//! `draw` applies it to the automatic layout; `edit` writes it. An entry that names nothing of the chart is without
//! effect.

use crate::{Name, Place};

/// `layout Conveyor { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The chart.
    pub chart: Name,
    /// The places.
    pub places: Vec<PlaceAt>,
    /// Where it stands.
    pub at: Place,
}

impl Layout {
    /// True if a chart counts as drawn by hand: more than half of its steps and transitions have a place.
    pub fn is_by_hand(placed: usize, symbols: usize) -> bool {
        placed * 2 > symbols
    }
}

/// One entry of a layout section: a symbol and its place on the drawing, or a link and its bends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlaceAt {
    /// The part of the drawing.
    pub what: Placed,
    /// The horizontal position, positive to the right, in hundredths of the drawing's unit.
    pub x: i32,
    /// The vertical position, positive downward, in hundredths of the drawing's unit.
    pub y: i32,
    /// The bends of a link behind the first one, which is at `x` and `y`; empty for anything else.
    pub then: Vec<(i32, i32)>,
    /// Where it stands.
    pub at: Place,
}

/// The part of the drawing that an entry of a layout section is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Placed {
    /// A step by name.
    Step(Name),
    /// A transition by label.
    Transition(Name),
    /// A transition by its place in the text of the chart, from 0.
    TransitionNumber(u32),
    /// A comment by its text.
    Comment(Box<str>),
    /// A link by the step and the transition that it joins, its start first.
    Link(Box<(Placed, Placed)>),
}

impl Placed {
    /// The steps and transitions that the entry names: one of its own, or the two ends of a link.
    pub fn symbols(&self) -> impl Iterator<Item = &Placed> {
        let (one, other) = match self {
            Placed::Step(_) | Placed::Transition(_) | Placed::TransitionNumber(_) => (Some(self), None),
            Placed::Link(ends) => (Some(&ends.0), Some(&ends.1)),
            Placed::Comment(_) => (None, None),
        };
        one.into_iter().chain(other)
    }

    /// The same, to change them.
    pub fn symbols_mut(&mut self) -> impl Iterator<Item = &mut Placed> {
        let (one, other) = match self {
            Placed::Link(ends) => (Some(&mut ends.0), Some(&mut ends.1)),
            Placed::Comment(_) => (None, None),
            symbol => (Some(symbol), None),
        };
        one.into_iter().chain(other)
    }

    /// True for an entry that gives a step or a transition its place.
    pub fn is_symbol(&self) -> bool {
        matches!(self, Placed::Step(_) | Placed::Transition(_) | Placed::TransitionNumber(_))
    }
}
