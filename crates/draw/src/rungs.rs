//! Ladder diagrams as pictures: rails, contacts, branches, blocks, coils (IEC 61131-3:2003, 4.2,
//! tables 58 to 61).
//!
//! ```text
//! logic of the text or of printed code -> Rung -> measure -> ink -> SVG
//! ```
//!
//! Power flows from left to right, rungs stand one below the other, coils stand at the right rail,
//! and no text covers another.

use crate::ink::Picture;
use crate::svg::standalone;
use crate::text::width;
use crate::{Options, Rect};

/// One rung.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rung {
    /// The heading over the rung.
    pub title: String,
    /// A remark under the title.
    pub note: String,
    /// The label that a jump can name.
    pub label: String,
    /// The elements, from left to right.
    pub elements: Vec<Element>,
}

/// An element on a wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Element {
    /// A contact: it passes power while its condition is true. Signs: `/`, `P`, `N`, or none.
    Contact {
        /// The sign between the bars.
        sign: &'static str,
        /// The name over the contact.
        text: String,
    },
    /// A coil: power acts on its variable. Signs: `/`, `S`, `R`, `P`, `N`, or none.
    Coil {
        /// The sign between the arcs.
        sign: &'static str,
        /// The name over the coil.
        text: String,
    },
    /// A function or function block.
    Block {
        /// The name over the box.
        title: String,
        /// The pin at which power enters.
        power: String,
        /// The other inputs: pin and the value it receives.
        inputs: Vec<(String, String)>,
        /// The pin at which power leaves.
        output: String,
        /// The other outputs: pin and the variable it writes.
        outputs: Vec<(String, String)>,
    },
    /// Parallel branches: power passes if one of them passes it.
    Branch(Vec<Vec<Element>>),
}

/// Size of names.
const TEXT: i32 = 120;
/// Size of titles.
const TITLE: i32 = 140;
/// Half the width of a contact or coil.
const HALF: i32 = 80;
/// Distance from the wire to the end of a contact.
const TALL: i32 = 100;
/// Least length of the wire on each side of an element.
const LEAD: i32 = 100;
/// Room above the wire for a contact with its name.
const UP: i32 = 280;
/// Room below the wire.
const DOWN: i32 = 140;
/// Distance between the pins of a block.
const PIN: i32 = 220;
/// Distance between two rungs.
const APART: i32 = 120;
/// Distance from the texts over a rung to the names of its elements.
const UNDER_TEXT: i32 = 60;
/// Least width of a rung.
const NARROW: i32 = 1600;

/// The room of an element: its width, and its height above and below the wire.
#[derive(Clone, Copy, Default)]
struct Room {
    wide: i32,
    up: i32,
    down: i32,
}

impl Element {
    fn room(&self) -> Room {
        match self {
            Element::Contact { text, .. } | Element::Coil { text, .. } => {
                Room { wide: width(text, TEXT).max(2 * HALF) + 2 * LEAD, up: UP, down: DOWN }
            }
            Element::Block { title, power, inputs, output, outputs } => {
                let rows = inputs.len().max(outputs.len()) as i32;
                let box_wide = block_width(title, power, inputs, output, outputs);
                let wide = box_wide + 2 * LEAD + outside(inputs) + outside(outputs);
                Room { wide, up: UP, down: DOWN + rows * PIN }
            }
            Element::Branch(ways) => {
                let mut all = Room::default();
                for (i, way) in ways.iter().enumerate() {
                    let own = room(way);
                    all.wide = all.wide.max(own.wide);
                    if i == 0 {
                        all = Room { up: own.up, down: own.down, ..all };
                    } else {
                        all.down += own.up + own.down;
                    }
                }
                Room { wide: all.wide + LEAD, ..all }
            }
        }
    }

    /// True if it stands at the right rail.
    fn is_end(&self) -> bool {
        match self {
            Element::Coil { .. } => true,
            Element::Branch(ways) => ways.iter().all(|w| !w.is_empty() && w.iter().all(Element::is_end)),
            Element::Contact { .. } | Element::Block { .. } => false,
        }
    }
}

fn room(way: &[Element]) -> Room {
    way.iter().map(Element::room).fold(Room { wide: 0, up: UP, down: DOWN }, |a, b| Room {
        wide: a.wide + b.wide,
        up: a.up.max(b.up),
        down: a.down.max(b.down),
    })
}

/// The width of the widest text beside a block's pins.
fn outside(pins: &[(String, String)]) -> i32 {
    pins.iter().map(|(_, text)| width(text, TEXT) + 60).max().unwrap_or(0)
}

fn block_width(
    title: &str,
    power: &str,
    inputs: &[(String, String)],
    output: &str,
    outputs: &[(String, String)],
) -> i32 {
    let widest = |first: &str, pins: &[(String, String)]| {
        pins.iter().map(|(pin, _)| width(pin, TEXT)).max().unwrap_or(0).max(width(first, TEXT))
    };
    (widest(power, inputs) + widest(output, outputs) + 220).max(width(title, TEXT) + 40).max(500)
}

