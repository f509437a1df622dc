//! Lists of words of equal length, packed: a word that is the same in all of them is kept once, and of
//! the others only as many bits as they need.
//!
//! A word that varies is kept in one of two ways: by the run of bits in which its values differ, or, where
//! it has few values that differ in many bits, by the number of its value in a list. Where a new row does
//! not fit, the layout is widened and all rows are packed anew; that happens seldom, since a word gets
//! wider no more than 64 times. Nothing is lost: a row comes back word for word.

/// Most values of a word that are kept in a list.
const MOST: usize = 1 << 16;
/// Widest run of bits that is never replaced by a list.
const NARROW: u32 = 8;

/// A word that varies.
#[derive(Clone, Debug)]
struct Field {
    /// The word.
    word: usize,
    /// Its bits in a packed row.
    at: u32,
    width: u32,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// The bits from this one on; the others are as in the first row.
    Span(u32),
    /// The number of the value.
    List(List),
}

/// Values by their numbers, and the other way round.
#[derive(Clone, Debug, Default)]
struct List {
    values: Vec<u64>,
    /// Numbers, or `u32::MAX`; `2^n` slots, at least half of them free.
    slots: Vec<u32>,
}

impl List {
    fn find(&self, value: u64) -> Option<u32> {
        let mask = self.slots.len().checked_sub(1)?;
        let mut at = mix(0, value) as usize & mask;
        loop {
            let number = self.slots.get(at).copied().filter(|n| *n != u32::MAX)?;
            if self.values.get(number as usize) == Some(&value) {
                return Some(number);
            }
            at = (at + 1) & mask;
        }
    }

    fn add(&mut self, value: u64) {
        if self.find(value).is_some() {
            return;
        }
        self.values.push(value);
        if self.values.len() * 2 > self.slots.len() {
            self.slots = vec![u32::MAX; (self.values.len() * 4).next_power_of_two()];
            (0..self.values.len() as u32).for_each(|n| self.place(n));
        } else {
            self.place(self.values.len() as u32 - 1);
        }
    }

    fn place(&mut self, number: u32) {
        let Some(value) = self.values.get(number as usize) else { return };
        let mask = self.slots.len().wrapping_sub(1);
        let mut at = mix(0, *value) as usize & mask;
        while self.slots.get(at).is_some_and(|s| *s != u32::MAX) {
            at = (at + 1) & mask;
        }
        if let Some(slot) = self.slots.get_mut(at) {
            *slot = number;
        }
    }

    fn bytes(&self) -> usize {
        self.values.len() * 8 + self.slots.len() * 4
    }
}

/// Rows of words.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// The first row.
    first: Vec<u64>,
    /// For each word the bits in which some row differs from the first, all of them for a list.
    vary: Vec<u64>,
    fields: Vec<Field>,
    /// Bytes of a packed row.
    stride: usize,
    /// The rows one behind the other, and eight bytes more.
    data: Vec<u8>,
    len: usize,
    /// How often all rows were packed anew.
    layouts: u32,
}

/// The bits of one packed row, 64 in each word.
pub(crate) type Key = Vec<u64>;

