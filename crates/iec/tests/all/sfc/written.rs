//! Written files: read back equal, and taken by a compiler that is not ours.

use crate::support;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use g7_exchange::Written;
use g7_model::{Document, FileId, Severity};

use crate::sfc::{file, import};

fn document(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert_eq!(problems, [], "{text}");
    document
}

fn export(document: &Document) -> Written {
    support::export("sfc", document)
}

const PUMP: &str = "profile iec61131
scan 10ms
input go, stop : BOOL
input level : REAL
output motor, lamp : BOOL
var n : DINT := 3
var k : INT
var t : TON
chart Pump {
  initial step Rest { N lamp  P1 Tally }
  step Run { S motor  D 2s lamp  N Watch }
  step Off { R motor }
  Rest -> Run when go and not stop
  Run -> Off when level >= 0.5 or Run.t > 1m30s or t.Q priority 1
  Off -> Rest when n > 2
  action Tally { n := n + 1 }
  action Watch {
    t(IN := Run.X, PT := 5s)
    IF n > 10 THEN n := 0 ELSE n := n - 1 END_IF
    CASE n OF 1, 2: lamp := TRUE 3 .. 5: lamp := FALSE ELSE lamp := stop END_CASE
    FOR k := 1 TO 5 DO n := n * 2 END_FOR
    WHILE n > 3 DO n := n - 1 END_WHILE
    REPEAT n := n + 1 UNTIL n > 5 END_REPEAT
  }
}
";

#[test]
fn a_chart_of_the_standard_comes_back_equal() {
    let before = document(PUMP);
    let written = export(&before);
    assert_eq!(written.problems, []);
    let (after, problems) = import(&written.text);
    assert_eq!(problems, [], "{}", written.text);
    // Variables that were declared together are declared one by one.
    let lone = "input go : BOOL\ninput stop : BOOL\n";
    let expected = PUMP
        .replace("input go, stop : BOOL\n", lone)
        .replace("output motor, lamp : BOOL\n", "output motor : BOOL\noutput lamp : BOOL\n");
    let expected = g7_syntax::print(&document(&expected), None);
    assert_eq!(g7_syntax::print(&after, None), expected, "{}", written.text);
}

#[test]
fn numbers_are_converted_where_the_standard_does_not() {
    let written = export(&document(
        "profile iec61131\nvar a : INT\nvar b : DINT\nvar r : REAL\nvar q : BOOL\nchart G {\n initial step 1 { N { b := a + b  r := a * 2  q := a < b } }\n}\n",
    ));
    for part in [
        "b := INT_TO_DINT(a) + b;",
        "r := INT_TO_REAL(a * 2);",
        "q := INT_TO_DINT(a) < b;",
        "INITIAL_STEP Step1:",
    ] {
        assert!(written.text.contains(part), "{part} in {}", written.text);
    }
    assert!(written.problems.iter().all(|p| p.severity() == Severity::Warning), "{:?}", written.problems);
}

#[test]
fn what_has_no_form_is_told_with_its_place() {
    let text = "profile iec61131
input a : BOOL
output q : BOOL
chart G {
  initial step A { SD 1s q if a  N q }
  step B { force H := {} }
  A -> B when a on clearing { q := a }
  A -> B when not a
  B -> A when 5s/a
}
chart H every 3s { initial step C  step D  C -> D when ↑a }
";
    let written = export(&document(text));
    let told = |part: &str, words: &str| {
        let at = text.find(part).expect("a part") as u32;
        let hit = |p: &&g7_model::Problem| p.at.start <= at && at < p.at.end && p.what.contains(words);
        assert!(written.problems.iter().any(|p| hit(&p)), "{part}: {:?}", written.problems);
    };
    told("SD 1s q if a", "the condition of an action");
    told("force H", "an order");
    told("{ q := a }", "an action on clearing");
    told("↑a", "an edge in a chart with a period of its own");
    let errors = written.problems.iter().filter(|p| p.severity() == Severity::Error).count();
    assert_eq!(errors, 4, "{:?}", written.problems);
}

#[test]
fn macro_steps_stand_in_line() {
    let written = export(&document(
        "profile iec61131\ninput a : BOOL\nchart G { initial step 1  macro M = Fill  1 -> M when a  M -> 1 when XM }\n\
         macrochart Fill { entry step 1  exit step S  1 -> S when a }",
    ));
    for part in
        ["FROM Step1 TO Fill_Step1", "FROM S TO Step1\n    := Fill_Step1.X OR S.X;", "FROM Fill_Step1 TO S\n"]
    {
        assert!(written.text.contains(part), "{part} in {}", written.text);
    }
    assert!(written.problems.iter().any(|p| p.what.contains("its expansion stands in its place")));
}

