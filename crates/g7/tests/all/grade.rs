//! `g7 grade` and `g7 new exercise`: exercises, submissions, what is told of them, and what is written.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::common;

use common::{Folder, Ran};
use serde_json::Value;

/// A right solution of the exercise of `g7 new exercise`.
const RIGHT: &str = "input button : BOOL\noutput lamp : BOOL\nchart Lamp {\n  initial step 0\n  step 1 { N lamp }\n  \
                     0 -> 1 when ↑button\n  1 -> 0 when ↑button\n}\n";

/// A folder with an exercise in `lamp`.
fn lamp() -> Folder {
    let folder = Folder::new();
    folder.g7(&["new", "exercise", "lamp"]).is(0);
    folder
}

/// The exercise with submissions in `in`.
fn with(submissions: &[(&str, &str)]) -> Folder {
    let folder = lamp();
    submissions.iter().for_each(|(name, text)| folder.write(&format!("in/{name}"), text));
    folder
}

/// All results of the submissions.
fn graded(folder: &Folder, more: &[&str]) -> (Ran, Value) {
    let ran = folder.g7(&[&["grade", "lamp", "in", "--json", "all.json"][..], more].concat());
    assert!(ran.code < 2, "{}", ran.err);
    let value = serde_json::from_str(&folder.read("all.json")).expect("JSON");
    (ran, value)
}

fn row<'v>(all: &'v Value, name: &str) -> &'v Value {
    let rows = all["submissions"].as_array().expect("rows");
    rows.iter().find(|r| r["submission"] == name).unwrap_or_else(|| panic!("no {name} in {all:#}"))
}

fn notes(row: &Value) -> String {
    row["notes"]
        .as_array()
        .expect("notes")
        .iter()
        .map(|n| format!("{}\n", n.as_str().expect("text")))
        .collect()
}

#[test]
fn a_new_exercise_is_right_in_each_language() {
    let folder = lamp();
    for (lang, title, right) in [
        ("en", "A lamp with one button", "the exercise is right"),
        ("fr", "Une lampe et un bouton", "l’exercice est correct"),
        ("pt", "Uma lâmpada e um botão", "o exercício está correto"),
    ] {
        let ran = folder.g7(&["grade", "lamp", "--lang", lang]);
        let out = &ran.is(0).out;
        assert!(out.starts_with(title) && out.ends_with(&format!("{right}\n")), "{out}");
        assert_eq!(out.matches("wrong/").count(), 3, "{out}");
    }
    folder.g7(&["check", "lamp"]).is(0);
    folder.g7(&["fmt", "--check", "lamp"]).is(0);
    folder.g7(&["test", "lamp/model.g7"]).is(0);
    folder.g7(&["new", "exercise", "lamp"]).is_refused(&["lamp is not empty"]);
    folder.g7(&["new", "tank", "lamp"]).is_refused(&["only `g7 new exercise`"]);
}

