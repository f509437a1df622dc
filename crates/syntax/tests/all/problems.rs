//! Wrong texts: what is told, where, and that the rest is read all the same.

use g7_model::{ChartItem, Document, FileId, Item, Problem};
use g7_syntax::{LineIndex, parse};

/// `line:column code words | help` of each problem.
fn told(text: &str) -> (Document, Vec<Problem>, Vec<String>) {
    let (document, problems) = parse(text, FileId(7));
    let lines = LineIndex::new(text);
    let shown = problems
        .iter()
        .map(|p| {
            assert_eq!(p.at.file, FileId(7));
            let place = lines.place(p.at.start);
            let help = p.help.as_deref().map(|h| format!(" | {h}")).unwrap_or_default();
            format!("{}:{} {} {}{help}", place.line, place.column, p.code.id, p.what)
        })
        .collect();
    (document, problems, shown)
}

/// Checks that the problems are just these: each begins with the first text and has the second in it.
fn expect(text: &str, wanted: &[(&str, &str)]) -> Document {
    let (document, _, shown) = told(text);
    let fits = shown.len() == wanted.len()
        && shown.iter().zip(wanted).all(|(s, (start, part))| s.starts_with(start) && s.contains(part));
    assert!(fits, "{text}\ntold:\n  {}\nwanted: {wanted:#?}", shown.join("\n  "));
    document
}

fn steps(document: &Document) -> Vec<&str> {
    document.charts().flat_map(|c| c.steps()).map(|s| &*s.name.text).collect()
}

#[test]
fn misspelt_words_are_read_as_what_was_meant() {
    let d = expect(
        "chrat G {\n  intial step 0\n  Step 1\n  stpe 2\n  0 -> 1 when a\n}\n",
        &[
            ("1:1 G0009", "did you mean `chart`?"),
            ("2:3 G0009", "did you mean `initial`?"),
            ("3:3 G0009", "in small letters: `step`"),
            ("4:3 G0009", "did you mean `step`?"),
        ],
    );
    assert_eq!(steps(&d), ["0", "1", "2"]);
    assert!(d.charts().next().is_some_and(|c| c.steps().next().is_some_and(|s| s.initial)));

    expect(
        "test \"t\" {\n  exepct a\n  pusle b\n}\nplant P {\n  stat level : REAL\n}\nprove alwys a\n",
        &[
            ("2:3 G0009", "did you mean `expect`?"),
            ("3:3 G0009", "did you mean `pulse`?"),
            ("6:3 G0009", "did you mean `state`?"),
            ("8:7 G0009", "did you mean `always`?"),
        ],
    );
    expect(
        "profile iec6113\nprofile unity { multitoken }\ntarget tsx47\n",
        &[
            ("1:9 G0009", "did you mean `iec61131`?"),
            ("2:17 G0009", "did you mean `multi-token`?"),
            ("3:8 G0009", "did you mean `tsx57`?"),
        ],
    );
}

#[test]
fn other_words_are_unknown() {
    expect(
        "chart G {\n  step 1 { PX V }\n}\n",
        &[("2:12 G0009", "`PX` is not a qualifier | there are N, S, R")],
    );
    expect("hello world\ninput a : BOOL\n", &[("1:1 G0009", "no item of a file begins with `hello`")]);
}

#[test]
fn signs_of_other_languages_are_told_and_understood() {
    let d = expect(
        "chart G {\n  0 -> 1 when a && b || c\n  1 -> 0 when a := b\n  1 => 2 when c\n}\naction A {\n  n = 2\n  n += 1\n}\nvar k : INT = 5\n",
        &[
            ("2:17 G0004", "write `and`"),
            ("2:22 G0004", "write `or`"),
            ("3:17 G0004", "a comparison is written `=`"),
            ("4:5 G0004", "a transition is written with `->`"),
            ("7:5 G0004", "an assignment is written `:=`"),
            ("8:5 G0004", "write `n := n + 1`"),
            ("10:13 G0004", "an assignment is written `:=`"),
        ],
    );
    let (right, problems) = parse(
        "chart G { 0 -> 1 when a and b or c  1 -> 0 when a = b  1 -> 2 when c }\naction A { n := 2  n := 1 }\nvar k : INT := 5",
        FileId(0),
    );
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(d, right);
}

