//! A construct that cannot be carried over is reported, with its place.

use crate::plcopen::show::{bytes, document, errors, import, places};
use crate::support;
use crate::support::recognise;

#[test]
fn each_mistake_has_its_line() {
    let (_, problems) = import("wrong.xml");
    let mut found = places(&bytes("wrong.xml"), &problems);
    found.sort();
    let mut expected = [
        "G0604 4",  // a pointer
        "G0615 8",  // two variables of one name
        "G0604 9",  // a variable of that type
        "G0605 10", // an address given elsewhere
        "G0611 14", // two steps of one name
        "G0609 14", // a step behind a step
        "G0606 15", // no condition
        "G0610 15", // nothing behind
        "G0609 16", // a wire from nowhere
        "G0609 16", // no step at all
        "G0606 17", // a condition that ends too soon
        "G0610 17", // nothing behind
        "G0609 18", // a jump to nowhere
        "G0609 19", // an action block at no step
        "G0604 21", // a qualifier that is none
        "G0612 22", // a duration is missing
        "G0607 23", // an unknown name
        "G0605 24", // an indicator
        "G0603 26", // an unknown object
        "G0604 27", // a coil that belongs to nothing
    ];
    expected.sort_unstable();
    assert_eq!(found, expected, "{:?}", problems.iter().map(|p| &p.what).collect::<Vec<_>>());
}

#[test]
fn a_file_is_known_by_its_name_space() {
    let known = |text: &str| recognise("", text.as_bytes());
    for space in ["http://www.plcopen.org/xml/tc6_0200", "http://www.plcopen.org/xml/tc6_0201"] {
        assert_eq!(known(&format!("<project xmlns=\"{space}\"/>")), Some("plcopen"));
    }
    let last = "<ppx:Project xmlns:ppx=\"www.iec.ch/public/TC65SC65BWG7TF10\"/>";
    assert_eq!(known(last), Some("plcopen"));
    assert_ne!(known("<project/>"), Some("plcopen"));
}

#[test]
fn what_iec_61131_does_not_have_is_said_of_an_export() {
    let text = r#"profile iec60848
input a : BOOL at 3
input b : BOOL inverted
output v : BOOL safe TRUE
var c : DINT
chart G {
  initial step 1 { force H := INIT  on rise(a): c := 1  N v if a }
  step 2
  1 -> 2 when rise(a)
  2 -> 1 when 3s/a/2s on clearing { c := 0 }
  () -> 2 when b
}
chart H { initial step 5 }
prove always v
"#;
    let written = support::export("plcopen", &document(text));
    let mut found = places(text.as_bytes(), &written.problems);
    found.sort();
    let mut expected = [
        "G0614 1",  // other rules
        "G0605 2",  // a channel
        "G0605 4",  // a safe value
        "G0604 7",  // forcing
        "G0614 7",  // on event
        "G0611 7",  // 1 is no identifier, nor 2 and 5
        "G0614 10", // on clearing
        "G0614 11", // a source
        "G0605 14", // a property
    ];
    expected.sort_unstable();
    assert_eq!(found, expected, "{:?}", written.problems.iter().map(|p| &p.what).collect::<Vec<_>>());
    assert!(!errors(&written.problems).is_empty());
}

#[test]
fn a_block_that_no_code_calls_is_told() {
    let block = |name: &str, body: &str| {
        format!(
            "<pou name=\"{name}\" pouType=\"functionBlock\"><interface><localVars><variable name=\"n\"><type><INT/></type>\
             </variable></localVars></interface><actions><action name=\"Own\"><body><ST>n := 0;</ST></body></action></actions><body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">{body}</xhtml></ST></body></pou>\n"
        )
    };
    let instance = |name: &str, ty: &str| {
        format!("<variable name=\"{name}\"><type><derived name=\"{ty}\"/></type></variable>\n")
    };
    // A block with an action has a chart for each instance. `Ran` calls `Inner`, and is called by the program; `Idle` calls `Lost`, and is called by nobody.
    let file = format!(
        "<project xmlns=\"http://www.plcopen.org/xml/tc6_0200\"><types><dataTypes/><pous>\n\
         {}{}<pou name=\"P\" pouType=\"program\"><interface><externalVars>{}</externalVars></interface>\
         <body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">Ran();</xhtml></ST></body></pou></pous></types>\n\
         <instances><configurations><configuration name=\"C\"><globalVars>\n{}{}{}{}</globalVars></configuration>\
         </configurations></instances></project>",
        block("Plain", "n := n + 1;"),
        block("Caller", "Inner(); n := n + 2;"),
        instance("Ran", "Caller"),
        instance("Ran", "Caller"),
        instance("Inner", "Plain"),
        instance("Idle", "Caller"),
        instance("Lost", "Plain"),
    );
    let (read, problems) = support::import("plcopen", file.as_bytes(), g7_model::FileId(0));
    let whats: Vec<_> = problems.iter().map(|p| (p.code.id, &*p.what)).collect();
    let words = |name: &str| format!("no code calls the function block `{name}`; its body is left out");
    assert_eq!(whats, [("G0605", &*words("Idle")), ("G0605", &*words("Lost"))]);
    let text = crate::plcopen::show::text(&read);
    assert!(text.contains("Inner.n := Inner.n + 1") && text.contains("Ran.n := Ran.n + 2"), "{text}");
}

#[test]
fn a_chart_without_steps_has_no_body_for_a_program() {
    let chart = document("profile iec61131\nchart Home { var n : INT }");
    let written = support::export("plcopen", &chart);
    assert_eq!(errors(&written.problems), ["the chart `Home` has no step, and a program has a body"]);
}
