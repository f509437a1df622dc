//! The writer of a record: takes notes of the controller, and hands them to the disk a batch at a time.

use std::collections::BTreeMap;
use std::path::Path;

use g7_host::Kind;
use g7_model::Nanos;
use rusqlite::{Connection, Transaction, params};

use super::limits::Limits;
use super::packed::{Changes, MOST, Packed, put_batch, take_batch};
use super::prune::prune;
use super::{Clock, KIND, LAYOUTS, Signal, kind_of, kind_word};
use crate::file::{Durable, StoreError, open};

/// Between two times that batches are sorted into chunks by signal, in us.
const SORTED_EACH: i64 = 600_000_000;
/// The same, in bytes of batches.
const SORTED_AT: usize = 1 << 20;
/// Bytes that wait for a disk that takes none; behind that there is a gap.
const WAITING: usize = if cfg!(test) { 32 << 10 } else { 8 << 20 };
/// A pause between two runs counts as a day at most, in us.
const PAUSE: i64 = 86_400_000_000;

/// A signal that the record has seen.
struct Slot {
    kind: Kind,
    /// Its description, until the file has it.
    unsaved: Option<Signal>,
    /// The changes since batches were sorted last.
    full: Vec<Packed>,
    open: Packed,
    /// Those that no batch has yet.
    fresh: Packed,
    word: u64,
}

impl Slot {
    fn new(kind: Kind, unsaved: Option<Signal>) -> Slot {
        let (open, fresh) = (Packed::new(kind), Packed::new(kind));
        Slot { kind, unsaved, full: Vec::new(), open, fresh, word: 0 }
    }

    fn sort_in(&mut self, at: i64, word: u64) {
        if self.open.count >= MOST {
            self.full.push(std::mem::replace(&mut self.open, Packed::new(self.kind)));
        }
        self.open.push(at, word);
    }

    fn forget(&mut self) {
        self.full.clear();
        self.open = Packed::new(self.kind);
        self.fresh = Packed::new(self.kind);
    }
}

/// A span that goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Present {
    id: i64,
    start: i64,
    stop: i64,
    lost: u64,
    /// The file has it.
    saved: bool,
}

/// The writer of a record.
pub struct Writer {
    file: Connection,
    limits: Limits,
    /// Added to the time of the controller; in us.
    base: i64,
    now: i64,
    slots: BTreeMap<i64, Slot>,
    names: BTreeMap<(String, String), i64>,
    /// The signals of the present table.
    table: Vec<i64>,
    /// The last one goes on; those before it end there.
    spans: Vec<Present>,
    next_span: i64,
    clock: Clock,
    unsaved_clock: Vec<(i64, i64)>,
    /// Bytes of the batches since they were sorted last, and when that was.
    tail: usize,
    sorted: i64,
    /// Changes that found no room on the disk; `None` while it takes all.
    dropped: Option<u64>,
}

impl Writer {
    /// Opens or makes a record, for a controller whose clock shows `now` while the wall clock shows
    /// `utc`, in us since 1970.
    ///
    /// # Errors
    ///
    /// The file is none of a record, or cannot be written.
    pub fn open(path: &Path, limits: Limits, now: Nanos, utc: i64) -> Result<Writer, StoreError> {
        let file = open(path, KIND, LAYOUTS, Durable::Soon)?;
        // The log beside the file goes back to this size, in bytes.
        file.pragma_update(None, "journal_size_limit", 4 << 20)?;
        let clock = file
            .prepare("SELECT at, utc FROM clock ORDER BY at")?
            .query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?
            .collect::<Result<_, _>>()?;
        let clock = Clock::new(clock);
        let (last, spans): (Option<i64>, i64) =
            file.query_row("SELECT max(stop), coalesce(max(id), 0) FROM span", (), |row| {
                Ok((row.get(0)?, row.get(1)?))
            })?;
        let start = match last {
            None => 0,
            Some(last) => last.saturating_add(utc.saturating_sub(clock.utc(last)).clamp(1, PAUSE)),
        };
        let (slots, names) = signals(&file)?;
        let mut writer = Writer {
            file,
            limits,
            base: start.saturating_sub(micros(now)),
            now: start,
            slots,
            names,
            table: Vec::new(),
            spans: Vec::new(),
            next_span: spans + 1,
            clock,
            unsaved_clock: Vec::new(),
            tail: 0,
            sorted: start,
            dropped: None,
        };
        // The batches that a crash has left.
        writer.sort_tail()?;
        writer.clock(now, utc);
        Ok(writer)
    }

    /// The time of the record at a time of the controller; it never goes back.
    fn at(&mut self, at: Nanos) -> i64 {
        self.now = self.now.max(micros(at).saturating_add(self.base));
        self.now
    }

