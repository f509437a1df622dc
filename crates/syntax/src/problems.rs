//! The problems of one run, up to a limit.

use g7_model::{Problem, Span, codes};

/// More problems than this help nobody.
const MOST: usize = 100;

/// Problems found so far.
#[derive(Debug, Default)]
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

    /// True if no more problems are kept.
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
