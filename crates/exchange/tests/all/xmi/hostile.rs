//! Files made to break a reader: it ends soon, with words, never with a panic.

use crate::support;
use crate::support::recognise;
use g7_model::{Document, FileId, Problem};

use crate::support::hostile::{changed_for, within};
use crate::xmi::show::bytes;

const HEAD: &str = "<g:Grafcet xmlns:g='g' xmlns:xsi='x' xmlns:terms='t'>";
const TAIL: &str = "</g:Grafcet>";

fn import(file: &[u8]) -> (Document, Vec<Problem>) {
    recognise("", file);
    let (document, problems) = support::import("xmi", file, FileId(0));
    for p in &problems {
        assert!(p.at.start <= p.at.end, "{p:?}");
        assert!(p.at.end as usize <= file.len().max(1), "{p:?}");
    }
    support::export("xmi", &document);
    (document, problems)
}

/// The codes of a file, found within a time that no bound lets pass.
fn codes(body: &str) -> Vec<&'static str> {
    let file = format!("{HEAD}{body}{TAIL}");
    let (_, problems) = within(20, || import(file.as_bytes()));
    problems.iter().map(|p| p.code.id).collect()
}

#[test]
fn the_gate_for_xml_stands_before_this_reader_too() {
    let bomb = r#"<!DOCTYPE l [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><g:Grafcet xmlns:g="g" name="&b;"/>"#;
    assert_eq!(import(bomb.as_bytes()).1.iter().map(|p| p.code.id).collect::<Vec<_>>(), ["G0601"]);
    let deep = format!("{}{}", "<partialGrafcets>".repeat(10_000), "</partialGrafcets>".repeat(10_000));
    assert_eq!(codes(&deep), ["G0007"]);
}

#[test]
fn wide_terms_are_refused() {
    let many = "<subterm xsi:type='terms:BooleanConstant'/>".repeat(50_000);
    for class in ["And", "Equality", "Addition"] {
        let file = format!(
            "<partialGrafcets><transitions><term xsi:type='terms:{class}'>{many}</term></transitions></partialGrafcets>"
        );
        assert!(codes(&file).contains(&"G0007"), "{class}");
    }
}

#[test]
fn one_action_of_many_steps_is_bounded() {
    let steps = "<steps/>".repeat(3000);
    let value = "<subterm xsi:type='terms:BooleanConstant'/>".repeat(300);
    let links: String = (0..3000)
        .map(|n| format!("<actionLinks step='//@partialGrafcets.0/@steps.{n}' actionType='//@partialGrafcets.0/@actionTypes.0'/>"))
        .collect();
    let file = format!(
        "<partialGrafcets>{steps}<actionTypes xsi:type='g:StoredAction'><variable variableDeclaration='{}'/><value xsi:type='terms:And'>{value}</value></actionTypes>{links}</partialGrafcets>
         <variableDeclarationContainer><variableDeclarations name='a'><sort xsi:type='terms:Bool'/></variableDeclarations></variableDeclarationContainer>",
        "//@variableDeclarationContainer/@variableDeclarations.0"
    );
    assert!(codes(&file).contains(&"G0008"));
}

#[test]
fn synchronisations_are_bounded() {
    let part = |n: usize, what: &str| format!("//@partialGrafcets.0/@{what}.{n}");
    let mut arcs = String::new();
    for n in 0..3000 {
        arcs += &format!("<arcs source='{}' target='{}'/>", part(n, "steps"), part(0, "synchronizations"));
        arcs +=
            &format!("<arcs source='{}' target='{}'/>", part(0, "synchronizations"), part(n, "transitions"));
    }
    let file = format!(
        "<partialGrafcets>{}{}<synchronizations/>{arcs}</partialGrafcets>",
        "<steps/>".repeat(3000),
        "<transitions/>".repeat(3000)
    );
    assert!(codes(&file).contains(&"G0008"));
}

#[test]
fn many_equal_numbers_and_long_references_are_no_work() {
    let names = "<steps id='7'/>".repeat(30_000);
    codes(&format!("<partialGrafcets>{names}</partialGrafcets>"));
    let long = "/@a.0".repeat(100_000);
    assert!(
        codes(&format!("<partialGrafcets enclosingStep='/{long}'><steps/></partialGrafcets>"))
            .contains(&"G0607")
    );
    let many = "//@a.0 ".repeat(100_000);
    assert!(
        codes(&format!("<partialGrafcets><steps partialGrafcets='{many}'/></partialGrafcets>"))
            .contains(&"G0607")
    );
}

/// Put into files besides bytes and pieces of their own.
const WORDS: &[&str] = &[
    "<",
    ">",
    "/>",
    "\"",
    "&",
    "&#10;",
    "<!--",
    "é",
    "\u{202e}",
    "//@",
    "@steps.0",
    ".1",
    ".99999999999999999999",
    "initial=\"true\"",
    "partialGrafcets",
    "terms:",
    "Variable",
    "And",
    "Not",
    "-1",
    "99999999999",
    "true",
    "#",
    "/",
    "`",
    "enclosingStep=\"//@partialGrafcets.0/@steps.0\"",
    "<subterm xsi:type=\"terms:Not\">",
    "</subterm>",
];

#[test]
fn a_changed_file_never_panics() {
    changed_for(["mixer.grafcet", "wrong.grafcet"].map(bytes).to_vec(), WORDS, (300, 8), |file| {
        _ = import(file)
    });
}
