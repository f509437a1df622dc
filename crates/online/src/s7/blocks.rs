//! Which bytes are read as one item, and how bytes hold values.
//!
//! Bytes between two points of one memory are there as well, so points with a small gap between them
//! share an item: a gap costs less than the head of another one.

use crate::device::Absent;
use crate::setup::Encoding;
use crate::value::Raw;
use crate::wire::{Cell, Form};

use super::frames::Item;

/// The widest gap within an item, in bytes: what an item of its own costs in both messages.
const GAP: u32 = 16;

/// Cells that are read as one item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) item: Item,
    /// The numbers of the cells.
    pub(super) cells: Vec<usize>,
}

impl Block {
    /// A cell alone.
    pub(super) fn of(number: usize, cell: &Cell) -> Block {
        let item = Item { memory: cell.memory, byte: cell.byte, bytes: cell.bytes() };
        Block { item, cells: vec![number] }
    }

    /// Gives the inputs of the block their values.
    pub(super) fn give(
        &self,
        value: &Result<Vec<u8>, String>,
        cells: &[Cell],
        inputs: &mut [Result<Raw, Absent>],
    ) {
        for k in &self.cells {
            let (Some(cell), Some(to)) = (cells.get(*k), inputs.get_mut(*k)) else { continue };
            *to = match value {
                Ok(bytes) => decode(cell, self.item.byte, bytes).ok_or(Absent::Unread),
                Err(why) => Err(Absent::Refused(why.clone())),
            };
        }
    }
}

/// The blocks that read these cells; none is longer than `most` bytes.
pub(super) fn reads(cells: &[Cell], most: u16) -> Vec<Block> {
    let mut order: Vec<(usize, &Cell)> = cells.iter().enumerate().collect();
    order.sort_by_key(|(_, cell)| (cell.memory, cell.byte));
    let mut blocks: Vec<Block> = Vec::new();
    for (k, cell) in order {
        let joined = blocks.last_mut().filter(|block| {
            let Item { memory, byte, bytes } = block.item;
            let (from, end) = (u32::from(byte), u32::from(byte) + u32::from(bytes));
            memory == cell.memory && u32::from(cell.byte) <= end + GAP && cell.end() - from <= u32::from(most)
        });
        match joined {
            Some(block) => {
                let bytes = cell.end() - u32::from(block.item.byte);
                block.item.bytes = block.item.bytes.max(u16::try_from(bytes).unwrap_or(u16::MAX));
                block.cells.push(k);
            }
            None => blocks.push(Block::of(k, cell)),
        }
    }
    blocks
}

/// The value of a cell in bytes that begin at `from`.
fn decode(cell: &Cell, from: u16, bytes: &[u8]) -> Option<Raw> {
    let at = usize::from(cell.byte.checked_sub(from)?);
    let own = bytes.get(at..at + usize::from(cell.bytes()))?;
    let first = *own.first()?;
    let number = own.iter().fold(0u64, |all, byte| all << 8 | u64::from(*byte));
    Some(match cell.form {
        Form::Bit(bit) => Raw::Bit(first >> bit & 1 == 1),
        Form::Byte { signed: true } => Raw::Whole(i128::from(first as i8)),
        Form::Byte { signed: false } => Raw::Whole(i128::from(first)),
        Form::Number(Encoding::Unsigned(_)) => Raw::Whole(i128::from(number)),
        Form::Number(Encoding::Signed(n)) => {
            let unused = 64 - 16 * u32::from(n);
            Raw::Whole(i128::from((number << unused) as i64 >> unused))
        }
        Form::Number(Encoding::F32) => Raw::Real(f64::from(f32::from_bits(number as u32))),
        Form::Number(Encoding::F64) => Raw::Real(f64::from_bits(number)),
    })
}

/// The bytes of a value.
pub(super) fn encode(cell: &Cell, raw: Raw) -> Vec<u8> {
    let number = match (cell.form, raw) {
        (Form::Number(Encoding::F32), Raw::Real(x)) => u64::from((x as f32).to_bits()),
        (Form::Number(Encoding::F64), Raw::Real(x)) => x.to_bits(),
        (_, Raw::Whole(n)) => n as u64,
        (_, Raw::Real(x)) => x as i64 as u64,
        (_, Raw::Bit(on)) => u64::from(on),
    };
    let all = number.to_be_bytes();
    let unused = all.len().saturating_sub(usize::from(cell.bytes()));
    all.get(unused..).unwrap_or(&[]).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Memory;

    fn cell(memory: Memory, byte: u16, form: Form) -> Cell {
        Cell { memory, byte, form }
    }

    const WORD: Form = Form::Number(Encoding::Signed(1));

    #[test]
    fn points_near_each_other_are_one_item() {
        let block = Memory::Block(1);
        let cells = [
            cell(block, 10, WORD),
            cell(block, 0, Form::Bit(3)),
            cell(block, 0, Form::Bit(4)),
            cell(block, 28, WORD),
            cell(block, 47, Form::Byte { signed: false }),
            cell(Memory::Block(2), 0, WORD),
            cell(Memory::Flag, 0, WORD),
        ];
        let found: Vec<_> =
            reads(&cells, 222).into_iter().map(|b| (b.item.byte, b.item.bytes, b.cells)).collect();
        // A gap of 16 bytes is closed, one of 17 is not; blocks of data are apart.
        let expected = [(0, 2, vec![6]), (0, 30, vec![1, 2, 0, 3]), (47, 1, vec![4]), (0, 2, vec![5])];
        assert_eq!(found, expected);
        let long: Vec<Cell> = (0..200).map(|k| cell(block, k * 2, WORD)).collect();
        assert!(reads(&long, 222).iter().all(|b| b.item.bytes <= 222));
        assert_eq!(reads(&long, 222).len(), 2);
    }

    #[test]
    fn values_are_the_same_after_there_and_back() {
        let at = |form| cell(Memory::Flag, 10, form);
        let cases = [
            (at(Form::Byte { signed: true }), Raw::Whole(-2), vec![0xfe]),
            (at(Form::Byte { signed: false }), Raw::Whole(254), vec![0xfe]),
            (at(WORD), Raw::Whole(-2), vec![0xff, 0xfe]),
            (at(Form::Number(Encoding::Unsigned(2))), Raw::Whole(0x0102_0304), vec![1, 2, 3, 4]),
            // IEEE 754: 1.5 is 3FC00000 and 3FF8000000000000.
            (at(Form::Number(Encoding::F32)), Raw::Real(1.5), vec![0x3f, 0xc0, 0, 0]),
            (at(Form::Number(Encoding::F64)), Raw::Real(1.5), vec![0x3f, 0xf8, 0, 0, 0, 0, 0, 0]),
        ];
        for (cell, raw, bytes) in cases {
            assert_eq!(encode(&cell, raw), bytes, "{cell:?}");
            assert_eq!(decode(&cell, 10, &bytes), Some(raw), "{cell:?}");
        }
        assert_eq!(decode(&at(Form::Bit(7)), 9, &[0, 0x80]), Some(Raw::Bit(true)));
        assert_eq!(encode(&at(Form::Bit(7)), Raw::Bit(true)), [1], "a bit goes by itself");
    }
}
