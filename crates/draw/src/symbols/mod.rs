//! The symbols of IEC 60848 round their anchors, in hundredths of u.

mod action;
mod connector;
mod note;
mod parts;
mod step;
mod transition;

pub(crate) use connector::{arrow, connector, connector_label, connector_width};
pub(crate) use note::{note, note_area};
pub(crate) use parts::{DOUBLE_GAP, SMALL, SQUARE};
pub(crate) use step::{StepShape, step};
pub(crate) use transition::{TransitionShape, double, transition, widest};
