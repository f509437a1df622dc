//! Places for connections: so many in all, and so many of them for one address.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// The places; clones are the same.
#[derive(Clone, Debug)]
pub(super) struct Places {
    all: Arc<Semaphore>,
    taken: Arc<Mutex<BTreeMap<IpAddr, usize>>>,
    from_one: usize,
}

/// A place that is taken until this is dropped.
#[derive(Debug)]
pub(super) struct Place {
    _all: OwnedSemaphorePermit,
    places: Places,
    of: IpAddr,
}

impl Places {
    pub(super) fn new(all: usize, from_one: usize) -> Places {
        Places { all: Arc::new(Semaphore::new(all)), taken: Arc::default(), from_one }
    }

    /// Takes a place for an address, if there is one.
    pub(super) fn take(&self, of: IpAddr) -> Option<Place> {
        let all = Arc::clone(&self.all).try_acquire_owned().ok()?;
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let count = taken.get(&of).copied().unwrap_or_default();
        if count >= self.from_one {
            return None;
        }
        taken.insert(of, count + 1);
        drop(taken);
        Some(Place { _all: all, places: self.clone(), of })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.taken.lock().unwrap_or_else(PoisonError::into_inner);
        match taken.get_mut(&self.of) {
            Some(count) if *count > 1 => *count -= 1,
            Some(_) | None => {
                taken.remove(&self.of);
            }
        }
    }
}

impl Place {
    /// The address that has it.
    pub(super) fn of(&self) -> IpAddr {
        self.of
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_takes_its_share_and_no_more() {
        let places = Places::new(3, 2);
        let [a, b] = ["10.0.0.1", "10.0.0.2"].map(|text| text.parse::<IpAddr>().expect("an address"));
        let first = places.take(a).expect("free");
        let _second = places.take(a).expect("free");
        assert!(places.take(a).is_none(), "two for one");
        let third = places.take(b).expect("free");
        assert!(places.take(b).is_none(), "three in all");
        drop(first);
        assert!(places.take(a).is_some() && third.of() == b);
    }
}
