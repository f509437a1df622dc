//! Rungs as a picture: rails, contacts, coils, blocks, comments.

use std::fmt::Write;

use super::ladder::{Block, Coil, End, Ladder, Net, Rung};
use super::ld::size;

const WIDE: usize = 120;
const HIGH: usize = 56;
const LEFT: usize = 24;
const CONTACT: usize = 24;

/// The whole ladder as SVG.
pub(crate) fn draw(name: &str, l: &Ladder) -> String {
    let widest = l.rungs.iter().map(|r| size(&r.net).0 + if matches!(r.end, End::Block(_)) { 3 } else { 1 });
    let right = LEFT + widest.max().unwrap_or(1).max(4) * WIDE + 16;
    let mut d = Drawing { out: String::new(), right, y: 56 };
    d.text(LEFT, 28, "title", name);
    for r in &l.rungs {
        d.rung(r);
    }
    let high = d.y + 16;
    let style = "text{font-family:system-ui,sans-serif;font-size:12px;fill:#1d2733}.title{font-size:16px;font-weight:600}\
                 .head{font-weight:600}.note{fill:#5b6775}.name{text-anchor:middle}.sign{text-anchor:middle;font-weight:600}\
                 .pin{font-size:11px}path,rect{fill:none;stroke:#1d2733;stroke-width:1.5}.rail{stroke-width:3}";
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {high}\" width=\"{0}\" height=\"{high}\">\n\
         <style>{style}</style>\n<rect width=\"{0}\" height=\"{high}\" style=\"fill:#fff;stroke:none\"/>\n{1}</svg>\n",
        right + LEFT,
        d.out
    )
}

struct Drawing {
    out: String,
    right: usize,
    y: usize,
}

fn escape(text: &str) -> String {
    let fine = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(fine).collect::<String>().replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A name that fits between two contacts; the whole of it shows on pointing.
fn short(text: &str) -> String {
    match text.char_indices().nth(15) {
        Some((i, _)) if text.chars().count() > 16 => format!("{}…", text.get(..i).unwrap_or("")),
        _ => text.to_owned(),
    }
}

impl Drawing {
    fn text(&mut self, x: usize, y: usize, class: &str, text: &str) {
        let _ = writeln!(self.out, "<text x=\"{x}\" y=\"{y}\" class=\"{class}\">{}</text>", escape(text));
    }

    fn name(&mut self, x: usize, y: usize, text: &str) {
        let title =
            if short(text) == text { String::new() } else { format!("<title>{}</title>", escape(text)) };
        let _ = writeln!(
            self.out,
            "<text x=\"{x}\" y=\"{y}\" class=\"name\">{title}{}</text>",
            escape(&short(text))
        );
    }

    fn path(&mut self, d: &str) {
        let _ = writeln!(self.out, "<path d=\"{d}\"/>");
    }

    fn wire(&mut self, from: usize, to: usize, y: usize) {
        if to > from {
            self.path(&format!("M{from} {y}H{to}"));
        }
    }

    fn rung(&mut self, r: &Rung) {
        if !r.title.is_empty() {
            self.y += 16;
            self.text(LEFT, self.y, "head", &r.title);
            self.y += 20;
        }
        if !r.note.is_empty() {
            self.text(LEFT, self.y, "note", &r.note);
            self.y += 8;
        }
        let (columns, rows) = size(&r.net);
        let y = self.y + 32;
        self.net(&r.net, LEFT, y);
        let x = LEFT + columns * WIDE;
        let mut high = rows * HIGH;
        match &r.end {
            End::Coil(name, coil) => self.coil(name, *coil, x, y),
            End::Block(block) => high = high.max(self.block(block, x, y)),
        }
        let (top, bottom) = (y - 26, y + high - 24);
        for x in [LEFT, self.right] {
            let _ = writeln!(self.out, "<path class=\"rail\" d=\"M{x} {top}V{bottom}\"/>");
        }
        self.y = bottom + 18;
    }

    fn net(&mut self, net: &Net, x: usize, y: usize) {
        match net {
            Net::Wire => {}
            Net::Contact { name, negated } => {
                let (a, b) = (x + WIDE / 2 - CONTACT / 2, x + WIDE / 2 + CONTACT / 2);
                self.wire(x, a, y);
                self.wire(b, x + WIDE, y);
                self.path(&format!("M{a} {}V{}M{b} {}V{}", y - 10, y + 10, y - 10, y + 10));
                if *negated {
                    self.path(&format!("M{} {}L{} {}", a + 3, y + 10, b - 3, y - 10));
                }
                self.name(x + WIDE / 2, y - 15, name);
            }
            Net::Series(list) => {
                let mut x = x;
                for part in list {
                    self.net(part, x, y);
                    x += size(part).0 * WIDE;
                }
            }
            Net::Parallel(list) => {
                let wide = size(net).0 * WIDE;
                let mut at = y;
                for (i, part) in list.iter().enumerate() {
                    let own = size(part);
                    self.net(part, x, at);
                    self.wire(x + own.0 * WIDE, x + wide, at);
                    if i > 0 {
                        self.path(&format!("M{x} {y}V{at}M{} {y}V{at}", x + wide));
                    }
                    at += own.1 * HIGH;
                }
            }
        }
    }

    fn coil(&mut self, name: &str, coil: Coil, x: usize, y: usize) {
        let centre = self.right - WIDE / 2;
        let (a, b) = (centre - CONTACT / 2, centre + CONTACT / 2);
        self.wire(x, a, y);
        self.wire(b, self.right, y);
        self.path(&format!("M{} {}A14 14 0 0 0 {0} {}", a + 4, y - 10, y + 10));
        self.path(&format!("M{} {}A14 14 0 0 1 {0} {}", b - 4, y - 10, y + 10));
        self.name(centre, y - 15, name);
        let sign = match coil {
            Coil::Plain => return,
            Coil::Set => "S",
            Coil::Reset => "R",
        };
        self.text(centre, y + 4, "sign", sign);
    }

    /// A block; how high it is.
    fn block(&mut self, b: &Block, x: usize, y: usize) -> usize {
        let rows = b.inputs.len().max(usize::from(b.output.is_some()));
        let high = 24 * (rows + 1) + 8;
        let left = (x + WIDE).min(self.right - 2 * WIDE);
        let wide = WIDE - 8;
        self.wire(x, left, y);
        self.wire(left + wide, self.right, y);
        let _ =
            writeln!(self.out, "<rect x=\"{left}\" y=\"{}\" width=\"{wide}\" height=\"{high}\"/>", y - 12);
        self.text(
            left + wide / 2,
            y - 16,
            "name",
            &b.instance.as_ref().map_or(b.ty.clone(), |i| format!("{i}: {}", b.ty)),
        );
        self.text(left + 4, y + 4, "pin", "EN");
        self.text(left + wide - 28, y + 4, "pin", "ENO");
        for (i, (formal, operand)) in b.inputs.iter().enumerate() {
            let at = y + 24 * (i + 1);
            self.text(left + 4, at + 4, "pin", formal);
            self.wire(left - 8, left, at);
            let _ = writeln!(
                self.out,
                "<text x=\"{}\" y=\"{}\" style=\"text-anchor:end\">{}</text>",
                left - 12,
                at + 4,
                escape(&short(operand))
            );
        }
        if let Some((formal, to)) = &b.output {
            let at = y + 24;
            self.text(left + wide - 28, at + 4, "pin", formal);
            self.wire(left + wide, left + wide + 8, at);
            self.text(left + wide + 12, at + 4, "", to);
        }
        high + 16
    }
}
