//! `g7 devices`: asks the devices of a chart, or one by hand, for their values. It writes nothing.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use g7_host::Value;
use g7_model::{Nanos, Span, say};
use g7_online::ask as wait;
use g7_online::setup::{
    Address, At, Broker, Device, Encoding, Kind, Listen, Modbus, Parity, Place, Point, Register, S7, Serial,
    Setup, Tcp, Timing, Width, read_point,
};
use g7_online::{
    Absent, Asked, Cell, Clients, Failed, Form, Line, Probed, Raw, Scaling, Wire, Wired, hear, probe,
};

use crate::brought;
use crate::failure::{Failure, Verdict, raw};
use crate::message::told;
use crate::wiring::{self, Wanted};
use crate::{files, sources, style, values};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 devices sorter.g7                                  all channels of sorter.io.toml
  g7 devices sorter.g7 --browse                         and all nodes of its OPC UA servers
  g7 devices --tcp 10.0.0.7 --read 'holding(0)' --count 10
  g7 devices --tcp 10.0.0.7:1502 --unit 3 --read 'input(4)' --as f32
  g7 devices --serial /dev/ttyUSB0 --baud 9600 --read 'coil(0)' --read 'coil(7)'
  g7 devices --s7 10.0.0.8 --slot 2 --read DB1.DBW2 --read M0.0
  g7 devices --gpio /dev/gpiochip0 --read 'line(17)'

Nothing is written to a device.

Exit codes:
  0  every device answers and has what was asked for
  1  a device does not answer, or refuses a point
  2  bad usage, or something outside the chart: no such file")]
pub(crate) struct Devices {
    /// A chart with an io file, or a folder with a chart.g7.
    #[arg(default_value = ".", conflicts_with_all = ["tcp", "serial", "s7", "gpio"])]
    path: PathBuf,
    /// The io file [default: chart.io.toml for chart.g7].
    #[arg(long, value_name = "FILE", conflicts_with_all = ["tcp", "serial", "s7", "gpio"])]
    io: Option<PathBuf>,
    /// List all points of the devices that can tell them: servers of OPC UA.
    #[arg(long, conflicts_with_all = ["tcp", "serial"])]
    browse: bool,
    /// Ask a server of Modbus TCP.
    #[arg(long, value_name = "HOST[:PORT]", conflicts_with_all = ["serial", "s7", "gpio"])]
    tcp: Option<String>,
    /// Ask a slave of Modbus RTU on this serial port.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["s7", "gpio"])]
    serial: Option<String>,
    /// Ask a controller of Siemens.
    #[arg(long, value_name = "HOST[:PORT]", conflicts_with = "gpio")]
    s7: Option<String>,
    /// The rack of its processor.
    #[arg(long, default_value_t = 0, requires = "s7", value_parser = clap::value_parser!(u8).range(0..=7))]
    rack: u8,
    /// The slot of its processor.
    #[arg(long, default_value_t = 1, requires = "s7", value_parser = clap::value_parser!(u8).range(0..=31))]
    slot: u8,
    /// Ask the lines of a chip of this machine.
    #[arg(long, value_name = "CHIP")]
    gpio: Option<String>,
    /// The unit or slave.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=247))]
    unit: u8,
    /// Bits per second of the serial port.
    #[arg(long, default_value_t = 19_200, requires = "serial")]
    baud: u32,
    /// The parity of the serial port: even, odd or none.
    #[arg(long, default_value = "even", requires = "serial", value_parser = parity)]
    parity: Parity,
    /// A point to read: `coil(2)`, `discrete(0)`, `input(4)`, `holding(4)`, `holding(4.3)`; `DB1.DBW2`,
    /// `M0.0`; `line(17)`.
    #[arg(long = "read", value_name = "POINT", value_parser = point)]
    points: Vec<Point>,
    /// Read so many points from each on.
    #[arg(long, default_value_t = 1, requires = "points", value_parser = clap::value_parser!(u16).range(1..=2000))]
    count: u16,
    /// The form of the numbers: u16, i16, u32, i32, u64, i64, f32, f64 [default: u16, or as wide as the address].
    #[arg(long = "as", requires = "points", value_name = "FORM", value_parser = encoding)]
    encoding: Option<Encoding>,
    /// The longest time of an answer.
    #[arg(long, default_value = "1s", value_parser = values::duration, value_name = "TIME")]
    timeout: Nanos,
}

fn parity(text: &str) -> Result<Parity, String> {
    let words = [("even", Parity::Even), ("odd", Parity::Odd), ("none", Parity::None)];
    word(text, &words)
}