#[test]
fn a_transition_without_its_parts() {
    expect(
        "chart G {\n  0 -> 1\n  1 -> 0 a and b\n  2 -> 1 if a\n  1 -> 3 : b\n  step 5\n  -> 1 when a\n  1 -> when b\n}\n",
        &[
            ("2:9 G0004 expected `when` and the receptivity", "`when =1` is always true"),
            ("3:10 G0004 `when` is missing", ""),
            ("4:10 G0004", "write `when`"),
            ("5:10 G0004", "write `when`"),
            ("7:3 G0004 the preceding steps are missing", "`() -> 1 when …`"),
            ("8:7 G0004 the succeeding steps are missing", "`1 -> () when …`"),
        ],
    );
    let d = expect(
        "chart G {\n  1 -> 2 -> 3 when a\n  step 4\n}\n",
        &[("2:10 G0004", "a step cannot follow a step: write a transition `1 -> 2 when …` between them")],
    );
    assert_eq!(d.charts().next().map(|c| c.transitions().count()), Some(2));
    expect("chart G {\n  1, 2 -> 3 when a\n}\n", &[("2:4 G0004", "write `(1, 2)`")]);
    expect("chart G {\n  1 -> step 2 when a\n}\n", &[("2:8 G0004", "leave out `step`")]);
    expect("chart G {\n  1\n  step 2\n}\n", &[("2:4 G0004 expected `->` after the preceding step `1`", "")]);
}

#[test]
fn an_action_without_its_qualifier() {
    let d = expect(
        "chart G {\n  step 0 { n := 1 }\n  step 1 { motor }\n}\n",
        &[
            ("2:12 G0004 an action begins with its qualifier", "write `P1 n := 1`"),
            ("3:12 G0004 an action begins with its qualifier", "write `N motor`"),
        ],
    );
    assert!(d.charts().flat_map(|c| c.steps()).all(|s| s.actions.len() == 1));
    expect(
        "chart G {\n  step 1 {\n    L V\n    N 5s V\n    D t V\n  }\n}\n",
        &[
            ("3:5 G0004 `L` needs a time", "write `L 5s …`"),
            ("4:7 G0004 `N` takes no time", ""),
            ("5:7 G0004", "write `(t)`"),
        ],
    );
}

#[test]
fn brackets_that_are_never_closed() {
    let text = "chart G {\n  step 0 {\n    N V\n  step 1\n  0 -> 1 when (a or b\n  (1, 2 -> 0 when a\n}\n\nchart H {\n  step 5\n";
    let (document, problems, shown) = told(text);
    assert_eq!(shown.len(), 4, "{shown:#?}");
    let lines = LineIndex::new(text);
    let places: Vec<_> = problems
        .iter()
        .map(|p| {
            let related = p.related.first().map(|(at, _)| lines.place(at.start)).expect("a related place");
            (lines.line(p.at.start), p.code.id, related.line, related.column)
        })
        .collect();
    assert_eq!(places, [(3, "G0003", 2, 10), (5, "G0003", 5, 15), (6, "G0003", 6, 3), (10, "G0003", 9, 9)]);
    assert_eq!(steps(&document), ["0", "1", "5"]);

    expect("chart G {\n  step 1 }\n}\n", &[("3:1 G0003 this `}` closes nothing", "")]);
    expect("action A {\n  IF a THEN\n    n := 2\n}\n", &[("3:11 G0003 expected `END_IF`", "")]);
    expect("chart G {\n  step 1\n\nplant P {\n}\n", &[("2:9 G0003", "before the next item of the file")]);
}

#[test]
fn texts_that_are_never_closed_end_with_their_line() {
    expect(
        "chart G {\n  step 1 \"abc\n  step `x\n  step 2\n}\nvar s : STRING := 'abc\n",
        &[
            ("2:10 G0003 this comment is not closed with `\"`", ""),
            ("3:8 G0003 this name is not closed with `` ` ``", ""),
            ("6:19 G0003 this text is not closed with `'`", ""),
        ],
    );
    expect("input a : BOOL\n/* note\n", &[("2:1 G0003 this note is never closed with `*/`", "")]);
}

