//! Converts byte offsets to lines and columns, for messages.

/// The line starts of a text.
#[derive(Clone, Debug)]
pub struct LineIndex<'a> {
    text: &'a str,
    starts: Vec<u32>,
}

/// A place as people count it: line and column from 1, the column in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineColumn {
    /// The line, from 1.
    pub line: u32,
    /// The character within the line, from 1.
    pub column: u32,
}

impl<'a> LineIndex<'a> {
    /// Finds the lines of a text. A line ends with `\n`; a `\r` before it is part of the line's end.
    pub fn new(text: &'a str) -> LineIndex<'a> {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| clamp(i + 1))).collect();
        LineIndex { text, starts }
    }

    /// The text itself.
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// How many lines there are, at least one.
    pub fn count(&self) -> u32 {
        clamp(self.starts.len())
    }

    /// The line that the byte is in, from 1.
    pub fn line(&self, offset: u32) -> u32 {
        clamp(self.starts.partition_point(|s| *s <= offset))
    }

    /// The line and column of a byte. An offset beyond the text counts as its end.
    pub fn place(&self, offset: u32) -> LineColumn {
        let line = self.line(offset);
        let start = self.start(line);
        let end = (offset as usize).min(self.text.len());
        let before = self.text.as_bytes().get(start as usize..end).unwrap_or_default();
        // Continuation bytes are not characters of their own.
        let column = before.iter().filter(|b| **b & 0xC0 != 0x80).count();
        LineColumn { line, column: clamp(column + 1) }
    }

    /// The first byte of a line; the end of the text if there is no such line.
    pub fn start(&self, line: u32) -> u32 {
        let index = (line as usize).saturating_sub(1);
        self.starts.get(index).copied().unwrap_or(clamp(self.text.len()))
    }

    /// The text of a line, without its end.
    pub fn line_text(&self, line: u32) -> &'a str {
        let start = self.start(line) as usize;
        let end = self.start(line.saturating_add(1)) as usize;
        let text = self.text.get(start..end).unwrap_or_default();
        text.strip_suffix('\n').map_or(text, |t| t.strip_suffix('\r').unwrap_or(t))
    }
}

fn clamp(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