fn encoding(text: &str) -> Result<Encoding, String> {
    word(text, Encoding::WORDS)
}

fn word<T: Copy>(text: &str, words: &[(&str, T)]) -> Result<T, String> {
    let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    let found = words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
    found.ok_or_else(|| format!("it is one of {}", names.join(", ")))
}

fn point(text: &str) -> Result<Point, String> {
    match read_point(text).map_err(|why| why.to_string())? {
        point @ (Point::Modbus(_) | Point::S7(_) | Point::Line(_)) => Ok(point),
        Point::Good | Point::Topic(_) | Point::Metric(_) | Point::Panel(_) | Point::Node(_) => {
            Err("this is no point to read by hand".to_owned())
        }
    }
}

/// A value to read and how it is shown.
struct Shown {
    name: String,
    wire: Wire,
    scaling: Option<Scaling>,
}

pub(crate) fn devices(args: &Devices) -> Result<Verdict, Failure> {
    if let Some(device) = by_hand(args)? {
        let mut shown = Vec::new();
        for point in &args.points {
            shown.extend(many(args, &device.kind, point).map_err(|why| Failure::Usage(raw(why)))?);
        }
        return ask(&mut Clients::default(), &device, &shown);
    }
    if !args.points.is_empty() {
        return Err(Failure::Usage(say!(
            "--read asks one device: name it by --tcp, --serial, --s7 or --gpio"
        )));
    }
    let path = files::one(&args.path)?;
    let source = sources::load(&path, 0)?;
    let wanted = Wanted { io: args.io.as_deref(), ..Wanted::default() };
    let Some(plan) = wiring::plan(&path, &source, &wanted)? else { return Ok(Verdict::Found) };
    let (mut clients, mut verdict) = (brought::clients(), Verdict::Fine);
    for wired in &plan.wiring.devices {
        let found = match &wired.device.kind {
            Kind::ModbusServer(Listen { address, .. }) => {
                served(wired, &format!("listens at {address} for masters"))?
            }
            Kind::OpcUaServer(server) => {
                served(wired, &format!("listens at {} for clients", server.address))?
            }
            Kind::Mqtt(broker) => heard(broker, wired)?,
            Kind::OpcUa(_) => asked(&mut clients, wired)?,
            Kind::Panel(_) => served(wired, "is on the operator page")?,
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::S7(_) | Kind::Gpio(_) => {
                ask(&mut clients, &wired.device, &channels(wired))?
            }
        };
        if found == Verdict::Found {
            verdict = Verdict::Found;
        }
        if args.browse && browse(&clients, &wired.device)? == Verdict::Found {
            verdict = Verdict::Found;
        }
    }
    Ok(verdict)
}

/// The device that the arguments describe.
fn by_hand(args: &Devices) -> Result<Option<Device>, Failure> {
    let modbus = Modbus { unit: args.unit, low_word_first: false };
    let kind = match (&args.tcp, &args.serial, &args.s7, &args.gpio) {
        (Some(tcp), ..) => {
            let (host, port) = place(tcp, 502)?;
            Kind::ModbusTcp(Tcp { host, port }, modbus)
        }
        (_, Some(port), ..) => {
            let (port, baud, parity) = (port.clone(), args.baud, args.parity);
            Kind::ModbusRtu(Serial { port, baud, parity, two_stop_bits: false }, modbus)
        }
        (_, _, Some(s7), _) => {
            let (host, port) = place(s7, 102)?;
            Kind::S7(S7 { host, port, rack: args.rack, slot: args.slot, resource: 1 })
        }
        (_, _, _, Some(chip)) => Kind::Gpio(chip.clone()),
        (None, None, None, None) => return Ok(None),
    };
    let nowhere = Span::default();
    let timing = Timing { timeout: args.timeout, ..Timing::default() };
    let device = Device { name: At { value: String::new(), at: nowhere }, kind, timing };
    let setup = Setup { devices: vec![device.clone()], ..Setup::default() };
    if let Some(problem) = g7_online::lacking(&setup).first() {
        let help = problem.help.clone().unwrap_or_default();
        return Err(Failure::Usage(say!("{}: {help}", problem.what)));
    }
    Ok(Some(device))
}

/// Reads `HOST` or `HOST:PORT`.
fn place(text: &str, usual: u16) -> Result<(String, u16), Failure> {
    let (host, port) = match text.rsplit_once(':') {
        Some((host, port)) => (host, port.parse().ok()),
        None => (text, Some(usual)),
    };
    let port = port.ok_or_else(|| Failure::Usage(say!("{text}: the port is no number", text = raw(text))))?;
    Ok((host.trim_matches(['[', ']']).to_owned(), port))
}

