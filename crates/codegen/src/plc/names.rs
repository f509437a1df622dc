//! Names of the chart as identifiers of IEC 61131-3.

use std::collections::HashMap;

use g7_iec::words::is_word;

use crate::names::{Given, letters};

/// Names that are given once, in any case.
#[derive(Debug)]
pub(crate) struct Names {
    /// Letters that a name may have.
    longest: usize,
    given: Given,
    counts: HashMap<String, u32>,
}

/// Letters that the number of a shortened name may take.
const NUMBER: usize = 5;

impl Names {
    pub(crate) fn new(longest: usize) -> Names {
        Names { longest, given: Given::default(), counts: HashMap::new() }
    }

    /// A variable's name.
    pub(crate) fn variable(&mut self, name: &str) -> String {
        let plain = letters(name);
        self.once(if is_word(&plain) { format!("V_{plain}") } else { plain })
    }

    /// A name that begins with what it is for.
    pub(crate) fn with(&mut self, before: &str, name: &str) -> String {
        let plain = letters(&format!("a{name}"));
        self.once(format!("{before}_{}", plain.get(1..).unwrap_or("").trim_start_matches('_')))
    }

    /// A name with the first number that is free.
    pub(crate) fn counted(&mut self, before: &str) -> String {
        let count = self.counts.entry(before.to_owned()).or_default();
        *count += 1;
        let name = format!("{before}_{count}");
        self.once(name)
    }

    /// Capitals and small letters are the same there.
    fn once(&mut self, name: String) -> String {
        let mut name = name.trim_end_matches('_').to_owned();
        if name.len() > self.longest {
            // All letters are ASCII.
            name.truncate(self.longest.saturating_sub(NUMBER));
        }
        self.given.once(name.trim_end_matches('_').to_owned(), str::to_uppercase)
    }
}
