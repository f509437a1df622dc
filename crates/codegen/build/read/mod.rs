//! The runtime as data: text of Rust for `src/runtime.rs`.

mod c;
mod chart;
mod helpers;
mod rust;
mod tree;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use g7_runtime::source::{File, Source};

use chart::Chart;
use helpers::Helper;

/// A mistake in the runtime, with its file.
pub(crate) type Result<T> = std::result::Result<T, String>;

/// The error of a file of the runtime.
pub(crate) fn wrong<T>(file: &File, why: impl std::fmt::Display) -> Result<T> {
    Err(format!("crates/runtime/{}: {why}", file.path))
}

/// All that is written down.
pub(crate) fn runtime(source: &Source) -> Result<String> {
    let chart = Chart::read(&source.chart)?;
    let rust = rust::helpers(source.rust)?;
    let c = c::helpers(source.c)?;
    helpers::hold_the_same(&rust, &c)?;
    let mut evolution = tree::Reader::default();
    for file in source.evolution {
        evolution.file(file, &chart, true)?;
    }
    evolution.offers(source.offered)?;
    evolution.file(&source.function_blocks, &chart, false)?;
    let mut flat = tree::Reader::default();
    for file in source.flat {
        flat.file(file, &chart, true)?;
    }
    flat.offers(source.offered)?;
    every_name_is_there(source, &[&evolution, &flat], &chart, &rust)?;
    let mut out = chart.facts();
    let _ = writeln!(out, "{}", tree::faults(&source.faults)?);
    let _ = writeln!(out, "{}", evolution.text("", "the runtime"));
    let _ = writeln!(out, "{}", flat.text("FLAT_", "the frame of equations"));
    let _ = writeln!(out, "{}", helpers::text("RUST", &rust));
    let _ = writeln!(out, "{}", helpers::text("C", &c));
    Ok(out)
}

/// The names of one kind that a style uses.
type Used = fn(&tree::Reader) -> &BTreeSet<String>;

/// Every function that is called and every table that is read is there, and every fact
/// and every function of a chart is used.
fn every_name_is_there(
    source: &Source,
    styles: &[&tree::Reader],
    chart: &Chart,
    rust: &[Helper],
) -> Result<()> {
    for style in styles {
        let known = |name: &str| {
            style.functions.contains(name)
                || chart.functions.contains(name)
                || rust.iter().any(|h| h.offered && h.name == name)
        };
        let missing: Vec<&str> = style.calls.iter().map(String::as_str).filter(|f| !known(f)).collect();
        if !missing.is_empty() {
            return Err(format!("crates/runtime: functions that are called and not there: {missing:?}"));
        }
    }
    let unused = |all: &BTreeSet<String>, used: Used| -> Vec<String> {
        let is_used = |name: &&String| styles.iter().any(|s| used(s).contains(*name));
        all.iter().filter(|name| !is_used(name)).cloned().collect()
    };
    let kinds: [(&str, &BTreeSet<String>, Used); 3] = [
        ("facts", &chart.facts, |s| &s.facts),
        ("tables", &chart.tables, |s| &s.names),
        ("functions", &chart.functions, |s| &s.calls),
    ];
    for (what, all, used) in kinds {
        let unused = unused(all, used);
        if !unused.is_empty() {
            return wrong(&source.chart, format!("{what} that the runtime does not use: {unused:?}"));
        }
    }
    Ok(())
}
