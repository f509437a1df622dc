//! Converts between bytes of a text, UTF-16 code units, and lines with columns.

/// The places of one text.
#[derive(Clone, Debug, Default)]
pub struct Positions {
    /// For each line: its first byte and its first code unit.
    lines: Vec<(usize, usize)>,
    units: usize,
    ascii: bool,
}

impl Positions {
    /// The places of a text.
    pub fn new(text: &str) -> Positions {
        let ascii = text.is_ascii();
        let mut lines = vec![(0, 0)];
        let mut units = 0;
        if ascii {
            lines.extend(text.match_indices('\n').map(|(i, _)| (i + 1, i + 1)));
            units = text.len();
        } else {
            for (i, c) in text.char_indices() {
                units += c.len_utf16();
                if c == '\n' {
                    lines.push((i + 1, units));
                }
            }
        }
        Positions { lines, units, ascii }
    }

    /// The length of the text in code units.
    pub fn units(&self) -> usize {
        self.units
    }

    /// The code unit at a byte; a byte inside a character counts as its start.
    pub fn unit(&self, text: &str, byte: usize) -> usize {
        if self.ascii {
            return byte.min(self.units);
        }
        let line = self.lines.partition_point(|(b, _)| *b <= byte).saturating_sub(1);
        let (start, unit) = self.lines.get(line).copied().unwrap_or_default();
        let rest = text.get(start..).unwrap_or("");
        let before = rest.char_indices().take_while(|(i, c)| start + i + c.len_utf8() <= byte);
        unit + before.map(|(_, c)| c.len_utf16()).sum::<usize>()
    }

    /// The byte at a code unit; a code unit inside a character counts as its start.
    pub fn byte(&self, text: &str, unit: usize) -> usize {
        if self.ascii {
            return unit.min(self.units);
        }
        let line = self.lines.partition_point(|(_, u)| *u <= unit).saturating_sub(1);
        let (mut byte, mut at) = self.lines.get(line).copied().unwrap_or_default();
        for c in text.get(byte..).unwrap_or("").chars() {
            if at + c.len_utf16() > unit {
                break;
            }
            at += c.len_utf16();
            byte += c.len_utf8();
        }
        byte
    }

    /// The line of a byte, from 0, and the number of UTF-16 code units before it on its line.
    pub fn line_unit(&self, text: &str, byte: usize) -> (usize, usize) {
        let line = self.lines.partition_point(|(b, _)| *b <= byte).saturating_sub(1);
        let (_, first) = self.lines.get(line).copied().unwrap_or_default();
        (line, self.unit(text, byte).saturating_sub(first))
    }

    /// The byte at a line, from 0, and a number of UTF-16 code units on it. A place beyond the end of
    /// a line is that end.
    pub fn at_line_unit(&self, text: &str, line: usize, unit: usize) -> usize {
        let Some((start, first)) = self.lines.get(line).copied() else { return text.len() };
        let end = self.lines.get(line + 1).map_or(text.len(), |(next, _)| next - 1);
        self.byte(text, first.saturating_add(unit)).clamp(start, end)
    }

    /// The line and the column of a byte, both from 1; the column counts characters.
    pub fn line_column(&self, text: &str, byte: usize) -> (usize, usize) {
        let line = self.lines.partition_point(|(b, _)| *b <= byte).saturating_sub(1);
        let (start, _) = self.lines.get(line).copied().unwrap_or_default();
        let rest = text.get(start..).unwrap_or("");
        let column = rest.char_indices().take_while(|(i, c)| start + i + c.len_utf8() <= byte).count();
        (line + 1, column + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_bytes_turn_into_each_other() {
        let text = "a\u{305}·b\n😀x\nhöger";
        let p = Positions::new(text);
        assert_eq!(p.units(), text.encode_utf16().count());
        for (byte, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let unit = text[..byte].encode_utf16().count();
            assert_eq!(p.unit(text, byte), unit, "byte {byte}");
            assert_eq!(p.byte(text, unit), byte, "unit {unit}");
        }
        let smile = text.find('😀').unwrap();
        assert_eq!(p.byte(text, p.unit(text, smile) + 1), smile, "half of a pair: the character's start");
        assert_eq!(p.unit(text, smile + 2), p.unit(text, smile));
        assert_eq!(p.byte(text, 999), text.len());
        assert_eq!(p.unit(text, 999), p.units());
        assert_eq!(p.line_column(text, text.find('g').unwrap()), (3, 3));
        assert_eq!(p.line_unit(text, text.find('x').unwrap()), (1, 2), "😀 has two units");
        assert_eq!(p.at_line_unit(text, 1, 2), text.find('x').unwrap());
        assert_eq!(p.at_line_unit(text, 1, 99), text.find("\nh").unwrap(), "beyond the line: its end");
        assert_eq!(p.at_line_unit(text, 9, 0), text.len());
    }
}
