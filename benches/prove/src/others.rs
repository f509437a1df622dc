//! The answers of other checkers to a row, with their seconds.

use std::time::Instant;

use g7_peers::checkers::{Abc, Ltsmin, Ric3, Said, Spin, one_of};
use g7_verify::Tried;

use crate::charts;
use crate::own::{Aiger, all, one_word};
use crate::rows::{By, Row, Task};

/// The checkers that are here.
pub struct Others {
    abc: Option<Abc>,
    ric3: Option<Ric3>,
    spin: Option<Spin>,
    ltsmin: Option<Ltsmin>,
    limit: u32,
}

/// The names of the checkers, in the order of the columns.
pub const NAMES: [&str; 5] = ["ABC", "rIC3", "Spin", "Stateright", "LTSmin"];

/// An answer, in the words of `own.rs`, and its seconds.
pub struct Answer {
    pub word: String,
    pub seconds: f64,
}

impl Others {
    /// Looks for the checkers, for so many seconds each.
    pub fn find(limit: u32) -> Others {
        Others { abc: Abc::find(), ric3: Ric3::find(), spin: Spin::find(), ltsmin: Ltsmin::find(), limit }
    }

    /// The names of those that are not here.
    pub fn absent(&self) -> Vec<&'static str> {
        let here = [
            self.abc.is_some(),
            self.ric3.is_some(),
            self.spin.is_some(),
            cfg!(feature = "stateright"),
            self.ltsmin.is_some(),
        ];
        NAMES.iter().zip(here).filter(|(_, here)| !here).map(|(name, _)| *name).collect()
    }

    /// Their answers. None: absent, or not asked.
    pub fn answers(&self, row: &Row, file: Option<&Aiger>) -> [Option<Answer>; NAMES.len()] {
        let states = match row.task {
            // A search that visits states one by one is not asked about more than it can hold, and once of each.
            Task::States { cells, tried, by: By::Sets } if cells <= 11 => Some((cells, tried == Tried::One)),
            _ => None,
        };
        [
            file.zip(self.abc.as_ref()).map(|(file, abc)| {
                timed(|| {
                    let said = abc.ask(std::slice::from_ref(&file.file), self.limit);
                    let said = said.first().cloned().unwrap_or_default();
                    word(file, |signal| said.get(signal).copied().unwrap_or(Said::Open))
                })
            }),
            file.zip(self.ric3.as_ref()).map(|(file, ric3)| {
                timed(|| {
                    let begun = Instant::now();
                    word(file, |signal| {
                        let left = u64::from(self.limit).saturating_sub(begun.elapsed().as_secs());
                        if left == 0 {
                            Said::Open
                        } else {
                            ric3.ask(&one_of(&file.file, signal), left as u32)
                        }
                    })
                })
            }),
            states.zip(self.spin.as_ref()).map(|((cells, one), spin)| {
                let model = charts::promela(cells, one);
                let found = spin.search(&model, &["-DMEMLIM=8000"], 10_000_000, self.limit);
                found.map_or(self.open(), |s| Answer {
                    word: if s.errors == 0 { visited(cells, s.states) } else { "refuted".to_owned() },
                    seconds: s.seconds,
                })
            }),
            states.and_then(|(cells, one)| self.stateright(cells, one)),
            states.filter(|(_, one)| *one).zip(self.ltsmin.as_ref()).map(|((cells, _), ltsmin)| {
                let begun = Instant::now();
                let found = ltsmin.states(&charts::etf(cells), self.limit);
                found.map_or(self.open(), |n| Answer {
                    word: visited(cells, n),
                    seconds: begun.elapsed().as_secs_f64(),
                })
            }),
        ]
    }

    fn open(&self) -> Answer {
        Answer { word: "open".to_owned(), seconds: self.limit.into() }
    }

    #[cfg(feature = "stateright")]
    fn stateright(&self, cells: usize, one: bool) -> Option<Answer> {
        let limit = std::time::Duration::from_secs(self.limit.into());
        Some(timed(|| {
            crate::cells::search(cells, one, limit).map_or("open".to_owned(), |n| visited(cells, n))
        }))
    }

    #[cfg(not(feature = "stateright"))]
    fn stateright(&self, _: usize, _: bool) -> Option<Answer> {
        None
    }
}

fn visited(cells: usize, states: usize) -> String {
    if states as u128 == all(cells) { "all".to_owned() } else { format!("{states} states") }
}

/// The word on all questions, from what is said of each signal.
fn word(file: &Aiger, mut said: impl FnMut(usize) -> Said) -> String {
    let mut one = |(bad, unsure): &(usize, Option<usize>)| match said(*bad) {
        Said::Reached(_) => "refuted",
        Said::Never if unsure.is_none_or(|u| said(u) == Said::Never) => "proved",
        _ => "open",
    };
    one_word(file.signals.iter().map(&mut one).collect())
}

fn timed(work: impl FnOnce() -> String) -> Answer {
    let begun = Instant::now();
    let word = work();
    Answer { word, seconds: begun.elapsed().as_secs_f64() }
}