/// A point by hand, and those behind it.
fn many(args: &Devices, kind: &Kind, from: &Point) -> Result<Vec<Shown>, String> {
    let wires: Vec<Wire> = match (kind, from) {
        (Kind::ModbusTcp(..) | Kind::ModbusRtu(..), Point::Modbus(register)) => registers(args, *register),
        (Kind::S7(_), Point::S7(address)) => cells(args, *address)?,
        (Kind::Gpio(_), Point::Line(offset)) => {
            let line = |k: u16| Line {
                offset: offset + u32::from(k),
                bias: None,
                active_low: false,
                debounce: None,
            };
            (0..args.count).map(|k| Wire::Line(line(k))).collect()
        }
        (kind, point) => {
            return Err(format!("`{point}` is no point of a device of the kind \"{}\"", kind.word()));
        }
    };
    let shown = |wire: Wire| Shown { name: wire.to_string(), wire, scaling: None };
    Ok(wires.into_iter().map(shown).collect())
}

/// A bit or register of Modbus, and those behind it.
fn registers(args: &Devices, from: Register) -> Vec<Wire> {
    let bit = from.area.is_bits() || from.bit.is_some();
    let encoding = args.encoding.unwrap_or(Encoding::Unsigned(1));
    let step = if bit { 1 } else { encoding.registers() };
    let asked = |k: u16| {
        let address = from.address.checked_add(k.checked_mul(step)?)?;
        let register = Register { address, ..from };
        Some(Wire::Modbus(Place { register, encoding: (!bit).then_some(encoding) }))
    };
    (0..args.count).map_while(asked).collect()
}

/// The addresses that are read at a controller of Siemens: the given one, and as many behind it as `--count`
/// says. After a bit comes the same bit of the next byte.
fn cells(args: &Devices, from: Address) -> Result<Vec<Wire>, String> {
    let form = match (from.width, args.encoding) {
        (Width::Bit(bit), _) => Form::Bit(bit),
        (Width::Byte, None) => Form::Byte { signed: false },
        (Width::Word, None) => Form::Number(Encoding::Unsigned(1)),
        (Width::Double, None) => Form::Number(Encoding::Unsigned(2)),
        (Width::Word, Some(encoding)) if encoding.registers() == 1 => Form::Number(encoding),
        (Width::Double, Some(encoding)) if encoding.registers() == 2 => Form::Number(encoding),
        (Width::Byte, Some(encoding)) if encoding.registers() == 4 => Form::Number(encoding),
        (_, Some(_)) => return Err(format!("--as has not the size of {from}")),
    };
    let cell = |k: u16| {
        let first = Cell { memory: from.memory, byte: from.byte, form };
        let byte = from.byte.checked_add(k.checked_mul(first.bytes())?)?;
        byte.checked_add(first.bytes() - 1)?;
        Some(Wire::S7(Cell { byte, ..first }))
    };
    Ok((0..args.count).map_while(cell).collect())
}

/// The channels of a device; the present values of its outputs are read as well.
fn channels(wired: &Wired) -> Vec<Shown> {
    let inputs = wired.inputs.iter().map(|i| (&i.name, &i.wire, i.scaling));
    let outputs = wired.outputs.iter().map(|o| (&o.name, &o.wire, o.out.scaling));
    let all = wired.inputs.iter().map(|i| &i.name).chain(wired.outputs.iter().map(|o| &o.name));
    let width = all.map(|name| name.chars().count()).max().unwrap_or(0);
    let shown = |(name, wire, scaling): (&String, &Wire, Scaling)| Shown {
        name: format!("{name:<width$}  {wire}"),
        wire: wire.clone(),
        scaling: Some(scaling),
    };
    inputs.chain(outputs).map(shown).collect()
}

/// Asks a device and prints what it has.
fn ask(clients: &mut Clients, device: &Device, shown: &[Shown]) -> Result<Verdict, Failure> {
    let asked: Vec<Asked> = shown.iter().map(|s| s.wire.clone()).collect();
    print(device, shown, probe(clients, device, &asked))
}

/// Listens to a broker and prints the last values that it has.
fn heard(broker: &Broker, wired: &Wired) -> Result<Verdict, Failure> {
    print(&wired.device, &channels(wired), hear(broker, wired))
}

/// Asks a device that sends its values by itself, and prints them.
fn asked(clients: &mut Clients, wired: &Wired) -> Result<Verdict, Failure> {
    print(&wired.device, &channels(wired), wait(clients, wired))
}

