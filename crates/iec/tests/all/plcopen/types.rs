//! Types, functions and function blocks of a project.

use crate::plcopen::show::{compiles, document, errors, import, text};
use crate::support;
use g7_model::{Document, FileId, Problem, Type};

/// The file is read as this document, without errors, and the document compiles.
fn means(name: &str, expected: &str) -> Document {
    let (found, problems) = import(name);
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}");
    assert_eq!(text(&found), text(&document(expected)), "{name}");
    compiles(&found);
    found
}

/// Reads a project that has these types and units.
fn project(types: &str, pous: &str) -> (Document, Vec<Problem>) {
    let file = format!(
        "<project xmlns='http://www.plcopen.org/xml/tc6_0201'><types><dataTypes>{types}</dataTypes><pous>{pous}</pous></types></project>"
    );
    support::import("plcopen", file.as_bytes(), FileId(0))
}

fn variable(name: &str, ty: &str) -> String {
    format!("<variable name='{name}'><type>{ty}</type></variable>")
}

#[test]
fn types_functions_and_blocks_are_those_of_the_text() {
    let found = means(
        "types.xml",
        r#"
profile iec61131
type Mode : (Off, Hand := 5, Auto)
struct Line { Axes : ARRAY[1..2] OF Axis  State : Mode }
struct Axis { Position : REAL := 0.5 "in mm"  Load : INT(0..100) := 50 }
function block Count {
  input On : BOOL
  output Done : BOOL
  inout Sum : INT
  var Edge : R_TRIG
  body {
    Edge(CLK := On)
    IF Edge.Q THEN Sum := Sum + 1 END_IF
    IF Sum < 10 THEN RETURN END_IF
    Done := TRUE
  }
}
function block Split {
  output Split : INT
  input A : INT
  input B : INT := 3
  output Rest : INT
  body {
    Rest := 0
    Split := 0
    Split := A / B
    Rest := A mod B
  }
}
var Go : BOOL
var Plant : Line := (Axes := [(Position := 2.0), (Load := 7)], State := Hand)
var Levels : ARRAY[0..2] OF INT(0..100) := [1, 2(3)]
var Now : Mode
var Counts : ARRAY[1..2] OF Count
var Total : INT
var Rest : INT
var i : INT
var Split_2 : Split
pre {
  Now := Auto
  FOR i := 1 TO 2 DO Counts[i](On := Go, Sum := Total) END_FOR
  Plant.Axes[1].Position := Plant.Axes[2].Position + 1.0
  IF Counts[1].Done THEN
    Split_2(A := Total, Rest => Rest, B := 3)
    Total := Split_2.Split
  END_IF
}
"#,
    );
    let (written, problems) = support::import("sfc", &crate::plcopen::show::bytes("types.st"), FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new());
    let sorted = |document: &Document| {
        let text = text(document);
        let mut items: Vec<String> = text.split("\n\n").map(|i| i.trim().to_string()).collect();
        items.sort_unstable();
        items
    };
    assert_eq!(sorted(&found), sorted(&written), "in the order of the file; otherwise equal");
}

#[test]
fn charts_and_ladders_use_types_functions_and_blocks() {
    means(
        "station.xml",
        r"
profile iec61131
type Mode : (Off, Auto)
struct Part { Weight : INT  Good : BOOL }
function block Scale {
  input Load : INT
  output Full : BOOL
  inout Item : Part
  body {
    Item.Weight := Load
    Item.Good := Load < 10
    Full := Load > 20 and Now = Auto
    Heavy := Full
  }
}
function block Rest {
  output Rest : INT
  input All : INT
  output Over : INT
  body {
    Over := 0
    Rest := 0
    Rest := All mod 7
    Over := All / 7
  }
}
var Force : INT
var Now : Mode
var Heavy : BOOL
var Rows : ARRAY[1..2] OF BOOL
pre { Rows[2] := Heavy }
chart Sort {
  var Box : Part
  var Scales : ARRAY[1..2] OF Scale
  var Doors : ARRAY[0..3] OF BOOL
  var Left : INT
  var Rest_2 : Rest
  initial step Wait { N Weigh }
  step Push { S Doors[2] }
  Wait -> Push when Now = Auto and Box.Good
  Push -> Wait when Scales[1].Full
  action Weigh {
    Scales[1](Load := Force, Item := Box)
    Rest_2(All := Box.Weight, Over => Box.Weight)
    Left := Rest_2.Rest
  }
}
",
    );
}

