//! No text and no bytes make the parser panic, overflow the stack or take long.
#![allow(clippy::disallowed_methods, reason = "the time of a run is what is tested")]

use g7_model::{FileId, Problem};
use g7_syntax::{parse, parse_bytes, parse_expr, parse_statements, print, print_expr};
use proptest::prelude::*;
use std::time::{Duration, Instant};

const MEGABYTES: usize = 10 << 20;

/// Parses, with a limit that leaves room for slow machines: quadratic work takes hours here.
fn within_seconds(text: &str) -> Vec<Problem> {
    let start = Instant::now();
    let (document, problems) = parse(text, FileId(0));
    let problem_count = problems.len();
    let printed = print(&document, Some(text));
    drop(document);
    let took = start.elapsed();
    let head: String = text.chars().take(40).collect();
    assert!(took < Duration::from_secs(20), "{head:?}… took {took:?}, printed {} bytes", printed.len());
    assert!(problem_count <= 101, "{head:?}… has {problem_count} problems");
    problems
}

fn ids(problems: &[Problem]) -> Vec<&'static str> {
    problems.iter().map(|p| p.code.id).collect()
}

#[test]
fn ten_megabytes_of_brackets() {
    for piece in
        ["(", "{", "[", ")", "}", "]", "((*", "{(", "()", "{}", "([", "\"", "`", "'", "/*", "<", "->"]
    {
        let text = piece.repeat(MEGABYTES / piece.len());
        assert!(!within_seconds(&text).is_empty(), "{piece}");
    }
}

#[test]
fn ten_megabytes_of_beginnings() {
    let heads = [
        "chart G { ",
        "chart G {\nstep 1 {\n",
        "test \"t\" {\n",
        "plant P {\n",
        "action A {\n",
        "prove always ",
    ];
    let pieces = [
        "(",
        "{ ",
        "a\n",
        "a.",
        "1 -> ",
        "-> 2 when ",
        "step\n",
        "IF a THEN\n",
        "CASE a OF 1:\n",
        "not ",
        "a + ",
        "1s/",
        "a'",
        "f(",
        "\n- 1:",
        "repeat 2 {\n",
        "always a {\n",
        "n := n\n",
        "on a: {\n",
        "\u{305}",
        "1..",
        "é",
        "0",
        "REPEAT ",
        "force G := {",
        "1, ",
        ": ",
        "`x`",
        "%X1",
        "@",
        "\n",
        "a(b)\n",
        "(1, 2",
        "16#FF2.5 ",
        "16#F : ",
        "1_0 -> ",
    ];
    for head in heads {
        for piece in pieces {
            let text = format!("{head}{}", piece.repeat((MEGABYTES / 16) / piece.len()));
            within_seconds(&text);
        }
    }
}

/// A large chart is ordinary work: about 0.1 s in a release build.
#[test]
fn a_hundred_thousand_steps() {
    let mut text = String::from("input a : BOOL\noutput V : BOOL\nvar n : INT\nchart G {\n");
    for i in 0..100_000 {
        text.push_str(&format!("  step {i} {{ N V }}\n  {i} -> {} when a and X{i}.t >= 5s\n", i + 1));
    }
    text.push_str("}\n");
    let start = Instant::now();
    let (document, problems) = parse(&text, FileId(0));
    let took = start.elapsed();
    assert!(problems.is_empty());
    assert_eq!(document.charts().map(|c| c.items.len()).sum::<usize>(), 200_000);
    assert!(took < Duration::from_secs(10), "{took:?}");
}

#[test]
fn case_with_many_words() {
    let text = format!("action A {{ CASE n OF 1:\n{}", "a a\n".repeat(MEGABYTES / 16));
    assert!(!within_seconds(&text).is_empty());
}

#[test]
fn nul_bytes_are_one_problem_for_a_run() {
    let bytes = vec![0; MEGABYTES];
    let (_, problems) = parse_bytes(&bytes, FileId(0));
    assert_eq!(ids(&problems)[0], "G0002");
    assert!(problems.len() <= 2, "{:?}", ids(&problems));
}