    /// Notes what the wall clock shows, in us since 1970.
    pub fn clock(&mut self, at: Nanos, utc: i64) {
        // Notes of an earlier time may still come.
        let at = micros(at).saturating_add(self.base);
        if self.clock.parts(at, utc) {
            self.clock.add(at, utc);
            self.unsaved_clock.push((at, utc));
        }
    }

    /// From here on there are these signals, and so many changes before were lost. The values of all of
    /// them follow, at the same time.
    pub fn begin(&mut self, at: Nanos, signals: &[Signal], lost: u64) {
        self.table = signals.iter().map(|signal| self.slot(signal)).collect();
        self.begin_again(at, lost);
    }

    /// The same with the signals that there are.
    pub fn begin_again(&mut self, at: Nanos, lost: u64) {
        let at = self.at(at);
        match &mut self.dropped {
            // The span begins when the disk takes it.
            Some(dropped) => *dropped += lost,
            None => self.begin_span(at, lost),
        }
    }

    fn slot(&mut self, signal: &Signal) -> i64 {
        let next = self.slots.last_key_value().map_or(1, |(id, _)| id + 1);
        let key = (signal.name.clone(), kind_word(signal.kind));
        let id = *self.names.entry(key).or_insert(next);
        self.slots.entry(id).or_insert_with(|| Slot::new(signal.kind, Some(signal.clone())));
        id
    }

    fn begin_span(&mut self, at: i64, lost: u64) {
        // Another table in the same run leaves no gap.
        if let Some(last) = self.spans.last_mut().filter(|_| lost == 0) {
            last.stop = at;
        }
        self.spans.push(Present { id: self.next_span, start: at, stop: at, lost, saved: false });
        self.next_span += 1;
    }

    /// A signal of the present table has another value.
    pub fn change(&mut self, at: Nanos, signal: u32, word: u64) {
        let at = self.at(at);
        let Some(slot) = self.table.get(signal as usize).and_then(|id| self.slots.get_mut(id)) else {
            return;
        };
        slot.word = word;
        if let Some(dropped) = &mut self.dropped {
            *dropped += 1;
            return;
        }
        slot.fresh.push(at, word);
        slot.sort_in(at, word);
        self.reach(at);
    }

    /// Until here nothing else has changed.
    pub fn alive(&mut self, at: Nanos) {
        let at = self.at(at);
        if self.dropped.is_none() {
            self.reach(at);
        }
    }

    fn reach(&mut self, at: i64) {
        if let Some(span) = self.spans.last_mut() {
            span.stop = at;
        }
    }

    /// Hands all that is not yet written to the disk. Returns the number of changes that were lost for
    /// want of room before this call succeeded.
    ///
    /// # Errors
    ///
    /// The disk takes nothing; a later call tries again.
    pub fn commit(&mut self) -> Result<u64, StoreError> {
        if let Some(lost) = self.dropped {
            self.sort_tail()?;
            self.dropped = None;
            let (at, table) = (self.now, self.table.clone());
            self.begin_span(at, lost.max(1));
            for id in &table {
                if let Some(slot) = self.slots.get_mut(id) {
                    slot.fresh.push(at, slot.word);
                    slot.sort_in(at, slot.word);
                }
            }
            self.write().inspect_err(|_| self.drop_waiting(lost))?;
            return Ok(lost);
        }
        let done = self.write();
        if done.is_err() && self.slots.values().map(|slot| slot.fresh.data.len()).sum::<usize>() > WAITING {
            let waiting = self.slots.values().map(|slot| slot.fresh.count as u64).sum();
            self.drop_waiting(waiting);
        }
        done.map(|()| 0)
    }

    /// Gives up what the disk has not taken.
    fn drop_waiting(&mut self, lost: u64) {
        self.dropped = Some(lost);
        self.slots.values_mut().for_each(Slot::forget);
        self.spans.retain(|span| span.saved);
        if let Some(id) = self.spans.last().map(|span| span.id) {
            let stop = self.file.query_row("SELECT stop FROM span WHERE id = ?1", [id], |row| row.get(0));
            // A value that is not known for certain ends where it began.
            let end = |span: &Present| stop.unwrap_or(span.start);
            if let Some(last) = self.spans.last_mut() {
                last.stop = end(last);
            }
        }
    }

