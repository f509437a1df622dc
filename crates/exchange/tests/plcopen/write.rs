//! Documents as projects: what TC6 can hold comes back equal.

use g7_exchange::{Format, Outlet};
use g7_model::{Document, FileId};
use roxmltree::Node;

use crate::show::{document, errors, import, text};

/// The project of a document, which must hold all of it.
fn written(document: &Document) -> String {
    let written = g7_exchange::export(Outlet::Plcopen, document);
    assert_eq!(errors(&written.problems), Vec::<&str>::new());
    written.text
}

/// Out and in again.
fn again(document: &Document) -> Document {
    let xml = written(document);
    let (again, problems) = g7_exchange::import(Format::Plcopen, xml.as_bytes(), FileId(1));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{xml}");
    again
}

/// The lines of a document: variables come back by their sort, sections and
/// actions in an order of their own.
fn sorted(document: &Document) -> Vec<String> {
    let mut lines: Vec<String> =
        text(document).lines().filter(|l| !l.is_empty()).map(str::to_string).collect();
    lines.sort();
    lines
}

#[test]
fn a_chart_comes_back_equal() {
    let there = document(
        r#"
profile iec61131
scan 20ms
input start : BOOL at %IX0.0 "the green button"
input parts : INT
output lamp : BOOL
output valve : BOOL at %QX0.1
var n : INT := -3
var t1 : TON
var level : REAL := 0.5
var name : STRING(20) := 'it$'s <on> & off'
var total : DINT retain
const most : INT := 10
chart Press "one machine" {
  initial step Rest "waits"
  step Down { N valve  L 2s lamp  D (T#1s) Tell  P1 n := n + 1  P0 { n := 0; level := level / 2.0 }  S lamp  R lamp }
  step Hold { SD 1h30m lamp  DS 10ms lamp  SL 1.5ms lamp  P lamp }
  macro Lift = Lift
  begin: Rest -> (Down, Hold) when start and not (parts > most or n = 0) priority 2
  Rest -> Rest when n < 0 priority 1 "again"
  (Down, Hold) -> Lift when Down.X and Down.t >= 3s xor valve
  Lift -> Rest when Ready
  Lift -> Hold when FALSE
  action Tell "tells" {
    CASE n OF 1, 2: lamp := TRUE; 3 .. 5: t1(IN := lamp, PT := 2s) ELSE n := ABS(n) END_CASE
    FOR n := 1 TO 10 BY 2 DO WHILE level > 1.0 DO level := level - 1.0 END_WHILE END_FOR
    REPEAT n := n + 1; IF n > 5 THEN EXIT ELSIF t1.Q THEN RETURN ELSE lamp := FALSE END_IF UNTIL n >= 10 END_REPEAT
  }
  transition section Ready { IF start THEN Ready := TRUE ELSE Ready := lamp END_IF }
}
macrochart Lift {
  entry step Up
  step Halt
  exit step Top
  Up -> Halt when start
  Halt -> Top when not start
}
"#,
    );
    assert_eq!(sorted(&again(&there)), sorted(&there), "{}", text(&again(&there)));
}

#[test]
fn several_charts_bodies_and_functions_come_back_equal() {
    let there = document(
        r#"
profile iec61131
scan 10ms
input a : BOOL
output b : BOOL
var n : DINT
var kept : DINT retain
const k : DINT := 5
function Half(x : REAL) : REAL { var two : REAL := 2.0  Half := x / two }
pre { n := n + 1 }
post { b := n > 3 }
chart One { initial step S1  step S2  S1 -> S2 when a  S2 -> S1 when n > k }
chart Two { initial step S3  step S4 { N b }  S3 -> S4 when a  S4 -> S3 when not a }
"#,
    );
    assert_eq!(text(&again(&there)), text(&there));
}

#[test]
fn places_come_back() {
    let there = document(
        r#"
profile iec61131
input a : BOOL
chart G { initial step S1  step S2  S1 -> S2 when a  S2 -> S1 when not a }
layout G { step S1 at (5.25, 1)  step S2 at (5.25, 9.5)  transition #0 at (5.25, 5)  transition #1 at (8, 14) }
"#,
    );
    let layout = |d: &Document| g7_syntax::print(d, None).split("layout").nth(1).map(str::to_string);
    assert_eq!(layout(&again(&there)), layout(&there));
}

#[test]
fn imported_projects_come_back() {
    for name in ["press.xml", "part10.xml"] {
        let (mut there, _) = import(name);
        // An edge has no place in a condition of IEC 61131-3.
        let edge = "or rise(Lower)";
        let plain = text(&there).replace("or ↑Lower", "").replace(edge, "");
        there = document(&plain);
        assert_eq!(sorted(&again(&there)), sorted(&there), "{name}");
    }
}

/// The children of an element stand in the order that the schema has.
fn ordered(node: Node, order: &[&str]) {
    let places: Vec<usize> = node
        .children()
        .filter(Node::is_element)
        .map(|c| {
            let name = c.tag_name().name();
            order
                .iter()
                .position(|o| *o == name)
                .unwrap_or_else(|| panic!("{name} in {}", node.tag_name().name()))
        })
        .collect();
    assert!(places.is_sorted(), "{}: {places:?}", node.tag_name().name());
}

/// Each attribute that the schema wants is there, and none that it does not know.
fn attributes(node: Node, wanted: &[&str], known: &[&str]) {
    let names: Vec<&str> = node.attributes().map(|a| a.name()).collect();
    for name in wanted {
        assert!(names.contains(name), "{} without {name}", node.tag_name().name());
    }
    for name in names {
        assert!(wanted.contains(&name) || known.contains(&name), "{}: {name}", node.tag_name().name());
    }
}

#[test]
fn what_is_written_keeps_to_the_schema() {
    let (there, _) = import("press.xml");
    let written = g7_exchange::export(Outlet::Plcopen, &there);
    let tree = roxmltree::Document::parse(&written.text).expect("well-formed");
    let root = tree.root_element();
    assert_eq!(root.tag_name().namespace(), Some("http://www.plcopen.org/xml/tc6_0201"));
    let object = ["localId"];
    let size = ["height", "width"];
    let mut seen = 0;
    for node in root.descendants().filter(Node::is_element) {
        seen += 1;
        match node.tag_name().name() {
            "project" => ordered(node, &["fileHeader", "contentHeader", "types", "instances"]),
            "fileHeader" => {
                attributes(node, &["companyName", "productName", "productVersion", "creationDateTime"], &[]);
            }
            "contentHeader" => attributes(node, &["name"], &[]),
            "coordinateInfo" => ordered(node, &["fbd", "ld", "sfc"]),
            "types" => ordered(node, &["dataTypes", "pous"]),
            "pou" => {
                attributes(node, &["name", "pouType"], &[]);
                ordered(node, &["interface", "actions", "transitions", "body", "documentation"]);
            }
            "variable" => {
                attributes(node, &["name"], &["address"]);
                ordered(node, &["type", "initialValue", "documentation"]);
            }
            "step" => {
                attributes(node, &["localId", "name"], &["height", "width", "initialStep"]);
                let order = [
                    "position",
                    "connectionPointIn",
                    "connectionPointOut",
                    "connectionPointOutAction",
                    "documentation",
                ];
                ordered(node, &order);
            }
            "transition" if node.has_attribute("localId") => {
                attributes(node, &object, &["height", "width", "priority"]);
                let order =
                    ["position", "connectionPointIn", "connectionPointOut", "condition", "documentation"];
                ordered(node, &order);
            }
            "selectionDivergence"
            | "selectionConvergence"
            | "simultaneousDivergence"
            | "simultaneousConvergence" => {
                attributes(node, &object, &size);
                ordered(node, &["position", "connectionPointIn", "connectionPointOut"]);
            }
            "jumpStep" => attributes(node, &["localId", "targetName"], &size),
            "actionBlock" => {
                attributes(node, &object, &size);
                ordered(node, &["position", "connectionPointIn", "action"]);
            }
            "action" if node.has_attribute("localId") => {
                attributes(node, &object, &["qualifier", "duration"]);
                ordered(node, &["relPosition", "reference", "inline"]);
            }
            "connection" => attributes(node, &["refLocalId"], &[]),
            "position" | "relPosition" | "scaling" => attributes(node, &["x", "y"], &[]),
            "task" => attributes(node, &["name", "priority"], &["interval"]),
            "pouInstance" => attributes(node, &["name", "typeName"], &[]),
            _ => {}
        }
    }
    assert!(seen > 100);
}
