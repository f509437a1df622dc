//! The chart's variables as declarations, and where each word of the engine's
//! variable area is among them.

use std::collections::BTreeMap;

use g7_compile::ir::VarClass;
use g7_engine::{Num, Op};
use g7_model::{FbKind, Type};

use super::form::{Class, Declared, Ex};
use super::plan::Plan;

/// The type of a value; the engine has TIME as a 64-bit integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ty {
    pub(crate) num: Num,
    pub(crate) time: bool,
}

impl Ty {
    pub(crate) const BOOL: Ty = Ty { num: Num::Bool, time: false };
    pub(crate) const TIME: Ty = Ty { num: Num::I64, time: true };
    pub(crate) const LINT: Ty = Ty { num: Num::I64, time: false };

    pub(crate) fn of(num: Num) -> Ty {
        Ty { num, time: false }
    }

    pub(crate) fn name(self) -> &'static str {
        match self.num {
            Num::Bool => "BOOL",
            Num::I8 => "SINT",
            Num::I16 => "INT",
            Num::I32 => "DINT",
            Num::I64 if self.time => "TIME",
            Num::I64 => "LINT",
            Num::U8 => "USINT",
            Num::U16 => "UINT",
            Num::U32 => "UDINT",
            Num::U64 => "ULINT",
            Num::F32 => "REAL",
            Num::F64 => "LREAL",
        }
    }

    pub(crate) fn literal(self, word: u64) -> Ex {
        match self.num {
            Num::Bool => Ex::Bool(word != 0),
            Num::F32 => Ex::Real(f64::from(f32::from_bits(word as u32))),
            Num::F64 => Ex::Real(f64::from_bits(word)),
            Num::U64 => Ex::Int(word.into()),
            Num::I64 if self.time => Ex::Time(word as i64),
            _ => Ex::Int((word as i64).into()),
        }
    }
}

/// What is at a place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    One(Ty),
    Many(Ty, u32),
    Fb(FbKind),
    Text,
}

/// A variable by its first word.
#[derive(Clone, Debug)]
pub(crate) struct Slot {
    pub(crate) start: u32,
    pub(crate) words: u32,
    pub(crate) name: String,
    pub(crate) shape: Shape,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vars {
    pub(crate) slots: BTreeMap<u32, Slot>,
}

impl Vars {
    pub(crate) fn slot(&self, addr: u32) -> Option<&Slot> {
        let (_, slot) = self.slots.range(..=addr).next_back()?;
        (addr < slot.start + slot.words).then_some(slot)
    }
}

pub(crate) fn ty_of(ty: Type) -> Option<Ty> {
    crate::vars::num(ty).map(|num| Ty { num, time: ty == Type::Time })
}

/// The members of a standard block as the standard calls them; memories have none.
pub(crate) fn members(kind: FbKind) -> &'static [(&'static str, Ty)] {
    const B: Ty = Ty::BOOL;
    const I: Ty = Ty { num: Num::I16, time: false };
    const T: Ty = Ty::TIME;
    match kind {
        FbKind::Ctu => &[("CU", B), ("R", B), ("PV", I), ("Q", B), ("CV", I)],
        FbKind::Ctd => &[("CD", B), ("LD", B), ("PV", I), ("Q", B), ("CV", I)],
        FbKind::Ctud => {
            &[("CU", B), ("CD", B), ("R", B), ("LD", B), ("PV", I), ("QU", B), ("QD", B), ("CV", I)]
        }
        FbKind::Ton | FbKind::Tof | FbKind::Tp => &[("IN", B), ("PT", T), ("Q", B), ("ET", T)],
        FbKind::RTrig | FbKind::FTrig => &[("CLK", B), ("Q", B)],
        FbKind::Sr => &[("S1", B), ("R", B), ("Q1", B)],
        FbKind::Rs => &[("S", B), ("R1", B), ("Q1", B)],
    }
}

