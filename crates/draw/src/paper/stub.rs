//! Stubs: where links leave a sheet. An arrow, and beside it for each link the step at its other end and the sheet on
//! which it goes on.

use crate::ink::Picture;
use crate::symbols::{
    DOUBLE_GAP, SMALL, SQUARE, StepShape, TransitionShape, arrow, connector_label, connector_width,
};
use crate::{End, Extent, Rect};

/// A link that a stub stands for.
#[derive(Clone, Debug)]
pub(super) struct Token {
    pub(super) from: End,
    pub(super) to: End,
    /// The step at the other end, or beyond the transition there; may be empty.
    pub(super) name: String,
}

/// The end of links on a sheet.
#[derive(Clone, Debug)]
pub(super) struct Stub {
    /// True if the links go on elsewhere, false if they come from there.
    pub(super) leaving: bool,
    /// The stub draws the double line of its transition, since no other link of that side is drawn on this sheet.
    pub(super) double: bool,
    /// All links have one other end, which is named once.
    pub(super) once: bool,
    pub(super) tokens: Vec<Token>,
}

/// Greatest width of a line of names.
const WIDEST: i32 = 2200;
/// Distance from one line of names to the next.
const LEADING: i32 = 160;
/// Distance from the arrow to the names.
const ASIDE: i32 = 90;
/// Length of the arrow's line.
const LENGTH: i32 = 260;
/// Half the length of a double line.
const HALF: i32 = 100;

impl Stub {
    /// The symbol at the other end of the first link.
    pub(super) fn other(&self) -> Option<End> {
        self.tokens.first().map(|t| if self.leaving { t.to } else { t.from })
    }

    /// The labels of the links, on lines.
    fn lines(&self, page: &dyn Fn(End) -> usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let named = if self.once { 1 } else { self.tokens.len() };
        for t in self.tokens.iter().take(named) {
            let page = page(if self.leaving { t.to } else { t.from });
            let label = connector_label(&t.name, Some(u32::try_from(page).unwrap_or(u32::MAX)));
            let label = label.trim_start();
            match lines.last_mut() {
                Some(line) if connector_width(&format!("{line}, {label}")) <= WIDEST => {
                    line.push_str(", ");
                    line.push_str(label);
                }
                Some(line) => {
                    line.push(',');
                    lines.push(label.to_owned());
                }
                None => lines.push(label.to_owned()),
            }
        }
        lines
    }

    /// The width and height of the labels, whatever the sheets are.
    fn room(&self, digits: usize) -> (i32, i32) {
        // No figure is wider than 8, so no number of so many figures is wider.
        let widest = "8".repeat(digits).parse().unwrap_or(usize::MAX);
        let lines = self.lines(&|_| widest);
        let w = lines.iter().map(|l| connector_width(l)).max().unwrap_or(0);
        (w, LEADING * i32::try_from(lines.len()).unwrap_or(i32::MAX / LEADING - 1))
    }

    /// Its room in the place of a step.
    pub(super) fn step_extent(&self, digits: usize) -> Extent {
        let (w, h) = self.room(digits);
        let (up, down) =
            if self.leaving { (0, SQUARE.max(h + 60)) } else { ((h - SQUARE + 60).max(0), SQUARE) };
        Extent { left: HALF, right: ASIDE + w, up, down }
    }

    /// Its room in the place of a transition.
    pub(super) fn transition_extent(&self, digits: usize) -> Extent {
        let (w, h) = self.room(digits);
        let (up, down) = if self.leaving { (0, LENGTH.max(h + 60)) } else { (LENGTH.max(h + 60), 0) };
        Extent { left: HALF, right: ASIDE + w, up, down }
    }

    /// The stub in the place of a step, round the middle of its upper edge.
    pub(super) fn as_step(&self, page: &dyn Fn(End) -> usize) -> StepShape {
        let picture = self.picture(if self.leaving { 0 } else { SQUARE }, page);
        StepShape { picture, square: Rect::default(), actions: Vec::new(), extent: Extent::default() }
    }

    /// The stub in the place of a transition, round the middle of its bar.
    pub(super) fn as_transition(&self, page: &dyn Fn(End) -> usize) -> TransitionShape {
        let (bar, text) = (Rect::default(), Rect::default());
        TransitionShape { picture: self.picture(0, page), bar, text, extent: Extent::default() }
    }

    /// Draws it round the point at which the link of the drawing begins or ends.
    fn picture(&self, at: i32, page: &dyn Fn(End) -> usize) -> Picture {
        let mut p = Picture::default();
        let lines = self.lines(page);
        let high = LEADING * i32::try_from(lines.len()).unwrap_or(1);
        let gap = if self.double { DOUBLE_GAP } else { 0 };
        let (from, to, first) = if self.leaving {
            (at + gap, at + LENGTH, at + gap + 20)
        } else {
            (at - LENGTH, at - gap, at - gap - 20 - high)
        };
        p.line("g7-link", &[(0, from), (0, to)]);
        arrow(&mut p, (0, if self.leaving { to } else { to - 60 }).into(), (0, 1));
        if self.double {
            let top = if self.leaving { at } else { at - gap };
            p.line("g7-double", &[(-HALF, top), (HALF, top)]);
            p.line("g7-double", &[(-HALF, top + gap), (HALF, top + gap)]);
        }
        for (n, line) in (0..).zip(&lines) {
            p.text("g7-ref", ASIDE, first + n * LEADING + LEADING / 2 + SMALL * 35 / 100, SMALL, line);
        }
        p
    }
}
