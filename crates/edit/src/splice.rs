//! Changes of a text as data.

/// Replaces the bytes `start..end` of the old text by `insert`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Splice {
    /// The first byte that is replaced.
    pub start: usize,
    /// One past the last byte that is replaced.
    pub end: usize,
    /// The new text.
    pub insert: String,
}

impl Splice {
    /// Makes a replacement.
    pub fn new(start: usize, end: usize, insert: impl Into<String>) -> Splice {
        Splice { start, end, insert: insert.into() }
    }
}

/// Applies splices to a text; `None` if they do not fit: out of order, beyond the end, or inside a
/// character.
pub fn spliced(text: &str, splices: &[Splice]) -> Option<String> {
    let added: usize = splices.iter().map(|s| s.insert.len()).sum();
    let mut out = String::with_capacity(text.len() + added);
    let mut at = 0;
    for s in splices {
        if s.end < s.start {
            return None;
        }
        out.push_str(text.get(at..s.start)?);
        out.push_str(&s.insert);
        at = s.end;
        text.get(s.start..s.end)?;
    }
    out.push_str(text.get(at..)?);
    Some(out)
}

/// The splices that lead from the changed text back to `text`; `None` if they do not fit.
pub(crate) fn inverse(text: &str, splices: &[Splice]) -> Option<Vec<Splice>> {
    let mut shift = 0isize;
    let mut last = 0;
    let mut back = Vec::with_capacity(splices.len());
    for s in splices {
        if s.start < last {
            return None;
        }
        last = s.end;
        let old = text.get(s.start..s.end)?;
        let start = s.start.checked_add_signed(shift)?;
        back.push(Splice::new(start, start + s.insert.len(), old));
        shift += s.insert.len() as isize - old.len() as isize;
    }
    Some(back)
}

/// A piece of a changed text: kept text, by its place in the text before, or new text.
enum Piece {
    Kept(usize, usize),
    New(String),
}

/// The splices with the same effect as two lists applied one after the other.
pub(crate) fn composed(text: &str, first: &[Splice], second: &[Splice]) -> Option<Vec<Splice>> {
    let mut pieces = Vec::new();
    let mut at = 0;
    for s in first {
        pieces.push(Piece::Kept(at, s.start));
        pieces.push(Piece::New(s.insert.clone()));
        at = s.end;
    }
    pieces.push(Piece::Kept(at, text.len()));
    let mut out = Vec::new();
    let mut place = 0;
    let mut left = second.iter().peekable();
    for piece in pieces {
        let length = match &piece {
            Piece::Kept(a, b) => b.checked_sub(*a)?,
            Piece::New(t) => t.len(),
        };
        let end = place + length;
        // Cuts this piece by the second list; the end of one splice is where the next part starts.
        let mut from = place;
        while let Some(s) = left.peek() {
            if s.start > end || s.start == end && s.end > end {
                break;
            }
            let start = s.start.max(from);
            out.push(part(&piece, from - place, start - place)?);
            if s.start >= place {
                out.push(Piece::New(s.insert.clone()));
            }
            from = s.end.min(end).max(start);
            if s.end > end {
                break;
            }
            left.next();
        }
        out.push(part(&piece, from - place, length)?);
        place = end;
    }
    Some(tidied(text, gaps(text, &out)))
}

fn part(piece: &Piece, from: usize, to: usize) -> Option<Piece> {
    Some(match piece {
        Piece::Kept(a, _) => Piece::Kept(a + from, a + to),
        Piece::New(t) => Piece::New(t.get(from..to)?.to_owned()),
    })
}

/// The splices that remove or replace everything between the kept pieces.
fn gaps(text: &str, pieces: &[Piece]) -> Vec<Splice> {
    let mut splices = Vec::new();
    let (mut at, mut new) = (0, String::new());
    for piece in pieces {
        match piece {
            Piece::Kept(a, b) if a < b => {
                if at < *a || !new.is_empty() {
                    splices.push(Splice::new(at, *a, std::mem::take(&mut new)));
                }
                at = *b;
            }
            Piece::Kept(..) => {}
            Piece::New(t) => new.push_str(t),
        }
    }
    if at < text.len() || !new.is_empty() {
        splices.push(Splice::new(at, text.len(), new));
    }
    splices
}

/// Sorts splices, drops those without effect, and cuts off common beginnings and ends.
pub(crate) fn tidied(text: &str, mut splices: Vec<Splice>) -> Vec<Splice> {
    splices.sort_by_key(|s| (s.start, s.end));
    let mut out: Vec<Splice> = Vec::with_capacity(splices.len());
    for s in splices {
        match out.last_mut() {
            Some(last) if last.end == s.start => {
                last.end = s.end;
                last.insert.push_str(&s.insert);
            }
            _ => out.push(s),
        }
    }
    out.into_iter().filter_map(|s| trimmed(text, s)).collect()
}

fn trimmed(text: &str, mut s: Splice) -> Option<Splice> {
    let old = text.get(s.start..s.end)?;
    let head: usize =
        old.chars().zip(s.insert.chars()).take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum();
    let (rest, new) = (old.get(head..)?, s.insert.get(head..)?);
    let tail: usize = rest
        .chars()
        .rev()
        .zip(new.chars().rev())
        .take_while(|(a, b)| a == b)
        .map(|(a, _)| a.len_utf8())
        .sum();
    s.insert = new.get(..new.len() - tail)?.to_owned();
    s.start += head;
    s.end -= tail;
    (s.start < s.end || !s.insert.is_empty()).then_some(s)
}

#[cfg(test)]
mod tests {
    use super::{Splice, composed, inverse, spliced, tidied};

    #[test]
    fn the_inverse_leads_back() {
        let text = "abcdefgh";
        let there = [Splice::new(1, 2, "XYZ"), Splice::new(2, 2, "-"), Splice::new(5, 8, "")];
        let after = spliced(text, &there).expect("it fits");
        assert_eq!(after, "aXYZ-cde");
        let back = inverse(text, &there).expect("it fits");
        assert_eq!(spliced(&after, &back).as_deref(), Some(text));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        for wrong in [
            vec![Splice::new(0, 9, "")],
            vec![Splice::new(4, 2, "")],
            vec![Splice::new(3, 4, ""), Splice::new(0, 1, "")],
            vec![Splice::new(2, 3, "")],
        ] {
            assert_eq!(spliced("aéx!", &wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn two_changes_are_one() {
        let text = "abcdefgh";
        let first = [Splice::new(1, 2, "XYZ"), Splice::new(5, 6, ""), Splice::new(8, 8, "!")];
        let mid = spliced(text, &first).expect("it fits");
        assert_eq!(mid, "aXYZcdegh!");
        for second in [
            vec![],
            vec![Splice::new(0, 10, "")],
            vec![Splice::new(2, 5, "-"), Splice::new(7, 7, "+")],
            vec![Splice::new(0, 1, "A"), Splice::new(1, 1, "B"), Splice::new(4, 10, "C")],
            vec![Splice::new(10, 10, "end")],
        ] {
            let wanted = spliced(&mid, &second).expect("it fits");
            let at_once = composed(text, &first, &second).expect("they fit");
            assert_eq!(spliced(text, &at_once), Some(wanted), "{second:?}");
        }
    }

    #[test]
    fn equal_parts_are_left_alone() {
        let tidy = tidied("a -> b", vec![Splice::new(0, 6, "a -> c"), Splice::new(0, 0, "")]);
        assert_eq!(tidy, [Splice::new(5, 6, "c")]);
        assert_eq!(tidied("abc", vec![Splice::new(0, 3, "abc")]), []);
    }
}
