//! The table of action qualifiers.

/// The action qualifiers of IEC 61131-3 (2003, table 45).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Qualifier {
    /// Non-stored: follows the step.
    N,
    /// Set (stored).
    S,
    /// Overriding reset.
    R,
    /// Time limited.
    L,
    /// Time delayed.
    D,
    /// Pulse.
    P,
    /// Pulse on deactivation.
    P0,
    /// Pulse on activation.
    P1,
    /// Stored and time delayed.
    SD,
    /// Delayed and stored.
    DS,
    /// Stored and time limited.
    SL,
}

/// How a qualified action takes part in the evolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lasting {
    /// While the step is active, within its time: a continuous action.
    WithStep,
    /// Until a reset, also after the step is left.
    UntilReset,
    /// In one scan, or at one moment.
    Pulse,
    /// It ends the stored action of others.
    Reset,
}

impl Qualifier {
    /// All eleven.
    pub const ALL: [Qualifier; 11] = [
        Qualifier::N,
        Qualifier::S,
        Qualifier::R,
        Qualifier::L,
        Qualifier::D,
        Qualifier::P,
        Qualifier::P0,
        Qualifier::P1,
        Qualifier::SD,
        Qualifier::DS,
        Qualifier::SL,
    ];

    /// The row of a qualifier: its name, whether a time stands behind it, how long its action lasts.
    const fn row(self) -> (&'static str, bool, Lasting) {
        match self {
            Qualifier::N => ("N", false, Lasting::WithStep),
            Qualifier::S => ("S", false, Lasting::UntilReset),
            Qualifier::R => ("R", false, Lasting::Reset),
            Qualifier::L => ("L", true, Lasting::WithStep),
            Qualifier::D => ("D", true, Lasting::WithStep),
            Qualifier::P => ("P", false, Lasting::Pulse),
            Qualifier::P0 => ("P0", false, Lasting::Pulse),
            Qualifier::P1 => ("P1", false, Lasting::Pulse),
            Qualifier::SD => ("SD", true, Lasting::UntilReset),
            Qualifier::DS => ("DS", true, Lasting::UntilReset),
            Qualifier::SL => ("SL", true, Lasting::UntilReset),
        }
    }

    /// As written.
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// The qualifier of this name.
    pub fn named(name: &str) -> Option<Qualifier> {
        Qualifier::ALL.into_iter().find(|q| q.name() == name)
    }

    /// True if a time stands behind it.
    pub const fn timed(self) -> bool {
        self.row().1
    }

    /// How long its action lasts.
    pub const fn lasting(self) -> Lasting {
        self.row().2
    }
}
