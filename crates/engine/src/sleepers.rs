//! Steps that a pass need not look at (`moves.rs`): each waits for variables of which none has changed
//! since the receptivity behind it was found to be FALSE.
//!
//! In a machine of 200 drives most drives wait for an input. A pass that asks each of them costs
//! what the whole machine costs, though only one drive moves.
//!
//! Sleep begins where many active steps wait, and ends where it does not pay (`Rest::on`): a chart with a few
//! tokens goes the way that it would go without.
//!
//! # Invariants
//!
//! - That a step sleeps says only that its receptivity is FALSE, so it holds whether or not the step is
//!   active.
//! - A word of 64 steps with an active one that does not sleep is stirred: whatever activates a step or wakes
//!   one tells [`Rest`]. A pass looks at stirred words alone.
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

/// Sleep begins where a pass looks at this many words of 64 steps, and most steps wait.
const MANY: u32 = 8;

/// Sleep ends where steps in more words of 64 are woken between two passes: then it saves little.
const CROWD: usize = 8;

/// Number of passes before sleep may begin again.
const PAUSE: u32 = 64;

/// The steps that can sleep, and the variables that wake them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sleepers {
    /// The steps that can sleep, a bit each; empty where there are too few.
    can: Box<[u64]>,
    /// For each word of the variable area, where its rows begin in `wakes`; one more at the end.
    of_word: Box<[u32]>,
    /// The steps that wait for it: the index of a word of 64 steps, and the bits of these there.
    wakes: Box<[(u32, u64)]>,
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
        let mut can = vec![0; hot.len().div_ceil(64)];
        let mut of_word = vec![0; t.init.len() + 1];
        let mut wakes: Vec<(u32, u64)> = Vec::new();
        let mut latest = None;
        for (word, step) in pairs {
            set_bit(&mut can, 0, step, true);
            if latest != Some((word, step / 64)) {
                latest = Some((word, step / 64));
                wakes.push((step / 64, 0));
                if let Some(n) = of_word.get_mut(word as usize + 1) {
                    *n += 1;
                }
            }
            if let Some((_, bits)) = wakes.last_mut() {
                *bits |= 1 << (step % 64);
            }
        }
        let mut begin = 0u32;
        for n in &mut of_word {
            begin += *n;
            *n = begin;
        }
        Sleepers { can: can.into(), of_word: of_word.into(), wakes: wakes.into() }
    }

    /// A new state, in which nobody sleeps.
    pub(crate) fn rest(&self) -> Rest {
        let words = self.can.len();
        let stirred = vec![0; words.div_ceil(64)].into();
        Rest { asleep: vec![0; words].into(), stirred, ..Rest::default() }
    }

    /// The steps that can sleep among the 64 of a word.
    #[inline(always)]
    fn can(&self, word: u32) -> u64 {
        self.can.get(word as usize).copied().unwrap_or(0)
    }

    /// Wakes the steps that wait for a word of the variable area.
    #[inline]
    pub(crate) fn wake(&self, rest: &mut Rest, addr: Addr) {
        let at = addr.0 as usize;
        let (Some(&from), Some(&to)) = (self.of_word.get(at), self.of_word.get(at + 1)) else { return };
        let wakes = self.wakes.get(from as usize..to as usize).unwrap_or(&[]);
        rest.woken += wakes.len();
        if rest.woken > CROWD {
            rest.on = false;
            rest.pause = PAUSE;
            return;
        }
        for (i, steps) in wakes {
            if let Some(asleep) = rest.asleep.get_mut(*i as usize) {
                *asleep &= !steps;
                set_bit(&mut rest.stirred, 0, *i, true);
            }
        }
    }
}

/// Who sleeps in a state; without words where no step can.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rest {
    /// Steps sleep. If not, `asleep` and `stirred` mean nothing.
    on: bool,
    /// Number of passes before sleep may begin.
    pause: u32,
    /// Number of words of 64 steps that were woken since the last pass.
    woken: usize,
    /// Steps whose receptivity is known to be FALSE, a bit each.
    asleep: Box<[u64]>,
    /// The words of 64 steps that a pass must look at, a bit each.
    stirred: Box<[u64]>,
}

impl Rest {
    #[inline(always)]
    pub(crate) fn is_on(&self) -> bool {
        self.on
    }

    /// Tells that a step was activated.
    #[inline(always)]
    pub(crate) fn stir(&mut self, step: u32) {
        if self.on {
            set_bit(&mut self.stirred, 0, step / 64, true);
        }
    }

    /// Ends the sleep of all steps.
    pub(crate) fn end(&mut self) {
        self.on = false;
    }

    /// Lets steps sleep from now on, if that pays. A pass has looked at `words` words of 64 steps; `found` of their active
    /// steps do not wait.
    #[inline(always)]
    pub(crate) fn begin(&mut self, words: u32, found: usize) {
        if words >= MANY && found < words as usize {
            self.try_to_begin();
        }
    }

    #[inline(never)]
    fn try_to_begin(&mut self) {
        self.pause = self.pause.saturating_sub(1);
        if self.pause == 0 && !self.asleep.is_empty() {
            self.on = true;
            self.woken = 0;
            self.asleep.fill(0);
            self.stirred.fill(u64::MAX);
        }
    }

    /// Calls `judge` with the index of each stirred word and its active steps that do not sleep. It returns
    /// those of them whose receptivity is FALSE, which sleep from now on if they can.
    #[inline(always)]
    pub(crate) fn look(
        &mut self,
        can: &Sleepers,
        active: impl Fn(u32) -> u64,
        mut judge: impl FnMut(u32, u64) -> u64,
    ) {
        self.woken = 0;
        for (k, stirred) in (0u32..).zip(&mut self.stirred) {
            let mut words = *stirred;
            while words != 0 {
                let i = k * 64 + words.trailing_zeros();
                let awake = self.asleep.get_mut(i as usize).map_or(0, |asleep| {
                    let active = active(i);
                    *asleep |= judge(i, active & !*asleep) & can.can(i);
                    active & !*asleep
                });
                if awake == 0 {
                    *stirred &= !(words & words.wrapping_neg());
                }
                words &= words - 1;
            }
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
