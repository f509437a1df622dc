//! The table of faults around a controller (the book, "Faults"): how often each was made, what was lost, and
//! how long it took.
//!
//! ```text
//! a test `row_7_...` of any crate -> row() -> its output, and the file that `G7_FAULT_ROWS` names
//!                                              -> the program `faults` -> the table, behind `make faults`
//! ```
//!
//! `make test` makes each fault a few times, `make faults` (`G7_FAULTS`) as often as the table says. It
//! finds the tests by their names, which begin with `row_`.

use std::fmt;
use std::path::Path;
use std::time::Duration;

/// The faults, in the order of the table; the first one has number 1.
pub const FAULTS: [&str; 27] = [
    "kill -9 while retained values are written",
    "power loss",
    "a flipped bit, any length of the retain file",
    "disk full",
    "fsync stalls",
    "wall clock changed",
    "Modbus slave killed, reset",
    "Modbus slave silent",
    "answers later than the time-out",
    "hostile slave",
    "100 slaves, 30 of them dead",
    "hostile masters",
    "OPC UA server killed and started",
    "OPC UA: whom it does not know",
    "MQTT broker killed",
    "MQTT broker away for a day",
    "endless loop or overrun of the chart",
    "panic in scan, device, server",
    "kill -9 of the controller",
    "busy machine, page-cache storm",
    "1000 pages, 200 of them stopped",
    "slow, huge, too many requests",
    "on-line change",
    "guesses, replay, revoked session",
    "audit log changed or not writable",
    "soak",
    "allocation, lock, system call in a scan",
];

/// True where the table is made: each fault many times.
pub fn many() -> bool {
    std::env::var_os("G7_FAULTS").is_some()
}

/// The number of trials: many for the table, few in each test.
pub fn trials(many_times: u32, few: u32) -> u32 {
    if many() { many_times } else { few }
}

/// The times that something took.
#[derive(Clone, Debug, Default)]
pub struct Times(pub Vec<Duration>);

impl Times {
    /// Adds a time.
    pub fn add(&mut self, time: Duration) {
        self.0.push(time);
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut all = self.0.clone();
        all.sort();
        let at = |share: usize| all.get((all.len() * share / 100).min(all.len().saturating_sub(1)));
        let ms = |time: Option<&Duration>| time.map_or(0.0, |t| t.as_secs_f64() * 1e3);
        let digits = usize::from(ms(all.last()) < 10.0);
        let [half, most_of, all] = [at(50), at(99), all.last()].map(ms);
        write!(f, "half {half:.digits$} ms, 99 % {most_of:.digits$} ms, most {all:.digits$} ms")
    }
}

/// Tells what a test of a row found: `part` is empty, or says which part of the row was tried; `held` is a
/// phrase with what held and the times that it took.
///
/// # Panics
///
/// There is no such row, or the file that `G7_FAULT_ROWS` names cannot be written.
pub fn row(number: usize, part: &str, count: u64, lost: u64, held: impl fmt::Display) {
    let row = Row { number, part: part.into(), count, lost, held: held.to_string() };
    println!("{row}");
    if let Some(file) = std::env::var_os("G7_FAULT_ROWS") {
        let line = format!("{number}\t{part}\t{count}\t{lost}\t{held}\n");
        crate::append(Path::new(&file), &line).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    }
}

/// A row as it was told.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    number: usize,
    part: String,
    count: u64,
    lost: u64,
    held: String,
}

impl Row {
    /// Reads what [`row`] wrote.
    fn read(line: &str) -> Option<Row> {
        let mut parts = line.split('\t');
        let mut next = || parts.next();
        let (number, part) = (next()?.parse().ok()?, next()?.to_owned());
        let (count, lost) = (next()?.parse().ok()?, next()?.parse().ok()?);
        Some(Row { number, part, count, lost, held: next()?.to_owned() })
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Row { number, part, count, lost, held } = self;
        let fault = number.checked_sub(1).and_then(|k| FAULTS.get(k)).expect("a row of the table");
        let fault = if part.is_empty() { (*fault).to_owned() } else { format!("{fault}: {part}") };
        write!(f, "row {number:2}  {fault:<52} {count:>9} times, lost {lost}; {held}")
    }
}

/// The whole table of what was told, in its order.
///
/// # Errors
///
/// The table, where something was lost, or where a line is none.
pub fn table(told: &str) -> Result<String, String> {
    let rows: Option<Vec<Row>> = told.lines().map(Row::read).collect();
    let mut rows = rows.ok_or("a line that no row has")?;
    rows.sort_by(|a, b| (a.number, &a.part).cmp(&(b.number, &b.part)));
    let mut text = String::new();
    for (number, fault) in (1..).zip(FAULTS) {
        let own: Vec<String> = rows.iter().filter(|r| r.number == number).map(|r| format!("{r}\n")).collect();
        let none = || format!("row {number:2}  {fault:<52}       not tried\n");
        text += &if own.is_empty() { none() } else { own.concat() };
    }
    let lost: u64 = rows.iter().map(|r| r.lost).sum();
    let tried = (1..=FAULTS.len()).filter(|n| rows.iter().any(|r| r.number == *n)).count();
    text += &format!("{tried} of {} rows were tried; lost: {lost}", FAULTS.len());
    if lost == 0 { Ok(text) } else { Err(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_their_order_and_those_without_a_trial_say_so() {
        let table =
            table("7\tkilled\t200\t0\tback after 3 s\n1\t\t1000\t0\tRUN within 1 s\n").expect("none is lost");
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 28);
        assert!(
            lines[0].starts_with("row  1  kill -9 while")
                && lines[0].ends_with("1000 times, lost 0; RUN within 1 s")
        );
        assert!(lines[1].ends_with("not tried"));
        assert!(lines[6].contains("reset: killed") && lines[6].contains("200 times"));
        assert_eq!(lines[27], "2 of 27 rows were tried; lost: 0");
    }

    #[test]
    fn what_is_lost_is_an_error() {
        assert!(table("1\t\t1000\t3\tx\n").is_err_and(|t| t.ends_with("lost: 3")));
        assert!(table("1\t\tmany\t0\tx\n").is_err());
    }

    #[test]
    fn times_are_told_by_their_shares() {
        let times = Times((1..=200).map(Duration::from_millis).collect());
        assert_eq!(times.to_string(), "half 101 ms, 99 % 199 ms, most 200 ms");
        assert_eq!(Times::default().to_string(), "half 0.0 ms, 99 % 0.0 ms, most 0.0 ms");
    }
}
