//! The io file held against the chart: which word of the program is which point of which device.

use std::collections::BTreeMap;

use g7_engine::Addr;
use g7_host::Kind;
use g7_model::{Nanos, Problem, Said, Span, codes, say};
use g7_rig::{Bench, Item, Role};

use crate::chosen;
use crate::driver::Out;
use crate::forms;
use crate::handles;
use crate::messages::{self, Carried, Refused};
use crate::names::{Named, named, source_of};
use crate::nodes;
use crate::points;
use crate::setup::{
    At, Bad, Broker, Channel, Encoding, Handle, Kind as Way, Literal, Place, Point, Register, Setup,
};
use crate::subject::{Class, Subject};
use crate::value::{Holds, Raw, Scaling};
use crate::wire::{Folder, Wire};
use crate::wired::{In, OutAt, WhileBad, Wired, Wiring};
use crate::word::{Source, Target};

/// Wires a chart. A channel that cannot be wired is left out and told.
pub fn wire(bench: &Bench, setup: &Setup) -> (Wiring, Vec<Problem>) {
    let (wiring, places, messages) = (Wiring::default(), BTreeMap::new(), BTreeMap::new());
    let mut wirer = Wirer { bench, wiring, places, messages, problems: Vec::new() };
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
            let subject = wirer.subject(item);
            wirer.channel(channel, &subject, if input { Class::Input } else { Class::Output });
        }
    }
    for channel in &setup.shown {
        if let Some(subject) = wirer.shown(channel) {
            wirer.channel(channel, &subject, Class::Shown);
        }
    }
    wirer.wiring.unwired = bench
        .items
        .iter()
        .filter(|i| matches!(i.role, Role::Input(_) | Role::Output) && !wired.contains_key(&(i.addr)))
        .map(|i| i.name.clone())
        .collect();
    nodes::expose(bench, &mut wirer.wiring.devices);
    let events = |d: &Wired| matches!(&d.device.kind, Way::Mqtt(broker) if broker.events.is_some());
    let used = |d: &Wired| !(d.inputs.is_empty() && d.outputs.is_empty() && d.good.is_empty()) || events(d);
    wirer.wiring.devices.retain(used);
    nodes::judge(&mut wirer.wiring.devices);
    if let Some(history) = &setup.history {
        wirer.wiring.history = Some(chosen::choose(bench, history, &mut wirer.problems));
    }
    (wirer.wiring, wirer.problems)
}

struct Wirer<'a> {
    bench: &'a Bench,
    wiring: Wiring,
    /// By device and point: the output that is wired to it.
    places: BTreeMap<(usize, Register), (String, Span)>,
    /// By device: the outputs on topics, all metrics, and the will.
    messages: BTreeMap<(usize, String), (String, Span)>,
    problems: Vec<Problem>,
}

impl<'a> Wirer<'a> {
    fn wrong(&mut self, code: &'static codes::Code, at: Span, what: Said) -> &mut Problem {
        self.problems.push(Problem::new(code, at, what));
        let last = self.problems.len() - 1;
        &mut self.problems[last]
    }