/// A chart with code before and behind it, edges, delays and conditions.
const BESIDE: &str = "profile iec61131
scan 20ms
input a, b : BOOL
input level : INT at %IW3
output q, lamp : BOOL
var n : INT
var kept : DINT retain
const most : INT := 7
pre { n := level + 1 }
post { IF n > most THEN kept := kept + 1 END_IF }
chart G {
  initial step 1 { N q if a  on ↑b: n := 0 }
  step 2 { L 2s lamp  each scan: n := n + most }
  1 -> 2 when ↑a and 3s/b
  2 -> 1 when ↓(a or b) or 5s/X2
}
chart H every 60ms { initial step 3  step 4  3 -> 4 when n > 3  4 -> 3 when not q }
";

#[test]
fn programs_beside_a_chart_share_global_variables() {
    let written = export(&document(BESIDE));
    assert!(written.problems.iter().all(|p| p.severity() == Severity::Warning), "{:?}", written.problems);
    let (after, problems) = import(&written.text);
    assert_eq!(problems, [], "{}", written.text);
    let text = g7_syntax::print(&after, None);
    for part in [
        "input a : BOOL\n",
        "input level : INT at %IW3\n",
        "output q : BOOL",
        "const most : INT := 7",
        "var kept : DINT retain",
        "a_rise_edge(CLK := a)",
        "n := level + 1",
        "post {",
        "chart H every 60ms {",
        "Step1 -> Step2 when a_rise and b_timed",
        "Step2 -> Step1 when Event_fall or Step2.X and Step2.t >= 5s",
    ] {
        assert!(text.contains(part), "{part} in {text}\n{}", written.text);
    }
}

#[test]
fn rules_of_another_profile_are_told() {
    let written = export(&document("chart G { initial step A }"));
    assert!(written.problems.iter().any(|p| p.what.contains("evolves by the rules of iec60848")));
}

/// A chart in which texts read a step that is declared later, a step stands before the initial one, and a
/// string has letters outside ASCII and `(*`.
const EARLY: &str = "profile iec61131
input a : BOOL
output q : BOOL
var s : STRING
chart G {
  step Before
  initial step Rest { N { q := Late.X } }
  Rest -> Before when Late.X or Late.t > 2s
  action Look { q := Last.X  s := 'ä (* ö *) €' }
  step Late { N Look }
  Before -> Late when a
  step Last
  Late -> Last when a
}
";

#[test]
fn a_step_stands_before_what_reads_it() {
    let written = export(&document(EARLY));
    assert_eq!(written.problems, []);
    let at = |part: &str| written.text.find(part).unwrap_or_else(|| panic!("{part}: {}", written.text));
    assert!(at("INITIAL_STEP Rest") < at(" STEP Before"), "{}", written.text);
    assert!(at(" STEP Late") < at("Late.X"), "{}", written.text);
    assert!(at(" STEP Last") < at("Last.X"), "{}", written.text);
    // A transition that reads nothing stays where it is.
    assert!(at("FROM Before") < at(" STEP Last"), "{}", written.text);
    let (after, problems) = import(&written.text);
    assert_eq!(problems, []);
    // Written again, nothing moves any more.
    assert_eq!(export(&after).text, written.text);
}

#[test]
fn actions_before_the_first_step_are_read_as_behind_it() {
    let text =
        |parts: [&str; 3]| format!("PROGRAM P\nVAR q : BOOL; END_VAR\n{}END_PROGRAM\n", parts.concat());
    let step = "INITIAL_STEP A: Act(N); END_STEP\n";
    let action = "ACTION Act: q := TRUE; END_ACTION\n";
    let other = "ACTION Act2: q := FALSE; END_ACTION\n";
    let (before, _) = import(&text([action, other, step]));
    let (behind, _) = import(&text([step, action, other]));
    assert_eq!(g7_syntax::print(&before, None), g7_syntax::print(&behind, None));
}

#[test]
fn the_order_is_told_where_the_initial_step_moves_and_acts() {
    let text = |first: &str| {
        format!(
            "profile iec61131\noutput q, r : BOOL\nchart G {{\n step A {{ {first} }}\n initial step B {{ N r }}\n B -> A when q\n}}\n"
        )
    };
    assert_eq!(export(&document(&text("\"nothing\""))).problems, []);
    let told = export(&document(&text("N q"))).problems;
    let said: Vec<&str> = told.iter().map(|p| &*p.what).collect();
    assert!(matches!(said[..], [one] if one.contains("`B` stands before the other steps")), "{said:?}");
}

