//! The io file held against the chart: which word of the program is which point of which device.

use std::collections::BTreeMap;

use g7_host::Kind;
use g7_model::{Problem, Span, codes};
use g7_rig::{Bench, Item, Role};

use crate::driver::Out;
use crate::setup::{At, Bad, Channel, Device, Encoding, Literal, Point, Register, Setup};
use crate::value::{Holds, Raw, Scaling};

/// All channels of a machine, by device.
#[derive(Clone, Debug, Default)]
pub struct Wiring {
    /// The devices that have a channel, in the order of the file.
    pub devices: Vec<Wired>,
    /// Inputs and outputs of the chart that no device has, by name.
    pub unwired: Vec<String>,
}

/// A device with its channels.
#[derive(Clone, Debug)]
pub struct Wired {
    /// The device.
    pub device: Device,
    /// Its inputs.
    pub inputs: Vec<In>,
    /// Its outputs.
    pub outputs: Vec<OutAt>,
    /// Input words that are 1 while it answers.
    pub good: Vec<u32>,
}

/// An input of the chart on a point of a device.
#[derive(Clone, Debug)]
pub struct In {
    /// The variable.
    pub name: String,
    /// The input word, counted from the first.
    pub index: u32,
    /// The point.
    pub register: Register,
    /// How registers hold the number; `None` for a bit.
    pub encoding: Option<Encoding>,
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

/// An output of the chart on a point of a device.
#[derive(Clone, Debug)]
pub struct OutAt {
    /// The variable.
    pub name: String,
    /// The output word, counted from the first.
    pub index: u32,
    /// The point.
    pub register: Register,
    /// How registers hold the number; `None` for a bit.
    pub encoding: Option<Encoding>,
    /// How the word becomes a value.
    pub out: Out,
}

/// Wires a chart. A channel that cannot be wired is left out and told.
pub fn wire(bench: &Bench, setup: &Setup) -> (Wiring, Vec<Problem>) {
    let mut wirer = Wirer { bench, wiring: Wiring::default(), places: BTreeMap::new(), problems: Vec::new() };
    for device in &setup.devices {
        let entry =
            Wired { device: device.clone(), inputs: Vec::new(), outputs: Vec::new(), good: Vec::new() };
        wirer.wiring.devices.push(entry);
    }
    let mut wired = BTreeMap::new();
    for (channel, input) in
        setup.inputs.iter().map(|c| (c, true)).chain(setup.outputs.iter().map(|c| (c, false)))
    {
        if let Some(item) = wirer.item(channel, input, &mut wired) {
            wirer.channel(channel, item, input);
        }
    }
    wirer.wiring.unwired = bench
        .items
        .iter()
        .filter(|i| matches!(i.role, Role::Input(_) | Role::Output) && !wired.contains_key(&(i.addr)))
        .map(|i| i.name.clone())
        .collect();
    wirer.wiring.devices.retain(|d| !(d.inputs.is_empty() && d.outputs.is_empty() && d.good.is_empty()));
    (wirer.wiring, wirer.problems)
}

struct Wirer<'a> {
    bench: &'a Bench,
    wiring: Wiring,
    /// By device and point: the output that is wired to it.
    places: BTreeMap<(usize, Register), (String, Span)>,
    problems: Vec<Problem>,
}

impl<'a> Wirer<'a> {
    fn wrong(&mut self, code: &'static codes::Code, at: Span, what: impl Into<String>) -> &mut Problem {
        self.problems.push(Problem::new(code, at, what));
        let last = self.problems.len() - 1;
        &mut self.problems[last]
    }