#[test]
fn numbers_and_durations_that_cannot_be_read() {
    expect(
        "scan 10\nchart G {\n  1 -> 2 when 3xs/X1\n  2 -> 1 when 1h2h/X1\n  2 -> 3 when 1.5h3m/X1\n  3 -> 4 when 0.5ns/X1\n}\n",
        &[
            ("1:6 G0006 the unit of this duration is missing", "write `10s`"),
            ("3:15 G0006 `xs` is no unit of time", ""),
            ("4:15 G0006 the units of a duration go from large to small", ""),
            ("5:15 G0006 only the last number", ""),
            ("6:15 G0006 the duration is finer than one nanosecond", ""),
        ],
    );
    expect(
        "const a : INT := 16#XY\nconst b : INT := 3#12\nconst c : INT := SINT#200\nconst d : REAL := 1e999\nscan 200000d\n",
        &[
            ("1:18 G0005 `X` is no digit of base 16", ""),
            ("2:18 G0005 `3` is no base", ""),
            ("3:18 G0005 200 is no SINT: it holds -128 to 127", ""),
            ("4:19 G0005 the number is larger than LREAL can hold", ""),
            ("5:6 G0006 the duration is too long", ""),
        ],
    );
}

#[test]
fn words_of_the_language_are_no_names() {
    expect(
        "var when : BOOL\nchart G {\n  step not\n  step 2\n}\n",
        &[("1:5 G0004", "`` `when` ``"), ("3:8 G0004", "`not` is a word of the language")],
    );
    let d = expect("var at, max, on, state, t : BOOL\nchart G { step scan\n scan -> at when on }\n", &[]);
    assert_eq!(d.items.len(), 2);
}

#[test]
fn declarations() {
    expect(
        "input a = TRUE\ninput b BOOL\nconst c : INT\ninput d : BOOL retain\nvar e : BOOL safe TRUE\n",
        &[
            ("1:9 G0004 expected `:` and a type", "for example `a : BOOL`"),
            ("2:9 G0004 `:` is missing before the type", ""),
            ("3:14 G0004 expected `:=` and the value", ""),
            ("4:16 G0004 `retain` belongs to `var`", ""),
            ("5:14 G0004 `safe` belongs to `output`", ""),
        ],
    );
}

#[test]
fn a_chart_without_its_frame() {
    expect(
        "step 1\n1 -> 2 when a\ninput b : BOOL\n",
        &[("1:1 G0004", "write it between the braces of a chart")],
    );
    expect("test \"t\" {\n  a := TRUE\n}\n", &[("2:3 G0004", "`set a := TRUE`")]);
}

#[test]
fn characters_without_a_meaning_are_skipped() {
    let d = expect("input a @@ : BOOL $\nvar b : INT\n", &[("1:9 G0002", "`@@`"), ("1:19 G0002", "`$`")]);
    assert_eq!(d.items.len(), 2);
}

/// Problems of one run are many, and the items around them are kept.
#[test]
fn reading_goes_on_behind_each_problem() {
    let mut text = String::new();
    for i in 0..30 {
        text.push_str(&format!("chart G{i} {{\n  step 1 {{ 5 }}\n  step 2\n  1 -> 2 when )\n}}\n"));
    }
    let (document, problems, _) = told(&text);
    assert_eq!(problems.len(), 60);
    assert_eq!(document.items.len(), 30);
    assert!(document.charts().all(|c| c.steps().count() == 2));
    let transitions =
        |c: &g7_model::Chart| c.items.iter().filter(|i| matches!(i, ChartItem::Transition(_))).count();
    assert!(document.items.iter().all(|i| matches!(i, Item::Chart(c) if transitions(c) == 1)));

    let (_, problems, shown) = told(&text.repeat(5));
    assert_eq!(problems.len(), 101);
    assert!(shown.last().is_some_and(|s| s.contains("G0010")), "{:?}", shown.last());
}
