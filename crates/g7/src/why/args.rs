//! The arguments of `g7 why`.

use std::path::PathBuf;

use g7_model::{Nanos, ProfileName};

use crate::form::{EXIT_CODES, Format};
use crate::values::{self, Assign};

/// The arguments of `g7 why`.
#[derive(clap::Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 why tank fill 12.34s --set start=1@2s    why this output has its value then
  g7 why tank X1 5s                why step 1 is active then, or is not
  g7 why tank '0 -> 1' 5s          why this transition does not clear then
  g7 why tank 5s                   what happened in the scan at 5s
  g7 run tank --headless --for 20s --trace run.csv && g7 why run.csv drain 12.34s --chart tank

A trace is that of `g7 run --trace` (.csv), a record that of `g7 run --record`. The run is made again from
its inputs; where it takes another course than the trace, the first difference is told.

{EXIT_CODES}"))]
pub(crate) struct Why {
    /// A chart, or a folder with a chart.g7, which is run; or the trace or record of a run.
    pub(super) run: PathBuf,
    /// A variable, a step (`X12`, `G.X12`) or a transition (its label, or `1 -> 2`); without it, all that
    /// happened in the scan at the time.
    pub(super) name: Option<String>,
    /// The time, as in `12.34s`; without it, the end of the run.
    pub(super) time: Option<String>,
    /// The chart of a trace or record [default: the chart of its name beside it, or the one of its folder].
    #[arg(long, value_name = "PATH")]
    pub(super) chart: Option<PathBuf>,
    /// How long to run [default: up to the time that is asked for, or 10s].
    #[arg(long = "for", value_parser = values::duration, value_name = "TIME")]
    pub(super) duration: Option<Nanos>,
    /// Set an input, a variable, a system bit (`%S21`) or a state of the plant at a time: `start=1@2s`.
    #[arg(long = "set", value_parser = values::assign, value_name = "NAME=VALUE@TIME")]
    pub(super) set: Vec<Assign>,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(super) profile: Option<ProfileName>,
    /// Time between scans, instead of the file's own (10ms).
    #[arg(long, value_parser = values::duration, value_name = "TIME")]
    pub(super) scan: Option<Nanos>,
    /// The plant to use if there are several; `none` for no plant.
    #[arg(long, value_name = "NAME")]
    pub(super) plant: Option<String>,
    /// The seed of the plant's random numbers; the same seed gives the same run.
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    pub(super) seed: u64,
    /// For people or for programs.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(super) format: Format,
}
