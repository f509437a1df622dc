//! Names of the chart as identifiers of IEC 61131-3.

use std::collections::{HashMap, HashSet};

use g7_iec::words::is_word;

use crate::names::letters;

/// Names that are given once, in any case.
#[derive(Debug, Default)]
pub(crate) struct Names {
    given: HashSet<String>,
    /// By a name that is wanted again and again, in capitals: the number to try next.
    next: HashMap<String, u32>,
    counts: HashMap<String, u32>,
}

impl Names {
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

    fn once(&mut self, name: String) -> String {
        let name = name.trim_end_matches('_').to_owned();
        let plain = name.to_uppercase();
        if self.given.insert(plain.clone()) {
            return name;
        }
        // No name is given back, so the numbers tried before are still taken.
        let next = self.next.entry(plain).or_insert(2);
        loop {
            let free = format!("{name}_{next}");
            *next += 1;
            if self.given.insert(free.to_uppercase()) {
                return free;
            }
        }
    }
}
