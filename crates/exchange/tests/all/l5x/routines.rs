//! Charts, tags and text.

use g7_model::{ProfileName, Switch};

use crate::support::{Bench, errors, lines, own, read, text_of};

fn document() -> g7_model::Document {
    let bytes = own("l5x", "filler.L5X");
    let (document, problems) = read("l5x", &bytes);
    assert!(errors(&problems).is_empty(), "{:?}", lines(&bytes, &problems));
    document
}

#[test]
fn a_routine_is_a_chart_with_the_tags_that_it_names() {
    let document = document();
    let profile = document.profile().expect("a profile");
    assert_eq!(profile.name, ProfileName::Iec61131);
    assert!(profile.switches.iter().any(|(s, _)| *s == Switch::FinalScan(false)));
    let text = text_of(&document);
    for line in [
        "scan 10ms",
        "input Start : BOOL at 'Local:1:I.Data.0' \"start button\"",
        "output Pump : BOOL at 'Local:2:O.Data.4'",
        "input `Now.Hot` : BOOL",
        "input Level : REAL",
        "output `A_Late.Q` : BOOL",
        "var Count : DINT",
        "chart Fill \"fill and warm at once\" {",
        "  initial step S_Wait { N A_Stop }",
        "    D 100ms `A_Late.Q`",
        "    P1 A_Tally",
        "  step S_Empty { S `A_Ready.Q` }",
        // `Go` is another name of `Start`.
        "  T_Start: S_Wait -> (S_Pour, S_Warm) when Start and Level < 1.5",
        "  T_Both: (S_Pour, S_Warm) -> S_Empty when S_Warm.t >= 200ms and TIME_TO_DINT(S_Pour.t) >= 100",
        "  T_Stop: S_Empty -> End when `Now.Hot` or `A_Late.Q`",
        "  T_Again: S_Empty -> S_Wait when Start",
        "  action A_Stop { Pump := 0 }",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    assert!(!text.contains("Unused") && !text.contains("Batches"), "{text}");
}

#[test]
fn the_filler_goes_its_way() {
    let mut filler = Bench::new(&document());
    filler.scan().set("Start", 1).scan();
    assert_eq!(filler.active(), ["S_Pour", "S_Warm"]);
    assert_eq!((filler.get("Pump"), filler.get("Count")), (1, 1));
    filler.set("Start", 0).run(80);
    assert_eq!(filler.get("A_Late.Q"), 0);
    filler.run(40);
    assert_eq!((filler.get("A_Late.Q"), filler.get("Count")), (1, 1));
    assert_eq!(filler.active(), ["S_Pour", "S_Warm"]);
    filler.run(100);
    assert_eq!(filler.active(), ["S_Empty"]);
    // Both ways are open: the left one is gone, and the chart stops there.
    filler.set("Start", 1).set("Now.Hot", 1).scan();
    assert_eq!(filler.active(), ["End"]);
    filler.run(50);
    assert_eq!(filler.active(), ["End"]);
}

#[test]
fn what_has_no_counterpart_is_told_with_its_line() {
    let bytes = own("l5x", "wrong.L5X");
    let (document, problems) = read("l5x", &bytes);
    let told = lines(&bytes, &problems);
    let at = |words: &str| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        1 + text.lines().position(|l| l.contains(words)).expect("in the file")
    };
    for expected in [
        "G0614 4: the last scan of a step resets what its actions set (automatic reset); there is none here"
            .to_string(),
        format!("G0605 {}: the routine `Idle` (ST) is left out, with what it writes", at("\"Idle\"")),
        format!("G0612 {}: the qualifier `Sideways` is not known", at("Sideways")),
        format!("G0604 {}: `JSR(Gone)` has no counterpart", at("JSR(Gone")),
        format!("G0604 {}: `A.TMAX` of a step has no counterpart", at("A.TMax")),
        format!("G0604 {}: writing `B.PRE` of a step has no counterpart", at("B.PRE")),
        format!("G0606 {}: a transition without a condition", at("<Transition")),
        format!(
            "G0614 {}: priorities of the author's own in a branch; here the branches go from left to right",
            at("UserDefined")
        ),
        format!("G0604 {}: a subroutine's entry and return; the chart runs by itself here", at("SbrRet")),
        format!("G0603 {}: the element `Spiral` is not known", at("<Spiral")),
        format!("G0609 {}: a link from or to an object that is not there", at("ToID=\"99\"")),
        format!("G0609 {}: a line from a step to a step without a transition between", at("ToID=\"0\"")),
    ] {
        assert!(told.contains(&expected), "{expected}\n{told:#?}");
    }
    let stable =
        document.profile().is_some_and(|p| p.switches.iter().any(|(s, _)| *s == Switch::Stable(true)));
    assert!(stable, "UntilFalse: until no transition is true");
}

/// A part of a file is recognised by its first element and the chart in it, whichever part it is.
#[test]
fn parts_of_files_are_read() {
    let whole = String::from_utf8(own("l5x", "filler.L5X")).expect("text");
    // Of several elements with one name the first that has a chart.
    let part = |tag: &str| {
        let chart = whole.find("<SFCContent").expect("a chart");
        let before = whole.get(..chart).expect("the text before it");
        let from = before.rfind(&format!("<{tag} ")).or_else(|| before.rfind(&format!("<{tag}>")));
        let (from, end) = (from.expect("it begins"), format!("</{tag}>"));
        let to = whole.get(chart..).and_then(|rest| rest.find(&end)).expect("it ends") + chart + end.len();
        whole.get(from..to).expect("the part").to_owned()
    };
    let chart = |d: &g7_model::Document| {
        let chart = d.charts().next().expect("a chart");
        (chart.name.text.clone(), chart.steps().count(), chart.transitions().count())
    };
    for tag in ["Controller", "Programs", "Program", "Routines", "Routine"] {
        let text = part(tag);
        let format = g7_exchange::recognise("part.xml", text.as_bytes()).map(|f| f.word);
        assert_eq!(format, Some("l5x"), "{tag}");
        let (found, problems) = read("l5x", text.as_bytes());
        assert!(errors(&problems).is_empty() || tag.starts_with("Routine"), "{tag}: {problems:?}");
        assert_eq!(chart(&found), chart(&document()), "{tag}");
    }
    // The same words without a chart are somebody else's.
    assert!(g7_exchange::recognise("part.xml", b"<Program><x/></Program>").is_none());
}
