//! STRING values: the first word has the length in bytes, the others have UTF-8, eight
//! bytes in each. Positions count characters. A text that does not fit is cut between
//! two characters.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::Write;

use crate::fault::FaultKind;
use crate::memory::{read, write};
use crate::number::{ordered, real};
use crate::ops::{Addr, Builtin, Cmp, Num, TEXT};
use crate::program::Program;
use crate::state::State;

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

/// Bytes of a text that so many bytes can hold, cut at a character.
pub fn cut(bytes: &[u8], cap: usize) -> usize {
    let mut len = bytes.len().min(cap);
    while len < bytes.len() && len > 0 && bytes.get(len).is_some_and(|b| b & 0xC0 == 0x80) {
        len -= 1;
    }
    len
}

/// Writes text to a string variable, cut between two characters where it is too long.
fn store(p: &Program, s: &mut State, to: Addr, cap: u16, bytes: &[u8]) {
    let len = cut(bytes, usize::from(cap));
    let kept = bytes.get(..len).unwrap_or(&[]);
    write(p, s, to, len as u64);
    // Unused bytes are zero, so that equal strings have equal words.
    for k in 0..usize::from(cap).div_ceil(8) {
        let chunk = kept.get(8 * k..).unwrap_or(&[]);
        let w = chunk.iter().take(8).rev().fold(0u64, |acc, b| acc << 8 | u64::from(*b));
        write(p, s, Addr(to.0 + 1 + k as u32), w);
    }
}

/// Takes the buffers out of the state, so that both can be changed at once.
fn buffers(s: &mut State) -> [Vec<u8>; 3] {
    core::mem::take(&mut s.scratch.text)
}

pub(crate) fn copy(p: &Program, s: &mut State, from: u64, to: Addr, cap: u16) {
    let mut b = buffers(s);
    load(s, from, &mut b[0]);
    store(p, s, to, cap, &b[0]);
    s.scratch.text = b;
}

pub(crate) fn compare(s: &mut State, c: Cmp) {
    let mut b = buffers(s);
    let right = s.scratch.stack.pop();
    let left = s.scratch.stack.pop();
    load(s, left, &mut b[0]);
    load(s, right, &mut b[1]);
    let result = ordered(c, Some(b[0].cmp(&b[1])));
    s.scratch.text = b;
    s.scratch.stack.push(u64::from(result));
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
            s.scratch.stack.push(u64::from(to.0));
        }
        Ok(Some(n)) => s.scratch.stack.push(n),
        Err(_) => {}
    }
    s.scratch.text = b;
    done.map(|_| ())
}

/// Runs a string function: the result is in the third buffer, or is a number.
fn work(s: &mut State, f: Builtin, b: &mut [Vec<u8>; 3]) -> Result<Option<u64>, FaultKind> {
    let mut pop = || s.scratch.stack.pop();
    let (numbers, strings) = match f {
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
    assemble(f, [text(first), text(second)], numbers, out)
}

/// A function of texts: the result in the buffer, or a number. `n` is a length,
/// `at` a position from 1.
fn assemble(
    f: Builtin,
    [a, c]: [&str; 2],
    [n, at]: [i64; 2],
    out: &mut Vec<u8>,
) -> Result<Option<u64>, FaultKind> {
    let (n, at) = (&n, &at);
    out.clear();
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

/// The value of a function of texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Applied {
    /// LEN and FIND.
    Number(u64),
    /// The others, not cut yet.
    Text(Vec<u8>),
}

/// A function of texts on its texts and numbers, each in the order of the call.
/// Allocates: not for a scan.
///
/// # Errors
///
/// [`FaultKind::Range`] where a length or a position is negative.
pub fn apply(f: Builtin, texts: [&[u8]; 2], numbers: &[i64]) -> Result<Applied, FaultKind> {
    let arg = |i: usize| numbers.get(i).copied().unwrap_or(0);
    let places = match f {
        Builtin::Left | Builtin::Right => [arg(0), 0],
        Builtin::Insert => [0, arg(0)],
        Builtin::Mid | Builtin::Delete | Builtin::Replace => [arg(0), arg(1)],
        _ => [0, 0],
    };
    let mut out = Vec::new();
    let number = assemble(f, texts.map(text), places, &mut out)?;
    Ok(number.map_or(Applied::Text(out), Applied::Number))
}

/// A writer into the room of a buffer, which drops what does not fit.
struct Out<'a>(&'a mut Vec<u8>);

impl Write for Out<'_> {
    fn write_str(&mut self, t: &str) -> core::fmt::Result {
        let room = self.0.capacity().saturating_sub(self.0.len());
        self.0.extend(t.bytes().take(room));
        Ok(())
    }
}

/// A number as text; REAL and LREAL so that they are read again as the same.
fn write_number(out: &mut impl Write, from: Num, time: bool, v: u64) -> core::fmt::Result {
    match from {
        _ if time => write!(out, "{}", Duration(v as i64)),
        Num::Bool => out.write_str(if v == 0 { "FALSE" } else { "TRUE" }),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => write!(out, "{}", v as i64),
        Num::U8 | Num::U16 | Num::U32 | Num::U64 => write!(out, "{v}"),
        Num::F32 => write!(out, "{:?}", f32::from_bits(v as u32)),
        Num::F64 => write!(out, "{:?}", real(from, v)),
    }
}

/// A number as text, as the engine writes it. Allocates: not for a scan.
pub fn written(from: Num, time: bool, v: u64) -> String {
    let mut out = String::new();
    // A String takes everything.
    let _ = write_number(&mut out, from, time, v);
    out
}

pub(crate) fn from_number(p: &Program, s: &mut State, from: Num, time: bool, to: Addr, cap: u16) {
    let v = s.scratch.stack.pop();
    let mut b = buffers(s);
    b[2].clear();
    let mut out = Out(&mut b[2]);
    // `Out` never fails.
    let _ = write_number(&mut out, from, time, v);
    store(p, s, to, cap, &b[2]);
    s.scratch.text = b;
    s.scratch.stack.push(u64::from(to.0));
}

/// A text as a number.
///
/// # Errors
///
/// [`FaultKind::Range`] where it is none of this kind.
pub fn read_number(n: Num, bytes: &[u8]) -> Result<u64, FaultKind> {
    let t = text(bytes).trim();
    let parsed = match n {
        Num::F32 => t.parse::<f32>().ok().map(|v| u64::from(v.to_bits())),
        Num::F64 => t.parse::<f64>().ok().map(f64::to_bits),
        Num::Bool => match t {
            "TRUE" | "1" => Some(1),
            "FALSE" | "0" => Some(0),
            _ => None,
        },
        Num::U64 => t.parse::<i128>().ok().and_then(|v| u64::try_from(v).ok()),
        _ => t.parse::<i64>().ok().and_then(|v| crate::number::convert(Num::I64, n, v as u64).ok()),
    };
    parsed.ok_or(FaultKind::Range)
}

pub(crate) fn to_number(s: &mut State, n: Num) -> Result<(), FaultKind> {
    let at = s.scratch.stack.pop();
    let mut b = buffers(s);
    load(s, at, &mut b[0]);
    let parsed = read_number(n, &b[0]);
    s.scratch.text = b;
    s.scratch.stack.push(parsed?);
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
