//! Faults of a scan in words that can be told in each language; the engine has them in English alone.

use g7_engine::FaultKind;
use g7_model::{Said, say};

/// Why a scan stopped.
pub fn fault(kind: FaultKind) -> Said {
    match kind {
        FaultKind::Unstable { cycle } => {
            say!("the chart is unstable: it comes back to the same state after {cycle} passes")
        }
        FaultKind::Bound => say!("no stable situation within the bound on passes"),
        FaultKind::Overflow => say!("overflow: the result does not fit its type"),
        FaultKind::DivisionByZero => say!("division by zero"),
        FaultKind::Range => say!("a value, an index or a text is out of range"),
        FaultKind::Work => say!("a loop did not end within the work of one scan"),
        FaultKind::Forcing { .. } => say!("two forcing orders on one chart disagree"),
        FaultKind::Table => say!("the target's tables are too small for this situation"),
        FaultKind::Inputs => say!("the inputs or the time of this scan do not fit the program"),
        FaultKind::Stopped => say!("stopped by an earlier fault"),
    }
}

#[cfg(test)]
mod tests {
    use super::{FaultKind, fault};

    #[test]
    fn each_fault_is_told_in_the_words_of_the_engine() {
        for kind in [
            FaultKind::Unstable { cycle: 3 },
            FaultKind::Bound,
            FaultKind::Overflow,
            FaultKind::DivisionByZero,
            FaultKind::Range,
            FaultKind::Work,
            FaultKind::Forcing { chart: 0 },
            FaultKind::Table,
            FaultKind::Inputs,
            FaultKind::Stopped,
        ] {
            assert_eq!(fault(kind).as_str(), kind.to_string());
        }
    }
}
