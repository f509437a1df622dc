//! The cases of `tests/why`: a chart, its run, and the answers that the rules ask for. `tests/why/README.md` describes
//! their form.

use std::path::{Path, PathBuf};

use g7_host::Tape;
use g7_model::{Language, Nanos};
use g7_rig::{Bench, Options, Source, question, values};
use g7_why::{Cause, Question, Why};

/// A fenced block of a case: the words behind its fence, and its text.
struct Block {
    head: String,
    text: String,
}

fn blocks(text: &str) -> Vec<Block> {
    let (mut found, mut open): (Vec<Block>, Option<Block>) = (Vec::new(), None);
    for line in text.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(_), Some(block)) => found.push(block),
            (Some(head), None) => open = Some(Block { head: head.to_owned(), text: String::new() }),
            (None, Some(mut block)) => {
                block.text.push_str(line);
                block.text.push('\n');
                open = Some(block);
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a fence is not closed");
    found
}

/// The run of a case: `for 5s`, `scan 100ms`, then one assignment a line, `start=1@2s`.
fn taped(bench: &Bench, script: &str) -> Tape {
    let mut until = Nanos::SECOND;
    let mut sets: Vec<(Nanos, &str, &str)> = Vec::new();
    for line in script.lines().map(str::trim).filter(|l| !l.is_empty()) {
        if let Some(time) = line.strip_prefix("for ") {
            until = values::duration(time).expect("a time");
        } else {
            let (what, at) = line.rsplit_once('@').expect("NAME=VALUE@TIME");
            let (name, value) = what.split_once('=').expect("NAME=VALUE@TIME");
            sets.push((values::duration(at).expect("a time"), name, value));
        }
    }
    sets.sort_by_key(|(at, ..)| *at);
    let mut runner = bench.runner(0).with_tape();
    let mut sets = sets.into_iter().peekable();
    while runner.due() <= until {
        while let Some((_, name, value)) = sets.next_if(|(at, ..)| *at <= runner.due()) {
            let item = bench.item(name).expect("what is set is there");
            bench.set(&mut runner, item, &item.read(value).expect("a value of its type"));
        }
        if runner.scan().is_err() {
            break;
        }
    }
    runner.tape().cloned().expect("it has a tape")
}

/// The lines of an answer, as `g7 why` prints them.
fn shown(cause: &Cause, language: Language) -> String {
    let mut out = String::new();
    for (depth, line) in cause.lines() {
        let sign = match (depth, line.aside) {
            (0, _) => "",
            (_, true) => "· ",
            (_, false) => "← ",
        };
        out.push_str(&format!("{}{sign}{}\n", "  ".repeat(depth), line.said.in_language(language)));
    }
    out
}

fn answers(path: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let blocks = blocks(&text);
    let of = |head: &str| blocks.iter().find(|b| b.head == head).map(|b| b.text.as_str());
    let chart = of("g7").ok_or("no chart")?;
    let source = Source::new("case.g7", chart.as_bytes().to_vec(), 0);
    let (bench, problems) = g7_rig::build(&source, &Options::default()).map_err(|e| e.to_string())?;
    let bench = bench.ok_or_else(|| format!("{problems:?}"))?;
    let tape = taped(&bench, of("run").ok_or("no run")?);
    let why = Why::new(&bench.compiled, &tape).map_err(|d| format!("{d:?}"))?;
    let mut asked = 0;
    for block in &blocks {
        let Some(head) = block.head.strip_prefix("why ") else { continue };
        asked += 1;
        let (language, head) = match head.split_once(' ') {
            Some(("fr", rest)) => (Language::French, rest),
            Some(("pt", rest)) => (Language::Portuguese, rest),
            _ => (Language::English, head),
        };
        let (name, time) = head.rsplit_once(' ').unwrap_or(("", head));
        let of_scan = name.is_empty();
        let question = if of_scan { Ok(Question::Scan) } else { question(&bench, name) };
        let time = values::duration(time).map_err(|e| e.to_string())?;
        let cause = why.ask(question.map_err(|e| e.to_string())?, time).map_err(|e| e.to_string())?;
        let got = shown(&cause, language);
        if got != block.text {
            return Err(format!("`{head}`: expected\n{}got\n{got}", block.text));
        }
    }
    if asked == 0 { Err("no question".to_owned()) } else { Ok(()) }
}

#[test]
fn answers_are_those_of_the_rules() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/why");
    let cases: Vec<PathBuf> = g7_tests::case::cases(&folder);
    assert!(cases.len() >= 8, "only {} cases in {}", cases.len(), folder.display());
    let wrong = |path: &PathBuf| answers(path).err().map(|why| format!("{}: {why}", path.display()));
    let wrong: Vec<String> = cases.iter().filter_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
