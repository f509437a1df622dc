//! Steps that a pass need not look at (`moves.rs`): each waits for variables of which none has changed
//! since the receptivity behind it was found to be FALSE.
//!
//! In a machine of 200 drives most drives wait for an input. A pass that asks each of them costs
//! what the whole machine costs, though only one drive moves.
//!
//! # Invariants
//!
//! - That a step sleeps says only that its receptivity is FALSE, so it holds whether or not the step is
//!   active, and nothing need be done when it is activated or deactivated.
//! - Every change of a variable that such a receptivity reads goes through
//!   [`crate::memory::notice`] or wakes the steps itself. Outputs that follow a step directly are written
//!   without that, and so are locals: a step that waits for one of these never sleeps.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::set_bit;
use crate::ops::{Addr, Code, Op};
use crate::rows::Hot;
use crate::tables::{NONE, Receptivity, Tables};

/// With fewer such steps it is cheaper to look at each.
const FEWEST: usize = 64;

/// The steps that can sleep, and the words that wake them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sleepers {
    /// The steps that can sleep, a bit each; empty where there are too few.
    can: Box<[u64]>,
    /// For each word of the variable area, where its steps begin in `steps`; one more at the end.
    of_word: Box<[u32]>,
    steps: Box<[u32]>,
}

impl Sleepers {
    #[inline(never)]
    pub(crate) fn new(t: &Tables, hot: &[Hot]) -> Sleepers {
        let mut pairs = Vec::new();
        let mut count = 0;
        let untold = untold(t);
        for (step, row) in (0u32..).zip(hot).filter(|(_, row)| row.waits_for != NONE) {
            let Some(words) = t.transitions.get(row.rank as usize).and_then(|tr| waits(t, tr.receptivity))
            else {
                continue;
            };
            if words.iter().all(|a| untold.get(a.0 as usize) == Some(&false)) {
                count += 1;
                pairs.extend(words.iter().map(|a| (a.0, step)));
            }
        }
        if count < FEWEST {
            return Sleepers::default();
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut can = vec![0; hot.len().div_ceil(64)];
        let mut of_word = vec![0; t.init.len() + 1];
        for (word, step) in &pairs {
            set_bit(&mut can, 0, *step, true);
            if let Some(n) = of_word.get_mut(*word as usize + 1) {
                *n += 1;
            }
        }
        let mut begin = 0u32;
        for n in &mut of_word {
            begin += *n;
            *n = begin;
        }
        Sleepers {
            can: can.into(),
            of_word: of_word.into(),
            steps: pairs.into_iter().map(|(_, step)| step).collect(),
        }
    }

    /// Words of bits that say which steps sleep; 0 where none can.
    pub(crate) fn words(&self) -> usize {
        self.can.len()
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.can.is_empty()
    }

    /// The steps that can sleep among the 64 of a word.
    #[inline(always)]
    pub(crate) fn can(&self, word: u32) -> u64 {
        self.can.get(word as usize).copied().unwrap_or(0)
    }

    /// Wakes the steps that wait for a word of the variable area.
    #[inline]
    pub(crate) fn wake(&self, asleep: &mut [u64], addr: Addr) {
        let at = addr.0 as usize;
        let (Some(&from), Some(&to)) = (self.of_word.get(at), self.of_word.get(at + 1)) else { return };
        for step in self.steps.get(from as usize..to as usize).unwrap_or(&[]) {
            set_bit(asleep, 0, *step, false);
        }
    }
}

/// The words that are written without [`crate::memory::notice`].
fn untold(t: &Tables) -> Vec<bool> {
    let mut untold = vec![false; t.init.len()];
    let direct = t.steps.iter().map(|s| s.direct.0);
    for at in direct.chain(t.locals.start..t.locals.end) {
        if let Some(word) = untold.get_mut(at as usize) {
            *word = true;
        }
    }
    untold
}

/// The words that a receptivity waits for; `None` if it depends on more than these.
fn waits(t: &Tables, receptivity: Receptivity) -> Option<Vec<Addr>> {
    match receptivity {
        Receptivity::True => None,
        Receptivity::Word(a) | Receptivity::NotWord(a) => Some(vec![a]),
        Receptivity::Code(Code { start, end }) => {
            let word = |op: &Op| match *op {
                Op::Load(a) => Some(Some(a)),
                Op::Push(_) | Op::Not | Op::And | Op::Or | Op::Xor | Op::Compare(..) => Some(None),
                _ => None,
            };
            let words: Option<Vec<_>> = t.code.get(start as usize..end as usize)?.iter().map(word).collect();
            Some(words?.into_iter().flatten().collect())
        }
    }
}
