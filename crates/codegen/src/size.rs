//! How much memory printed C takes, worked out from its structures and tables; and the boards
//! that it may be for.

use std::collections::HashMap;

use crate::tree::{Known, Module, Ty};

/// Bytes of the structure `NAME_state` and of the tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// The state on an 8-bit AVR, which lays out bytes without gaps.
    pub avr: usize,
    /// The state on a controller of 32 bits, where numbers stand at multiples of their size.
    pub wide: usize,
    /// The tables, which need no RAM.
    pub tables: usize,
}

/// A board with its controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name in the command line.
    pub name: &'static str,
    /// Bytes of RAM.
    pub ram: usize,
    /// Bytes of RAM that the stack and the board's own library need.
    pub reserve: usize,
    /// True for a controller of 8 bits.
    pub is_avr: bool,
}

/// The boards that are known.
pub const BOARDS: [Board; 3] = [
    Board { name: "uno", ram: 2_048, reserve: 512, is_avr: true },
    Board { name: "mega", ram: 8_192, reserve: 1_024, is_avr: true },
    Board { name: "esp32", ram: 327_680, reserve: 65_536, is_avr: false },
];

impl Board {
    /// Bytes that the state of a chart takes there.
    pub fn state(&self, sizes: Sizes) -> usize {
        if self.is_avr { sizes.avr } else { sizes.wide }
    }

    /// True if the state fits beside the RAM that the stack and the library need.
    pub fn holds(&self, sizes: Sizes) -> bool {
        self.state(sizes) + self.reserve <= self.ram
    }
}

/// The bytes that the state and the tables of a module take in C.
pub(crate) fn sizes(m: &Module) -> Sizes {
    let tables = m.consts.iter().map(|c| {
        let Ty::Array(of, n) = &c.ty else { return 0 };
        let (size, _) = Layout { avr: true, done: HashMap::new() }.of(of);
        let rows = match &c.value {
            Known::Many(all) => all.len(),
            Known::Rows(rows) => rows.iter().map(|r| r.0.len()).sum(),
            Known::One(_) => *n,
        };
        size * rows.max(1)
    });
    Sizes { avr: state(m, true), wide: state(m, false), tables: tables.sum() }
}

fn state(m: &Module, avr: bool) -> usize {
    let mut layout = Layout { avr, done: HashMap::new() };
    for s in &m.structs {
        let (mut end, mut most) = (0usize, 1);
        for f in &s.fields {
            let (size, align) = layout.of(&f.ty);
            end = end.next_multiple_of(align) + size;
            most = most.max(align);
        }
        // C has no structure without a field: it gets one of a byte.
        layout.done.insert(&s.name, (end.max(1).next_multiple_of(most), most));
    }
    layout.done.get("State").map_or(0, |s| s.0)
}

struct Layout<'a> {
    avr: bool,
    done: HashMap<&'a str, (usize, usize)>,
}

impl Layout<'_> {
    /// Size and alignment of a type, in bytes.
    fn of(&self, ty: &Ty) -> (usize, usize) {
        let number = |bytes: usize| (bytes, if self.avr { 1 } else { bytes });
        match ty {
            Ty::Bool => number(1),
            Ty::Int { bits, .. } => number(usize::from(*bits) / 8),
            // A double of an AVR is a float.
            Ty::Real { bits } => number(if self.avr { 4 } else { usize::from(*bits) / 8 }),
            Ty::Size | Ty::Ref(..) | Ty::Slice(..) => number(4),
            Ty::Named(name) => self.done.get(name.as_str()).copied().unwrap_or((0, 1)),
            Ty::Array(of, n) => {
                let (size, align) = self.of(of);
                // An array without an element has one in C.
                (size * (*n).max(1), align)
            }
        }
    }
}
