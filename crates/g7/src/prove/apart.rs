//! `g7 compare`: equal for every sequence of inputs, or a shortest sequence that tells two
//! charts apart, with both chronograms in one.

use std::io::Write;

use g7_model::{ProfileName, Said, say};
use g7_rig::Source;
use g7_verify::{Budget, Compare, Equality, Unlike, words};

use super::trace::Drawer;
use crate::cli;
use crate::failure::{self, Failure, raw};
use crate::message::{talk, told};
use crate::report::{self, Tally};
use crate::{files, sources, style};

/// A chart of a comparison.
struct Side {
    name: String,
    source: Source,
    profile: Option<ProfileName>,
}

pub(crate) fn compare(args: &cli::Compare) -> Result<failure::Verdict, Failure> {
    let from: Vec<_> = args.files.iter().map(|p| p.as_path()).collect();
    files::refuse_foreign(args.aiger.as_deref(), &from, args.force)?;
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
        let (charts, found) = if side.source.is_broken() {
            (None, Vec::new())
        } else {
            g7_verify::ask(side.source.whole(), side.profile)
        };
        let problems: Vec<_> = side.source.read_problems().into_iter().chain(found).collect();
        if Tally::of(&problems).errors > 0 {
            talk!("{}", report::text(&side.source, &problems).trim_end());
        }
        compiled.extend(charts);
    }
    let [a, b] = compiled.as_slice() else { return Ok(failure::Verdict::Found) };
    let stop = super::patience::Patience::new()?.within(args.time);
    let bytes = args.memory.saturating_mul(1 << 20);
    let budget = Budget { states: args.states, scans: usize::MAX, bytes, stop: &*stop };
    let assume = [a.assume.clone(), b.assume.clone()];
    let assumed = assume.iter().any(|list| !list.is_empty());
    let what = Compare { charts: [&a.compiled, &b.compiled], assume, situations: args.situations };
    if let Some(path) = &args.aiger {
        let system = g7_verify::miter(&what).map_err(|why| unlike(&why))?;
        files::write(path, &system)?;
    }
    let mut out = anstream::stdout().lock();
    match g7_verify::compare(&what, &budget) {
        Equality::Equal(certificate) => {
            let what = if args.situations {
                say!("the same outputs and situations")
            } else {
                say!("the same outputs")
            };
            let of = if assumed {
                say!("{what} for every sequence of inputs that the assumptions of both allow")
            } else {
                say!("{what} for every sequence of inputs")
            };
            writeln!(out, "{}{}{:#}: {}", style::GOOD, told(&say!("equal")), style::GOOD, told(&of))?;
            writeln!(out, "  {}", told(&Said::in_each(words::equal(&certificate))))?;
            Ok(failure::Verdict::Fine)
        }
        Equality::Apart { moves, what } => {
            let mut drawers = Vec::new();
            for side in sides {
                drawers.extend(Drawer::new(&side.source, side.profile)?);
            }
            let both = <[Drawer; 2]>::try_from(drawers).ok();
            let count = moves.first().map_or(0, Vec::len);
            let what = Said::in_each(words::difference(&what));
            let after =
                if count == 1 { say!("after 1 scan {what}") } else { say!("after {count} scans {what}") };
            writeln!(out, "{}{}{:#}: {}", style::BAD, told(&say!("different")), style::BAD, told(&after))?;
            for (number, (side, moves)) in (1..).zip(sides.iter().zip(&moves)) {
                let drawer = both.as_ref().and_then(|b| b.get(number - 1));
                let fault =
                    drawer.and_then(|d| d.fault(moves)).map(|f| format!(": {}", told(&say!("fault: {}", f))));
                writeln!(out, "  {number}: {}{}", side.name, fault.unwrap_or_default())?;
            }
            for line in both.map(|b| Drawer::draw_both(&b, &moves)).unwrap_or_default().lines() {
                writeln!(out, "  {line}")?;
            }
            Ok(failure::Verdict::Found)
        }
        Equality::Open(open) => {
            let why = told(&Said::in_each(words::why(&open.reason)));
            writeln!(out, "{}{}{:#}: {why}", style::WARN, told(&say!("not decided")), style::WARN)?;
            let so_far =
                say!("equal for all runs of up to {} scans ({} pairs of states)", open.scans, open.states);
            writeln!(out, "  {}", told(&so_far))?;
            let help = Said::in_each(words::way_on(&open.reason));
            writeln!(out, "  {}", told(&say!("help: {}", help)))?;
            Ok(failure::Verdict::Open)
        }
        Equality::Unlike(why) => Err(unlike(&why)),
    }
}

fn unlike(why: &Unlike) -> Failure {
    Failure::Usage(say!(
        "these charts cannot be compared: {sentence}",
        sentence = Said::in_each(words::unlike(why))
    ))
}

fn sides(args: &cli::Compare) -> Result<Vec<Side>, Failure> {
    let load = |path: &std::path::Path, profile: Option<ProfileName>| -> Result<Side, Failure> {
        let source = sources::load(path, 0)?;
        let name = match profile {
            Some(p) => told(&say!("{} under {p}", raw(&source.name))),
            None => source.name.clone(),
        };
        Ok(Side { name, source, profile })
    };
    match (args.files.as_slice(), args.profiles.as_slice()) {
        ([a, b], []) => Ok(vec![load(a, None)?, load(b, None)?]),
        ([a], [p, q]) => Ok(vec![load(a, Some(*p))?, load(a, Some(*q))?]),
        ([a, b], [p, q]) => Ok(vec![load(a, Some(*p))?, load(b, Some(*q))?]),
        _ => Err(Failure::Usage(say!("name two files, or one file with --profiles iec60848,unity"))),
    }
}