#[test]
fn each_submission_is_graded_as_what_it_is() {
    let stays = RIGHT.replace("  1 -> 0 when ↑button\n", "");
    let fitted = RIGHT.replace("  1 -> 0 when ↑button\n", "  step 2 { N lamp }\n  1 -> 2 when ↑button\n");
    let changed = RIGHT.replace("output lamp : BOOL", "output lamp : BOOL safe TRUE");
    let folder = with(&[
        ("right.g7", RIGHT),
        ("nothing.g7", "input button : BOOL\noutput lamp : BOOL\nchart Lamp { initial step 0 }\n"),
        ("stays.g7", &stays),
        ("fitted.g7", &fitted),
        ("changed.g7", &changed),
        ("broken.g7", "chart Lamp {\n  initial step 0\n  0 -> when\n"),
        (
            "unknown.g7",
            "input button : BOOL\noutput lamp : BOOL\nchart Lamp {\n  initial step 0 { N lump }\n}\n",
        ),
        ("notes.txt", "I could not do it, sorry.\n"),
        ("empty.g7", ""),
        (".hidden", "not a submission"),
    ]);
    let (ran, all) = graded(&folder, &[]);
    ran.is(1);
    let results = [
        ("right.g7", "passed"),
        ("nothing.g7", "failed"),
        ("stays.g7", "passes the visible tests only"),
        ("fitted.g7", "passes the visible tests only"),
        ("changed.g7", "locked part changed"),
        ("broken.g7", "errors"),
        ("unknown.g7", "errors"),
        ("notes.txt", "errors"),
        ("empty.g7", "failed"),
    ];
    for (name, result) in results {
        assert_eq!(row(&all, name)["result"], result, "{name}: {:#}", row(&all, name));
    }
    assert_eq!(all["submissions"].as_array().map(Vec::len), Some(results.len()), "hidden files are none");
    let told = |name: &str| notes(row(&all, name));
    assert!(told("broken.g7").starts_with("broken.g7:3:"), "{}", told("broken.g7"));
    assert!(told("unknown.g7").contains("unknown.g7:4:22"), "{}", told("unknown.g7"));
    assert!(told("notes.txt").contains("this is no .g7 file"), "{}", told("notes.txt"));
    assert!(told("changed.g7").contains("changed.g7:2:1: the locked part `lamp`"), "{}", told("changed.g7"));
    let stays = row(&all, "stays.g7");
    let tests = stays["tests"].as_array().expect("tests");
    let passed: Vec<(bool, bool)> =
        tests.iter().map(|t| (t["hidden"] == true, t["passed"] == true)).collect();
    assert_eq!(passed, [(false, true), (false, true), (true, false), (true, false)], "{stays:#}");
    assert_eq!(tests[2]["failure"]["expected"], "not lamp");
    assert!(tests[2]["failure"]["chronogram"].as_str().is_some_and(|c| c.contains("lamp")), "{stays:#}");
    assert_eq!(row(&all, "right.g7")["coverage"]["reached"], row(&all, "right.g7")["coverage"]["elements"]);
}

#[test]
fn tests_plants_and_settings_of_a_submission_do_not_count() {
    let folder = with(&[
        (
            "own-tests.g7",
            "input button : BOOL\noutput lamp : BOOL\nchart Lamp { initial step 0 }\ntest \"one push turns the lamp on\" { \
             expect not lamp }\nassume not button\nplant P { drive button := FALSE }\n",
        ),
        ("slow.g7", &format!("scan 100ms\n{RIGHT}")),
        ("other-rules.g7", &format!("profile iec61131\n{RIGHT}")),
    ]);
    let (_, all) = graded(&folder, &[]);
    let own = row(&all, "own-tests.g7");
    assert_eq!(
        (&own["result"], own["tests"].as_array().map(Vec::len)),
        (&"failed".into(), Some(4)),
        "{own:#}"
    );
    assert_eq!(own["questions"][0]["refuted"], true, "the lamp is never on: {own:#}");
    for (name, setting) in [("slow.g7", "scan"), ("other-rules.g7", "profile")] {
        let row = row(&all, name);
        assert_eq!(row["result"], "locked part changed", "{row:#}");
        assert!(notes(row).starts_with(&format!("{name}:1:1: the template leaves `{setting}`")), "{row:#}");
    }
}

#[test]
fn names_that_are_missing_are_told_with_the_nearest_one() {
    let folder = with(&[("lump.g7", &RIGHT.replace("lamp", "lump")), ("right.g7", RIGHT)]);
    folder.write(
        "lamp/template.g7",
        folder.read("lamp/template.g7") + "\ntest \"button is there\" {\n  pulse button\n}\n",
    );
    let (_, all) = graded(&folder, &[]);
    let lump = row(&all, "lump.g7");
    assert_eq!(lump["result"], "failed");
    assert_eq!(lump["names_missing"][0]["name"], "lamp", "{lump:#}");
    assert_eq!(lump["names_missing"][0]["near"]["name"], "lump");
    assert_eq!(lump["names_missing"][0]["near"]["place"], "lump.g7:2:8");
    assert_eq!(lump["names_missing"].as_array().map(Vec::len), Some(1), "the button is there");
    let passed = |title: &str| {
        let tests = lump["tests"].as_array().expect("tests");
        tests.iter().find(|t| t["title"] == title).expect("the test")["passed"].clone()
    };
    assert_eq!(passed("button is there"), true, "it needs no lamp: {lump:#}");
    assert_eq!(passed("one push turns the lamp on"), false);
    assert_eq!(row(&all, "right.g7")["result"], "passed");
}