#[test]
fn a_text_is_ascii_and_holds_no_sign_of_a_comment() {
    let written = export(&document(EARLY));
    assert!(written.text.contains("s := '$C3$A4 ($2A $C3$B6 *) $E2$82$AC';"), "{}", written.text);
    let (after, _) = import(&written.text);
    let back = g7_syntax::print(&after, None);
    assert!(back.contains("s := 'ä (* ö *) €'"), "{back}");
    // Bytes that are not UTF-8 are read as letters of Latin-1.
    let (after, _) = import("PROGRAM P VAR s : STRING; END_VAR s := '$E4$41$C3$28$24'; END_PROGRAM");
    let back = g7_syntax::print(&after, None);
    assert!(back.contains("s := 'äAÃ($$'"), "{back}");
}

/// A variable and a step with one name, but for the case of a letter.
const TWINS: &str = "profile iec61131
output init : BOOL
chart G {
  initial step Init { N init }
  action Nothing {}
  action More { init := TRUE }
  step Next { N Nothing  N More }
  Init -> Next when init
  Next -> Init when not init
}
";

#[test]
fn a_step_that_is_not_read_may_have_the_name_of_a_variable() {
    let before = document(TWINS);
    let written = export(&before);
    assert_eq!(written.problems, []);
    let (after, problems) = import(&written.text);
    assert_eq!(problems, []);
    assert_eq!(g7_syntax::print(&after, None), g7_syntax::print(&before, None), "{}", written.text);
    // `Init.X` would be a member of the variable.
    let written = export(&document(&TWINS.replace("when not init", "when not init and Init.t > 1s")));
    assert!(written.text.contains("STEP G_Init:") && written.text.contains("G_Init.T"), "{}", written.text);
    assert!(written.problems.iter().any(|p| p.what.contains("`Init` is called `G_Init` there")));
}

/// Steps called like standard functions, as in the Oscat library; a variable may not be.
const FUNCTIONS: &str = "
profile iec61131
input a : BOOL
output q : BOOL
chart G {
  initial step Check
  step Add { N q }
  step Max
  Check -> Add when a
  Add -> Max when not a
  Max -> Check when a
}
";

#[test]
fn a_step_that_is_not_read_may_have_the_name_of_a_standard_function() {
    let before = document(FUNCTIONS);
    let written = export(&before);
    assert_eq!(written.problems, []);
    let (after, problems) = import(&written.text);
    assert_eq!(problems, []);
    assert_eq!(g7_syntax::print(&after, None), g7_syntax::print(&before, None), "{}", written.text);
    for (from, to, expected) in [
        // `Add.X` would be a member of the function.
        (
            "Max -> Check when a",
            "Max -> Check when Add.X",
            "`Add` is called `G_Add` there, because it is a word",
        ),
        (
            "input a : BOOL",
            "input a : BOOL  input sel : BOOL",
            "`sel` is called `sel_2` there, because it is a word",
        ),
        ("Check", "On", "`On` is called `G_On` there, because it is a word"),
    ] {
        let written = export(&document(&FUNCTIONS.replace(from, to)));
        let told: Vec<_> = written.problems.iter().map(|p| &*p.what).collect();
        assert!(told.iter().any(|t| t.contains(expected)), "{expected}: {told:?}");
    }
}

/// matiec wants a variable in each program, and has no global text with a length.
#[test]
fn programs_have_a_variable_and_texts_stand_where_they_are_used() {
    let alone = export(&document("profile iec61131\nchart G { initial step A  step B  A -> B when true }"));
    assert!(alone.text.starts_with("PROGRAM G\n  VAR\n    Unused : BOOL;\n  END_VAR\n"), "{}", alone.text);
    let several = export(&document(
        "profile iec61131\ninput a : BOOL\nvar s : STRING(20)\nvar t : STRING(30) := 'x'\nvar u : STRING(40)\n\
         pre { u := 'y' }\nchart G { initial step A { N { s := u } }  step B  A -> B when a }",
    ));
    for part in [
        "    s : STRING[20];\n    t : STRING[30] := 'x';",
        "    u : STRING;\n  END_VAR\n\n  u :=",
        "VAR_GLOBAL\n    u : STRING;",
    ] {
        assert!(several.text.contains(part), "{part} in {}", several.text);
    }
    assert!(several.problems.iter().any(|p| p.what.contains("`u` is a STRING")), "{:?}", several.problems);
    if let Some(matiec) = g7_peers::matiec() {
        assert_eq!(compile(&matiec, &alone.text), Ok(()), "{}", alone.text);
    }
}