/// Draws rungs as an SVG element that uses the page's style sheet.
pub fn rungs(list: &[Rung]) -> String {
    let (picture, area) = drawn("", list);
    let px = |n: i32| crate::ink::Px(n).to_string();
    format!(
        "<svg class=\"g7 g7-rungs\" viewBox=\"{} {} {w} {h}\" width=\"{w}\" height=\"{h}\">{}</svg>",
        px(area.x),
        px(area.y),
        picture.svg(),
        w = px(area.w),
        h = px(area.h),
    )
}

/// Draws rungs as an SVG file, under a title.
pub fn rungs_svg(title: &str, list: &[Rung], options: &Options) -> String {
    let (picture, area) = drawn(title, list);
    standalone(area, options, title, &picture.svg())
}

fn drawn(title: &str, list: &[Rung]) -> (Picture, Rect) {
    let right = list.iter().map(|r| room(&r.elements).wide + LEAD).max().unwrap_or(0).max(NARROW);
    let mut pen = Pen { picture: Picture::default(), right };
    let mut y = 0;
    if !title.is_empty() {
        y += 200;
        pen.picture.text("g7-name", 0, y, 180, title);
        y += 120;
    }
    for r in list {
        y = pen.rung(r, y);
    }
    let wide = pen.picture.area().map_or(right, |a| a.x + a.w).max(right);
    (pen.picture, Rect { x: -20, y: 0, w: wide + 40, h: y.max(1) })
}

struct Pen {
    picture: Picture,
    right: i32,
}

impl Pen {
    /// Draws a rung whose room begins at `y`; returns where the next one begins.
    fn rung(&mut self, r: &Rung, y: i32) -> i32 {
        let (top, mut y) = (y, y);
        for (text, size, class) in
            [(&r.title, TITLE, "g7-name"), (&r.note, TEXT, "g7-note"), (&r.label, TEXT, "g7-label")]
        {
            if !text.is_empty() {
                y += size + 60;
                let colon = if std::ptr::eq(text, &r.label) { ":" } else { "" };
                self.picture.text(class, 0, y, size, &format!("{text}{colon}"));
            }
        }
        let all = room(&r.elements);
        let wire = y + all.up + if y == top { 0 } else { UNDER_TEXT };
        let ends = r.elements.iter().rev().take_while(|e| e.is_end()).count();
        let (inner, outer) = r.elements.split_at(r.elements.len() - ends);
        let x = self.way(inner, 0, wire);
        let from = self.right - room(outer).wide;
        self.wire(x, from, wire);
        self.way(outer, from, wire);
        for x in [0, self.right] {
            self.picture.line("g7-sign", &[(x, wire - 180), (x, wire + all.down)]);
        }
        wire + all.down + APART
    }

    fn wire(&mut self, from: i32, to: i32, y: i32) {
        if to > from {
            self.picture.line("g7-link", &[(from, y), (to, y)]);
        }
    }

    /// Draws the elements of one wire; returns where it ends.
    fn way(&mut self, way: &[Element], x: i32, y: i32) -> i32 {
        let mut x = x;
        for e in way {
            let wide = e.room().wide;
            self.element(e, x, y, wide);
            x += wide;
        }
        x
    }

    fn element(&mut self, e: &Element, x: i32, y: i32, wide: i32) {
        let middle = x + wide / 2;
        match e {
            Element::Contact { sign, text } => {
                self.sides(x, wide, y);
                for side in [middle - HALF, middle + HALF] {
                    self.picture.line("g7-sign", &[(side, y - TALL), (side, y + TALL)]);
                }
                self.sign(sign, middle, y);
                self.centred(text, middle, y - TALL - 50);
            }
            Element::Coil { sign, text } => {
                self.sides(x, wide, y);
                for turn in [-1, 1] {
                    // An arc of a third of a circle.
                    let arc = [(-50, 100), (-72, 62), (-80, 0), (-72, -62), (-50, -100)];
                    let points = arc.map(|(dx, dy)| (middle - turn * dx, y + dy));
                    self.picture.line("g7-sign", &points);
                }
                self.sign(sign, middle, y);
                self.centred(text, middle, y - TALL - 50);
            }
            Element::Branch(ways) => self.branch(ways, x, y, wide),
            Element::Block { title, power, inputs, output, outputs } => {
                let own = block_width(title, power, inputs, output, outputs);
                let left = x + LEAD + outside(inputs);
                let right = left + own;
                let rows = inputs.len().max(outputs.len()) as i32;
                self.wire(x, left, y);
                self.wire(right, x + wide, y);
                self.picture.rect("g7-box", left, y - TALL, own, 2 * TALL + rows * PIN);
                self.centred(title, (left + right) / 2, y - TALL - 50);
                self.pin(power, left, y, true, None);
                self.pin(output, right, y, false, None);
                for (i, (pin, text)) in inputs.iter().enumerate() {
                    self.pin(pin, left, y + PIN * (i as i32 + 1), true, Some(text));
                }
                for (i, (pin, text)) in outputs.iter().enumerate() {
                    self.pin(pin, right, y + PIN * (i as i32 + 1), false, Some(text));
                }
            }
        }
    }

