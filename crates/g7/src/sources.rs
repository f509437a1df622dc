//! Reads the files of charts.

use std::path::Path;

pub(crate) use g7_rig::Source;

use crate::failure::Failure;
use crate::files;

/// Reads a .g7 file or a file of another tool. The content decides which one it is, otherwise the
/// name.
pub(crate) fn load(path: &Path, id: u32) -> Result<Source, Failure> {
    let name = if path == Path::new("-") { "<stdin>".to_owned() } else { path.display().to_string() };
    Ok(Source::new(&name, files::read(path)?, id))
}
