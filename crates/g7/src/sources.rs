//! Files of charts, read.

use std::path::Path;

pub(crate) use g7_rig::Source;

use crate::failure::Failure;
use crate::files;

/// Reads a .g7 file or one of another tool; which, its content says, or else its name.
pub(crate) fn load(path: &Path, id: u32) -> Result<Source, Failure> {
    let name = if path == Path::new("-") { "<stdin>".to_owned() } else { path.display().to_string() };
    Ok(Source::new(&name, files::read(path)?, id))
}
