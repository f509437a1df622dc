//! Prints answers, for people, programs and build servers.

use std::io::Write;

use g7_verify::{Evidence, Verdict, words};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::style;
use crate::testing::escape;

/// An answered question, ready to be printed.
pub(crate) struct Answered {
    /// `path:line:column` of what is asked about.
    pub(crate) place: String,
    /// The claim in words.
    pub(crate) claim: String,
    /// The author wrote it.
    pub(crate) own: bool,
    /// The evidence in one line.
    pub(crate) reason: String,
    /// The way out; empty where none is known.
    pub(crate) help: String,
    /// The answer.
    pub(crate) verdict: Verdict,
    /// The run that shows it, drawn; empty without one.
    pub(crate) chronogram: String,
    /// The question by its short name.
    pub(crate) rule: &'static str,
    /// The scans of the run, each in words.
    pub(crate) scans: Vec<String>,
}

pub(super) fn word(verdict: &Verdict) -> String {
    let [word, ..] = words::verdict(verdict);
    word
}

/// Prints what is not proved and the author's properties; with `all` every answer.
pub(super) fn text(list: &[Answered], all: bool) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    for a in list {
        let proved = matches!(a.verdict, Verdict::Proved(_));
        if proved && !a.own && !all {
            continue;
        }
        let style = match a.verdict {
            Verdict::Proved(_) => style::GOOD,
            Verdict::Refuted(_) => style::BAD,
            Verdict::Open(_) => style::WARN,
        };
        writeln!(out, "{}: {style}{}{style:#}: {}", a.place, word(&a.verdict), a.claim)?;
        if proved && !all {
            continue;
        }
        writeln!(out, "  {}", a.reason)?;
        for line in a.chronogram.lines() {
            writeln!(out, "  {line}")?;
        }
        if !a.help.is_empty() {
            writeln!(out, "  help: {}", a.help)?;
        }
    }
    let [proved, refuted, open] = counts(list);
    writeln!(out, "{proved} proved, {refuted} refuted, {open} not decided")?;
    Ok(())
}

fn counts(list: &[Answered]) -> [usize; 3] {
    ["proved", "refuted", "not decided"].map(|w| list.iter().filter(|a| word(&a.verdict) == w).count())
}

/// Prints all answers as one JSON object.
pub(super) fn json(list: &[Answered]) -> Result<(), Failure> {
    let [proved, refuted, open] = counts(list);
    let answers: Vec<Value> = list.iter().map(row).collect();
    let all = json!({ "proved": proved, "refuted": refuted, "not_decided": open, "answers": answers });
    writeln!(anstream::stdout().lock(), "{all:#}")?;
    Ok(())
}

/// Prints each answer as a line of JSON.
pub(super) fn lines(list: &[Answered]) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    list.iter().try_for_each(|a| writeln!(out, "{}", row(a)))?;
    out.flush()?;
    Ok(())
}

/// An answer as an object.
fn row(a: &Answered) -> Value {
    let mut row = json!({
        "place": a.place, "claim": a.claim, "own": a.own, "verdict": word(&a.verdict), "reason": a.reason,
        "help": a.help,
    });
    if !a.chronogram.is_empty() {
        row["chronogram"] = json!(a.chronogram);
    }
    if let Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) = &a.verdict {
        row["run"] = run.moves.iter().map(|m| json!({ "inputs": m.inputs, "wait_ns": m.wait })).collect();
    }
    row
}

/// A JUnit report: a case for each answer; what is not decided counts as skipped.
pub(super) fn junit(list: &[Answered]) -> String {
    let [_, refuted, open] = counts(list);
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"g7 prove\" tests=\"{}\" failures=\"{refuted}\" \
         skipped=\"{open}\">\n",
        list.len()
    );
    for a in list {
        let file = a.place.rsplitn(3, ':').last().unwrap_or_default();
        out.push_str(&format!("  <testcase classname=\"{}\" name=\"{}\"", escape(file), escape(&a.claim)));
        let body = format!("{}\n{}", a.reason, a.chronogram);
        match a.verdict {
            Verdict::Proved(_) => out.push_str("/>\n"),
            Verdict::Refuted(_) => out.push_str(&format!(
                ">\n    <failure message=\"{}: refuted\">{}</failure>\n  </testcase>\n",
                escape(&a.place),
                escape(body.trim())
            )),
            Verdict::Open(_) => {
                out.push_str(&format!(
                    ">\n    <skipped message=\"{}\"/>\n  </testcase>\n",
                    escape(&a.reason)
                ));
            }
        }
    }
    out.push_str("</testsuite>\n");
    out
}