#[test]
fn a_submission_that_takes_too_long_is_ended_and_the_others_are_graded() {
    // Each scan takes some milliseconds, and the test has six thousand of them.
    let slow = format!(
        "{RIGHT}var n : DINT\npost {{\n  var i : DINT\n  FOR i := 1 TO 40000 DO n := (n + i) MOD 1000 END_FOR\n}}\n"
    );
    let folder = with(&[("slow.g7", &slow), ("right.g7", RIGHT)]);
    let minute = "\ntest \"a minute\" {\n  wait 60s\n}\n";
    folder.write("lamp/template.g7", folder.read("lamp/template.g7") + minute);
    let (ran, all) = graded(&folder, &["--timeout", "2s"]);
    ran.is(1);
    let slow = row(&all, "slow.g7");
    let ended =
        slow["tests"].as_array().expect("tests").iter().any(|t| t["failure"]["ended_for_time"] == true);
    assert!(ended, "{slow:#}");
    assert_eq!(row(&all, "right.g7")["result"], "passed");
}

#[test]
fn an_evolution_without_end_is_a_failed_test() {
    let folder = with(&[(
        "loop.g7",
        "input button : BOOL\noutput lamp : BOOL\nchart Lamp {\n  initial step 0\n  step 1 { N lamp }\n  0 -> 1 when \
         TRUE\n  1 -> 0 when TRUE\n}\n",
    )]);
    let (_, all) = graded(&folder, &[]);
    assert_eq!(row(&all, "loop.g7")["result"], "failed", "{all:#}");
}

#[test]
fn a_file_that_is_too_large_is_not_read() {
    let folder = with(&[("right.g7", RIGHT)]);
    folder.write("in/large.g7", " ".repeat((8 << 20) + 1));
    folder.write("in/deep.g7", format!("{RIGHT}var x : BOOL := {}TRUE\n", "(".repeat(100_000)));
    folder.write("in/bytes.g7", [0xff, 0xfe, 0, 1, 2, 3]);
    let (_, all) = graded(&folder, &[]);
    assert!(notes(row(&all, "large.g7")).contains("longer than 8 MiB"), "{all:#}");
    assert_eq!(row(&all, "deep.g7")["result"], "errors");
    assert_eq!(row(&all, "bytes.g7")["result"], "errors");
    assert_eq!(row(&all, "right.g7")["result"], "passed");
}

#[test]
fn charts_are_alike_whatever_their_names_notes_and_order() {
    let renamed = "// mine\ninput button : BOOL \"knob\"\noutput lamp : BOOL\n\nchart Lamp {\n  step on \"it shines\" { N lamp }\n  \
                   on -> off when ↑button\n  initial step off\n  off -> on when ↑button\n}\n";
    let other = RIGHT.replace("1 -> 0 when ↑button", "1 -> 0 when ↓button");
    let folder = with(&[("a.g7", RIGHT), ("b.g7", renamed), ("c.g7", &other), ("d.g7", "chart {")]);
    let (_, all) = graded(&folder, &[]);
    let like = |name: &str| row(&all, name)["the_same_but_for_names"].clone();
    assert_eq!(like("a.g7"), serde_json::json!(["model.g7", "b.g7"]));
    assert_eq!(like("b.g7"), serde_json::json!(["model.g7", "a.g7"]));
    assert_eq!((like("c.g7"), like("d.g7")), (serde_json::json!([]), serde_json::json!([])));
    let out = folder.g7(&["grade", "lamp", "in"]).out;
    assert_eq!(out.matches("the same but for names").count(), 1, "each group once: {out}");
    assert!(out.contains("\nthe same but for names: model.g7, a.g7, b.g7\n"), "{out}");
}

