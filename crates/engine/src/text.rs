//! STRING values: a length in bytes in the first word, then UTF-8, eight bytes a
//! word. Positions count characters; what does not fit is cut at a character.

use alloc::vec::Vec;
use core::fmt::Write;

use crate::fault::FaultKind;
use crate::number::{ordered, real};
use crate::run::{read, write};
use crate::state::State;
use crate::{Addr, Builtin, Cmp, Num, Program};

/// Longest STRING, in bytes.
pub const TEXT: u16 = 4096;

/// Reads the string at an address into a buffer.
fn load(s: &State, at: u64, buffer: &mut Vec<u8>) {
    buffer.clear();
    let base = at as u32;
    let len = (read(s, Addr(base)) as usize).min(usize::from(TEXT));
    for k in 0..len.div_ceil(8) {
        let w = read(s, Addr(base.wrapping_add(1 + k as u32)));
        buffer.extend_from_slice(w.to_le_bytes().get(..(len - 8 * k).min(8)).unwrap_or(&[]));
    }
}

/// The text of a buffer, up to the first byte that is not UTF-8.
fn text(bytes: &[u8]) -> &str {
    match core::str::from_utf8(bytes) {
        Ok(t) => t,
        Err(e) => core::str::from_utf8(bytes.get(..e.valid_up_to()).unwrap_or(&[])).unwrap_or(""),
    }
}

/// Writes text to a string variable, cut at a character.
fn store(p: &Program, s: &mut State, to: Addr, cap: u16, bytes: &[u8]) {
    let mut len = bytes.len().min(usize::from(cap));
    while len < bytes.len() && len > 0 && bytes.get(len).is_some_and(|b| b & 0xC0 == 0x80) {
        len -= 1;
    }
    let kept = bytes.get(..len).unwrap_or(&[]);
    write(p, s, to, len as u64);
    // Unused bytes are zero, so that equal strings are equal words.
    for k in 0..usize::from(cap).div_ceil(8) {
        let chunk = kept.get(8 * k..).unwrap_or(&[]);
        let w = chunk.iter().take(8).rev().fold(0u64, |acc, b| acc << 8 | u64::from(*b));
        write(p, s, Addr(to.0 + 1 + k as u32), w);
    }
}

/// Takes the buffers out while they are worked on, so that the state is free.
fn buffers(s: &mut State) -> [Vec<u8>; 3] {
    core::mem::take(&mut s.x.text)
}

pub(crate) fn copy(p: &Program, s: &mut State, from: u64, to: Addr, cap: u16) {
    let mut b = buffers(s);
    load(s, from, &mut b[0]);
    store(p, s, to, cap, &b[0]);
    s.x.text = b;
}

pub(crate) fn compare(s: &mut State, c: Cmp) {
    let mut b = buffers(s);
    let right = s.x.stack.pop().unwrap_or(0);
    let left = s.x.stack.pop().unwrap_or(0);
    load(s, left, &mut b[0]);
    load(s, right, &mut b[1]);
    let result = ordered(c, Some(b[0].cmp(&b[1])));
    s.x.text = b;
    s.x.stack.push(u64::from(result));
}

/// Byte position of character `n`, at most the length.
fn skip(t: &str, n: i64) -> usize {
    let n = usize::try_from(n).unwrap_or(0);
    t.char_indices().nth(n).map_or(t.len(), |(i, _)| i)
}

pub(crate) fn call(p: &Program, s: &mut State, f: Builtin, to: Addr, cap: u16) -> Result<(), FaultKind> {
    let mut b = buffers(s);
    let done = work(s, f, &mut b);
    match done {
        Ok(None) => {
            store(p, s, to, cap, &b[2]);
            s.x.stack.push(u64::from(to.0));
        }
        Ok(Some(n)) => s.x.stack.push(n),
        Err(_) => {}
    }
    s.x.text = b;
    done.map(|_| ())
}