impl Rows {
    /// No row yet. The first one decides the number of words.
    pub(crate) fn new() -> Rows {
        Rows { data: vec![0; 8], ..Rows::default() }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Bytes in use.
    pub(crate) fn bytes(&self) -> usize {
        let lists = self.fields.iter().map(|f| if let Kind::List(list) = &f.kind { list.bytes() } else { 0 });
        self.data.len() + self.first.len() * 16 + lists.sum::<usize>()
    }

    /// Changes whenever all rows were packed anew.
    pub(crate) fn layout(&self) -> u32 {
        self.layouts
    }

    /// Appends a row.
    pub(crate) fn push(&mut self, row: &[u64], key: &mut Key) {
        if !self.pack(row, key) {
            self.widen(row);
            let packed = self.pack(row, key);
            debug_assert!(packed, "the layout was made for it");
        }
        self.push_key(key);
    }

    /// Appends a packed row.
    pub(crate) fn push_key(&mut self, key: &Key) {
        let end = self.len * self.stride;
        self.data.truncate(end);
        key.iter().for_each(|w| self.data.extend_from_slice(&w.to_le_bytes()));
        self.data.truncate(end + self.stride);
        self.data.extend_from_slice(&[0; 8]);
        self.len += 1;
    }

    /// Packs a row; false if the layout has no room for it.
    pub(crate) fn pack(&self, row: &[u64], key: &mut Key) -> bool {
        if self.layouts == 0 || row.len() != self.first.len() {
            return false;
        }
        let differs = row.iter().zip(&self.first).zip(&self.vary).fold(0, |d, ((w, f), v)| d | (w ^ f) & !v);
        if differs != 0 {
            return false;
        }
        key.clear();
        key.resize(self.stride.div_ceil(8), 0);
        for f in &self.fields {
            let word = row.get(f.word).copied().unwrap_or(0);
            let value = match &f.kind {
                Kind::Span(low) => word >> low & ones(f.width),
                Kind::List(list) => match list.find(word) {
                    Some(number) => u64::from(number),
                    None => return false,
                },
            };
            put(key, f.at, f.width, value);
        }
        true
    }

    /// Makes room for a row, and packs all others anew where that needs a new layout.
    pub(crate) fn widen(&mut self, row: &[u64]) {
        if self.layouts == 0 {
            (self.first, self.vary) = (row.to_vec(), vec![0; row.len()]);
            self.layouts = 1;
            return;
        }
        if self.note(row) {
            return;
        }
        let old = self.clone_layout();
        for (word, value) in row.iter().enumerate().take(self.first.len()) {
            self.widen_word(word, *value);
        }
        let mut at = 0;
        for f in &mut self.fields {
            f.at = at;
            at += f.width;
        }
        self.stride = (at as usize).div_ceil(8);
        self.layouts += 1;
        let mut data = Vec::with_capacity((self.len + 1) * self.stride + 8);
        data.extend_from_slice(&[0; 8]);
        let data = std::mem::replace(&mut self.data, data);
        let (mut image, mut key) = (Vec::new(), Key::new());
        for number in 0..std::mem::take(&mut self.len) {
            old.unpack(&data, number, &mut image);
            let packed = self.pack(&image, &mut key);
            debug_assert!(packed, "a wider layout has room for what was there");
            self.push_key(&key);
        }
    }

    /// Adds new values to lists that have room for them; tells whether the row fits now.
    fn note(&mut self, row: &[u64]) -> bool {
        for f in &mut self.fields {
            if let (Kind::List(list), Some(value)) = (&mut f.kind, row.get(f.word))
                && (list.values.len() as u64) < (1 << f.width)
            {
                list.add(*value);
            }
        }
        self.pack(row, &mut Key::new())
    }

    fn clone_layout(&self) -> Rows {
        Rows {
            first: self.first.clone(),
            fields: self.fields.clone(),
            stride: self.stride,
            ..Rows::default()
        }
    }

    /// Gives a word room for a value.
    fn widen_word(&mut self, word: usize, value: u64) {
        let first = self.first.get(word).copied().unwrap_or(0);
        let known = self.vary.get(word).copied().unwrap_or(0);
        let place = self.fields.iter().position(|f| f.word == word);
        let list = place.and_then(|k| self.fields.get(k)).and_then(|f| match &f.kind {
            Kind::List(list) => Some(list),
            Kind::Span(_) => None,
        });
        let fits = match list {
            Some(list) => list.find(value).is_some(),
            None => (value ^ first) & !known == 0,
        };
        if fits {
            return;
        }
        let mut values = match list {
            Some(list) => list.clone(),
            None => self.values_of(word),
        };
        values.add(first);
        values.add(value);
        let mask = values.values.iter().fold(known_of(list, known), |m, v| m | (v ^ first));
        let low = mask.trailing_zeros();
        let span = 64 - mask.leading_zeros() - low;
        // Room for twice as many, so that lists seldom outgrow their bits.
        let width = 64 - (values.values.len() as u64 * 2 - 1).leading_zeros();
        let is_list = span > NARROW && width * 2 <= span && values.values.len() <= MOST;
        let (kind, width, vary) = if is_list {
            (Kind::List(values), width, u64::MAX)
        } else {
            (Kind::Span(low), span, ones(span) << low)
        };
        let field = Field { word, at: 0, width, kind };
        match place.and_then(|k| self.fields.get_mut(k)) {
            Some(old) => *old = field,
            None => self.fields.push(field),
        }
        if let Some(v) = self.vary.get_mut(word) {
            *v = vary;
        }
    }

    /// The values that a word has in the rows; where it is kept as bits, no more than a list may have.
    fn values_of(&self, word: usize) -> List {
        let mut list = List::default();
        let Some(field) = self.fields.iter().find(|f| f.word == word) else { return list };
        let (first, mut key) = (self.first.get(word).copied().unwrap_or(0), Vec::new());
        for number in 0..self.len {
            self.key_of(number, &mut key);
            list.add(value_of(field, first, &key));
            if list.values.len() > MOST {
                break;
            }
        }
        list
    }

    fn key_of(&self, number: usize, key: &mut Key) {
        read(&self.data, number, self.stride, key);
    }

    /// Writes a row into `row`; nothing if there is none.
    pub(crate) fn get(&self, number: usize, row: &mut Vec<u64>) {
        row.clear();
        if number < self.len {
            self.unpack(&self.data, number, row);
        }
    }

    fn unpack(&self, data: &[u8], number: usize, row: &mut Vec<u64>) {
        row.clear();
        row.extend_from_slice(&self.first);
        let (start, stride) = (number * self.stride, self.stride);
        for f in &self.fields {
            let value = bits(data.get(start..start + stride + 8).unwrap_or(&[]), f.at, f.width);
            if let Some(word) = row.get_mut(f.word) {
                *word = f.value(*word, value);
            }
        }
    }

    /// The last word of a row.
    pub(crate) fn last_word(&self, number: usize) -> Option<u64> {
        let word = self.first.len().checked_sub(1)?;
        let first = self.first.get(word).copied()?;
        let Some(field) = self.fields.iter().find(|f| f.word == word) else { return Some(first) };
        let mut key = Vec::new();
        self.key_of(number, &mut key);
        Some(value_of(field, first, &key))
    }

    /// True if a row is the one that was packed so.
    #[inline]
    pub(crate) fn is(&self, number: usize, key: &Key) -> bool {
        let start = number * self.stride;
        let mut left = self.stride;
        for (k, word) in key.iter().enumerate() {
            let from = start + k * 8;
            let Some(bytes) = self.data.get(from..from + 8).and_then(|b| <[u8; 8]>::try_from(b).ok()) else {
                return false;
            };
            let mask = ones((left * 8).min(64) as u32);
            if (u64::from_le_bytes(bytes) ^ word) & mask != 0 {
                return false;
            }
            left = left.saturating_sub(8);
        }
        true
    }

    /// The packed row with a number.
    pub(crate) fn key(&self, number: usize, key: &mut Key) {
        self.key_of(number, key);
    }
}

impl Field {
    /// The word for a value of the field, where the first row has `first`.
    #[inline]
    fn value(&self, first: u64, value: u64) -> u64 {
        match &self.kind {
            Kind::Span(low) => first & !(ones(self.width) << low) | value << low,
            Kind::List(list) => list.values.get(value as usize).copied().unwrap_or(0),
        }
    }
}

/// The bits that vary where no list says so.
fn known_of(list: Option<&List>, known: u64) -> u64 {
    if list.is_some() { 0 } else { known }
}

fn value_of(field: &Field, first: u64, key: &Key) -> u64 {
    let (k, low) = ((field.at / 64) as usize, field.at % 64);
    let word = |k: usize| key.get(k).copied().unwrap_or(0);
    let high = if low == 0 { 0 } else { word(k + 1) << (64 - low) };
    field.value(first, (word(k) >> low | high) & ones(field.width))
}

/// The packed row with a number, 64 bits in each word.
fn read(data: &[u8], number: usize, stride: usize, key: &mut Key) {
    key.clear();
    let row = data.get(number * stride..(number + 1) * stride).unwrap_or(&[]);
    key.extend(row.chunks(8).map(|chunk| {
        let mut bytes = [0u8; 8];
        bytes.iter_mut().zip(chunk).for_each(|(to, from)| *to = *from);
        u64::from_le_bytes(bytes)
    }));
}

/// Some bits of a packed row. Behind the row there are eight bytes more.
#[inline]
fn bits(row: &[u8], at: u32, width: u32) -> u64 {
    let (from, low) = ((at / 8) as usize, at % 8);
    let eight =
        row.get(from..from + 8).and_then(|b| <[u8; 8]>::try_from(b).ok()).map_or(0, u64::from_le_bytes);
    let ninth =
        if low + width > 64 { row.get(from + 8).map_or(0, |b| u64::from(*b)) << (64 - low) } else { 0 };
    (eight >> low | ninth) & ones(width)
}

/// Writes some bits into a packed row.
#[inline]
fn put(key: &mut Key, at: u32, width: u32, value: u64) {
    let (k, low) = ((at / 64) as usize, at % 64);
    if let Some(word) = key.get_mut(k) {
        *word |= value << low;
    }
    if low + width > 64
        && let Some(word) = key.get_mut(k + 1)
    {
        *word |= value >> (64 - low);
    }
}

#[inline]
fn ones(width: u32) -> u64 {
    if width >= 64 { u64::MAX } else { (1 << width) - 1 }
}

/// A hash that takes one word more. It finds places only; rows are compared as a whole.
#[inline]
pub(crate) fn mix(hash: u64, word: u64) -> u64 {
    let product = u128::from(hash.rotate_left(23) ^ word ^ 0x243F_6A88_85A3_08D3)
        * u128::from(0x9E37_79B9_7F4A_7C15u64);
    product as u64 ^ (product >> 64) as u64
}

#[cfg(test)]
mod tests {
    use super::{Key, Rows};

