//! The table of texts in French and Portuguese, held to the sources: each `say!` and each title of a code has
//! a row, each row is used, and its holes are those of the English text. What is printed or refused is said by
//! `say!`, and not written out in English.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use g7_model::{codes, said};
use g7_tests::house::{ends_in, files, none, read};

/// The string literal at the start of a text, as Rust reads it.
fn literal(code: &str) -> Option<String> {
    let mut chars = code.strip_prefix('"')?.chars().peekable();
    let mut text = String::new();
    loop {
        match chars.next()? {
            '"' => return Some(text),
            '\\' => match chars.next()? {
                '\n' => while chars.next_if(|c| c.is_whitespace()).is_some() {},
                'n' => text.push('\n'),
                'u' => {
                    let code: String = chars.by_ref().skip(1).take_while(|c| *c != '}').collect();
                    text.push(u32::from_str_radix(&code, 16).ok().and_then(char::from_u32)?);
                }
                c => text.push(c),
            },
            c => text.push(c),
        }
    }
}

/// A source without its tests and comments.
fn code_of(source: &str) -> String {
    // `#[cfg(test)] mod tests;` names tests in another file. The code after it belongs to this source.
    let of_tests = |rest: &str| rest.lines().next().is_some_and(|line| line.contains('{'));
    let begins =
        source.match_indices("#[cfg(test)]\nmod ").find(|(at, sign)| of_tests(&source[at + sign.len()..]));
    let own = begins.map_or(source, |(at, _)| &source[..at]);
    own.lines().filter(|l| !l.trim_start().starts_with("//")).map(|l| l.to_owned() + "\n").collect()
}

