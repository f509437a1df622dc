//! `g7 plant`: the plant of a chart in the place of its devices, for a controller to try its wires.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;
use g7_model::{Item, Nanos, say};
use g7_online::{Clients, Command, Options as Threads};
use g7_rig::Options;

use crate::attendant::Attendant;
use crate::failure::{Failure, Verdict, raw, refused};
use crate::message::talk;
use crate::operator::Names;
use crate::wiring::{self, Wanted};
use crate::{files, sources, values};

/// The watchdog of a plant: it drives nothing that can break.
const WATCHDOG: Nanos = Nanos::from_millis(10_000);

#[derive(Args, Debug)]
#[command(after_help = "\
The plant listens where the io file says that the devices of Modbus TCP are, with the
same points, and the charts of the file do not run: a controller drives it, such as
`g7 run --online` in another terminal, or a PLC. Lines on the standard input set
inputs and states (`NAME := VALUE`), as a hand at the machine does.

Examples:
  g7 plant sorter                        devices of sorter.io.toml on this machine
  g7 plant sorter --listen 192.168.1.5   for a controller in the network; no keys, no users

Exit codes:
  0  it ran until it was told to end
  1  the chart, the io file or the plant has a problem
  2  bad usage, or something outside the chart: no such file")]
pub(crate) struct Plant {
    /// A chart with an io file and a plant, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    path: PathBuf,
    /// The io file [default: chart.io.toml for chart.g7].
    #[arg(long, value_name = "FILE")]
    io: Option<PathBuf>,
    /// Listen at this address of the machine, whatever the io file says.
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<IpAddr>,
    /// The plant to use if there are several.
    #[arg(long, value_name = "NAME")]
    plant: Option<String>,
    /// How long to run [default: no limit].
    #[arg(long = "for", value_parser = values::duration, value_name = "TIME")]
    duration: Option<Nanos>,
    /// The seed of the plant's random numbers.
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    seed: u64,
}

pub(crate) fn plant(args: &Plant) -> Result<Verdict, Failure> {
    let path = files::one(&args.path)?;
    let mut source = sources::load(&path, 0)?;
    let wanted = Wanted { io: args.io.as_deref(), ..Wanted::default() };
    let Some(wired) = wiring::plan(&path, &source, &wanted)?.map(|plan| plan.wiring) else {
        return Ok(Verdict::Found);
    };
    // The charts run in the controller, not here.
    let of_charts = |item: &Item| {
        matches!(item, Item::Chart(_) | Item::Pre(..) | Item::Post(..) | Item::Section(_) | Item::Action(_))
    };
    source.amend(|document| document.items.retain(|item| !of_charts(item)));
    let options = Options { plant: args.plant.as_deref(), ..Options::default() };
    let Some(bench) = wiring::build(&source, &options)? else { return Ok(Verdict::Found) };
    if bench.plant.is_none() {
        return Err(Failure::Usage(say!("{} has no plant", raw(&source.name))));
    }
    let wiring = g7_online::mirror(&bench, &wired, args.listen).map_err(|why| Failure::Usage(raw(why)))?;
    if wiring.devices.is_empty() {
        return Err(Failure::Usage(say!("the io file has no device of Modbus TCP")));
    }
    for wired in &wired.devices {
        if let g7_online::setup::Kind::Mqtt(_) = &wired.device.kind {
            talk!("{} is a broker, which the plant does not stand for", wired.device.name.value);
        }
    }
    for device in &wiring.devices {
        if let g7_online::setup::Kind::ModbusServer(listen) = &device.device.kind {
            talk!("{} listens at {}", device.device.name.value, listen.address);
        }
    }
    let mut clients = Clients::default();
    let machine = g7_online::assemble(bench.runner(args.seed), &wiring, |wired| clients.device(wired));
    let threads = Threads { watchdog: WATCHDOG, priority: None };
    let mut running =
        g7_online::start::<g7_online::RealDisk>(machine.map_err(refused)?, None, threads).map_err(refused)?;
    running.command(Command::Run);
    let names = Names::new(source, bench, wiring);
    Attendant::new(names).that_sets().attend(running, args.duration)
}
