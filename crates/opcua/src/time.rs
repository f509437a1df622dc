//! Times of the io file as the library takes them.

use std::time::Duration;

use g7_model::Nanos;

/// The same time; none for one that is negative.
pub(crate) fn duration(time: Nanos) -> Duration {
    Duration::from_nanos(time.count().max(0).unsigned_abs())
}