/// The literals that begin the arguments of a call in a source without its tests and comments.
fn literals(code: &str, call: &str) -> Vec<String> {
    code.match_indices(call)
        .filter(|(at, _)| !code[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
        .filter_map(|(at, word)| literal(code[at + word.len()..].trim_start()))
        .collect()
}

/// The texts of `say!` in a source without its tests and comments.
fn said_in(source: &str) -> Vec<String> {
    literals(&code_of(source), "say!(")
}

/// Calls that print a text or refuse with one.
const TELLS: [&str; 9] = [
    "talk!(",
    "writeln!(out, ",
    "writeln!(&mut out, ",
    "write!(out, ",
    "Err(",
    "Err(format!(",
    "ok_or(",
    "ok_or_else(|| format!(",
    "map_err(|_| format!(",
];

/// The crates whose texts go to a reader as they are.
const TELLERS: [&str; 5] = ["edit", "ide", "page", "rig", "g7"];

/// Sources that speak English alone: what a controller or a shared run says while it runs (decision 51), what
/// processes of a shared search say to each other, refusals of arguments, which stand among clap's words, and
/// files for programs.
const ENGLISH: [&str; 17] = [
    "crates/g7/src/attendant.rs",
    "crates/g7/src/audit.rs",
    "crates/g7/src/operator/",
    "crates/g7/src/plant.rs",
    "crates/g7/src/station.rs",
    "crates/g7/src/serve/live.rs",
    "crates/g7/src/serve/runs.rs",
    "crates/g7/src/lsp/follow.rs",
    "crates/g7/src/lsp/shows.rs",
    "crates/g7/src/prove/process.rs",
    "crates/g7/src/prove/workers.rs",
    "crates/g7/src/prove/graph/picture.rs",
    "crates/g7/src/values.rs",
    "crates/g7/src/devices.rs",
    "crates/g7/src/draw/mod.rs",
    "crates/g7/src/generate.rs",
    "crates/page/src/explain.rs",
];

/// The names in the holes of a text, in order, and whether a letter stands outside of holes and back-ticks.
fn taken_apart(text: &str) -> (Vec<String>, bool) {
    let (mut holes, mut ticked, mut words) = (Vec::new(), false, false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '{' | '}' if chars.peek() == Some(&c) => {
                chars.next();
            }
            '{' => {
                let hole: String = chars.by_ref().take_while(|c| *c != '}').collect();
                holes.push(hole.split(':').next().unwrap_or("").to_owned());
            }
            '`' => ticked = !ticked,
            c => words |= !ticked && c.is_alphabetic(),
        }
    }
    (holes, words)
}

/// The sources of the crates, without files of tests, each with the name of its crate.
fn sources() -> Vec<(String, PathBuf)> {
    let test = |f: &PathBuf| f.iter().any(|p| p == "tests" || p.to_string_lossy().ends_with("tests.rs"));
    let source = |f: &PathBuf| {
        f.starts_with("crates") && ends_in(f, &["rs"]) && !f.starts_with("crates/say") && !test(f)
    };
    let home = |f: &PathBuf| f.iter().nth(1).unwrap_or_default().to_string_lossy().into_owned();
    let all = files().into_iter().filter(|f| source(f) && f.iter().any(|p| p == "src"));
    all.map(|f| (home(&f), f)).collect()
}

/// The texts that have words, with the crates that say them.
fn all_said() -> BTreeMap<String, BTreeSet<String>> {
    let mut said: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (home, file) in sources() {
        for text in said_in(&read(&file)).into_iter().filter(|t| taken_apart(t).1) {
            said.entry(text).or_default().insert(home.clone());
        }
    }
    assert!(said.len() > 600, "only {} texts", said.len());
    for code in codes::ALL {
        said.entry(code.title.to_owned()).or_default().insert("codes".to_owned());
    }
    said
}

#[test]
fn each_text_is_told_in_each_language() {
    let rows: BTreeMap<&str, said::Row> = said::rows().map(|row| (row[0], row)).collect();
    let said = all_said();
    let lacking = said.iter().filter(|(text, _)| !rows.contains_key(&***text));
    let found: Vec<String> = lacking.map(|(text, homes)| format!("{homes:?}: no row: {text}")).collect();
    none(&found, "texts that a language lacks");
}

/// The texts that a source prints or refuses with, in English alone: those of more than one word.
fn in_english(source: &str) -> Vec<String> {
    // A call may stand on several lines.
    let code = code_of(source).split_whitespace().collect::<Vec<_>>().join(" ").replace("( ", "(");
    let all = TELLS.iter().flat_map(|call| literals(&code, call));
    all.filter(|text| taken_apart(text).1 && text.trim().contains(' ')).collect()
}

#[test]
fn what_is_told_is_said_in_each_language() {
    let speaks = |home: &str, file: &PathBuf| {
        let english = ENGLISH.iter().any(|of| file.to_string_lossy().starts_with(of));
        TELLERS.contains(&home) && !english
    };
    let mut found = Vec::new();
    for (_, file) in sources().iter().filter(|(home, file)| speaks(home, file)) {
        found.extend(in_english(&read(file)).iter().map(|text| format!("{}: {text}", file.display())));
    }
    none(&found, "texts in English alone: write `say!`");
    for english in ENGLISH {
        let is_there = sources().iter().any(|(_, file)| file.to_string_lossy().starts_with(english));
        assert!(is_there, "{english} is no source");
    }
}

#[test]
fn each_row_is_used_once_and_is_whole() {
    let said = all_said();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for [english, french, portuguese] in said::rows() {
        if !said.contains_key(english) {
            found.push(format!("no text: {english}"));
        }
        if !seen.insert(english) {
            found.push(format!("twice: {english}"));
        }
        let mut wanted = taken_apart(english).0;
        wanted.sort();
        for told in [french, portuguese] {
            let mut holes = taken_apart(told).0;
            holes.sort();
            if holes != wanted || told.is_empty() || told.ends_with('.') || told.matches('`').count() % 2 == 1
            {
                found.push(format!("not the same holes, or a stop at its end: {english}: {told}"));
            }
        }
    }
    none(&found, "rows of the table of texts that do not fit");
}

#[test]
fn texts_are_found_and_taken_apart() {
    let source = "// say!(\"no\")\n let a = say!(\n    \"`{x}` has \\\n     {}\", 1); bsay!(\"no\");\n#[cfg(test)]\nmod t { say!(\"no\") }";
    assert_eq!(said_in(source), ["`{x}` has {}"]);
    assert_eq!(said_in("#[cfg(test)]\nmod tests;\nsay!(\"a\")\n#[cfg(test)]\nmod t { say!(\"b\") }"), ["a"]);
    let source = "talk!(\n  \"{} was lost\", a); writeln!(\n out,\n \"b c\"); talk!(\"{a}: {b}\"); Err(\"no `a b`\"); Err(format!(\n \"no {a}\"))";
    assert_eq!(in_english(source), ["{} was lost", "b c", "no `a b`", "no {a}"]);
    assert_eq!(taken_apart("`{x}` {} {n:?} {{").0, ["x", "", "n"]);
    assert!(!taken_apart("`word` {}").1 && taken_apart("a `b`").1);
}
