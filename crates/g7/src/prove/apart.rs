//! `g7 compare`: equal for every sequence of inputs, or a shortest sequence that tells two
//! charts apart, with both chronograms in one.

use std::io::Write;

use g7_model::ProfileName;
use g7_rig::Source;
use g7_verify::{Budget, Compare, Difference, Equality};

use super::trace::Drawer;
use crate::cli;
use crate::failure::{self, Failure};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::{sources, style};

/// A chart of a comparison.
struct Side {
    name: String,
    source: Source,
    profile: Option<ProfileName>,
}

pub(crate) fn compare(args: &cli::Compare) -> Result<failure::Verdict, Failure> {
    beside(&sides(args)?, args)
}

/// Compares the outputs of a chart with those of the same chart in another form, as `g7 compare` does.
pub(crate) fn read_back(before: Source, after: Source) -> Result<failure::Verdict, Failure> {
    let side = |source: Source| Side { name: source.name.clone(), source, profile: None };
    beside(&[side(before), side(after)], &cli::Compare::of_outputs())
}

fn beside(sides: &[Side], args: &cli::Compare) -> Result<failure::Verdict, Failure> {
    let mut compiled = Vec::new();
    for side in sides {
        let (charts, found) = if side.source.has_errors() {
            (None, Vec::new())
        } else {
            g7_verify::ask(&side.source.document, side.profile)
        };
        let problems: Vec<_> = side.source.problems.iter().cloned().chain(found).collect();
        if Tally::of(&problems).errors > 0 {
            talk!("{}", report::text(&side.source, &problems).trim_end());
        }
        compiled.extend(charts);
    }
    let [a, b] = compiled.as_slice() else { return Ok(failure::Verdict::Found) };
    let stop = super::patience::Patience::new()?.within(args.time);
    let bytes = args.memory.saturating_mul(1 << 20);
    let budget = Budget { states: args.states, scans: usize::MAX, bytes, stop: &*stop };
    let what = Compare { charts: [&a.compiled, &b.compiled], situations: args.situations };
    let mut out = anstream::stdout().lock();
    match g7_verify::compare(&what, &budget) {
        Equality::Equal { states, scans } => {
            let what = if args.situations { "outputs and situations" } else { "outputs" };
            writeln!(
                out,
                "{}equal{:#}: the same {what} for every sequence of inputs",
                style::GOOD,
                style::GOOD
            )?;
            writeln!(out, "  all {states} pairs of states were visited by {scans} scans")?;
            Ok(failure::Verdict::Fine)
        }
        Equality::Apart { moves, what } => {
            let mut drawers = Vec::new();
            for side in sides {
                drawers.extend(Drawer::new(&side.source, side.profile)?);
            }
            let both = <[Drawer; 2]>::try_from(drawers).ok();
            let count = moves.first().map_or(0, Vec::len);
            let scans = if count == 1 { "scan" } else { "scans" };
            let what = match what {
                Difference::Output(name) => format!("output `{name}` has two values"),
                Difference::Step(name) => format!("step {name} is active in one of them only"),
                Difference::Fault => "a fault stops one of them only, or each has another".to_owned(),
            };
            writeln!(out, "{}different{:#}: after {count} {scans} {what}", style::BAD, style::BAD)?;
            for (number, (side, moves)) in (1..).zip(sides.iter().zip(&moves)) {
                let drawer = both.as_ref().and_then(|b| b.get(number - 1));
                let fault = drawer.and_then(|d| d.fault(moves)).map(|f| format!(": fault: {f}"));
                writeln!(out, "  {number}: {}{}", side.name, fault.unwrap_or_default())?;
            }
            for line in both.map(|b| Drawer::draw_both(&b, &moves)).unwrap_or_default().lines() {
                writeln!(out, "  {line}")?;
            }
            Ok(failure::Verdict::Found)
        }
        Equality::Open(open) => {
            writeln!(out, "{}not decided{:#}: {}", style::WARN, style::WARN, open.reason)?;
            writeln!(
                out,
                "  equal for all runs of up to {} scans ({} pairs of states)",
                open.scans, open.states
            )?;
            writeln!(out, "  help: {}", open.help)?;
            Ok(failure::Verdict::Open)
        }
        Equality::Unlike(sentence) => {
            Err(Failure::Usage(format!("these charts cannot be compared: {sentence}")))
        }
    }
}

fn sides(args: &cli::Compare) -> Result<Vec<Side>, Failure> {
    let load = |path: &std::path::Path, profile: Option<ProfileName>| -> Result<Side, Failure> {
        let source = sources::load(path, 0)?;
        let name = match profile {
            Some(p) => format!("{} under {}", source.name, p.name()),
            None => source.name.clone(),
        };
        Ok(Side { name, source, profile })
    };
    match (args.files.as_slice(), args.profiles.as_slice()) {
        ([a, b], []) => Ok(vec![load(a, None)?, load(b, None)?]),
        ([a], [p, q]) => Ok(vec![load(a, Some(*p))?, load(a, Some(*q))?]),
        ([a, b], [p, q]) => Ok(vec![load(a, Some(*p))?, load(b, Some(*q))?]),
        _ => Err(Failure::Usage("name two files, or one file with --profiles iec60848,unity".to_owned())),
    }
}
