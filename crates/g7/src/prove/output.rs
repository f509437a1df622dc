//! Prints answers, for people and programs.

use std::io::Write;

use g7_model::{Said, say};
use g7_verify::{Evidence, Open, Reason, Verdict, words};
use serde_json::{Value, json};

use super::found::{Answered, Found, LISTED};
use crate::failure::{Failure, raw};
use crate::message::{tell, told};
use crate::{reasons, style};

/// The word for an answer.
pub(super) fn word(verdict: &Verdict) -> Said {
    Said::in_each(words::verdict(verdict))
}

/// The way out, on a line.
fn help(out: &mut impl Write, what: &Said) -> Result<(), Failure> {
    if !what.is_empty() {
        writeln!(out, "  {}", told(&say!("help: {}", what)))?;
    }
    Ok(())
}

/// Prints that a question is not decided, and why.
fn not_decided(out: &mut impl Write, name: &str, why: &str) -> Result<(), Failure> {
    let style = style::WARN;
    writeln!(out, "{name}: {style}{}{style:#}: {why}", told(&say!("not decided")))?;
    Ok(())
}

/// Prints the answers of a file that are not proved, and all of the author's; with `all` every answer.
pub(super) fn text(found: &Found, all: bool) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    if let Some(why) = &found.unasked {
        not_decided(&mut out, &found.name, &told(why))?;
        help(&mut out, &say!("allow more with --time"))?;
    }
    let mut seen: Vec<&Reason> = Vec::new();
    for a in &found.answers {
        let proved = matches!(a.verdict, Verdict::Proved(_));
        if proved && !a.own && !all {
            continue;
        }
        if let Some(open) = open(a)
            && !all
        {
            // All of one reason stand where the first of them does.
            if seen.contains(&&open.reason) {
                continue;
            }
            seen.push(&open.reason);
            let is_like = |b: &&Answered| self::open(b).is_some_and(|o| o.reason == open.reason);
            let group: Vec<&Answered> = found.answers.iter().filter(is_like).collect();
            if group.len() > 1 {
                undecided(&mut out, found, &group)?;
                continue;
            }
        }
        one(&mut out, a, proved && !all)?;
    }
    Ok(())
}

/// How far a question of every chart is decided that is not decided.
fn open(a: &Answered) -> Option<&Open> {
    match &a.verdict {
        Verdict::Open(open) if !a.own => Some(open),
        _ => None,
    }
}

fn one(out: &mut impl Write, a: &Answered, short: bool) -> Result<(), Failure> {
    let style = match a.verdict {
        Verdict::Proved(_) => style::GOOD,
        Verdict::Refuted(_) => style::BAD,
        Verdict::Open(_) => style::WARN,
    };
    writeln!(out, "{}: {style}{}{style:#}: {}", a.place, told(&word(&a.verdict)), told(&a.claim))?;
    if short {
        return Ok(());
    }
    writeln!(out, "  {}", told(&a.reason))?;
    for line in a.chronogram.lines() {
        writeln!(out, "  {line}")?;
    }
    if let Some(last) = a.scans.last() {
        writeln!(out, "  {}", told(&say!("the last scan, {}", raw(last))))?;
    }
    if !a.guilt.is_empty() {
        writeln!(out, "  {}", told(&a.guilt))?;
    }
    reasons::lines(out, &a.why)?;
    help(out, &a.help)
}

/// Prints questions that are not decided for one reason: the first ones with their places.
fn undecided(out: &mut impl Write, found: &Found, group: &[&Answered]) -> Result<(), Failure> {
    let Some(first) = group.first() else { return Ok(()) };
    let known = open(first).and_then(|open| found.more.iter().find(|(reason, _)| *reason == open.reason));
    let known = known.map(|(_, more)| more);
    let mut more = known.map(|m| m.hidden.clone()).unwrap_or_default();
    let listed = group.iter().filter_map(|a| Some((open(a)?.scans, &a.reason)));
    let counted = known.and_then(|m| m.least.as_ref()).map(|(scans, words)| (*scans, words));
    let reason = listed
        .chain(counted)
        .min_by_key(|(scans, _)| *scans)
        .map(|(_, words)| words.clone())
        .unwrap_or_default();
    let n = group.len() + more.values().sum::<usize>();
    not_decided(out, &found.name, &told(&say!("{n} questions")))?;
    writeln!(out, "  {}", told(&say!("of each: {reason}")))?;
    for a in group.iter().take(LISTED) {
        let place = a.place.strip_prefix(&found.name).unwrap_or(&a.place).trim_start_matches(':');
        writeln!(out, "  {place}: {}", told(&a.claim))?;
    }
    for a in group.iter().skip(LISTED) {
        *more.entry(a.rule).or_default() += 1;
    }
    if !more.is_empty() {
        let kinds: Vec<String> = more.iter().map(|(rule, n)| told(&say!("{n} of {}", raw(rule)))).collect();
        writeln!(out, "  {}", told(&say!("… and {} (--all lists them)", raw(kinds.join(", ")))))?;
    }
    help(out, &first.help)
}

