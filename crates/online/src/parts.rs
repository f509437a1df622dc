//! The parts of a controller that belong to its chart, so that an on-line change can exchange them.

use g7_host::Runner;
use g7_model::Nanos;

use crate::exchange::Writer;
use crate::forces::{FORCES, Forced};
use crate::keep::Keep;
use crate::notes::Noting;
use crate::sight::Showing;
use crate::wired::{WhileBad, Wired};
use crate::word::{Source, Target};

/// The words of a run that a device gives and gets.
#[derive(Clone, Debug, Default)]
pub struct Handles {
    /// The words that the device gives, and what each has while its value is bad.
    pub inputs: Vec<(Target, WhileBad)>,
    /// The words that the device gets, and the safe value of each; `None` for what is only shown.
    pub outputs: Vec<(Source, Option<u64>)>,
    /// Input words that are 1 while the device answers.
    pub good: Vec<u32>,
}

impl Handles {
    /// Those of a device.
    pub fn of(wired: &Wired) -> Handles {
        Handles {
            inputs: wired.inputs.iter().map(|i| (i.target, i.bad)).collect(),
            outputs: wired.outputs.iter().map(|o| (o.source, o.out.safe)).collect(),
            good: wired.good.clone(),
        }
    }
}

/// The values that are kept, on their way to the one who writes them.
#[derive(Debug)]
pub(crate) struct Keeping {
    pub(crate) keep: Keep,
    pub(crate) to_disk: Writer,
    pub(crate) due: Nanos,
}

impl Keeping {
    pub(crate) fn new(keep: Keep, to_disk: Writer) -> Keeping {
        Keeping { keep, to_disk, due: Nanos::ZERO }
    }
}

/// A controller between two scans.
pub struct Picture {
    pub(crate) runner: Runner,
    pub(crate) forces: Vec<Forced>,
    /// The number of changes that the controller has seen.
    pub(crate) revision: u64,
}

impl Picture {
    /// Room for pictures of a controller with such a run.
    pub fn of(runner: &Runner) -> Picture {
        let mut runner = runner.clone();
        runner.reserve_forces(FORCES);
        Picture { runner, forces: Vec::with_capacity(FORCES), revision: 0 }
    }
}

/// The parts of a controller that belong to its chart; behind a change, those of the chart before.
pub struct Successor {
    pub(crate) runner: Runner,
    pub(crate) forces: Vec<Forced>,
    /// One for each device.
    pub(crate) handles: Vec<Handles>,
    pub(crate) keeping: Option<Keeping>,
    pub(crate) showing: Option<Showing>,
    pub(crate) noting: Option<Noting>,
    pub(crate) revision: u64,
}
