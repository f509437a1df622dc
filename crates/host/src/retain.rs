//! Keeps the values of retained variables over a restart.

use std::fs;
use std::io;
use std::path::Path;

use crate::hash::Fnv;
use crate::whole::write_whole;

/// The names and types of the retained variables, and the number of words of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// For each variable: qualified name, type as written, number of words.
    pub variables: Vec<(String, String, u32)>,
}

impl Layout {
    /// FNV-1a over names, types and sizes. A file that was written with another layout is refused.
    pub fn hash(&self) -> u64 {
        let mut hash = Fnv::default();
        for (name, ty, words) in &self.variables {
            hash.add(name.as_bytes());
            hash.add(&[0]);
            hash.add(ty.as_bytes());
            hash.add(&[0]);
            hash.add(&words.to_le_bytes());
        }
        hash.value()
    }

    fn words(&self) -> usize {
        self.variables.iter().map(|v| v.2 as usize).sum()
    }
}

/// Why retained values could not be loaded.
#[derive(Debug)]
pub enum RetainError {
    /// The file cannot be read or written.
    Io(io::Error),
    /// The file belongs to other variables.
    Layout,
    /// The file is damaged.
    Damaged,
}

impl std::fmt::Display for RetainError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RetainError::Io(e) => write!(f, "{e}"),
            RetainError::Layout => f.write_str("it was written by a chart with other retained variables"),
            RetainError::Damaged => f.write_str("it is damaged"),
        }
    }
}

impl std::error::Error for RetainError {}

/// The words of the retained variables, in the order of the layout.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Retained {
    /// The words of all variables.
    pub words: Vec<u64>,
}

const MAGIC: &[u8; 8] = b"g7retain";

impl Retained {
    /// Writes the words to a file, completely or not at all.
    ///
    /// # Errors
    ///
    /// The file cannot be written; the previous file is unchanged.
    pub fn save(&self, layout: &Layout, path: &Path) -> io::Result<()> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(layout.hash().to_le_bytes());
        self.words.iter().for_each(|w| bytes.extend(w.to_le_bytes()));
        let check = Fnv::of(&bytes);
        bytes.extend(check.to_le_bytes());
        write_whole(path, &bytes)
    }

    /// Reads the words from a file; `None` if there is no file yet.
    ///
    /// # Errors
    ///
    /// The file is unreadable, has another layout, or is damaged.
    pub fn load(layout: &Layout, path: &Path) -> Result<Option<Retained>, RetainError> {
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(RetainError::Io(e)),
        };
        let Some((body, check)) = bytes.split_last_chunk::<8>() else { return Err(RetainError::Damaged) };
        let sum = Fnv::of(body);
        let body = body.strip_prefix(MAGIC).ok_or(RetainError::Damaged)?;
        if sum != u64::from_le_bytes(*check) {
            return Err(RetainError::Damaged);
        }
        let (hash, body) = body.split_first_chunk::<8>().ok_or(RetainError::Damaged)?;
        if u64::from_le_bytes(*hash) != layout.hash() {
            return Err(RetainError::Layout);
        }
        let (words, rest) = body.as_chunks::<8>();
        if !rest.is_empty() || words.len() != layout.words() {
            return Err(RetainError::Damaged);
        }
        Ok(Some(Retained { words: words.iter().map(|w| u64::from_le_bytes(*w)).collect() }))
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("g7-retain-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        path
    }

    fn layout(ty: &str) -> Layout {
        Layout { variables: vec![("count".into(), ty.into(), 1), ("say".into(), "STRING".into(), 2)] }
    }

    #[test]
    fn what_was_saved_is_loaded_under_the_same_layout_only() {
        let folder = folder("load");
        let path = folder.join("kept");
        assert_eq!(Retained::load(&layout("INT"), &path).unwrap(), None);
        let kept = Retained { words: vec![7, 8, 9] };
        kept.save(&layout("INT"), &path).unwrap();
        assert_eq!(Retained::load(&layout("INT"), &path).unwrap(), Some(kept));
        assert!(matches!(Retained::load(&layout("DINT"), &path), Err(RetainError::Layout)));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn every_damaged_byte_and_every_cut_is_noticed() {
        let folder = folder("damage");
        let path = folder.join("kept");
        Retained { words: vec![1, 2, 3] }.save(&layout("INT"), &path).unwrap();
        let good = fs::read(&path).unwrap();
        for i in 0..good.len() {
            let mut bad = good.clone();
            bad[i] ^= 0x10;
            fs::write(&path, &bad).unwrap();
            assert!(Retained::load(&layout("INT"), &path).is_err(), "byte {i}");
            fs::write(&path, &good[..i]).unwrap();
            assert!(Retained::load(&layout("INT"), &path).is_err(), "cut at {i}");
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
