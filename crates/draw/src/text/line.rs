//! A line of set text: characters, overlines over parts of it, and places where it may break.

use crate::text::{fits, shortened, width};

/// A line of set text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Line {
    /// Its characters.
    pub(crate) text: String,
    /// The overlines, inner ones first.
    pub(crate) overs: Vec<Over>,
    /// The places where it may break, in the order of the text.
    pub(crate) breaks: Vec<Break>,
    /// The width of its indent.
    pub(crate) indent: i32,
}

/// An overline: the complement of the text under it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Over {
    /// The first byte of the text under it.
    pub(crate) from: usize,
    /// One past the last byte of that text.
    pub(crate) to: usize,
    /// The height: 1 close to the text, one more above each overline that it covers.
    pub(crate) level: u32,
}

/// A place where the line may break.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Break {
    /// The byte with which the next line begins.
    pub(crate) at: usize,
    /// The depth of the operator, 0 for the outermost; a break at a lower depth is better.
    pub(crate) depth: u32,
}

impl Line {
    /// A line of plain text.
    pub(crate) fn plain(text: impl Into<String>) -> Line {
        Line { text: text.into(), ..Line::default() }
    }

    /// The width of the line, indent included.
    pub(crate) fn width(&self, size: i32) -> i32 {
        self.indent + width(&self.text, size)
    }

    /// The level of the highest overline; 0 if there is none.
    pub(crate) fn levels(&self) -> u32 {
        self.overs.iter().map(|o| o.level).max().unwrap_or(0)
    }

    /// The line without overlines, for titles: `¬` stands before a complemented part.
    pub(crate) fn linear(&self) -> String {
        let mut text = String::new();
        for (i, c) in self.text.char_indices() {
            self.overs.iter().filter(|o| o.to == i).for_each(|_| text.push(')'));
            self.overs.iter().filter(|o| o.from == i).for_each(|_| text.push_str("¬("));
            text.push(c);
        }
        self.overs.iter().filter(|o| o.to == self.text.len()).for_each(|_| text.push(')'));
        text
    }

    /// Breaks the line into lines no wider than `most`, at its places to break. A line that is far
    /// wider because it has no such place is cut and ends in `…`.
    pub(crate) fn wrap(self, size: i32, most: i32) -> Vec<Line> {
        let widest = most + most / 2;
        self.broken(size, most).into_iter().map(|l| l.shortened(size, widest)).collect()
    }

    /// True if a part of the text was left out.
    pub(crate) fn is_cut(&self) -> bool {
        self.text.ends_with('…')
    }

    fn shortened(mut self, size: i32, most: i32) -> Line {
        if !fits(&self.text, size, most - self.indent) {
            let (text, _) = shortened(&self.text, size, most - self.indent);
            let end = text.len() - '…'.len_utf8();
            self.overs.retain(|o| o.from < end);
            self.overs.iter_mut().for_each(|o| o.to = o.to.min(end));
            self.text = text;
        }
        self
    }

    fn broken(self, size: i32, most: i32) -> Vec<Line> {
        if self.breaks.is_empty() || fits(&self.text, size, most - self.indent) {
            return vec![self];
        }
        let mut lines = Vec::new();
        let mut start = 0;
        let room = (most - self.indent).max(size);
        while start < self.text.len() {
            let end = self.line_end(start, size, if start == 0 { room } else { (room - HANG).max(size) });
            let mut line = self.cut(start, end);
            if start > 0 {
                line.indent += HANG;
            }
            lines.push(line);
            start = end;
        }
        lines
    }

    /// The end of the line that begins at a byte: the outermost operator that leaves the line more
    /// than half full, otherwise the last place that fits.
    fn line_end(&self, start: usize, size: i32, room: i32) -> usize {
        let span = |end: usize| width(self.text.get(start..end).unwrap_or("").trim_end(), size);
        if fits(self.text.get(start..).unwrap_or(""), size, room) {
            return self.text.len();
        }
        let ahead = self.breaks.iter().skip(self.breaks.partition_point(|b| b.at <= start));
        let mut best: Option<Break> = None;
        for b in ahead {
            if span(b.at) > room {
                // Nothing fits, so take the first place to break.
                return best.map_or(b.at, |best| best.at);
            }
            let better = best.is_none_or(|best| b.depth <= best.depth || span(best.at) * 2 < room);
            if better {
                best = Some(*b);
            }
        }
        best.map_or(self.text.len(), |b| b.at)
    }

    fn cut(&self, start: usize, end: usize) -> Line {
        let text = self.text.get(start..end).unwrap_or("").trim_end().to_owned();
        let inside = self.overs.iter().filter(|o| o.from >= start && o.to <= end);
        let overs = inside.map(|o| Over { from: o.from - start, to: o.to - start, level: o.level }).collect();
        Line { text, overs, breaks: Vec::new(), indent: self.indent }
    }
}

/// The indent of all lines after the first.
const HANG: i32 = 120;

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(n: usize) -> Line {
        let mut line = Line::default();
        for i in 0..n {
            if i > 0 {
                line.breaks.push(Break { at: line.text.len(), depth: 0 });
                line.text.push_str("+ ");
            }
            line.text.push_str("aaaa ");
        }
        line
    }

    #[test]
    fn a_long_sum_breaks_before_its_signs_and_loses_nothing() {
        let line = terms(20);
        let lines = line.clone().wrap(140, 1500);
        assert!(lines.len() > 3);
        assert!(lines.iter().all(|l| l.width(140) <= 1500));
        assert!(lines[1..].iter().all(|l| l.text.starts_with("+ ")));
        let back = lines.iter().map(|l| l.text.as_str()).collect::<Vec<_>>().join(" ");
        assert_eq!(back, line.text.trim_end());
    }

    #[test]
    fn the_outer_operator_is_the_better_place() {
        let mut line = Line::plain("aaaaaaaa + bbb · ccc");
        line.breaks = vec![Break { at: 9, depth: 0 }, Break { at: 15, depth: 1 }];
        let most = width("aaaaaaaa + bbb ·", 140);
        let lines: Vec<String> = line.wrap(140, most).into_iter().map(|l| l.text).collect();
        assert_eq!(lines, ["aaaaaaaa", "+ bbb · ccc"]);
    }

    #[test]
    fn what_has_no_place_to_break_stays_whole_unless_it_is_far_too_wide() {
        let word = "a".repeat(12);
        let most = width(&word, 140) - 200;
        assert_eq!(Line::plain(&*word).wrap(140, most), [Line::plain(&*word)]);
        let mut long = Line::plain("a".repeat(500));
        long.overs.push(Over { from: 0, to: 500, level: 1 });
        let [cut] = &long.wrap(140, most)[..] else { panic!("one line") };
        assert!(cut.is_cut() && cut.width(140) <= most + most / 2);
        assert!(cut.overs[0].to < cut.text.len(), "the line ends where the text does");
    }
}
