//! An answer: a sentence with its time, the places it speaks of, and the sentences that are its causes.
//!
//! Everything that shows answers (the terminal, the page, failed tests) reads this tree; nobody reads the sentences
//! to learn what they say, because each carries the same as a [`Fact`].

use g7_engine::{Addr, GroupId, StepId};
use g7_model::{Nanos, Said, Span};

/// A sentence of an answer, with its causes.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// The sentence.
    pub said: Said,
    /// The content of the sentence, for code that must not read the words.
    pub fact: Fact,
    /// The instant of which it is true.
    pub now: Nanos,
    /// The places in the text that it speaks of, the main one first.
    pub places: Vec<Span>,
    /// It holds as well, but did not begin the change: its own causes are not followed.
    pub aside: bool,
    /// Why it is so.
    pub causes: Vec<Cause>,
}

/// The content of a sentence. "Here a chain ends" means that a sentence with this content has no causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fact {
    /// A word of an input has this value from this scan on: here a chain ends.
    Input(Addr, u64),
    /// A word has this value from this scan on.
    Word(Addr, u64),
    /// A step is active or not from this scan on.
    Step(StepId, bool),
    /// A macro-step or a chart has an active step or none from this scan on.
    Group(GroupId, bool),
    /// A transition (rank) cleared in this scan.
    Cleared(u32),
    /// A transition (rank) did not clear in this scan.
    Waits(u32),
    /// A part of a condition is TRUE or FALSE.
    Part(bool),
    /// A time was over: here a chain ends, but for the step or condition whose time it was.
    Time,
    /// It is so since the start: here a chain ends.
    Start,
    /// It was written, forced or restarted from outside: here a chain ends.
    Outside,
    /// An action or other code did it.
    Code,
    /// An order, an enclosure or a service did it.
    Order,
    /// A fault did it: here a chain ends.
    Fault,
    /// A scan, or one of its passes.
    Scan,
    /// The causes behind this are not followed.
    Bound,
}

impl Fact {
    /// The word for this kind of sentence in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Fact::Input(..) => "input",
            Fact::Word(..) => "variable",
            Fact::Step(..) => "step",
            Fact::Group(..) => "macro-step",
            Fact::Cleared(_) | Fact::Waits(_) => "transition",
            Fact::Part(_) => "condition",
            Fact::Time => "time",
            Fact::Start => "start",
            Fact::Outside => "outside",
            Fact::Code => "action",
            Fact::Order => "order",
            Fact::Fault => "fault",
            Fact::Scan => "scan",
            Fact::Bound => "bound",
        }
    }
}

impl Cause {
    pub(crate) fn new(said: Said, fact: Fact, now: Nanos, places: impl IntoIterator<Item = Span>) -> Cause {
        let mut found: Vec<Span> = Vec::new();
        for at in places {
            if at != Span::default() && !found.contains(&at) {
                found.push(at);
            }
        }
        Cause { said, fact, now, places: found, aside: false, causes: Vec::new() }
    }

    pub(crate) fn because(mut self, causes: impl IntoIterator<Item = Cause>) -> Cause {
        self.causes.extend(causes);
        self
    }

    /// Calls `f` with each sentence and its depth, causes behind effects.
    pub fn visit<'c>(&'c self, f: &mut dyn FnMut(usize, &'c Cause)) {
        fn go<'c>(cause: &'c Cause, depth: usize, f: &mut dyn FnMut(usize, &'c Cause)) {
            f(depth, cause);
            cause.causes.iter().for_each(|c| go(c, depth + 1, f));
        }
        go(self, 0, f);
    }

    /// Each sentence with its depth, in the order in which they are read.
    pub fn lines(&self) -> Vec<(usize, &Cause)> {
        let mut lines = Vec::new();
        self.visit(&mut |depth, cause| lines.push((depth, cause)));
        lines
    }
}
