//! `g7 history`: what a record has, and its values as CSV, VCD or Parquet.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use g7_host::{Kind, Recording, Sample};
use g7_model::{Nanos, say};
use g7_store::history::{Overview, Reader, Signal};

use super::rows::{Broken, Csv, Row, Sink, rows};
use super::time;
use crate::failure::{Failure, Verdict, raw};
use crate::message::told;
use crate::{files, style, values};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 history sorter.history                          its signals, and when it was recorded
  g7 history sorter.history --from 1h --csv -        the last hour, to the standard output
  g7 history sorter.history --from 2026-11-25T06:00 --to 2026-11-25T14:00 --parquet shift.parquet
  g7 history sorter.history --signal start --signal X3 --vcd start.vcd

A controller may be writing the record meanwhile. Times are in UTC; without a date they
are counted back from the end of the record. A row without a value says that nothing is
known from there on: the controller was off, or changes were lost.")]
pub(crate) struct History {
    /// The file that `[history]` of an io file names.
    file: PathBuf,
    /// From this time on: 2026-11-25T10:00, or 1h before the end.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    from: Option<Moment>,
    /// Up to this time.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    to: Option<Moment>,
    /// Only this signal; may be given several times.
    #[arg(long = "signal", value_name = "NAME")]
    signals: Vec<String>,
    /// Write comma-separated values, a row for each change; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a value change dump, for GTKWave.
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    /// Write a file of Parquet, for pandas or DuckDB.
    #[cfg(feature = "parquet")]
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    /// Replace a file that g7 did not write, and any of Parquet; never the history itself.
    #[arg(long)]
    force: bool,
}

/// A time that the user named.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// In us since 1970.
    Utc(i64),
    /// Before the end of the record.
    Back(Nanos),
}

fn moment(text: &str) -> Result<Moment, String> {
    let day = time::read(text).map(Moment::Utc);
    day.or_else(|| values::duration(text).ok().map(Moment::Back))
        .ok_or_else(|| "expected a time as 2026-11-25T10:00 (UTC), or 1h before the end".to_owned())
}

/// Executes the command.
pub(crate) fn history(args: &History) -> Result<Verdict, Failure> {
    let cannot = |e: &dyn std::fmt::Display| {
        Failure::Usage(say!("cannot read {} as a history: {e}", raw(args.file.display()), e = raw(e)))
    };
    if !args.file.is_file() {
        return Err(Failure::Read(args.file.clone(), io::ErrorKind::NotFound.into()));
    }
    let outputs = [args.csv.as_deref().filter(|p| *p != Path::new("-")), args.vcd.as_deref()];
    #[cfg(feature = "parquet")]
    let outputs = outputs.into_iter().chain([args.parquet.as_deref()]);
    outputs.into_iter().try_for_each(|output| files::refuse_foreign(output, &[&args.file], args.force))?;
    let reader = Reader::open(&args.file).map_err(|e| cannot(&e))?;
    let overview = reader.overview().map_err(|e| cannot(&e))?;
    let asked = Asked {
        reader: &reader,
        signals: chosen(&overview, &args.signals)?,
        ranges: ranges(&overview, args),
        overview: &overview,
    };
    let broken = |path: &Path, e: Broken| match e {
        Broken::Record(e) => cannot(&e),
        Broken::Out(e) if path == Path::new("-") => Failure::Output(e),
        Broken::Out(e) => Failure::Write(path.to_path_buf(), e),
    };
    let mut listed = true;
    if let Some(path) = &args.csv {
        listed = false;
        if path == Path::new("-") {
            let out = io::BufWriter::new(io::stdout().lock());
            asked.csv(out).map_err(|e| broken(path, e))?;
        } else {
            files::deliver(Some(path), &asked.csv(Vec::new()).map_err(|e| broken(path, e))?)?;
        }
    }
    if let Some(path) = &args.vcd {
        listed = false;
        let recording = asked.recording().map_err(|e| broken(path, e))?;
        let mut bytes = Vec::new();
        g7_host::write_vcd(&recording, &mut bytes)?;
        files::deliver(Some(path), &bytes)?;
    }
    #[cfg(feature = "parquet")]
    if let Some(path) = &args.parquet {
        listed = false;
        files::deliver(Some(path), &asked.parquet().map_err(|e| broken(path, e))?)?;
    }
    if listed {
        list(&asked)?;
    }
    Ok(Verdict::Fine)
}

/// The part of a record that the user asks for.
struct Asked<'a> {
    reader: &'a Reader,
    overview: &'a Overview,
    signals: Vec<(i64, Signal)>,
    /// Times of the record.
    ranges: Vec<(i64, i64)>,
}

