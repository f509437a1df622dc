//! STRING values as words of a state: the first word holds the length in bytes, the others hold the
//! UTF-8 bytes, eight to a word, little-endian; unused bytes are zero.

/// Reads the text whose first word is at `at`.
pub fn read_text(words: &[u64], at: u32) -> String {
    let at = at as usize;
    let len = words.get(at).copied().unwrap_or(0);
    let len = usize::try_from(len).unwrap_or(usize::MAX).min(words.len().saturating_sub(at + 1) * 8);
    let bytes: Vec<u8> = words.iter().skip(at + 1).flat_map(|w| w.to_le_bytes()).take(len).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The words of a text for a variable of `words` words; a longer text is cut between two
/// characters.
pub fn write_text(text: &str, words: u32) -> Vec<u64> {
    let capacity = (words.saturating_sub(1) as usize).saturating_mul(8);
    let mut len = text.len().min(capacity);
    while !text.is_char_boundary(len) {
        len -= 1;
    }
    let mut out = vec![len as u64];
    for chunk in text.as_bytes().get(..len).unwrap_or(&[]).chunks(8) {
        out.push(chunk.iter().rev().fold(0, |acc, b| acc << 8 | u64::from(*b)));
    }
    out.resize(words.max(1) as usize, 0);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_goes_there_and_back_and_is_cut_at_a_character() {
        let words = write_text("håndtag", 3);
        assert_eq!(words.len(), 3);
        assert_eq!(read_text(&words, 0), "håndtag");
        assert_eq!(read_text(&write_text("1234567å", 2), 0), "1234567");
        assert_eq!(read_text(&write_text("", 1), 0), "");
    }

    #[test]
    fn a_length_that_lies_reads_no_further_than_there_is() {
        assert_eq!(read_text(&[u64::MAX, 0x6161], 0), "aa\0\0\0\0\0\0");
        assert_eq!(read_text(&[], 7), "");
    }
}
