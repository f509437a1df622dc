//! The values that an input may take, as few as make all the difference.
//!
//! A BOOL takes both. A number that is only compared with constants takes, around each of
//! them, the values below, at and above it: no comparison tells others from these. A type
//! of few values takes all. Of any other only some are tried, and nothing is decided about
//! all runs then. REAL and LREAL inputs are numbers: NaN is left out.

use std::collections::BTreeSet;

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{Num, Op, Tables};
use g7_model::{Holds, Type};

/// The values of one word of the inputs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Values {
    /// The values to be tried, the initial one first.
    pub tried: Vec<u64>,
    /// Any other value acts as one of them.
    pub whole: bool,
}

/// Most values of a type that are all tried.
const ALL: u32 = 8;

/// The values of each word of [`Tables::inputs`].
pub fn values(compiled: &Compiled) -> Vec<Values> {
    let t = compiled.program.tables();
    let inputs = t.inputs.start..t.inputs.end;
    let mut list = vec![Values { tried: vec![0], whole: true }; inputs.len()];
    let mine = |v: &&Variable| v.class == VarClass::Input && inputs.contains(&v.addr.0);
    for v in compiled.symbols.variables.iter().filter(mine) {
        for at in v.addr.0..v.addr.0.saturating_add(v.words()) {
            if let Some(entry) = list.get_mut((at - inputs.start) as usize) {
                *entry = of_word(t, v.ty, at);
            }
        }
    }
    list
}

fn of_word(t: &Tables, ty: Type, at: u32) -> Values {
    let init = t.init.get(at as usize).copied().unwrap_or(0);
    let row = ty.elementary();
    let (mut tried, mut whole) = (BTreeSet::from([init]), true);
    match row.map(|r| (r.holds, r.bits)) {
        Some((Holds::Truth, _)) => tried.extend([0, 1]),
        Some((holds @ (Holds::Signed | Holds::Unsigned | Holds::Bits), bits)) if u32::from(bits) <= ALL => {
            let (least, most) = range(holds, bits);
            tried.extend((least..=most).map(|v| v as u64));
        }
        Some((Holds::Text, _)) | None => whole = false,
        Some((holds, bits)) => {
            let (constants, only) = compared(t, at);
            whole = only;
            for c in constants {
                match ty {
                    Type::Real => {
                        let x = f32::from_bits(c as u32);
                        tried.extend([x.next_down(), x, x.next_up()].map(|x| u64::from(x.to_bits())));
                    }
                    Type::Lreal => {
                        let x = f64::from_bits(c);
                        tried.extend([x.next_down(), x, x.next_up()].map(f64::to_bits));
                    }
                    _ => {
                        let (least, most) = range(holds, bits);
                        let c = if matches!(holds, Holds::Unsigned | Holds::Bits) {
                            i128::from(c)
                        } else {
                            i128::from(c as i64)
                        };
                        let near = [c - 1, c, c + 1].into_iter().filter(|v| (least..=most).contains(v));
                        tried.extend(near.map(|v| v as u64));
                    }
                }
            }
        }
    }
    tried.remove(&init);
    Values { tried: std::iter::once(init).chain(tried).collect(), whole }
}

fn range(holds: Holds, bits: u8) -> (i128, i128) {
    let bits = u32::from(bits.clamp(1, 64));
    match holds {
        Holds::Unsigned | Holds::Bits => (0, (1i128 << bits) - 1),
        _ => (-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1),
    }
}

/// The constants that a word is compared with; tells whether it is read in no other way.
fn compared(t: &Tables, at: u32) -> (Vec<u64>, bool) {
    let op = |pc: Option<usize>| pc.and_then(|pc| t.code.get(pc)).copied();
    let is_target = |pc: usize| {
        t.code.iter().any(|o| matches!(o, Op::Jump(to) | Op::JumpUnless(to) if *to as usize == pc))
    };
    let (mut found, mut only) = (Vec::new(), true);
    for (pc, o) in t.code.iter().enumerate() {
        match o {
            Op::Load(a) if a.0 == at => match (op(pc.checked_sub(1)), op(Some(pc + 1)), op(Some(pc + 2))) {
                (_, Some(Op::Push(c)), Some(Op::Compare(_, n))) if n != Num::Bool => found.push(c),
                (Some(Op::Push(c)), Some(Op::Compare(_, n)), _) if n != Num::Bool && !is_target(pc) => {
                    found.push(c);
                }
                _ => only = false,
            },
            Op::LoadAt { base, len } if (base.0..base.0.saturating_add(*len)).contains(&at) => only = false,
            _ => {}
        }
    }
    (found, only)
}
