//! Arrays leave as single variables: the right element for each index. Where it is not known, they leave as arrays, if
//! the format has these.

use g7_model::FileId;

/// The IEC 61131-3 text of a chart, and the words at the places of its errors.
fn sfc(text: &str) -> (String, Vec<&str>) {
    written(text, "sfc")
}

fn written<'t>(text: &'t str, form: &str) -> (String, Vec<&'t str>) {
    let (document, mut problems) = g7_syntax::parse(text, FileId(0));
    problems.append(&mut g7_compile::check(&document));
    problems.retain(|p| p.severity() == g7_model::Severity::Error);
    assert!(problems.is_empty(), "{problems:?}");
    let written = g7_exchange::named(form).and_then(|f| f.write(&document)).expect("it is written");
    let errors = written.problems.iter().filter(|p| p.severity() == g7_model::Severity::Error);
    let words = errors.map(|p| &text[p.at.bytes()]).collect();
    (written.text, words)
}

/// Two charts that each drive an element; `first` and `second` stand in their actions.
fn charts(first: &str, second: &str) -> String {
    format!(
        "profile iec61131\ninput b : ARRAY[1..2] OF BOOL\nvar x : ARRAY[-1..2] OF INT := [4, 2(5)]\n\
         chart G {{\n  const c : INT := 1\n  initial step 0 {{ {first} }}\n  step 1\n  0 -> 1 when b[1]\n  1 -> 0 when not \
         b[c]\n}}\nchart H {{\n  const c : INT := 2\n  initial step 0 {{ {second} }}\n  step 1\n  0 -> 1 when b[2]\n  \
         1 -> 0 when not b[c]\n}}\n"
    )
}

#[test]
fn a_constant_is_that_of_its_own_chart() {
    let chart = charts("P1 x[c] := 7", "P1 x[c] := x[-1]");
    let (text, errors) = sfc(&chart);
    assert_eq!(errors, Vec::<&str>::new());
    for line in
        ["x_1 := 7;", "x_2 := x_m1;", ":= NOT b_1;", ":= NOT b_2;", "x_m1 : INT := 4;", "x_0 : INT := 5;"]
    {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
}

#[test]
fn a_local_variable_is_not_taken_for_the_constant_that_it_hides() {
    let chart = charts("P1 { var c : INT := 2; x[c] := 7 }", "P1 x[0] := 7");
    // Elsewhere the constant could be known; to refuse it is safe.
    for words in ["x[c]", "b[c]"] {
        assert!(written(&chart, "controlexpert").1.contains(&words), "{words}");
    }
    let (text, errors) = sfc(&chart);
    assert_eq!(errors, Vec::<&str>::new());
    for line in
        ["x[Step0_1_c] := 7;", "x[0] := 7;", ":= NOT b[c];", ":= NOT b[H_c];", "x : INT_m1_2 := [4, 2(5)];"]
    {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
}

#[test]
fn a_format_without_arrays_refuses_an_index_that_is_not_known() {
    let chart = charts("P1 x[x[0]] := 7", "P1 x[1] := x[x[1]]");
    assert!(written(&chart, "controlexpert").1.contains(&"x[x[0]]"));
    let (text, errors) = sfc(&chart);
    assert_eq!(errors, Vec::<&str>::new());
    for line in ["INT_m1_2 : ARRAY[-1..2] OF INT;", "x[x[0]] := 7;", "x[1] := x[x[1]];"] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
}

#[test]
fn elements_that_actions_drive_are_copied_into_an_open_array() {
    let (text, errors) = sfc(
        "profile iec61131\ninput k : INT\noutput one : BOOL\nvar m : ARRAY[1..3] OF BOOL\n\
         chart G {\n  initial step 0 { N m[2] }\n  step 1 { S m[1] }\n  0 -> 1 when m[2] and one\n  1 -> 0 when k = 3\n}\n\
         post { one := m[k] }\n",
    );
    assert_eq!(errors, Vec::<&str>::new());
    let at = |line: &str| text.find(line).unwrap_or_else(|| panic!("{line} is missing in\n{text}"));
    assert!(at("m[1] := m_1;") < at("m[2] := m_2;"));
    assert!(at("m[2] := m_2;") < at("one := m[k];"));
    at("m_2(N)");
    at("m_1(S)");
    at(":= m_2 AND one;");
    assert!(!text.contains("m_3"), "{text}");
}

#[test]
fn the_body_behind_a_chart_sees_the_copies_of_its_array() {
    let (text, errors) = sfc("profile iec61131\ninput k : INT\noutput one : BOOL\n\
         chart G {\n  var m : ARRAY[1..2] OF BOOL\n  initial step 0 { N m[2] }\n  step 1\n  0 -> 1 when k = 1\n  1 -> 0 when k = 2\n  \
         post { one := m[k] }\n}\npost { one := one or G.m[k] }\n");
    assert_eq!(errors, Vec::<&str>::new());
    let at = |line: &str| text.find(line).unwrap_or_else(|| panic!("{line} is missing in\n{text}"));
    assert!(at("m[2] := m_2;") < at("one := one OR m[k];"));
    assert!(at("m[2] := m_2;") < at("one := m[k];"));
}

#[test]
fn names_that_are_taken_stay() {
    let (text, errors) = sfc(
        "input x_1 : BOOL\nvar x : ARRAY[1..1] OF BOOL\nchart G {\n  initial step 0 { N x[1] }\n  step 1\n  \
                              0 -> 1 when x_1\n  1 -> 0 when not x_1\n}\n",
    );
    assert_eq!(errors, Vec::<&str>::new());
    assert!(text.contains("x_1_"), "{text}");
}
