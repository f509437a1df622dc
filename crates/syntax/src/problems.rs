//! The problems of one run, and how many of them are worth telling.

use g7_model::{Problem, Span, codes};

/// More than this many problems help nobody.
const MOST: usize = 100;

/// Problems found so far.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    list: Vec<Problem>,
    overflow: Option<Span>,
}

impl Problems {
    /// Adds a problem; the words are made only when there is still room for it.
    pub(crate) fn add(&mut self, at: Span, make: impl FnOnce() -> Problem) {
        if self.list.len() < MOST {
            self.list.push(make());
        } else if self.overflow.is_none() {
            self.overflow = Some(at);
        }
    }

    /// Whether more problems would change nothing.
    pub(crate) fn is_full(&self) -> bool {
        self.overflow.is_some()
    }

    /// All of them in the order of the text.
    pub(crate) fn finish(mut self) -> Vec<Problem> {
        self.list.sort_by_key(|p| p.at.start);
        if let Some(at) = self.overflow {
            let what = format!("more than {MOST} problems; the rest of them is not listed");
            let help = "mend the first ones and look again: they often cause those that follow";
            self.list.push(Problem::new(&codes::TOO_MANY_PROBLEMS, at, what).help(help));
        }
        self.list
    }
}