#[test]
fn types_of_iec_61131_10_are_read() {
    means(
        "types10.xml",
        r"
profile iec61131
type Mode : (Off, Hand)
type Rank : (Low := 3, High := 9)
struct Axis { Position : REAL := 0.5  Loads : ARRAY[1..2] OF INT(0..100) }
var One : Axis
var Now : Mode := Hand
var Grade : Rank
pre { IF Now = Hand THEN One.Loads[2] := 5  Grade := High END_IF }
",
    );
}

#[test]
fn what_a_type_cannot_be_is_told() {
    let main = |vars: &str| {
        format!(
            "<pou name='P' pouType='program'><interface><localVars>{vars}</localVars></interface><body><ST/></body></pou>"
        )
    };
    let dim = "<dimension lower='1' upper='2'/>";
    let cases = [
        // Names that stand for each other.
        (
            "<dataType name='A'><baseType><derived name='B'/></baseType></dataType>\
          <dataType name='B'><baseType><derived name='A'/></baseType></dataType>",
            "<derived name='A'/>",
            "G0007",
        ),
        // A type of which there is nothing.
        ("", "<derived name='Nothing'/>", "G0604"),
        (
            "<dataType name='A'><baseType><pointer><baseType><INT/></baseType></pointer></baseType></dataType>",
            "<derived name='A'/>",
            "G0604",
        ),
        // Two types of one name.
        (
            "<dataType name='A'><baseType><INT/></baseType></dataType><dataType name='a'><baseType><INT/></baseType></dataType>",
            "<INT/>",
            "G0615",
        ),
        // An array without bounds.
        ("", "<array><baseType><INT/></baseType></array>", "G0604"),
        // The number of a value that is no number.
        (
            "<dataType name='A'><baseType><enum><values><value name='x' value='y'/></values></enum></baseType></dataType>",
            "<derived name='A'/>",
            "G0604",
        ),
        // A dimension without bounds, a subrange without limits.
        ("", "<array><dimension lower='1'/><baseType><INT/></baseType></array>", "G0604"),
        ("", "<subrangeSigned><baseType><INT/></baseType></subrangeSigned>", "G0604"),
        // The values are of a type that has no whole numbers.
        (
            "<dataType name='A'><baseType><enum><values><value name='x'/></values><baseType><REAL/></baseType></enum></baseType></dataType>",
            "<derived name='A'/>",
            "G0614",
        ),
        // A structure has no value as a type.
        (
            "<dataType name='A'><baseType><struct><variable name='x'><type><INT/></type></variable></struct></baseType>\
          <initialValue><simpleValue value='1'/></initialValue></dataType>",
            "<derived name='A'/>",
            "G0604",
        ),
    ];
    for (types, ty, code) in cases {
        let (_, problems) = project(types, &main(&variable("v", ty)));
        assert!(problems.iter().any(|p| p.code.id == code), "{types}: {problems:?}");
    }
    // A value of a list that says nothing would shift those behind it.
    let point = "<dataType name='P'><baseType><struct><variable name='x'><type><INT/></type></variable></struct></baseType></dataType>";
    let list = format!(
        "<variable name='v'><type><array>{dim}<baseType><derived name='P'/></baseType></array></type><initialValue><arrayValue>\
         <value><structValue/></value></arrayValue></initialValue></variable>"
    );
    let (_, problems) = project(point, &main(&list));
    assert!(errors(&problems).contains(&"the value of a structure that names no member"), "{problems:?}");
}