fn block_type(kind: FbKind) -> &'static str {
    match kind {
        FbKind::Ctu => "CTU",
        FbKind::Ctd => "CTD",
        FbKind::Ctud => "CTUD",
        FbKind::Ton => "TON",
        FbKind::Tof => "TOF",
        FbKind::Tp => "TP",
        FbKind::RTrig => "R_TRIG",
        FbKind::FTrig => "F_TRIG",
        FbKind::Sr => "SR",
        FbKind::Rs => "RS",
    }
}

impl Plan<'_> {
    /// Declares the variables of the chart.
    pub(crate) fn variables(&mut self) {
        for v in &self.c.symbols.variables {
            let (start, words) = (v.addr.0, v.words());
            if words == 0 || self.vars.slot(start).is_some() {
                continue; // a member of an instance
            }
            let name = self.names.variable(&v.name);
            let shape = match v.ty {
                Type::String(_) => Shape::Text,
                Type::Fb(kind) => Shape::Fb(kind),
                ty => match (ty_of(ty), v.elements) {
                    (Some(ty), 1) => Shape::One(ty),
                    (Some(ty), n) => Shape::Many(ty, n),
                    (None, _) => continue,
                },
            };
            let mut note = if *v.name == *name { String::new() } else { v.name.to_string() };
            if let Some(address) = v.address.as_deref() {
                note = format!("{note} at {address}").trim().to_owned();
            }
            if let Some(comment) = v.comment.as_deref() {
                let sign = if note.is_empty() { "" } else { ": " };
                note = format!("{note}{sign}{comment}");
            }
            let class = match v.class {
                VarClass::Input => Class::Input,
                VarClass::Output => Class::Output,
                _ if v.retain => Class::Retain,
                _ => Class::Internal,
            };
            let init = |ty: Ty, n: u32| -> Vec<Ex> {
                let words = self.t.init.get(start as usize..(start + n) as usize).unwrap_or(&[]);
                if words.iter().all(|w| *w == 0) {
                    return Vec::new();
                }
                words.iter().map(|w| ty.literal(*w)).collect()
            };
            let slot = Slot { start, words, name: name.clone(), shape: shape.clone() };
            self.vars.slots.insert(start, slot);
            // Locals are declared where something in the code uses them.
            let (ty, elements, init) = match shape {
                Shape::One(ty) => (ty.name(), 1, init(ty, 1)),
                Shape::Many(ty, n) => (ty.name(), n, init(ty, n)),
                Shape::Fb(kind) => (block_type(kind), 1, Vec::new()),
                Shape::Text => continue,
            };
            if v.class == VarClass::Const && elements == 1 {
                continue; // its value stands where it is used
            }
            let ty = ty.to_owned();
            self.e.variables.push(Declared { class, name, ty, elements, init, note });
        }
    }

    /// Whether something in the code writes a word, control blocks apart.
    pub(crate) fn is_written(&self, addr: u32) -> bool {
        self.t.code.iter().any(|op| match *op {
            Op::Store(a) => a.0 == addr,
            Op::StoreAt { base, len } => (base.0..base.0 + len).contains(&addr),
            Op::Fb(block, base) => (base.0..base.0 + block.words()).contains(&addr),
            _ => false,
        })
    }

    /// A memory of the equations.
    pub(crate) fn declare(&mut self, name: &str, ty: &str, note: &str) {
        if self.e.variables.iter().any(|v| v.name == name) {
            return;
        }
        let (name, ty, note) = (name.to_owned(), ty.to_owned(), note.to_owned());
        self.e.variables.push(Declared {
            class: Class::Internal,
            name,
            ty,
            elements: 1,
            init: Vec::new(),
            note,
        });
    }

    /// A new memory; its name begins with what it is for.
    pub(crate) fn memory(&mut self, before: &str, of: &str, ty: Ty, note: &str) -> String {
        let name = self.names.with(before, of);
        self.declare(&name, ty.name(), note);
        name
    }
}