#[test]
fn names_of_the_template_are_no_choice_of_the_author() {
    // Two rings of three steps and one of six look the same from each step, and two lamps that are exchanged too.
    let ring = |ends: &str| {
        let steps: String = (1..6).map(|n| format!("  step {n} {{ N lamp }}\n")).collect();
        format!(
            "input button : BOOL\noutput lamp : BOOL\nchart Lamp {{\n  initial step 0 {{ N lamp }}\n{steps}{ends}}}\n"
        )
    };
    let arcs = |list: &[(u8, u8)]| -> String {
        list.iter().map(|(a, b)| format!("  {a} -> {b} when ↑button\n")).collect()
    };
    let folder = with(&[
        ("one.g7", &ring(&arcs(&[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)]))),
        ("same.g7", &ring(&arcs(&[(0, 5), (5, 4), (4, 3), (3, 2), (2, 1), (1, 0)]))),
        ("two.g7", &ring(&arcs(&[(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)]))),
        ("swapped.g7", &RIGHT.replace("button", "x").replace("lamp", "button").replace('x', "lamp")),
    ]);
    let (_, all) = graded(&folder, &[]);
    let like = |name: &str| row(&all, name)["the_same_but_for_names"].clone();
    assert_eq!(like("one.g7"), serde_json::json!(["same.g7"]), "{all:#}");
    assert_eq!(like("two.g7"), serde_json::json!([]));
    assert_eq!(like("swapped.g7"), serde_json::json!([]));
}

#[test]
fn a_folder_is_a_submission_and_reads_no_other() {
    let part = "chart Lamp {\n  initial step 0\n  step 1 { N lamp }\n  0 -> 1 when ↑button\n  1 -> 0 when ↑button\n}\n";
    let head = "use 'part.g7'\ninput button : BOOL\noutput lamp : BOOL\n";
    let thief = |of: &str| head.replace("part.g7", of);
    let folder = with(&[
        ("lea/template.g7", head),
        ("lea/part.g7", part),
        ("max/template.g7", &thief("../lea/part.g7")),
        ("part.g7", part),
        ("tom.g7", head),
        ("ida/a.txt", "?"),
        ("ida/b.txt", "?"),
    ]);
    let (_, all) = graded(&folder, &[]);
    assert_eq!(row(&all, "lea")["result"], "passed", "{:#}", row(&all, "lea"));
    assert_eq!(row(&all, "lea")["the_same_but_for_names"], serde_json::json!(["model.g7"]));
    for name in ["max", "tom.g7", "ida"] {
        assert_eq!(row(&all, name)["result"], "errors", "{:#}", row(&all, name));
    }
    assert!(notes(row(&all, "max")).contains("lies outside of the folder"), "{:#}", row(&all, "max"));
}

#[test]
fn a_chart_of_another_tool_is_a_submission() {
    let folder = lamp();
    let profile = "profile jgrafchart\nscan 40ms\n";
    for name in ["template.g7", "model.g7", "wrong/level.g7", "wrong/stays-on.g7", "wrong/two-pushes.g7"] {
        folder.write(&format!("lamp/{name}"), format!("{profile}{}", folder.read(&format!("lamp/{name}"))));
    }
    folder.write(
        "template.g7",
        folder
            .read("lamp/template.g7")
            .replace("// locked: the button and the lamp are wired like this\n", ""),
    );
    folder.write("lamp/template.g7", folder.read("template.g7"));
    folder.write("right.g7", format!("{profile}{RIGHT}"));
    std::fs::create_dir_all(folder.path("in")).expect("a folder");
    folder.g7(&["export", "right.g7", "-o", "in/Right.xml", "--to", "jgrafchart"]).is(0);
    let (_, all) = graded(&folder, &[]);
    assert_eq!(row(&all, "Right.xml")["result"], "passed", "{all:#}");
}

/// The exercise refuses with this sentence at this place, and grades nobody.
#[track_caller]
fn refuses(change: impl Fn(&Folder), place: &str, what: &str) {
    let folder = with(&[("right.g7", RIGHT)]);
    change(&folder);
    for args in [&["grade", "lamp"][..], &["grade", "lamp", "in", "--csv", "t.csv"]] {
        let ran = folder.g7(args);
        ran.is(1);
        let line = ran.err.lines().find(|l| l.starts_with(&format!("{place}: error: ")));
        assert!(line.is_some_and(|l| l.contains(what)), "{place} {what}: {}", ran.err);
        assert_eq!(ran.out, "");
    }
    assert!(!folder.path("t.csv").exists());
}

