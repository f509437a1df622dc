//! How a variable is carried by an address of a controller of Siemens, or by a line of this machine.
//!
//! Pure: `wiring` holds the channel against the chart and the device, and asks here for the rest.

use g7_host::Kind;
use g7_model::{Said, Span, say};

use crate::forms;
use crate::messages::{Carried, Refused};
use crate::setup::{Address, Channel, Encoding, Kind as Way, Memory, Point, Width};
use crate::value::{Holds, Scaling};
use crate::wire::{Cell, Form, Line, Wire};

fn refused(at: Span, what: Said, help: Option<Said>) -> Refused {
    Refused { at, what, help }
}

/// A setting of a channel that the points of a kind of device do not have: its place, and who has it.
pub(crate) fn misplaced(channel: &Channel, kind: Option<&Way>) -> Option<(Span, Said)> {
    let message = channel.message.first().map(|at| (at, say!("only a topic has messages")));
    let pin = channel.pin.first();
    let pin = pin.map(|at| (at, say!("only a line of a chip has a bias, a level and a debounce time")));
    let unit =
        channel.unit.as_ref().map(|unit| (unit.at, say!("only an OPC UA server of our own shows a unit")));
    match kind {
        Some(Way::Gpio(_)) => message.or(unit),
        Some(Way::Mqtt(_)) => pin.or(unit),
        Some(Way::OpcUaServer(_)) => message.or(pin),
        _ => message.or(pin).or(unit),
    }
}

/// The cell of a channel at a controller of Siemens, and how its value becomes a word.
pub(crate) fn cell(channel: &Channel, carried: &Carried<'_>) -> Result<(Wire, Scaling), Refused> {
    let at = channel.at;
    let Point::S7(address) = &channel.point else {
        let what = say!("`{}` is no address of a controller of Siemens", channel.point);
        return Err(refused(
            at,
            what,
            Some(say!("write `DB1.DBX0.0`, `DB1.DBW2`, `M0.0`, `MW2`, `I0.0` or `Q0.0`")),
        ));
    };
    if carried.safe && address.memory == Memory::Input {
        return Err(refused(
            at,
            say!("`{address}` cannot be written"),
            Some(say!("outputs are in DB, M or Q")),
        ));
    }
    let form = form(channel, carried, address)?;
    let numbers = [&channel.scale, &channel.offset];
    let holds = match form {
        Form::Bit(_) => {
            if let Some(number) = numbers.into_iter().flatten().next() {
                return Err(refused(number.at, say!("one bit has no scale or offset"), None));
            }
            Holds::Bit
        }
        Form::Byte { signed } => Holds::Whole { bits: 8, signed },
        Form::Number(encoding) => forms::holds(encoding),
    };
    let [scale, offset] = [(&channel.scale, 1.0), (&channel.offset, 0.0)]
        .map(|(number, usual)| number.as_ref().map_or(usual, |n| n.value));
    let inverted = carried.inverted && holds == Holds::Bit;
    let cell = Cell { memory: address.memory, byte: address.byte, form };
    if cell.end() > 65_536 {
        return Err(refused(at, say!("the number goes beyond the last byte, 65535"), None));
    }
    Ok((Wire::S7(cell), Scaling { kind: carried.kind, holds, inverted, scale, offset }))
}

/// How the bytes of an address hold the variable.
fn form(channel: &Channel, carried: &Carried<'_>, address: &Address) -> Result<Form, Refused> {
    let wrong = |what: Said, help: Said| Err(refused(channel.at, what, Some(help)));
    let none = say!("`{address}` cannot carry `{}`", carried.name);
    let width: u16 = match (address.width, carried.kind) {
        (_, Kind::Text) => return wrong(none, say!("a STRING cannot be wired")),
        (Width::Bit(bit), Kind::Bool) => {
            return match &channel.encoding {
                None => Ok(Form::Bit(bit)),
                Some(form) => Err(refused(form.at, say!("one bit has no form of number"), None)),
            };
        }
        (Width::Bit(_), _) | (_, Kind::Bool) => {
            return wrong(
                say!("{none}: a BOOL is a bit, a number is not"),
                say!("a bit is `M0.0` or `DB1.DBX0.0`; a number is `MB0`, `MW0`, `MD0`"),
            );
        }
        (Width::Byte, _) => 1,
        (Width::Word, _) => 2,
        (Width::Double, _) => 4,
    };
    let signed = !matches!(carried.kind, Kind::Int { signed: false, .. });
    let Some(given) = &channel.encoding else {
        return Ok(match (width, carried.kind) {
            (1, _) => Form::Byte { signed },
            (4, Kind::Real | Kind::Lreal) => Form::Number(Encoding::F32),
            (bytes, _) => {
                let registers = if bytes == 4 { 2 } else { 1 };
                let number = if signed { Encoding::Signed(registers) } else { Encoding::Unsigned(registers) };
                Form::Number(number)
            }
        });
    };
    match (given.value.registers() * 2, width) {
        (bytes, width) if bytes == width => Ok(Form::Number(given.value)),
        (8, 1) => Ok(Form::Number(given.value)),
        _ => Err(refused(
            given.at,
            say!("this form of number has not the size of `{address}`"),
            Some(say!(
                "W has `u16` and `i16`, D has `u32`, `i32` and `f32`; `u64`, `i64` and `f64` begin at a byte: `DBB`"
            )),
        )),
    }
}

/// The line of a channel at a chip, and how its value becomes a word.
pub(crate) fn line(channel: &Channel, carried: &Carried<'_>) -> Result<(Wire, Scaling), Refused> {
    let Point::Line(offset) = &channel.point else {
        let what = say!("`{}` is no line of a chip", channel.point);
        return Err(refused(channel.at, what, Some(say!("write `line(17)`"))));
    };
    if carried.kind != Kind::Bool {
        let what = say!("a line is one bit and cannot carry `{}`", carried.name);
        return Err(refused(channel.at, what, Some(say!("wire a BOOL to it"))));
    }
    let numbers = [&channel.scale, &channel.offset].into_iter().flatten().map(|n| n.at);
    if let Some(at) = numbers.chain(channel.encoding.as_ref().map(|e| e.at)).next() {
        return Err(refused(at, say!("one bit has no scale, offset or form of number"), None));
    }
    let pin = &channel.pin;
    let line = Line {
        offset: *offset,
        bias: pin.bias.as_ref().map(|bias| bias.value),
        active_low: pin.active_low.as_ref().is_some_and(|low| low.value),
        debounce: pin.debounce.as_ref().map(|time| time.value),
    };
    let scaling =
        Scaling { kind: Kind::Bool, holds: Holds::Bit, inverted: carried.inverted, scale: 1.0, offset: 0.0 };
    Ok((Wire::Line(line), scaling))
}

/// The bits of a cell, for what overlaps.
pub(crate) fn bits(cell: &Cell) -> Vec<String> {
    let own = |byte: u16, bit: u8| {
        let form = Form::Bit(bit);
        Cell { byte, form, ..*cell }.address().to_string()
    };
    match cell.form {
        Form::Bit(bit) => vec![own(cell.byte, bit)],
        Form::Byte { .. } | Form::Number(_) => {
            let bytes = (0..cell.bytes()).map(|k| cell.byte.saturating_add(k));
            bytes.flat_map(|byte| (0..8).map(move |bit| (byte, bit))).map(|(y, t)| own(y, t)).collect()
        }
    }
}
