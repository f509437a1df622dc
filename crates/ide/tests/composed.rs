//! Hovers, changes of names, completion and colours for structures and function blocks of one's own.

use g7_edit::spliced;
use g7_ide::File;
use g7_ide::completion::complete;
use g7_ide::hover::hover;
use g7_ide::references::{rename, uses};
use g7_ide::tables::tables;
use g7_ide::tokens::{Class, tokens};

const TEXT: &str = "\
struct Motor \"of the belt\" {
  speed : REAL := 1.5 \"in m/s\"
  on : BOOL
}
function block Debounce {
  var t : TON
  output q : BOOL
  input raw : BOOL
  inout n : INT
  body {
    var i : INT
    t(IN := raw, PT := 10ms);
    i := n;
    n := i + 1;
    q := t.Q
  }
}
var m : ARRAY[1..2] OF Motor := [(speed := 2.0), (on := TRUE)]
var d : Debounce
var k, i : INT
input raw : BOOL
output lamp : BOOL
chart G {
  var q : BOOL
  var pair : ARRAY[1..2] OF Debounce
  initial step 0 {
    each scan: d(raw := raw, n := k, q => lamp)
    P1 { m[i].speed := m[1].speed + 1.0; pair[i](raw := raw, n := k) }
  }
  0 -> 0 when d.q and q and pair[1].t.Q
}
prove never d.q and G.pair[1].q
";

fn file(text: &str) -> File {
    File::open_native("x.g7", text.to_owned()).expect("a file")
}

/// The byte of the word that a mark `|` stands before, and the text without the mark.
fn marked(text: &str) -> (String, usize) {
    let at = text.find('|').expect("a mark");
    (text.replacen('|', "", 1), at)
}

/// The byte in [`TEXT`] at which the last of some words begins.
fn at(words: &str) -> usize {
    let last = words.rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
    TEXT.find(words).expect("it is there") + words.len() - last.len()
}

fn renamed(words: &str, to: &str) -> Result<String, String> {
    let splices = rename(&file(TEXT), at(words), to).map_err(|e| e.to_string())?;
    Ok(spliced(TEXT, &splices).expect("splices fit"))
}

#[test]
fn a_name_is_changed_wherever_it_stands() {
    let cases = [
        ("m[i].speed", "v", TEXT.replace("speed", "v")),
        ("m[i].speed", "fast speed", {
            let text = TEXT.replace("].speed", "].`fast speed`");
            text.replace("speed :", "`fast speed` :")
        }),
        ("d : Debounce", "Filter", TEXT.replace("Debounce", "Filter")),
        ("var d", "input1", {
            let text = TEXT.replace("var d ", "var input1 ").replace(" d.q", " input1.q");
            text.replace(": d(", ": input1(")
        }),
        ("G.pair", "two", TEXT.replace("pair", "two")),
        ("P1 { m[i", "k2", {
            let text = TEXT.replace("var k, i", "var k, k2").replace("m[i]", "m[k2]");
            text.replace("pair[i]", "pair[k2]")
        }),
        // The member, not the input of the file that is its value.
        ("d(raw", "x", {
            let text = TEXT.replace("  input raw", "  input x").replace("IN := raw", "IN := x");
            text.replace("(raw :=", "(x :=")
        }),
        // The local variable of the body.
        ("n := i", "j", {
            let text = TEXT.replace("    var i", "    var j").replace("    i := n", "    j := n");
            text.replace("n := i + 1", "n := j + 1")
        }),
    ];
    for (words, to, wanted) in cases {
        assert_eq!(renamed(words, to).as_ref(), Ok(&wanted), "{words}");
    }
}

#[test]
fn a_name_that_is_in_use_is_refused() {
    let cases = [
        ("m[i].speed", "on", "a member `on` of `Motor` already"),
        ("d : Debounce", "Motor", "a type `Motor` already"),
        ("var d", "m", "a variable `m` already"),
        // It would hide the variable of the file in the body, or be hidden there.
        ("n := i", "raw", "a member `raw` of `Debounce` already"),
        ("d : Debounce", "INT", ""),
    ];
    for (words, to, why) in cases {
        let refused = renamed(words, to).expect_err(words);
        assert!(refused.contains(why), "{words}: {refused}");
    }
}

#[test]
fn a_member_leads_to_its_declaration() {
    let file = file(TEXT);
    for (words, declared) in [
        ("m[i].speed", "{\n  speed"),
        ("[(speed", "{\n  speed"),
        ("when d.q", "output q"),
        ("n := k, q", "output q"),
        ("0 when d.q and q", "var q"),
        ("pair[1].t", "var t"),
        ("OF Motor", "struct Motor"),
        ("d(raw := raw, n", "inout n"),
    ] {
        let place = uses(&file, at(words)).declared.map(|r| r.start);
        assert_eq!(place, Some(at(declared)), "{words}");
    }
}

#[test]
fn a_member_is_shown_with_its_declaration_and_a_type_with_its_members() {
    let file = file(TEXT);
    let shown = |words: &str| hover(&file, at(words)).map(|h| h.markdown).unwrap_or_default();
    assert_eq!(shown("m[i].speed"), "`speed : REAL := …` of `Motor`  \nin m/s");
    assert_eq!(shown("when d.q"), "`output q : BOOL` of `Debounce`");
    assert_eq!(shown("0 when d.q and q"), "`var q : BOOL` of chart G");
    assert_eq!(shown("d(raw := raw, n"), "`inout n : INT` of `Debounce`");
    assert_eq!(shown("    n := i"), "`var i : INT` of `Debounce`");
    assert_eq!(shown("OF Motor"), "`struct Motor`  \nof the belt  \n`speed : REAL := …`  \n`on : BOOL`");
    let block = "`function block Debounce`  \n`var t : TON`  \n`output q : BOOL`  \n`input raw : BOOL`  \n`inout n : INT`";
    assert_eq!(shown("d : Debounce"), block);
    assert_eq!(shown("var d"), "`var d : Debounce`");
}

