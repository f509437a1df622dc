//! The grid, the sections and the declarations.

use g7_model::ProfileName;

use crate::support::{Bench, errors, lines, own, read, text_of};

fn document(name: &str) -> g7_model::Document {
    let bytes = own("controlexpert", name);
    let (document, problems) = read("controlexpert", &bytes);
    assert!(errors(&problems).is_empty(), "{:?}", lines(&bytes, &problems));
    document
}

#[test]
fn what_touches_on_the_grid_is_joined() {
    let document = document("mixer.xef");
    assert_eq!(document.profile().map(|p| p.name), Some(ProfileName::Unity));
    let text = text_of(&document);
    for line in [
        "scan 10ms",
        "input Go : BOOL at %I0.1.3 \"start button\"",
        "output Valve_in : BOOL at %Q0.2.0",
        "var Batches : INT := -1",
        "var Pause : TON",
        "chart Mixer \"fill and heat at once\" {",
        "  initial step Start \"waits\"",
        "  step Fill { N Valve_in }",
        "  step Heat { DS 100ms Heater }",
        "    R Heater",
        "    N Draining",
        "  Start -> (Fill, Heat) when Go",
        "  (Fill, Heat) -> Drain when Both",
        "  Drain -> Start when `Tank.Empty`",
        "  Drain -> Fill when not Go",
        "    Valve_out := TRUE",
        "    Pause(IN := not `Tank.Empty`, PT := 50ms, Q => Alarm)",
        "  transition section Both := Ready_both and Fill.t >= 30ms",
        "  IF ↑Drain.X THEN",
        "  step Heat at (13, 12)",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    // Members of the structure that nothing here writes come from outside.
    assert!(text.contains("input `Tank.Full` : BOOL"), "{text}");
}

#[test]
fn branches_of_transitions_stand_from_left_to_right() {
    // In the file the right one stands first; with both true, the left one is gone.
    let mut mixer = Bench::new(&document("mixer.xef"));
    mixer.set("Tank.Full", 1).set("Tank.Warm", 1).scan().set("Go", 1).scan();
    assert_eq!(mixer.active(), ["Fill", "Heat"]);
    mixer.run(20);
    assert_eq!(mixer.active(), ["Fill", "Heat"]);
    mixer.run(20);
    assert_eq!(mixer.active(), ["Drain"]);
    mixer.set("Tank.Empty", 1).set("Go", 0).scan();
    assert_eq!(mixer.active(), ["Start"]);
}

#[test]
fn sections_run_before_and_behind_the_chart() {
    let mut mixer = Bench::new(&document("mixer.xef"));
    mixer.set("Tank.Full", 1).set("Tank.Warm", 1).set("Go", 1).scan();
    assert_eq!(mixer.get("Ready_both"), 1);
    assert_eq!((mixer.get("Valve_in"), mixer.get("Batches")), (1, -1));
    mixer.run(50);
    // One rising edge of the step: one more batch. The action holds the valve open.
    assert_eq!((mixer.get("Lamp"), mixer.get("Batches"), mixer.get("Valve_out")), (1, 0, 1));
    mixer.run(100);
    assert_eq!((mixer.get("Alarm"), mixer.get("Batches")), (1, 0));
}

#[test]
fn links_and_macro_steps_come_over() {
    let text = text_of(&document("cell.xsf"));
    for line in [
        "  macro Work = Work",
        "macrochart Work {",
        "  entry step In { P1 Started }",
        "  exit step Out",
        "  Wait -> Work when `Part.here`",
        "  Work -> Wait when TRUE",
        "  In -> Out when `Part.Done`",
        "output Started : BOOL",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

#[test]
fn what_has_no_counterpart_is_told_with_its_line() {
    let bytes = own("controlexpert", "wrong.xsf");
    let (_, problems) = read("controlexpert", &bytes);
    let told = lines(&bytes, &problems);
    for expected in [
        "G0612 9: the qualifier `Q9` is not known",
        "G0612 10: the qualifier `L` without its time",
        "G0606 11: an action that is no variable",
        "G0604 12: the delay time of step `A` has no counterpart",
        "G0609 14: a line from a step to a step without a transition between",
        "G0613 15: the macro-step `M` without its inside",
        "G0606 16: a transition without a condition",
        "G0609 17: a jump to `Nowhere`, a step that is not there",
        "G0610 18: a jump with nothing above it",
        "G0610 19: a link from or to a cell where nothing stands",
        "G0603 20: the element `spiral` is not known",
        "G0604 23: a section in a drawn language (`FBDSource`) is left out",
        "G0604 24: the transition section `Laddered` is drawn, and not carried over",
    ] {
        assert!(told.iter().any(|t| t == expected), "{expected}\n{told:#?}");
    }
}

/// Two steps, of which the second enters the joint of the first by a link to its second column.
const JOINED: &str = r#"<networkSFC>
<step stepType="initialStep" stepName="A"><objPosition posX="0" posY="0"/></step>
<transition><objPosition posX="0" posY="1"/><transitionCondition invertLogic="false"><variableName>a</variableName></transitionCondition></transition>
<altJoint width="2" relativePos="0"><objPosition posX="0" posY="1"/></altJoint>
<step stepType="step" stepName="B"><objPosition posX="0" posY="2"/></step>
<step stepType="step" stepName="C"><objPosition posX="5" posY="0"/></step>
<transition><objPosition posX="5" posY="1"/><transitionCondition invertLogic="false"><variableName>c</variableName></transitionCondition></transition>
<linkSFC>
<directedLinkSource objectType="transition"><objPosition posX="5" posY="1"/></directedLinkSource>
<directedLinkDestination objectType="altJoint"><objPosition posX="1" posY="1"/></directedLinkDestination>
</linkSFC>
</networkSFC>"#;

#[test]
fn a_link_ends_at_any_column_of_a_joint() {
    let text = text_of(&read("controlexpert", JOINED.as_bytes()).0);
    for line in ["  A -> B when a", "  C -> B when c"] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

#[test]
fn a_part_of_a_file_is_read_as_the_whole() {
    let whole = format!(
        "<SFCExchangeFile><SFCProgram><identProgram name=\"Chart\"/><chartSource>{JOINED}</chartSource></SFCProgram></SFCExchangeFile>"
    );
    let wanted = text_of(&read("controlexpert", whole.as_bytes()).0);
    assert!(wanted.contains("chart Chart {"), "{wanted}");
    for part in [
        JOINED.to_string(),
        format!("<SFCContent><chartSource>{JOINED}</chartSource></SFCContent>"),
        format!("<SFCContent>{JOINED}</SFCContent>"),
        format!("<SFCExchangeFile><chartSource>{JOINED}</chartSource></SFCExchangeFile>"),
        format!("<SFCExchangeFile><SFCSource>{JOINED}</SFCSource></SFCExchangeFile>"),
    ] {
        assert_eq!(text_of(&read("controlexpert", part.as_bytes()).0), wanted, "{part}");
    }
}
