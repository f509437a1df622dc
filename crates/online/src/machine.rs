//! A controller with its drivers, put together from a chart and its wiring.

use std::sync::Arc;
use std::sync::mpsc::Sender;

use g7_host::{Coupling, Runner};
use g7_model::Nanos;
use g7_rig::Bench;

use crate::controller::{Controller, Event, Port, Shared};
use crate::device::Device;
use crate::driver::{Driver, from_device};
use crate::exchange::exchange;
use crate::keep::{Keep, KeptFile};
use crate::notes::{Notes, Noting, Table, pen};
use crate::parts::Handles;
use crate::setup::Timing;
use crate::sight::Sight;
use crate::slots::{Disk, Slots};
use crate::wired::{Wired, Wiring};
use crate::word::Target;

/// Events that wait for their reader; more are counted as lost.
const EVENTS: usize = 4096;

/// A controller that is stopped, and its drivers, which have not begun.
pub struct Machine {
    /// The controller.
    pub controller: Controller,
    /// A driver for each device, in the order of the wiring.
    pub drivers: Vec<Driver>,
    /// The events of the controller.
    pub events: rtrb::Consumer<Event>,
    /// The flags that they share.
    pub shared: Shared,
    /// The way for later tables of signals to the one who records.
    pub(crate) tables: Option<Sender<Table>>,
}

impl Machine {
    /// Shows the controller to whoever holds the result.
    pub fn show(&mut self) -> Sight {
        self.controller.show()
    }

    /// Notes each change of the chosen signals from here on; `None` where the io file chooses none.
    pub fn record(&mut self, wiring: &Wiring) -> Option<Notes> {
        let table = Table { number: 0, signals: wiring.history.as_ref()?.signals.clone() };
        let noting = Noting::new(&table);
        let (pen, notes, tables) = pen(table);
        self.controller.note_by(pen, noting);
        self.tables = Some(tables);
        Some(notes)
    }

    /// Keeps the values of the run in these slots from here on; the result goes to
    /// [`crate::start`].
    pub fn keep<D: Disk>(&mut self, bench: &Bench, slots: Slots<D>) -> KeptFile<D> {
        let keep = Keep::new(bench, self.controller.runner());
        let words = keep.len();
        let (to_disk, from_scan) = exchange(words);
        self.controller.keep_by(keep, to_disk);
        KeptFile { slots, from_scan, words }
    }
}

/// A run of the bench whose plant leaves the wired inputs to their devices.
pub fn runner(bench: &Bench, wiring: &Wiring, seed: u64) -> Runner {
    let mut runner = bench.runner(seed);
    if let Some(coupling) = coupling(bench, wiring) {
        runner.couple(coupling);
    }
    runner
}

/// The words of the plant and the charts without those of wired inputs; `None` without a plant.
pub(crate) fn coupling(bench: &Bench, wiring: &Wiring) -> Option<Coupling> {
    let wired = |index: u32| {
        wiring
            .devices
            .iter()
            .any(|d| d.good.contains(&index) || d.inputs.iter().any(|i| i.target == Target::Input(index)))
    };
    let Coupling { to_plant, to_charts } = bench.plant.as_ref()?.coupling.clone();
    let to_charts = to_charts.into_iter().filter(|(_, input)| !wired(*input)).collect();
    Some(Coupling { to_plant, to_charts })
}

/// Puts a machine together; `device` makes the device of each row of the wiring.
///
/// # Errors
///
/// That of `device`.
pub fn assemble<E>(
    runner: Runner,
    wiring: &Wiring,
    mut device: impl FnMut(&Wired) -> Result<Box<dyn Device>, E>,
) -> Result<Machine, E> {
    let shared = Shared::default();
    let (mut drivers, mut ports, mut grace) = (Vec::new(), Vec::new(), Nanos::ZERO);
    for wired in &wiring.devices {
        let timing = wired.device.timing;
        let (to_scan, from_device) = exchange(from_device::words(wired.inputs.len()));
        let (to_device, from_scan) = exchange(wired.outputs.len());
        let inputs = wired.inputs.iter().map(|i| i.scaling).collect();
        let outputs = wired.outputs.iter().map(|o| o.out).collect();
        let ends = (from_scan, to_scan);
        drivers.push(Driver::new(device(wired)?, timing, inputs, outputs, ends, Arc::clone(&shared.safe)));
        ports.push(Port { from_device, to_device, handles: Handles::of(wired), stale: stale(timing) });
        // Reached, and asked once.
        grace = grace.max(timing.timeout * 2 + timing.poll);
    }
    let (producer, events) = rtrb::RingBuffer::new(EVENTS);
    let controller = Controller::new(runner, ports, shared.clone(), grace, producer);
    Ok(Machine { controller, drivers, events, shared, tables: None })
}

/// Values older than this are bad even if their driver says nothing: a driver tells of its device at
/// least after each time-out, and some time is left for scheduling.
pub(crate) fn stale(timing: Timing) -> Nanos {
    timing.poll + timing.timeout * 2 + timing.retry
}
