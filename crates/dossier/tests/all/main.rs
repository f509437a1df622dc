//! The sheets of a dossier, read from their SVG.
#![allow(missing_docs, reason = "a test")]

use g7_dossier::{Answer, Head, Input, Known, Missing, Part, Test, Verdict, dossier};
use g7_draw::{Look, Options, Paper};
use g7_host::VirtualClock;
use g7_model::{Language, Said, Severity};
use g7_rig::Source;
use g7_rig::testing::{self, Coverage};

const TANK: &str = "\
input  start : BOOL at %I0.0 \"the green button\"
output pump : BOOL at %Q0.1 safe FALSE \"lifts water\"
var    count : INT := 0 retain \"full tanks\"
const  MOST : INT := 3

chart Tank \"fills and empties\" {
  initial step 0 \"at rest\"
  step 1 \"fills, and tells so with a comment of such a length that no drawing shows all of it, however wide the sheets may be\" {
    N pump
    P1 count := count + 1
  }
  fork: 0 -> 1 when ↑start and count < MOST
  1 -> 0 when 2s/X1
}

action Reset { count := 0; }

test \"one press fills once\" {
  pulse start
  expect X1, pump
  wait 3s
  expect not pump
}

test \"a press never fills\" {
  pulse start
  expect not pump
}

prove never count > MOST \"never too many\"
assume not start or not pump
";

fn source(text: &str) -> Source {
    let source = Source::new("tank.g7", text.as_bytes().to_vec(), 0);
    assert!(!source.has_errors(), "{:?}", source.problems);
    source
}

fn tests(source: &Source) -> Known<Test> {
    let options = testing::Options { record: true, ..testing::Options::default() };
    let mut coverage = Coverage::default();
    let made = testing::file(source, options, &mut coverage, &mut VirtualClock::default(), &mut || {});
    let (outcomes, problems) = made.expect("the tests run");
    assert!(problems.iter().all(|p| p.severity() == Severity::Warning), "{problems:?}");
    Known::Here(outcomes.into_iter().map(Test::from).collect())
}

fn input(source: &Source, language: Language) -> Input<'_> {
    let answer = Answer {
        claim: Said::foreign("never count > MOST"),
        place: "tank.g7:40:1".to_owned(),
        own: true,
        verdict: Verdict::Refuted,
        reason: Said::foreign("a run of 3 scans"),
        help: Said::default(),
    };
    Input {
        source,
        head: Head { title: "Tank 4".to_owned(), author: "A. Martin".to_owned(), ..Head::default() },
        paper: Paper::default(),
        language,
        look: Look::default(),
        parts: Part::ALL.to_vec(),
        problems: Vec::new(),
        tests: tests(source),
        answers: Known::Here(vec![answer]),
        views: Vec::new(),
    }
}

/// The texts of all sheets without blanks and marks, so that no line end matters.
fn text(input: &Input<'_>) -> (usize, String) {
    let made = dossier(input);
    let sheets = made.svgs(&Options { font: false, ..Options::default() });
    let mut all = String::new();
    for svg in &sheets {
        for piece in svg.split("<text").skip(1) {
            let words =
                piece.split_once('>').and_then(|(_, rest)| rest.split("</text>").next()).unwrap_or("");
            all.push_str(
                &words
                    .replace("&lt;", "<")
                    .replace("&gt;", ">")
                    .replace("&quot;", "\"")
                    .replace("&amp;", "&"),
            );
        }
    }
    (sheets.len(), bare(&all))
}

