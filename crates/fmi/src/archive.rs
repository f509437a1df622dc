//! The zip archive of an FMU, in memory. The caller writes its files where the library can be loaded.

use std::io::{Cursor, Read};

/// The greatest size of all unpacked files together, in bytes.
const MOST: u64 = 1 << 30;
/// The greatest number of files.
const FILES: usize = 20_000;

/// A file of the archive: its path (folders are separated by `/`, and `..` does not occur) and its content.
pub type File = (String, Vec<u8>);

/// All files of an archive.
///
/// # Errors
///
/// It is no zip archive, is broken or too large, or has a file outside of its folder.
pub fn unpack(bytes: &[u8]) -> Result<Vec<File>, String> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| format!("no FMU: {e}"))?;
    if archive.len() > FILES {
        return Err(format!("more than {FILES} files"));
    }
    let (mut files, mut left) = (Vec::new(), MOST);
    for i in 0..archive.len() {
        let entry = archive.by_index(i).map_err(|e| format!("file {i} of the archive: {e}"))?;
        if entry.is_dir() {
            continue;
        }
        let written = entry.name().map_err(|e| format!("file {i} of the archive: {e}"))?.into_owned();
        let Some(path) = entry.enclosed_name() else {
            return Err(format!("`{written}` lies outside of the archive"));
        };
        let mut content = Vec::new();
        // One byte more than is allowed tells that there is more.
        entry.take(left + 1).read_to_end(&mut content).map_err(|e| format!("`{written}`: {e}"))?;
        left = left
            .checked_sub(content.len() as u64)
            .ok_or_else(|| format!("the archive holds more than {MOST} bytes"))?;
        files.push((path.to_string_lossy().replace('\\', "/"), content));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_no_archive_are_refused() {
        for bytes in [&b""[..], b"PK", b"PK\x05\x06 and more", &[0; 100]] {
            assert!(unpack(bytes).is_err());
        }
    }
}
