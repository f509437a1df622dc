//! The values that outlive the program: the retained variables by name, and the situation with its
//! times, as words for the slots of a file.
//!
//! ```text
//! bytes of the text | its words: a line `name type words` a variable | retained words | canonical image
//! ```
//!
//! The same program goes on where it was. Another one can still find its retained variables by name
//! and type.

use g7_engine::{Addr, State};
use g7_host::{Runner, Start};
use g7_rig::Bench;

use crate::exchange::Reader;
use crate::setup::Changed;
use crate::slots::{Disk, Loaded, Slots, SlotsError};

/// The layout of the words; its number changes with it.
const LAYOUT: u64 = u64::from_le_bytes(*b"g7 keep1");

/// A retained variable: name, type as written, number of words.
type Variable = (String, String, usize);

/// How a controller starts with the values that were kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Started {
    /// There were none, or they were not wanted.
    Cold,
    /// Where the earlier run was.
    Warm,
    /// In the initial situation, with so many of so many retained variables of an earlier program.
    Fitted(usize, usize),
}

/// Why a controller does not start with the values that were kept.
#[derive(Debug, thiserror::Error)]
pub enum KeepError {
    /// The file cannot be read or written, or both slots are damaged.
    #[error("{0}")]
    Slots(#[from] SlotsError),
    /// The values are those of another program, and the policy is to refuse them.
    #[error("it holds the values of another program")]
    Changed,
}

/// The values of a run, in the form in which they are kept.
#[derive(Debug)]
pub struct Keep {
    /// The text with the names, as words; the same in each save.
    head: Vec<u64>,
    words: Vec<u64>,
    image: Vec<u64>,
}

impl Keep {
    /// The form of a bench.
    pub fn new(bench: &Bench, runner: &Runner) -> Keep {
        let variables: Vec<Variable> = bench
            .retained()
            .map(|i| (i.name.clone(), i.retain.clone().unwrap_or_default(), i.words as usize))
            .collect();
        let text: String =
            variables.iter().map(|(name, ty, words)| format!("{name}\t{ty}\t{words}\n")).collect();
        let mut head = vec![text.len() as u64];
        head.extend(text.as_bytes().chunks(8).map(|bytes| {
            let mut word = [0; 8];
            word.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
            u64::from_le_bytes(word)
        }));
        let mut keep = Keep { head, words: Vec::new(), image: Vec::new() };
        keep.take(runner);
        keep
    }

    /// The number of words of each save.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// False: there is an image at least.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The words that were taken last.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// The words of the run as it is now. Allocates only in the first call.
    pub fn take(&mut self, runner: &Runner) -> &[u64] {
        runner.state().canonical(runner.program(), &mut self.image);
        self.words.clear();
        self.words.extend_from_slice(&self.head);
        self.words.extend(runner.retained_words());
        self.words.extend_from_slice(&self.image);
        &self.words
    }
}

/// The file of the values that are kept, and the end of the exchange that they come from.
pub struct KeptFile<D> {
    /// The slots of the file.
    pub slots: Slots<D>,
    /// The other end is with the controller.
    pub from_scan: Reader,
    /// The number of words.
    pub words: usize,
}

/// Opens the file of a run and starts the run with the values that it holds.
///
/// # Errors
///
/// The file cannot be used, or the policy refuses it; it is left as it is.
pub fn open<D: Disk>(
    disk: impl Fn() -> D,
    bench: &Bench,
    runner: Runner,
    changed: Changed,
) -> Result<(Slots<D>, Runner, Started), KeepError> {
    let words = Keep::new(bench, &runner).len();
    let begin = || Slots::begin(disk(), LAYOUT, words);
    let (slots, loaded) = match Slots::open(disk(), LAYOUT, words) {
        Ok((slots, None)) => return Ok((slots, runner, Started::Cold)),
        Ok((slots, Some(loaded))) => (Some(slots), loaded),
        Err(SlotsError::Layout(loaded)) => (None, *loaded),
        Err(SlotsError::Damaged) if changed == Changed::Cold => return Ok((begin()?, runner, Started::Cold)),
        Err(e) => return Err(e.into()),
    };
    if let (Some(slots), Some(state)) = (slots, situation(&runner, &loaded)) {
        return Ok((slots, runner.resume(state), Started::Warm));
    }
    match changed {
        Changed::Refuse => Err(KeepError::Changed),
        Changed::Cold => Ok((begin()?, runner, Started::Cold)),
        Changed::Fit => {
            let mut runner = runner;
            let started = fit(bench, &mut runner, &loaded);
            Ok((begin()?, runner, started))
        }
    }
}

/// The state that was kept, if it is one of this program.
fn situation(runner: &Runner, loaded: &Loaded) -> Option<State> {
    let mut state = State::new(runner.program());
    let image = loaded.words.len().checked_sub(state.image().len())?;
    state.restore(runner.program(), loaded.words.get(image..)?).ok()?;
    Some(state)
}

/// Gives the retained variables the values of those with the same name and type.
fn fit(bench: &Bench, runner: &mut Runner, loaded: &Loaded) -> Started {
    let Some((variables, mut words)) = variables(loaded) else { return Started::Cold };
    runner.restart(Start::Warm);
    let (mut fitted, all) = (0, variables.len());
    for (name, ty, count) in variables {
        let Some((values, rest)) = words.split_at_checked(count) else { break };
        words = rest;
        let same = |i: &&g7_rig::Item| {
            i.name == name && i.retain.as_deref() == Some(&ty) && i.words as usize == count
        };
        if let Some(item) = bench.retained().find(same) {
            (item.addr..).zip(values).for_each(|(addr, value)| runner.set_word(Addr(addr), *value));
            fitted += 1;
        }
    }
    Started::Fitted(fitted, all)
}

/// The retained variables that were kept, and the words behind the text.
fn variables(loaded: &Loaded) -> Option<(Vec<Variable>, &[u64])> {
    let (length, rest) = loaded.words.split_first()?;
    let length = usize::try_from(*length).ok()?;
    let (text, words) = rest.split_at_checked(length.div_ceil(8))?;
    let bytes: Vec<u8> = text.iter().flat_map(|word| word.to_le_bytes()).take(length).collect();
    let text = String::from_utf8(bytes).ok()?;
    let line = |line: &str| {
        let mut parts = line.split('\t');
        Some((parts.next()?.to_owned(), parts.next()?.to_owned(), parts.next()?.parse().ok()?))
    };
    text.lines().map(line).collect::<Option<Vec<Variable>>>().map(|all| (all, words))
}
