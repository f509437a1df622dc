//! Two helpers of client and server.

use std::time::Duration;

use g7_model::Nanos;

pub(super) fn duration(time: Nanos) -> Duration {
    Duration::from_nanos(time.count().max(0).unsigned_abs())
}

pub(super) fn set<T>(list: &mut [T], at: usize, value: T) {
    if let Some(slot) = list.get_mut(at) {
        *slot = value;
    }
}
