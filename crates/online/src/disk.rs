//! The file of the slots on a real disk.
//!
//! It is the one file that is written in place: `slots.rs` writes one of two slots, and the other one
//! stays whole. It is created whole, as all other files.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

use g7_host::write_whole;

use crate::slots::Disk;

/// A file of the system.
#[derive(Debug)]
pub struct RealDisk {
    path: PathBuf,
    file: Option<File>,
}

impl RealDisk {
    /// The file at a path; it need not be there yet.
    pub fn new(path: impl Into<PathBuf>) -> RealDisk {
        RealDisk { path: path.into(), file: None }
    }

    fn file(&mut self) -> io::Result<&mut File> {
        if self.file.is_none() {
            self.file = Some(OpenOptions::new().read(true).write(true).open(&self.path)?);
        }
        self.file.as_mut().ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

impl Disk for RealDisk {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        match self.file() {
            Ok(file) => file.read_to_end(&mut bytes).map(|_| bytes),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(bytes),
            Err(e) => Err(e),
        }
    }

    fn create(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file = None;
        write_whole(&self.path, bytes)
    }

    fn write(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let file = self.file()?;
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.file()?.sync_data()
    }
}
