//! The declarations that the uses of undeclared names ask for, and the fixes that make them.

use g7_edit::{Gesture, spliced};
use g7_ide::File;
use g7_ide::fixes::Fixes;
use g7_ide::gestures::foresee;

fn file(text: &str) -> File {
    File::open_native("x.g7", text.to_owned()).expect("a file")
}

/// The declarations that a file asks for, in the order of the text.
fn asked(text: &str) -> Vec<String> {
    let file = file(text);
    let known = Fixes::of(&file);
    known.undeclared().iter().map(|u| format!("{} {} : {}", u.class, u.name, u.ty)).collect()
}

/// A chart whose one step has these actions, and whose transition has this receptivity.
fn chart(actions: &str, receptivity: &str) -> String {
    format!(
        "output o : BOOL\nchart G {{\n  initial step 0 {{ {actions} }}\n  0 -> 0 when {receptivity}\n}}\n"
    )
}

#[test]
fn the_type_comes_from_the_use() {
    for (actions, receptivity, wanted) in [
        ("N o", "a", "input a : BOOL"),
        ("N o", "↑a", "input a : BOOL"),
        ("N o", "3s/a", "input a : BOOL"),
        ("N o", "a > 3", "input a : INT"),
        ("N o", "3 < a", "input a : INT"),
        ("N o", "a > 40000", "input a : DINT"),
        ("N o", "a > 3.5", "input a : REAL"),
        ("N o", "a * 2 > 3.5", "input a : REAL"),
        ("N o", "a > T#3s", "input a : TIME"),
        ("N o", "X0.T > a", "input a : TIME"),
        ("N o", "a = 'left'", "input a : STRING"),
        ("N o", "LEN(a) > 3", "input a : STRING"),
        ("N o", "SQRT(a) > 2.0", "input a : REAL"),
        ("N o", "INT_TO_REAL(a) > 2.0", "input a : INT"),
        ("L (a) o", "o", "input a : TIME"),
        ("N a", "o", "output a : BOOL"),
        ("S a", "a", "output a : BOOL"),
        ("N o if a", "o", "input a : BOOL"),
        ("P1 a := a + 1", "o", "var a : INT"),
        ("P1 a := 2.5", "o", "output a : REAL"),
        ("P1 a := 0", "a >= 5", "var a : INT"),
        ("P1 a := X0.T", "o", "output a : TIME"),
        ("P1 a := o", "o", "output a : BOOL"),
        ("P1 a := a + 1, P0 a := a * 0.5", "o", "var a : REAL"),
        ("P1 { FOR a := 1 TO 3 DO o := TRUE; END_FOR; }", "o", "var a : INT"),
        ("P1 { IF a THEN o := TRUE; END_IF; }", "o", "input a : BOOL"),
        ("N o", "a[2] > 3.5", "input a : ARRAY[0..9] OF REAL"),
        ("N o", "a[20]", "input a : ARRAY[0..20] OF BOOL"),
    ] {
        let actions = actions.replace(", ", "\n    ");
        assert_eq!(asked(&chart(&actions, receptivity)), [wanted], "{actions} | {receptivity}");
    }
}

#[test]
fn an_index_is_a_whole_number_and_names_lend_each_other_their_types() {
    let text = chart("N o", "v[i] > 2.0 and j = k and k > 1.5")
        .replace("output o", "var v : ARRAY[0..3] OF REAL\noutput o");
    assert_eq!(asked(&text), ["input i : INT", "input j : REAL", "input k : REAL"]);
}

#[test]
fn a_test_tells_the_type_of_what_it_sets_and_expects_outputs() {
    let text = chart("N o", "go and depth > 2") + "test \"t\" {\n  pulse go\n  set depth := 2.5\n}\n";
    assert_eq!(asked(&text), ["input go : BOOL", "input depth : REAL"]);
    // Tests are read when the charts have no errors.
    let text = chart("N o", "o") + "test \"t\" {\n  expect lamp\n}\n";
    assert_eq!(asked(&text), ["output lamp : BOOL"]);
}

#[test]
fn each_name_has_its_fixes_the_likely_one_first_and_they_solve_it() {
    let many: Vec<String> = (0..20).map(|n| format!("signal{n}x{}", n * n)).collect();
    let file = file(&chart("N o", &many.join(" and ")));
    let known = Fixes::of(&file);
    assert_eq!(file.problems.iter().filter(|p| p.code.id == "G0202").count(), 20);
    for (p, name) in file.problems.iter().filter(|p| p.code.id == "G0202").zip(&many) {
        let fixes = known.fixes(p);
        let declared: Vec<&str> =
            fixes.iter().filter(|f| f.splices().is_none()).map(|f| f.title.as_str()).collect();
        assert_eq!(declared.len(), 3, "{declared:?}");
        assert_eq!(declared.first(), Some(&&*format!("declare `{name} : BOOL` as an input")));
        let fix = fixes.iter().find(|f| f.splices().is_none()).expect("it was counted");
        let text = spliced(file.text(), &fix.edit(&file).expect("a draft").splices).expect("it fits");
        assert!(!asked(&text).iter().any(|line| line.contains(&format!(" {name} "))), "{text}");
    }
}

#[test]
fn a_field_foresees_only_the_names_of_its_own_symbol() {
    let file = file(
        "chart G {\n  initial step 0\n  0 -> 0 when elsewhere\n  step 1\n  1 -> 0 when TRUE\n  0 -> 1 when TRUE\n}\n",
    );
    let gesture =
        Gesture::Receptivity { id: "G/t/1".parse().expect("an id"), text: "here and level < 3.0".to_owned() };
    let after = foresee(&file, &gesture).expect("it reads");
    let names: Vec<&str> = after.undeclared.iter().map(|u| u.name.as_str()).collect();
    assert_eq!(names, ["here", "level"]);
    assert!(file.text().contains("1 -> 0 when TRUE"), "the file stays as it is");
}
