//! A chart that is wired: which word of the program is which point of which device.
//!
//! `wiring` makes it of the io file and the chart; drivers, devices and the controller work with it.

use crate::chosen::Chosen;
use crate::driver::Out;
use crate::setup::Device;
use crate::value::Scaling;
use crate::wire::Wire;
use crate::word::{Source, Target};

/// All channels of a machine, by device.
#[derive(Clone, Debug, Default)]
pub struct Wiring {
    /// The devices that have a channel, in the order of the file.
    pub devices: Vec<Wired>,
    /// Inputs and outputs of the chart that no device has, by name.
    pub unwired: Vec<String>,
    /// The signals that are recorded.
    pub history: Option<Chosen>,
}

/// A device with its channels.
#[derive(Clone, Debug)]
pub struct Wired {
    /// The device.
    pub device: Device,
    /// Its inputs.
    pub inputs: Vec<In>,
    /// Its outputs, and what is shown to the masters of a server.
    pub outputs: Vec<OutAt>,
    /// Input words that are 1 while it answers.
    pub good: Vec<u32>,
}

/// An input of the chart on a point of a device.
#[derive(Clone, Debug)]
pub struct In {
    /// The variable.
    pub name: String,
    /// The word of the run.
    pub target: Target,
    /// The point.
    pub wire: Wire,
    /// How the value becomes a word.
    pub scaling: Scaling,
    /// Its value while that of the device is bad.
    pub bad: WhileBad,
}

/// The value of an input word while that of the device is bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhileBad {
    /// The last good value, or the initial one.
    Hold,
    /// This word.
    Word(u64),
    /// The controller stops.
    Fault,
}

/// An output of the chart on a point of a device, or what masters read there.
#[derive(Clone, Debug)]
pub struct OutAt {
    /// The variable or step.
    pub name: String,
    /// The word of the run.
    pub source: Source,
    /// The point.
    pub wire: Wire,
    /// How the word becomes a value.
    pub out: Out,
}
