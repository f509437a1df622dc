//! Words read one after the other, with texts among them.

/// Reads words; each function gives nothing where they end too early.
pub(crate) struct Words<'w>(pub(crate) &'w [u64]);

impl<'w> Words<'w> {
    pub(crate) fn next(&mut self) -> Option<u64> {
        let (word, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*word)
    }

    /// The next word as a number of things.
    pub(crate) fn count(&mut self) -> Option<usize> {
        usize::try_from(self.next()?).ok()
    }

    pub(crate) fn take(&mut self, count: usize) -> Option<&'w [u64]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// A list that [`put_list`] has written.
    pub(crate) fn list(&mut self) -> Option<&'w [u64]> {
        let count = self.count()?;
        self.take(count)
    }

    /// A text that [`put_text`] has written.
    pub(crate) fn text(&mut self) -> Option<String> {
        let length = self.count()?;
        let words = self.take(length.div_ceil(8))?;
        let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        bytes.truncate(length);
        String::from_utf8(bytes).ok()
    }
}

/// Writes the length of a list and the list.
pub(crate) fn put_list(into: &mut Vec<u64>, list: &[u64]) {
    into.push(list.len() as u64);
    into.extend_from_slice(list);
}

/// Writes a text: its length in bytes, then the bytes.
pub(crate) fn put_text(into: &mut Vec<u64>, text: &str) {
    into.push(text.len() as u64);
    for part in text.as_bytes().chunks(8) {
        let mut word = [0u8; 8];
        word.iter_mut().zip(part).for_each(|(to, from)| *to = *from);
        into.push(u64::from_le_bytes(word));
    }
}
