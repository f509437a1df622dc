//! Steps: the square with its name, and the signs of the kind of step.

use g7_model::{ActionForm, Step, StepKind};

use crate::ink::{Picture, rise, stack};
use crate::symbols::action;
use crate::symbols::parts::{SMALL, SQUARE, extent, quoted};
use crate::text::{Line, clean, name_lines, shortened, width};
use crate::{Extent, Options, Rect};

/// A step round its anchor, the middle of the upper edge of its square.
#[derive(Clone, Debug)]
pub(crate) struct StepShape {
    /// The symbol, its comment included.
    pub(crate) picture: Picture,
    /// The square alone.
    pub(crate) square: Rect,
    /// Its actions: the number of each, and its picture.
    pub(crate) actions: Vec<(u32, Picture)>,
    /// The room of the whole symbol.
    pub(crate) extent: Extent,
}

/// Distance from the outer to the inner square of an initial step.
const INSET: i32 = 55;
/// Size of the corners that are cut off the square of an enclosing step.
const CORNER: i32 = 110;
/// Greatest width of a line of the comment.
const COMMENT: i32 = 2000;

pub(crate) fn step(step: &Step, form: ActionForm, options: &Options) -> StepShape {
    let mut picture = Picture::default();
    let inset = if step.initial { INSET } else { 0 };
    let fitted = name_lines(&step.name.text, SQUARE - 2 * inset - 50);
    // Rounded to whole u, so that widened squares stay on the grid.
    let w = ((fitted.width + 2 * inset + 50).max(SQUARE) + 99) / 100 * 100;
    let square = Rect { x: -w / 2, y: 0, w, h: SQUARE };
    outline(&mut picture, step, square, inset);
    name(&mut picture, &fitted.lines, fitted.size);
    if fitted.lines.concat().ends_with('…') {
        picture.title = Some(clean(&step.name.text));
    }
    beside(&mut picture, step, square);
    let shown = if options.actions { step.actions.as_slice() } else { &[] };
    let actions = action::actions(step, shown, square.x + w, form, options);
    let mut below = SQUARE;
    let mut right = square.x + w;
    for area in actions.iter().filter_map(|(_, p)| p.area()) {
        below = below.max(area.y + area.h);
        right = right.max(area.x + area.w);
    }
    remarks(&mut picture, step, square, (!actions.is_empty()).then_some(below));
    let areas = actions.iter().filter_map(|(_, p)| p.area()).chain(picture.area());
    let extent = extent(areas.collect::<Vec<_>>());
    StepShape { picture, square, actions, extent }
}

#[inline(never)]
fn outline(p: &mut Picture, step: &Step, s: Rect, inset: i32) {
    p.rect("g7-box", s.x, s.y, s.w, s.h);
    if inset > 0 {
        p.rect("g7-inner", s.x + inset, s.y + inset, s.w - 2 * inset, s.h - 2 * inset);
    }
    let (left, right, top, low) = (s.x + inset, s.x + s.w - inset, s.y + inset, s.y + s.h - inset);
    match &step.kind {
        StepKind::Macro(_) => {
            p.line("g7-inner", &[(left, top + 60), (right, top + 60)]);
            p.line("g7-inner", &[(left, low - 60), (right, low - 60)]);
        }
        StepKind::Enclosing => {
            let c = CORNER;
            p.line("g7-inner", &[(left, top + c), (left + c, top)]);
            p.line("g7-inner", &[(right - c, top), (right, top + c)]);
            p.line("g7-inner", &[(right, low - c), (right - c, low)]);
            p.line("g7-inner", &[(left + c, low), (left, low - c)]);
        }
        StepKind::Plain | StepKind::Entry | StepKind::Exit => {}
    }
}

/// Draws the name in the middle of the square.
#[inline(never)]
fn name(p: &mut Picture, lines: &[String], size: i32) {
    let cap = size * 698 / 1000;
    let leading = size * 118 / 100;
    let count = i32::try_from(lines.len()).unwrap_or(1);
    let first = (SQUARE + cap - leading * (count - 1)) / 2;
    for (i, line) in (0..).zip(lines) {
        p.text("g7-name", -width(line, size) / 2, first + i * leading, size, line);
    }
}

/// Draws the signs at the left of the square: the activation link, and the marks of an entry or
/// exit step whose name does not begin with the standard's letter.
#[inline(never)]
fn beside(p: &mut Picture, step: &Step, s: Rect) {
    let mark = match step.kind {
        StepKind::Entry if !step.name.text.starts_with('E') => "E",
        StepKind::Exit if !step.name.text.starts_with('S') => "S",
        StepKind::Entry | StepKind::Exit | StepKind::Plain | StepKind::Macro(_) | StepKind::Enclosing => "",
    };
    p.text("g7-label", s.x - 60 - width(mark, SMALL), s.y + 100, SMALL, mark);
    if step.linked {
        let size = 240;
        p.text("g7-name", s.x - 50 - width("*", size), s.y + SQUARE / 2 + size * 48 / 100, size, "*");
    }
}

/// Draws the comment and the expansion of a macro-step: at the right of a square without actions,
/// otherwise below the actions.
#[inline(never)]
fn remarks(p: &mut Picture, step: &Step, s: Rect, actions: Option<i32>) {
    let mut lines = Vec::new();
    if let StepKind::Macro(of) = &step.kind
        && of.text != step.name.text
    {
        lines.push(Line::plain(format!("= {}", shortened(&clean(&of.text), SMALL, COMMENT).0)));
    }
    if let Some(comment) = step.comment.as_deref().filter(|c| !c.trim().is_empty()) {
        let (set, whole) = quoted(comment, COMMENT, 3);
        lines.extend(set);
        if !whole {
            p.title = Some(comment.to_owned());
        }
    }
    let Some(first) = lines.first() else { return };
    let (up, height) = stack(&lines, SMALL);
    let top = match actions {
        Some(low) => (low + 50).max(rise(first, SMALL)),
        None => (SQUARE - height) / 2,
    };
    let x = match actions {
        Some(_) => s.x + s.w + action::GAP,
        None => s.x + s.w + 90,
    };
    p.lines("g7-note", (x, top + up), SMALL, &lines);
}
