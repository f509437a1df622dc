//! Prints the results of tests, for people, programs and build servers.

use std::io::{self, Write};

use g7_model::{Nanos, say};
use serde_json::{Value, json};

use crate::failure::raw;
use crate::message::told;
use crate::tongue::language;
use crate::{reasons, report, style};
use g7_rig::testing::{Coverage, Defect, Outcome, Unproved};

/// Prints one line for each test.
pub(super) fn progress_lines(out: &mut dyn Write, outcomes: &[Outcome]) -> io::Result<()> {
    for o in outcomes {
        let (style, word) = match o.defect {
            Some(_) => (style::BAD, told(&say!("FAILED"))),
            None => (style::GOOD, told(&say!("ok"))),
        };
        let (faint, time) = (style::FAINT, o.simulated.plain());
        writeln!(out, "{style}{word:>6}{style:#} {}: {} {faint}({time}){faint:#}", o.file, o.title)?;
        for note in &o.notes {
            writeln!(out, "{}  {}{:#} {}", style::WARN, told(&say!("note")), style::WARN, told(note))?;
        }
    }
    Ok(())
}

/// Prints each failure: its place, the expected and the actual values, and the events before it.
pub(super) fn failures(out: &mut dyn Write, outcomes: &[Outcome]) -> io::Result<()> {
    for o in outcomes {
        let Some(d) = &o.defect else { continue };
        writeln!(out, "\n{}{}{:#}: {}", style::BAD, o.title, style::BAD, told(&d.sentence()))?;
        let place = say!("at {}, {} after the start", raw(&d.place), raw(d.time.plain()));
        writeln!(out, "  {}", told(&place))?;
        if let Some(origin) = &d.origin {
            writeln!(out, "  {}", told(&say!("it came up at {}", raw(origin))))?;
        }
        if !d.got.is_empty() {
            let got: Vec<String> = d.got.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            writeln!(out, "  {}", told(&say!("got {}", raw(got.join(", ")))))?;
        }
        writeln!(out, "  {}", told(&say!("situation {}", raw(&d.situation))))?;
        reasons::lines(out, &d.why)?;
        if !d.chronogram.is_empty() {
            writeln!(out)?;
            for line in d.chronogram.lines() {
                writeln!(out, "  {line}")?;
            }
        }
    }
    Ok(())
}

/// All that came of the files.
#[derive(Default)]
pub(super) struct Results {
    pub(super) outcomes: Vec<Outcome>,
    /// Files with errors, and their problems as text.
    pub(super) broken: Vec<(String, String)>,
    pub(super) covered: Vec<(String, Coverage)>,
    pub(super) unproved: Vec<Unproved>,
    /// Tests that were left out behind a failure.
    pub(super) not_run: usize,
}

impl Results {
    fn failed(&self) -> usize {
        self.outcomes.iter().filter(|o| o.defect.is_some()).count()
    }
}

/// Prints the closing line.
pub(super) fn summary(out: &mut dyn Write, results: &Results) -> io::Result<()> {
    let failed = results.failed();
    let passed = results.outcomes.len() - failed;
    let broken = match results.broken.len() {
        0 => None,
        1 => Some(say!("1 file with errors")),
        n => Some(say!("{n} files with errors")),
    };
    let not_run = (results.not_run > 0).then(|| say!("{} not run", results.not_run));
    let left = (!results.unproved.is_empty()).then(|| say!("{} left to g7 prove", results.unproved.len()));
    let parts = [Some(say!("{passed} passed, {failed} failed")), broken, not_run, left];
    let parts: Vec<String> = parts.into_iter().flatten().map(|part| part.in_language(language())).collect();
    writeln!(out, "\n{}", parts.join(", "))
}

/// Prints the coverage of each kind of element, and every element that was not reached.
pub(super) fn coverage(out: &mut dyn Write, files: &[(String, Coverage)]) -> io::Result<()> {
    for (file, coverage) in files {
        writeln!(out, "\n{}{file}{:#}", style::STRONG, style::STRONG)?;
        for (sort, rows) in coverage.sorts() {
            let reached = rows.values().filter(|r| r.hits > 0).count();
            let style = if reached == rows.len() { style::GOOD } else { style::WARN };
            let of = told(&say!("of"));
            writeln!(out, "  {style}{reached:>5} {of} {:<5}{style:#} {}", rows.len(), told(&sort.plural()))?;
        }
        for (sort, rows) in coverage.sorts() {
            for row in rows.values().filter(|r| r.hits == 0) {
                let row = say!("not reached: {} {} ({})", sort.one(), raw(&row.name), raw(&row.place));
                writeln!(out, "  {}", told(&row))?;
            }
        }
    }
    Ok(())
}