    /// A generator of numbers.
    fn random(x: &mut u64) -> u64 {
        *x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *x >> 33
    }

    #[test]
    fn rows_come_back_word_for_word() {
        let mut x = 7;
        for words in [0usize, 1, 3, 9, 40] {
            let (mut rows, mut all, mut key) = (Rows::new(), Vec::new(), Key::new());
            for n in 0..3000u64 {
                let row: Vec<u64> = (0..words)
                    .map(|k| match k % 6 {
                        0 => 42,
                        // Bits, a number that grows, times, any word at all, one that varies late.
                        1 => random(&mut x) % 7,
                        2 => n,
                        3 => 0i64.wrapping_sub((random(&mut x) % 90) as i64 * 10_000_000) as u64,
                        4 => random(&mut x) << 40 ^ random(&mut x),
                        _ => u64::from(n > 2000) << 63,
                    })
                    .collect();
                rows.push(&row, &mut key);
                assert!(rows.is(n as usize, &key));
                all.push(row);
            }
            let mut row = Vec::new();
            for (n, expected) in all.iter().enumerate() {
                rows.get(n, &mut row);
                assert_eq!(&row, expected, "{words} words, row {n}");
                assert_eq!(rows.last_word(n), expected.last().copied());
            }
        }
    }

    #[test]
    fn what_does_not_vary_takes_no_room() {
        let (mut rows, mut key) = (Rows::new(), Key::new());
        for n in 0..1000u64 {
            // 3 bits, and a time with 50 values.
            rows.push(&[5, n % 8, 9, 0u64.wrapping_sub(n % 50 * 10_000_000), 1 << 40], &mut key);
        }
        assert!(rows.bytes() < 1000 * 2 + 3000, "{}", rows.bytes());
    }
}
