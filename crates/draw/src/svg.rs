//! Drawings as files of their own: a style sheet, the font, the items.

use std::fmt::Write as _;

use crate::ink::{Px, escape};
use crate::text::{FONT_FAMILY, font};
use crate::{Drawing, Options, Part, Rect};

/// Round a standalone picture.
const MARGIN: i32 = 200;

/// The style sheet of the fragments: what each class looks like.
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
.g7 .g7-bar,.g7 .g7-mark{{fill:{ink};stroke:none}}\
.g7 .g7-note,.g7 .g7-label,.g7 .g7-ref{{fill:{soft}}}\
.g7 .g7-qual,.g7 .g7-cond{{fill:{accent}}}"
    )
}

/// One chart as an SVG file.
pub fn svg(drawing: &Drawing, options: &Options) -> String {
    let mut out = String::new();
    let area = drawing.area;
    open(&mut out, area, options, &drawing.chart);
    body(&mut out, drawing);
    out.push_str("</g></svg>\n");
    out
}

/// The head of a file up to the open group `g7`.
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
        let _ = write!(
            out,
            "@font-face{{font-family:\"{FONT_FAMILY}\";src:url(data:font/ttf;base64,{})}}",
            base64(font())
        );
    }
    let _ = write!(
        out,
        "{}</style><g class=\"g7\"><rect class=\"g7-paper\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>",
        style(options.dark)
    );
}

/// The items, each in a group that says what it is.
fn body(out: &mut String, drawing: &Drawing) {
    for item in &drawing.items {
        let part = match item.part {
            Part::Step { .. } => "step",
            Part::Action { .. } => "action",
            Part::Transition { .. } => "transition",
            Part::Link { .. } => "link",
            Part::Connector { .. } => "connector",
            Part::Text => "text",
        };
        let _ = write!(out, "<g data-part=\"{part}\">{}</g>", item.svg);
    }
}

/// Bytes in base 64 (RFC 4648, 4).
fn base64(bytes: &[u8]) -> String {
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
    use super::base64;

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
