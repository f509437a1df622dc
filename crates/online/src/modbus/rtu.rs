//! Frames of Modbus RTU on a serial line (Modbus over serial line 1.02, 2.5.1), and the lines that
//! several slaves share.
//!
//! The library's own serial transport is not used, because what it is built on is not under a
//! permissive licence.
//!
//! An answer on a serial line does not say what it is an answer to. So after an answer that did not come,
//! or was none, a slave is first asked for an echo with a number of its own (application protocol 1.1b3,
//! 6.8): a slave answers in turn, so what comes behind the echo is not late. A slave that does not know the
//! echo refuses it; as refusals have no number, there must be as many as echoes were asked for.

use std::collections::BTreeMap;
use std::future::{Future, ready};
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use serial2::{CharSize, FlowControl, Parity as Bit, SerialPort, Settings, StopBits};
use voltage_modbus::{
    ModbusError, ModbusFunction, ModbusRequest, ModbusResponse, ModbusResult, ModbusTransport, TransportStats,
};

use crate::setup::{Parity, Serial};

/// Bits of a character: start, eight, parity or a second stop bit, stop.
const CHARACTER: u64 = 11;
/// Half characters of silence between two frames.
const SILENCE: u64 = 7;
/// The silence of fast lines, above 19,200 baud.
const LEAST: Duration = Duration::from_micros(1750);
/// The pause behind a broadcast, in which slaves carry it out.
const TURNAROUND: Duration = Duration::from_millis(100);
/// The longest frame.
const LONGEST: usize = 256;

/// The function of diagnostics, of which sub-function 0 is the echo.
const ECHO: u8 = 8;
/// A slave that has said nothing for so many time-outs has nothing left to answer. One that was never heard
/// about an echo is asked without it then.
const SILENT: u8 = 3;
/// Echoes that a slave is asked for in vain, whatever it said before: it may be another slave by now.
const ECHOES: u8 = 100;
/// Bytes that are looked through for an echo at most.
const NOISE: usize = 4096;

/// How a slave answers a request for an echo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Habit {
    /// It has never answered one.
    #[default]
    Unknown,
    /// By the same bytes.
    Echoes,
    /// By an exception.
    Refuses,
}

/// The answers of a unit that are outstanding.
#[derive(Clone, Copy, Debug, Default)]
struct Unit {
    habit: Habit,
    /// It may still answer an earlier request.
    late: bool,
    /// Echoes that it was asked for and has neither given nor refused.
    owed: usize,
    /// The number of the last of them.
    number: u16,
    /// Attempts since the answer that is late, and how many of the last ones heard nothing.
    tries: u8,
    silent: u8,
}

/// A line that is open.
struct Open {
    port: SerialPort,
    units: BTreeMap<u8, Unit>,
    /// The number of the last echo.
    echo: u16,
}

/// A serial line. Its slaves take turns.
pub(super) struct Line {
    serial: Serial,
    port: Mutex<Option<Open>>,
}

impl Line {
    /// A line that is not open yet.
    pub(crate) fn new(serial: Serial) -> Line {
        Line { serial, port: Mutex::new(None) }
    }

    /// Waits until no other slave has the line.
    fn lock(&self) -> MutexGuard<'_, Option<Open>> {
        // A port that was in use in a panic is no worse than any other.
        self.port.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens the line, if it is not open.
    pub(crate) fn open(&self) -> io::Result<()> {
        let mut slot = self.lock();
        if slot.is_none() {
            let port = SerialPort::open(&self.serial.port, |settings: Settings| self.configure(settings))?;
            *slot = Some(Open { port, units: BTreeMap::new(), echo: 0 });
        }
        Ok(())
    }

    fn configure(&self, mut settings: Settings) -> io::Result<Settings> {
        settings.set_raw();
        settings.set_baud_rate(self.serial.baud)?;
        settings.set_char_size(CharSize::Bits8);
        settings.set_stop_bits(if self.serial.two_stop_bits { StopBits::Two } else { StopBits::One });
        settings.set_parity(match self.serial.parity {
            Parity::Even => Bit::Even,
            Parity::Odd => Bit::Odd,
            Parity::None => Bit::None,
        });
        settings.set_flow_control(FlowControl::None);
        Ok(settings)
    }

