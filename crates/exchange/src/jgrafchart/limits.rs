//! Limits on the content of one file.

/// The longest text of one step or transition, in bytes.
pub(super) const MOST_BYTES: usize = 1 << 16;
/// The most actions and conditions of a file; each costs much more memory than its text.
pub(super) const MOST_WORK: usize = 100_000;