#[test]
fn values_that_cannot_be_placed_are_told() {
    let point = "<dataType name='P'><baseType><struct><variable name='x'><type><INT/></type></variable></struct></baseType></dataType>";
    let main = |ty: &str, value: &str| {
        format!(
            "<pou name='P1' pouType='program'><interface><localVars><variable name='v'><type>{ty}</type><initialValue>{value}\
             </initialValue></variable></localVars></interface><body><ST/></body></pou>"
        )
    };
    let one = "<value><simpleValue value='1'/></value>";
    let (_, problems) =
        project(point, &main("<derived name='P'/>", &format!("<structValue>{one}</structValue>")));
    assert!(errors(&problems).contains(&"the value of a structure that names no member"), "{problems:?}");
    let array = "<array><dimension lower='1' upper='2'/><baseType><INT/></baseType></array>";
    let many = one.replace("<value>", "<value repetitionValue='n'>");
    let (_, problems) = project("", &main(array, &format!("<arrayValue>{many}</arrayValue>")));
    assert!(problems.iter().any(|p| *p.what == *"`n` is not a number of repetitions"), "{problems:?}");
}

#[test]
fn a_structure_within_itself_is_told_by_the_compiler() {
    let own = "<dataType name='A'><baseType><struct><variable name='x'><type><derived name='A'/></type></variable></struct></baseType></dataType>";
    let main = format!(
        "<pou name='P' pouType='program'><interface><localVars>{}</localVars></interface><body><ST/></body></pou>",
        variable("v", "<derived name='A'/>")
    );
    let (found, problems) = project(own, &main);
    assert_eq!(errors(&problems), Vec::<&str>::new());
    let (compiled, _) = g7_compile::compile(&found);
    assert!(compiled.is_none());
}

#[test]
fn an_input_that_a_block_writes_is_a_variable() {
    let block = "<pou name='B' pouType='functionBlock'><interface><localVars><variable name='n'><type><INT/></type></variable>\
                 </localVars><externalVars><variable name='x'><type><INT/></type></variable></externalVars></interface>\
                 <body><ST>x := 3; n := 4;</ST></body></pou>";
    let main = "<pou name='P' pouType='program'><interface><localVars><variable name='b'><type><derived name='B'/></type></variable>\
                <variable name='n' address='%IW2'><type><INT/></type></variable></localVars></interface><body><ST>b();</ST></body></pou>";
    let file = format!(
        "<project xmlns='http://www.plcopen.org/xml/tc6_0201'><types><pous>{block}{main}</pous></types><instances><configurations>\
         <configuration name='C'><globalVars><variable name='x' address='%IW1'><type><INT/></type></variable></globalVars>\
         </configuration></configurations></instances></project>"
    );
    let (found, problems) = support::import("plcopen", file.as_bytes(), FileId(0));
    assert_eq!(problems.iter().map(|p| p.code.id).collect::<Vec<_>>(), ["G0614"]);
    let text = text(&found);
    // `n` of the block is another variable than the input of its name.
    assert!(text.contains("var x : INT\n") && text.contains("input n : INT at %IW2"), "{text}");
    compiles(&found);
}

