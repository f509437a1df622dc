//! Unlimited undo and redo: each change is kept together with its inverse.
//!
//! Undoing everything restores the first text byte for byte, and redoing everything the last one.

use crate::splice::{Splice, inverse};

/// One step of undo.
#[derive(Clone, Debug)]
struct Unit {
    there: Vec<Splice>,
    back: Vec<Splice>,
    /// True if the user typed it; the next key may then extend it.
    typed: bool,
}

/// The changes of a text, and those that were undone.
#[derive(Clone, Debug, Default)]
pub struct History {
    done: Vec<Unit>,
    undone: Vec<Unit>,
}

impl History {
    /// Records a change of `text`. Typed changes are joined while they continue one word. Returns
    /// false if the splices do not fit the text.
    pub fn record(&mut self, text: &str, splices: &[Splice], typed: bool) -> bool {
        let Some(back) = inverse(text, splices) else { return false };
        if splices.is_empty() {
            return true;
        }
        self.undone.clear();
        let unit = Unit { there: splices.to_vec(), back, typed };
        let joined = typed && self.done.last_mut().is_some_and(|last| join(last, &unit));
        if !joined {
            self.done.push(unit);
        }
        true
    }

    /// Undoes the last change: returns the splices for the present text.
    pub fn undo(&mut self) -> Option<Vec<Splice>> {
        let unit = self.done.pop()?;
        let back = unit.back.clone();
        self.undone.push(unit);
        Some(back)
    }

    /// Redoes the change that was undone last: returns the splices for the present text.
    pub fn redo(&mut self) -> Option<Vec<Splice>> {
        let mut unit = self.undone.pop()?;
        unit.typed = false;
        let there = unit.there.clone();
        self.done.push(unit);
        Some(there)
    }

    /// Ends the present step of undo: the next key starts a new one.
    pub fn pause(&mut self) {
        if let Some(last) = self.done.last_mut() {
            last.typed = false;
        }
    }

    /// True if there is a change to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// True if there is a change to redo.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }
}

/// Extends the last step of undo by a key if both belong to one word.
fn join(last: &mut Unit, next: &Unit) -> bool {
    if !last.typed {
        return false;
    }
    let ([l], [lb], [n], [nb]) =
        (last.there.as_mut_slice(), last.back.as_mut_slice(), next.there.as_slice(), next.back.as_slice())
    else {
        return false;
    };
    let one = |s: &str| !s.is_empty() && !s.contains(char::is_whitespace);
    let written = n.start == n.end && lb.end == n.start && one(&n.insert) && one(&l.insert);
    if written {
        l.insert.push_str(&n.insert);
        lb.end += n.insert.len();
        return true;
    }
    let rubbed = n.insert.is_empty() && l.insert.is_empty() && one(&nb.insert) && one(&lb.insert);
    if rubbed && n.end == l.start {
        l.start = n.start;
        lb.insert.insert_str(0, &nb.insert);
        (lb.start, lb.end) = (n.start, n.start);
        return true;
    }
    if rubbed && n.start == l.start {
        l.end += n.end - n.start;
        lb.insert.push_str(&nb.insert);
        return true;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::History;
    use crate::splice::{Splice, spliced};

    fn play(text: &mut String, history: &mut History, splices: &[Splice], typed: bool) {
        assert!(history.record(text, splices, typed));
        *text = spliced(text, splices).expect("it fits");
    }

    fn undo(text: &mut String, history: &mut History) {
        let back = history.undo().expect("something to undo");
        *text = spliced(text, &back).expect("it fits");
    }

    #[test]
    fn the_keys_of_one_word_are_one_unit() {
        let (mut text, mut history) = ("ab".to_owned(), History::default());
        for (k, c) in "so it".chars().enumerate() {
            play(&mut text, &mut history, &[Splice::new(1 + k, 1 + k, c.to_string())], true);
        }
        assert_eq!(text, "aso itb");
        for left in ["aso b", "asob", "ab"] {
            undo(&mut text, &mut history);
            assert_eq!(text, left);
        }
        assert!(!history.can_undo());
        while let Some(there) = history.redo() {
            text = spliced(&text, &there).expect("it fits");
        }
        assert_eq!(text, "aso itb");
    }

    #[test]
    fn keys_that_delete_join_too_in_both_directions() {
        for cuts in [[(3, 4), (2, 3), (1, 2)], [(1, 2), (1, 2), (1, 2)]] {
            let (mut text, mut history) = ("abcd!".to_owned(), History::default());
            for (start, end) in cuts {
                play(&mut text, &mut history, &[Splice::new(start, end, "")], true);
            }
            assert_eq!(text, "a!");
            undo(&mut text, &mut history);
            assert_eq!(text, "abcd!");
            assert!(!history.can_undo());
            let there = history.redo().expect("something to redo");
            assert_eq!(spliced(&text, &there).as_deref(), Some("a!"));
        }
    }

    #[test]
    fn a_gesture_or_a_pause_ends_the_word() {
        let (mut text, mut history) = (String::new(), History::default());
        play(&mut text, &mut history, &[Splice::new(0, 0, "a")], true);
        history.pause();
        play(&mut text, &mut history, &[Splice::new(1, 1, "b")], true);
        play(&mut text, &mut history, &[Splice::new(2, 2, "c")], false);
        for left in ["ab", "a", ""] {
            undo(&mut text, &mut history);
            assert_eq!(text, left);
        }
    }
}