#[test]
fn mistakes_of_an_exercise_are_told_to_its_teacher() {
    let edit = |name: &'static str, from: &'static str, to: &'static str| {
        move |folder: &Folder| {
            let text = folder.read(name);
            assert!(text.contains(from), "{name}: {from}");
            folder.write(name, text.replace(from, to));
        }
    };
    let remove =
        |name: &'static str| move |folder: &Folder| std::fs::remove_file(folder.path(name)).expect("removed");
    refuses(remove("lamp/statement.md"), "lamp/statement.md", "has a statement");
    refuses(remove("lamp/template.g7"), "lamp/template.g7", "what the student gets");
    refuses(remove("lamp/model.g7"), "lamp/model.g7", "the model solution");
    refuses(
        edit("lamp/template.g7", "expect not lamp", "expect not lump"),
        "lamp/template.g7:11:14",
        "nothing is called",
    );
    refuses(
        edit("lamp/hints.fr.md", "## Quand", "Quand"),
        "lamp/hints.fr.md",
        "hints here: 2; in English: 3",
    );
    refuses(
        edit("lamp/template.g7", "like this\n", "like this\n\n"),
        "lamp/template.g7:1:1",
        "this note locks nothing",
    );
    refuses(
        edit("lamp/model.g7", "\"a long push counts once\"", "\"one push turns the lamp on\""),
        "lamp/model.g7:21:1",
        "the template has this too, and not the same",
    );
    refuses(
        edit("lamp/model.g7", "1 -> 0 when ↑button", "1 -> 0 when ↓button"),
        "lamp/template.g7:16:10",
        "the model solution fails the test `one push turns the lamp on`",
    );
    refuses(
        edit("lamp/model.g7", "prove reachable lamp", "prove never lamp"),
        "lamp/model.g7:32:1",
        "does not keep this",
    );
    refuses(
        |folder| folder.write("lamp/wrong/right.g7", RIGHT),
        "lamp/wrong/right.g7",
        "no test catches this wrong solution",
    );
    refuses(
        |folder| folder.write("lamp/wrong/broken.g7", "chart Lamp {"),
        "lamp/wrong/broken.g7",
        "has errors, so that no test can catch it",
    );
    let no_tests = |folder: &Folder| {
        for name in ["lamp/template.g7", "lamp/model.g7"] {
            let text = folder.read(name);
            folder.write(name, text.split("\ntest ").next().expect("a text"));
        }
    };
    refuses(no_tests, "lamp/template.g7", "the exercise has no test");
}

#[test]
fn pages_are_written_whole_and_tell_students_nothing_hidden() {
    let stays = RIGHT.replace("  1 -> 0 when ↑button\n", "");
    let folder = with(&[("<b>.g7", RIGHT), ("stays.g7", &stays), ("Stays.g7", &stays)]);
    let grade = |more: &[&str]| folder.g7(&[&["grade", "lamp", "in", "--html", "report"][..], more].concat());
    grade(&[]).is(1);
    let names = |name: &str| -> BTreeSet<String> {
        let list = std::fs::read_dir(folder.path(name)).expect("a folder");
        list.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    };
    let wanted = ["Stays.html", "_b_.html", "index.html", "stays-2.html"].map(str::to_owned);
    assert_eq!(names("report"), BTreeSet::from(wanted));
    let index = folder.read("report/index.html");
    assert!(index.contains("the second push turns the lamp off") && index.contains("<pre"), "{index}");
    assert!(index.contains("&lt;b&gt;.g7") && !index.contains("<b>.g7"), "{index}");
    let page = folder.read("report/stays-2.html");
    for hidden in ["the second push", "a long push", "model.g7", "reachable"] {
        assert!(!page.contains(hidden), "`{hidden}` in {page}");
    }
    assert!(page.contains("one push turns the lamp on") && page.contains("hidden test 1"), "{page}");
    assert!(page.contains("<svg"), "the chart is drawn");
    assert!(index.contains("stays-on.g7, Stays.g7, stays.g7"), "{index}");
    assert!(!page.contains("Stays.g7"), "a student learns nothing of others: {page}");
    // Written again over its own pages, with one submission less.
    std::fs::remove_file(folder.path("in/Stays.g7")).expect("removed");
    grade(&[]).is(1);
    assert_eq!(names("report").len(), 3);
    folder.write("report/mine.txt", "mine");
    grade(&[]).is_refused(&["mine.txt is there, and g7 grade did not write it"]);
    assert_eq!((names("report").len(), folder.read("report/mine.txt")), (4, "mine".to_owned()));
    assert!(folder.names().iter().all(|n| !n.contains(".report")), "{:?}", folder.names());
    folder.g7(&["grade", "lamp", "in", "--html", "in"]).is_refused(&["is in itself"]);
}

