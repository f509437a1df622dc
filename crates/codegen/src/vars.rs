//! Where each word of the variable area lives in the code: a field with its type.

use std::collections::BTreeMap;

use g7_compile::ir::VarClass;
use g7_compile::symbols::Symbols;
use g7_engine::Num;
use g7_equations::{Class, Memory};
use g7_model::{FbKind, Type};

use crate::names::Names;
use crate::tree::{Expr, Field, Ty};

/// The structure in which a variable lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Home {
    Inputs,
    Outputs,
    Variables,
    Locals,
    /// No field: a constant.
    Constant,
}

/// The form of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    One(Num),
    Many(Num, u32),
    Text(u16),
    Texts(u16, u32),
    Fb(FbKind),
}

/// A variable, or words that only the lowering knows of.
#[derive(Clone, Debug)]
pub(crate) struct Slot {
    pub(crate) start: u32,
    pub(crate) words: u32,
    pub(crate) home: Home,
    pub(crate) shape: Shape,
    pub(crate) field: String,
    pub(crate) note: String,
    pub(crate) retain: bool,
}

/// All of them, by their first word.
#[derive(Debug, Default)]
pub(crate) struct Vars {
    pub(crate) slots: BTreeMap<u32, Slot>,
}

/// The words' kind of a type, where it has one word.
pub(crate) fn num(ty: Type) -> Option<Num> {
    Some(match ty {
        Type::Bool => Num::Bool,
        Type::Sint => Num::I8,
        Type::Int => Num::I16,
        Type::Dint => Num::I32,
        Type::Lint | Type::Time | Type::Moment(_) => Num::I64,
        Type::Usint | Type::Byte => Num::U8,
        Type::Uint | Type::Word => Num::U16,
        Type::Udint | Type::Dword => Num::U32,
        Type::Ulint | Type::Lword => Num::U64,
        Type::Real => Num::F32,
        Type::Lreal => Num::F64,
        Type::String(_) | Type::Fb(_) => return None,
    })
}

/// The type of a number in the code.
pub(crate) fn ty(n: Num) -> Ty {
    let int = |signed, bits| Ty::Int { signed, bits };
    match n {
        Num::Bool => Ty::Bool,
        Num::I8 => int(true, 8),
        Num::I16 => int(true, 16),
        Num::I32 => int(true, 32),
        Num::I64 => int(true, 64),
        Num::U8 => int(false, 8),
        Num::U16 => int(false, 16),
        Num::U32 => int(false, 32),
        Num::U64 => int(false, 64),
        Num::F32 => Ty::Real { bits: 32 },
        Num::F64 => Ty::Real { bits: 64 },
    }
}

/// A number of a kind as a literal.
pub(crate) fn literal(n: Num, word: u64) -> Expr {
    match n {
        Num::Bool => Expr::Bool(word != 0),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => Expr::Int((word as i64).into(), None),
        Num::U8 | Num::U16 | Num::U32 | Num::U64 => Expr::Int(word.into(), None),
        Num::F32 => Expr::Real(word, 32),
        Num::F64 => Expr::Real(word, 64),
    }
}

/// Fields of an instance in the order of its words, with their kinds.
pub(crate) fn members(kind: FbKind) -> &'static [(&'static str, Num)] {
    use Num::{Bool as B, I16 as I, I64 as T, U8};
    const TIMER: [(&str, Num); 6] =
        [("in_", B), ("pt", T), ("q", B), ("et", T), ("start", T), ("memory", U8)];
    match kind {
        FbKind::Ctu => &[("cu", B), ("r", B), ("pv", I), ("q", B), ("cv", I), ("cu_before", B)],
        FbKind::Ctd => &[("cd", B), ("ld", B), ("pv", I), ("q", B), ("cv", I), ("cd_before", B)],
        FbKind::Ctud => &[
            ("cu", B),
            ("cd", B),
            ("r", B),
            ("ld", B),
            ("pv", I),
            ("qu", B),
            ("qd", B),
            ("cv", I),
            ("cu_before", B),
            ("cd_before", B),
        ],
        FbKind::Ton | FbKind::Tof | FbKind::Tp => &TIMER,
        FbKind::RTrig => &[("clk", B), ("q", B), ("clk_before", B)],
        FbKind::FTrig => &[("clk", B), ("q", B), ("low_before", B)],
        FbKind::Sr => &[("s1", B), ("r", B), ("q1", B)],
        FbKind::Rs => &[("s", B), ("r1", B), ("q1", B)],
    }
}

