//! The io file of a chart, held against the chart: for `run --online` and `devices`.

use std::path::{Path, PathBuf};

use g7_model::{FileId, Nanos, Problem, ProfileName, Said, Severity, say};
use g7_online::Wiring;
use g7_online::setup::{self, Channel, Kind, Origin, Setup};
use g7_rig::{Bench, Options};

use crate::failure::{Failure, plain, raw};
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

/// The io file of a chart.
pub(crate) fn io_file(path: &Path, named: Option<&Path>) -> PathBuf {
    named.map_or_else(|| path.with_extension("io.toml"), Path::to_path_buf)
}

/// The settings of an io file; those of a silent one where it cannot be read, which [`make`] tells.
pub(crate) fn settings(io: &Path) -> Setup {
    let text = std::fs::read(io).ok().and_then(|bytes| String::from_utf8(bytes).ok());
    text.map(|text| setup::read(&text, FileId(1)).0).unwrap_or_default()
}

/// Reads the io file and wires the chart, or prints the problems.
pub(crate) fn plan(path: &Path, source: &Source, wanted: &Wanted<'_>) -> Result<Option<Plan>, Failure> {
    let (plan, told) = make(path, source, wanted)?;
    if !told.is_empty() {
        talk!("{}", told.trim_end());
    }
    Ok(plan)
}

/// Reads the io file and wires the chart, unless there are errors. Returns the problems as text, in
/// colours.
pub(crate) fn make(
    path: &Path,
    source: &Source,
    wanted: &Wanted<'_>,
) -> Result<(Option<Plan>, String), Failure> {
    let io = io_file(path, wanted.io);
    if wanted.io.is_none() && !io.is_file() {
        return Err(Failure::Usage(say!(
            "{} is missing: it says which devices the inputs and outputs are wired to; --io names another file",
            raw(io.display())
        )));
    }
    let text = files::read(&io)?;
    let file = Source::plain(&io.display().to_string(), text);
    let (mut setup, mut problems) = setup::read(&file.text, FileId(1));
    if file.text.as_bytes() != file.bytes {
        return Err(Failure::Usage(say!("{} is not UTF-8 text", raw(io.display()))));
    }
    let simulated = simulate(&mut setup, wanted.simulate)?;
    if wanted.simulate.is_none() {
        problems.extend(g7_online::lacking(&setup));
    }
    // Without a plant in place of a device there is none.
    let plant = wanted.plant.or(if wanted.simulate.is_none() { Some("none") } else { None });
    let scan = wanted.scan.or(setup.controller.period.as_ref().map(|p| p.value));
    let options = Options { profile: wanted.profile, scan, plant, asks: &[] };
    let (bench, of_chart) = g7_rig::build(source, &options)?;
    let mut told = told_of(source, &of_chart);
    let Some(bench) = bench else { return Ok((None, told)) };
    setup::settle(&mut setup, io.parent().unwrap_or(Path::new("")));
    problems.extend(setup::read_secrets(&mut setup, |origin| secret(&io, origin)));
    let (mut wiring, wrong) = g7_online::wire(&bench, &setup);
    wiring.unwired.retain(|name| !simulated.iter().any(|s| bench.item(s).is_some_and(|i| i.name == *name)));
    problems.extend(wrong);
    told += &told_of(&file, &problems);
    let errors = problems.iter().any(|p: &Problem| p.severity() == Severity::Error);
    Ok(((!errors).then_some(Plan { bench, setup, wiring, io }), told))
}

/// The bytes of a password, certificate or key, which is never in the io file.
pub(crate) fn secret(io: &Path, origin: &Origin) -> Result<Vec<u8>, Said> {
    match origin {
        Origin::File(name) => {
            let path = io.with_file_name(name);
            std::fs::read(&path).map_err(|e| Said::foreign(format!("{}: {}", path.display(), plain(&e))))
        }
        Origin::Variable(name) => std::env::var_os(name)
            .map(std::ffi::OsString::into_encoded_bytes)
            .ok_or_else(|| say!("the environment has no variable {}", Said::foreign(name))),
    }
}

/// Takes the devices out that the plant stands for. Returns the inputs and outputs that were wired to
/// them, as the file names them.
fn simulate(setup: &mut Setup, names: Option<&[String]>) -> Result<Vec<String>, Failure> {
    let Some(names) = names else { return Ok(Vec::new()) };
    let there = |name: &String| setup.devices.iter().any(|d| d.name.value == *name);
    if let Some(name) = names.iter().find(|name| !there(name)) {
        let all: Vec<&str> = setup.devices.iter().map(|d| d.name.value.as_str()).collect();
        return Err(Failure::Usage(say!(
            "--simulate: the io file has no device `{name}`; it has {}",
            raw(all.join(", "))
        )));
    }
    // A panel is no part of the machine: the plant does not stand for it unless it is named.
    let panels: Vec<String> = setup
        .devices
        .iter()
        .filter(|d| matches!(d.kind, Kind::Panel(_)))
        .map(|d| d.name.value.clone())
        .collect();
    let simulated =
        |name: &String| if names.is_empty() { !panels.contains(name) } else { names.contains(name) };
    let gone = |channels: &mut Vec<Channel>| -> Vec<String> {
        channels.extract_if(.., |c| simulated(&c.device.value)).map(|c| c.variable.value).collect()
    };
    let taken = [gone(&mut setup.inputs), gone(&mut setup.outputs)];
    setup.shown.retain(|c| !simulated(&c.device.value));
    for device in setup.devices.iter_mut().filter(|d| simulated(&d.name.value)) {
        // A broker that is not there hears of nothing.
        if let setup::Kind::Mqtt(broker) = &mut device.kind {
            broker.events = None;
        }
    }
    Ok(taken.concat())
}

/// Compiles a source, or prints its problems.
pub(crate) fn build(source: &Source, options: &Options<'_>) -> Result<Option<Bench>, Failure> {
    let (bench, problems) = g7_rig::build(source, options)?;
    let told = told_of(source, &problems);
    if !told.is_empty() {
        talk!("{}", told.trim_end());
    }
    Ok(bench)
}

/// The problems of a file with their number; nothing if there are none.
fn told_of(source: &Source, problems: &[Problem]) -> String {
    match problems {
        [] => String::new(),
        _ => {
            let each = report::text(source, problems);
            format!("{}\n{}: {}\n", each.trim_end(), source.name, Tally::of(problems))
        }
    }
}