#[test]
fn tables_are_written_for_programs_and_replace_nothing_foreign() {
    let folder = with(&[("=1+1.g7", RIGHT), ("a,b.g7", "chart {")]);
    folder.write("mine.csv", "mine");
    let grade =
        |file: &str, more: &[&str]| folder.g7(&[&["grade", "lamp", "in", "--csv", file][..], more].concat());
    grade("mine.csv", &[]).is_refused(&["mine.csv is there, and g7 did not write it"]);
    assert_eq!(folder.read("mine.csv"), "mine");
    grade("t.csv", &[]).is(1);
    grade("t.csv", &[]).is(1);
    grade("mine.csv", &["--force"]).is(1);
    let text = folder.read("t.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3, "{text}");
    let columns = lines[0].split(',').count();
    assert!(lines[1].starts_with("'=1+1.g7,passed,4,4,2,2,2,2,"), "no formula of a spreadsheet: {text}");
    assert_eq!(lines[1].split(',').count(), columns, "{text}");
    assert!(lines[2].starts_with("\"a,b.g7\",errors,"), "{text}");
    assert_eq!(lines[2].split(',').count(), columns + 1, "{text}");
    folder.g7(&["grade", "lamp", "nowhere"]).is_refused(&["nowhere"]);
    std::fs::create_dir_all(folder.path("none")).expect("a folder");
    folder.g7(&["grade", "lamp", "none"]).is_refused(&["none has no submission"]);
    folder.g7(&["grade", "nowhere"]).is_refused(&["nowhere"]);
}

#[test]
fn the_table_is_told_in_each_language() {
    let folder = with(&[("right.g7", RIGHT), ("lump.g7", &RIGHT.replace("lamp", "lump"))]);
    for (lang, parts) in [
        ("en", ["right.g7  passed", "the exercise looks at `lamp`", "submissions that passed: 1 of 2"]),
        ("fr", ["right.g7  réussi", "l’exercice regarde `lamp`", "rendus réussis : 1 sur 2"]),
        ("pt", ["right.g7  passou", "o exercício observa `lamp`", "entregas que passaram: 1 de 2"]),
    ] {
        let ran = folder.g7(&["grade", "lamp", "in", "--lang", lang, "--jobs", "1"]);
        ran.is(1);
        parts.iter().for_each(|part| assert!(ran.out.contains(part), "{part}: {}", ran.out));
    }
}

fn exercises() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../exercises");
    let list = std::fs::read_dir(&root).expect("the exercises");
    let mut found: Vec<PathBuf> = list.map(|e| e.expect("an entry").path()).filter(|p| p.is_dir()).collect();
    found.sort();
    found
}

#[test]
fn each_exercise_is_right_and_each_wrong_solution_is_caught_by_another_test() {
    let folder = Folder::new();
    let all = exercises();
    assert!(all.len() >= 3, "{all:?}");
    for exercise in all {
        let name = exercise.display().to_string();
        let ran = folder.g7(&["grade", &name]);
        let caught: Vec<&str> = ran.is(0).out.lines().filter(|l| l.contains("wrong/")).collect();
        assert!(caught.len() >= 3, "{name}: {}", ran.out);
        let by: BTreeSet<&str> =
            caught.iter().filter_map(|l| l.split_once("caught by ")).map(|(_, by)| by).collect();
        assert_eq!(by.len(), caught.len(), "{name}: {}", ran.out);
        for text in ["statement", "hints"] {
            for ending in ["md", "fr.md", "pt.md"] {
                assert!(exercise.join(format!("{text}.{ending}")).is_file(), "{name}: {text}.{ending}");
            }
        }
        let template = std::fs::read_to_string(exercise.join("template.g7")).expect("the template");
        let views = template.lines().filter_map(|l| l.trim().strip_prefix("view '")?.split('\'').next());
        for picture in views {
            assert!(exercise.join(picture).is_file(), "{name}: the picture {picture}");
        }
        folder.g7(&["fmt", "--check", &name]).is(0);
    }
}
