//! Levels on disk: what one process has found, a file for each level, and the outcome of each search that has
//! ended.
//!
//! A file is written aside and renamed when it is whole, so a process that is killed leaves whole files
//! only. It is synchronised while the next levels are searched. Its end has a hash of all, so after a power
//! cut a file that is not whole counts as missing.
//!
//! A level is a list of records in the order in which one thread finds its states: the rank in the level,
//! the key (the rank of the state before, and the number of the scan), the packed image, the packed
//! inputs. Behind them stand the findings of all levels up to this one.

use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

use crate::Error;
use crate::meet::plain;

/// The first word of each file.
const MAGIC: u64 = 0x6737_6C65_7665_6C01;
/// Words before the records of a level.
const HEAD: usize = 6;
/// A file is read that has no more bytes than so many times the memory for states: a level alone takes more room
/// there than in memory.
const ROOM: u64 = 4;
/// And no fewer than these.
const LEAST: u64 = 64 << 20;

/// The folder of a process.
pub(crate) struct Levels {
    folder: PathBuf,
    /// The search, the number of this process, and the number of processes: a file of another search is refused.
    work: [u64; 3],
    /// Most bytes of a file that is read.
    most: u64,
    /// The file that is being synchronised.
    sync: Option<JoinHandle<io::Result<()>>>,
}

/// A level of one process.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Level {
    /// Words of a record.
    pub(crate) width: usize,
    /// The records.
    pub(crate) records: Vec<u64>,
    /// The bits that a packed image keeps, the findings of all levels up to this one, and the ranks of the
    /// states of the level before that no scan leads on from.
    pub(crate) rest: Vec<u64>,
}

impl Levels {
    /// The folder of a process for a search that may keep so many bytes of states; it is made if it is not
    /// there.
    ///
    /// # Errors
    ///
    /// The folder cannot be made, or it has files of another search.
    pub(crate) fn open(
        folder: &Path,
        task: u64,
        me: usize,
        peers: usize,
        bytes: usize,
    ) -> Result<Levels, Error> {
        let folder = folder.join(format!("process-{me}"));
        let most = (bytes as u64).saturating_mul(ROOM).max(LEAST);
        let levels = Levels { folder, work: [task, me as u64, peers as u64], most, sync: None };
        fs::create_dir_all(&levels.folder).map_err(|e| levels.error(&levels.folder, &e))?;
        let mark = levels.folder.join("search");
        match read_words(&mark, levels.most) {
            Some(words) if words != levels.work => Err(Error::Usage(format!(
                "{} keeps the levels of another search; name another folder, or remove it",
                folder_name(&levels.folder)
            ))),
            Some(_) => Ok(levels),
            None => {
                levels.write(&mark, &[&levels.work])?;
                Ok(levels)
            }
        }
    }

    fn error(&self, path: &Path, e: &io::Error) -> Error {
        Error::Disk(format!("cannot write {}: {}", path.display(), plain(e)))
    }

    fn level(&self, job: usize, level: usize) -> PathBuf {
        self.folder.join(format!("search-{job}-level-{level}"))
    }

    fn outcome(&self, job: usize) -> PathBuf {
        self.folder.join(format!("search-{job}"))
    }

    /// Writes a level as a whole. While the disk is still busy with an earlier one, it is not asked to
    /// take this one at once.
    ///
    /// # Errors
    ///
    /// The disk is full, or refuses.
    pub(crate) fn keep(&mut self, job: usize, number: usize, level: &Level) -> Result<(), Error> {
        let path = self.level(job, number);
        let [task, me, _] = self.work;
        let head = [MAGIC, task, me, number as u64, level.width as u64, level.records.len() as u64];
        let file = self.write(&path, &[&head, &level.records, &level.rest])?;
        if self.sync.as_ref().is_none_or(JoinHandle::is_finished) {
            self.synchronised()?;
            self.sync = Some(std::thread::spawn(move || file.sync_all()));
        }
        Ok(())
    }

    /// Waits until the disk has what it was asked to take.
    fn synchronised(&mut self) -> Result<(), Error> {
        let done = self.sync.take().map_or(Ok(()), |t| t.join().unwrap_or(Ok(())));
        done.map_err(|e| self.error(&self.folder, &e))
    }

    /// Writes a file aside, with a hash at its end, and gives it its name.
    fn write(&self, path: &Path, parts: &[&[u64]]) -> Result<File, Error> {
        let aside = path.with_extension("part");
        let write = || -> io::Result<File> {
            let mut file = BufWriter::with_capacity(1 << 18, File::create(&aside)?);
            let mut hash = 0;
            for part in parts {
                for word in *part {
                    hash = mix(hash, *word);
                    file.write_all(&word.to_le_bytes())?;
                }
            }
            file.write_all(&hash.to_le_bytes())?;
            let file = file.into_inner().map_err(|e| e.into_error())?;
            fs::rename(&aside, path)?;
            Ok(file)
        };
        write().map_err(|e| self.error(path, &e))
    }

    /// A level, if it is there and whole.
    pub(crate) fn read(&self, job: usize, number: usize) -> Option<Level> {
        let words = read_words(&self.level(job, number), self.most)?;
        let (head, body) = words.split_at_checked(HEAD)?;
        let [task, me, _] = self.work;
        let [magic, of, process, level, width, count] = <[u64; HEAD]>::try_from(head).ok()?;
        if [magic, of, process, level] != [MAGIC, task, me, number as u64] {
            return None;
        }
        let (width, count) = (usize::try_from(width).ok()?, usize::try_from(count).ok()?);
        let (records, rest) = body.split_at_checked(count)?;
        let fits = width > 2 && count.is_multiple_of(width);
        fits.then(|| Level { width, records: records.to_vec(), rest: rest.to_vec() })
    }

