//! The form of a written file, and what it cannot say: each is a problem with its place.

use crate::controlexpert::written::parse;
use crate::support::{self, lines};

/// The problems of writing a text.
fn said(text: &str) -> Vec<String> {
    lines(text.as_bytes(), &support::export("controlexpert", &parse(text)).problems)
}

#[test]
fn a_file_has_the_form_of_the_tool_s_own() {
    let text = "profile unity
        input go, stop : BOOL at %I0.1.0
        input lid : BOOL
        output motor : BOOL at %Q0.2.0
        var n : INT := -3  var t1 : TON  var s : STRING(20)
        chart Fill {
          initial step 1 \"rest\" { R motor }
          step Run { DS 1s500ms motor  P1 n := n + 1  N { t1(IN := lid, PT := 2s); IF ↓lid AND Run.T >= 3s THEN n := 0; END_IF } }
          1 -> Run when ↑go and not lid
          Run -> 1 when not stop \"why\"
          Run -> 1 when 3s/XRun
        }";
    let file = support::export("controlexpert", &parse(text));
    assert_eq!(
        lines(text.as_bytes(), &file.problems),
        [
            "G0614 3: `lid` has no address such as %I0.1.0: it is a plain variable there",
            "G0611 7: `1` is called `S1` there",
        ]
    );
    let squeezed: String = file.text.split_whitespace().collect::<Vec<_>>().join(" ").replace("> <", "><");
    for part in [
        r#"<SFCExchangeFile><fileHeader company="G7" product="Control Expert" content="SFC source file" DTDVersion="41"/><contentHeader name="Fill" version="0.0.000"/>"#,
        r#"<SFCProgram areaNum="0" operatorCtrl="0"><identProgram name="Fill" type="section" task="MAST"/><chartSource name="Chart"><networkSFC>"#,
        r#"<step stepType="initialStep" stepName="S1"><objPosition posX="0" posY="0"/><action qualifier="R"><actionName><variableName>motor</variableName></actionName><tValue><tLiteral/></tValue></action><literals max="" min="" delay=""/><comment>rest</comment></step>"#,
        r#"<action qualifier="DS"><actionName><variableName>motor</variableName></actionName><tValue><tLiteral>T#1s500ms</tLiteral></tValue></action>"#,
        r#"<action qualifier="P1"><actionName><sectionName>Run_2</sectionName></actionName>"#,
        r#"<altBranch width="2" relativePos="0"><objPosition posX="0" posY="3"/></altBranch>"#,
        r#"<transitionCondition invertLogic="false"><sectionName>T1_2</sectionName></transitionCondition>"#,
        r#"<transitionCondition invertLogic="true"><variableName>stop</variableName></transitionCondition><comment>why</comment></transition>"#,
        r#"<jumpSFC stepName="S1"><objPosition posX="1" posY="4"/></jumpSFC>"#,
        r#"<actionSource name="Run_2"><STSource>n := n + 1;</STSource></actionSource>"#,
        r#"t1(IN := lid, PT := T#2s); IF FE(lid) AND Run.t &gt;= T#3s THEN n := 0; END_IF;"#,
        r#"<STSource>RE(go) AND NOT lid</STSource>"#,
        r#"<STSource>Run.x AND Run.t &gt;= T#3s</STSource>"#,
        r#"<variables name="go" typeName="EBOOL" topologicalAddress="%I0.1.0"/>"#,
        r#"<variables name="lid" typeName="EBOOL"/>"#,
        r#"<variables name="n" typeName="INT"><variableInit value="-3"/></variables>"#,
        r#"<variables name="s" typeName="STRING[20]"/>"#,
    ] {
        assert!(squeezed.contains(part), "{part}\n{squeezed}");
    }
}

#[test]
fn what_cannot_be_said_is_a_problem_with_its_place() {
    let none = |line: u32, what: &str| format!("G0604 {line}: {what}: Control Expert has none");
    let drop =
        |line: u32, what: &str| format!("G0605 {line}: {what}: Control Expert has none; it is left out");
    assert_eq!(
        said(
            "profile unity
             scan 20ms
             target tsx57
             input a : BOOL
             var k : INT  var l : LREAL  var r : BOOL retain  const c : INT := 2 + 1
             function f(x : INT) : INT { f := x }
             pre { k := 1 }
             chart G every 40ms {
               initial step 1 { N k := 1 if r  N r if a  SD 1s r  on ↑a: k := 2 }
               step 2 { force H := {}  D 1500us r  P1 { IF a THEN SETSTEP(X1) END_IF } }
               t7: 1 -> 2 when 2s/a on clearing { k := 0 }
               2 -> () when a
               () -> 2 when a
               post { k := 0 }
             }
             chart H { enclosing step 5 { enclose I } initial step 6 6 -> 5 when a }
             chart I { step 7 * }
             test \"t\" { scan }"
        ),
        [
            "G0605 2: the time of a scan is left out: it belongs to the task MAST there".to_string(),
            drop(3, "a target"),
            "G0614 4: `a` has no address such as %I0.1.0: it is a plain variable there".to_string(),
            none(5, "a variable of the type LREAL"),
            drop(5, "the word `retain`"),
            "G0614 5: the constant `c` is a variable there".to_string(),
            none(5, "an initial value that is worked out"),
            none(6, "a function"),
            "G0604 7: a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text".to_string(),
            none(8, "a period of such a chart"),
            "G0611 9: `1` is called `S1` there; 4 more names are changed as well".to_string(),
            none(12, "a transition without a step behind it"),
            none(13, "a transition without a step before it"),
            "G0604 14: a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text".to_string(),
            "G0604 16: a second chart `H`: the file holds one section".to_string(),
            "G0604 17: a second chart `I`: the file holds one section".to_string(),
            drop(18, "a test"),
        ]
    );
    // A chart that has no drawing is not looked at further; this one has.
    assert_eq!(
        said(
            "profile unity
             input a : BOOL at %I0.1.0
             var k : INT  var r : BOOL
             chart G {
               initial step 1 { N k := 1 if r  N r if a  SD 1s r  on ↑a: k := 2 }
               step 2 { force G := {}  D 1500us r  P1 { IF a THEN SETSTEP(X1) END_IF }  P0 k := 0 if a }
               t7: 1 -> 2 when 2s/a on clearing { k := 0 }
               2 -> 1 when ↑(a or r)
               2 -> 1 when LEN('x') = 1
               2 -> 1 when ↑r
             }"
        ),
        [
            "G0611 5: `1` is called `S1` there; 1 more names are changed as well".to_string(),
            none(5, "such a condition of an action"),
            none(5, "a condition of an action"),
            none(5, "the qualifier `SD`"),
            none(5, "an action on event"),
            none(6, "a forcing order"),
            none(6, "a TIME of parts of a millisecond, or above 49 days"),
            none(6, "a call of `SETSTEP` in an action"),
            none(6, "such a condition of an action"),
            "G0605 7: the label of a transition: Control Expert has none; it is left out".to_string(),
            none(7, "a delay of something other than the activity of a step"),
            none(7, "an action on clearing"),
            none(8, "an edge of something other than a variable"),
            none(9, "the function `LEN`"),
            "G0614 10: an edge of `r`, which is no input: it lasts there until the variable is written again"
                .to_string(),
        ]
    );
}

