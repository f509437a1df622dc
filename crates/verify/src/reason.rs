//! Reasons why a question is not decided. `words` prints them, each with the way out.

use g7_engine::{Builtin, FaultKind};

/// The reason why a question is not decided.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// The caller stopped the search, or its time was over.
    #[default]
    Stopped,
    /// There are more states than these.
    States(usize),
    /// The states need more memory than this, in MiB.
    Memory(usize),
    /// More scans than these are needed.
    Scans(usize),
    /// So many inputs matter at once, in more combinations than are tried.
    Combinations(usize),
    /// The input with this name takes more values than are tried.
    Values(String),
    /// Some input takes more values than are tried, or there are more combinations.
    Inputs,
    /// No input satisfies the assumptions behind a run of so many scans.
    NoInput(usize),
    /// It is not known whether some input always satisfies the assumptions.
    Assumptions,
    /// The plant's chance is tried in so many ways at each tick, of more.
    Chance(usize),
    /// The plant has a fault.
    Plant(FaultKind),
    /// A condition of the property has a fault.
    Condition(FaultKind),
    /// A scan does more than it reports.
    Reports,
    /// A scan has more passes than these.
    Passes(u32),
    /// Some scan has more passes or loops than the solver follows, or a condition has no value there.
    Loops,
    /// The chart has a part that the solver does not follow.
    Part(Part),
    /// The claim is about what can follow, which the solver is not asked.
    Future,
    /// No proof was found that each state leads on within a few scans.
    LeadsOn,
    /// A time is read in another way than by comparing it with constants.
    Times,
    /// Too many times side by side decide if some run leads on.
    ManyTimes,
    /// A run that was found does not show it again in the engine.
    NotRepeated,
    /// The variable with this name is counted up, and nothing was found that ends it before its type does.
    Counter(String),
}

/// A part of a chart that bits cannot express.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Arithmetic of floating-point numbers.
    Floating,
    /// A conversion of a floating-point number or a text.
    Conversion,
    /// A product of large numbers.
    Product,
    /// A division of large numbers.
    Division,
    /// A function of numbers that are not constant.
    Function(Builtin),
    /// A random number.
    Random,
    /// A comparison of texts.
    Texts,
    /// The length of a text.
    Length,
}

impl Reason {
    /// True if no layer has more to say about the question, however much it may do.
    pub(crate) fn is_last_word(&self) -> bool {
        matches!(self, Reason::Counter(_))
    }

    /// True if more states, memory, scans or time may decide the question.
    pub fn is_of_budget(&self) -> bool {
        matches!(self, Reason::Stopped | Reason::States(_) | Reason::Memory(_) | Reason::Scans(_))
    }
}
