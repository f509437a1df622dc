//! The files of a controller and the arguments with which they are read, so that an on-line change can
//! read them again.

use std::path::PathBuf;

use g7_model::{Nanos, ProfileName};

use crate::operator::Names;
use crate::sources;
use crate::wiring::{self, Wanted};

/// The files of a chart that is on line, and the arguments with which they are read.
#[derive(Clone, Debug)]
pub(crate) struct Origin {
    pub(crate) path: PathBuf,
    pub(crate) io: Option<PathBuf>,
    pub(crate) simulate: Option<Vec<String>>,
    pub(crate) plant: Option<String>,
    pub(crate) profile: Option<ProfileName>,
    pub(crate) scan: Option<Nanos>,
}

impl Origin {
    pub(crate) fn wanted(&self) -> Wanted<'_> {
        Wanted {
            io: self.io.as_deref(),
            simulate: self.simulate.as_deref(),
            plant: self.plant.as_deref(),
            profile: self.profile,
            scan: self.scan,
        }
    }

    /// Reads the files as they are now.
    ///
    /// # Errors
    ///
    /// Their problems as plain text.
    pub(crate) fn read(&self) -> Result<Names, String> {
        let source = sources::load(&self.path, 0).map_err(|e| e.to_string())?;
        match wiring::make(&self.path, &source, &self.wanted()).map_err(|e| e.to_string())? {
            (Some(plan), _) => Ok(Names::new(source, plan.bench, plan.wiring)),
            (None, told) => Err(anstream::adapter::strip_str(told.trim_end()).to_string()),
        }
    }
}