/// Prints how many answers there are of each kind, and why there are no more.
pub(super) fn summary(all: &[Found], stopped: Option<&Said>) -> Result<(), Failure> {
    let [proved, refuted, open] = counts(all);
    let mut out = anstream::stdout().lock();
    let counted = say!("{proved} proved, {refuted} refuted, {open} not decided");
    let counted = stopped.map_or_else(|| counted.clone(), |why| say!("{counted}; {why}"));
    writeln!(out, "{}", told(&counted))?;
    let unasked = all.iter().filter(|f| f.unasked.is_some()).count();
    if unasked > 0 {
        writeln!(out, "{}", told(&say!("{unasked} of {} files without an answer", all.len())))?;
    }
    Ok(())
}

/// Numbers of answers: proved, refuted, not decided.
pub(super) fn counts(all: &[Found]) -> [usize; 3] {
    let mut counts = [0; 3];
    let answers = all.iter().flat_map(|f| &f.answers);
    for (place, n) in answers.map(|a| (place(&a.verdict), 1)).chain(all.iter().map(|f| (2, f.hidden()))) {
        if let Some(count) = counts.get_mut(place) {
            *count += n;
        }
    }
    counts
}

fn place(verdict: &Verdict) -> usize {
    match verdict {
        Verdict::Proved(_) => 0,
        Verdict::Refuted(_) => 1,
        Verdict::Open(_) => 2,
    }
}

/// Prints all answers as one JSON object.
pub(super) fn json(all: &[Found]) -> Result<(), Failure> {
    let [proved, refuted, open] = counts(all);
    let answers: Vec<Value> = all.iter().flat_map(|f| &f.answers).map(row).collect();
    let files: Vec<Value> = all.iter().filter_map(not_asked).collect();
    let all = json!({
        "proved": proved, "refuted": refuted, "not_decided": open, "answers": answers, "not_asked": files,
    });
    writeln!(anstream::stdout().lock(), "{all:#}")?;
    Ok(())
}

/// Prints each answer of a file as a line of JSON; tells why there is none.
pub(super) fn lines(found: &Found) -> Result<(), Failure> {
    if let Some(why) = &found.unasked {
        tell(say!("{}: not decided: {why}", raw(&found.name)));
    }
    let mut out = anstream::stdout().lock();
    found.answers.iter().try_for_each(|a| writeln!(out, "{}", row(a)))?;
    out.flush()?;
    Ok(())
}

/// An answer as an object.
fn row(a: &Answered) -> Value {
    let mut row = json!({
        "place": a.place, "claim": &*a.claim, "own": a.own, "verdict": &*word(&a.verdict), "reason": &*a.reason,
        "help": &*a.help,
    });
    if !a.chronogram.is_empty() {
        row["chronogram"] = json!(a.chronogram);
    }
    if !a.guilt.is_empty() {
        row["guilt"] = json!(&*a.guilt);
    }
    if !a.why.is_empty() {
        row["why"] = a.why.iter().map(reasons::json).collect();
    }
    if let Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) = &a.verdict {
        row["run"] = run.moves.iter().map(|m| json!({ "inputs": m.inputs, "wait_ns": m.wait })).collect();
    }
    row
}

/// A file of which not all was asked, with the reason.
pub(super) fn not_asked(found: &Found) -> Option<Value> {
    let reason = trouble(found)?;
    Some(json!({ "file": found.name, "reason": reason }))
}

/// Why nothing was asked of a file, or what it was asked means nothing; in plain text.
pub(super) fn trouble(found: &Found) -> Option<String> {
    let errors = Some(&found.trouble).filter(|t| !t.is_empty());
    let text = errors.map(|t| anstream::adapter::strip_str(t).to_string());
    text.or_else(|| found.unasked.as_ref().map(ToString::to_string))
}