    fn branch(&mut self, ways: &[Vec<Element>], x: i32, y: i32, wide: i32) {
        let (left, right) = (x + LEAD / 2, x + wide - LEAD / 2);
        self.wire(x, left, y);
        self.wire(right, x + wide, y);
        let mut at = y;
        let mut below = 0;
        for (i, way) in ways.iter().enumerate() {
            let own = room(way);
            if i > 0 {
                at += below + own.up;
                self.picture.line("g7-link", &[(left, y), (left, at)]);
                self.picture.line("g7-link", &[(right, y), (right, at)]);
            }
            let end = self.way(way, left, at);
            self.wire(end, right, at);
            below = own.down;
        }
    }

    /// Draws the wire on both sides of a contact or coil.
    fn sides(&mut self, x: i32, wide: i32, y: i32) {
        let middle = x + wide / 2;
        self.wire(x, middle - HALF, y);
        self.wire(middle + HALF, x + wide, y);
    }

    fn sign(&mut self, sign: &str, middle: i32, y: i32) {
        if sign == "/" {
            self.picture.line("g7-sign", &[(middle - 50, y + TALL), (middle + 50, y - TALL)]);
        } else {
            self.centred(sign, middle, y + 45);
        }
    }

    fn centred(&mut self, text: &str, middle: i32, y: i32) {
        self.picture.text("g7-name", middle - width(text, TEXT) / 2, y, TEXT, text);
    }

    /// Draws a pin: its name inside the box, its value or variable outside.
    fn pin(&mut self, name: &str, x: i32, y: i32, left: bool, text: Option<&str>) {
        let own = width(name, TEXT);
        self.picture.text("g7-note", if left { x + 50 } else { x - 50 - own }, y + 45, TEXT, name);
        let Some(text) = text else { return };
        let (from, to) = if left { (x - 60, x) } else { (x, x + 60) };
        self.wire(from, to, y);
        let at = if left { from - width(text, TEXT) } else { to };
        self.picture.text("g7-name", at, y + 45, TEXT, text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(text: &str) -> Element {
        Element::Contact { sign: "", text: text.to_owned() }
    }

    fn coil(text: &str) -> Element {
        Element::Coil { sign: "S", text: text.to_owned() }
    }

    /// The texts of a drawing: characters, left end, base line.
    fn texts(r: &[Rung]) -> Vec<(String, i32, i32)> {
        let (picture, _) = drawn("", r);
        let text = |i: &crate::ink::Ink| match i {
            crate::ink::Ink::Text(_, at, _, t) => Some((t.clone(), at.x, at.y)),
            _ => None,
        };
        picture.ink.iter().filter_map(text).collect()
    }

    #[test]
    fn contacts_follow_one_another_and_ways_stand_below_one_another() {
        let ways = Element::Branch(vec![vec![contact("b")], vec![contact("c"), contact("d")]]);
        let elements = vec![contact("a"), ways, coil("q")];
        let found = texts(&[Rung { elements, ..Rung::default() }]);
        let at = |name: &str| found.iter().find(|t| t.0 == name).map(|t| (t.1, t.2)).expect(name);
        assert!(at("a").0 < at("b").0 && at("c").0 < at("d").0 && at("d").0 < at("q").0, "{found:?}");
        assert!(at("a").1 == at("b").1 && at("b").1 == at("q").1, "{found:?}");
        assert!(at("c").1 == at("d").1 && at("c").1 >= at("b").1 + UP, "{found:?}");
    }

    #[test]
    fn coils_stand_at_the_right_rail_of_the_widest_rung() {
        let long = (0..12).map(|_| contact("a_rather_long_name")).chain([coil("far")]).collect();
        let short = vec![contact("a"), coil("q")];
        let list = [long, short].map(|elements| Rung { elements, ..Rung::default() });
        let found = texts(&list);
        let middle = |name: &str| {
            let t = found.iter().find(|t| t.0 == name).expect(name);
            t.1 + width(name, TEXT) / 2
        };
        assert!((middle("far") - middle("q")).abs() < 100, "{found:?}");
    }

    #[test]
    fn no_name_covers_another() {
        let names = ["start_button_of_the_left_press", "b", "level.high > 12", "X1"];
        let elements = names.iter().map(|n| contact(n)).chain([coil("a_long_name_of_a_coil")]).collect();
        let mut found = texts(&[Rung { elements, ..Rung::default() }]);
        found.retain(|t| t.0.len() > 1 || t.0 == "b");
        found.sort_by_key(|t| t.1);
        for pair in found.windows(2) {
            assert!(pair[0].1 + width(&pair[0].0, TEXT) < pair[1].1, "{pair:?}");
        }
    }

    #[test]
    fn texts_stay_texts() {
        let elements = vec![contact("<script>"), coil("\"&\u{1}")];
        let svg = rungs(&[Rung { elements, ..Rung::default() }]);
        assert!(!svg.contains("<script") && svg.contains("&lt;script&gt;"), "{svg}");
    }
}
