//! The variable area: which word holds what.
//!
//! Inputs first, then outputs, then everything else that lasts: internal
//! variables, instances, constants, texts, and what only the lowering knows of.
//! Behind them lie the locals and words for what is worked out in between. A word is
//! a number; a STRING(n) is its length in bytes and `ceil(n / 8)` words of text.

use std::collections::HashMap;

use g7_engine::{Addr, Block, NONE, Num, Rows, TEXT};
use g7_model::{FbKind, Type};

use crate::ir::{Unit, Value, Var, VarClass, VarId};

/// Words that all variables together may have.
const MOST: usize = 1 << 25;

/// Where the variables lie.
pub(super) struct Words {
    /// By variable: its first word.
    addr: Vec<u32>,
    /// Initial value of each word.
    pub(super) init: Vec<u64>,
    /// The inputs' words.
    pub(super) inputs: Rows,
    /// The outputs' words.
    pub(super) outputs: Rows,
    /// The outputs' words after a fault.
    pub(super) safe: Vec<u64>,
    /// The first variable for which there is no room.
    pub(super) full: Option<VarId>,
    texts: HashMap<Box<str>, Addr>,
}

impl Words {
    pub(super) fn new(unit: &Unit) -> Words {
        let mut w = Words {
            addr: vec![NONE; unit.vars.len()],
            init: Vec::with_capacity(unit.vars.len()),
            inputs: Rows::default(),
            outputs: Rows::default(),
            safe: Vec::new(),
            full: None,
            texts: HashMap::new(),
        };
        w.place(unit, |c| c == VarClass::Input);
        w.inputs = Rows { start: 0, end: w.init.len() as u32 };
        w.place(unit, |c| c == VarClass::Output);
        w.outputs = Rows { start: w.inputs.end, end: w.init.len() as u32 };
        for var in unit.vars.iter().filter(|v| v.class == VarClass::Output) {
            for _ in 0..var.elements {
                if w.safe.len() < (w.outputs.end - w.outputs.start) as usize {
                    push_value(&mut w.safe, var.ty, &var.safe);
                }
            }
        }
        w.safe.resize((w.outputs.end - w.outputs.start) as usize, 0);
        w.place(unit, |c| !matches!(c, VarClass::Input | VarClass::Output | VarClass::Local));
        w
    }

    /// Places the locals; only words that need not last may come behind them.
    pub(super) fn place_locals(&mut self, unit: &Unit) -> u32 {
        let start = self.init.len() as u32;
        self.place(unit, |c| c == VarClass::Local);
        start
    }

    fn place(&mut self, unit: &Unit, wanted: impl Fn(VarClass) -> bool) {
        for (i, var) in unit.vars.iter().enumerate().filter(|(_, v)| wanted(v.class)) {
            let size = (words_of(var.ty) as usize).saturating_mul(var.elements as usize);
            if self.init.len().saturating_add(size) > MOST {
                self.full.get_or_insert(VarId(i as u32));
                continue;
            }
            if let Some(a) = self.addr.get_mut(i) {
                *a = self.init.len() as u32;
            }
            for k in 0..var.elements as usize {
                if var.class == VarClass::Local {
                    self.init.resize(self.init.len() + words_of(var.ty) as usize, 0);
                } else {
                    push_value(&mut self.init, var.ty, initial(var, k));
                }
            }
        }
    }

    /// The first word of a variable.
    pub(super) fn addr(&self, var: VarId) -> Addr {
        Addr(self.addr.get(var.index()).copied().filter(|a| *a != NONE).unwrap_or(0))
    }

    /// A word that no variable of the unit has. Asked for before the locals are
    /// placed it lasts, behind them it lasts for one run.
    pub(super) fn hidden(&mut self, init: u64) -> Addr {
        self.init.push(init);
        Addr(self.init.len() as u32 - 1)
    }

    /// Room for a text of so many bytes, for one run.
    pub(super) fn text_room(&mut self, cap: u16) -> Addr {
        let at = Addr(self.init.len() as u32);
        let words = words_of(Type::String(cap)) as usize;
        self.init.resize(self.init.len() + words, 0);
        at
    }

