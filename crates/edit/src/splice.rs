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

/// Moves splices over those of others. Both lists are made for the same text; the result is for the text that the others
/// have already changed. A part that both delete is deleted once. The text that the others insert stays. If both insert
/// at one place, `first` tells if these splices insert before the others.
///
/// For lists `a` and `b` of one text, `a` and then `over(b, a, false)` gives the same text as `b` and then
/// `over(a, b, true)`.
pub(crate) fn over(splices: &[Splice], others: &[Splice], first: bool) -> Vec<Splice> {
    let mut out: Vec<Splice> = Vec::with_capacity(splices.len());
    // The others that end before the present place, and what they have added to it.
    let (mut next, mut shift) = (0, 0isize);
    for s in splices {
        while let Some(o) = others.get(next)
            && (o.end < s.start || o.end == s.start && (o.start < o.end || !first))
        {
            shift += growth(o);
            next += 1;
        }
        let at = moved(s.start, others.get(next), shift, first);
        put(&mut out, Splice::new(at, at, s.insert.clone()));
        cut(&mut out, s.start..s.end, &others[next..], shift);
    }
    out
}

/// The bytes that a splice adds to its text.
fn growth(s: &Splice) -> isize {
    s.insert.len() as isize - (s.end - s.start) as isize
}

/// A place behind `shift` more bytes. Inside a range that the next one of the others replaces, it is behind the new text, which
/// stands at the begin of that range; at that begin itself, `first` decides.
fn moved(at: usize, next: Option<&Splice>, shift: isize, first: bool) -> usize {
    match next {
        Some(o) if o.start < at || o.start == at && o.start < o.end && !first => {
            o.start.saturating_add_signed(shift) + o.insert.len()
        }
        _ => at.saturating_add_signed(shift),
    }
}

/// Adds the deletion of a range, without what `others` delete in it.
fn cut(out: &mut Vec<Splice>, range: std::ops::Range<usize>, others: &[Splice], mut shift: isize) {
    let mut at = range.start;
    for o in others {
        if o.start >= range.end {
            break;
        }
        if at < o.start {
            put(out, Splice::new(at.saturating_add_signed(shift), o.start.saturating_add_signed(shift), ""));
        }
        at = at.max(o.end);
        shift += growth(o);
    }
    if at < range.end {
        put(out, Splice::new(at.saturating_add_signed(shift), range.end.saturating_add_signed(shift), ""));
    }
}

/// Adds a splice behind the others, joined with the last one if they touch.
fn put(out: &mut Vec<Splice>, s: Splice) {
    match out.last_mut() {
        Some(last) if last.end == s.start => {
            last.end = s.end;
            last.insert.push_str(&s.insert);
        }
        _ if s.start == s.end && s.insert.is_empty() => {}
        _ => out.push(s),
    }
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
    use super::{Splice, composed, inverse, over, spliced, tidied};

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
    /// Splices of a text of this length, drawn from a row of numbers.
    fn drawn(length: usize, name: &str, numbers: &mut impl FnMut(usize) -> usize) -> Vec<Splice> {
        let mut places: Vec<usize> = (0..2 * numbers(4)).map(|_| numbers(length + 1)).collect();
        places.sort_unstable();
        let mut found = Vec::new();
        for (k, pair) in places.chunks_exact(2).enumerate() {
            let end = if numbers(3) == 0 { pair[0] } else { pair[1] };
            found.push(Splice::new(pair[0], end, name.repeat(numbers(3)) + &k.to_string()));
        }
        found
    }

    #[test]
    fn two_changes_in_either_order_give_one_text() {
        let mut seed = 1u64;
        let mut numbers = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % below
        };
        for _ in 0..20_000 {
            let text = "abcdefghij";
            let mine = drawn(text.len(), "M", &mut numbers);
            let theirs = drawn(text.len(), "T", &mut numbers);
            let after = |first: &[Splice], then: &[Splice]| {
                let text = spliced(text, first).expect("they fit");
                spliced(&text, then).expect("they fit too")
            };
            let a = after(&theirs, &over(&mine, &theirs, false));
            let b = after(&mine, &over(&theirs, &mine, true));
            assert_eq!(a, b, "{mine:?} {theirs:?}");
            for s in mine.iter().chain(&theirs) {
                assert!(a.contains(&s.insert), "{a} lacks what was inserted: {mine:?} {theirs:?}");
            }
            let kept = |list: &[Splice], at: usize| !list.iter().any(|s| s.start <= at && at < s.end);
            let left: String = text
                .char_indices()
                .filter(|&(k, _)| kept(&mine, k) && kept(&theirs, k))
                .map(|(_, c)| c)
                .collect();
            assert_eq!(
                a.chars().filter(|c| text.contains(*c)).collect::<String>(),
                left,
                "{mine:?} {theirs:?}"
            );
        }
    }
}