impl Asked<'_> {
    fn rows(&self, sink: &mut impl Sink) -> Result<(), Broken> {
        self.ranges.iter().try_for_each(|range| rows(self.reader, self.overview, &self.signals, *range, sink))
    }

    fn csv<W: Write>(&self, out: W) -> Result<W, Broken> {
        let mut csv = Csv::new(out)?;
        self.rows(&mut csv)?;
        Ok(csv.end()?)
    }

    #[cfg(feature = "parquet")]
    fn parquet(&self) -> Result<Vec<u8>, Broken> {
        let mut file = super::Parquet::new(Vec::new())?;
        self.rows(&mut file)?;
        Ok(file.end()?)
    }

    /// The values with one more signal: 1 while the record has them.
    fn recording(&self) -> Result<Recording, Broken> {
        let own = |(_, signal): &(i64, Signal)| g7_host::Signal {
            group: match signal.class.as_str() {
                "inputs" => "inputs",
                "outputs" => "outputs",
                "steps" => "steps",
                _ => "variables",
            },
            name: signal.name.clone(),
            kind: signal.kind,
        };
        let known = g7_host::Signal { group: "history", name: "recorded".to_owned(), kind: Kind::Bool };
        let signals = [known].into_iter().chain(self.signals.iter().map(own)).collect();
        let words = vec![None; self.signals.len()];
        let mut dump = Dump { recording: Recording::new(signals), words, at: None };
        self.rows(&mut dump)?;
        dump.settle();
        Ok(dump.recording)
    }
}

/// Rows as a recording.
struct Dump {
    recording: Recording,
    /// The present values; a value that is not known keeps the one before.
    words: Vec<Option<(u64, bool)>>,
    at: Option<i64>,
}

impl Dump {
    fn settle(&mut self) {
        let Some(at) = self.at else { return };
        let known = self.words.iter().any(|word| matches!(word, Some((_, true))));
        let words = self.words.iter().map(|word| word.map_or(0, |(word, _)| word));
        let all = [u64::from(known)].into_iter().chain(words).map(Sample::Word);
        self.recording.sample(Nanos::new(at.saturating_mul(1000)), all);
    }
}

impl Sink for Dump {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if self.at != Some(row.at) {
            self.settle();
            self.at = Some(row.at);
        }
        if let Some(word) = self.words.get_mut(row.number) {
            let before = word.map_or(0, |(word, _)| word);
            *word = Some((row.word.unwrap_or(before), row.word.is_some()));
        }
        Ok(())
    }
}

/// The signals that the user named, or all.
fn chosen(overview: &Overview, names: &[String]) -> Result<Vec<(i64, Signal)>, Failure> {
    let mut found = Vec::new();
    for name in names {
        let before = found.len();
        found.extend(overview.named(name).cloned());
        if found.len() == before {
            return Err(Failure::Usage(say!(
                "the record has no signal `{name}`; `g7 history FILE` lists them"
            )));
        }
    }
    Ok(if names.is_empty() { overview.signals.clone() } else { found })
}

/// The times of the record that the user named.
fn ranges(overview: &Overview, args: &History) -> Vec<(i64, i64)> {
    let all = (overview.from, overview.until);
    let utc = |moment: Option<Moment>, other| match moment {
        Some(Moment::Utc(utc)) => utc,
        Some(Moment::Back(_)) | None => other,
    };
    let at = |moment: Option<Moment>, other: i64| match moment {
        Some(Moment::Back(back)) => overview.until.saturating_sub(back.count() / 1000),
        Some(Moment::Utc(_)) | None => other,
    };
    let within = (at(args.from, all.0).max(all.0), at(args.to, all.1).min(all.1));
    match (args.from, args.to) {
        (Some(Moment::Utc(_)), _) | (_, Some(Moment::Utc(_))) => {
            overview.clock.ranges(within, (utc(args.from, i64::MIN), utc(args.to, i64::MAX)))
        }
        _ => vec![within],
    }
}

/// Prints what the record has.
fn list(asked: &Asked<'_>) -> Result<(), Failure> {
    let Asked { overview, signals, .. } = asked;
    let mut out = anstream::stdout().lock();
    let shown = |at| time::show(overview.clock.utc(at));
    let gone = overview.spans.iter().filter(|span| span.lost > 0);
    let lost: u64 = gone.map(|span| span.lost).sum();
    for span in &overview.spans {
        let start = span.start.max(overview.from);
        let long = Nanos::from_millis(span.stop.saturating_sub(start) / 1_000);
        let (start, stop, long) = (raw(shown(start)), raw(shown(span.stop)), raw(long.plain()));
        let of = match span.lost {
            0 => say!("{start} to {stop}  {long}"),
            n => say!("{start} to {stop}  {long}  {n} changes were lost before"),
        };
        writeln!(out, "{}", told(&of))?;
    }
    if lost > 0 {
        writeln!(out, "{}{}{:#}", style::WARN, told(&say!("{lost} changes were lost")), style::WARN)?;
    }
    for (_, Signal { name, class, ty, comment, .. }) in signals {
        let comment = comment.as_ref().map_or_else(String::new, |c| format!("  {c}"));
        writeln!(out, "{class:<9}  {name}  {ty}{comment}")?;
    }
    Ok(out.flush()?)
}
