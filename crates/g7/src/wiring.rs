//! The io file of a chart, held against the chart: for `run --online` and `devices`.

use std::path::{Path, PathBuf};

use g7_model::{FileId, Nanos, Problem, ProfileName, Severity};
use g7_online::Wiring;
use g7_online::setup::{self, Setup};
use g7_rig::{Bench, Options};

use crate::failure::Failure;
use crate::files;
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::Source;

/// A chart with its wiring.
pub(crate) struct Plan {
    pub(crate) bench: Bench,
    pub(crate) setup: Setup,
    pub(crate) wiring: Wiring,
    pub(crate) io: PathBuf,
}

/// The arguments that change the wiring.
#[derive(Default)]
pub(crate) struct Wanted<'a> {
    /// The io file, where it is not that of the chart.
    pub(crate) io: Option<&'a Path>,
    /// Devices in whose place there is the plant; all for none named.
    pub(crate) simulate: Option<&'a [String]>,
    pub(crate) plant: Option<&'a str>,
    pub(crate) profile: Option<ProfileName>,
    pub(crate) scan: Option<Nanos>,
}

/// Reads the io file and wires the chart, or prints the problems.
pub(crate) fn plan(path: &Path, source: &Source, wanted: &Wanted<'_>) -> Result<Option<Plan>, Failure> {
    let io = wanted.io.map_or_else(|| path.with_extension("io.toml"), Path::to_path_buf);
    if wanted.io.is_none() && !io.is_file() {
        let what =
            format!("{} is missing: it says which devices the inputs and outputs are wired to", io.display());
        return Err(Failure::Usage(format!("{what}; --io names another file")));
    }
    let text = files::read(&io)?;
    let file = Source::plain(&io.display().to_string(), text);
    let (mut setup, mut problems) = setup::read(&file.text, FileId(1));
    if file.text.as_bytes() != file.bytes {
        return Err(Failure::Usage(format!("{} is not UTF-8 text", io.display())));
    }
    simulate(&mut setup, wanted.simulate)?;
    // Without a plant in place of a device there is none.
    let plant = wanted.plant.or(if wanted.simulate.is_none() { Some("none") } else { None });
    let scan = wanted.scan.or(setup.controller.period.as_ref().map(|p| p.value));
    let options = Options { profile: wanted.profile, scan, plant, asks: &[] };
    let Some(bench) = build(source, &options)? else { return Ok(None) };
    let (wiring, wrong) = g7_online::wire(&bench, &setup);
    problems.extend(wrong);
    show(&file, &problems);
    let errors = problems.iter().any(|p: &Problem| p.severity() == Severity::Error);
    Ok((!errors).then_some(Plan { bench, setup, wiring, io }))
}

/// Takes the devices out that the plant stands for.
fn simulate(setup: &mut Setup, names: Option<&[String]>) -> Result<(), Failure> {
    let Some(names) = names else { return Ok(()) };
    let there = |name: &String| setup.devices.iter().any(|d| d.name.value == *name);
    if let Some(name) = names.iter().find(|name| !there(name)) {
        let all: Vec<&str> = setup.devices.iter().map(|d| d.name.value.as_str()).collect();
        return Err(Failure::Usage(format!(
            "--simulate: the io file has no device `{name}`; it has {}",
            all.join(", ")
        )));
    }
    let simulated = |name: &String| names.is_empty() || names.contains(name);
    setup.inputs.retain(|c| !simulated(&c.device.value));
    setup.outputs.retain(|c| !simulated(&c.device.value));
    setup.shown.retain(|c| !simulated(&c.device.value));
    Ok(())
}

/// Compiles a source, or prints its problems.
pub(crate) fn build(source: &Source, options: &Options<'_>) -> Result<Option<Bench>, Failure> {
    let (bench, problems) = g7_rig::build(source, options)?;
    show(source, &problems);
    Ok(bench)
}

/// Prints the problems of a file, if it has any.
fn show(source: &Source, problems: &[Problem]) {
    if !problems.is_empty() {
        talk!("{}", report::text(source, problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(problems));
    }
}
