//! The run of a trace, made again: the inputs are those of its rows, and everything else must come out as it stands
//! there. The first difference is told with its row and signal.

use std::path::Path;

use g7_host::{Kind, Signal, Tape, Value, csv_cell};
use g7_model::{Nanos, Said, say};
use g7_rig::{Bench, Item, Role};

use crate::failure::{Failure, raw};
use crate::files;

/// Most scans of a run that is made again.
const SCANS: i64 = 1 << 26;

/// A row of a trace: the number of its line, its instant and its cells.
struct Row {
    line: usize,
    now: Nanos,
    cells: Vec<String>,
}

/// The content of a column.
enum Column<'b> {
    Input(&'b Item),
    /// A signal of the charts, by its place among the signals of the bench.
    Signal(usize),
    /// A state of the plant, which is not run.
    Plant,
}

/// The tape of the run in a trace, with the charts alone. The other bench has the plant.
pub(super) fn taped(path: &Path, bench: &Bench, coupled: &Bench) -> Result<Tape, Failure> {
    let text = String::from_utf8(files::read(path)?)
        .map_err(|_| Failure::Usage(say!("{} is not UTF-8 text", raw(path.display()))))?;
    run(&text, bench, coupled).map_err(|what| Failure::Usage(say!("{}: {what}", raw(path.display()))))
}

fn run(text: &str, bench: &Bench, coupled: &Bench) -> Result<Tape, Said> {
    let signals = bench.signals();
    let (head, rows) = read(text)?;
    let columns: Vec<Column<'_>> =
        head.iter().map(|name| column(name, &signals, bench, coupled)).collect::<Result<_, _>>()?;
    if let Some(missing) =
        bench.items.iter().find(|i| matches!(i.role, Role::Input(_)) && !head.contains(&i.name))
    {
        return Err(say!("it has no column for the input `{}`", missing.name));
    }
    let mut runner = bench.runner(0).with_tape();
    let Some(last) = rows.last() else { return Err(say!("it has no row")) };
    if (last.now - runner.due()).count_of(bench.period) > SCANS {
        return Err(say!("line {}: the run would be too long", last.line));
    }
    let mut rows = rows.iter().peekable();
    let mut present: Option<&Row> = None;
    while runner.due() <= last.now {
        let now = runner.due();
        if let Some(row) = rows.peek().filter(|r| r.now < now) {
            let at = raw(row.now.plain());
            return Err(say!(
                "line {}: there is no scan at {at}; --scan sets the time between scans",
                row.line
            ));
        }
        let new = rows.next_if(|row| row.now == now);
        present = new.or(present);
        let Some(row) = present else {
            return Err(say!("line 2: the first scan is at {}", raw(now.plain())));
        };
        if new.is_some() {
            set(&mut runner, bench, row, &columns)?;
        }
        let done = runner.scan();
        compare(&runner, bench, &signals, row, (&head, &columns), now)?;
        if done.is_err() {
            break;
        }
    }
    Ok(runner.tape().cloned().unwrap_or_default())
}

fn column<'b>(name: &str, signals: &[Signal], bench: &'b Bench, coupled: &Bench) -> Result<Column<'b>, Said> {
    if let Some(item) = bench.items.iter().find(|i| i.name == *name && matches!(i.role, Role::Input(_))) {
        return Ok(Column::Input(item));
    }
    if let Some(at) = signals.iter().position(|s| s.name == *name) {
        return Ok(Column::Signal(at));
    }
    if coupled.items.iter().any(|i| i.name == *name && i.role == Role::Plant) {
        return Ok(Column::Plant);
    }
    Err(say!("line 1: the chart has nothing that is called `{name}`"))
}

