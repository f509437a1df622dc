//! The prover beside other model checkers on the same charts, in one run: answers, seconds, memory, ratios.
//!
//! ```text
//! rows.rs (charts.rs: a chart as text) -> own.rs in a process of its own -> answer, seconds, peak memory
//!                                      -> others.rs: an AIGER file for ABC and rIC3,
//!                                         models for Spin, Stateright (cells.rs) and LTSmin
//! ```
//!
//! `g7-prove-bench [--limit SECONDS] [WORDS]`: the rows whose names have one of the words. Each answer has the
//! limit (120 s); without one in time a row has the limit with `>`. Times of others are of the whole call, but for
//! Spin: that of the search, without its compiler. An answer that differs from ours stands in the row, and the
//! program fails.

#[cfg(feature = "stateright")]
mod cells;
mod charts;
mod others;
mod own;
mod rows;

use std::process::{Command, ExitCode};

use others::{Answer, NAMES, Others};
use rows::rows;

/// Seconds for each answer, if nothing else is said.
const SECONDS: u32 = 120;

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let mut limit = SECONDS;
    if words.first().is_some_and(|w| w == "--limit") {
        limit = words.get(1).and_then(|s| s.parse().ok()).unwrap_or(limit);
        words.drain(..words.len().min(2));
    }
    if let Some(name) = words.first().and_then(|w| w.strip_prefix("row:")) {
        if let Some(row) = rows().into_iter().find(|r| r.name == name) {
            println!("{}", own::answered(&row, limit));
        }
        return ExitCode::SUCCESS;
    }
    let others = Others::find(limit);
    println!("| | G7: answer, s, MiB | {} |", NAMES.join(" | "));
    println!("|---|---|{}", "---|".repeat(NAMES.len()));
    let mut differ = 0;
    for row in rows().iter().filter(|r| words.is_empty() || words.iter().any(|w| r.name.contains(w.as_str())))
    {
        let ours = ours(row.name, limit);
        let file = own::aiger(row);
        let answers = others.answers(row, file.as_ref());
        differ += answers.iter().flatten().filter(|a| disagree(&ours, a)).count();
        let cells = answers.iter().map(|a| a.as_ref().map_or("–".to_owned(), |a| cell(&ours, a)));
        let [word, seconds, mib] = &ours;
        let own =
            if word == "open" { format!("> {limit}, {mib}") } else { format!("{word}, {seconds}, {mib}") };
        println!("| {} | {own} | {} |", row.name, cells.collect::<Vec<_>>().join(" | "));
    }
    println!(
        "\nIn brackets: the time of G7 divided by that of the other; below 1, G7 is faster. –: not asked."
    );
    let absent = others.absent();
    if !absent.is_empty() {
        println!("Not here: {}.", absent.join(", "));
    }
    if differ == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The answer of G7, its seconds and its memory, from a process of its own.
fn ours(name: &str, limit: u32) -> [String; 3] {
    let out = std::env::current_exe().and_then(|program| {
        Command::new(program).args(["--limit", &limit.to_string(), &format!("row:{name}")]).output()
    });
    let text = out.map_or(String::new(), |o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    let mut parts = text.split(", ").map(str::to_owned);
    [(); 3].map(|()| parts.next().unwrap_or_else(|| "WRONG".to_owned()))
}

fn disagree(ours: &[String; 3], theirs: &Answer) -> bool {
    ours[0].contains("WRONG") || ours[0] != "open" && theirs.word != "open" && ours[0] != theirs.word
}

/// The time of another, and what it says if it is not what we say.
fn cell(ours: &[String; 3], theirs: &Answer) -> String {
    let seconds = theirs.seconds;
    if theirs.word == "open" {
        return format!("> {seconds:.0}");
    }
    let ratio = ours[1].parse::<f64>().ok().filter(|_| ours[0] != "open");
    let ratio = ratio.map_or(String::new(), |own| format!(" ({:.2}×)", own / seconds));
    let says = if disagree(ours, theirs) { format!(" **{}**", theirs.word) } else { String::new() };
    format!("{seconds:.2}{ratio}{says}")
}