#[test]
fn long_chains_are_cut() {
    let chain = vec!["a"; 1_000_000].join(" or ");
    let (e, problems) = parse_expr(&chain, FileId(0));
    assert!(ids(&problems).contains(&"G0007"));
    let _ = print_expr(&e.clone());
    assert_eq!(e, e.clone());

    let sensible = vec!["a"; 400].join(" or ");
    let (e, problems) = parse_expr(&sensible, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(print_expr(&e), sensible);
}

#[test]
fn deep_nesting_is_cut() {
    for (open, close) in
        [("(", ")"), ("not (", ")"), ("f(", ")"), ("[", "]"), ("↑(", ")"), ("delay(1s, ", ")")]
    {
        let text = format!("{}a{}", open.repeat(100_000), close.repeat(100_000));
        let (_, problems) = parse_expr(&text, FileId(0));
        assert_eq!(ids(&problems).first(), Some(&"G0007"), "{open}");

        let text = format!("{}a{}", open.repeat(100), close.repeat(100));
        let (_, problems) = parse_expr(&text, FileId(0));
        assert!(problems.is_empty(), "{open}: {problems:?}");
    }
    let text = format!("{}{}", "IF a THEN\n".repeat(100_000), "END_IF\n".repeat(100_000));
    let (_, problems) = parse_statements(&text, FileId(0));
    assert_eq!(ids(&problems)[0], "G0007");
}

/// The deepest trees that are allowed: all that later stages do to them must fit a thread's stack.
#[test]
fn the_deepest_allowed_tree_can_be_used() {
    let level = "a or b xor c and d = e < f + g * h ** ";
    let mut text = String::new();
    for _ in 0..100 {
        text.push_str(level);
        text.push('(');
    }
    text.push('z');
    text.push_str(&")".repeat(100));
    let (e, _) = parse_expr(&text, FileId(0));
    let copy = e.clone();
    assert_eq!(copy, e);
    assert!(!format!("{e:?}{}", print_expr(&e)).is_empty());
}

#[test]
fn broken_utf8_is_told_with_its_place() {
    let (document, problems) =
        parse_bytes(b"input a : BOOL\ninput \xff\xfe b : BOOL\nvar n : INT \xc3", FileId(0));
    assert_eq!(document.items.len(), 3);
    let places: Vec<_> = problems.iter().map(|p| (p.code.id, p.at.start, p.at.end)).collect();
    assert_eq!(places[..3], [("G0001", 21, 22), ("G0001", 22, 23), ("G0001", 45, 46)]);

    let (_, problems) = parse_bytes(b"\xff\xfei\0n\0p\0u\0t\0", FileId(0));
    assert_eq!(problems[0].code.id, "G0001");
    assert!(problems[0].what.contains("UTF-16"));
}

#[test]
fn a_byte_order_mark_is_no_problem() {
    let (document, problems) = parse_bytes("\u{feff}input a : BOOL".as_bytes(), FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(document.items.len(), 1);
}

#[test]
fn a_file_beyond_all_sense_is_refused() {
    let text = " ".repeat((64 << 20) + 1);
    let (document, problems) = parse(&text, FileId(0));
    assert!(document.items.is_empty());
    assert_eq!(ids(&problems), ["G0008"]);
    assert_eq!(ids(&parse_bytes(text.as_bytes(), FileId(0)).1), ["G0008"]);
    assert_eq!(ids(&parse_expr(&text, FileId(0)).1), ["G0008"]);
    assert_eq!(ids(&parse_statements(&text, FileId(0)).1), ["G0008"]);
}

#[test]
fn huge_numbers_are_told() {
    let big = "9".repeat(100_000);
    for (text, code) in [
        (format!("const n : INT := {big}"), "G0005"),
        (format!("const n : INT := 16#{big}"), "G0005"),
        (format!("const n : REAL := {big}.0e{big}"), "G0005"),
        (format!("scan {big}s"), "G0006"),
        (format!("test \"t\" {{ repeat {big} {{ scan {big} }} }}"), "G0005"),
        ("test \"t\" { scan 5000000000 }".into(), "G0005"),
        (format!("layout G {{ step 1 at ({big}, 0) }}"), "G0005"),
        (format!("var s : STRING({big})"), "G0005"),
        ("chart G { (1..1000000000) -> 2 when a }".into(), "G0003"),
    ] {
        let problems = within_seconds(&text);
        assert_eq!(ids(&problems).first(), Some(&code), "{}", &text[..40.min(text.len())]);
    }
}

/// Pieces that make the parser take every turn.
const SOUP: &[&str] = &[
    "chart",
    "G",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "step",
    "initial",
    "entry",
    "exit",
    "enclosing",
    "macro",
    "=",
    ":=",
    ":",
    ";",
    ",",
    "->",
    "when",
    "on",
    "clearing",
    "priority",
    "1",
    "2.5",
    "3s",
    "T#5s",
    "INT#3",
    "16#FF",
    "%X1.T",
    "\"c\"",
    "'s'",
    "`n`",
    "a",
    "X12",
    ".",
    "·",
    "↑",
    "↓",
    "'",
    "\u{305}",
    "not",
    "and",
    "or",
    "xor",
    "mod",
    "/",
    "*",
    "**",
    "-",
    "+",
    "<",
    ">",
    "<=",
    "<>",
    "!=",
    "&&",
    "||",
    "==",
    "=>",
    "..",
    "#",
    "@",
    "\u{0}",
    "//",
    "/*",
    "*/",
    "(*",
    "*)",
    "\n",
    "N",
    "S",
    "L",
    "P1",
    "SD",
    "each",
    "scan",
    "force",
    "INIT",
    "enable",
    "mask",
    "call",
    "enclose",
    "if",
    "IF",
    "THEN",
    "ELSE",
    "END_IF",
    "CASE",
    "OF",
    "END_CASE",
    "FOR",
    "TO",
    "DO",
    "END_FOR",
    "WHILE",
    "REPEAT",
    "UNTIL",
    "EXIT",
    "RETURN",
    "input",
    "output",
    "var",
    "const",
    "BOOL",
    "STRING",
    "at",
    "retain",
    "safe",
    "inverted",
    "plant",
    "state",
    "rate",
    "drive",
    "parts",
    "max",
    "length",
    "arrivals",
    "every",
    "view",
    "in",
    "test",
    "set",
    "pulse",
    "wait",
    "within",
    "expect",
    "always",
    "fault",
    "restart",
    "repeat",
    "prove",
    "after",
    "layout",
    "profile",
    "iec60848",
    "bound",
    "target",
    "function",
    "action",
    "transition",
    "section",
    "pre",
    "post",
    "il",
    "ld",
    "st",
    "task",
    "macrochart",
    "delay",
    "rise",
    "fall",
    "TRUE",
    "stpe",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn token_soup_ends_with_problems_or_a_document(
        picks in prop::collection::vec((0..SOUP.len(), any::<bool>()), 0..80),
    ) {
        let mut text = String::new();
        for (i, blank) in picks {
            text.push_str(SOUP[i]);
            text.push_str(if blank { " " } else { "" });
        }
        check(&text);
        let _ = print_expr(&parse_expr(&text, FileId(0)).0);
        parse_statements(&text, FileId(0));
    }

    #[test]
    fn any_bytes_end_with_problems_or_a_document(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let (document, problems) = parse_bytes(&bytes, FileId(0));
        print(&document, None);
        for p in problems {
            prop_assert!(p.at.start <= p.at.end && p.at.end as usize <= bytes.len());
        }
    }

    #[test]
    fn any_text_ends_with_problems_or_a_document(text in "\\PC{0,100}") {
        check(&text);
    }
}

/// Every place of a problem lies in the text, on the borders of characters.
fn check(text: &str) {
    let (document, problems) = parse(text, FileId(0));
    for p in &problems {
        let places = std::iter::once(p.at).chain(p.related.iter().map(|(at, _)| *at));
        for at in places {
            assert!(text.get(at.start as usize..at.end as usize).is_some(), "{p:?} in {text:?}");
        }
    }
    let printed = print(&document, Some(text));
    if problems.is_empty() {
        let (again, problems) = parse(&printed, FileId(0));
        assert!(problems.is_empty() && again == document, "{text:?} printed as {printed:?}: {problems:?}");
    }
}