/// Parameters and local variables of a function whose names are words there, or have letters that are none, get other
/// names, each one of its own; a call that names them follows.
#[test]
fn arguments_have_the_names_of_the_parameters() {
    let written = export(&document(
        "profile iec61131\ninput a : BOOL\noutput q : INT\n\
         function Pick(on : BOOL, on_2 : BOOL, début : INT) : INT { var mid : INT := 3  Pick := SEL(on, mid, SEL(on_2, 0, début)) }\n\
         chart G { initial step A { each scan: { q := Pick(début := 7, on := a, on_2 := not a) } }  step B  A -> B when a }",
    ));
    let heads = "VAR_INPUT\n    on_2 : BOOL;\n    on_2_2 : BOOL;\n    debut : INT;\n  END_VAR\n";
    assert!(written.text.contains(heads), "{}", written.text);
    let body = "Pick := SEL(on_2, mid_2, SEL(on_2_2, 0, debut));";
    assert!(written.text.contains(body), "{}", written.text);
    let call = "q := Pick(debut := 7, on_2 := a, on_2_2 := NOT a);";
    assert!(written.text.contains(call), "{}", written.text);
    if let Some(matiec) = g7_peers::matiec() {
        assert_eq!(compile(&matiec, &written.text), Ok(()), "{}", written.text);
    }
}

/// The judgement of matiec on a text.
pub(crate) fn compile(matiec: &g7_peers::Matiec, text: &str) -> Result<(), String> {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("g7-iectext-{}-{call}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("chart.st"), text).expect("a file");
    let output = matiec.translate(&folder, "chart.st").output().expect("matiec starts");
    let _ = std::fs::remove_dir_all(&folder);
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

#[test]
fn matiec_takes_what_is_written() {
    let Some(matiec) = g7_peers::matiec() else { return };
    for text in [
        PUMP.to_string(),
        BESIDE.to_string(),
        EARLY.to_string(),
        TWINS.to_string(),
        FUNCTIONS.to_string(),
        g7_syntax::print(&import(&file("press.st")).0, None),
        g7_syntax::print(&import(&file("fork.st")).0, None),
    ] {
        let written = export(&document(&text));
        assert_eq!(compile(&matiec, &written.text), Ok(()), "{}", written.text);
    }
}

/// The blocks of the library stay function blocks, and matiec takes what their test charts become.
#[test]
fn matiec_takes_the_library() {
    let Some(matiec) = g7_peers::matiec() else { return };
    let folder: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "..", "library"].iter().collect();
    let mut taken = Vec::new();
    for entry in std::fs::read_dir(folder.join("tests")).expect("the test charts") {
        let file = entry.expect("an entry").path();
        let name = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let block = std::fs::read_to_string(folder.join(format!("{name}.g7"))).expect("the block");
        let chart = std::fs::read_to_string(&file).expect("a chart");
        // The charts of GEMMA force each other, which has no form there.
        if name == "gemma" {
            continue;
        }
        let written = export(&document(&format!("{}{block}", chart.replace(&format!("use {name}\n"), ""))));
        assert!(written.text.contains("FUNCTION_BLOCK "), "{name}: {}", written.text);
        assert_eq!(compile(&matiec, &written.text), Ok(()), "{name}: {}", written.text);
        taken.push(name);
    }
    assert!(taken.len() >= 12, "{taken:?}");
}

/// Cases that matiec cannot compile, though they are in the words of the standard: it
/// ends at an initial value of `STRING[10]`, has decimal digits for numbers without a sign alone, and no DAY_OF_WEEK.
const NOT_BY_MATIEC: [&str; 4] =
    ["bit-bcd-range", "data-day-of-week", "data-initial-values", "data-string-length"];

/// The charts of the conformance cases: what can be written of them is compiled.
#[test]
fn matiec_takes_the_conformance_cases() {
    let Some(matiec) = g7_peers::matiec() else { return };
    let folder: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "spec", "iec61131"].iter().collect();
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("the cases").filter_map(|e| Some(e.ok()?.path())).collect();
    files.sort();
    let mut taken = 0;
    let mut wrong = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a case");
        let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let chart = text.split("```g7\n").nth(1).and_then(|t| t.split("```").next());
        let Some(chart) = chart.filter(|_| !NOT_BY_MATIEC.contains(&stem.as_str())) else { continue };
        let head = if chart.starts_with("profile") { "" } else { "profile iec61131\n" };
        let written = export(&document(&format!("{head}{chart}")));
        if written.problems.iter().any(|p| p.severity() == Severity::Error) {
            continue;
        }
        match compile(&matiec, &written.text) {
            Ok(()) => taken += 1,
            Err(why) => wrong.push(format!("{stem}: {why}\n{}", written.text)),
        }
    }
    assert!(wrong.is_empty(), "{} of {taken}\n{}", wrong.len(), wrong.join("\n"));
    assert!(taken > 80, "only {taken}");
}
