//! Prints answers, for people, programs and build servers.

use std::io::Write;

use g7_model::Nanos;
use g7_verify::{Certificate, Evidence, Verdict};
use serde_json::{Value, json};

use super::words;
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
    /// The answer.
    pub(crate) verdict: Verdict,
    /// The run that shows it, drawn; empty without one.
    pub(crate) chronogram: String,
    /// The time that the run takes.
    pub(crate) time: Nanos,
}

fn word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Proved(_) => "proved",
        Verdict::Refuted(_) => "refuted",
        Verdict::Open(_) => "not decided",
    }
}

/// The evidence of an answer, in one line.
fn reason(a: &Answered) -> String {
    match &a.verdict {
        Verdict::Open(open) => {
            format!(
                "no run of up to {} decides it ({} visited): {}",
                count(open.scans, "scan"),
                count(open.states, "state"),
                open.reason
            )
        }
        Verdict::Proved(e) | Verdict::Refuted(e) => match e {
            Evidence::Run(run) => {
                let fault = run.fault.map_or(String::new(), |f| format!(", with a fault: {}", f.kind));
                format!("shown by a run of {}, {}{fault}", count(run.moves.len(), "scan"), a.time.plain())
            }
            Evidence::Certificate(Certificate::Search { states, scans }) => {
                format!("all of {} visited by {}", count(*states, "state"), count(*scans, "scan"))
            }
            Evidence::Certificate(Certificate::Invariant { clauses }) => {
                format!("an invariant of {}, which was checked", count(*clauses, "clause"))
            }
            Evidence::Certificate(Certificate::Induction { depth }) => {
                format!("induction over {}, which was checked", count(*depth, "scan"))
            }
        },
    }
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn help(a: &Answered) -> String {
    match &a.verdict {
        Verdict::Open(open) => open.help.clone(),
        Verdict::Refuted(_) => words::way_out(&a.claim).unwrap_or_default().to_owned(),
        Verdict::Proved(_) => String::new(),
    }
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
        writeln!(out, "  {}", reason(a))?;
        for line in a.chronogram.lines() {
            writeln!(out, "  {line}")?;
        }
        let help = help(a);
        if !help.is_empty() {
            writeln!(out, "  help: {help}")?;
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
    let one = |a: &Answered| -> Value {
        let mut row = json!({
            "place": a.place, "claim": a.claim, "own": a.own, "verdict": word(&a.verdict), "reason": reason(a),
            "help": help(a),
        });
        if !a.chronogram.is_empty() {
            row["chronogram"] = json!(a.chronogram);
        }
        if let Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) = &a.verdict {
            row["run"] = run.moves.iter().map(|m| json!({ "inputs": m.inputs, "wait_ns": m.wait })).collect();
        }
        row
    };
    let answers: Vec<Value> = list.iter().map(one).collect();
    let all = json!({ "proved": proved, "refuted": refuted, "not_decided": open, "answers": answers });
    writeln!(anstream::stdout().lock(), "{all:#}")?;
    Ok(())
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
        let body = format!("{}\n{}", reason(a), a.chronogram);
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
                    escape(&reason(a))
                ));
            }
        }
    }
    out.push_str("</testsuite>\n");
    out
}
