//! Unlimited undo and redo: each change is kept as the splices that take it back.
//!
//! Undoing everything restores the first text byte for byte, and redoing everything the last one. Changes of other
//! people (decision 086) are no units: the units are moved over them, so that undo takes back what was done here
//! and leaves the rest as it is.

use crate::splice::{Splice, inverse, over};

/// The last change that was typed. The next key may extend it.
#[derive(Clone, Debug)]
struct Typed {
    there: Vec<Splice>,
}

/// The changes of a text, and those that were undone.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// The splices that take each change back. The last one fits the present text, each other one the text after the next
    /// one was taken back.
    done: Vec<Vec<Splice>>,
    /// The splices that make each undone change again, in the same order.
    undone: Vec<Vec<Splice>>,
    /// The last of `done`, if the user typed it and may go on.
    typed: Option<Typed>,
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
        let next = Typed { there: splices.to_vec() };
        if typed
            && let (Some(last), Some(last_back)) = (&mut self.typed, self.done.last_mut())
            && join(&mut last.there, last_back, &next.there, &back)
        {
            return true;
        }
        self.done.push(back);
        self.typed = typed.then_some(next);
        true
    }

    /// Undoes the last change of `text`: returns the splices for it.
    pub fn undo(&mut self, text: &str) -> Option<Vec<Splice>> {
        self.typed = None;
        travel(text, &mut self.done, &mut self.undone)
    }

    /// Redoes the change of `text` that was undone last: returns the splices for it.
    pub fn redo(&mut self, text: &str) -> Option<Vec<Splice>> {
        travel(text, &mut self.undone, &mut self.done)
    }

    /// The splices that `undo` would return.
    pub fn last(&self) -> Option<&[Splice]> {
        self.done.last().map(Vec::as_slice)
    }

    /// Moves all units over a change of the text that somebody else has made. A unit of which nothing is left, such as the
    /// undo of a word that is gone, is dropped.
    pub fn others(&mut self, splices: &[Splice]) {
        self.pause();
        move_over(&mut self.done, splices);
        move_over(&mut self.undone, splices);
    }

    /// Ends the present step of undo: the next key starts a new one.
    pub fn pause(&mut self) {
        self.typed = None;
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

/// Takes the last unit of one side to the other.
fn travel(text: &str, from: &mut Vec<Vec<Splice>>, to: &mut Vec<Vec<Splice>>) -> Option<Vec<Splice>> {
    let splices = from.pop()?;
    to.push(inverse(text, &splices)?);
    Some(splices)
}

/// Moves the units of one side over a change of the present text.
fn move_over(units: &mut Vec<Vec<Splice>>, splices: &[Splice]) {
    let mut splices = splices.to_vec();
    for unit in units.iter_mut().rev() {
        let moved = over(unit, &splices, false);
        splices = over(&splices, unit, true);
        *unit = moved;
    }
    units.retain(|unit| !unit.is_empty());
}

/// Extends the last step of undo by a key if both belong to one word.
fn join(there: &mut [Splice], back: &mut [Splice], next: &[Splice], next_back: &[Splice]) -> bool {
    let ([l], [lb], [n], [nb]) = (there, back, next, next_back) else {
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
        let back = history.undo(text).expect("something to undo");
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
        while let Some(there) = history.redo(&text) {
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
            let there = history.redo(&text).expect("something to redo");
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
    #[test]
    fn undo_takes_back_what_was_done_here_and_leaves_the_work_of_others() {
        let (mut text, mut history) = ("one three".to_owned(), History::default());
        let others = |text: &mut String, history: &mut History, splices: &[Splice]| {
            history.others(splices);
            *text = spliced(text, splices).expect("it fits");
        };
        play(&mut text, &mut history, &[Splice::new(4, 4, "two ")], false);
        play(&mut text, &mut history, &[Splice::new(0, 3, "1")], false);
        others(&mut text, &mut history, &[Splice::new(1, 1, "!"), Splice::new(11, 11, " four")]);
        assert_eq!(text, "1! two three four");
        undo(&mut text, &mut history);
        assert_eq!(text, "one! two three four");
        others(&mut text, &mut history, &[Splice::new(0, 0, "> ")]);
        undo(&mut text, &mut history);
        assert_eq!(text, "> one! three four");
        for now in ["> one! two three four", "> 1! two three four"] {
            let there = history.redo(&text).expect("something to redo");
            text = spliced(&text, &there).expect("it fits");
            assert_eq!(text, now);
        }
    }

    #[test]
    fn a_unit_of_which_nothing_is_left_is_dropped() {
        let (mut text, mut history) = ("ab".to_owned(), History::default());
        play(&mut text, &mut history, &[Splice::new(1, 1, "x")], true);
        history.others(&[Splice::new(0, 3, "")]);
        assert!(!history.can_undo());
    }
    #[test]
    fn all_that_is_undone_beside_others_can_be_redone() {
        let mut seed = 7u64;
        let mut numbers = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % below
        };
        for _ in 0..300 {
            let (mut text, mut history) = ("abcdefghij".to_owned(), History::default());
            for _ in 0..30 {
                let (a, b) = (numbers(text.len() + 1), numbers(text.len() + 1));
                let mine = numbers(2) == 0;
                let splice =
                    Splice::new(a.min(b), a.max(b).min(a.min(b) + 4), if mine { "mm" } else { "TT" });
                if mine {
                    play(&mut text, &mut history, &[splice], numbers(2) == 0);
                } else {
                    history.others(std::slice::from_ref(&splice));
                    text = spliced(&text, &[splice]).expect("it fits");
                }
            }
            let now = text.clone();
            while history.can_undo() {
                undo(&mut text, &mut history);
            }
            assert!(!text.contains('m'), "{text} has what was undone");
            while let Some(there) = history.redo(&text) {
                text = spliced(&text, &there).expect("it fits");
            }
            assert_eq!(text, now);
        }
    }
}