    /// The silence between two frames.
    fn silence(&self) -> Duration {
        let nanos = CHARACTER * SILENCE * 1_000_000_000 / (2 * u64::from(self.serial.baud.max(1)));
        Duration::from_nanos(nanos).max(LEAST)
    }
}

/// One slave's use of a line.
pub(super) struct Slave {
    pub(super) line: Arc<Line>,
    pub(super) timeout: Duration,
}

impl Slave {
    fn ask(&self, request: &ModbusRequest) -> ModbusResult<ModbusResponse> {
        request.validate()?;
        let unit = request.slave_id;
        let mut frame = vec![unit];
        frame.extend_from_slice(request.encode_pdu()?.as_slice());
        let frame = checked(frame);
        let mut slot = self.line.lock();
        let Some(open) = slot.as_mut() else {
            return Err(ModbusError::Connection { message: "the serial line is closed".to_owned() });
        };
        let answer = self.agree(open, unit).and_then(|()| {
            let answer = self.exchange(&mut open.port, &frame)?;
            let Some(answer) = answer else { return Ok(ModbusResponse::new_broadcast_ack(request.function)) };
            response(answer, unit, request.function)
        });
        match &answer {
            Ok(_) => {}
            // The adapter is gone; the next attempt opens the line anew.
            Err(ModbusError::Io { .. }) => *slot = None,
            Err(_) => open.units.entry(unit).or_default().late = true,
        }
        answer
    }

    /// Waits until a unit has answered all that it was asked before.
    fn agree(&self, open: &mut Open, unit: u8) -> ModbusResult<()> {
        let Open { port, units, echo } = open;
        let Some(state) = units.get_mut(&unit).filter(|state| state.late) else { return Ok(()) };
        if state.silent >= SILENT {
            state.owed = 0;
        }
        if state.tries >= ECHOES || (state.silent >= SILENT && state.habit == Habit::Unknown) {
            *state = Unit::default();
            return Ok(());
        }
        state.tries += 1;
        // Refusals of several echoes cannot be told apart, so a new one waits for those before it.
        if state.owed == 0 || state.habit == Habit::Echoes {
            *echo = echo.wrapping_add(1);
            (state.number, state.owed) = (*echo, state.owed + 1);
            std::thread::sleep(self.line.silence());
            self.write(port, &request_of_echo(unit, *echo))?;
        }
        let (mut heard, mut clock) = (Vec::new(), WallClock::default());
        let answered = self.hear_echo(port, state, unit, &mut clock, &mut heard);
        match answered {
            Ok(habit) => *state = Unit { habit, ..Unit::default() },
            Err(_) => {
                state.silent = if heard.is_empty() { state.silent.saturating_add(1) } else { 0 };
                state.owed = state.owed.saturating_sub(refusals(&heard, unit));
            }
        }
        answered.map(drop)
    }

    /// Listens until a unit has answered the last echo, and so all that came before; says how.
    fn hear_echo(
        &self,
        port: &mut SerialPort,
        state: &Unit,
        unit: u8,
        clock: &mut WallClock,
        heard: &mut Vec<u8>,
    ) -> ModbusResult<Habit> {
        let frame = request_of_echo(unit, state.number);
        loop {
            if heard.windows(frame.len()).any(|window| window == frame) {
                return Ok(Habit::Echoes);
            }
            if refusals(heard, unit) >= state.owed {
                return Ok(Habit::Refuses);
            }
            if heard.len() > NOISE {
                return Err(ModbusError::Frame { message: "nothing but noise".to_owned() });
            }
            self.hear(port, clock, LONGEST, heard)?;
        }
    }

    /// Sends a frame behind a silence; what has come until then is no answer to it.
    fn send(&self, port: &mut SerialPort, frame: &[u8]) -> ModbusResult<()> {
        std::thread::sleep(self.line.silence());
        port.discard_input_buffer().map_err(broken)?;
        self.write(port, frame)
    }

    fn write(&self, port: &mut SerialPort, frame: &[u8]) -> ModbusResult<()> {
        port.set_write_timeout(self.timeout).map_err(broken)?;
        port.write_all(frame).map_err(|e| self.late(e))?;
        port.flush().map_err(broken)
    }

