//! Which registers are read and written in one request.
//!
//! Only neighbours share a request: a device may refuse a request because of one address between them
//! that it does not have.

use crate::setup::{Area, Encoding, Place, Register};
use crate::value::Raw;

/// Most bits of a request to read (Modbus application protocol 1.1b3, 6.1), and to write (6.11).
const BITS: (u16, u16) = (2000, 1968);
/// Most registers of a request to read (6.3), and to write (6.12).
const REGISTERS: (u16, u16) = (125, 123);

impl Place {
    fn end(&self) -> u32 {
        u32::from(self.register.address) + u32::from(self.encoding.map_or(1, Encoding::registers))
    }
}

/// Neighbours that share a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    pub(crate) area: Area,
    pub(crate) from: u16,
    pub(crate) count: u16,
    /// The numbers of the places.
    pub(crate) places: Vec<usize>,
}

/// The blocks that read these places.
pub(crate) fn reads(places: &[Place]) -> Vec<Block> {
    let all: Vec<usize> = (0..places.len()).collect();
    blocks(places, all, (BITS.0, REGISTERS.0))
}

/// The blocks that write those of these places that are chosen.
pub(crate) fn writes(places: &[Place], chosen: &[bool]) -> Vec<Block> {
    // A register with a chosen bit is written whole, with the other bits of it.
    let wanted = |k: &usize| {
        let Some(place) = places.get(*k) else { return false };
        let same = |(other, chosen): (&Place, &bool)| {
            *chosen
                && (other.register.area, other.register.address)
                    == (place.register.area, place.register.address)
        };
        places.iter().zip(chosen).any(same)
    };
    blocks(places, (0..places.len()).filter(wanted).collect(), (BITS.1, REGISTERS.1))
}

fn blocks(places: &[Place], mut chosen: Vec<usize>, (bits, registers): (u16, u16)) -> Vec<Block> {
    chosen.sort_by_key(|k| places.get(*k).map(|p| (p.register.area, p.register.address, p.register.bit)));
    let mut blocks: Vec<Block> = Vec::new();
    for k in chosen {
        let Some(place) = places.get(k) else { continue };
        let Register { area, address, .. } = place.register;
        let most = if area.is_bits() { bits } else { registers };
        let joined = blocks.last_mut().filter(|b| {
            let next = u32::from(b.from) + u32::from(b.count);
            b.area == area && u32::from(address) <= next && place.end() - u32::from(b.from) <= u32::from(most)
        });
        match joined {
            Some(block) => {
                let count = place.end() - u32::from(block.from);
                block.count = block.count.max(u16::try_from(count).unwrap_or(u16::MAX));
                block.places.push(k);
            }
            None => {
                let count = u16::try_from(place.end() - u32::from(address)).unwrap_or(1);
                blocks.push(Block { area, from: address, count, places: vec![k] });
            }
        }
    }
    blocks
}

/// The value of a place in the registers of its block; `None` where they do not reach so far.
pub(crate) fn decode(place: &Place, from: u16, registers: &[u16], low_first: bool) -> Option<Raw> {
    let at = usize::from(place.register.address.checked_sub(from)?);
    if let Some(bit) = place.register.bit {
        return registers.get(at).map(|word| Raw::Bit(word >> bit & 1 == 1));
    }
    let encoding = place.encoding?;
    let words = registers.get(at..at + usize::from(encoding.registers()))?;
    let join = |all: u64, word: &u16| all << 16 | u64::from(*word);
    let number = if low_first { words.iter().rev().fold(0, join) } else { words.iter().fold(0, join) };
    Some(match encoding {
        Encoding::Unsigned(_) => Raw::Whole(i128::from(number)),
        Encoding::Signed(n) => {
            let unused = 64 - 16 * u32::from(n);
            Raw::Whole(i128::from((number << unused) as i64 >> unused))
        }
        Encoding::F32 => Raw::Real(f64::from(f32::from_bits(number as u32))),
        Encoding::F64 => Raw::Real(f64::from_bits(number)),
    })
}

