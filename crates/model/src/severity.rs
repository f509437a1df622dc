//! How grave a problem is. Each code has one severity, and a problem has that of its code.

/// The effect of a problem on its chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Runs as written, but probably not as intended.
    Warning,
    /// Has no meaning in the standard and cannot be compiled.
    Error,
}

impl Severity {
    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}
