//! How a variable is carried by OPC UA: a node of a server, or of the server of our own.
//!
//! Pure: `wiring` holds the channel against the chart and the device, and asks here for the rest.

use std::collections::{BTreeMap, BTreeSet};

use g7_host::Kind;
use g7_model::{Said, say};
use g7_rig::{Activity, Bench, Item, Role, StepItem};

use crate::driver::Out;
use crate::forms::holds;
use crate::messages::{Carried, Refused, number};
use crate::setup::{self, Channel, Point, read_node};
use crate::subject::{Class, Subject};
use crate::value::{Holds, Scaling};
use crate::wire::{About, Folder, Shown, Wire};
use crate::wired::{OutAt, Wired};
use crate::word::Source;

/// The point of a channel at a server, and how its value becomes a word.
pub(crate) fn wire(channel: &Channel, carried: &Carried<'_>) -> Result<(Wire, Scaling), Refused> {
    let Point::Node(Some(text)) = &channel.point else {
        return Err(no_node(channel, "node(ns=2;s=Tank.Level)"));
    };
    let node = read_node(text).map_err(|what| Refused {
        at: channel.at,
        what,
        help: Some(say!("write `node(ns=2;s=Tank.Level)`, or `node(nsu=urn:tanks;s=Level)`")),
    })?;
    Ok((Wire::Node(node), scaling(channel, carried)?))
}

/// The node of a channel on the server of our own.
pub(crate) fn shown(channel: &Channel, subject: &Subject, class: Class) -> Result<(Wire, Scaling), Refused> {
    let Point::Node(name) = &channel.point else { return Err(no_node(channel, "node()")) };
    let name = name.as_deref().unwrap_or(&subject.name).to_owned();
    if name.len() > LONGEST || name.contains(char::is_control) {
        let what = say!("the name of a node has at most {LONGEST} bytes, and no control characters");
        return Err(Refused { at: channel.at, what, help: None });
    }
    let unit = channel.unit.as_ref().map(|unit| unit.value.clone());
    let about = About { comment: subject.comment.clone(), unit };
    let shown = Shown { name, folder: subject.folder, about };
    Ok((Wire::Shown(shown), scaling(channel, &subject.carried(class))?))
}

/// The longest name of a node of our own.
const LONGEST: usize = 1024;

fn no_node(channel: &Channel, example: &str) -> Refused {
    let what = say!("`{}` is no point of OPC UA", channel.point);
    Refused { at: channel.at, what, help: Some(say!("its points are nodes: `{example}`")) }
}

/// A node has a type of its own; the form of the number says which one it is, where the variable does not.
fn scaling(channel: &Channel, carried: &Carried<'_>) -> Result<Scaling, Refused> {
    let refused = |at, what: Said| Refused { at, what, help: None };
    if carried.kind == Kind::Text {
        let what = say!("`{}` is a STRING, which cannot be wired", carried.name);
        return Err(refused(channel.at, what));
    }
    let scaling = number(channel, carried)?;
    let Some(form) = &channel.encoding else { return Ok(scaling) };
    if carried.kind == Kind::Bool {
        return Err(refused(form.at, say!("a BOOL has no form of number")));
    }
    Ok(Scaling { holds: holds(form.value), ..scaling })
}

/// Something that a server of our own shows.
pub(crate) struct Seen {
    pub(crate) name: String,
    pub(crate) source: Source,
    pub(crate) wire: Wire,
    pub(crate) out: Out,
}

/// Whatever a chart has to show: inputs, outputs, variables, steps with their activity and time.
pub(crate) fn all(bench: &Bench) -> impl Iterator<Item = Seen> {
    let of_items = bench.items.iter().filter_map(of_item);
    of_items.chain(bench.steps.iter().flat_map(of_step))
}

/// The name of a node of our own.
pub(crate) fn name(wire: &Wire) -> Option<&str> {
    match wire {
        Wire::Shown(shown) => Some(&shown.name),
        _ => None,
    }
}

fn of_item(item: &Item) -> Option<Seen> {
    let holds = plain(item.kind)?;
    let out = Scaling { kind: item.kind, holds, inverted: false, scale: 1.0, offset: 0.0 };
    let about = About { comment: item.comment.clone(), unit: None };
    let folder = folder(item.role)?;
    Some(seen(item.name.clone(), Source::Word(g7_engine::Addr(item.addr)), out, folder, about))
}

/// The folder of a variable; what belongs to the plant has none.
pub(crate) fn folder(role: Role) -> Option<Folder> {
    match role {
        Role::Input(_) => Some(Folder::Inputs),
        Role::Output => Some(Folder::Outputs),
        Role::Variable => Some(Folder::Variables),
        Role::Plant => None,
    }
}

