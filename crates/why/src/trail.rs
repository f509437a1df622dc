//! How far an answer has gone: what it has told, and how much it may still tell.

use std::collections::BTreeSet;

use crate::signal::{Pos, Signal};

/// Most sentences that are followed in one answer.
const MOST: u32 = 200;
/// Most causes one behind the other.
const DEEPEST: u32 = 40;

/// Something that an answer follows once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Event {
    Changed(Signal),
    Cleared(u32),
}

/// How an answer goes on behind a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// Tell its causes.
    On,
    /// They were told before.
    Told,
    /// The bound is reached.
    Bound,
    /// Only a few causes were asked for.
    Short,
}

pub(crate) struct Trail {
    told: BTreeSet<(Event, Pos)>,
    left: u32,
    deep: u32,
    most: u32,
    short: bool,
}

impl Trail {
    /// For an answer that goes back as far as it can.
    pub(crate) fn whole() -> Trail {
        Trail { told: BTreeSet::new(), left: MOST, deep: 0, most: DEEPEST, short: false }
    }

    /// For an answer that names each event and so many causes behind it.
    pub(crate) fn short(causes: u32) -> Trail {
        Trail { most: causes, short: true, ..Trail::whole() }
    }

    /// Begins to follow an event; where it is [`Way::On`], [`Trail::leave`] ends it.
    pub(crate) fn enter(&mut self, event: Event, pos: Pos) -> Way {
        if self.deep >= self.most {
            return if self.short { Way::Short } else { Way::Bound };
        }
        if self.left == 0 {
            return Way::Bound;
        }
        if !self.told.insert((event, pos)) {
            return Way::Told;
        }
        self.left -= 1;
        self.deep += 1;
        Way::On
    }

    pub(crate) fn leave(&mut self) {
        self.deep -= 1;
    }
}
