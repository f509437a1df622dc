//! Parts that several tests need: chance from a seed, and a disk that fails.
#![allow(dead_code, reason = "each test file uses a part")]

use std::io;
use std::sync::{Arc, Mutex, MutexGuard};

use g7_online::Disk;

/// A small generator (splitmix64).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }
}

/// An error of a library, as a test wants it: a panic of which nobody reads on the terminal.
pub(crate) fn panics() -> ! {
    std::panic::resume_unwind(Box::new("as the test wants it"))
}

/// The present state of a disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Ill {
    #[default]
    Well,
    /// No byte can be added to a file.
    Full,
    /// It takes no bytes.
    NoWrite,
    /// It takes bytes and cannot say that they are safe.
    NoSync,
    /// The library behind it has an error.
    Panics,
}

/// A disk with a cache that a loss of power empties: of the writes since the last sync some sectors
/// arrive and others do not, in any order.
#[derive(Default)]
pub(crate) struct Plates {
    pub(crate) safe: Vec<u8>,
    pub(crate) cached: Vec<(usize, Vec<u8>)>,
    /// Calls until power fails; `None` while it does not.
    pub(crate) left: Option<u64>,
    pub(crate) ill: Ill,
}

const SECTOR: usize = 512;

impl Plates {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        self.safe[at..at + bytes.len()].copy_from_slice(bytes);
    }

    /// Loses power.
    pub(crate) fn fail(&mut self, chance: &mut Chance) {
        for (at, bytes) in std::mem::take(&mut self.cached) {
            for (k, sector) in bytes.chunks(SECTOR).enumerate() {
                match chance.below(3) {
                    0 => {}
                    // A torn sector.
                    1 => self.put(at + k * SECTOR, &sector[..chance.below(sector.len() as u64 + 1) as usize]),
                    _ => self.put(at + k * SECTOR, sector),
                }
            }
        }
        self.left = None;
    }

    fn check(&self, fails: Ill) -> io::Result<()> {
        if self.ill == Ill::Panics {
            panics();
        }
        if self.ill == fails { Err(io::Error::other("the disk fails")) } else { Ok(()) }
    }

    fn power(&mut self) -> io::Result<()> {
        match &mut self.left {
            Some(0) => Err(io::Error::other("no power")),
            Some(n) => {
                *n -= 1;
                Ok(())
            }
            None => Ok(()),
        }
    }
}

/// The file on such a disk.
#[derive(Clone, Default)]
pub(crate) struct Simulated(Arc<Mutex<Plates>>);

impl Simulated {
    pub(crate) fn plates(&self) -> MutexGuard<'_, Plates> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Another disk that holds what is safe on this one.
    pub(crate) fn copy(&self) -> Simulated {
        Simulated::holding(self.plates().safe.clone())
    }

    pub(crate) fn holding(safe: Vec<u8>) -> Simulated {
        Simulated(Arc::new(Mutex::new(Plates { safe, ..Plates::default() })))
    }
}

impl Disk for Simulated {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        let plates = self.plates();
        assert!(plates.cached.is_empty(), "read after a start only");
        Ok(plates.safe.clone())
    }

    fn create(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut plates = self.plates();
        if plates.ill == Ill::Full {
            return Err(io::ErrorKind::StorageFull.into());
        }
        plates.check(Ill::NoWrite)?;
        plates.safe = bytes.to_vec();
        plates.cached.clear();
        Ok(())
    }

    fn write(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let mut plates = self.plates();
        assert!(at as usize + bytes.len() <= plates.safe.len(), "the file does not grow");
        plates.check(Ill::NoWrite)?;
        plates.cached.push((at as usize, bytes.to_vec()));
        plates.power()
    }

    fn sync(&mut self) -> io::Result<()> {
        let mut plates = self.plates();
        plates.check(Ill::NoSync)?;
        plates.power()?;
        for (at, bytes) in std::mem::take(&mut plates.cached) {
            plates.put(at, &bytes);
        }
        Ok(())
    }
}
