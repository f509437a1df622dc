//! Enumerations of a file become types of the document, and stay what they were where they are used as numbers.

use g7_model::{Document, Problem};

use super::carried::same;
use super::{carried, errors, import, written};
use crate::support::{self, Bench};

/// A program with variables and one action, which runs in each scan.
fn program(types: &str, variables: &str, action: &str) -> String {
    format!(
        "{types}
PROGRAM p
  VAR_INPUT go : BOOL; n : INT; END_VAR
  VAR_OUTPUT out : INT; END_VAR
  VAR {variables} END_VAR
  INITIAL_STEP A: Act(N); END_STEP
  TRANSITION FROM A TO A := go; END_TRANSITION
  ACTION Act: {action} END_ACTION
END_PROGRAM"
    )
}

/// The same as .g7 text: with these types before the inputs.
fn document(types: &str, variables: &str, action: &str) -> String {
    format!(
        "profile iec61131
{types}
input go : BOOL
input n : INT
output out : INT
{variables}
chart p {{
  initial step A {{ N Act }}
  A -> A when go
  action Act {{ {action} }}
}}"
    )
}

const MODE: &str = "TYPE Mode : (Off, Auto := 5, Hand); END_TYPE";
const AS_MODE: &str = "type Mode : (Off, Auto := 5, Hand)";

/// The text has this part, however both are broken into lines.
#[track_caller]
fn has(text: &str, part: &str) {
    let flat = |text: &str| format!(" {} ", text.split_whitespace().collect::<Vec<_>>().join(" "));
    assert!(flat(text).contains(&flat(part)), "{part} in {text}");
}

/// Checks that a text with the enumeration `Mode` becomes this document, without problems, and that it runs.
#[track_caller]
fn becomes((variables, action): (&str, &str), expected: (&str, &str)) -> Document {
    let (found, problems) = import(&program(MODE, variables, action));
    assert_eq!(problems, []);
    same(&found, &document(AS_MODE, expected.0, expected.1));
    let (_, problems) = g7_compile::compile(&found);
    assert_eq!(errors(&problems), <[&str; 0]>::default());
    found
}

/// The same for one that stays numbers. Gives what is told.
#[track_caller]
fn stays(types: &str, variables: &str, action: &str) -> (String, Document) {
    let (found, problems) = import(&program(types, variables, action));
    assert_eq!(errors(&problems), <[&str; 0]>::default());
    let told: Vec<&Problem> = problems.iter().filter(|p| p.code.id == "G0614").collect();
    assert_eq!(told.len(), 1, "{problems:?}");
    assert!(!g7_syntax::print(&found, None).contains("type "), "{}", g7_syntax::print(&found, None));
    let (_, more) = g7_compile::compile(&found);
    assert_eq!(errors(&more), <[&str; 0]>::default());
    (told[0].what.to_string(), found)
}

#[test]
fn values_are_compared_chosen_and_assigned_by_their_names() {
    becomes(
        (
            "m, k : Mode; lit : BOOL;",
            "CASE m OF Off, Mode#AUTO: k := MODE.Hand; ELSE m := SEL(go, k, Off); END_CASE; lit := m <> mode#off AND Hand = k; m := MOVE(IN := k);",
        ),
        (
            "var m : Mode\nvar k : Mode\nvar lit : BOOL",
            "CASE m OF Off, Auto: k := Hand ELSE m := SEL(go, k, Off) END_CASE lit := m <> Off AND Hand = k m := MOVE(IN := k)",
        ),
    );
}

