//! `g7 log`: the log of a controller, shown, exported and proved. Another program may be writing it.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use g7_host::{utc_of, utc_text};
use g7_store::log::{Broken, Checked, Filter, Mark, Reader, Row};
use serde_json::{Value, json};

use g7_model::say;

use crate::failure::{Failure, Verdict, raw};
use crate::message::{talk, tell};
use crate::wiring;

#[derive(Args, Debug)]
#[command(
    name = "log",
    after_help = "\
Examples:
  g7 log sorter.log                    all rows, the oldest first
  g7 log sorter.g7 --last 20           the log that sorter.io.toml names
  g7 log sorter.log --level alarm --from 2026-11-24 --until '2026-11-25 06:00'
  g7 log sorter.log --level deed --text ana --format csv > deeds.csv
  g7 log sorter.log --check            each row fits the one before
  g7 log sorter.log --check --known 41:9f2c…   and row 41 is still the one of then

Times are in UTC. Keep the mark that a start or --check prints somewhere else: the chain
alone finds rows that are changed, removed or put in, and the mark finds also that the
newest were cut off, or all of it was made anew.

Exit codes:
  0  fine
  1  a row does not fit
  2  bad usage, or something outside the log: no such file"
)]
pub(crate) struct Journal {
    /// The log, or a chart whose io file names it.
    file: PathBuf,
    /// Rows from this time on.
    #[arg(long, value_name = "TIME", value_parser = utc_of)]
    from: Option<u64>,
    /// Rows before this time.
    #[arg(long, value_name = "TIME", value_parser = utc_of)]
    until: Option<u64>,
    /// Rows of this level: note, warning, alarm, deed (several times for more).
    #[arg(long = "level", value_name = "LEVEL", value_parser = ["note", "warning", "alarm", "deed"])]
    levels: Vec<String>,
    /// Rows with this text.
    #[arg(long, value_name = "TEXT", default_value = "")]
    text: String,
    /// The newest so many of these rows.
    #[arg(long, value_name = "NUMBER")]
    last: Option<usize>,
    /// For people, for a spreadsheet, or one JSON object a line.
    #[arg(long, value_enum, default_value_t = Form::Text)]
    format: Form,
    /// Prove that no row was changed, removed or put in.
    #[arg(long)]
    check: bool,
    /// With --check: a mark that was kept elsewhere.
    #[arg(long, value_name = "NUMBER:HASH", requires = "check")]
    known: Option<Mark>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    Text,
    Csv,
    Jsonl,
}

pub(crate) fn journal(args: &Journal) -> Result<Verdict, Failure> {
    let path = path(&args.file)?;
    let failed = |e| Failure::Usage(say!("cannot read {} as a log: {e}", raw(path.display()), e = raw(&e)));
    if !path.is_file() {
        return Err(Failure::Read(path, std::io::ErrorKind::NotFound.into()));
    }
    let reader = Reader::open(&path).map_err(failed)?;
    if args.check {
        let checked = reader.check(args.known).map_err(failed)?;
        return told(&path, checked);
    }
    let filter = Filter {
        from: args.from,
        until: args.until,
        levels: args.levels.clone(),
        text: args.text.clone(),
        before: None,
    };
    let mut out = anstream::stdout().lock();
    if args.format == Form::Csv {
        writeln!(out, "n,time,controller_s,level,kind,who,from,data,hash")?;
    }
    let mut written = Ok(());
    match args.last {
        Some(last) => {
            let rows = reader.rows(&filter, last).map_err(failed)?;
            written = rows.iter().rev().try_for_each(|row| put(&mut out, args.format, row));
        }
        None => {
            let take = |row: Row| {
                written = put(&mut out, args.format, &row);
                written.is_ok()
            };
            reader.each(&filter, take).map_err(failed)?;
        }
    }
    written?;
    out.flush()?;
    Ok(Verdict::Fine)
}

/// The log: named, or by a chart or its io file.
fn path(file: &Path) -> Result<PathBuf, Failure> {
    let ends = |end: &str| file.extension().is_some_and(|e| e == end);
    if !ends("g7") && !ends("toml") {
        return Ok(file.to_path_buf());
    }
    let io = if ends("g7") { wiring::io_file(file, None) } else { file.to_path_buf() };
    match wiring::settings(&io).controller.log {
        Some(log) => Ok(io.with_file_name(&log.file.value)),
        None => Err(Failure::Usage(say!(
            "{} names no log: write `log = \"machine.log\"` in its [controller]",
            raw(io.display())
        ))),
    }
}

fn told(path: &Path, checked: Result<Checked, Broken>) -> Result<Verdict, Failure> {
    match checked {
        Ok(Checked { rows, gone, newest }) => {
            let name = raw(path.display());
            tell(match gone {
                0 => say!("{name}: {rows} rows, each fits"),
                _ => say!("{name}: {rows} rows, each fits, behind {gone} that were too old to be kept"),
            });
            let mut out = anstream::stdout();
            writeln!(out, "{newest}")?;
            out.flush()?;
            Ok(Verdict::Fine)
        }
        Err(broken) => {
            talk!("{}: {broken}", path.display());
            Ok(Verdict::Found)
        }
    }
}

fn put(out: &mut impl std::io::Write, form: Form, row: &Row) -> std::io::Result<()> {
    let Row { n, entry, hash } = row;
    let time = utc_text(entry.wall);
    let at = entry.at.map(|at| format!("{:.3}", at as f64 / 1e9)).unwrap_or_default();
    match form {
        Form::Text => {
            let by = match (entry.who.as_str(), entry.from.as_str()) {
                ("", "") => String::new(),
                ("", from) => format!(" [{from}]"),
                (who, from) => format!(" [{who} at {from}]"),
            };
            writeln!(out, "{n:>7} {time} {:<7} {}{by} {}", entry.level, plain(&entry.kind), said(&entry.data))
        }
        Form::Csv => {
            let hash = hash.to_string();
            let cells = [&time, &at, &entry.level, &entry.kind, &entry.who, &entry.from, &entry.data, &hash];
            let cells: Vec<String> = cells.iter().map(|cell| quoted(cell)).collect();
            writeln!(out, "{n},{}", cells.join(","))
        }
        Form::Jsonl => {
            let data: Value = serde_json::from_str(&entry.data).unwrap_or_else(|_| json!(entry.data));
            let row = json!({
                "n": n,
                "time": time,
                "wall_ms": entry.wall,
                "controller_ns": entry.at,
                "level": entry.level,
                "kind": entry.kind,
                "who": entry.who,
                "from": entry.from,
                "data": data,
                "hash": hash.to_string(),
            });
            writeln!(out, "{row}")
        }
    }
}

/// A cell of CSV (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The sentence of an event, or its data.
fn said(data: &str) -> String {
    let read: Value = serde_json::from_str(data).unwrap_or(Value::Null);
    let text = read.get("text").and_then(Value::as_str);
    plain(text.unwrap_or(if data == "{}" { "" } else { data }))
}

/// A text on one line that commands no terminal.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
