//! An on-line change: the controller goes on with a changed chart, between two scans.
//!
//! ```text
//! scan k ends -> Picture -> prepare, on a thread of its own -> Successor -> before scan k + 1
//! ```
//!
//! # Invariants
//!
//! The scan thread copies words into room that is there, and exchanges parts for others. It frees none
//! of the old ones: they go back. A successor that comes too late is not taken, so no scan waits for it.
//! A change is made as a whole or not at all. Devices, wires and drivers are those of before.

use g7_model::{Document, Nanos};
use g7_rig::{Bench, Carried};

use crate::exchange::{Reader, exchange};
use crate::forces::{FORCES, Forced};
use crate::keep::Keep;
use crate::machine::{coupling, stale};
use crate::notes::{Noting, Table};
use crate::parts::{Handles, Keeping, Picture, Successor};
use crate::sight::{Sight, sight};
use crate::wired::{Wired, Wiring};

/// A chart with its wiring.
#[derive(Clone, Copy)]
pub struct Chart<'a> {
    /// The chart, compiled.
    pub bench: &'a Bench,
    /// The chart, as it was written.
    pub document: &'a Document,
    /// Its wires.
    pub wiring: &'a Wiring,
}

/// A change that can be made.
pub struct Prepared {
    /// The parts for the controller.
    pub successor: Box<Successor>,
    /// A sentence for each part of the run that does not go on.
    pub lost: Vec<String>,
    /// Room for pictures behind the change.
    pub picture: Box<Picture>,
    /// The sight of the controller behind the change.
    pub sight: Sight,
    /// The values that it keeps behind the change.
    pub kept: Reader,
    /// The signals that are recorded behind the change.
    pub table: Option<Table>,
}

/// Prepares the change of a controller from the old chart to the new one.
///
/// # Errors
///
/// The reason why it cannot be made.
pub fn prepare(old: Chart<'_>, new: Chart<'_>, picture: &Picture) -> Result<Prepared, String> {
    fits(old, new)?;
    let Carried { mut runner, lost } =
        g7_rig::carry((new.bench, new.document), (old.bench, old.document), &picture.runner)
            .map_err(|e| e.to_string())?;
    let lost = lost.iter().map(ToString::to_string).collect();
    if let Some(coupling) = coupling(new.bench, new.wiring) {
        runner.couple(coupling);
    }
    let mut forces = Vec::with_capacity(FORCES);
    forces.extend(picture.forces.iter().filter_map(|force| force_in(old.bench, new.bench, *force)));
    runner.reserve_forces(FORCES);
    let ports = new.wiring.devices.iter().map(|d| (d.inputs.len(), stale(d.device.timing)));
    let (showing, sight) = sight(&runner, ports);
    let keep = Keep::new(new.bench, &runner);
    let (to_disk, kept) = exchange(keep.len());
    // No two changes that are made have the same picture.
    let number = picture.revision.saturating_add(1);
    let table = new.wiring.history.as_ref().map(|h| Table { number, signals: h.signals.clone() });
    let next = Box::new(Picture::of(&runner));
    let successor = Successor {
        runner,
        forces,
        handles: new.wiring.devices.iter().map(Handles::of).collect(),
        keeping: Some(Keeping::new(keep, to_disk)),
        showing: Some(showing),
        noting: table.as_ref().map(Noting::new),
        revision: picture.revision,
    };
    Ok(Prepared { successor: Box::new(successor), lost, picture: next, sight, kept, table })
}

/// The same force in the new chart.
fn force_in(old: &Bench, new: &Bench, force: Forced) -> Option<Forced> {
    let was = old.items.iter().find(|item| old.force_of(item) == Some(force.what))?;
    let item = new.items.iter().find(|item| item.name == was.name && item.kind == was.kind)?;
    Some(Forced { what: new.force_of(item)?, ..force })
}

/// Refuses a change of what stays outside the chart: the scan time and the wires.
fn fits(old: Chart<'_>, new: Chart<'_>) -> Result<(), String> {
    let (was, is) = (old.bench.period, new.bench.period);
    if was != is {
        return Err(restart(&format!("the scan time changes from {} to {}", millis(was), millis(is))));
    }
    let (before, after) = (&old.wiring.devices, &new.wiring.devices);
    if let Some(device) = after.iter().find(|d| before.iter().all(|b| name(b) != name(d))) {
        return Err(restart(&format!("the device `{}` is a new one", name(device))));
    }
    if let Some(device) = before.iter().find(|d| after.iter().all(|b| name(b) != name(d))) {
        return Err(restart(&format!("the device `{}` has no channels any more", name(device))));
    }
    same_record(old.wiring, new.wiring).map_err(restart)?;
    for (before, after) in before.iter().zip(after) {
        same_wires(before, after).map_err(|what| restart(&format!("`{}`: {what}", name(after))))?;
    }
    Ok(())
}

/// Refuses another file or other limits of the record, since its thread has those of the start.
fn same_record(old: &Wiring, new: &Wiring) -> Result<(), &'static str> {
    match (&old.history, &new.history) {
        (None, None) => Ok(()),
        (Some(was), Some(is))
            if (&was.file, was.days, was.megabytes) == (&is.file, is.days, is.megabytes) =>
        {
            Ok(())
        }
        (Some(_), Some(_)) => Err("[history]: the file, `days` or `megabytes` change"),
        (Some(_), None) | (None, Some(_)) => Err("[history] comes or goes"),
    }
}

fn restart(what: &str) -> String {
    format!("{what}: this needs a new start")
}

fn millis(time: Nanos) -> String {
    format!("{} ms", time.count() as f64 / 1e6)
}

fn name(wired: &Wired) -> &str {
    &wired.device.name.value
}

/// Refuses other points, since the driver has those of the start.
fn same_wires(before: &Wired, after: &Wired) -> Result<(), String> {
    let (was, is) = (&before.device, &after.device);
    if was.name.value != is.name.value || was.kind != is.kind || was.timing != is.timing {
        return Err("the device is declared otherwise".to_owned());
    }
    let inputs = before.inputs.iter().map(|i| (&i.wire, i.scaling));
    let other = after.inputs.iter().zip(inputs.map(Some).chain(std::iter::repeat(None)));
    for (input, was) in other {
        if was != Some((&input.wire, input.scaling)) {
            return Err(format!("the input `{}` has another wire or type", input.name));
        }
    }
    let outputs = before.outputs.iter().map(|o| (&o.wire, o.out));
    let other = after.outputs.iter().zip(outputs.map(Some).chain(std::iter::repeat(None)));
    for (output, was) in other {
        if was != Some((&output.wire, output.out)) {
            return Err(format!("the output `{}` has another wire, type or safe value", output.name));
        }
    }
    let gone = before.inputs.len() > after.inputs.len() || before.outputs.len() > after.outputs.len();
    if gone || before.good.len() != after.good.len() {
        return Err("a channel is gone".to_owned());
    }
    Ok(())
}