    /// Where a constant text lies; all are asked for before the locals are placed.
    pub(super) fn text(&mut self, text: &str) -> Addr {
        if let Some(a) = self.texts.get(text) {
            return *a;
        }
        let at = Addr(self.init.len() as u32);
        let cap = capacity(u16::try_from(text.len()).unwrap_or(TEXT));
        push_text(&mut self.init, cap, text);
        self.texts.insert(text.into(), at);
        at
    }
}

fn initial(var: &Var, element: usize) -> &Value {
    var.table.get(element).unwrap_or(&var.init)
}

/// Bytes that a STRING may hold at most.
pub(crate) fn capacity(bytes: u16) -> u16 {
    bytes.min(TEXT)
}

/// Words that a value of a type takes.
pub fn words_of(ty: Type) -> u32 {
    match ty {
        Type::String(n) => 1 + u32::from(capacity(n)).div_ceil(8),
        Type::Fb(kind) => block_of(kind).words(),
        Type::Bool
        | Type::Sint
        | Type::Int
        | Type::Dint
        | Type::Lint
        | Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword
        | Type::Real
        | Type::Lreal
        | Type::Time
        | Type::Moment(_) => 1,
    }
}

/// How a value of a type is read as a number; text and instances are none.
pub fn num(ty: Type) -> Num {
    match ty {
        Type::Bool => Num::Bool,
        Type::Sint => Num::I8,
        Type::Int => Num::I16,
        Type::Dint => Num::I32,
        Type::Lint | Type::Time | Type::Moment(_) => Num::I64,
        Type::Usint | Type::Byte => Num::U8,
        Type::Uint | Type::Word => Num::U16,
        Type::Udint | Type::Dword => Num::U32,
        Type::Ulint | Type::Lword | Type::String(_) | Type::Fb(_) => Num::U64,
        Type::Real => Num::F32,
        Type::Lreal => Num::F64,
    }
}

/// The engine's block of a kind of function block.
pub(crate) fn block_of(kind: FbKind) -> Block {
    match kind {
        FbKind::Ctu => Block::Ctu,
        FbKind::Ctd => Block::Ctd,
        FbKind::Ctud => Block::Ctud,
        FbKind::Ton => Block::Ton,
        FbKind::Tof => Block::Tof,
        FbKind::Tp => Block::Tp,
        FbKind::RTrig => Block::RTrig,
        FbKind::FTrig => Block::FTrig,
        FbKind::Sr => Block::Sr,
        FbKind::Rs => Block::Rs,
    }
}

/// A constant of a one-word type as its word.
pub(crate) fn word_of(ty: Type, value: &Value) -> u64 {
    match (value, ty) {
        (Value::Bool(b), _) => u64::from(*b),
        (Value::Int(v), Type::Real) => u64::from((*v as f32).to_bits()),
        (Value::Int(v), Type::Lreal) => (*v as f64).to_bits(),
        (Value::Int(v), Type::Ulint | Type::Lword) => *v as u64,
        (Value::Int(v), _) => *v as i64 as u64,
        (Value::Real(v), Type::Real) => u64::from((*v as f32).to_bits()),
        (Value::Real(v), _) => v.to_bits(),
        (Value::Str(_), _) => 0,
    }
}

/// The words of a constant of any type.
pub fn words_for(ty: Type, value: &Value) -> Vec<u64> {
    let mut words = Vec::new();
    push_value(&mut words, ty, value);
    words
}

fn push_value(to: &mut Vec<u64>, ty: Type, value: &Value) {
    match (ty, value) {
        (Type::String(n), Value::Str(text)) => push_text(to, capacity(n), text),
        (Type::String(n), _) => push_text(to, capacity(n), ""),
        (Type::Fb(_), _) => to.resize(to.len() + words_of(ty) as usize, 0),
        _ => to.push(word_of(ty, value)),
    }
}

/// Length, then the bytes, eight a word, the first lowest; cut at a character.
fn push_text(to: &mut Vec<u64>, cap: u16, text: &str) {
    let mut len = text.len().min(usize::from(cap));
    while !text.is_char_boundary(len) {
        len -= 1;
    }
    let bytes = text.as_bytes().get(..len).unwrap_or(&[]);
    to.push(len as u64);
    for k in 0..usize::from(cap).div_ceil(8) {
        let chunk = bytes.get(8 * k..).unwrap_or(&[]);
        to.push(chunk.iter().take(8).rev().fold(0u64, |acc, b| acc << 8 | u64::from(*b)));
    }
}
