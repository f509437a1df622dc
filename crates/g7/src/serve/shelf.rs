//! Files that are being sent, each once, however many read it.
//!
//! A copy lives as long as somebody reads it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use axum::body::Bytes;

/// The copies by name. A name belongs to one content.
#[derive(Debug)]
pub(super) struct Shelf(Mutex<BTreeMap<String, Weak<Vec<u8>>>>);

/// A copy that somebody reads.
struct Read(Arc<Vec<u8>>);

impl AsRef<[u8]> for Read {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl Shelf {
    pub(super) const fn new() -> Shelf {
        Shelf(Mutex::new(BTreeMap::new()))
    }

    /// The copy with a name; it is made if nobody reads it now.
    pub(super) fn of(&self, name: &str, make: impl FnOnce() -> Option<Vec<u8>>) -> Option<Bytes> {
        let mut copies = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        copies.retain(|_, copy| copy.strong_count() > 0);
        let known = copies.get(name).and_then(Weak::upgrade);
        let copy = match known {
            Some(copy) => copy,
            None => {
                let made = Arc::new(make()?);
                copies.insert(name.to_owned(), Arc::downgrade(&made));
                made
            }
        };
        Some(Bytes::from_owner(Read(copy)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_there_once_as_long_as_it_is_read() {
        let shelf = Shelf::new();
        let first = shelf.of("a", || Some(vec![1, 2])).expect("made");
        let second = shelf.of("a", || None).expect("the same");
        assert_eq!((first.as_ptr(), &second[..]), (second.as_ptr(), &[1, 2][..]));
        drop(first);
        assert!(shelf.of("a", || None).is_some(), "one still reads it");
        drop(second);
        assert!(shelf.of("a", || None).is_none(), "nobody reads it");
    }
}