    /// Writes what is waiting: as a batch, or sorted by signal.
    fn write(&mut self) -> Result<(), StoreError> {
        let sorts = self.tail > SORTED_AT || self.now.saturating_sub(self.sorted) > SORTED_EACH;
        let step = self.file.transaction()?;
        save_signals(&step, &self.slots)?;
        for span in &self.spans {
            step.prepare_cached(
                "INSERT INTO span VALUES (?1, ?2, ?3, ?4) ON CONFLICT (id) DO UPDATE SET stop = ?3",
            )?
            .execute(params![span.id, span.start, span.stop, span.lost.cast_signed()])?;
        }
        for (at, utc) in &self.unsaved_clock {
            step.execute("INSERT OR REPLACE INTO clock VALUES (?1, ?2)", params![at, utc])?;
        }
        let mut batch = Vec::new();
        if sorts {
            save_chunks(&step, &self.slots)?;
            step.execute("DELETE FROM tail", ())?;
            prune(&step, self.limits, self.now)?;
        } else {
            let fresh = self.slots.iter().filter(|(_, slot)| slot.fresh.count > 0);
            fresh.for_each(|(id, slot)| put_batch(&mut batch, *id, &slot.fresh));
            if !batch.is_empty() {
                step.prepare_cached("INSERT INTO tail (data) VALUES (?1)")?.execute([&batch])?;
            }
        }
        step.commit()?;
        for slot in self.slots.values_mut() {
            slot.unsaved = None;
            slot.fresh = Packed::new(slot.kind);
            if sorts {
                slot.forget();
            }
        }
        self.unsaved_clock.clear();
        let present = self.spans.pop();
        self.spans.clear();
        self.spans.extend(present.map(|span| Present { saved: true, ..span }));
        self.tail += batch.len();
        if sorts {
            (self.tail, self.sorted) = (0, self.now);
        }
        Ok(())
    }

    /// Sorts the batches of the file into chunks; nothing of them is in memory.
    fn sort_tail(&mut self) -> Result<(), StoreError> {
        let batches: Vec<Vec<u8>> = self
            .file
            .prepare("SELECT data FROM tail ORDER BY id")?
            .query_map((), |row| row.get(0))?
            .collect::<Result<_, _>>()?;
        for batch in &batches {
            let mut rest = batch.as_slice();
            while let Some((id, start, data)) = take_batch(&mut rest) {
                if let Some(slot) = self.slots.get_mut(&id) {
                    Changes::new(slot.kind, start, data).for_each(|(at, word)| slot.sort_in(at, word));
                }
            }
        }
        let step = self.file.transaction()?;
        let saved = save_chunks(&step, &self.slots).and_then(|()| {
            step.execute("DELETE FROM tail", ())?;
            Ok(step.commit()?)
        });
        self.slots.values_mut().for_each(Slot::forget);
        saved?;
        (self.tail, self.sorted) = (0, self.now);
        Ok(())
    }

    /// A disk with room for so many pages.
    #[cfg(test)]
    pub(super) fn limit_pages(&self, pages: i64) {
        self.file.pragma_update(None, "max_page_count", pages).expect("a limit");
    }

    /// Sorts all there is into chunks and ends the record.
    ///
    /// # Errors
    ///
    /// The disk takes nothing: what was committed before is there all the same.
    pub fn close(mut self) -> Result<(), StoreError> {
        self.sorted = i64::MIN;
        self.commit()?;
        Ok(())
    }
}

fn micros(time: Nanos) -> i64 {
    time.count().div_euclid(1000)
}

/// The signals of a file, with the ids of their names.
type Known = (BTreeMap<i64, Slot>, BTreeMap<(String, String), i64>);

fn signals(file: &Connection) -> Result<Known, StoreError> {
    let (mut slots, mut names) = (BTreeMap::new(), BTreeMap::new());
    let mut rows = file.prepare("SELECT id, name, kind FROM signal")?;
    let rows = rows.query_map((), |row| Ok((row.get(0)?, row.get(1)?, row.get::<_, String>(2)?)))?;
    for row in rows {
        let (id, name, kind): (i64, String, String) = row?;
        if let Some(read) = kind_of(&kind) {
            slots.insert(id, Slot::new(read, None));
            names.insert((name, kind), id);
        }
    }
    Ok((slots, names))
}

fn save_signals(step: &Transaction<'_>, slots: &BTreeMap<i64, Slot>) -> Result<(), StoreError> {
    for (id, signal) in slots.iter().filter_map(|(id, slot)| Some((id, slot.unsaved.as_ref()?))) {
        let Signal { name, kind, class, ty, comment } = signal;
        step.prepare_cached("INSERT OR REPLACE INTO signal VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(params![id, name, kind_word(*kind), class, ty, comment])?;
    }
    Ok(())
}

fn save_chunks(step: &Transaction<'_>, slots: &BTreeMap<i64, Slot>) -> Result<(), StoreError> {
    let mut insert = step.prepare_cached(
        "INSERT INTO chunk (signal, start, stop, count, low, high, last, data)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    )?;
    for (id, slot) in slots {
        for packed in slot.full.iter().chain([&slot.open]).filter(|packed| packed.count > 0) {
            let Packed { start, stop, count, last, range, data, .. } = packed;
            let (low, high) = (range.map(|r| r.0), range.map(|r| r.1));
            insert.execute(params![id, start, stop, *count as i64, low, high, last.cast_signed(), data])?;
        }
    }
    Ok(())
}