/// Structure and function of a block.
pub(crate) fn block_names(kind: FbKind) -> (&'static str, &'static str) {
    match kind {
        FbKind::Ctu => ("Ctu", "call_ctu"),
        FbKind::Ctd => ("Ctd", "call_ctd"),
        FbKind::Ctud => ("Ctud", "call_ctud"),
        FbKind::Ton => ("Ton", "call_ton"),
        FbKind::Tof => ("Tof", "call_tof"),
        FbKind::Tp => ("Tp", "call_tp"),
        FbKind::RTrig => ("RTrig", "call_r_trig"),
        FbKind::FTrig => ("FTrig", "call_f_trig"),
        FbKind::Sr => ("Sr", "call_sr"),
        FbKind::Rs => ("Rs", "call_rs"),
    }
}

/// A text as the code has it: its length in two bytes, then room for its bytes.
pub(crate) fn text_bytes(text: &[u8], cap: usize) -> Vec<u8> {
    let mut bytes = vec![(text.len() & 255) as u8, (text.len() >> 8) as u8];
    bytes.extend(text);
    bytes.resize(cap + 2, 0);
    bytes
}

pub(crate) fn text_words(cap: u16) -> u32 {
    1 + u32::from(cap).div_ceil(8)
}

impl Slot {
    /// The type of the field.
    pub(crate) fn ty(&self) -> Ty {
        let text = |cap: u16| Ty::Array(Box::new(Ty::U8), usize::from(cap) + 2);
        match self.shape {
            Shape::One(n) => ty(n),
            Shape::Many(n, len) => Ty::Array(Box::new(ty(n)), len as usize),
            Shape::Text(cap) => text(cap),
            Shape::Texts(cap, n) => Ty::Array(Box::new(text(cap)), n as usize),
            Shape::Fb(kind) => Ty::Named(block_names(kind).0.to_owned()),
        }
    }

    /// The field.
    pub(crate) fn place(&self) -> Expr {
        let s = Expr::name("s");
        let home = match self.home {
            Home::Inputs => s.field("inputs"),
            Home::Outputs => s.field("outputs"),
            Home::Variables => s.field("v"),
            Home::Locals => s.field("t"),
            Home::Constant => return Expr::name(self.field.to_uppercase()),
        };
        home.field(self.field.clone())
    }
}

impl Vars {
    /// The declared variables.
    pub(crate) fn new(symbols: &Symbols, names: &mut Names) -> Vars {
        let mut vars = Vars::default();
        for v in &symbols.variables {
            let (start, words) = (v.addr.0, v.words());
            if words == 0 || vars.slot(start).is_some() {
                continue; // a member of an instance
            }
            let home = match v.class {
                VarClass::Input => Home::Inputs,
                VarClass::Output => Home::Outputs,
                VarClass::Local => Home::Locals,
                VarClass::Const => Home::Constant,
                VarClass::Internal | VarClass::System => Home::Variables,
            };
            let shape = match (v.ty, v.elements) {
                (Type::String(cap), 1) => Shape::Text(cap),
                (Type::String(cap), n) => Shape::Texts(cap, n),
                (Type::Fb(kind), _) => Shape::Fb(kind),
                (ty, 1) => Shape::One(num(ty).unwrap_or(Num::I64)),
                (ty, n) => Shape::Many(num(ty).unwrap_or(Num::I64), n),
            };
            let address = v.address.as_deref().map_or(String::new(), |a| format!(" at {a}"));
            let comment = v.comment.as_deref().map_or(String::new(), |c| format!(": {c}"));
            let note = format!("{}{address}{comment}", v.name);
            let field = names.small(&v.name);
            let slot = Slot { start, words, home, shape, field, note, retain: v.retain };
            vars.slots.insert(start, slot);
        }
        vars
    }

    /// The slot in which a word lies.
    pub(crate) fn slot(&self, addr: u32) -> Option<&Slot> {
        let (_, slot) = self.slots.range(..=addr).next_back()?;
        (addr < slot.start + slot.words).then_some(slot)
    }

    /// A word without a declaration gets a field, if it has none yet.
    pub(crate) fn reveal(&mut self, addr: u32, memory: &Memory, names: &mut Names) {
        if self.slot(addr).is_some() {
            return;
        }
        let home = if memory.class == Class::Scratch { Home::Locals } else { Home::Variables };
        let (words, shape, name) = match memory.ty {
            Type::String(cap) => (text_words(cap), Shape::Text(cap), "text"),
            ty => (1, Shape::One(num(ty).unwrap_or(Num::I64)), "hidden"),
        };
        let field = names.small(name);
        let slot = Slot { start: addr, words, home, shape, field, note: String::new(), retain: false };
        self.slots.insert(addr, slot);
    }

    /// The fields of a home.
    pub(crate) fn fields(&self, home: Home) -> Vec<Field> {
        let of = self.slots.values().filter(|s| s.home == home);
        of.map(|s| Field { name: s.field.clone(), ty: s.ty(), note: s.note.clone(), kept: true }).collect()
    }
}