fn bare(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

#[test]
fn everything_of_the_file_stands_on_the_sheets() {
    let source = source(TANK);
    let (sheets, text) = text(&input(&source, Language::English));
    for part in [
        "Tank 4",
        "A. Martin",
        "Chart Tank",
        "fills and empties",
        "at rest",
        "N pump",
        "P1 count := count + 1",
        "with a comment of such a length that no drawing shows all of it, however wide the sheets may be",
        "fork: 0 → 1",
        "↑start and count < MOST",
        "1 → 0",
        "2s/X1",
        "%I0.0",
        "%Q0.1",
        "the green button",
        "lifts water",
        "retain",
        "full tanks",
        "MOST",
        "action Reset",
        "{ count := 0; }",
        "one press fills once – passed",
        "a press never fills – failed",
        "expected: not pump",
        "never count > MOST",
        "refuted",
        "a run of 3 scans",
        "assume not start or not pump",
        "No problems.",
        "Tank: step 1",
        "Tank: transition fork: 0 → 1",
    ] {
        assert!(text.contains(&bare(part)), "{part} is in\n{text}");
    }
    assert!(text.contains(&format!("{sheets}/{sheets}")), "the last sheet is numbered");
}

#[test]
fn reads_and_writes_stand_in_their_columns() {
    let source = source(TANK);
    let only = |parts: Vec<Part>| Input { parts, ..input(&source, Language::English) };
    let (_, text) = text(&only(vec![Part::References]));
    let row = text.split("count").nth(1).expect("a row");
    let (reads, writes) = (row.find("transitionfork"), row.find("actionReset"));
    assert!(reads < writes && reads.is_some(), "{row}");
}

#[test]
fn what_is_left_out_is_named() {
    let source = source(TANK);
    let given = Input {
        parts: vec![Part::Signals, Part::Tests, Part::Proofs],
        tests: Known::Missing(Missing::NotRun),
        answers: Known::Missing(Missing::NotRun),
        ..input(&source, Language::English)
    };
    let (_, text) = text(&given);
    for part in [
        "Left out: Charts, Variables and constants, Cross references",
        "Not run for this dossier.",
        "Not asked for this dossier.",
        "a press never fills",
        "never count > MOST",
    ] {
        assert!(text.contains(&bare(part)), "{part} is in\n{text}");
    }
}

#[test]
fn a_dossier_is_in_the_language_of_its_reader() {
    let source = source(TANK);
    for (language, words) in [
        (Language::English, ["Contents", "Inputs and outputs", "receptivity"]),
        (Language::French, ["Sommaire", "Entrées et sorties", "réceptivité"]),
        (Language::Portuguese, ["Índice", "Entradas e saídas", "recetividade"]),
    ] {
        let (_, text) = text(&input(&source, language));
        words.iter().for_each(|w| assert!(text.contains(&bare(w)), "{w}"));
    }
}

#[test]
fn the_contents_name_the_sheets_and_the_bytes_are_the_same_again() {
    let source = source(TANK);
    let input = input(&source, Language::English);
    let options = Options { font: false, ..Options::default() };
    let made = dossier(&input);
    let sheets = made.svgs(&options);
    for entry in &made.outline {
        let sheet = sheets.get(entry.page - 1).expect("a sheet");
        // The sheet of the part is that of its first chart.
        let first = entry.title.split_whitespace().next().expect("a word").trim_end_matches('s');
        assert!(sheet.contains(first), "{entry:?}");
    }
    assert_eq!(dossier(&input).svgs(&options), sheets);
}

#[test]
fn a_table_goes_on_over_sheets_and_loses_no_row() {
    let mut text_of = String::from("chart G {\n  initial step 1\n}\n");
    for n in 0..400 {
        text_of.push_str(&format!("input signal{n} : BOOL \"the comment of number {n}\"\n"));
    }
    let source = source(&text_of);
    let given = Input { parts: vec![Part::Signals], ..input(&source, Language::English) };
    let (sheets, text) = text(&given);
    assert!(sheets > 5, "{sheets}");
    assert_eq!(text.matches("safevalue").count(), sheets - 2, "each sheet of the table has its head");
    for n in 0..400 {
        assert!(text.contains(&format!("signal{n}input")), "{n}");
    }
    assert_eq!(text.matches("thecommentofnumber").count(), 400);
}