#[test]
fn members_types_and_words_are_offered_where_they_can_stand() {
    // The text in the place of the condition, of a declaration, or of a line of a function block; the words wanted first.
    let condition = |e: &str| TEXT.replace("d.q and q and", &format!("{e} and"));
    let variable = |v: &str| TEXT.replace("var k, i : INT", &format!("var k, i : INT\n{v}"));
    let cases: [(String, &[&str]); 14] = [
        (condition("d.|"), &["q", "raw", "t"]),
        (condition("G.pair[1].|"), &["q", "raw", "t"]),
        (condition("pair[k + 1].t.|"), &["IN", "PT", "Q", "ET"]),
        (condition("m[1].|"), &["speed", "on"]),
        (condition("m[1].s|"), &["speed"]),
        (condition("k.|"), &[]),
        (variable("var x : De|"), &["Debounce"]),
        (variable("var x : ARRAY[1..2] OF Mo|"), &["Motor"]),
        (TEXT.replace("on : BOOL", "on : BOOL\n  inner : De|"), &["Debounce"]),
        (
            TEXT.replace("inout n : INT", "inout n : INT\n  |"),
            &["input", "output", "inout", "var", "const", "body"],
        ),
        (TEXT.replace("on : BOOL", "on : BOOL\n  |"), &[]),
        (TEXT.replace("i := n;", "i := n;\n    |"), &["t", "q", "raw", "n", "i"]),
        (TEXT.replace("i := n;", "i := n;\n    t.|"), &["IN", "PT", "Q", "ET"]),
        (TEXT.replace("var i : INT\n", "var i : INT\n    var j : Mo|\n"), &[]),
    ];
    for (text, wanted) in cases {
        let (text, place) = marked(&text);
        let mut open = file(TEXT);
        open.take(text.clone()).expect("a text");
        let labels: Vec<String> = complete(&open, place).items.into_iter().map(|c| c.label).collect();
        let first: Vec<&str> = labels.iter().take(wanted.len().max(1)).map(|l| l.as_str()).collect();
        let line = text.get(..place).unwrap_or_default().lines().last();
        assert_eq!(first, wanted, "{line:?}");
    }
}

#[test]
fn nothing_is_offered_in_a_note() {
    for (text, offers) in [
        ("// a note|", false),
        ("// a note|\ninput a : BOOL\n", false),
        ("input a : BOOL // n|\n", false),
        ("(* a | note *)\n", false),
        ("(* a note *) |\n", true),
        ("// a note\n|\n", true),
    ] {
        let (text, place) = marked(text);
        let open = file(&text);
        assert_eq!(!complete(&open, place).items.is_empty(), offers, "{text}");
    }
}

#[test]
fn charts_of_function_blocks_are_offered_with_the_names_of_their_blocks() {
    const BLOCK: &str = "function block Gripper {\n  input close : BOOL\n}\nchart Cycle of Gripper {\n  initial step 1\n  step 2\n  1 -> 2 when close\n}\nstruct Pair { x : INT }\nvar grip : ARRAY[1..2] OF Gripper\nprove never grip[1].Cycle.X2\n";
    let cases: [(String, &[&str]); 4] = [
        (BLOCK.replace("never grip[1].Cycle.X2", "never grip[1].|"), &["close", "Cycle"]),
        (BLOCK.replace("grip[1].Cycle.X2", "grip[1].Cycle.|"), &["X1", "X2"]),
        (BLOCK.replace("of Gripper {\n  initial", "of |"), &["Gripper"]),
        (BLOCK.replace("when close", "when cl|"), &["close"]),
    ];
    for (text, wanted) in cases {
        let (text, place) = marked(&text);
        let mut open = file(BLOCK);
        open.take(text.clone()).expect("a text");
        let labels: Vec<String> = complete(&open, place).items.into_iter().map(|c| c.label).collect();
        let first: Vec<&str> = labels.iter().take(wanted.len()).map(|l| l.as_str()).collect();
        assert_eq!(first, wanted, "{text}");
    }
    let renamed = BLOCK.replace("Cycle", "Move");
    let place = BLOCK.find("Cycle.X2").expect("a use");
    let splices = rename(&file(BLOCK), place, "Move").expect("a new name");
    assert_eq!(spliced(BLOCK, &splices).expect("splices fit"), renamed);
}

#[test]
fn names_of_types_have_the_colour_of_types_and_tables_leave_members_out() {
    let file = file(TEXT);
    let class = |words: &str| {
        let place = at(words);
        tokens(&file, place..place + 1).into_iter().map(|t| t.class).collect::<Vec<_>>()
    };
    assert_eq!(class("OF Motor"), [Class::Type]);
    assert_eq!(class("d : Debounce"), [Class::Type]);
    assert_eq!(class("function block Debounce"), [Class::Type]);
    assert_eq!(class("function block"), [Class::Keyword]);
    assert_eq!(class("m[i].speed"), [Class::Variable]);
    let names: Vec<String> = tables(&file.drawn()).variables.into_iter().map(|v| v.name).collect();
    assert_eq!(names, ["m", "d", "k", "i", "raw", "lamp", "q", "pair"]);
}