#[test]
fn a_wide_function_in_a_condition_is_told() {
    let split = format!(
        "<pou name='Split' pouType='function'><interface><returnType><INT/></returnType><inputVars>{}</inputVars><outputVars>{}</outputVars>\
         </interface><body><ST>Split := a; b := a;</ST></body></pou>",
        variable("a", "<INT/>"),
        variable("b", "<INT/>")
    );
    let chart = "<pou name='P' pouType='program'><interface/><body><SFC>\
        <step localId='1' name='S' initialStep='true'><connectionPointOut formalParameter=''/></step>\
        <transition localId='2'><connectionPointIn><connection refLocalId='1'/></connectionPointIn><connectionPointOut/>\
        <condition><inline name=''><ST>Split(3) = 3</ST></inline></condition></transition>\
        <jumpStep localId='3' targetName='S'><connectionPointIn><connection refLocalId='2'/></connectionPointIn></jumpStep>\
        </SFC></body></pou>";
    let (_, problems) = project("", &format!("{split}{chart}"));
    let told = "a function with structures, arrays or outputs in a receptivity; call it in an action";
    assert!(errors(&problems).contains(&told), "{problems:?}");
}

#[test]
fn a_wide_function_in_the_action_of_a_step_has_an_instance() {
    let swap = format!(
        "<pou name='Swap' pouType='function'><interface><returnType><INT/></returnType><inOutVars>{}</inOutVars></interface>\
         <body><ST>Swap := a; a := 0;</ST></body></pou>",
        variable("a", "<INT/>")
    );
    let chart = format!(
        "<pou name='P' pouType='program'><interface><localVars>{}</localVars></interface><body><SFC>\
         <step localId='1' name='S' initialStep='true'><connectionPointOut formalParameter=''/></step>\
         <actionBlock localId='2'><connectionPointIn><connection refLocalId='1'/></connectionPointIn>\
         <action localId='3'><inline><ST>n := Swap(n) + 1;</ST></inline></action></actionBlock></SFC></body></pou>",
        variable("n", "<INT/>")
    );
    let (found, problems) = project("", &format!("{swap}{chart}"));
    assert_eq!(errors(&problems), Vec::<&str>::new());
    let text = text(&found);
    assert!(text.contains("Swap_2(a := n)\n      n := Swap_2.Swap + 1"), "{text}");
    compiles(&found);
}

#[test]
fn the_time_of_the_controller_is_a_timer() {
    let body = "<pou name='P' pouType='program'><interface><localVars>";
    let main = format!(
        "{body}{}</localVars></interface><body><ST>t := TIME();</ST></body></pou>",
        variable("t", "<TIME/>")
    );
    let (found, problems) = project("", &main);
    assert_eq!(errors(&problems), Vec::<&str>::new());
    let text = text(&found);
    assert!(text.contains("var plc_time : TON") && text.contains("t := plc_time.ET"), "{text}");
    compiles(&found);
}

#[test]
fn a_block_that_expects_a_global_variable_has_one() {
    let block = format!(
        "<pou name='B' pouType='functionBlock'><interface><externalVars>{}</externalVars></interface><body><ST>n := n + 1;</ST></body></pou>",
        variable("n", "<INT/>")
    );
    let main = format!(
        "<pou name='P' pouType='program'><interface><localVars>{}</localVars></interface><body><ST>b();</ST></body></pou>",
        variable("b", "<derived name='B'/>")
    );
    let (found, problems) = project("", &format!("{block}{main}"));
    assert_eq!(problems.iter().map(|p| p.code.id).collect::<Vec<_>>(), ["G0610"]);
    compiles(&found);
}

#[test]
fn lengths_of_texts_are_kept() {
    let of = |ty: &str| {
        let vars = format!(
            "<pou name='P' pouType='program'><interface><localVars>{}</localVars></interface><body><ST><xhtml>t := '';</xhtml></ST></body></pou>",
            variable("t", ty)
        );
        let (found, _) = project("", &vars);
        let vars =
            found.items.iter().filter_map(|i| if let g7_model::Item::Var(v) = i { Some(v.ty) } else { None });
        vars.collect::<Vec<_>>()
    };
    assert_eq!(of("<string length='2000'/>"), [Type::String(2000)]);
    assert_eq!(of("<wstring length='10'/>"), [Type::String(30)], "up to three bytes each");
    assert_eq!(of("<wstring/>"), [Type::String(240)]);
}
