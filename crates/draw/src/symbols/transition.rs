//! Transitions: bar, receptivity, name, priority, action on clearing.

use g7_model::Transition;

use crate::ink::{Picture, stack};
use crate::symbols::action;
use crate::symbols::parts::{ACTION_TEXT, DOUBLE_GAP, HALF_BAR, SMALL, TEXT, extent, quoted};
use crate::text::{Line, body, clean, receptivity, shortened, width};
use crate::{Bar, Extent, Point, Rect};

/// A transition round its anchor, the middle of its bar.
#[derive(Clone, Debug)]
pub(crate) struct TransitionShape {
    /// The symbol with its texts, without double lines.
    pub(crate) picture: Picture,
    /// The bar alone.
    pub(crate) bar: Rect,
    /// The box of the receptivity's text.
    pub(crate) text: Rect,
    /// The room of the whole symbol.
    pub(crate) extent: Extent,
}

/// Half the thickness of the bar.
const HALF: i32 = 18;
/// Distance from the bar to the receptivity.
const GAP: i32 = 80;
/// Greatest width of a line of a receptivity, by the number of alternatives it stands among:
/// branches side by side are as wide as their texts.
const WIDEST: [i32; 3] = [3200, 2000, 1500];
/// Most lines of a receptivity.
const LINES: usize = 10;

/// The greatest width of a line among this many alternatives.
pub(crate) fn widest(alternatives: usize) -> i32 {
    let [alone, of_two, of_many] = WIDEST;
    match alternatives {
        0 | 1 => alone,
        2 => of_two,
        _ => of_many,
    }
}

/// Draws a transition; lines are no wider than `widest` where they can be broken.
#[inline(never)]
pub(crate) fn transition(t: &Transition, widest: i32) -> TransitionShape {
    let mut p = Picture::default();
    let bar = Rect { x: -HALF_BAR, y: -HALF, w: 2 * HALF_BAR, h: 2 * HALF };
    p.rect("g7-bar", bar.x, bar.y, bar.w, bar.h);
    let text = condition(&mut p, t, widest);
    let mut low = text.y + text.h;
    if let Some(block) = &t.on_clearing {
        low = clearing(&mut p, &body(&block.statements), low);
    }
    if let Some(comment) = t.comment.as_deref().filter(|c| !c.trim().is_empty()) {
        let (lines, whole) = quoted(comment, 2600, 3);
        let (up, _) = stack(&lines, SMALL);
        p.lines("g7-note", (HALF_BAR + GAP, low + 20 + up), SMALL, &lines);
        if !whole {
            p.title = Some(comment.to_owned());
        }
    }
    if let Some(label) = &t.label {
        let label = format!("({})", shortened(&clean(&label.text), SMALL, 1600).0);
        p.text("g7-label", -HALF_BAR - GAP - width(&label, SMALL), SMALL * 35 / 100, SMALL, &label);
    }
    if let Some(n) = t.priority {
        priority(&mut p, n);
    }
    let extent = extent(p.area());
    TransitionShape { picture: p, bar, text, extent }
}

/// Draws the receptivity, its lines centred at the height of the bar.
#[inline(never)]
fn condition(p: &mut Picture, t: &Transition, widest: i32) -> Rect {
    let full = receptivity(&t.receptivity);
    let linear = full.linear();
    let mut lines = full.wrap(TEXT, widest);
    if lines.len() > LINES {
        lines.truncate(LINES);
        if let Some(last) = lines.last_mut() {
            last.text.push_str(" …");
        }
    }
    if lines.iter().any(Line::is_cut) {
        p.title = Some(linear);
    }
    let x = HALF_BAR + GAP;
    let (up, height) = stack(&lines, TEXT);
    // A single line is centred at the height of its capitals.
    let first = if lines.len() == 1 { TEXT * 35 / 100 } else { up - height / 2 };
    p.lines("g7-expr", (x, first), TEXT, &lines);
    let w = lines.iter().map(|l| l.width(TEXT)).max().unwrap_or(0);
    Rect { x, y: first - up, w, h: height }
}

/// Draws the stored action on clearing, which hangs from the right end of the bar.
#[inline(never)]
fn clearing(p: &mut Picture, lines: &[Line], below: i32) -> i32 {
    let (lines, title) = action::limited(lines);
    let (up, height) = stack(&lines, ACTION_TEXT);
    let w = lines.iter().map(|l| l.width(ACTION_TEXT)).max().unwrap_or(0) + 160;
    let h = (height + 100).max(260);
    let (x, y) = (HALF_BAR + GAP + 60, below + 70);
    let middle = y + h / 2;
    p.line("g7-thin", &[(HALF_BAR - 8, 0), (HALF_BAR - 8, middle), (x, middle)]);
    p.shape("g7-mark", &[(x, middle), (x - 80, middle - 36), (x - 80, middle + 36)]);
    p.rect("g7-action", x, y, w, h);
    p.lines("g7-act", (x + 80, y + (h - height) / 2 + up), ACTION_TEXT, &lines);
    if title.is_some() {
        p.title = title;
    }
    y + h
}

/// Draws the priority: a number in a circle over the left half of the bar.
fn priority(p: &mut Picture, n: u32) {
    let text = n.to_string();
    let size = if text.len() > 1 { 90 } else { 110 };
    let w = width(&text, size);
    let r = (w / 2 + 25).max(75);
    let (x, y) = (-50 - r, -HALF - 30 - r);
    p.circle("g7-ring", x, y, r);
    p.text("g7-num", x - w / 2, y + size * 35 / 100, size, &text);
}

/// Draws the two lines of a synchronisation, and the link between them and the bar.
#[inline(never)]
pub(crate) fn double(p: &mut Picture, bar: &Bar, at: Point) {
    // Links end at the double line, so that none shows between its two lines.
    let (x, y, right, low) = (bar.at.x, bar.at.y, bar.at.x + bar.w, bar.at.y + DOUBLE_GAP);
    p.shape("g7-paper", &[(x, y), (right, y), (right, low), (x, low)]);
    for y in [bar.at.y, bar.at.y + DOUBLE_GAP] {
        p.line("g7-double", &[(bar.at.x, y), (bar.at.x + bar.w, y)]);
    }
    let near = if bar.join { bar.at.y + DOUBLE_GAP } else { bar.at.y };
    p.line("g7-link", &[(at.x, near.min(at.y)), (at.x, near.max(at.y))]);
}
