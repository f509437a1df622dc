//! Drawings as standalone files: a style sheet, the font, and the items of one or several charts on
//! one sheet.

use std::fmt::Write as _;

use g7_model::Document;

use crate::ink::{Px, escape};
use crate::text::{FONT_FAMILY, font};
use crate::together::{Arranged, together};
use crate::{Drawing, Options, Part, Rect};

/// Margin round a standalone picture.
const MARGIN: i32 = 200;

/// The style sheet for the fragments: one rule for each class.
pub fn style(dark: bool) -> String {
    let (paper, ink, soft, accent) = if dark {
        ("#15181d", "#e8eaed", "#9aa4b2", "#b6c2d2")
    } else {
        ("#ffffff", "#16191d", "#5b6674", "#3d4956")
    };
    format!(
        ".g7{{font-family:\"{FONT_FAMILY}\",\"IBM Plex Sans\",sans-serif;font-kerning:none}}\
.g7 text{{fill:{ink};stroke:none;white-space:pre}}\
.g7 path,.g7 rect,.g7 circle{{fill:none;stroke:{ink};stroke-linejoin:miter}}\
.g7 .g7-paper{{fill:{paper};stroke:none}}\
.g7 .g7-box{{fill:{paper};stroke-width:1.7}}\
.g7 .g7-action{{fill:{paper};stroke-width:1.2}}\
.g7 .g7-inner{{stroke-width:1.2}}\
.g7 .g7-thin{{stroke-width:1.2}}\
.g7 .g7-link{{stroke-width:1.4}}\
.g7 .g7-double{{stroke-width:1.5}}\
.g7 .g7-sign{{stroke-width:1.7}}\
.g7 .g7-over{{stroke-width:1.1}}\
.g7 .g7-ring{{fill:{paper};stroke-width:1.1}}\
.g7 .g7-frame{{stroke:{soft};stroke-width:1}}\
.g7 .g7-grid{{stroke:{soft};stroke-width:.5;stroke-opacity:.5}}\
.g7 .g7-wave{{stroke-width:1.4}}\
.g7 .g7-active{{fill:{accent};fill-opacity:.2;stroke-width:1.2}}\
.g7 .g7-bar,.g7 .g7-mark{{fill:{ink};stroke:none}}\
.g7 .g7-note,.g7 .g7-label,.g7 .g7-ref{{fill:{soft}}}\
.g7 .g7-qual,.g7 .g7-cond{{fill:{accent}}}"
    )
}

/// Draws one chart as an SVG file.
pub fn svg(drawing: &Drawing, options: &Options) -> String {
    let mut out = String::new();
    open(&mut out, drawing.area, options, &drawing.chart);
    body(&mut out, drawing);
    out.push_str("</g></svg>\n");
    out
}

/// Draws several charts as one SVG file, each under its title: where their layout sections say, the others in rows.
pub fn sheet(document: &Document, drawings: &[Drawing], options: &Options) -> String {
    let arranged = together(document, drawings);
    let area = arranged.iter().map(|a| a.area).reduce(|all, area| all.union(&area));
    let names: Vec<&str> = drawings.iter().map(|d| &*d.chart).collect();
    let mut out = String::new();
    open(&mut out, area.unwrap_or_default(), options, &names.join(", "));
    for (d, Arranged { by, title, frame, .. }) in drawings.iter().zip(&arranged) {
        let _ = write!(out, "<g>{}{}</g>", title.svg(), frame.svg());
        let _ = write!(out, "<g transform=\"translate({} {})\">", Px(by.x), Px(by.y));
        body(&mut out, d);
        out.push_str("</g>");
    }
    out.push_str("</g></svg>\n");
    out
}

/// Wraps other SVG content as a file in the same style.
pub(crate) fn standalone(area: Rect, options: &Options, title: &str, body: &str) -> String {
    let mut out = String::new();
    open(&mut out, area, options, title);
    out.push_str(body);
    out.push_str("</g></svg>\n");
    out
}

/// Writes the head of a file up to and including the opening tag of the group `g7`.
fn open(out: &mut String, area: Rect, options: &Options, title: &str) {
    let (x, y) = (area.x - MARGIN, area.y - MARGIN);
    let (w, h) = (area.w + 2 * MARGIN, area.h + 2 * MARGIN);
    let (x, y, w, h) = (Px(x), Px(y), Px(w), Px(h));
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{x} {y} {w} {h}\" width=\"{w}\" height=\"{h}\" \
role=\"img\"><title>{}</title><style>",
        escape(title)
    );
    if options.font {
        let _ = write!(out, "{FontFace}");
    }
    let _ = write!(
        out,
        "{}</style><g class=\"g7\"><rect class=\"g7-paper\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>",
        style(options.dark)
    );
}

/// The rule of CSS that brings the font.
pub(crate) struct FontFace;

impl std::fmt::Display for FontFace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let font = base64(font());
        write!(f, "@font-face{{font-family:\"{FONT_FAMILY}\";src:url(data:font/ttf;base64,{font})}}")
    }
}

/// Writes the items, each in a group that says which part of the chart it is.
pub(crate) fn body(out: &mut String, drawing: &Drawing) {
    for item in &drawing.items {
        let part = match item.part {
            Part::Step { .. } => "step",
            Part::Action { .. } => "action",
            Part::Transition { .. } => "transition",
            Part::Link { .. } => "link",
            Part::Connector { .. } => "connector",
            Part::Comment { .. } => "comment",
            Part::Text => "text",
        };
        let _ = write!(out, "<g data-part=\"{part}\">{}</g>", item.picture.svg());
    }
}

/// Encodes bytes in base 64 (RFC 4648, section 4).
pub(crate) fn base64(bytes: &[u8]) -> String {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sign = |n: u32| char::from(SIGNS[(n & 63) as usize]);
    let mut out = String::with_capacity(bytes.len() / 3 * 4 + 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let n = byte(0) << 16 | byte(1) << 8 | byte(2);
        out.push(sign(n >> 18));
        out.push(sign(n >> 12));
        out.push(if three.len() > 1 { sign(n >> 6) } else { '=' });
        out.push(if three.len() > 2 { sign(n) } else { '=' });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_that_of_the_rfc() {
        let cases = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