    /// Reads some bytes, at most so many, in what is left of the time-out.
    fn hear(
        &self,
        port: &mut SerialPort,
        clock: &mut WallClock,
        most: usize,
        heard: &mut Vec<u8>,
    ) -> ModbusResult<()> {
        let spent = Duration::from_nanos(clock.now().max(Nanos::ZERO).count().unsigned_abs());
        let left = self.timeout.checked_sub(spent).filter(|left| !left.is_zero());
        port.set_read_timeout(left.ok_or_else(|| self.timed_out())?).map_err(broken)?;
        let mut bytes = [0; LONGEST];
        let count = port.read(bytes.get_mut(..most).unwrap_or(&mut [])).map_err(|e| self.late(e))?;
        if count == 0 {
            return Err(broken(io::ErrorKind::UnexpectedEof.into()));
        }
        heard.extend_from_slice(bytes.get(..count).unwrap_or(&[]));
        Ok(())
    }

    /// Sends a frame and takes the answer; `None` for a broadcast, which has none.
    fn exchange(&self, port: &mut SerialPort, frame: &[u8]) -> ModbusResult<Option<Vec<u8>>> {
        self.send(port, frame)?;
        if frame.first() == Some(&0) {
            std::thread::sleep(TURNAROUND);
            return Ok(None);
        }
        let mut clock = WallClock::default();
        let mut answer = Vec::with_capacity(LONGEST);
        let mut wanted = 2;
        while answer.len() < wanted {
            self.hear(port, &mut clock, wanted - answer.len(), &mut answer)?;
            wanted = wanted.max(length(&answer)?);
        }
        Ok(Some(answer))
    }

    fn timed_out(&self) -> ModbusError {
        ModbusError::Timeout { operation: "answer".to_owned(), timeout_ms: self.timeout.as_millis() as u64 }
    }

    fn late(&self, error: io::Error) -> ModbusError {
        if error.kind() == io::ErrorKind::TimedOut { self.timed_out() } else { broken(error) }
    }
}

fn broken(error: io::Error) -> ModbusError {
    ModbusError::Io { message: error.to_string() }
}

/// The bytes of an answer of which these have come; so many as are known to be needed.
fn length(answer: &[u8]) -> ModbusResult<usize> {
    Ok(match answer {
        [] | [_] => 2,
        // An exception has one byte.
        [_, function, ..] if function & 0x80 != 0 => 5,
        [_, 1..=4] => 3,
        [_, 1..=4, count, ..] => 5 + usize::from(*count),
        [_, 5 | 6 | 15 | 16, ..] => 8,
        [_, function, ..] => {
            return Err(ModbusError::Frame { message: format!("no function {function} was asked for") });
        }
    })
}

/// A frame with its checksum.
fn checked(mut frame: Vec<u8>) -> Vec<u8> {
    let check = crc(&frame);
    frame.extend(check.to_le_bytes());
    frame
}

/// The request for an echo, which is its answer as well.
fn request_of_echo(unit: u8, number: u16) -> Vec<u8> {
    let [high, low] = number.to_be_bytes();
    checked(vec![unit, ECHO, 0, 0, high, low])
}

/// How often a unit has refused to echo within these bytes.
fn refusals(bytes: &[u8], unit: u8) -> usize {
    let refusal = |five: &&[u8]| match five {
        [from, function, code, check @ ..] => {
            *from == unit
                && *function == ECHO | 0x80
                && *check == crc(&[*from, *function, *code]).to_le_bytes()
        }
        _ => false,
    };
    bytes.windows(5).filter(refusal).count()
}

fn response(answer: Vec<u8>, unit: u8, asked: ModbusFunction) -> ModbusResult<ModbusResponse> {
    let wrong = |message: String| Err(ModbusError::Frame { message });
    let Some((body, check)) = answer.split_last_chunk::<2>() else {
        return wrong("a short answer".to_owned());
    };
    if u16::from_le_bytes(*check) != crc(body) {
        return wrong("the checksum of the answer is wrong".to_owned());
    }
    let [slave, function, data @ ..] = body else { return wrong("a short answer".to_owned()) };
    if *slave != unit {
        return wrong(format!("slave {slave} has answered for {unit}"));
    }
    let kind = ModbusFunction::from_u8(function & 0x7f)?;
    if kind != asked {
        return wrong(format!("an answer to function {} came for {}", kind.to_u8(), asked.to_u8()));
    }
    if function & 0x80 != 0 {
        return Ok(ModbusResponse::new_exception(unit, kind, data.first().copied().unwrap_or(0)));
    }
    Ok(ModbusResponse::new_success(unit, kind, data.to_vec()))
}

