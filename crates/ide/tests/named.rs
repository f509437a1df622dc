//! Hovers, changes of names, completion and colours for enumerations and other types with a name.

use g7_edit::spliced;
use g7_ide::File;
use g7_ide::completion::complete;
use g7_ide::hover::hover;
use g7_ide::references::{rename, uses};

const TEXT: &str = "\
type Mode : (Off, Manual, Automatic := 5) \"of the switch\"
type Percent : INT(0..100) := 20
input want : Mode
output valve : Percent
var small : SINT(-3..3)
chart G {
  var mode : Mode
  initial step 0 { each scan: mode := SEL(want = Mode.Off, Manual, Automatic); }
  step 1 { each scan: valve := 50; }
  0 -> 1 when mode = Automatic and small > 0
  1 -> 0 when mode <> want
}
";

fn file(text: &str) -> File {
    File::open_native("x.g7", text.to_owned()).expect("a file")
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
fn values_and_types_are_renamed_wherever_they_stand() {
    for (words, to, wanted) in [
        ("mode = Automatic", "Auto", TEXT.replace("Automatic", "Auto")),
        ("Mode.Off", "Halt", TEXT.replace("Off", "Halt")),
        ("want : Mode", "Switch", TEXT.replace("Mode", "Switch")),
        ("valve : Percent", "Share", TEXT.replace("Percent", "Share")),
    ] {
        assert_eq!(renamed(words, to).as_ref(), Ok(&wanted), "{words}");
    }
    let taken = renamed("Mode.Off", "Manual").expect_err("there is such a value");
    assert!(taken.contains("a value `Manual` of `Mode` already"), "{taken}");
    // A variable of the name would hide the value.
    renamed("mode = Automatic", "mode").expect_err("the chart has such a variable");
}

#[test]
fn values_and_types_lead_to_their_declaration_and_are_shown_with_it() {
    let file = file(TEXT);
    let declared = |words: &str| uses(&file, at(words)).declared.map(|r| r.start);
    assert_eq!(declared("mode = Automatic"), Some(at("Off, Manual, Automatic")));
    assert_eq!(declared("Mode.Off"), Some(at("(Off")));
    assert_eq!(declared("valve : Percent"), Some(at("type Percent")));
    let shown = |words: &str| hover(&file, at(words)).map(|h| h.markdown).unwrap_or_default();
    assert_eq!(shown("mode = Automatic"), "value `Automatic` of `Mode`  \nof the switch");
    assert_eq!(shown("want : Mode"), "`type Mode : (Off, Manual, Automatic := 5)`  \nof the switch");
    assert_eq!(shown("valve : Percent"), "`type Percent : INT(0..100) := 20`");
    assert_eq!(shown("output valve"), "`output valve : Percent`");
    assert_eq!(shown("var small"), "`var small : SINT(-3..3)`");
}

#[test]
fn values_and_types_are_offered_where_they_can_stand() {
    let condition = |e: &str| TEXT.replace("mode = Automatic and", &format!("{e} and"));
    let cases: [(String, &[&str]); 4] = [
        (condition("want = Mode.|"), &["Off", "Manual", "Automatic"]),
        (condition("want = Man|"), &["Manual"]),
        (TEXT.replace("var small", "var x : Per|\nvar small"), &["Percent"]),
        (TEXT.replace("var small", "var x : ARRAY[1..2] OF Mo|\nvar small"), &["Mode"]),
    ];
    for (text, wanted) in cases {
        let place = text.find('|').expect("a mark");
        let text = text.replacen('|', "", 1);
        let mut open = file(TEXT);
        open.take(text.clone()).expect("a text");
        let offered: Vec<String> = complete(&open, place).items.into_iter().map(|c| c.label).collect();
        let first: Vec<&str> = offered.iter().map(String::as_str).take(wanted.len()).collect();
        assert_eq!(first, wanted, "{text}");
    }
}

const FUNCTION: &str = "\
type Mode : (Off, Manual)
type Row : ARRAY[1..2] OF INT
input want : Mode
function Next(m : Mode, plus : INT(0..9)) : Mode {
  var last : Mode := Manual
  Next := SEL(m = Mode.Off, Mode.Off, last)
}
chart Drive(i : INT, wish : Mode) {
  initial step 0
  0 -> 0 when wish = want
}
instance First : Drive(1, Manual)
";

/// The types of parameters, results and local variables are names like those of variables.
#[test]
fn types_of_parameters_are_followed_and_renamed() {
    let file = file(FUNCTION);
    let place = |words: &str| FUNCTION.find(words).expect("it is there") + words.len() - 1;
    for words in ["want : Mode", "(m : Mode", ") : Mode", "last : Mode", "wish : Mode"] {
        let found = uses(&file, place(words));
        assert_eq!(found.declared.map(|r| r.start), Some(5), "{words}");
        let splices = rename(&file, place(words), "Switch").expect("it can be renamed");
        assert_eq!(spliced(FUNCTION, &splices).expect("they fit"), FUNCTION.replace("Mode", "Switch"));
    }
}

/// Where one value is meant, no structure and no array is offered.
#[test]
fn types_of_one_value_are_offered_to_parameters() {
    for (before, after) in [("(m : Mode", "(m : |"), ("last : Mode", "last : |"), ("wish : Mode", "wish : |")]
    {
        let text = FUNCTION.replacen(before, after, 1);
        let place = text.find('|').expect("a mark");
        let mut open = file(FUNCTION);
        open.take(text.replacen('|', "", 1)).expect("a text");
        let offered: Vec<String> = complete(&open, place).items.into_iter().map(|c| c.label).collect();
        let has = |name: &str| offered.iter().any(|o| o == name);
        assert!(has("Mode") && has("INT") && !has("Row"), "{after}: {offered:?}");
    }
}