    /// The input or output that a channel names.
    fn item(&mut self, channel: &Channel, input: bool, wired: &mut BTreeMap<u32, Span>) -> Option<&'a Item> {
        let At { value: name, at } = &channel.variable;
        let Some(item) = self.bench.item(name) else {
            let what = match input {
                true => say!("the chart has no input `{name}`"),
                false => say!("the chart has no output `{name}`"),
            };
            let near = self.bench.near(name);
            self.wrong(&codes::UNKNOWN_CHANNEL, *at, what).help = Some(near).filter(|near| !near.is_empty());
            return None;
        };
        if matches!(item.role, Role::Input(_)) != input || !matches!(item.role, Role::Input(_) | Role::Output)
        {
            let what = match input {
                true => say!("`{name}` is no input of the chart"),
                false => say!("`{name}` is no output of the chart"),
            };
            self.wrong(&codes::UNKNOWN_CHANNEL, *at, what);
            return None;
        }
        if let Some(before) = wired.insert(item.addr, *at) {
            self.wrong(&codes::WIRED_TWICE, *at, say!("`{}` is wired twice", item.name))
                .related
                .push((before, say!("it is wired here as well")));
            return None;
        }
        Some(item)
    }

    fn subject(&self, item: &Item) -> Subject {
        let variable = self.bench.compiled.symbols.variable_at(Addr(item.addr));
        Subject {
            name: item.name.clone(),
            kind: item.kind,
            ty: item.ty.to_string(),
            inverted: variable.is_some_and(|v| v.inverted),
            input: if let Role::Input(index) = item.role { Some(index) } else { None },
            source: Source::Word(Addr(item.addr)),
            safe: self.bench.safe(item),
            folder: nodes::folder(item.role).unwrap_or(Folder::Variables),
            comment: item.comment.clone(),
        }
    }

    /// The variable or the step that a channel shows.
    fn shown(&mut self, channel: &Channel) -> Option<Subject> {
        match named(self.bench, &channel.variable) {
            Ok(Named::Item(item)) => Some(self.subject(item)),
            Ok(Named::Step(step)) => Some(Subject {
                name: step.activity(),
                kind: Kind::Bool,
                ty: "BOOL".to_owned(),
                inverted: false,
                input: None,
                source: source_of(step),
                safe: None,
                folder: Folder::Steps,
                comment: step.comment.clone(),
            }),
            Err(problem) => {
                self.problems.push(*problem);
                None
            }
        }
    }

    fn channel(&mut self, channel: &Channel, subject: &Subject, class: Class) {
        let place = self.wiring.devices.iter().position(|d| d.device.name.value == channel.device.value);
        let Some(device) = place else {
            let names: Vec<String> =
                self.wiring.devices.iter().map(|d| format!("`{}`", d.device.name.value)).collect();
            let help = if names.is_empty() {
                say!("declare it: `[devices.{}]`", channel.device.value)
            } else {
                say!("there are {}", Said::foreign(names.join(", ")))
            };
            let what = say!("there is no device `{}`", channel.device.value);
            self.wrong(&codes::UNKNOWN_CHANNEL, channel.at, what).help = Some(help);
            return;
        };
        let kind = self.wiring.devices.get(device).map(|d| d.device.kind.clone());
        if let Some((at, what)) = points::misplaced(channel, kind.as_ref()) {
            self.wrong(&codes::WRONG_CHANNEL, at, what);
            return;
        }
        match (&channel.point, kind) {
            (_, Some(Way::Panel(_))) => self.panel(channel, subject, device, class),
            (_, _) if channel.limits.first().is_some() => {
                let at = channel.limits.first().unwrap_or(channel.at);
                self.wrong(&codes::WRONG_CHANNEL, at, say!("only a number of a panel has limits"));
            }
            (Point::Good, _) => self.good(channel, subject, device, class),
            (_, Some(Way::Mqtt(broker))) => self.message(channel, subject, (device, &broker), class),
            (_, Some(Way::S7(_))) => self.point(channel, subject, device, class, points::cell),
            (_, Some(Way::Gpio(_))) => self.point(channel, subject, device, class, points::line),
            (_, Some(Way::OpcUa(_))) => self.point(channel, subject, device, class, nodes::wire),
            (_, Some(Way::OpcUaServer(_))) => {
                let shown = nodes::shown(channel, subject, class);
                self.place(channel, subject, device, class, shown);
            }
            (Point::Modbus(register), _) => self.register(channel, subject, device, *register, class),
            (point, _) => {
                let what = say!("`{point}` is no point of `{}`", channel.device.value);
                let help = match point {
                    Point::S7(_) => say!("only a controller of Siemens has such addresses: `kind = \"s7\"`"),
                    Point::Line(_) => say!("only a chip has lines: `kind = \"gpio\"`"),
                    Point::Panel(_) => say!("only a panel has buttons and lamps: `kind = \"panel\"`"),
                    Point::Node(_) => say!("only OPC UA has nodes: `kind = \"opc-ua\"`"),
                    _ => say!("only a broker has messages: `kind = \"mqtt\"`"),
                };
                self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help);
            }
        }
    }

    /// An input that tells whether the device answers.
    fn good(&mut self, channel: &Channel, subject: &Subject, device: usize, class: Class) {
        match subject.input {
            Some(index) if class == Class::Input && subject.kind == Kind::Bool => {
                if let Some(wired) = self.wiring.devices.get_mut(device) {
                    wired.good.push(index);
                }
            }
            _ => {
                let what = say!("`good()` is a BOOL that is read, and `{}` is none", subject.name);
                self.wrong(&codes::WRONG_CHANNEL, channel.at, what);
            }
        }
    }

    /// An address of a controller of Siemens, a line of a chip, or a node of a server of OPC UA.
    fn point(&mut self, channel: &Channel, subject: &Subject, device: usize, class: Class, read: Read) {
        if class == Class::Shown {
            let (what, help) = not_shown(&channel.point);
            self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help);
            return;
        }
        self.place(channel, subject, device, class, read(channel, &subject.carried(class)));
    }

    /// A point that nothing else has.
    fn place(
        &mut self,
        channel: &Channel,
        subject: &Subject,
        device: usize,
        class: Class,
        read: Result<(Wire, Scaling), Refused>,
    ) {
        let (wire, scaling) = match read {
            Ok(wired) => wired,
            Err(Refused { at, what, help }) => {
                self.wrong(&codes::WRONG_CHANNEL, at, what).help = help;
                return;
            }
        };
        let places = match &wire {
            // Several inputs may read one address or node; a line and a node of our own have one use.
            Wire::S7(cell) if class == Class::Output => points::bits(cell),
            Wire::Node(_) if class == Class::Output => vec![wire.to_string()],
            Wire::Line(_) | Wire::Shown(_) => vec![wire.to_string()],
            _ => Vec::new(),
        };
        for place in places {
            if !self.is_unused(channel, subject, device, place) {
                return;
            }
        }
        self.connect(channel, subject, device, (wire, scaling), class);
    }

    /// A part of a panel.
    fn panel(&mut self, channel: &Channel, subject: &Subject, device: usize, class: Class) {
        let press = match self.wiring.devices.get(device).map(|d| &d.device.kind) {
            Some(Way::Panel(panel)) => panel.press,
            Some(_) | None => Nanos::ZERO,
        };
        if channel.point == Point::Panel(Handle::Button) && press < self.bench.period {
            let period = self.bench.period.plain();
            let [press, each] = [press.plain(), period.clone()].map(Said::foreign);
            let what = say!("a press of {press} may fall between two scans, one each {each}");
            let help = say!("give the panel a longer `press`: `press = \"{period}\"`");
            self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help);
            return;
        }
        match handles::wire(channel, (&subject.name, subject.kind), class == Class::Input) {
            Ok(wired) => self.connect(channel, subject, device, wired, class),
            Err(Refused { at, what, help }) => self.wrong(&codes::WRONG_CHANNEL, at, what).help = help,
        }
    }

    /// A topic or metric of a broker.
    fn message(
        &mut self,
        channel: &Channel,
        subject: &Subject,
        (device, broker): (usize, &Broker),
        class: Class,
    ) {
        let (wire, scaling) = match messages::wire(channel, &subject.carried(class), broker) {
            Ok(wired) => wired,
            Err(Refused { at, what, help }) => {
                self.wrong(&codes::WRONG_CHANNEL, at, what).help = help;
                return;
            }
        };
        let place = match &wire {
            // Several inputs may read one topic.
            Wire::Topic(topic) => (class != Class::Input).then(|| topic.name.clone()),
            Wire::Metric(name) => Some(name.clone()),
            _ => None,
        };
        let will = matches!(&wire, Wire::Topic(topic) if topic.will).then(|| WILL.to_owned());
        for place in place.into_iter().chain(will) {
            if !self.is_unused(channel, subject, device, place) {
                return;
            }
        }
        self.connect(channel, subject, device, (wire, scaling), class);
    }

    /// True if nothing else publishes there.
    fn is_unused(&mut self, channel: &Channel, item: &Subject, device: usize, place: String) -> bool {
        let kind = |k: usize| self.wiring.devices.get(k).map(|d| &d.device.kind);
        let of = |broker: &Broker| (broker.host.clone(), broker.port, broker.sparkplug.clone());
        let same = |k: &usize| match (kind(*k), kind(device)) {
            (Some(Way::Mqtt(one)), Some(Way::Mqtt(other))) => of(one) == of(other),
            (Some(Way::OpcUa(one)), Some(Way::OpcUa(other))) => one.url == other.url,
            (one, other) => one == other,
        };
        // Two clients of one broker publish to the same topics, but each has a will of its own.
        let first = (0..device).find(same).unwrap_or(device);
        let key = (if place == WILL { device } else { first }, place);
        if let Some((other, there)) = self.messages.get(&key).cloned() {
            let what = match key.1.as_str() {
                WILL => say!("`{}` and `{other}` are both the will of one client", item.name),
                place => one_point(&item.name, &other, place),
            };
            self.wrong(&codes::WIRED_TWICE, channel.at, what)
                .related
                .push((there, say!("`{other}` is wired here")));
            return false;
        }
        self.messages.insert(key, (item.name.clone(), channel.at));
        true
    }

    fn register(
        &mut self,
        channel: &Channel,
        subject: &Subject,
        device: usize,
        register: Register,
        class: Class,
    ) {
        let server = self.wiring.devices.get(device).is_some_and(|d| d.device.kind.is_server());
        if let Some((what, help)) = refused(register, class, server) {
            self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help);
            return;
        }
        let Some((encoding, scaling)) = self.scaling(channel, subject, register) else { return };
        // Several inputs may read one point of a device; a point of a server has one use.
        if (class != Class::Input || server) && !self.is_free(channel, subject, device, register, encoding) {
            return;
        }
        self.connect(channel, subject, device, (Wire::Modbus(Place { register, encoding }), scaling), class);
    }

    /// Adds a channel to its device.
    fn connect(
        &mut self,
        channel: &Channel,
        subject: &Subject,
        device: usize,
        (wire, scaling): (Wire, Scaling),
        class: Class,
    ) {
        let name = subject.name.clone();
        match (class, subject.input) {
            (Class::Input, Some(index)) => {
                let Some(bad) = self.bad(channel, &scaling) else { return };
                let Some(wired) = self.wiring.devices.get_mut(device) else { return };
                wired.inputs.push(In { name, target: Target::Input(index), wire, scaling, bad });
            }
            (Class::Input, None) => {}
            (Class::Output | Class::Shown, _) => {
                let (source, out) = (subject.source, Out { scaling, safe: subject.safe });
                let Some(wired) = self.wiring.devices.get_mut(device) else { return };
                wired.outputs.push(OutAt { name, source, wire, out });
            }
        }
    }

    /// How the variable and the point go together.
    fn scaling(
        &mut self,
        channel: &Channel,
        item: &Subject,
        register: Register,
    ) -> Option<(Option<Encoding>, Scaling)> {
        let bit = register.area.is_bits() || register.bit.is_some();
        let fits = match item.kind {
            Kind::Bool => bit,
            Kind::Text => false,
            Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => !bit,
        };
        if !fits {
            let what =
                say!("`{register}` cannot carry `{}`, which is {}", item.name, Said::foreign(&item.ty));
            let help = match item.kind {
                Kind::Bool => {
                    say!("a BOOL is a coil, a discrete input, or one bit of a register: `holding(4.0)`")
                }
                Kind::Text => say!("a STRING cannot be wired"),
                _ => say!("a number is in registers: `input(…)` or `holding(…)`"),
            };
            self.wrong(&codes::WRONG_CHANNEL, channel.at, what).help = Some(help);
            return None;
        }
        let inverted = item.inverted;
        let numbers = [&channel.scale, &channel.offset].into_iter().flatten().map(|s| s.at);
        if bit {
            let first = numbers.chain(channel.encoding.as_ref().map(|e| e.at)).next();
            if let Some(at) = first {
                self.wrong(&codes::WRONG_CHANNEL, at, say!("one bit has no scale, offset or form of number"));
                return None;
            }
            let scaling = Scaling { kind: item.kind, holds: Holds::Bit, inverted, scale: 1.0, offset: 0.0 };
            return Some((None, scaling));
        }
        let encoding = channel.encoding.as_ref().map_or_else(|| forms::usual(item.kind), |e| e.value);
        if u32::from(register.address) + u32::from(encoding.registers()) > 65_536 {
            self.wrong(
                &codes::WRONG_CHANNEL,
                channel.at,
                say!("the number goes beyond the last register, 65535"),
            );
            return None;
        }
        let holds = forms::holds(encoding);
        let value = |number: &Option<At<f64>>, usual| number.as_ref().map_or(usual, |n| n.value);
        let (scale, offset) = (value(&channel.scale, 1.0), value(&channel.offset, 0.0));
        Some((Some(encoding), Scaling { kind: item.kind, holds, inverted: false, scale, offset }))
    }

    /// True if nothing else has the point, or a part of it.
    fn is_free(
        &mut self,
        channel: &Channel,
        item: &Subject,
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
            let what = one_point(&item.name, &other, &register.to_string());
            self.wrong(&codes::WIRED_TWICE, channel.at, what)
                .related
                .push((there, say!("`{other}` is wired here")));
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
            let what = say!("`{}` cannot have this value", channel.variable.value);
            self.wrong(&codes::WRONG_CHANNEL, channel.bad.at, what);
        }
        word.map(WhileBad::Word)
    }
}

