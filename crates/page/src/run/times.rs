//! Times in messages are in ms.

use g7_model::Nanos;

/// Converts ms to a time; NaN and infinity give 0.
pub(super) fn time(ms: f64) -> Nanos {
    Nanos::new(if ms.is_finite() { (ms.clamp(-1e12, 1e12) * 1e6).round() as i64 } else { 0 })
}