/// Prints everything as one JSON object.
pub(super) fn json(out: &mut dyn Write, results: &Results, coverage: bool) -> io::Result<()> {
    let failed = results.failed();
    let tests: Vec<Value> = results.outcomes.iter().map(test_json).collect();
    let broken: Vec<&str> = results.broken.iter().map(|(file, _)| file.as_str()).collect();
    let mut all = json!({
        "passed": results.outcomes.len() - failed, "failed": failed, "not_run": results.not_run,
        "files_with_errors": broken, "tests": tests,
    });
    all["not_proved"] = report::unproved_json(&results.unproved);
    if coverage {
        all["coverage"] = results.covered.iter().map(|(file, c)| coverage_json(file, c)).collect();
    }
    writeln!(out, "{all:#}")
}

fn test_json(o: &Outcome) -> Value {
    let mut test = json!({
        "file": o.file, "title": o.title, "place": o.place, "passed": o.defect.is_none(),
        "simulated_seconds": o.simulated.as_seconds(), "scans": o.scans, "seconds": o.took.as_seconds(),
        "notes": o.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    if let Some(d) = &o.defect {
        test["failure"] = defect_json(d, d.what.as_str());
    }
    test
}

/// Why a test failed; `what` is the sentence about it.
pub(crate) fn defect_json(d: &Defect, what: &str) -> Value {
    let got: serde_json::Map<String, Value> = d.got.iter().map(|(n, v)| (n.clone(), json!(v))).collect();
    json!({
        "what": what, "expected": d.expected, "got": got, "place": d.place, "origin": d.origin,
        "time_seconds": d.time.as_seconds(), "situation": d.situation, "chronogram": d.chronogram,
        "why": d.why.iter().map(reasons::json).collect::<Vec<_>>(),
    })
}

fn coverage_json(file: &str, coverage: &Coverage) -> Value {
    let mut all = json!({ "file": file });
    for (sort, rows) in coverage.sorts() {
        let list: Vec<Value> =
            rows.values().map(|r| json!({ "name": r.name, "place": r.place, "hits": r.hits })).collect();
        all[sort.key()] = json!({
            "total": rows.len(), "reached": rows.values().filter(|r| r.hits > 0).count(), "rows": list,
        });
    }
    all
}

/// A JUnit report: a suite for each file. A file with errors is a suite with one error.
pub(super) fn junit(results: &Results) -> String {
    let failed = |list: &[&Outcome]| list.iter().filter(|o| o.defect.is_some()).count();
    let took = |list: &[&Outcome]| list.iter().fold(Nanos::ZERO, |sum, o| sum + o.took).in_seconds();
    let outcomes = &results.outcomes;
    let all: Vec<&Outcome> = outcomes.iter().collect();
    let mut files: Vec<&str> = outcomes.iter().map(|o| o.file.as_str()).collect();
    files.dedup();
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    out.push_str(&format!(
        "<testsuites name=\"g7\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{}\">\n",
        all.len() + results.broken.len(),
        failed(&all),
        results.broken.len(),
        took(&all)
    ));
    for file in files {
        let mine: Vec<&Outcome> = outcomes.iter().filter(|o| o.file == file).collect();
        let name = escape(file);
        out.push_str(&format!(
            "  <testsuite name=\"{name}\" tests=\"{}\" failures=\"{}\" errors=\"0\" time=\"{}\">\n",
            mine.len(),
            failed(&mine),
            took(&mine)
        ));
        mine.into_iter().for_each(|o| case(&mut out, o));
        out.push_str("  </testsuite>\n");
    }
    for (file, told) in &results.broken {
        let name = escape(file);
        let text = anstream::adapter::strip_str(told.trim()).to_string();
        out.push_str(&format!(
            "  <testsuite name=\"{name}\" tests=\"1\" failures=\"0\" errors=\"1\" time=\"0\">\n    \
             <testcase classname=\"{name}\" name=\"the file\" file=\"{name}\" time=\"0\">\n      \
             <error message=\"errors\">{}</error>\n    </testcase>\n  </testsuite>\n",
            escape(&text)
        ));
    }
    out.push_str("</testsuites>\n");
    out
}

/// A test of a JUnit report, with its place.
fn case(out: &mut String, o: &Outcome) {
    let (name, title, time) = (escape(&o.file), escape(&o.title), o.took.in_seconds());
    // `path:line:column`
    let line = o.place.rsplit(':').nth(1).unwrap_or("1");
    out.push_str(&format!(
        "    <testcase classname=\"{name}\" name=\"{title}\" file=\"{name}\" line=\"{line}\" time=\"{time}\""
    ));
    match &o.defect {
        None => out.push_str("/>\n"),
        Some(d) => {
            let mut text = Vec::new();
            failures(&mut text, std::slice::from_ref(o)).ok();
            let text = anstream::adapter::strip_str(&String::from_utf8_lossy(&text)).to_string();
            out.push_str(&format!(
                ">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                escape(&d.sentence()),
                escape(text.trim())
            ));
        }
    }
}

/// Escapes text for XML; characters that XML does not allow become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            c if (c as u32) < 0x20 || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}