    /// The number of levels that are there, one behind the other from the first.
    pub(crate) fn count(&self, job: usize) -> usize {
        (0..).take_while(|n| self.level(job, *n).exists()).count()
    }

    /// Tells whether so many levels can be read back.
    ///
    /// # Errors
    ///
    /// One of them is larger than the memory allows. It may be whole, so it is not removed.
    pub(crate) fn fit(&self, job: usize, count: usize) -> Result<(), Error> {
        for path in (0..count).map(|n| self.level(job, n)) {
            let bytes = fs::metadata(&path).map_or(0, |m| m.len());
            if bytes > self.most {
                return Err(Error::Usage(format!(
                    "{} has {} MiB, too much for the memory of this search; give more with --memory, or remove the \
                     folder",
                    path.display(),
                    bytes >> 20
                )));
            }
        }
        Ok(())
    }

    /// Removes the levels from this one on.
    pub(crate) fn forget(&mut self, job: usize, from: usize) -> Result<(), Error> {
        self.synchronised()?;
        // The last one first, so that no gap remains where this is interrupted.
        for number in (from..self.count(job)).rev() {
            let path = self.level(job, number);
            fs::remove_file(&path).map_err(|e| self.error(&path, &e))?;
        }
        Ok(())
    }

    /// The key of the state with this rank in a level, if it is one of this process.
    pub(crate) fn key(&self, job: usize, number: usize, rank: u64) -> Option<u64> {
        let mut file = File::open(self.level(job, number)).ok()?;
        let [.., width, count] = words_at::<HEAD>(&mut file, 0)?;
        let (mut low, mut high) = (0, count / width.max(1));
        while low < high {
            let middle = low + (high - low) / 2;
            let [found, key] =
                words_at::<2>(&mut file, middle.checked_mul(width)?.checked_add(HEAD as u64)?)?;
            match found.cmp(&rank) {
                std::cmp::Ordering::Equal => return Some(key),
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }

    /// Keeps the outcome of a search that has ended.
    pub(crate) fn keep_outcome(&mut self, job: usize, words: &[u64]) -> Result<(), Error> {
        let path = self.outcome(job);
        let file = self.write(&path, &[words])?;
        file.sync_all().map_err(|e| self.error(&path, &e))
    }

    /// The outcome of a search that has ended.
    pub(crate) fn read_outcome(&self, job: usize) -> Option<Vec<u64>> {
        read_words(&self.outcome(job), self.most)
    }
}

fn folder_name(path: &Path) -> String {
    path.parent().unwrap_or(path).display().to_string()
}

fn mix(hash: u64, word: u64) -> u64 {
    (hash.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// The words of a file of at most so many bytes whose hash is right, without it.
fn read_words(path: &Path, most: u64) -> Option<Vec<u64>> {
    let file = File::open(path).ok()?;
    if file.metadata().ok()?.len() > most {
        return None;
    }
    let mut bytes = Vec::new();
    BufReader::new(file.take(most)).read_to_end(&mut bytes).ok()?;
    let (words, rest) = bytes.as_chunks();
    let mut words: Vec<u64> = words.iter().map(|b| u64::from_le_bytes(*b)).collect();
    let hash = words.pop()?;
    (rest.is_empty() && words.iter().fold(0, |h, w| mix(h, *w)) == hash).then_some(words)
}

fn words_at<const N: usize>(file: &mut File, word: u64) -> Option<[u64; N]> {
    file.seek(SeekFrom::Start(word.checked_mul(8)?)).ok()?;
    let mut bytes = [[0u8; 8]; N];
    file.read_exact(bytes.as_flattened_mut()).ok()?;
    Some(bytes.map(u64::from_le_bytes))
}

#[cfg(test)]
mod tests {
    use super::{HEAD, LEAST, Level, Levels, MAGIC};
    use crate::Error;

    #[test]
    fn a_head_with_numbers_too_large_gives_no_key() {
        let folder = std::env::temp_dir().join(format!("g7-levels-{}", std::process::id()));
        let levels = Levels::open(&folder, 7, 0, 1, 0).unwrap();
        for (width, count) in [(3, u64::MAX), (u64::MAX / 4, u64::MAX), (1, u64::MAX), (0, u64::MAX)] {
            let head: [u64; HEAD] = [MAGIC, 7, 0, 0, width, count];
            levels.write(&levels.level(0, 0), &[&head]).unwrap();
            assert_eq!(levels.key(0, 0, 5), None);
            assert_eq!(levels.read(0, 0), None);
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_level_that_is_too_large_is_refused_and_stays() {
        let folder = std::env::temp_dir().join(format!("g7-large-{}", std::process::id()));
        let mut levels = Levels::open(&folder, 7, 0, 1, 0).unwrap();
        let level = Level { width: 3, records: vec![1; 30], rest: Vec::new() };
        levels.keep(0, 0, &level).unwrap();
        assert_eq!((levels.fit(0, 1), levels.read(0, 0)), (Ok(()), Some(level)));
        let path = levels.level(0, 0);
        // A hole takes no room on the disk.
        std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(LEAST + 8).unwrap();
        let Err(Error::Usage(told)) = levels.fit(0, 1) else { panic!("it is too large") };
        assert!(told.contains("64 MiB") && told.contains("--memory"), "{told}");
        assert_eq!(levels.read(0, 0), None);
        assert!(path.exists());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
