//! Masters of Modbus TCP, which G7 is the server of.
//!
//! The tables that masters ask for, and the answers to their requests; `masters` has the connections. A
//! table has only the points that are wired: for any other the answer is exception 2.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;

use crate::device::{Absent, Device, Failed};
use crate::setup::{Area, Listen, Place};
use crate::value::Raw;
use crate::wired::Wired;

use super::blocks::{decode, encode};
use super::masters::Masters;
use super::shared::{duration, set};

/// A connection without a request is ended after this time, or after the silence of the io file where
/// that is longer.
const IDLE: Duration = Duration::from_secs(30);

/// A bit or register of the tables.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    value: u16,
    /// The bits that a master may write.
    writable: u16,
    /// A master has written it.
    written: bool,
}

/// The tables, and when they were asked for last.
#[derive(Debug, Default)]
struct Tables {
    cells: BTreeMap<(Area, u16), Cell>,
    clock: WallClock,
    asked: Option<Nanos>,
}

/// The tables as the connections see them.
#[derive(Debug, Default)]
struct Shared(Mutex<Tables>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Tables> {
        // A word is written whole, so tables are whole after a panic too.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A server as a device: its inputs are what masters write, its outputs what they read.
pub(super) struct Server {
    listen: Listen,
    shared: Arc<Shared>,
    inputs: Vec<Place>,
    outputs: Vec<Place>,
    at_work: Option<Masters>,
}

impl Server {
    /// A server that does not listen yet. A point that no master has written has no value.
    pub(super) fn new(listen: Listen, wired: &Wired) -> Server {
        let inputs: Vec<Place> = wired.inputs.iter().filter_map(|i| i.wire.place()).collect();
        let outputs: Vec<Place> = wired.outputs.iter().filter_map(|o| o.wire.place()).collect();
        let tables = Tables::new(&inputs, &outputs);
        Server { listen, shared: Arc::new(Shared(Mutex::new(tables))), inputs, outputs, at_work: None }
    }

    fn begin(&self) -> Result<Masters, Failed> {
        let shared = Arc::clone(&self.shared);
        let answer = move |function: u8, data: &[u8]| {
            let mut tables = shared.lock();
            tables.asked = Some(tables.clock.now());
            tables.answer(function, data)
        };
        let idle = duration(self.listen.silence).max(IDLE);
        Masters::listen(self.listen.address, idle, Arc::new(answer))
            .map_err(|e| Failed(format!("cannot listen at {}: {e}", self.listen.address)))
    }
}

/// Exception codes (Modbus application protocol 1.1b3, 7): illegal function, illegal data address, illegal data
/// value.
const FUNCTION: u8 = 1;
const ADDRESS: u8 = 2;
const VALUE: u8 = 3;

/// The addresses of a place.
fn addresses(place: &Place) -> impl Iterator<Item = u16> {
    let from = place.register.address;
    // The wiring refuses numbers that reach beyond the last register.
    (0..place.encoding.map_or(1, crate::setup::Encoding::registers)).map(move |k| from.saturating_add(k))
}

impl Device for Server {
    fn connect(&mut self) -> Result<(), Failed> {
        if self.at_work.is_none() {
            self.at_work = Some(self.begin()?);
        }
        Ok(())
    }

    /// Fails without a request for the time of the io file, but hands the outputs over all the same:
    /// the next master is to read present values.
    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut tables = self.shared.lock();
        for ((place, raw), _) in self.outputs.iter().zip(outputs).zip(write).filter(|(_, write)| **write) {
            tables.put(place, *raw, self.listen.low_word_first);
        }
        for (k, place) in self.inputs.iter().enumerate() {
            let value = tables.get(place, self.listen.low_word_first);
            set(inputs, k, value.ok_or_else(|| Absent::Refused("no master has written it".to_owned())));
        }
        let now = tables.clock.now();
        match tables.asked {
            Some(asked) if now - asked <= self.listen.silence => Ok(()),
            Some(_) => {
                tables.forget();
                Err(Failed(format!("no request for {}", self.listen.silence.plain())))
            }
            None => Err(Failed(format!("none has asked at {} yet", self.listen.address))),
        }
    }

    /// Does nothing: masters come and go, and the server goes on to listen for them until it is
    /// dropped.
    fn close(&mut self) {}
}

impl Tables {
    /// Tables with the places that masters write and those that they only read.
    fn new(written: &[Place], read: &[Place]) -> Tables {
        let mut tables = Tables::default();
        let all = written.iter().map(|place| (place, true)).chain(read.iter().map(|place| (place, false)));
        for (place, writable) in all {
            let bits = place.register.bit.map_or(u16::MAX, |bit| 1 << bit);
            for address in addresses(place) {
                let cell = tables.cells.entry((place.register.area, address)).or_default();
                cell.writable |= if writable { bits } else { 0 };
            }
        }
        tables
    }

    /// Gives a place its value.
    fn put(&mut self, place: &Place, raw: Raw, low_first: bool) {
        let (area, from) = (place.register.area, place.register.address);
        let mut words: Vec<u16> =
            addresses(place).map(|a| self.cells.get(&(area, a)).map_or(0, |c| c.value)).collect();
        if area.is_bits() {
            set(&mut words, 0, u16::from(raw == Raw::Bit(true)));
        } else {
            encode(place, from, raw, &mut words, low_first);
        }
        for (address, word) in addresses(place).zip(words) {
            if let Some(cell) = self.cells.get_mut(&(area, address)) {
                cell.value = word;
            }
        }
    }

    /// The value of a place; `None` where no master has written all of it.
    fn get(&self, place: &Place, low_first: bool) -> Option<Raw> {
        let (area, from) = (place.register.area, place.register.address);
        let words: Option<Vec<u16>> = addresses(place)
            .map(|a| self.cells.get(&(area, a)).filter(|c| c.written).map(|c| c.value))
            .collect();
        let words = words?;
        if area.is_bits() {
            return words.first().map(|word| Raw::Bit(*word != 0));
        }
        decode(place, from, &words, low_first)
    }

    /// Forgets what masters have written: a master that comes back has to say again what it wants.
    fn forget(&mut self) {
        self.cells.values_mut().for_each(|cell| cell.written = false);
    }

    /// The values of neighbours.
    fn read(&self, area: Area, from: u16, count: u16) -> Result<Vec<u16>, u8> {
        let end = from.checked_add(count.saturating_sub(1)).ok_or(ADDRESS)?;
        let values: Vec<u16> =
            self.cells.range((area, from)..=(area, end)).map(|(_, cell)| cell.value).collect();
        if values.len() == usize::from(count) { Ok(values) } else { Err(ADDRESS) }
    }

    /// Writes neighbours, all or none of them.
    fn write(&mut self, area: Area, from: u16, values: &[u16]) -> Result<(), u8> {
        let count = u16::try_from(values.len()).unwrap_or(u16::MAX);
        self.read(area, from, count)?;
        let range = (area, from)..=(area, from.saturating_add(count.saturating_sub(1)));
        if self.cells.range(range.clone()).any(|(_, cell)| cell.writable == 0) {
            return Err(ADDRESS);
        }
        for ((_, cell), value) in self.cells.range_mut(range).zip(values) {
            cell.value = cell.value & !cell.writable | value & cell.writable;
            cell.written = true;
        }
        Ok(())
    }

    /// Answers a request (Modbus application protocol 1.1b3, 6). What follows the function code is
    /// `data`; the answer begins with the function code. An exception is its number.
    fn answer(&mut self, function: u8, data: &[u8]) -> Result<Vec<u8>, u8> {
        let Some((head, rest)) = data.split_first_chunk::<4>() else {
            return Err(if FUNCTIONS.contains(&function) { VALUE } else { FUNCTION });
        };
        let (from, second) = (u16::from_be_bytes([head[0], head[1]]), u16::from_be_bytes([head[2], head[3]]));
        let within = |count: u16, most: u16| (1..=most).contains(&count);
        match function {
            1 | 2 if rest.is_empty() && within(second, 2000) => {
                let bits =
                    self.read(if function == 1 { Area::Coil } else { Area::Discrete }, from, second)?;
                let bytes =
                    bits.chunks(8).map(|eight| eight.iter().rev().fold(0, |all, bit| all << 1 | *bit as u8));
                Ok(counted(function, bytes.collect()))
            }
            3 | 4 if rest.is_empty() && within(second, 125) => {
                let words =
                    self.read(if function == 3 { Area::Holding } else { Area::Input }, from, second)?;
                Ok(counted(function, words.iter().flat_map(|word| word.to_be_bytes()).collect()))
            }
            5 if rest.is_empty() && matches!(second, 0 | 0xff00) => {
                self.write(Area::Coil, from, &[u16::from(second != 0)])?;
                Ok(echo(function, data))
            }
            6 if rest.is_empty() => {
                self.write(Area::Holding, from, &[second])?;
                Ok(echo(function, data))
            }
            15 | 16 => {
                let (most, bytes) =
                    if function == 15 { (1968, second.div_ceil(8)) } else { (123, second.saturating_mul(2)) };
                let body = rest.split_first().filter(|(n, body)| {
                    within(second, most) && u16::from(**n) == bytes && body.len() == usize::from(bytes)
                });
                let (_, body) = body.ok_or(VALUE)?;
                if function == 15 {
                    let bit = |k: u16| {
                        body.get(usize::from(k / 8)).map_or(0, |byte| u16::from(byte >> (k % 8) & 1))
                    };
                    self.write(Area::Coil, from, &(0..second).map(bit).collect::<Vec<u16>>())?;
                } else {
                    let words: Vec<u16> =
                        body.chunks_exact(2).map(|two| u16::from_be_bytes([two[0], two[1]])).collect();
                    self.write(Area::Holding, from, &words)?;
                }
                Ok(echo(function, head))
            }
            _ if FUNCTIONS.contains(&function) => Err(VALUE),
            _ => Err(FUNCTION),
        }
    }
}

/// The functions that are answered: reading and writing of the four tables.
const FUNCTIONS: [u8; 8] = [1, 2, 3, 4, 5, 6, 15, 16];

fn counted(function: u8, bytes: Vec<u8>) -> Vec<u8> {
    // At most 250 bytes, by the limits of the counts.
    [vec![function, bytes.len() as u8], bytes].concat()
}

fn echo(function: u8, data: &[u8]) -> Vec<u8> {
    [&[function], data].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Encoding, Register};

    /// A place, and true if masters write it.
    fn places() -> [(Place, bool); 6] {
        let place =
            |area, address, bit, encoding| Place { register: Register { area, address, bit }, encoding };
        [
            (place(Area::Coil, 0, None, None), true),
            (place(Area::Coil, 1, None, None), true),
            (place(Area::Coil, 2, None, None), false),
            (place(Area::Holding, 5, None, Some(Encoding::Signed(2))), true),
            (place(Area::Holding, 7, Some(3), None), true),
            (place(Area::Input, 0, None, Some(Encoding::F32)), false),
        ]
    }

    /// The number in the holding registers 5 and 6.
    fn number(tables: &Tables, low_first: bool) -> Option<Raw> {
        tables.get(&places()[3].0, low_first)
    }

    fn tables() -> Tables {
        let of = |master: bool| {
            let places = places().into_iter().filter(move |(_, written)| *written == master);
            places.map(|(place, _)| place).collect::<Vec<Place>>()
        };
        Tables::new(&of(true), &of(false))
    }

    /// The answer, or the number of the exception.
    fn ask(tables: &mut Tables, function: u8, data: &[u8]) -> Result<Vec<u8>, u8> {
        tables.answer(function, data)
    }

    #[test]
    fn requests_are_answered_as_the_protocol_says() {
        let mut t = tables();
        t.put(&places()[5].0, Raw::Real(1.5), false);
        // IEEE 754: 1.5 is 3FC00000.
        assert_eq!(ask(&mut t, 4, &[0, 0, 0, 2]), Ok(vec![4, 4, 0x3f, 0xc0, 0, 0]));
        // Coils 0 and 1 at once: the lowest bit is the first.
        assert_eq!(ask(&mut t, 15, &[0, 0, 0, 2, 1, 0b10]), Ok(vec![15, 0, 0, 0, 2]));
        assert_eq!(ask(&mut t, 1, &[0, 0, 0, 3]), Ok(vec![1, 1, 0b010]));
        assert_eq!(ask(&mut t, 5, &[0, 0, 0xff, 0]), Ok(vec![5, 0, 0, 0xff, 0]));
        assert_eq!(ask(&mut t, 1, &[0, 0, 0, 1]), Ok(vec![1, 1, 1]));
        assert_eq!(ask(&mut t, 16, &[0, 5, 0, 2, 4, 0xff, 0xff, 0xff, 0xfe]), Ok(vec![16, 0, 5, 0, 2]));
        assert_eq!(number(&t, false), Some(Raw::Whole(-2)));
        // Of register 7 only bit 3 is the master's.
        assert_eq!(ask(&mut t, 6, &[0, 7, 0xff, 0xff]), Ok(vec![6, 0, 7, 0xff, 0xff]));
        assert_eq!(ask(&mut t, 3, &[0, 7, 0, 1]), Ok(vec![3, 2, 0, 8]));
    }

    #[test]
    fn a_value_that_is_written_in_part_is_none() {
        let mut t = tables();
        assert_eq!(number(&t, false), None);
        ask(&mut t, 6, &[0, 5, 0, 1]).expect("it is the master's");
        assert_eq!(number(&t, false), None);
        ask(&mut t, 6, &[0, 6, 0, 2]).expect("it is the master's");
        assert_eq!(number(&t, false), Some(Raw::Whole(0x0001_0002)));
        assert_eq!(number(&t, true), Some(Raw::Whole(0x0002_0001)));
    }

    #[test]
    fn wrong_requests_are_refused_by_number_and_change_nothing() {
        let mut t = tables();
        let cases: &[(u8, &[u8], u8)] = &[
            (0, &[0, 0, 0, 1], 1),
            (22, &[0, 5, 0, 0, 0, 0], 1),
            (43, &[], 1),
            (1, &[], 3),
            (1, &[0, 0, 0, 0], 3),
            (1, &[0, 0, 7, 0xd1], 3),
            (3, &[0, 5, 0, 126], 3),
            (3, &[0, 5, 0, 1, 0], 3),
            (5, &[0, 0, 0, 1], 3),
            (15, &[0, 0, 0, 2, 2, 0, 0], 3),
            (16, &[0, 5, 0, 1, 2, 0], 3),
            (16, &[0, 5, 0xff, 0xff, 0xff, 0, 0], 3),
            (16, &[0, 5, 0, 1], 3),
            (1, &[0, 2, 0, 2], 2),
            (1, &[0xff, 0xff, 0, 2], 2),
            (2, &[0, 0, 0, 1], 2),
            (5, &[0, 2, 0, 0], 2),
            (15, &[0, 1, 0, 2, 1, 3], 2),
            (6, &[0, 9, 0, 0], 2),
            (16, &[0, 6, 0, 3, 6, 0, 1, 0, 1, 0, 1], 2),
        ];
        for (function, data, number) in cases {
            assert_eq!(ask(&mut t, *function, data), Err(*number), "{function} {data:?}");
        }
        assert!(t.cells.values().all(|cell| cell.value == 0 && !cell.written), "{t:?}");
    }

    #[test]
    fn no_request_panics_or_gets_a_long_answer() {
        let mut t = tables();
        let mut random = 1u64;
        let mut next = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as u8
        };
        let (mut answered, mut refused) = (0, 0);
        for _ in 0..100_000 {
            let function = next() % 24;
            let mut byte = |k: u8| match next() % 8 {
                0 => next(),
                // Small numbers behind zeros meet the points that there are.
                _ if k.is_multiple_of(2) => 0,
                _ => next() % 4,
            };
            let data: Vec<u8> = (0..4).map(&mut byte).collect();
            let more = next() % 8;
            let data = [data, (0..more.saturating_sub(3)).map(|_| next() % 4).collect()].concat();
            match t.answer(function, &data) {
                Ok(answer) => {
                    assert!(answer.len() <= 253 && answer.first() == Some(&function), "{function} {data:?}");
                    answered += 1;
                }
                Err(_) => refused += 1,
            }
            assert_eq!(t.cells.get(&(Area::Coil, 2)).map(|c| c.value), Some(0), "{function} {data:?}");
        }
        assert!(answered > 100 && refused > 100, "{answered} {refused}");
    }
}