#[test]
fn joints_and_branches_that_the_grid_cannot_have_are_refused() {
    let joint = "on the grid the joint stands directly below its steps";
    let branch = "on the grid the branch stands directly above its steps";
    assert_eq!(
        said(
            "profile unity
             input go : BOOL at %I0.1.0
             chart G { initial step A step B step C step D
               A -> (B, C) when go
               (B, C) -> D when go
               C -> A when go
               D -> (C, A) when go }"
        ),
        [
            format!("G0604 5: a transition behind several steps, where `C` has another one besides: {joint}"),
            format!(
                "G0604 7: a transition before several steps, where `C` begins other branches too: {branch}"
            ),
        ]
    );
}

/// A chart under a profile, with these transitions behind its first step, and these actions in the second.
fn under(profile: &str, transitions: &str, actions: &str) -> Vec<String> {
    let text = format!(
        "{profile} input a, b : BOOL at %I0.1.0 var n : INT
         chart G {{ initial step 1 step 2 {{ {actions} }} step 3 {transitions} 2 -> 1 when b 3 -> 1 when a }}"
    );
    said(&text).into_iter().filter(|t| t.starts_with("G0604")).collect()
}

#[test]
fn other_rules_of_evolution_are_refused_where_they_matter() {
    let fork = "1 -> 2 when a 1 -> 3 when b";
    let apart = "1 -> 2 when a and b 1 -> 3 when not a";
    let one = "1 -> 2 when a";
    let rule = |word: &str| {
        vec![format!(
            "G0604 1: the rule `{word}`, which this chart depends on; Control Expert has those of `unity`"
        )]
    };
    let fine: Vec<String> = Vec::new();
    assert_eq!(under("profile unity", fork, "N n := n + 1"), fine);
    for other in ["iec60848", "pl7", "jgrafchart"] {
        let what =
            format!("G0604 1: the rules of evolution of `{other}`; Control Expert has those of `unity`");
        assert_eq!(under(&format!("profile {other}"), one, ""), [what]);
    }
    assert_eq!(under("profile unity { multi-token }", fork, ""), rule("multi-token"));
    assert_eq!(under("profile unity { multi-token }", apart, ""), fine);
    assert_eq!(under("profile unity { stable }", one, ""), rule("stable"));
    assert_eq!(under("profile unity { sequential }", one, ""), rule("sequential"));
    assert_eq!(under("profile unity { parallel-actions }", one, "P1 n := 1"), rule("parallel-actions"));
    assert_eq!(under("profile unity { parallel-actions }", one, ""), fine);
    assert_eq!(under("profile iec61131", one, "N n := n + 1"), rule("final-scan"));
    assert_eq!(under("profile iec61131", fork, "P1 n := n + 1"), fine);
    assert_eq!(under("profile iec61131 { no-final-scan }", one, "N n := n + 1"), fine);
    assert_eq!(under("profile iec61131", one, "P0 n := 1 P1 n := n + 1"), rule("text-order"));
    assert_eq!(under("profile iec61131", one, "P1 n := 1 P0 n := n + 1"), fine);
    assert_eq!(under("profile unity { zero-step-time }", one, "N n := n + 1"), fine);
    assert_eq!(under("profile unity { zero-step-time }", "1 -> 2 when 1.t > 1s", ""), rule("zero-step-time"));
}

#[test]
fn several_initial_steps_need_branches_that_exclude_each_other() {
    let text = |second: &str| {
        format!(
            "profile unity input a, b : BOOL at %I0.1.0
             chart G {{ initial step A initial step B step C A -> C when a
               A -> B when {second}
               (B, C) -> A when b }}"
        )
    };
    let begins = "a second initial step: Control Expert takes it with the option for several tokens alone";
    let told = said(&text("not a"));
    assert!(
        told.iter().any(|t| t.starts_with(&format!("G0614 2: {begins}, which changes nothing"))),
        "{told:?}"
    );
    let told = said(&text("b"));
    assert!(told.iter().any(|t| t.starts_with(&format!("G0604 2: {begins}, under which"))), "{told:?}");
}
