//! Texts in fixed room.

use core::fmt::Write as _;

use crate::faults::FAULT_RANGE;
use crate::numbers::fail;

/// Texts: two bytes of length, then UTF-8; what is not used is zero.
pub(crate) fn text_str(a: &[u8]) -> &str {
    let size = usize::from(a[0]) | usize::from(a[1]) << 8;
    let bytes = &a[2..(size + 2).min(a.len())];
    match core::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) => core::str::from_utf8(&bytes[..e.valid_up_to()]).unwrap_or(""),
    }
}

/// A text that is being written; what does not fit is left away.
pub(crate) struct Text<'a> {
    to: &'a mut [u8],
    size: usize,
    most: usize,
    full: bool,
}

impl<'a> Text<'a> {
    pub(crate) fn new(to: &'a mut [u8], most: usize) -> Text<'a> {
        to.fill(0);
        Text { to, size: 0, most, full: false }
    }
}

impl core::fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for c in text.chars() {
            let end = self.size + c.len_utf8();
            self.full |= end > self.most;
            if !self.full {
                c.encode_utf8(&mut self.to[self.size + 2..end + 2]);
                self.size = end;
            }
        }
        self.to[0] = (self.size & 255) as u8;
        self.to[1] = (self.size >> 8) as u8;
        Ok(())
    }
}

/// The byte behind so many characters.
pub(crate) fn text_skip(a: &str, count: i64) -> usize {
    let count = usize::try_from(count).unwrap_or(0);
    a.char_indices().nth(count).map_or(a.len(), |(i, _)| i)
}

pub fn text_len(a: &[u8]) -> i64 {
    text_str(a).chars().count() as i64
}

pub fn text_compare(a: &[u8], b: &[u8]) -> i32 {
    let (a, b) = (text_str(a).as_bytes(), text_str(b).as_bytes());
    a.cmp(b) as i32
}

pub fn text_find(a: &[u8], b: &[u8]) -> i64 {
    let (a, b) = (text_str(a), text_str(b));
    match a.find(b) {
        Some(i) if !b.is_empty() => a[..i].chars().count() as i64 + 1,
        _ => 0,
    }
}

/// Writes parts one behind the other.
pub(crate) fn text_parts(parts: &[&str], to: &mut [u8], most: usize) {
    let mut text = Text::new(to, most);
    for part in parts {
        let _ = text.write_str(part);
    }
}

pub fn text_copy(a: &[u8], to: &mut [u8], most: usize) {
    text_parts(&[text_str(a)], to, most);
}

pub fn text_left(a: &[u8], n: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if n < 0 {
        return fail(fault, FAULT_RANGE);
    }
    text_parts(&[&a[..text_skip(a, n)]], to, most);
}

pub fn text_right(a: &[u8], n: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if n < 0 {
        return fail(fault, FAULT_RANGE);
    }
    let drop = (a.chars().count() as i64 - n).max(0);
    text_parts(&[&a[text_skip(a, drop)..]], to, most);
}

pub fn text_mid(a: &[u8], n: i64, at: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if n < 0 || at < 0 {
        return fail(fault, FAULT_RANGE);
    }
    let rest = &a[text_skip(a, at - 1)..];
    text_parts(&[&rest[..text_skip(rest, n)]], to, most);
}

pub fn text_concat(a: &[u8], b: &[u8], to: &mut [u8], most: usize) {
    text_parts(&[text_str(a), text_str(b)], to, most);
}

pub fn text_insert(a: &[u8], b: &[u8], at: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if at < 0 {
        return fail(fault, FAULT_RANGE);
    }
    let i = text_skip(a, at);
    text_parts(&[&a[..i], text_str(b), &a[i..]], to, most);
}

pub fn text_delete(a: &[u8], n: i64, at: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if n < 0 || at < 0 {
        return fail(fault, FAULT_RANGE);
    }
    let i = text_skip(a, at - 1);
    let rest = &a[i..];
    text_parts(&[&a[..i], &rest[text_skip(rest, n)..]], to, most);
}

pub fn text_replace(a: &[u8], b: &[u8], n: i64, at: i64, to: &mut [u8], most: usize, fault: &mut u8) {
    let a = text_str(a);
    if n < 0 || at < 0 {
        return fail(fault, FAULT_RANGE);
    }
    let i = text_skip(a, at - 1);
    let rest = &a[i..];
    text_parts(&[&a[..i], text_str(b), &rest[text_skip(rest, n)..]], to, most);
}

pub fn text_from_i64(v: i64, to: &mut [u8], most: usize) {
    let mut text = Text::new(to, most);
    let _ = write!(text, "{v}");
}

pub fn text_from_u64(v: u64, to: &mut [u8], most: usize) {
    let mut text = Text::new(to, most);
    let _ = write!(text, "{v}");
}

pub fn text_from_bool(v: bool, to: &mut [u8], most: usize) {
    text_parts(&[if v { "TRUE" } else { "FALSE" }], to, most);
}

pub fn text_from_time(v: i64, to: &mut [u8], most: usize) {
    const UNITS: [(u64, &str); 7] = [
        (86_400_000_000_000, "d"),
        (3_600_000_000_000, "h"),
        (60_000_000_000, "m"),
        (1_000_000_000, "s"),
        (1_000_000, "ms"),
        (1_000, "us"),
        (1, "ns"),
    ];
    let mut text = Text::new(to, most);
    let mut left = v.unsigned_abs();
    let _ = text.write_str(if v < 0 { "T#-" } else { "T#" });
    if left == 0 {
        let _ = text.write_str("0s");
    }
    for (unit, name) in UNITS {
        if left >= unit {
            let _ = write!(text, "{}{name}", left / unit);
            left %= unit;
        }
    }
}

pub fn text_to_bool(a: &[u8], fault: &mut u8) -> bool {
    match text_str(a).trim() {
        "TRUE" | "1" => true,
        "FALSE" | "0" => false,
        _ => {
            fail(fault, FAULT_RANGE);
            false
        }
    }
}