/// The result in the third buffer, or a number.
fn work(s: &mut State, f: Builtin, b: &mut [Vec<u8>; 3]) -> Result<Option<u64>, FaultKind> {
    let mut pop = || s.x.stack.pop().unwrap_or(0);
    let (mut numbers, strings) = match f {
        Builtin::Len => ([0, 0], [Some(pop()), None]),
        Builtin::Left | Builtin::Right => {
            let n = pop() as i64;
            ([n, 0], [Some(pop()), None])
        }
        Builtin::Mid | Builtin::Delete => {
            let (at, n) = (pop() as i64, pop() as i64);
            ([n, at], [Some(pop()), None])
        }
        Builtin::Insert => {
            let at = pop() as i64;
            let second = pop();
            ([0, at], [Some(pop()), Some(second)])
        }
        Builtin::Replace => {
            let (at, n) = (pop() as i64, pop() as i64);
            let second = pop();
            ([n, at], [Some(pop()), Some(second)])
        }
        _ => {
            let second = pop();
            ([0, 0], [Some(pop()), Some(second)])
        }
    };
    for (buffer, at) in b.iter_mut().zip(strings) {
        if let Some(at) = at {
            load(s, at, buffer);
        }
    }
    let [first, second, out] = b;
    let (a, c) = (text(first), text(second));
    out.clear();
    let [n, at] = &mut numbers;
    if *n < 0 || *at < 0 {
        return Err(FaultKind::Range);
    }
    let mut put = |part: &str| out.extend_from_slice(part.as_bytes());
    match f {
        Builtin::Len => return Ok(Some(a.chars().count() as u64)),
        Builtin::Find => {
            let found = a.find(c).map_or(0, |i| a.get(..i).unwrap_or("").chars().count() + 1);
            return Ok(Some(if c.is_empty() { 0 } else { found as u64 }));
        }
        Builtin::Left => put(a.get(..skip(a, *n)).unwrap_or("")),
        Builtin::Right => {
            let drop = (a.chars().count() as i64 - *n).max(0);
            put(a.get(skip(a, drop)..).unwrap_or(""));
        }
        Builtin::Mid => {
            let from = skip(a, *at - 1);
            let rest = a.get(from..).unwrap_or("");
            put(rest.get(..skip(rest, *n)).unwrap_or(""));
        }
        Builtin::Concat => {
            put(a);
            put(c);
        }
        Builtin::Insert => {
            let i = skip(a, *at);
            put(a.get(..i).unwrap_or(""));
            put(c);
            put(a.get(i..).unwrap_or(""));
        }
        Builtin::Delete | Builtin::Replace => {
            let from = skip(a, *at - 1);
            let rest = a.get(from..).unwrap_or("");
            put(a.get(..from).unwrap_or(""));
            if f == Builtin::Replace {
                put(c);
            }
            put(rest.get(skip(rest, *n)..).unwrap_or(""));
        }
        _ => return Err(FaultKind::Range),
    }
    Ok(None)
}

/// Text of at most a buffer's room; what does not fit is left away.
struct Out<'a>(&'a mut Vec<u8>);

impl Write for Out<'_> {
    fn write_str(&mut self, t: &str) -> core::fmt::Result {
        let room = self.0.capacity().saturating_sub(self.0.len());
        self.0.extend(t.bytes().take(room));
        Ok(())
    }
}

pub(crate) fn from_number(p: &Program, s: &mut State, from: Num, time: bool, to: Addr, cap: u16) {
    let v = s.x.stack.pop().unwrap_or(0);
    let mut b = buffers(s);
    b[2].clear();
    let mut out = Out(&mut b[2]);
    // `Out` never fails.
    let _ = match from {
        _ if time => write!(out, "{}", Duration(v as i64)),
        Num::Bool => out.write_str(if v == 0 { "FALSE" } else { "TRUE" }),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => write!(out, "{}", v as i64),
        Num::U8 | Num::U16 | Num::U32 | Num::U64 => write!(out, "{v}"),
        Num::F32 => write!(out, "{:?}", f32::from_bits(v as u32)),
        Num::F64 => write!(out, "{:?}", real(from, v)),
    };
    store(p, s, to, cap, &b[2]);
    s.x.text = b;
    s.x.stack.push(u64::from(to.0));
}

pub(crate) fn to_number(s: &mut State, n: Num) -> Result<(), FaultKind> {
    let at = s.x.stack.pop().unwrap_or(0);
    let mut b = buffers(s);
    load(s, at, &mut b[0]);
    let t = text(&b[0]).trim();
    let parsed = match n {
        Num::F32 => t.parse::<f32>().ok().map(|v| u64::from(v.to_bits())),
        Num::F64 => t.parse::<f64>().ok().map(f64::to_bits),
        Num::Bool => match t {
            "TRUE" | "1" => Some(1),
            "FALSE" | "0" => Some(0),
            _ => None,
        },
        Num::U64 => t.parse::<u64>().ok(),
        _ => t.parse::<i64>().ok().and_then(|v| crate::number::convert(Num::I64, n, v as u64).ok()),
    };
    s.x.text = b;
    s.x.stack.push(parsed.ok_or(FaultKind::Range)?);
    Ok(())
}

/// A TIME as IEC 61131-3 writes it: `T#1s500ms`, `T#0s`, `T#-2ms`.
#[derive(Clone, Copy, Debug)]
pub struct Duration(
    /// Nanoseconds.
    pub i64,
);

impl core::fmt::Display for Duration {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const UNITS: [(u64, &str); 7] = [
            (86_400_000_000_000, "d"),
            (3_600_000_000_000, "h"),
            (60_000_000_000, "m"),
            (1_000_000_000, "s"),
            (1_000_000, "ms"),
            (1_000, "us"),
            (1, "ns"),
        ];
        f.write_str(if self.0 < 0 { "T#-" } else { "T#" })?;
        let mut left = self.0.unsigned_abs();
        if left == 0 {
            return f.write_str("0s");
        }
        for (unit, name) in UNITS {
            if left >= unit {
                write!(f, "{}{name}", left / unit)?;
                left %= unit;
            }
        }
        Ok(())
    }
}
