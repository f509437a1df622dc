//! Messages of S7 over ISO transport on TCP (RFC 1006, with the data units of ISO 8073), as controllers of
//! Siemens speak them: setup, reading and writing of variables.
//!
//! Pure. An answer is taken only if its number is that of the request and its lengths are those that were
//! asked for; no bytes make this panic.

use crate::setup::Memory;
use crate::wire::{Cell, Form};

/// Bytes of the packet header of RFC 1006.
pub(super) const PACKET: usize = 4;
/// The longest packet that is taken. What was negotiated is shorter.
pub(super) const LONGEST: usize = 1024;
/// The length of a message that is asked for in the setup.
const WANTED: u16 = 480;
/// A controller that takes less than this is none.
const LEAST: u16 = 64;
/// Items of one request.
pub(super) const ITEMS: usize = 20;
/// Bytes of a message before the items, of a request and of an answer; of an item in each.
const HEADS: (usize, usize) = (12, 14);
const ITEM: (usize, usize) = (12, 4);
const READ: u8 = 4;
const WRITE: u8 = 5;
const SETUP: u8 = 0xf0;

/// Why an answer is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    /// It is no answer to this request.
    Broken(&'static str),
    /// The controller refuses the whole request.
    Refused(String),
}

/// Neighbours that are read or written as one item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Item {
    pub(super) memory: Memory,
    pub(super) byte: u16,
    pub(super) bytes: u16,
}

impl Item {
    fn of(cell: &Cell) -> Item {
        Item { memory: cell.memory, byte: cell.byte, bytes: cell.bytes() }
    }
}

/// The length of a packet by its header; `None` where it is no packet.
pub(super) fn length(head: &[u8; PACKET]) -> Option<usize> {
    let [3, _, high, low] = *head else { return None };
    let length = usize::from(u16::from_be_bytes([high, low]));
    (PACKET + 3..=LONGEST).contains(&length).then_some(length)
}

fn packet(body: &[u8]) -> Vec<u8> {
    let length = u16::try_from(PACKET + body.len()).unwrap_or(u16::MAX).to_be_bytes();
    [&[3, 0, length[0], length[1]], body].concat()
}

/// The request for a connection: resource, rack and slot are the name of the processor.
pub(super) fn connect(resource: u8, rack: u8, slot: u8) -> Vec<u8> {
    // Length, request, references, class 0; the longest data unit is 1024 bytes; who calls, who is called.
    packet(&[17, 0xe0, 0, 0, 0, 1, 0, 0xc0, 1, 10, 0xc1, 2, 1, 0, 0xc2, 2, resource, rack << 5 | slot & 0x1f])
}

/// True if a packet says that the connection is there.
pub(super) fn is_connected(packet: &[u8]) -> bool {
    packet.get(PACKET + 1).is_some_and(|kind| kind & 0xf0 == 0xd0)
}

fn message(number: u16, parameters: &[u8], data: &[u8]) -> Vec<u8> {
    let two = |n: usize| u16::try_from(n).unwrap_or(u16::MAX).to_be_bytes();
    let [number, parameters_length, data_length] =
        [number.to_be_bytes(), two(parameters.len()), two(data.len())];
    let head = [&[2, 0xf0, 0x80, 0x32, 1, 0, 0], &number[..], &parameters_length, &data_length].concat();
    packet(&[&head, parameters, data].concat())
}

/// The request for the lengths of messages.
pub(super) fn setup(number: u16) -> Vec<u8> {
    let [high, low] = WANTED.to_be_bytes();
    message(number, &[SETUP, 0, 0, 1, 0, 1, high, low], &[])
}

/// The length of messages that the controller takes.
pub(super) fn agreed(packet: &[u8], number: u16) -> Result<u16, Wrong> {
    let (parameters, _) = answer(packet, number)?;
    let &[SETUP, _, _, _, _, _, high, low] = parameters else {
        return Err(Wrong::Broken("it does not agree to a length of messages"));
    };
    let length = u16::from_be_bytes([high, low]);
    if length < LEAST { Err(Wrong::Broken("its messages are too short")) } else { Ok(length.min(WANTED)) }
}

/// Bytes that one item of a read may have at most.
pub(super) fn most(agreed: u16) -> u16 {
    agreed.saturating_sub((HEADS.1 + ITEM.1) as u16)
}

