//! The switches in which the profiles differ.

/// The rules that a program runs under. A profile is one value of this type,
/// so that nothing behind it asks which profile it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rules {
    /// A scan makes passes until one changes nothing; otherwise it makes one pass.
    pub stable: bool,
    /// All clearable transitions clear at once. Otherwise, of those that share a
    /// preceding step, the one of the best rank clears.
    pub multi_token: bool,
    /// Under `multi_token`: a clearable transition with a written priority keeps
    /// those of a worse priority, or of none, that share a step with it from
    /// clearing.
    pub numbered_exclusive: bool,
    /// Transitions clear one after the other, each with its actions at once
    /// (JGrafchart).
    pub sequential: bool,
    /// Stored actions read the values from before the pass. Otherwise each sees
    /// what the earlier ones wrote.
    pub parallel_actions: bool,
    /// Pulse actions of bodies run with the other bodies at the end of the scan
    /// (ACTION_CONTROL). Otherwise they run within the pass.
    pub late_actions: bool,
    /// A body runs once more after its Q has fallen.
    pub final_scan: bool,
    /// Step times keep their value after deactivation. Otherwise they fall to 0.
    pub keep_step_time: bool,
    /// Step times count scans, not nanoseconds.
    pub scan_clock: bool,
    /// P1 actions come first and P0 actions last. Otherwise the order of the text
    /// holds (used by `compile` alone).
    pub pulse_first: bool,
    /// Boolean S and R are stored actions. Otherwise they are inputs of control
    /// blocks (used by `compile` alone).
    pub stored_set_reset: bool,
    /// N, D and L on Boolean variables are continuous actions. Otherwise they are
    /// inputs of control blocks (used by `compile` alone).
    pub continuous: bool,
    /// `each scan` actions run before the control blocks, and not in the scan in
    /// which their step was activated.
    pub periodic_first: bool,
    /// The number of passes after which a scan ends with [`crate::FaultKind::Bound`].
    pub bound: u32,
}

/// Passes after which cycles are looked for. Most searches are shorter, and looking
/// costs a copy of the image.
pub(crate) const PATIENCE: u32 = 48;

impl Default for Rules {
    fn default() -> Rules {
        Rules::IEC60848
    }
}

impl Rules {
    /// IEC 60848.
    pub const IEC60848: Rules = Rules {
        stable: true,
        multi_token: true,
        numbered_exclusive: false,
        sequential: false,
        parallel_actions: true,
        late_actions: false,
        final_scan: false,
        keep_step_time: true,
        scan_clock: false,
        pulse_first: false,
        stored_set_reset: true,
        continuous: true,
        periodic_first: false,
        bound: 1_000_000,
    };
    /// IEC 61131-3.
    pub const IEC61131: Rules = Rules {
        stable: false,
        multi_token: false,
        parallel_actions: false,
        late_actions: true,
        final_scan: true,
        stored_set_reset: false,
        continuous: false,
        ..Rules::IEC60848
    };
    /// PL7.
    pub const PL7: Rules =
        Rules { stable: false, parallel_actions: false, continuous: false, ..Rules::IEC60848 };
    /// Unity Pro.
    pub const UNITY: Rules = Rules { final_scan: false, pulse_first: true, ..Rules::IEC61131 };
    /// JGrafchart.
    pub const JGRAFCHART: Rules = Rules {
        numbered_exclusive: true,
        sequential: true,
        keep_step_time: false,
        scan_clock: true,
        periodic_first: true,
        ..Rules::PL7
    };
}
