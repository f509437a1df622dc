//! Measures and sets text: the width of a line, its overlines, its breaks. It uses the advance
//! widths of the bundled font, so a picture fits its texts on every machine; all numbers are
//! integers.

mod duration;
mod expr;
mod line;
mod stmt;
mod widths;
mod words;

pub(crate) use duration::duration;
pub(crate) use expr::{receptivity, set};
pub(crate) use line::Line;
pub(crate) use stmt::body;
pub(crate) use words::{name_lines, shortened, wrap_words};

/// The width of a text at a size, both in hundredths of u.
pub fn width(text: &str, size: i32) -> i32 {
    let sum: i64 = text.chars().map(|c| i64::from(advance(c).unwrap_or_else(|| guess(c)))).sum();
    i32::try_from((sum * i64::from(size) + 999) / 1000).unwrap_or(i32::MAX / 4)
}

/// True if a text is no wider than `most`; stops reading as soon as the answer is known.
pub(crate) fn fits(text: &str, size: i32, most: i32) -> bool {
    let most = i64::from(most) * 1000;
    let mut sum = 0;
    text.trim_end().chars().all(|c| {
        sum += i64::from(advance(c).unwrap_or_else(|| guess(c))) * i64::from(size);
        sum <= most
    })
}

/// True if the bundled font has every character, so that the width is exact.
pub(crate) fn known(text: &str) -> bool {
    text.chars().all(|c| advance(c).is_some())
}

/// The advance width of a character in thousandths of the size.
fn advance(c: char) -> Option<u16> {
    let code = u32::from(c);
    let run = widths::RUNS.partition_point(|(first, _)| *first <= code).checked_sub(1)?;
    let (first, widths) = widths::RUNS.get(run)?;
    widths.get(usize::try_from(code - first).ok()?).copied()
}

/// An estimated width for a character that another font will draw.
fn guess(c: char) -> u16 {
    match u32::from(c) {
        0x300..=0x36F | 0x200B..=0x200F | 0xFE00..=0xFE0F => 0,
        0..=0x10FF => 650,
        _ => 1000,
    }
}

/// Text that may stand in a picture: one line without control characters.
pub(crate) fn clean(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\n' | '\t' | '\r' => ' ',
            c if c.is_control() || matches!(u32::from(c), 0xFFFE | 0xFFFF) => '\u{FFFD}',
            c => c,
        })
        .collect()
}

/// The embedded font, for the program that draws the texts.
pub fn font() -> &'static [u8] {
    include_bytes!("../../font/G7Sans-Regular.ttf")
}

/// The family name of the font.
pub const FONT_FAMILY: &str = "G7 Sans";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_widths_is_that_of_the_font() {
        let face = ttf_parser::Face::parse(font(), 0).expect("a font");
        assert_eq!(face.units_per_em(), 1000);
        let mut seen = 0;
        for (first, widths) in widths::RUNS {
            for (code, width) in (*first..).zip(*widths) {
                let glyph = char::from_u32(code).and_then(|c| face.glyph_index(c));
                assert_eq!(glyph.and_then(|g| face.glyph_hor_advance(g)), Some(*width), "{code:04X}");
                seen += 1;
            }
        }
        assert!(seen > 600, "{seen}");
        assert!(widths::RUNS.windows(2).all(|w| w[0].0 < w[1].0), "sorted");
    }

    #[test]
    fn every_sign_of_a_chart_is_in_the_font() {
        for c in "↑↓→←·+×≤≥≠⁰−–…“”\"'()[]{}<>=:;*/#%&|~^_°µΣαΩДяőŁßñçãéèêÅøæ€".chars()
        {
            assert!(known(&c.to_string()), "{c}");
        }
    }

    #[test]
    fn a_width_is_the_sum_of_the_advances_rounded_up() {
        assert_eq!(width("00", 140), 168, "digits are 600 wide: 2 · 0.6 · 140");
        assert_eq!(width("", 140), 0);
        assert_eq!(width("0", 131), 79, "78.6");
    }

    #[test]
    fn control_characters_never_reach_a_picture() {
        assert_eq!(clean("a\u{0}b\nc\u{7f}\u{85}"), "a\u{FFFD}b c\u{FFFD}\u{FFFD}");
    }
}