/// How many of the items share the first request.
pub(super) fn share(items: &[Item], agreed: u16) -> usize {
    let agreed = usize::from(agreed);
    let (mut asked, mut answered) = HEADS;
    let fits = items.iter().take(ITEMS).take_while(|item| {
        asked += ITEM.0;
        answered += ITEM.1 + usize::from(item.bytes).next_multiple_of(2);
        asked <= agreed && answered <= agreed
    });
    fits.count().max(1)
}

fn specified(item: &Item, bit: Option<u8>) -> [u8; ITEM.0] {
    let (area, block) = match item.memory {
        Memory::Input => (0x81, 0),
        Memory::Output => (0x82, 0),
        Memory::Flag => (0x83, 0),
        Memory::Block(number) => (0x84, number),
    };
    // Bits and bytes; the address counts bits.
    let (kind, count) = if bit.is_some() { (1, 1) } else { (2, item.bytes) };
    let address = u32::from(item.byte) * 8 + u32::from(bit.unwrap_or(0));
    let ([c, d], [b, e], [_, x, y, z]) = (count.to_be_bytes(), block.to_be_bytes(), address.to_be_bytes());
    [0x12, 10, 0x10, kind, c, d, b, e, area, x, y, z]
}

/// The request to read items.
pub(super) fn read(number: u16, items: &[Item]) -> Vec<u8> {
    let specified: Vec<u8> = items.iter().flat_map(|item| specified(item, None)).collect();
    // At most 20 (`share`).
    message(number, &[&[READ, items.len() as u8], &specified[..]].concat(), &[])
}

/// The request to write the value of a cell.
pub(super) fn write(number: u16, cell: &Cell, value: &[u8]) -> Vec<u8> {
    let bit = if let Form::Bit(bit) = cell.form { Some(bit) } else { None };
    let specified = specified(&Item::of(cell), bit);
    // A bit is counted in bits, bytes are as well, but under another name.
    let (kind, length) = if bit.is_some() { (3, 1) } else { (4, cell.bytes() * 8) };
    let [high, low] = length.to_be_bytes();
    message(number, &[&[WRITE, 1], &specified[..]].concat(), &[&[0, kind, high, low], value].concat())
}

