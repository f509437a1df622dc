//! Follows arbitrary changes of an arbitrary text. After each of them the tree is what a whole reading
//! of the new text gives. The input is a text, a line of four dashes, and one change per line: the first
//! byte, how many bytes go away, and the words that come, with `\n` for the end of a line.
#![no_main]

use g7_model::FileId;
use g7_syntax::Tree;
use libfuzzer_sys::fuzz_target;

const MOST: usize = 30;

/// The nearest byte at which a character begins.
fn floor(text: &str, byte: usize) -> usize {
    (0..=byte.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

fuzz_target!(|bytes: &[u8]| {
    let whole = String::from_utf8_lossy(bytes);
    let Some((first, changes)) = whole.split_once("----\n") else { return };
    let mut tree = Tree::read(first.to_owned(), FileId(0));
    for line in changes.lines().take(MOST) {
        let mut parts = line.splitn(3, ' ');
        let mut number = || parts.next().and_then(|n| n.parse::<u32>().ok()).unwrap_or(0) as usize;
        let (start, gone) = (number(), number());
        let words = parts.next().unwrap_or_default().replace("\\n", "\n");
        let start = floor(&tree.text, start % (tree.text.len() + 1));
        let end = floor(&tree.text, start.saturating_add(gone)).max(start);
        let before = tree.text.clone();
        assert!(tree.change(&[(start..end, &words)]), "it fits");
        let read = Tree::read(tree.text.clone(), FileId(0));
        let shown = |t: &Tree| format!("{:?}\n{:?}", t.document, t.problems);
        assert_eq!(shown(&tree), shown(&read), "{line}\n--- before\n{before}\n--- after\n{}", read.text);
    }
});