/// The values of a type without a scale; a STRING has none.
fn plain(kind: Kind) -> Option<Holds> {
    match kind {
        Kind::Bool => Some(Holds::Bit),
        Kind::Int { bits, signed } => Some(Holds::Whole { bits, signed }),
        Kind::Time | Kind::Moment(_) => Some(Holds::Whole { bits: 64, signed: true }),
        Kind::Real => Some(Holds::Single),
        Kind::Lreal => Some(Holds::Double),
        Kind::Text => None,
    }
}

/// The activity of a step and the time since it became active: `X2` and `X2.T`.
fn of_step(step: &StepItem) -> [Seen; 2] {
    let (activity, age) = match step.id {
        Activity::Step(id) => (Source::Step(id), Source::Age(id)),
        Activity::Macro(id) => (Source::Macro(id), Source::MacroAge(id)),
    };
    let about = About { comment: step.comment.clone(), unit: None };
    let scaling = |kind, holds| Scaling { kind, holds, inverted: false, scale: 1.0, offset: 0.0 };
    let time = scaling(Kind::Time, Holds::Whole { bits: 64, signed: true });
    [
        seen(step.activity(), activity, scaling(Kind::Bool, Holds::Bit), Folder::Steps, about.clone()),
        seen(time_of(step), age, time, Folder::Steps, about),
    ]
}

/// The name of the time of a step: `X2.T`, `Fill.T`.
fn time_of(step: &StepItem) -> String {
    let activity = step.activity();
    format!("{}.T", activity.strip_suffix(".X").unwrap_or(&activity))
}

fn seen(name: String, source: Source, scaling: Scaling, folder: Folder, about: About) -> Seen {
    let wire = Wire::Shown(Shown { name: name.clone(), folder, about });
    Seen { name, source, wire, out: Out { scaling, safe: None } }
}

/// How good an input is that a server of our own shows, by the numbers of its device and of itself there.
pub(crate) fn worth(name: &str, device: usize, input: usize) -> Seen {
    let kind = Kind::Int { bits: 8, signed: false };
    let holds = Holds::Whole { bits: 8, signed: false };
    let scaling = Scaling { kind, holds, inverted: false, scale: 1.0, offset: 0.0 };
    Seen {
        name: format!("{name} (status)"),
        source: Source::Worth(device, input),
        wire: Wire::Worth(name.to_owned()),
        out: Out { scaling, safe: None },
    }
}

/// Adds to each server of our own that shows all whatever no channel of it shows.
pub(crate) fn expose(bench: &Bench, devices: &mut [Wired]) {
    for wired in devices {
        if matches!(&wired.device.kind, setup::Kind::OpcUaServer(server) if server.all) {
            show_all(bench, wired);
        }
    }
}

/// Adds to a server of our own whatever the chart has and no channel of it shows.
fn show_all(bench: &Bench, server: &mut Wired) {
    let inputs = server.inputs.iter().map(|i| (&i.name, &i.wire));
    let shown = inputs.chain(server.outputs.iter().map(|o| (&o.name, &o.wire)));
    // By its own name, and by that of its node.
    let there: BTreeSet<String> =
        shown.flat_map(|(own, wire)| [Some(own.as_str()), name(wire)]).flatten().map(str::to_owned).collect();
    let hidden = all(bench)
        .filter(|seen| name(&seen.wire).is_some_and(|n| !there.contains(n) && !there.contains(&seen.name)));
    server.outputs.extend(hidden.map(OutAt::from));
}

/// Lets each server of our own tell how good the inputs are that it shows and another device gives.
pub(crate) fn judge(devices: &mut [Wired]) {
    let of_device = |(device, wired): (usize, &Wired)| {
        let inputs = wired.inputs.iter().enumerate();
        inputs.map(|(k, input)| (input.name.clone(), (device, k))).collect::<Vec<_>>()
    };
    let given: BTreeMap<String, (usize, usize)> = devices.iter().enumerate().flat_map(of_device).collect();
    for (own, wired) in devices.iter_mut().enumerate() {
        let of = |out: &OutAt| {
            let (name, (device, input)) = (name(&out.wire)?, *given.get(&out.name)?);
            (device != own).then(|| OutAt::from(worth(name, device, input)))
        };
        let judged: Vec<OutAt> = wired.outputs.iter().filter_map(of).collect();
        wired.outputs.extend(judged);
    }
}

impl From<Seen> for OutAt {
    fn from(Seen { name, source, wire, out }: Seen) -> OutAt {
        OutAt { name, source, wire, out }
    }
}
