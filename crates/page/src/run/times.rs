//! Times in messages are in ms; times of the engine are in nanoseconds.

/// Converts ms to nanoseconds.
pub(super) fn ns(ms: f64) -> i64 {
    if ms.is_finite() { (ms.clamp(-1e12, 1e12) * 1e6).round() as i64 } else { 0 }
}

/// Converts nanoseconds to ms.
pub(super) fn ms(ns: i64) -> f64 {
    ns as f64 / 1e6
}