/// Reads the point of a channel, with what its variable carries.
type Read = fn(&Channel, &Carried<'_>) -> Result<(Wire, Scaling), Refused>;

/// The key of the will among the points of a broker; no topic and no metric is empty.
const WILL: &str = "";

/// Why two have one point.
fn one_point(one: &str, other: &str, place: &str) -> Said {
    say!("`{one}` and `{other}` are wired to one point, {}", Said::foreign(place))
}

/// Why a device shows nothing, and what to do instead.
fn not_shown(point: &impl std::fmt::Display) -> (Said, Said) {
    let help = say!(
        "only a server or a broker shows: `kind = \"modbus-server\"`, `kind = \"opc-ua-server\"`, `kind = \"mqtt\"`"
    );
    (say!("`{point}` belongs to a device that does not ask"), help)
}

/// Why a use of a table is refused, and what to do instead.
fn refused(register: Register, class: Class, server: bool) -> Option<(Said, Said)> {
    let is_writable = register.area.is_writable();
    match class {
        Class::Shown if !server => Some(not_shown(&register)),
        Class::Input if server && !is_writable => Some((
            say!("`{register}` cannot be written by a master"),
            say!("inputs from a master are coils or holding registers"),
        )),
        Class::Output if !server && !is_writable => {
            Some((say!("`{register}` cannot be written"), say!("outputs are coils or holding registers")))
        }
        Class::Input | Class::Output | Class::Shown => None,
    }
}