/// A type, a variable and an array begin with the first value, as the standard has it, so only another one is written.
#[test]
fn initial_values_are_those_of_the_text() {
    let text = carried(&program(
        "TYPE Mode : (Off := 1, Auto, Hand) := Hand; Other : Mode := Auto; S : STRUCT m : Mode; k : Mode := Off; END_STRUCT; END_TYPE",
        "a : Mode; b : Mode := Off; c : Other; d : ARRAY[1..3] OF Mode; e : ARRAY[1..3] OF Mode := [2(Auto)]; s : S := (m := 2);",
        "a := b;",
    ));
    for part in [
        "type Mode : (Off := 1, Auto, Hand) := Hand\n",
        "var a : Mode\n",
        "var b : Mode := Off\n",
        "var c : Mode := Auto\n",
        "var d : ARRAY[1..3] OF Mode\n",
        "var e : ARRAY[1..3] OF Mode := [2(Auto), Hand]\n",
        "  m : Mode\n",
        "  k : Mode := Off\n",
        "var s : S := (m := Auto)\n",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// The standard has no order of values and no sums; most tools have, with the numbers.
#[test]
fn a_value_is_its_number_where_one_is_needed() {
    let found = becomes(
        (
            "m : Mode := Auto; x : INT := Hand; row : ARRAY[Off..6] OF INT;",
            "IF m > Off THEN out := m + 1; END_IF; row[m] := Hand; IF m = n THEN out := MAX(m, n); END_IF; CASE n OF Off..3, Auto: out := Mode_TO_INT(Hand); END_CASE;",
        ),
        (
            "var m : Mode := Auto\nvar x : INT := 6\nvar row : ARRAY[0..6] OF INT",
            "IF Mode_TO_INT(m) > Mode_TO_INT(Off) THEN out := Mode_TO_INT(m) + 1 END_IF row[Mode_TO_INT(m)] := Mode_TO_INT(Hand) IF Mode_TO_INT(m) = n THEN out := MAX(Mode_TO_INT(m), n) END_IF CASE n OF 0..3, 5: out := Mode_TO_INT(Hand) END_CASE",
        ),
    );
    let mut bench = Bench::new(&found);
    assert_eq!(bench.set("n", 9).scan().get("out"), 6);
    assert_eq!(bench.set("n", 5).scan().get("out"), 6, "the number of Hand, by the CASE");
}

/// A written number is the value that has it.
#[test]
fn a_number_of_a_value_is_the_value() {
    becomes(
        (
            "m : Mode := 5;",
            "m := 6; IF m = 0 THEN m := SEL(go, 0, Hand); END_IF; CASE m OF 0: m := 5; END_CASE; IF m = 7 THEN out := 1; END_IF;",
        ),
        (
            "var m : Mode := Auto",
            "m := Hand IF m = Off THEN m := SEL(go, Off, Hand) END_IF CASE m OF Off: m := Auto END_CASE IF Mode_TO_INT(m) = 7 THEN out := 1 END_IF",
        ),
    );
}

#[test]
fn an_enumeration_that_gets_other_numbers_stays_numbers() {
    let value = "the enumeration `Mode` is read as numbers: here it gets one that is no value";
    let used = "the enumeration `Mode` is read as numbers: here it is used as one";
    for (action, told) in [
        ("m := n;", value),
        ("m := 4;", value),
        ("m := m + 1;", value),
        ("FOR m := 0 TO 5 DO out := out + m; END_FOR;", used),
        ("m.0 := go;", used),
        ("t(CU := go, CV => m);", used),
    ] {
        let (what, found) =
            stays(MODE, "m : Mode := Hand; t : CTU; all : ARRAY[1..2] OF Mode := [Auto, 6];", action);
        assert_eq!(what, told, "{action}");
        let text = g7_syntax::print(&found, None);
        for part in
            ["const Auto : INT := 5", "var m : INT := Hand", "var all : ARRAY[1..2] OF INT := [Auto, 6]"]
        {
            has(&text, part);
        }
    }
    let (_, found) =
        stays(MODE, "m : Mode;", "m := n; CASE m OF Auto: out := m; Mode#Hand: out := 1; END_CASE;");
    let mut bench = Bench::new(&found);
    assert_eq!(bench.set("n", 5).scan().get("out"), 5);
    assert_eq!(bench.set("n", 6).scan().get("out"), 1);
    assert_eq!(bench.set("n", 7).scan().get("m"), 7);
}

/// The number of one enumeration is no value of another one: only this one becomes numbers.
#[test]
fn a_value_of_another_enumeration_is_a_number() {
    let types = "TYPE Mode : (Off, Auto); Light : (Red, Green); END_TYPE";
    let (found, problems) = import(&program(types, "m : Mode; l : Light := Green;", "l := m; out := l;"));
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert_eq!(
        &*problems[0].what,
        "the enumeration `Light` is read as numbers: here it gets one that is no value"
    );
    let text = g7_syntax::print(&found, None);
    for part in [
        "type Mode : (Off, Auto)",
        "const Red : INT := 0",
        "var m : Mode\n",
        "l := Mode_TO_INT(m)",
        "var l : INT := Green",
    ] {
        has(&text, part);
    }
}

/// Values without numbers of INT of their own have no type in G7.
#[test]
fn numbers_that_are_equal_or_too_large_stay_numbers() {
    let numbers = "the enumeration `Mode` is read as numbers: its values do not have a number of INT each";
    for types in ["TYPE Mode : (Off, On := 0); END_TYPE", "TYPE Mode : DINT (Off, On := 40000); END_TYPE"] {
        let (what, _) = stays(types, "m : Mode;", "IF m = Off THEN m := On; END_IF;");
        assert_eq!(what, numbers, "{types}");
    }
}

/// CODESYS and TwinCAT write the type of the numbers behind the values, the third edition before them.
#[test]
fn the_numbers_can_have_a_type() {
    for types in [
        "TYPE Mode : (Off, On := 3) BYTE := On; END_TYPE",
        "TYPE Mode : BYTE (Off, On := BYTE#3) := On; END_TYPE",
    ] {
        let text = carried(&program(types, "m : Mode; w : BYTE;", "w := m; IF m = w THEN m := On; END_IF;"));
        for part in [
            "type Mode : (Off, On := 3) := On",
            "w := INT_TO_BYTE(Mode_TO_INT(m))",
            "IF INT_TO_BYTE(Mode_TO_INT(m)) = w THEN",
        ] {
            has(&text, part);
        }
        let (_, found) = stays(types, "m : Mode; w : BYTE;", "m := w;");
        let text = g7_syntax::print(&found, None);
        assert!(text.contains("const On : BYTE := 3") && text.contains("var m : BYTE := On"), "{text}");
    }
}

/// The place tells which of two values with one name is meant; without a place it is told.
#[test]
fn two_enumerations_can_share_a_name() {
    let types = "TYPE Mode : (Off, Auto); Light : (Red, Off); END_TYPE";
    let text = carried(&program(
        types,
        "m : Mode; l : Light := Off;",
        "IF m = Off THEN l := Off; END_IF; CASE l OF Red: m := Auto; Off: m := Off; END_CASE; l := SEL(go, Off, Red);",
    ));
    for part in [
        "var l : Light := Light.Off",
        "IF m = Mode.Off THEN l := Light.Off END_IF",
        "Red:\n        m := Auto",
        "Light.Off:\n        m := Mode.Off",
        "l := SEL(go, Light.Off, Red)",
    ] {
        has(&text, part);
    }
    let (_, problems) = import(&program(types, "m : Mode; l : Light;", "out := Off;"));
    assert_eq!(errors(&problems), ["`Off` is a value of `Mode` and of `Light`"]);
    // A value of numbers gets another name.
    let (found, _) = import(&program(
        types,
        "m : Mode; l : Light;",
        "m := n; l := Off; IF m = Off THEN m := Mode#Off; END_IF;",
    ));
    let text = g7_syntax::print(&found, None);
    for part in ["const Mode_Off : INT := 0", "l := Light.Off", "IF m = Mode_Off THEN m := Mode_Off END_IF"] {
        has(&text, part);
    }
}

/// A variable hides the name of a value, and a variable can be called like a type.
#[test]
fn names_of_variables_come_first() {
    let text = carried(&program(
        "TYPE Mode : (Off, Auto); END_TYPE",
        "Mode : Mode; Auto : BOOL;",
        "IF Auto THEN Mode := Mode#Auto; END_IF; out := Mode;",
    ));
    for part in [
        "type Mode_type : (Off, Auto)",
        "var Mode : Mode_type",
        "IF Auto THEN Mode := Mode_type.Auto END_IF",
        "out := Mode_type_TO_INT(Mode)",
    ] {
        has(&text, part);
    }
}

#[test]
fn a_value_that_an_enumeration_does_not_have_is_told() {
    let (_, problems) = import(&program(MODE, "m : Mode;", "m := Mode#Away;"));
    assert_eq!(errors(&problems), ["`Mode` has no value `Away`"]);
}

/// The type of a variable without one of its own is called like the variable.
#[test]
fn an_enumeration_without_a_name_gets_one() {
    let text = carried(&program(
        "TYPE S : STRUCT m : (Low, High); END_STRUCT; END_TYPE",
        "m, k : (Off, On); s : S;",
        "m := On; k := m; s.m := High;",
    ));
    for part in [
        "type m_type_ : (Off, On)",
        "type m_type : (Low, High)",
        "var m : m_type_",
        "var k : m_type_",
        "s.m := High",
    ] {
        has(&text, part);
    }
}

/// Members, elements, parameters, in-outs and outputs are of the type.
#[test]
fn structures_arrays_and_parameters_are_of_the_type() {
    let types = "TYPE Mode : (Off, Auto, Hand); Part : STRUCT mode : Mode; row : ARRAY[0..2] OF Mode; END_STRUCT; END_TYPE
FUNCTION Rank : INT VAR_INPUT m : Mode; END_VAR IF m = Hand THEN Rank := 10; ELSE Rank := m; END_IF; END_FUNCTION
FUNCTION_BLOCK Choose
  VAR_INPUT wanted : Mode := Auto; END_VAR
  VAR_OUTPUT given : Mode; END_VAR
  VAR_IN_OUT kept : Mode; END_VAR
  VAR last : Mode; END_VAR
  last := given; given := wanted; IF last = Off THEN kept := Hand; END_IF;
END_FUNCTION_BLOCK";
    let variables = "part : Part; parts : ARRAY[1..2] OF Part; i : INT := 1; c : Choose; k, g : Mode;";
    let (found, problems) = import(&program(
        types,
        variables,
        "parts[i].row[2] := Hand; part.mode := parts[1].row[2]; c(wanted := part.mode, kept := k, given => g); \
         IF c.given = Hand AND part.mode <> Off THEN out := Rank(g) + Rank(m := Auto); END_IF;",
    ));
    assert_eq!(problems, []);
    let text = g7_syntax::print(&found, None);
    for part in [
        "input wanted : Mode := Auto",
        "inout kept : Mode",
        "mode : Mode",
        "row : ARRAY[0..2] OF Mode",
        "function Rank(m : Mode) : INT",
        "IF m = Hand THEN Rank := 10 ELSE Rank := Mode_TO_INT(m) END_IF",
        "parts[i].row[2] := Hand",
        "out := Rank(g) + Rank(m := Auto)",
    ] {
        has(&text, part);
    }
    let mut bench = Bench::new(&found);
    bench.scan();
    assert_eq!((bench.get("g"), bench.get("k"), bench.get("out")), (2, 2, 11));
}

const NEXT: &str = "TYPE Mode : (Off, Auto := 5, Hand); END_TYPE
FUNCTION Next : Mode
  VAR_INPUT m : Mode; plus : INT; END_VAR
  VAR last : Mode := Hand; first : Mode; END_VAR
  CASE m OF Off: Next := Auto; Auto: Next := last; ELSE Next := first; END_CASE;
END_FUNCTION";

/// Parameters, results and local variables of a function keep the enumeration as their type.
#[test]
fn functions_take_and_give_values() {
    let (found, problems) = import(&program(
        NEXT,
        "m : Mode;",
        "m := Next(m, 5); out := Next(0, 1); IF Next(plus := n, m := m) = Off THEN out := out + 100; END_IF;",
    ));
    assert_eq!(problems, []);
    let text = g7_syntax::print(&found, None);
    for part in [
        "function Next(m : Mode, plus : INT) : Mode {",
        "var last : Mode := Hand",
        "var first : Mode",
        "Off: Next := Auto",
        "m := Next(m, 5)",
        "out := Mode_TO_INT(Next(Off, 1))",
        "IF Next(plus := n, m := m) = Off THEN",
    ] {
        has(&text, part);
    }
    let mut bench = Bench::new(&found);
    let mut seen = Vec::new();
    for _ in 0..3 {
        bench.scan();
        seen.push((bench.get("m"), bench.get("out")));
    }
    assert_eq!(seen, [(5, 5), (6, 105), (0, 5)]);
}

/// A number that no value has makes numbers of a parameter and of a result, too.
#[test]
fn functions_that_get_other_numbers_have_numbers() {
    for (action, place) in [("m := Next(n, 1);", "n"), ("m := n; out := Next(m, 1);", "n")] {
        let (what, found) = stays(NEXT, "m : Mode;", action);
        assert_eq!(
            what, "the enumeration `Mode` is read as numbers: here it gets one that is no value",
            "{place}"
        );
        has(&g7_syntax::print(&found, None), "function Next(m : INT, plus : INT) : INT {");
    }
}

/// An input and an output that share a variable are of one type.
#[test]
fn an_inout_of_another_type_makes_numbers_of_both() {
    let types = "TYPE Mode : (Off, Auto, Hand); END_TYPE
FUNCTION_BLOCK Up VAR_IN_OUT x : INT; END_VAR x := x + 1; END_FUNCTION_BLOCK";
    let (what, found) = stays(types, "m : Mode; u : Up;", "u(x := m); out := m;");
    assert_eq!(what, "the enumeration `Mode` is read as numbers: here it is used as one");
    let mut bench = Bench::new(&found);
    assert_eq!(bench.scan().scan().get("out"), 2);
}

/// A drive with a mode switch, with all that an enumeration can do in a file that comes back as it was.
const DRIVE: &str = "TYPE
  Phase : (Rest, Start, Turn, Halt) := Halt;
  Axis : STRUCT phase : Phase; before : Phase := Rest; END_STRUCT;
END_TYPE
FUNCTION_BLOCK Follow
  VAR_INPUT wanted : Phase; END_VAR
  VAR_OUTPUT given : Phase := Rest; END_VAR
  VAR last : Phase; END_VAR
  IF wanted <> last THEN given := last; END_IF;
  last := wanted;
END_FUNCTION_BLOCK
PROGRAM Drive
  VAR_INPUT go : BOOL; wanted : Phase; END_VAR
  VAR_OUTPUT lit : BOOL; shown : Phase; END_VAR
  VAR one : Axis; watch : Follow; now : Phase := Start; END_VAR
  INITIAL_STEP A: Act(N); END_STEP
  STEP B: Back(N); END_STEP
  TRANSITION FROM A TO B := go AND now = Phase#Turn; END_TRANSITION
  TRANSITION FROM B TO A := one.phase <> Halt; END_TRANSITION
  ACTION Act:
    watch(wanted := wanted, given => shown);
    CASE wanted OF Rest: now := Start; Start, Turn: now := watch.given; ELSE now := Turn; END_CASE;
    one.before := one.phase;
    one.phase := now;
    lit := one.before = Rest OR shown = Halt;
  END_ACTION
  ACTION Back: one.phase := Rest; now := one.before; END_ACTION
END_PROGRAM";

/// Text is read, written as text and as PLCopen XML, and read again: the same types, and the same names of values in each scan.
#[test]
fn enumerations_come_back_with_their_values() {
    let (first, problems) = support::read("sfc", DRIVE.as_bytes());
    assert_eq!(problems, []);
    let types = |document: &Document| {
        let text = g7_syntax::print(document, None);
        text.lines().filter(|l| l.starts_with("type ")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(types(&first), ["type Phase : (Rest, Start, Turn, Halt) := Halt"]);
    for format in ["sfc", "plcopen"] {
        let written = support::export(format, &first);
        assert_eq!(errors(&written.problems), <[&str; 0]>::default());
        let (again, problems) = support::import(format, written.text.as_bytes(), g7_model::FileId(0));
        assert_eq!(errors(&problems), <[&str; 0]>::default());
        let kept: Vec<String> =
            types(&again).iter().map(|t| t.split(')').next().unwrap_or("").to_owned()).collect();
        assert_eq!(kept, ["type Phase_2 : (Rest, Start, Turn, Halt"], "{}", written.text);
        let (mut one, mut two) = (Bench::new(&first), Bench::new(&again));
        let mut seen = std::collections::BTreeSet::new();
        for scan in 0..40_i64 {
            for bench in [&mut one, &mut two] {
                bench.set("go", scan / 3 % 2).set("wanted", scan * 7 / 4 % 4).scan();
            }
            for name in ["now", "shown", "one.phase", "one.before", "watch.given", "lit", "wanted"] {
                assert_eq!(
                    one.shown(name),
                    two.shown(name),
                    "{format}, scan {scan}: {name}\n{}",
                    written.text
                );
                seen.insert(one.shown(name));
            }
        }
        assert!(["Rest", "Start", "Turn", "Halt"].iter().all(|v| seen.contains(*v)), "{seen:?}");
    }
}

#[test]
fn matiec_takes_enumerations_that_were_read() {
    let Some(matiec) = g7_peers::matiec() else { return };
    let (document, _) = import(DRIVE);
    let text = support::export("sfc", &document).text;
    assert_eq!(written::compile(&matiec, &text), Ok(()), "{text}");
}
