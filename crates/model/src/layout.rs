//! The layout section of a chart: the places of symbols, the bends of links and the form in which they are drawn, how
//! the actions of a step stand, the place of the chart on a sheet of several, and the comments that belong to no symbol.
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

/// One entry of a layout section: a symbol and its place on the drawing, a link and its bends, or a form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlaceAt {
    /// The part of the drawing.
    pub what: Placed,
    /// The horizontal position, positive to the right, in hundredths of the drawing's unit; 0 where the entry gives
    /// no place.
    pub x: i32,
    /// The vertical position, positive downward, in hundredths of the drawing's unit; 0 where the entry gives no place.
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
    /// The form of a link, whose ends are as above; the entry gives no place.
    LinkForm(Box<(Placed, Placed)>, LinkForm),
    /// How the actions of a step stand, or those of all steps that have no entry of their own; the entry gives no place.
    Actions(Option<Box<Placed>>, ActionForm),
    /// The whole chart, on a sheet with the other charts of its file: the place of the origin of its drawing.
    Sheet,
}

/// How the actions of a step stand (IEC 60848, association of actions).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ActionForm {
    /// One below the other.
    #[default]
    Column,
    /// Side by side.
    Row,
}

impl ActionForm {
    /// Every form.
    pub const ALL: [ActionForm; 2] = [ActionForm::Column, ActionForm::Row];

    /// Its word in the text.
    pub const fn word(self) -> &'static str {
        match self {
            ActionForm::Column => "column",
            ActionForm::Row => "row",
        }
    }
}

/// The form in which the author wants a link drawn, whatever the layout would do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkForm {
    /// A line from its start to its end.
    Line,
    /// Broken off: an arrow at each end with the name of the step at the other (IEC 60848, reference of a link).
    Jump,
}

impl LinkForm {
    /// Every form.
    pub const ALL: [LinkForm; 2] = [LinkForm::Line, LinkForm::Jump];

    /// Its word in the text.
    pub const fn word(self) -> &'static str {
        match self {
            LinkForm::Line => "line",
            LinkForm::Jump => "jump",
        }
    }
}

impl Placed {
    /// The steps and transitions that the entry names: one of its own, or the two ends of a link.
    pub fn symbols(&self) -> impl Iterator<Item = &Placed> {
        let (one, other) = match self {
            Placed::Step(_) | Placed::Transition(_) | Placed::TransitionNumber(_) => (Some(self), None),
            Placed::Link(ends) | Placed::LinkForm(ends, _) => (Some(&ends.0), Some(&ends.1)),
            Placed::Actions(step, _) => (step.as_deref(), None),
            Placed::Comment(_) | Placed::Sheet => (None, None),
        };
        one.into_iter().chain(other)
    }

    /// The same, to change them.
    pub fn symbols_mut(&mut self) -> impl Iterator<Item = &mut Placed> {
        let (one, other) = match self {
            Placed::Link(ends) | Placed::LinkForm(ends, _) => (Some(&mut ends.0), Some(&mut ends.1)),
            Placed::Actions(step, _) => (step.as_deref_mut(), None),
            Placed::Comment(_) | Placed::Sheet => (None, None),
            symbol => (Some(symbol), None),
        };
        one.into_iter().chain(other)
    }

    /// True for an entry that gives a step or a transition its place.
    pub fn is_symbol(&self) -> bool {
        matches!(self, Placed::Step(_) | Placed::Transition(_) | Placed::TransitionNumber(_))
    }
    /// True if the entry gives a place, or places.
    pub fn has_place(&self) -> bool {
        !matches!(self, Placed::LinkForm(..) | Placed::Actions(..))
    }
}
