//! Changes of a text as data.

/// Replaces bytes `start..end` of the text before by `insert`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Splice {
    /// First byte that goes.
    pub start: usize,
    /// One past the last byte that goes.
    pub end: usize,
    /// What comes instead.
    pub insert: String,
}

impl Splice {
    /// A replacement.
    pub fn new(start: usize, end: usize, insert: impl Into<String>) -> Splice {
        Splice { start, end, insert: insert.into() }
    }
}

/// The text after the splices; none where they do not fit it: out of order,
/// beyond its end, inside of a character.
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

/// The splices that lead from the text after back to the text before; none
/// where they do not fit it.
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

/// In order, those that change nothing left out, common beginnings and ends cut away.
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
    use super::{Splice, inverse, spliced, tidied};

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
    fn equal_parts_are_left_alone() {
        let tidy = tidied("a -> b", vec![Splice::new(0, 6, "a -> c"), Splice::new(0, 0, "")]);
        assert_eq!(tidy, [Splice::new(5, 6, "c")]);
        assert_eq!(tidied("abc", vec![Splice::new(0, 3, "abc")]), []);
    }
}