/// CRC-16/MODBUS (Modbus over serial line 1.02, 6.2.2).
fn crc(bytes: &[u8]) -> u16 {
    crc::Crc::<u16>::new(&crc::CRC_16_MODBUS).checksum(bytes)
}

impl ModbusTransport for Slave {
    fn request(
        &mut self,
        request: &ModbusRequest,
    ) -> impl Future<Output = ModbusResult<ModbusResponse>> + Send {
        // Each device has a thread of its own, which may wait.
        ready(self.ask(request))
    }

    fn is_connected(&self) -> bool {
        self.line.lock().is_some()
    }

    fn close(&mut self) -> impl Future<Output = ModbusResult<()>> + Send {
        // The line stays open for its other slaves.
        ready(Ok(()))
    }

    fn get_stats(&self) -> TransportStats {
        TransportStats::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification (6.2.2): the frame 02 07 ends in 41 12.
    #[test]
    fn the_checksum_is_that_of_the_specification() {
        assert_eq!(crc(&[0x02, 0x07]), 0x1241);
    }

    #[test]
    fn the_length_of_an_answer_is_known_from_its_first_bytes() {
        let known = |bytes: &[u8]| length(bytes).ok();
        assert_eq!(known(&[1, 3]), Some(3));
        assert_eq!(known(&[1, 3, 4]), Some(9));
        assert_eq!(known(&[1, 0x83]), Some(5));
        assert_eq!(known(&[1, 16]), Some(8));
        assert_eq!(known(&[1, 99]), None);
    }

    #[test]
    fn wrong_answers_are_refused() {
        const HOLDING: ModbusFunction = ModbusFunction::ReadHoldingRegisters;
        let framed = |body: &[u8]| checked(body.to_vec());
        assert!(response(framed(&[1, 3, 2, 0, 7]), 1, HOLDING).is_ok());
        assert!(response(framed(&[2, 3, 2, 0, 7]), 1, HOLDING).is_err(), "another slave");
        let mut bad = framed(&[1, 3, 2, 0, 7]);
        bad[4] ^= 1;
        assert!(response(bad, 1, HOLDING).is_err(), "checksum");
        let input = ModbusFunction::ReadInputRegisters;
        assert!(response(framed(&[1, 3, 2, 0, 7]), 1, input).is_err(), "another function");
        assert!(response(framed(&[1, 0x83, 2]), 1, HOLDING).is_ok(), "an exception");
        assert!(response(framed(&[1, 0x84, 2]), 1, HOLDING).is_err(), "that of another function");
        assert!(response(vec![1], 1, HOLDING).is_err());
        assert!(response(Vec::new(), 1, HOLDING).is_err());
    }

    #[test]
    fn refusals_are_counted_for_their_unit() {
        let (late, refusal) = (checked(vec![7, 3, 2, 0, 9]), checked(vec![7, 0x88, 1]));
        assert_eq!(refusals(&late, 7), 0);
        assert_eq!(refusals(&[late.clone(), refusal.clone(), late, refusal].concat(), 7), 2);
        assert_eq!(refusals(&checked(vec![8, 0x88, 1]), 7), 0, "another unit");
        assert_eq!(refusals(&[7, 0x88, 1, 0, 0], 7), 0, "checksum");
    }

    #[test]
    fn an_echo_has_its_number() {
        assert_eq!(request_of_echo(7, 0x1234)[..6], [7, 8, 0, 0, 0x12, 0x34]);
        assert_ne!(request_of_echo(7, 0x1234), request_of_echo(7, 0x1233));
    }

    #[test]
    fn frames_are_apart_by_three_and_a_half_characters() {
        let line = |baud| {
            let port = "x".to_owned();
            Line::new(Serial { port, baud, parity: Parity::Even, two_stop_bits: false }).silence()
        };
        // 38.5 bits at 9600 baud.
        assert_eq!(line(9600).as_micros(), 4010);
        assert_eq!(line(115_200), LEAST);
    }
}
