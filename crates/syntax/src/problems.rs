//! The problems of one run, up to a limit.

use g7_model::{Problem, Span, codes, say};

/// More problems than this help nobody.
const MOST: usize = 100;

/// Problems found so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Problems {
    list: Vec<Problem>,
    overflow: Option<Span>,
}

impl Problems {
    /// Adds a problem; its words are made only if there is still room for it.
    pub(crate) fn add(&mut self, at: Span, make: impl FnOnce() -> Problem) {
        if self.list.len() < MOST {
            self.list.push(make());
        } else if self.overflow.is_none() {
            self.overflow = Some(at);
        }
    }

    /// Goes on with problems found before.
    pub(crate) fn of(list: Vec<Problem>) -> Problems {
        Problems { list, overflow: None }
    }

    /// Adds problems that were found before; `None` if there are then too many.
    pub(crate) fn and(mut self, more: Vec<Problem>) -> Option<Problems> {
        self.list.extend(more);
        (self.overflow.is_none() && self.list.len() <= MOST).then_some(self)
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Those from a number on, which are removed; `None` if there were too many.
    pub(crate) fn split_off(&mut self, at: usize) -> Option<Vec<Problem>> {
        (self.overflow.is_none() && at <= self.list.len()).then(|| self.list.split_off(at))
    }

    /// True if no more problems are kept.
    pub(crate) fn is_full(&self) -> bool {
        self.overflow.is_some()
    }

    /// All of them in the order of the text.
    pub(crate) fn finish(mut self) -> Vec<Problem> {
        self.list.sort_by_key(|p| p.at.start);
        if let Some(at) = self.overflow {
            let what = say!("more than {MOST} problems; the rest of them is not listed");
            let help = say!("mend the first ones and look again: they often cause those that follow");
            self.list.push(Problem::new(&codes::TOO_MANY_PROBLEMS, at, what).help(help));
        }
        self.list
    }
}
