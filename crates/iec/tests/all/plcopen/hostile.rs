//! Files made to break a reader: it ends soon, with words, never with a panic.

use crate::support;
use crate::support::recognise;
use g7_model::{Document, FileId, Problem};

use crate::plcopen::show::bytes;
use crate::support::hostile::{changed_for, within};

const FILES: [&str; 6] = ["press.xml", "blocks.xml", "networks.xml", "part10.xml", "macros.xml", "wrong.xml"];

fn import(file: &[u8]) -> (Document, Vec<Problem>) {
    recognise("", file);
    let (document, problems) = support::import("plcopen", file, FileId(0));
    for p in &problems {
        assert!(p.at.start <= p.at.end, "{p:?}");
        assert!(p.at.end as usize <= file.len().max(1), "{p:?}");
    }
    support::export("plcopen", &document);
    (document, problems)
}

/// The codes of a chart with these objects, found within a time that no bound lets pass.
fn codes(objects: &str) -> Vec<&'static str> {
    codes_of(&format!(
        "<pou name='P' pouType='program'><interface><localVars><variable name='a'><type><BOOL/></type></variable>\
         </localVars></interface><body><SFC>{objects}</SFC></body></pou>"
    ))
}

fn codes_of(pous: &str) -> Vec<&'static str> {
    let file = format!(
        "<project xmlns='http://www.plcopen.org/xml/tc6_0201'><types><pous>{pous}</pous></types></project>"
    );
    let (_, problems) = within(60, || import(file.as_bytes()));
    problems.iter().map(|p| p.code.id).collect()
}

fn wire(from: usize) -> String {
    format!("<connectionPointIn><connection refLocalId='{from}'/></connectionPointIn>")
}

#[test]
fn entities_and_encodings_are_refused() {
    let refused = |file: &[u8]| {
        let (document, problems) = import(file);
        assert_eq!(document.charts().count(), 0);
        problems.iter().map(|p| p.code.id).collect::<Vec<_>>()
    };
    let bomb =
        "<!DOCTYPE l [<!ENTITY a 'aaaaaaaaaa'>]><project xmlns='http://www.plcopen.org/xml/tc6_0201'/>";
    assert_eq!(refused(bomb.as_bytes()), ["G0601"]);
    assert_eq!(refused(b"<project xmlns='http://www.plcopen.org/xml/tc6_0201'><types>"), ["G0601"]);
    let wide: Vec<u8> = "<project xmlns='http://www.plcopen.org/xml/tc6_0201'/>"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(recognise("", &wide), Some("plcopen"));
    assert_eq!(refused(&wide), ["G0001"]);
    assert_eq!(refused(b"<other/>"), ["G0602"]);
}

#[test]
fn lines_that_multiply_are_bounded() {
    // Each convergence joins the two before it: twice as many ways a level.
    let mut objects = String::new();
    for n in 0..2 {
        objects += &format!("<step localId='{n}' name='s{n}'/>");
    }
    for n in 2..200 {
        objects += &format!(
            "<selectionConvergence localId='{n}'>{}{}</selectionConvergence>",
            wire(n - 1),
            wire(n - 2)
        );
    }
    objects += &format!("<transition localId='900'>{}</transition>", wire(199));
    assert!(codes(&objects).contains(&"G0609"));
    // A circle without a step.
    let circle = format!(
        "<selectionDivergence localId='1'>{}</selectionDivergence><selectionDivergence localId='2'>{}</selectionDivergence>\
         <transition localId='3'>{}</transition>",
        wire(2),
        wire(1),
        wire(1)
    );
    assert!(codes(&circle).contains(&"G0609"));
}

#[test]
fn values_that_multiply_are_bounded() {
    // Each block adds the one before it to itself.
    let mut objects = String::from(
        "<step localId='800' name='s'/><inVariable localId='0'><expression>a</expression></inVariable>",
    );
    for n in 1..60 {
        let pin = |p: &str| format!("<variable formalParameter='{p}'>{}</variable>", wire(n - 1));
        objects += &format!(
            "<block localId='{n}' typeName='OR'><inputVariables>{}{}</inputVariables></block>",
            pin("IN1"),
            pin("IN2")
        );
    }
    objects +=
        &format!("<transition localId='900'>{}<condition>{}</condition></transition>", wire(800), wire(59));
    assert!(codes(&objects).contains(&"G0008"));
    let own = format!(
        "<block localId='1' typeName='NOT'><inputVariables><variable formalParameter='IN'>{}</variable></inputVariables></block>\
         <step localId='3' name='s'/><transition localId='2'>{}<condition>{}</condition></transition>",
        wire(1),
        wire(3),
        wire(1)
    );
    assert!(codes(&own).contains(&"G0609"));
}