    /// The input or output that a channel names.
    fn item(&mut self, channel: &Channel, input: bool, wired: &mut BTreeMap<u32, Span>) -> Option<&'a Item> {
        let At { value: name, at } = &channel.variable;
        let class = if input { "input" } else { "output" };
        let Some(item) = self.bench.item(name) else {
            let near = self.bench.suggestions(name);
            let near = near.trim_start_matches("; ").to_owned();
            let problem =
                self.wrong(&codes::UNKNOWN_CHANNEL, *at, format!("the chart has no {class} `{name}`"));
            problem.help = Some(near).filter(|near| !near.is_empty());
            return None;
        };
        if matches!(item.role, Role::Input(_)) != input || !matches!(item.role, Role::Input(_) | Role::Output)
        {
            self.wrong(&codes::UNKNOWN_CHANNEL, *at, format!("`{name}` is no {class} of the chart"));
            return None;
        }
        if let Some(before) = wired.insert(item.addr, *at) {
            self.wrong(&codes::WIRED_TWICE, *at, format!("`{}` is wired twice", item.name))
                .related
                .push((before, "it is wired here as well".to_owned()));
            return None;
        }
        Some(item)
    }

    fn channel(&mut self, channel: &Channel, item: &Item, input: bool) {
        let place = self.wiring.devices.iter().position(|d| d.device.name.value == channel.device.value);
        let Some(device) = place else {
            let names: Vec<String> =
                self.wiring.devices.iter().map(|d| format!("`{}`", d.device.name.value)).collect();
            let help = if names.is_empty() {
                format!("declare it: `[devices.{}]`", channel.device.value)
            } else {
                format!("there are {}", names.join(", "))
            };
            let what = format!("there is no device `{}`", channel.device.value);
            self.wrong(&codes::UNKNOWN_CHANNEL, channel.at, what).help = Some(help);
            return;
        };
        match channel.point {
            Point::Good => self.good(channel, item, device, input),
            Point::Modbus(register) => self.register(channel, item, device, register, input),
        }
    }

    /// An input that tells whether the device answers.
    fn good(&mut self, channel: &Channel, item: &Item, device: usize, input: bool) {
        match item.role {
            Role::Input(index) if input && item.kind == Kind::Bool => {
                if let Some(wired) = self.wiring.devices.get_mut(device) {
                    wired.good.push(index);
                }
            }
            _ => {
                let what = format!("`good()` is a BOOL that is read, and `{}` is none", item.name);
                self.wrong(&codes::WRONG_CHANNEL, channel.at, what);
            }
        }
    }

    fn register(&mut self, channel: &Channel, item: &Item, device: usize, register: Register, input: bool) {
        if !input && !register.area.is_writable() {
            self.wrong(&codes::WRONG_CHANNEL, channel.at, format!("`{register}` cannot be written")).help =
                Some("outputs are coils or holding registers".to_owned());
            return;
        }
        let Some((encoding, scaling)) = self.scaling(channel, item, register) else { return };
        if !input && !self.is_free(channel, item, device, register, encoding) {
            return;
        }
        let name = item.name.clone();
        match item.role {
            Role::Input(index) => {
                let Some(bad) = self.bad(channel, &scaling) else { return };
                let Some(wired) = self.wiring.devices.get_mut(device) else { return };
                wired.inputs.push(In { name, index, register, encoding, scaling, bad });
            }
            Role::Output => {
                let tables = self.bench.compiled.program.tables();
                let index = item.addr.saturating_sub(tables.outputs.start);
                let safe = tables.safe.get(index as usize).copied().unwrap_or(0);
                let Some(wired) = self.wiring.devices.get_mut(device) else { return };
                wired.outputs.push(OutAt { name, index, register, encoding, out: Out { scaling, safe } });
            }
            Role::Variable | Role::Plant => {}
        }
    }

    /// How the variable and the point go together.
    fn scaling(
        &mut self,
        channel: &Channel,
        item: &Item,
        register: Register,
    ) -> Option<(Option<Encoding>, Scaling)> {
        let bit = register.area.is_bits() || register.bit.is_some();
        let fits = match item.kind {
            Kind::Bool => bit,
            Kind::Text => false,
            Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time => !bit,
        };
        if !fits {
            let what = format!("`{register}` cannot carry `{}`, which is {}", item.name, item.ty);
            let help = match item.kind {
                Kind::Bool => "a BOOL is a coil, a discrete input, or one bit of a register: `holding(4.0)`",
                Kind::Text => "a STRING cannot be wired",
                _ => "a number is in registers: `input(…)` or `holding(…)`",
            };
            self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help.to_owned());
            return None;
        }
        let variable = self.bench.compiled.symbols.variable_at(g7_engine::Addr(item.addr));
        let inverted = variable.is_some_and(|v| v.inverted);
        let numbers = [&channel.scale, &channel.offset].into_iter().flatten().map(|s| s.at);
        if bit {
            let first = numbers.chain(channel.encoding.as_ref().map(|e| e.at)).next();
            if let Some(at) = first {
                self.wrong(&codes::WRONG_CHANNEL, at, "one bit has no scale, offset or form of number");
                return None;
            }
            let scaling = Scaling { kind: item.kind, holds: Holds::Bit, inverted, scale: 1.0, offset: 0.0 };
            return Some((None, scaling));
        }
        let encoding = channel.encoding.as_ref().map_or_else(|| usual(item.kind), |e| e.value);
        if u32::from(register.address) + u32::from(encoding.registers()) > 65_536 {
            self.wrong(&codes::WRONG_CHANNEL, channel.at, "the number goes beyond the last register, 65535");
            return None;
        }
        let holds = match encoding {
            Encoding::Unsigned(n) => Holds::Whole { bits: n * 16, signed: false },
            Encoding::Signed(n) => Holds::Whole { bits: n * 16, signed: true },
            Encoding::F32 => Holds::Single,
            Encoding::F64 => Holds::Double,
        };
        let value = |number: &Option<At<f64>>, usual| number.as_ref().map_or(usual, |n| n.value);
        let (scale, offset) = (value(&channel.scale, 1.0), value(&channel.offset, 0.0));
        Some((Some(encoding), Scaling { kind: item.kind, holds, inverted: false, scale, offset }))
    }

    /// True if no other output has the point, or a part of it.
    fn is_free(
        &mut self,
        channel: &Channel,
        item: &Item,
        device: usize,
        register: Register,
        encoding: Option<Encoding>,
    ) -> bool {
        // Two names of one unit are one device.
        let kind = |k: usize| self.wiring.devices.get(k).map(|d| &d.device.kind);
        let device = (0..device).find(|k| kind(*k) == kind(device)).unwrap_or(device);
        let count = encoding.map_or(1, Encoding::registers);
        let places: Vec<Register> = (0..count)
            .map(|k| Register { address: register.address.saturating_add(k), ..register })
            .collect();
        let taken = places.iter().find_map(|place| {
            // A whole register and one bit of it are the same place.
            let bits = (0..16).map(|bit| Register { bit: Some(bit), ..*place });
            let all = bits.filter(|_| !place.area.is_bits() && place.bit.is_none());
            let whole = [*place, Register { bit: None, ..*place }];
            whole.into_iter().chain(all).find_map(|r| self.places.get(&(device, r)).cloned())
        });
        if let Some((other, there)) = taken {
            let what = format!("`{}` and `{other}` are wired to one point, {register}", item.name);
            self.wrong(&codes::WIRED_TWICE, channel.at, what)
                .related
                .push((there, format!("`{other}` is wired here")));
            return false;
        }
        for place in places {
            self.places.insert((device, place), (item.name.clone(), channel.at));
        }
        true
    }

    fn bad(&mut self, channel: &Channel, scaling: &Scaling) -> Option<WhileBad> {
        let literal = match channel.bad.value {
            Bad::Hold => return Some(WhileBad::Hold),
            Bad::Fault => return Some(WhileBad::Fault),
            Bad::Value(literal) => literal,
        };
        // The value is that of the variable: no scale, nothing inverted.
        let plain = Scaling { inverted: false, scale: 1.0, offset: 0.0, ..*scaling };
        let word = match literal {
            Literal::Bool(on) => plain.word(Raw::Bit(on)),
            Literal::Number(x) if x.fract() == 0.0 && x.abs() < 1e18 => plain.word(Raw::Whole(x as i128)),
            Literal::Number(x) if matches!(plain.kind, Kind::Real | Kind::Lreal) => plain.word(Raw::Real(x)),
            Literal::Number(_) => None,
        };
        if word.is_none() {
            let what = format!("`{}` cannot have this value", channel.variable.value);
            self.wrong(&codes::WRONG_CHANNEL, channel.bad.at, what);
        }
        word.map(WhileBad::Word)
    }
}

/// How registers hold a variable where the file does not say it.
fn usual(kind: Kind) -> Encoding {
    match kind {
        Kind::Int { bits, signed } => {
            let registers = bits.div_ceil(16);
            if signed { Encoding::Signed(registers) } else { Encoding::Unsigned(registers) }
        }
        Kind::Real => Encoding::F32,
        Kind::Lreal => Encoding::F64,
        Kind::Time | Kind::Bool | Kind::Text => Encoding::Signed(2),
    }
}
