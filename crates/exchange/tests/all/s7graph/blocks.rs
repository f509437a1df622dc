//! Sequences, networks and actions.

use g7_model::{ProfileName, Switch};

use crate::support::{Bench, errors, lines, own, read, text_of};

fn document() -> g7_model::Document {
    let bytes = own("s7graph", "press.xml");
    let (document, problems) = read("s7graph", &bytes);
    assert!(errors(&problems).is_empty(), "{:?}", lines(&bytes, &problems));
    document
}

#[test]
fn a_sequence_is_a_chart_and_networks_are_expressions() {
    let document = document();
    let profile = document.profile().expect("a profile");
    assert_eq!(profile.name, ProfileName::Iec61131);
    assert!(profile.switches.iter().any(|(s, _)| *s == Switch::FinalScan(false)));
    let text = text_of(&document);
    for line in [
        "input pressed : BOOL \"the button\"",
        "output done : BOOL",
        "var count : INT := -1",
        // Of the sequencer's surroundings: written ones are outputs, the others inputs.
        "output Motor : BOOL",
        "input Jam : BOOL",
        "output Jams : DINT",
        "chart Press \"a press\" {",
        "  initial step `Wait here` \"about Wait here\" {",
        "    P1 count := count + 1",
        "    R Motor",
        "    N Valve if Closed",
        "    D 100ms Late",
        "    S Motor",
        "    on ↑Jam: Jams := Jams + 1",
        "    N done",
        "    P0 Left := TRUE",
        "  Start: `Wait here` -> (Down, Turn) when Go",
        "  Idle: `Wait here` -> Up when `Wait here`.t >= 200ms and count < 2",
        // The condition that the two steps watch holds the transition behind them back.
        "  Both: (Down, Turn) -> Up when Low and ↑Tick and not Jam and not Jam",
        "  Back: Up -> `Wait here` when TRUE",
        "pre { Go := pressed and not Guard }",
        "post { Turning := Turn.X }",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    // The left one of two branches is asked first, wherever it stands in the file.
    assert!(
        text.find("  Start:") < text.find("  Idle:") && text.find("  Idle:") < text.find("  Both:"),
        "{text}"
    );
    assert!(!text.contains("OFF_SQ") && !text.contains("RT_DATA"), "{text}");
}

#[test]
fn the_press_goes_its_way() {
    let mut press = Bench::new(&document());
    press.scan();
    assert_eq!((press.active(), press.get("count")), (vec!["Wait here".to_string()], 0));
    press.set("pressed", 1).scan();
    assert_eq!(press.active(), ["Down", "Turn"]);
    assert_eq!((press.get("Motor"), press.get("Turning"), press.get("Valve")), (1, 1, 0));
    press.set("Closed", 1).scan();
    assert_eq!(press.get("Valve"), 1);
    // A jam is counted once, and nothing goes on while it lasts.
    press.set("Jam", 1).set("Low", 1).set("Tick", 1).scan().set("Tick", 0).scan().set("Tick", 1).scan();
    assert_eq!((press.active().len(), press.get("Jams")), (2, 1));
    press.set("Jam", 0).set("Tick", 0).scan().set("Tick", 1).scan();
    assert_eq!(press.active(), ["Up"]);
    assert_eq!((press.get("done"), press.get("Left")), (1, 0));
    press.set("pressed", 0).scan();
    assert_eq!(press.active(), ["Wait here"]);
    assert_eq!((press.get("count"), press.get("Left"), press.get("Motor")), (1, 1, 0));
}

#[test]
fn what_has_no_counterpart_is_told_with_its_line() {
    let bytes = own("s7graph", "wrong.xml");
    let (_, problems) = read("s7graph", &bytes);
    let told = lines(&bytes, &problems);
    for expected in [
        "G0605 7: `strange` is of the type `\"Recipe\"`, which is not known",
        "G0604 12: a network in STL or SCL is not carried over",
        "G0604 13: `Blinker` in a network has no counterpart",
        "G0604 18: the qualifier `CU` of an action has no counterpart",
        "G0604 19: the event `A1` has no counterpart",
        "G0614 21: `N` with an event: the variable stays TRUE here, one scan only in GRAPH",
        "G0612 20: the qualifier `D` without its time",
        "G0605 21: an action that waits for the supervision or interlock of a step that has none",
        "G0604 22: an action with an event and a time has no counterpart",
        "G0606 23: an action that is no variable and no assignment",
        "G0615 25: a second step of this number",
        "G0611 25: a second step `A`; it is called `A_2`",
        "G0609 31: a line from a step to a step without a transition between",
        "G0609 32: a connection from or to something that is not there",
        "G0610 33: a connection without its ends",
        "G0610 28: a transition without any step",
        "G0605 38: a network of a block in another language is left out",
    ] {
        assert!(told.iter().any(|t| t == expected), "{expected}\n{told:#?}");
    }
}
