//! Pages of steps and transitions, evolving as ClassicLadder has it.

use g7_model::{ProfileName, Switch};

use crate::support::{Bench, errors, lines, own, read, text_of};

fn bench(name: &str) -> Bench {
    let bytes = own("classicladder", name);
    let (document, problems) = read("classicladder", &bytes);
    assert!(errors(&problems).is_empty(), "{:?}", lines(&bytes, &problems));
    Bench::new(&document)
}

#[test]
fn a_page_is_a_chart_with_its_steps_by_number() {
    let bytes = own("classicladder", "press.clprj");
    let (document, problems) = read("classicladder", &bytes);
    assert_eq!(lines(&bytes, &problems), Vec::<String>::new());
    let chart = document.charts().next().expect("a chart");
    assert_eq!((&*chart.name.text, chart.comment.as_deref()), ("Press", Some("the press / rest above")));
    let steps: Vec<(&str, bool, Option<&str>)> =
        chart.steps().map(|s| (&*s.name.text, s.initial, s.comment.as_deref())).collect();
    assert_eq!(steps, [("0", true, None), ("1", false, Some("stroke")), ("2", false, None)]);
    let profile = document.profile().expect("a profile");
    assert_eq!(profile.name, ProfileName::Iec60848);
    // One after the other, a step is left once, 50 rounds at most, times of steps begin at 0.
    for switch in
        [Switch::MultiToken(false), Switch::Sequential(true), Switch::KeepStepTime(false), Switch::Bound(50)]
    {
        assert!(profile.switches.iter().any(|(s, _)| *s == switch), "{switch:?}");
    }
    assert_eq!(document.cycle(), Some(g7_model::Nanos::from_millis(20)));
    let text = text_of(&document);
    for line in [
        "input start : BOOL at %I0 \"button\"",
        "input low : BOOL at %I2 \"end of the stroke\"",
        "output down : BOOL at %Q0",
        "var B0 : BOOL at %B0",
        "  0 -> 1 when B0",
        "  1 -> 2 when low",
        "  step 1 at (7, 18)",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

#[test]
fn rounds_go_on_until_nothing_changes() {
    let mut press = bench("press.clprj");
    press.scan();
    assert_eq!(press.active(), ["0"]);
    press.set("start", 1).scan();
    assert_eq!(press.active(), ["1"]);
    assert_eq!(press.get("down"), 1);
    press.set("start", 0).set("low", 1).scan();
    assert_eq!(press.active(), ["2"]);
    assert_eq!(press.get("down"), 0);
    // From 2 to 0 in the first round, and on to 1 in the second: %B0 holds itself.
    press.set("low", 0).set("high", 1).scan();
    assert_eq!(press.active(), ["1"]);
    press.set("high", 0).set("stop", 1).set("low", 1).scan().set("low", 0).set("high", 1).scan();
    assert_eq!(press.active(), ["0"]);
}

#[test]
fn of_two_ways_the_lower_number_is_gone() {
    // Both %I0 and %I1: transition 0 clears, step 10 is off for transition 1.
    let mut choices = bench("choices.csv");
    choices.set("I0", 1).set("I1", 1).scan();
    assert_eq!(choices.active(), ["11"]);
}

#[test]
fn a_round_sees_what_it_has_cleared_itself() {
    // 10 to 12 and 13, 13 to 14, 12 and 14 to 15: each behind the other in one round.
    let mut choices = bench("choices.csv");
    choices.set("I1", 1).set("I2", 1).scan();
    assert_eq!(choices.active(), ["15"]);
    let mut choices = bench("choices.csv");
    choices.set("I1", 1).scan();
    assert_eq!(choices.active(), ["12", "13"]);
}

#[test]
fn what_has_no_counterpart_is_told_with_its_line() {
    let bytes = own("classicladder", "wrong.clprj");
    let (_, problems) = read("classicladder", &bytes);
    let told = lines(&bytes, &problems);
    for expected in [
        "G0605 5: `ioconf.csv`, which hardware the inputs and outputs are wired to, is left out",
        "G0604 9: writing %X1.V has no counterpart",
        "G0606 10: an operation without `:=`",
        "G0608 11: the function `SHL` with 2 values has no counterpart",
        "G0614 12: `=>` is read as `=`, as ClassicLadder reads it",
        "G0614 21: the system variable %S4 becomes an input",
        "G0604 21: writing %I1 has no counterpart",
        "G0604 22: an element of this kind on a variable by index, from %B1 on",
        "G0604 23: the variable %R0.E has no counterpart",
        "G0604 23: a register (FIFO or LIFO) has no counterpart",
        "G0604 23: an element of kind 77 of a rung is not known",
        "G0605 28: there is no step 77; its activity is FALSE and its time 0",
        "G0612 28: an element of a rung that cannot be read",
        "G0614 39: the section `Middle` stands between two pages; it runs behind the last",
        "G0605 41: nothing calls the sub-routine `Lost`; it is left out",
        "G0611 46: a second step 0; it is called `0_1`, and its activity is not %X0",
        "G0605 48: no section runs page 7; its chart is left out",
        "G0609 50: transition 1 leads from or to a step that its page does not have",
        "G0614 51: transition 2 has no condition; ClassicLadder reads %B0",
    ] {
        assert!(told.iter().any(|t| t == expected), "{expected}\n{told:#?}");
    }
}