/// The bytes of each item of an answer, or why the controller does not give them.
pub(super) fn values(
    packet: &[u8],
    number: u16,
    items: &[Item],
) -> Result<Vec<Result<Vec<u8>, String>>, Wrong> {
    let (parameters, mut data) = answer(packet, number)?;
    if parameters != [READ, items.len() as u8] {
        return Err(Wrong::Broken("it answers for other items"));
    }
    let short = Wrong::Broken("its answer is too short or too long");
    let mut values = Vec::with_capacity(items.len());
    for (k, item) in items.iter().enumerate() {
        let Some((&[code, kind, high, low], rest)) = data.split_first_chunk::<4>() else { return Err(short) };
        if code != 0xff {
            values.push(Err(reason(code)));
            data = rest;
            continue;
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        // Bits, bytes and whole numbers are counted in bits, others in bytes.
        let length = if matches!(kind, 3..=5) { length.div_ceil(8) } else { length };
        let wanted = usize::from(item.bytes);
        let Some((value, rest)) = rest.split_at_checked(length).filter(|_| length == wanted) else {
            return Err(short);
        };
        values.push(Ok(value.to_vec()));
        // Items begin at even places.
        let fill = usize::from(length % 2 == 1 && k + 1 < items.len());
        data = rest.get(fill..).ok_or(short.clone())?;
    }
    if data.is_empty() { Ok(values) } else { Err(short) }
}

/// Done, or why the controller does not write.
pub(super) fn written(packet: &[u8], number: u16) -> Result<Result<(), String>, Wrong> {
    match answer(packet, number)? {
        ([WRITE, 1], [0xff]) => Ok(Ok(())),
        ([WRITE, 1], [code]) => Ok(Err(reason(*code))),
        _ => Err(Wrong::Broken("it answers for something else")),
    }
}

/// The parameters and the data of an answer.
fn answer(packet: &[u8], number: u16) -> Result<(&[u8], &[u8]), Wrong> {
    let (_, body) = packet.split_first_chunk::<PACKET>().ok_or(Wrong::Broken("its answer is too short"))?;
    let Some((&[2, 0xf0, 0x80, 0x32, kind, _, _, a, b, c, d, e, f, class, code], rest)) =
        body.split_first_chunk::<15>()
    else {
        return Err(Wrong::Broken("it does not speak S7"));
    };
    if u16::from_be_bytes([a, b]) != number {
        return Err(Wrong::Broken("its answer belongs to another request"));
    }
    if !matches!(kind, 2 | 3) {
        return Err(Wrong::Broken("it sends no answer"));
    }
    if (class, code) != (0, 0) {
        return Err(Wrong::Refused(general(class, code)));
    }
    let [parameters, data] = [[c, d], [e, f]].map(|n| usize::from(u16::from_be_bytes(n)));
    if rest.len() != parameters + data {
        return Err(Wrong::Broken("its answer has a wrong length"));
    }
    rest.split_at_checked(parameters).ok_or(Wrong::Broken("its answer has a wrong length"))
}

/// Why an item was refused.
fn reason(code: u8) -> String {
    match code {
        0x01 => "its hardware has a fault".to_owned(),
        0x03 => "it allows no access: permit PUT and GET in its protection".to_owned(),
        0x05 => "it has no such address; a block must not be optimised".to_owned(),
        0x06 | 0x07 => "it has another type there".to_owned(),
        0x0a => "it has no such data block".to_owned(),
        other => format!("it answers {other:02X}"),
    }
}

/// Why a request was refused as a whole.
fn general(class: u8, code: u8) -> String {
    match (class, code) {
        (0x81, 0x04) => "it allows no access: permit PUT and GET in its protection".to_owned(),
        (0x84, 0x04) => "it has no such address or data block".to_owned(),
        (class, code) => format!("it refuses the request: {class:02X}{code:02X}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Encoding;

    fn item(memory: Memory, byte: u16, bytes: u16) -> Item {
        Item { memory, byte, bytes }
    }

    /// An answer with a number, the parameters and the data.
    fn answered(number: u16, parameters: &[u8], data: &[u8]) -> Vec<u8> {
        let head = [2, 0xf0, 0x80, 0x32, 3, 0, 0, 0, number as u8, 0, parameters.len() as u8, 0];
        packet(&[&head[..], &[data.len() as u8, 0, 0], parameters, data].concat())
    }

    #[test]
    fn requests_are_those_of_the_protocol() {
        // As Wireshark shows them for DB1.DBB2, 4 bytes; and for M3.5 := 1.
        let asked = read(5, &[item(Memory::Block(1), 2, 4)]);
        let expected = [
            3, 0, 0, 31, 2, 0xf0, 0x80, 0x32, 1, 0, 0, 0, 5, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10, 2, 0, 4, 0,
            1, 0x84, 0, 0, 16,
        ];
        assert_eq!(asked, expected);
        let cell = Cell { memory: Memory::Flag, byte: 3, form: Form::Bit(5) };
        let expected = [
            3, 0, 0, 36, 2, 0xf0, 0x80, 0x32, 1, 0, 0, 0, 6, 0, 14, 0, 5, 5, 1, 0x12, 10, 0x10, 1, 0, 1, 0,
            0, 0x83, 0, 0, 29, 0, 3, 0, 1, 1,
        ];
        assert_eq!(write(6, &cell, &[1]), expected);
        let cell = Cell { memory: Memory::Output, byte: 4, form: Form::Number(Encoding::Signed(1)) };
        assert_eq!(&write(7, &cell, &[0x12, 0x34])[31..], [0, 4, 0, 16, 0x12, 0x34]);
        assert_eq!(connect(1, 0, 2).last(), Some(&2));
        assert_eq!(connect(3, 1, 2).get(20..), Some(&[3, 0x22][..]));
    }

    #[test]
    fn answers_are_taken_item_by_item() {
        let items = [item(Memory::Flag, 0, 1), item(Memory::Block(9), 0, 2), item(Memory::Flag, 2, 2)];
        let data = [0xff, 4, 0, 8, 7, 0, 10, 0, 0, 0, 0xff, 4, 0, 16, 1, 2];
        let values = values(&answered(3, &[4, 3], &data), 3, &items).expect("an answer");
        assert_eq!(values[0], Ok(vec![7]));
        assert_eq!(values[1], Err("it has no such data block".to_owned()));
        assert_eq!(values[2], Ok(vec![1, 2]));
        assert_eq!(written(&answered(3, &[5, 1], &[0xff]), 3), Ok(Ok(())));
        assert!(matches!(written(&answered(3, &[5, 1], &[5]), 3), Ok(Err(_))));
    }

    #[test]
    fn wrong_answers_are_none() {
        let items = [item(Memory::Flag, 0, 2)];
        let good = answered(3, &[4, 1], &[0xff, 4, 0, 16, 1, 2]);
        assert!(values(&good, 3, &items).is_ok());
        assert!(values(&good, 4, &items).is_err(), "the answer to another request");
        for data in [
            &[0xff, 4, 0, 8, 1][..],
            &[0xff, 4, 0, 16, 1],
            &[0xff, 4, 0, 24, 1, 2, 3],
            &[0xff, 4, 0, 16, 1, 2, 3],
            &[0xff, 4, 0xff, 0xff, 1, 2],
            &[0xff, 4],
            &[],
        ] {
            assert!(values(&answered(3, &[4, 1], data), 3, &items).is_err(), "{data:?}");
        }
        assert!(values(&answered(3, &[4, 2], &[0xff, 4, 0, 16, 1, 2]), 3, &items).is_err());
        assert!(values(&answered(3, &[5, 1], &[0xff]), 3, &items).is_err());
        let mut refused = good.clone();
        refused[PACKET + 13] = 0x81;
        refused[PACKET + 14] = 0x04;
        assert!(matches!(values(&refused, 3, &items), Err(Wrong::Refused(_))));
        assert!(agreed(&answered(1, &[0xf0, 0, 0, 1, 0, 1, 0, 20], &[]), 1).is_err(), "20 bytes");
        assert_eq!(agreed(&answered(1, &[0xf0, 0, 0, 1, 0, 1, 0, 240], &[]), 1), Ok(240));
        assert_eq!(length(&[3, 0, 0, 6]), None);
        assert_eq!(length(&[3, 0, 0xff, 0xff]), None);
        assert_eq!(length(&[4, 0, 0, 30]), None);
    }

    #[test]
    fn a_million_wrong_frames_neither_panic_nor_give_a_wrong_length() {
        let items = [item(Memory::Flag, 0, 3), item(Memory::Block(2), 8, 4)];
        let data = [0xff, 4, 0, 24, 1, 2, 3, 0, 0xff, 4, 0, 32, 4, 5, 6, 7];
        let good = answered(3, &[4, 2], &data);
        let mut random = 1u64;
        let mut next = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as usize
        };
        let count = if std::env::var_os("G7_FAULTS").is_some() { 1_000_000 } else { 50_000 };
        let mut taken = 0;
        for _ in 0..count {
            let mut frame = good.clone();
            for _ in 0..next() % 4 {
                let at = next() % frame.len();
                frame[at] = next() as u8;
            }
            frame.truncate(frame.len() - next() % 3 * (next() % 8));
            if let Ok(values) = values(&frame, 3, &items) {
                let lengths: Vec<usize> = values.iter().map(|v| v.as_ref().map_or(0, Vec::len)).collect();
                assert!(lengths.iter().zip([3, 4]).all(|(l, most)| *l == 0 || *l == most), "{frame:?}");
                taken += 1;
            }
            let noise: Vec<u8> = (0..next() % 60).map(|_| next() as u8).collect();
            assert!(values_of_noise(&noise).is_err());
        }
        assert!(taken > count / 10, "{taken} of {count}");
    }

    fn values_of_noise(noise: &[u8]) -> Result<Vec<Result<Vec<u8>, String>>, Wrong> {
        values(noise, 3, &[item(Memory::Flag, 0, 3)])
    }

    #[test]
    fn a_request_has_as_many_items_as_both_messages_hold() {
        let many: Vec<Item> = (0..30).map(|k| item(Memory::Flag, k * 40, 2)).collect();
        // 12 and 12 an item; 14 and 6 an item.
        assert_eq!(share(&many, 240), 19);
        assert_eq!(share(&many, 480), ITEMS);
        let long: Vec<Item> = (0..3).map(|k| item(Memory::Block(1), k * 300, 200)).collect();
        assert_eq!(share(&long, 240), 1);
        assert_eq!(share(&long, 480), 2);
        assert_eq!(most(240), 222);
    }
}