/// Prints the points that a device tells of.
fn browse(clients: &Clients, device: &Device) -> Result<Verdict, Failure> {
    let (warn, name) = (style::WARN, &device.name.value);
    let mut out = anstream::stdout().lock();
    let verdict = match clients.browse(device) {
        None => {
            writeln!(out, "  {}", told(&say!("{} cannot be asked for its points", raw(name))))?;
            Verdict::Fine
        }
        Some(Err(why)) => {
            writeln!(out, "  {warn}{}{warn:#} {why}", told(&say!("its points cannot be read:")))?;
            Verdict::Found
        }
        Some(Ok(nodes)) => {
            writeln!(out, "  {}", told(&say!("points of {}:", raw(name))))?;
            for node in &nodes {
                let (indent, point) = ("  ".repeat(node.depth + 2), &node.point);
                match node.value {
                    true => writeln!(out, "{indent}{}  {point}", node.name)?,
                    false => writeln!(out, "{indent}{}", node.name)?,
                }
            }
            Verdict::Fine
        }
    };
    out.flush()?;
    Ok(verdict)
}

/// Prints the answer of a device.
fn print(device: &Device, shown: &[Shown], probed: Result<Probed, Failed>) -> Result<Verdict, Failure> {
    let (strong, good, bad, warn) = (style::STRONG, style::GOOD, style::BAD, style::WARN);
    let mut out = anstream::stdout().lock();
    let name = [device.name.value.clone(), device.kind.place()].join(" ");
    let name = name.trim();
    let probed = match probed {
        Ok(probed) => probed,
        Err(why) => {
            writeln!(out, "{strong}{name}{strong:#} {bad}{}{bad:#} {why}", told(&say!("does not answer:")))?;
            out.flush()?;
            return Ok(Verdict::Found);
        }
    };
    let took = told(&say!("in {} ms", raw(format!("{:.1}", probed.took.as_secs_f64() * 1e3))));
    writeln!(out, "{strong}{name}{strong:#} {good}{}{good:#} {took}", told(&say!("answers")))?;
    let width = shown.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
    let mut verdict = Verdict::Fine;
    for (shown, value) in shown.iter().zip(&probed.values) {
        let text = match value {
            Ok(raw) => text(*raw, shown.scaling.as_ref()),
            // A broker that keeps no message is no fault.
            Err(Absent::Unread) if matches!(shown.wire, Wire::Topic(_)) => told(&say!("no message")),
            // An edge node is the one who knows the values.
            Err(Absent::Unread) if matches!(shown.wire, Wire::Metric(_)) => told(&say!("of this node")),
            Err(why) => {
                verdict = Verdict::Found;
                let why = match why {
                    Absent::Unread => told(&say!("it gave no value")),
                    Absent::Refused(why) => why.clone(),
                };
                format!("{warn}{why}{warn:#}")
            }
        };
        writeln!(out, "  {:<width$}  {text}", shown.name)?;
    }
    out.flush()?;
    Ok(verdict)
}

/// Prints what others find at G7 itself while the controller runs: masters on a server of our own,
/// a person on a panel.
fn served(wired: &Wired, how: &str) -> Result<Verdict, Failure> {
    let strong = style::STRONG;
    let mut out = anstream::stdout().lock();
    let name = &wired.device.name.value;
    writeln!(out, "{strong}{name}{strong:#} {how}")?;
    let channels = channels(wired);
    let width = channels.iter().map(|c| c.name.chars().count()).max().unwrap_or(0);
    for (k, channel) in channels.iter().enumerate() {
        let use_ = if k < wired.inputs.len() { say!("written") } else { say!("read") };
        writeln!(out, "  {:<width$}  {}", channel.name, told(&use_))?;
    }
    out.flush()?;
    Ok(Verdict::Fine)
}

/// A value of a device, as the chart has it and as it is on the wire.
fn text(raw: Raw, scaling: Option<&Scaling>) -> String {
    let plain = plain(raw);
    let Some(scaling) = scaling else { return plain };
    match value(raw, scaling) {
        Some(value) if value == plain => value,
        Some(value) => format!("{value} (from {plain})"),
        None => format!("{plain}, which the variable cannot hold"),
    }
}

/// A value as it is on the wire.
pub(crate) fn plain(raw: Raw) -> String {
    match raw {
        Raw::Bit(on) => if on { "TRUE" } else { "FALSE" }.to_owned(),
        Raw::Whole(n) => n.to_string(),
        Raw::Real(x) => x.to_string(),
    }
}

/// A value as the chart has it; `None` where the variable cannot hold it.
pub(crate) fn value(raw: Raw, scaling: &Scaling) -> Option<String> {
    scaling.word(raw).map(|word| Value::Word(word).show(scaling.kind))
}
