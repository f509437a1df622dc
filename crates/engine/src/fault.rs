//! The faults that stop a scan.

/// A scan that could not be finished. The state stays as it was reached; the
/// outputs have their safe values; further scans are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The kind.
    pub kind: FaultKind,
    /// The instruction in [`crate::Tables::code`], where one was running.
    pub at: Option<u32>,
}

/// The kinds of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// A whole state recurred within the scan, so the passes would never end.
    Unstable {
        /// Passes from one occurrence to the next. Calling [`crate::pass`] so
        /// often walks through the situations of the cycle.
        cycle: u32,
    },
    /// No stable situation within the bound on passes.
    Bound,
    /// A result that its type cannot hold.
    Overflow,
    /// Division or remainder by zero.
    DivisionByZero,
    /// An index, a MUX selector, a text or a value of a type with bounds that is out of range.
    Range,
    /// More than [`crate::WORK`] rounds of loops in a scan.
    Work,
    /// Two forcing orders on one chart disagree.
    Forcing {
        /// The chart: row of [`crate::Tables::charts`].
        chart: u32,
    },
    /// More steps active or transitions enabled than the target's tables hold.
    Table,
    /// There are more or fewer inputs than the program has, or time went back.
    Inputs,
    /// An earlier scan had a fault; only a restart helps.
    Stopped,
}

impl FaultKind {
    /// A fault of no instruction.
    pub const fn nowhere(self) -> Fault {
        Fault { kind: self, at: None }
    }

    /// The word for it in `expect fault …` and in traces.
    pub const fn word(self) -> &'static str {
        match self {
            FaultKind::Unstable { .. } => "unstable",
            FaultKind::Bound | FaultKind::Work => "bound",
            FaultKind::Overflow => "overflow",
            FaultKind::DivisionByZero => "division",
            FaultKind::Range => "range",
            FaultKind::Forcing { .. } => "forcing",
            FaultKind::Table => "table",
            FaultKind::Inputs => "inputs",
            FaultKind::Stopped => "stopped",
        }
    }
}

impl core::fmt::Display for FaultKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            FaultKind::Unstable { cycle } => {
                write!(f, "the chart is unstable: it comes back to the same state after {cycle} passes")
            }
            FaultKind::Bound => f.write_str("no stable situation within the bound on passes"),
            FaultKind::Overflow => f.write_str("overflow: the result does not fit its type"),
            FaultKind::DivisionByZero => f.write_str("division by zero"),
            FaultKind::Range => f.write_str("a value, an index or a text is out of range"),
            FaultKind::Work => f.write_str("a loop did not end within the work of one scan"),
            FaultKind::Forcing { .. } => f.write_str("two forcing orders on one chart disagree"),
            FaultKind::Table => f.write_str("the target's tables are too small for this situation"),
            FaultKind::Inputs => f.write_str("the inputs or the time of this scan do not fit the program"),
            FaultKind::Stopped => f.write_str("stopped by an earlier fault"),
        }
    }
}