#[test]
fn rows_that_multiply_are_bounded() {
    for row in
        ["", "<value><simpleValue value='1'/></value>", "<value/><value><simpleValue value='1'/></value>"]
    {
        let open = "<arrayValue><value repetitionValue='4000000000'>".repeat(12);
        let close = "</value></arrayValue>".repeat(12);
        let value = format!("{open}<arrayValue>{row}{row}</arrayValue>{close}");
        let array = "<array><dimension lower='1' upper='2'/><baseType><INT/></baseType></array>";
        codes_of(&format!(
            "<pou name='P' pouType='program'><interface><localVars><variable name='a'><type>{array}</type>\
             <initialValue>{value}</initialValue></variable></localVars></interface><body><ST/></body></pou>"
        ));
    }
}

#[test]
fn blocks_that_multiply_are_bounded() {
    // Each block has two instances of the next, and calls both.
    let block = |n: usize| {
        let next = format!("<type><derived name='B{}'/></type>", n + 1);
        format!(
            "<pou name='B{n}' pouType='functionBlock'><interface><localVars><variable name='x'>{next}</variable>\
             <variable name='y'>{next}</variable></localVars></interface><body><ST>x(); y();</ST></body></pou>"
        )
    };
    // A block with an action becomes a chart in each instance, and with it those that hold one.
    let last = "<pou name='B15' pouType='functionBlock'><interface/><actions><action name='A'><body><ST/></body></action>\
                </actions><body><ST/></body></pou>";
    let plain: String = (0..15).map(block).collect();
    let blocks = format!("{plain}{last}");
    let main = "<pou name='P' pouType='program'><interface><localVars><variable name='b'><type><derived name='B0'/></type>\
                </variable></localVars></interface><body><ST>b();</ST></body></pou>";
    assert!(codes_of(&format!("{blocks}{main}")).contains(&"G0008"));
    let own = "<pou name='B' pouType='functionBlock'><interface><localVars><variable name='b'><type><derived name='B'/></type>\
               </variable></localVars></interface><body><ST>b();</ST></body></pou>";
    let main = main.replace("'B0'", "'B'");
    assert!(refused(&format!("{own}{main}")).contains(&"G0216"));
    let main = main.replace("'B'", "'B0'");
    let leaf = last.replace("<actions><action name='A'><body><ST/></body></action></actions>", "");
    assert!(refused(&format!("{plain}{leaf}{main}")).contains(&"G0008"));
}

/// The codes with which a file of these units is refused as a program.
fn refused(pous: &str) -> Vec<&'static str> {
    let file = format!(
        "<project xmlns='http://www.plcopen.org/xml/tc6_0201'><types><pous>{pous}</pous></types></project>"
    );
    let (_, problems) = g7_compile::compile(&import(file.as_bytes()).0);
    problems.iter().map(|p| p.code.id).collect()
}

#[test]
fn a_name_that_all_have_is_told_apart_soon() {
    let steps: String = (1..40_000).map(|i| format!("<step localId='{i}' name='S'/>")).collect();
    assert!(codes(&steps).contains(&"G0611"));
    let pou = "<pou name='P' pouType='program'><interface/><body><SFC><step localId='1' name='S' initialStep='true'/></SFC></body></pou>";
    assert!(codes_of(&pou.repeat(40_000)).contains(&"G0611"));
}

/// Put into files besides bytes and pieces of their own.
const WORDS: &[&str] = &[
    "<",
    ">",
    "/>",
    "\"",
    "&#10;",
    "<![CDATA[",
    "]]>",
    "é",
    "<SFC>",
    "</SFC>",
    "<body>",
    "<ST>",
    "localId=\"1\"",
    "refLocalId=\"3\"",
    "<step name=\"x\"/>",
    "<jumpStep targetName=\"Init\"/>",
    "(",
    ":=",
    "END_IF",
    "T#",
    "16#",
    "99999999999999999999",
    "-",
    ".",
    "\0",
    "1e999",
];

#[test]
fn a_changed_file_never_panics() {
    changed_for(FILES.map(bytes).to_vec(), WORDS, (300, 8), |file| {
        let (document, _) = import(file);
        let _ = g7_compile::compile(&document);
    });
}
