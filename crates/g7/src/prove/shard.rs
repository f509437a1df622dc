//! `--shard i/n`: one part of all questions of all files, a line of JSON for each.
//!
//! Every n-th question of a file is in a part, so the parts together are the whole, and each costs about the
//! same. The count begins with the number of the file among all: whether another file was given up
//! when its time was over makes no difference, and small files do not all fall to one part.

/// A part of the questions: the i-th of n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// From 0.
    part: usize,
    of: usize,
}

/// Reads `i/n`.
pub(crate) fn part(text: &str) -> Result<Part, String> {
    let expected = || "expected I/N with I from 1 to N, as in 2/3".to_owned();
    let (i, n) = text.split_once('/').ok_or_else(expected)?;
    let read = |s: &str| s.parse::<usize>().ok().filter(|_| s.bytes().all(|b| b.is_ascii_digit()));
    match (read(i), read(n)) {
        (Some(i), Some(n)) if (1..=n).contains(&i) => Ok(Part { part: i - 1, of: n }),
        _ => Err(expected()),
    }
}

impl Part {
    /// True if the question with this number is in the part.
    pub(crate) fn has(self, number: usize) -> bool {
        number % self.of == self.part
    }
}

#[cfg(test)]
mod tests {
    use super::part;

    #[test]
    fn parts_are_read() {
        assert!(part("1/1").is_ok() && part("3/3").is_ok());
        for wrong in ["", "1", "0/3", "4/3", "1/0", "0/0", "-1/3", "+1/3", "a/b", "1/3/5", "1/ 3"] {
            assert!(part(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn each_question_is_in_one_part() {
        for n in 1..=7usize {
            let parts: Vec<_> = (1..=n).map(|i| part(&format!("{i}/{n}")).unwrap()).collect();
            assert!((0..100).all(|k| parts.iter().filter(|p| p.has(k)).count() == 1));
        }
    }
}
