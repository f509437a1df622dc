//! The nearest word of a list to a misspelt one.

/// The word of the list that was most likely meant: at most one slip in a word of up to four
/// letters, two in a longer one.
pub fn similar<'w>(word: &str, list: &[&'w str]) -> Option<&'w str> {
    let best = list.iter().map(|w| (slips(word, w), *w)).min_by_key(|(n, _)| *n)?;
    let allowed = if best.1.len() <= 4 { 1 } else { 2 };
    (best.0 <= allowed && best.0 < best.1.len()).then_some(best.1)
}

/// The number of insertions, deletions, replacements and swaps of neighbours between two words;
/// case is ignored.
fn slips(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().take(24).flat_map(char::to_lowercase).collect();
    let b: Vec<char> = b.chars().take(24).flat_map(char::to_lowercase).collect();
    let mut rows: [Vec<usize>; 3] = [Vec::new(), (0..=b.len()).collect(), Vec::new()];
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let at = |r: &Vec<usize>, k: usize| r.get(k).copied().unwrap_or(usize::MAX / 2);
            let mut n =
                (at(&rows[1], j) + usize::from(x != y)).min(at(&rows[1], j + 1) + 1).min(at(&row, j) + 1);
            let swapped = i > 0 && j > 0 && a.get(i - 1) == Some(y) && b.get(j - 1) == Some(x);
            if swapped {
                n = n.min(at(&rows[0], j - 1) + 1);
            }
            row.push(n);
        }
        rows.rotate_left(1);
        rows[1] = row;
    }
    rows[1].last().copied().unwrap_or(usize::MAX)
}