/// Puts the value of a place into the registers of its block.
pub(crate) fn encode(place: &Place, from: u16, raw: Raw, registers: &mut [u16], low_first: bool) {
    let Some(at) = place.register.address.checked_sub(from).map(usize::from) else { return };
    if let (Some(bit), Raw::Bit(on)) = (place.register.bit, raw) {
        if let Some(word) = registers.get_mut(at) {
            *word = *word & !(1 << bit) | u16::from(on) << bit;
        }
        return;
    }
    let Some(encoding) = place.encoding else { return };
    let number = match (encoding, raw) {
        (Encoding::F32, Raw::Real(x)) => u64::from((x as f32).to_bits()),
        (Encoding::F64, Raw::Real(x)) => x.to_bits(),
        (_, Raw::Whole(n)) => n as u64,
        (_, Raw::Real(x)) => x as i64 as u64,
        (_, Raw::Bit(on)) => u64::from(on),
    };
    let count = encoding.registers();
    for k in 0..count {
        let shift = 16 * if low_first { k } else { count - 1 - k };
        if let Some(word) = registers.get_mut(at + usize::from(k)) {
            *word = (number >> shift) as u16;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(area: Area, address: u16, bit: Option<u8>, encoding: Option<Encoding>) -> Place {
        Place { register: Register { area, address, bit }, encoding }
    }

    fn number(address: u16, encoding: Encoding) -> Place {
        place(Area::Holding, address, None, Some(encoding))
    }

    #[test]
    fn only_neighbours_share_a_request() {
        let coils = [7, 0, 1, 3].map(|a| place(Area::Coil, a, None, None));
        let found: Vec<_> = reads(&coils).into_iter().map(|b| (b.from, b.count, b.places)).collect();
        assert_eq!(found, [(0, 2, vec![1, 2]), (3, 1, vec![3]), (7, 1, vec![0])]);
        let numbers =
            [number(4, Encoding::F64), number(8, Encoding::Signed(1)), number(3, Encoding::Signed(1))];
        let found: Vec<_> = reads(&numbers).into_iter().map(|b| (b.from, b.count, b.places)).collect();
        assert_eq!(found, [(3, 6, vec![2, 0, 1])]);
        // Several inputs may read one register.
        let same = [number(4, Encoding::Signed(2)), number(4, Encoding::Signed(1))];
        assert_eq!(reads(&same).len(), 1);
        assert_eq!(reads(&same)[0].count, 2);
        let other = [place(Area::Input, 0, None, Some(Encoding::Signed(1))), number(1, Encoding::Signed(1))];
        assert_eq!(reads(&other).len(), 2, "tables are not neighbours");
    }

    #[test]
    fn no_request_is_longer_than_modbus_allows() {
        let many: Vec<Place> = (0..100).map(|k| number(k * 2, Encoding::Signed(2))).collect();
        let counts = |blocks: Vec<Block>| blocks.iter().map(|b| b.count).collect::<Vec<_>>();
        // No number is cut in two.
        assert_eq!(counts(reads(&many)), [124, 76]);
        assert_eq!(counts(writes(&many, &[true; 100])), [122, 78]);
        let bits: Vec<Place> = (0..2001).map(|k| place(Area::Coil, k, None, None)).collect();
        assert_eq!(counts(reads(&bits)), [2000, 1]);
        assert_eq!(counts(writes(&bits, &[true; 2001])), [1968, 33]);
    }

    #[test]
    fn a_register_with_a_chosen_bit_is_written_with_its_other_bits() {
        let bits = [0, 3, 9].map(|bit| place(Area::Holding, 5, Some(bit), None));
        let far = place(Area::Holding, 9, Some(0), None);
        let all = [bits[0], bits[1], bits[2], far];
        let blocks = writes(&all, &[false, true, false, false]);
        assert_eq!(blocks.len(), 1);
        assert_eq!((blocks[0].from, blocks[0].count, &blocks[0].places[..]), (5, 1, &[0, 1, 2][..]));
        let mut words = [0];
        for (k, on) in [(0, true), (1, true), (2, false)] {
            encode(&bits[k], 5, Raw::Bit(on), &mut words, false);
        }
        assert_eq!(words, [0b1001]);
    }

    #[test]
    fn numbers_are_the_same_after_there_and_back() {
        let cases = [
            (Encoding::Unsigned(1), Raw::Whole(65_535), vec![65_535]),
            (Encoding::Signed(1), Raw::Whole(-2), vec![65_534]),
            (Encoding::Signed(2), Raw::Whole(-2), vec![65_535, 65_534]),
            (Encoding::Unsigned(2), Raw::Whole(0x0001_0002), vec![1, 2]),
            (Encoding::Signed(4), Raw::Whole(i128::from(i64::MIN)), vec![0x8000, 0, 0, 0]),
            (Encoding::Unsigned(4), Raw::Whole(i128::from(u64::MAX)), vec![65_535; 4]),
            // IEEE 754: 1.5 is 3FC00000 and 3FF8000000000000.
            (Encoding::F32, Raw::Real(1.5), vec![0x3fc0, 0]),
            (Encoding::F64, Raw::Real(1.5), vec![0x3ff8, 0, 0, 0]),
        ];
        for (encoding, raw, words) in cases {
            let place = number(10, encoding);
            for low_first in [false, true] {
                let mut written = vec![0; words.len()];
                encode(&place, 10, raw, &mut written, low_first);
                let mut expected = words.clone();
                if low_first {
                    expected.reverse();
                }
                assert_eq!(written, expected, "{encoding:?}");
                assert_eq!(decode(&place, 10, &written, low_first), Some(raw), "{encoding:?}");
            }
        }
        assert_eq!(decode(&number(10, Encoding::F64), 10, &[0, 0], false), None, "too short");
    }
}