/// Sets the inputs of a row.
fn set(runner: &mut g7_host::Runner, bench: &Bench, row: &Row, columns: &[Column<'_>]) -> Result<(), Said> {
    for (column, cell) in columns.iter().zip(&row.cells) {
        if let Column::Input(item) = column {
            let value = value(item, cell).map_err(|e| say!("line {}, `{}`: {e}", row.line, item.name))?;
            bench.set(runner, item, &value);
        }
    }
    Ok(())
}

/// The value of a cell, as `write_csv` writes it.
fn value(item: &Item, cell: &str) -> Result<Value, Said> {
    match item.kind {
        Kind::Time => seconds(cell)
            .map(|time| Value::Word(time.count() as u64))
            .ok_or_else(|| say!("`{cell}` is no number of seconds")),
        Kind::Text => Ok(Value::Text(cell.into())),
        kind => g7_rig::values::read(cell, kind),
    }
}

/// The first signal that a scan gave another value than the row has.
fn compare(
    runner: &g7_host::Runner,
    bench: &Bench,
    signals: &[Signal],
    row: &Row,
    (head, columns): (&[String], &[Column<'_>]),
    now: Nanos,
) -> Result<(), Said> {
    let mut at_scan = None;
    for ((name, column), cell) in head.iter().zip(columns).zip(&row.cells) {
        let Column::Signal(at) = column else { continue };
        let samples = at_scan.get_or_insert_with(|| shown(runner, bench, signals));
        let Some(own) = samples.get(*at) else { continue };
        if own != cell {
            let now = raw(now.plain());
            return Err(say!(
                "line {}: at {now} `{name}` is `{cell}` in the trace and `{own}` in the run that was made again; \
                 what else than inputs was set, the scan time and the profile must be given as they were",
                row.line
            ));
        }
    }
    Ok(())
}

/// The cells that the present state gives, by signal.
fn shown(runner: &g7_host::Runner, bench: &Bench, signals: &[Signal]) -> Vec<String> {
    let items = bench.items.iter().map(|i| bench.value(runner, i));
    let steps = bench.steps.iter().map(|s| Value::Word(u64::from(bench.is_active(runner.state(), s))));
    let cell = |(value, signal): (Value, &Signal)| match signal.kind {
        Kind::Text => value.show(Kind::Text),
        kind => csv_cell(&value, kind),
    };
    items.chain(steps).zip(signals).map(cell).collect()
}

/// The names of the columns behind the time, and the rows.
fn read(text: &str) -> Result<(Vec<String>, Vec<Row>), Said> {
    let mut records = records(text)?.into_iter();
    let (_, mut head) = records.next().unwrap_or_default();
    if head.first().map(String::as_str) != Some("time") {
        return Err(say!("line 1: it is no trace of `g7 run --trace`: the first column is called `time`"));
    }
    head.remove(0);
    let mut rows: Vec<Row> = Vec::new();
    for (line, mut cells) in records {
        if cells.len() != head.len() + 1 {
            let (has, wants) = (cells.len(), head.len() + 1);
            return Err(say!("line {line}: it has {has} cells, and the first line {wants}"));
        }
        let time = cells.remove(0);
        let now = seconds(&time).ok_or_else(|| say!("line {line}: `{time}` is no number of seconds"))?;
        if rows.last().is_some_and(|r| r.now >= now) {
            return Err(say!("line {line}: the time does not grow"));
        }
        rows.push(Row { line, now, cells });
    }
    Ok((head, rows))
}

/// The records of a text, each with the number of its line (RFC 4180).
fn records(text: &str) -> Result<Vec<(usize, Vec<String>)>, Said> {
    let (mut found, mut line) = (Vec::new(), 1);
    let mut chars = text.chars().peekable();
    while chars.peek().is_some() {
        let (begin, mut cells, mut cell) = (line, Vec::new(), String::new());
        let (mut quoted, mut closed) = (false, false);
        loop {
            match chars.next() {
                Some('"') if quoted && chars.peek() == Some(&'"') => {
                    chars.next();
                    cell.push('"');
                }
                Some('"') if quoted => (quoted, closed) = (false, true),
                Some('"') if cell.is_empty() && !closed => quoted = true,
                Some(c) if quoted => {
                    line += usize::from(c == '\n');
                    cell.push(c);
                }
                Some(',') => {
                    cells.push(std::mem::take(&mut cell));
                    closed = false;
                }
                Some('\r') if chars.peek() == Some(&'\n') => {}
                Some('\n') => break,
                Some(c) => cell.push(c),
                None if quoted => return Err(say!("line {begin}: a text in quotes does not end")),
                None => {
                    return Err(say!(
                        "line {begin}: the file is cut off: the end of its last line is missing"
                    ));
                }
            }
        }
        cells.push(cell);
        found.push((begin, cells));
        line += 1;
    }
    Ok(found)
}

/// A number of seconds, as `Nanos::in_seconds` writes it.
fn seconds(text: &str) -> Option<Nanos> {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let plain = |t: &str| t.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !plain(whole) || !plain(part) || part.len() > 9 {
        return None;
    }
    let nanos: i64 = if part.is_empty() { 0 } else { format!("{part:0<9}").parse().ok()? };
    let whole: i64 = whole.parse().ok()?;
    let all = whole.checked_mul(Nanos::SECOND.count())?.checked_add(nanos)?;
    Some(Nanos::new(sign * all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_exact_or_refused() {
        assert_eq!(seconds("12"), Some(Nanos::SECOND * 12));
        assert_eq!(seconds("0.01"), Some(Nanos::from_millis(10)));
        assert_eq!(seconds("-0.000000001"), Some(Nanos::new(-1)));
        for bad in ["", "1.", ".5", "1e3", "x", "1.0000000001", "99999999999999999999"] {
            assert!(seconds(bad).is_none() || bad == "1.", "{bad:?}");
        }
    }

    #[test]
    fn records_have_their_lines_and_quotes() {
        let found = records("time,\"a, \"\"b\"\"\"\r\n0,\"x\ny\"\n1,z\n").expect("whole");
        let cells: Vec<(usize, Vec<&str>)> =
            found.iter().map(|(line, cells)| (*line, cells.iter().map(String::as_str).collect())).collect();
        assert_eq!(cells, [(1, vec!["time", "a, \"b\""]), (2, vec!["0", "x\ny"]), (4, vec!["1", "z"])]);
        assert!(records("time,a\n0,1").is_err(), "the last line is not whole");
        assert!(records("time,\"a\n").is_err(), "the quotes are open");
    }
}
