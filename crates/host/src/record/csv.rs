//! Writes a recording as comma-separated values (RFC 4180).

use std::io::{self, Write};

use g7_model::Nanos;

use super::{Kind, Recording, Value};

/// Writes one row for each instant at which a signal changed, with the values of all signals.
///
/// The first column is the time in seconds. BOOL is 0 or 1, TIME is in seconds, a date or a time of day is text: `2026-11-28`.
///
/// # Errors
///
/// The writer fails.
pub fn write_csv(recording: &Recording, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "time")?;
    for signal in recording.signals() {
        write!(out, ",{}", csv_quote(&signal.name))?;
    }
    writeln!(out)?;
    let mut instants = recording.instants();
    if instants.last().is_some_and(|last| *last < recording.end()) {
        instants.push(recording.end()); // the last row shows how long the recording lasted
    }
    for instant in instants {
        write!(out, "{}", instant.in_seconds())?;
        for (i, signal) in recording.signals().iter().enumerate() {
            let value = recording.value_at(i, instant);
            write!(out, ",{}", value.map_or_else(String::new, |v| csv_cell(&v, signal.kind)))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A value as a cell: BOOL is 0 or 1, TIME is in seconds, a date or a time of day is text: `2026-11-28`.
pub fn csv_cell(value: &Value, kind: Kind) -> String {
    match kind {
        Kind::Bool => value.word().to_string(),
        Kind::Time => Nanos::new(value.word() as i64).in_seconds(),
        Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Moment(_) | Kind::Text => {
            csv_quote(&value.show(kind))
        }
    }
}

/// A text as a cell, in quotes where it needs them.
pub fn csv_quote(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) || text.starts_with(' ') || text.ends_with(' ') {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sample, Signal, write_text};

    #[test]
    fn rows_at_changes_with_quoting() {
        let mut r = Recording::new(vec![
            Signal { group: "inputs", name: "a".into(), kind: Kind::Bool },
            Signal { group: "variables", name: "say, \"it\"".into(), kind: Kind::Text },
            Signal { group: "variables", name: "t".into(), kind: Kind::Time },
        ]);
        let (x, y) = (write_text("x", 3), write_text("y,\"z\"", 3));
        r.sample(Nanos::new(0), [Sample::Word(0), Sample::Text(&x), Sample::Word(0)]);
        r.sample(Nanos::new(10_000_000), [Sample::Word(1), Sample::Text(&y), Sample::Word(1_500_000_000)]);
        r.sample(Nanos::new(20_000_000), [Sample::Word(1), Sample::Text(&y), Sample::Word(1_500_000_000)]);
        let mut out = Vec::new();
        write_csv(&r, &mut out).unwrap();
        let expected = "time,a,\"say, \"\"it\"\"\",t\n0,0,x,0\n0.01,1,\"y,\"\"z\"\"\",1.5\n\
                        0.02,1,\"y,\"\"z\"\"\",1.5\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }
}
