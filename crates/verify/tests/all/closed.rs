//! Charts with their plant: the answers follow from the rules of a tick (the book, "Plants").

use g7_rig::Source;
use g7_verify::{Budget, Claim, Evidence, Explicit, Layer, Verdict, ask_with, replay, words};

/// A scan each 250 ms; while V is on, 2 are added in each tick, while W is on 2 are taken away.
const TANK: &str = "\
scan 250ms
input low, high : BOOL
output V, W : BOOL
chart Fill {
  initial step 0 { N V }
  step 1 { N W }
  0 -> 1 when high -> 0 when low
}
plant Tank {
  state level : REAL := 0.0 in 0.0 .. 100.0
  rate level := 8.0 when V
  rate level := -8.0 when W
  drive high := level >= 90.0
  drive low := level < 2.0
}
";

/// A lamp that is on while the plant shows red.
const SHOW: &str = "\
input red : BOOL
output lamp : BOOL
chart Show {
  initial step 0
  step 1 { N lamp }
  0 -> 1 when red -> 0 when not red
}
";

/// A letter for each answer to a property, with the number of scans of its run; the reason of what is not decided.
fn answers(text: &str, every: bool) -> Vec<(Claim, String)> {
    let source = Source::new("chart.g7", text.as_bytes().to_vec(), 0);
    let plant =
        ["Tank", "Line"].into_iter().find(|name| text.contains(&format!("plant {name} "))).expect("a plant");
    let (closed, problems) = ask_with(&source, None, plant, every).expect("it is there");
    let closed = closed.unwrap_or_else(|| panic!("{problems:?}"));
    let model = closed.model();
    let mut answers = vec![None; closed.questions.len()];
    let budget = Budget { states: 100_000, scans: usize::MAX, bytes: 256 << 20, stop: &|| false };
    Explicit.answer(&model, &closed.questions, &mut answers, &budget);
    let letter = |(question, answer): (&g7_verify::Question, Option<Verdict>)| {
        let letter = match answer.expect("each question has an answer") {
            Verdict::Proved(Evidence::Run(run)) => format!("P{}", run.moves.len()),
            Verdict::Refuted(Evidence::Run(run)) => {
                assert!(replay(&model, &question.claim, &run));
                format!("R{}", run.moves.len())
            }
            Verdict::Proved(_) => "P".to_owned(),
            Verdict::Refuted(_) => "R".to_owned(),
            Verdict::Open(open) => words::why(&open.reason)[0].clone(),
        };
        (question.claim.clone(), letter)
    };
    closed.questions.iter().zip(answers).map(letter).collect()
}

fn author(text: &str) -> Vec<String> {
    answers(text, false).into_iter().map(|(_, letter)| letter).collect()
}

#[test]
fn what_the_plant_does_is_known_to_the_scan() {
    // The first tick moves nothing, so that tick 46 is the first with 90. It closes the valve in its scan.
    let asked = "\
prove always level <= 90.0 with Tank
prove never level >= 90.0 with Tank
prove reachable level >= 92.0 with Tank
prove never X1 and level < 2.0 with Tank
prove reachable X1 and level = 88.0 with Tank
prove X1 leads to X0 with Tank
prove after X1 within 11s expect X0 with Tank
prove after X1 within 12s expect X0 with Tank
";
    // X1 comes in scan 46; 45 ticks later the level is 0: 11.25 s.
    assert_eq!(author(&format!("{TANK}{asked}")), ["P", "R46", "R", "P", "P47", "P", "R91", "P"]);
}

#[test]
fn without_the_plant_all_is_possible() {
    let (document, _) = g7_syntax::parse(&format!("{TANK}prove never X1\n"), g7_model::FileId(0));
    let (asked, _) = g7_verify::ask(&document, None);
    let asked = asked.expect("no errors");
    let model = g7_verify::Model::new(&asked.compiled, asked.assume.clone());
    let mut answers = vec![None; asked.questions.len()];
    let budget = Budget { states: 1_000, scans: usize::MAX, bytes: 1 << 20, stop: &|| false };
    Explicit.answer(&model, &asked.questions, &mut answers, &budget);
    let last = answers.pop().flatten().expect("it has an answer");
    assert!(matches!(last, Verdict::Refuted(Evidence::Run(run)) if run.moves.len() == 1));
}

#[test]
fn the_questions_of_every_chart_are_asked_with_the_plant_too() {
    let never = TANK.replace("drive high := level >= 90.0", "drive high := level > 100.0");
    let found = answers(&never, true);
    let of = |is: &dyn Fn(&Claim) -> bool| found.iter().find(|(c, _)| is(c)).map(|(_, l)| l.as_str());
    // The tank is full, and the chart waits for ever: from then on no run changes the situation.
    assert_eq!(of(&|c| *c == Claim::NoDeadlock), Some("R1"), "it never leaves its first situation");
    assert_eq!(of(&|c| matches!(c, Claim::Clears(0))), Some("R"));
    let found = answers(TANK, true);
    assert!(found.iter().all(|(_, letter)| letter.starts_with('P')), "{found:?}");
}

#[test]
fn inputs_that_no_plant_drives_are_free() {
    let text =
        TANK.replace("input low, high", "input low, high, go").replace("when high", "when high and go");
    let asked = "prove X0 leads to X1 with Tank\nprove after high within 1s expect X1 with Tank\n";
    // Whoever turns `go` may wait, but can always turn it. `high` is true from scan 46 on. The scans
    // after it come each 250 ms, so the fifth one is the first that is more than a second later.
    assert_eq!(author(&format!("{text}{asked}")), ["P", "R51"]);
    let assumed = "assume go = high\nprove after high within 1s expect X1 with Tank\n";
    assert_eq!(author(&format!("{text}{assumed}")), ["P"]);
}

#[test]
fn an_assumption_against_the_plant_is_told() {
    let found = author(&format!("{TANK}assume not high\nprove never level >= 90.0 with Tank\n"));
    assert_eq!(found, ["no input satisfies the assumptions behind a run of 45 scans"]);
}

#[test]
fn chance_is_taken_in_several_ways_and_proves_nothing() {
    let text = SHOW.to_owned()
        + "\
plant Line {
  state colour : LREAL
  each { colour := random() }
  drive red := colour > 0.8
}
prove never lamp with Line
prove always colour < 1.0 with Line
";
    let found = author(&text);
    assert_eq!(found[0], "R1");
    assert!(found[1].contains("chance"), "{found:?}");
}

#[test]
fn chance_that_is_never_asked_hides_nothing() {
    let text = SHOW.to_owned()
        + "\
plant Line {
  state mixed : BOOL
  state count : INT in 0 .. 5
  state colour : LREAL
  each {
    count := count + 1
    IF mixed and count > 3 THEN colour := random(); END_IF
  }
  drive red := colour > 0.8
}
prove never lamp with Line
";
    assert_eq!(author(&text), ["P"]);
    // Drawn late, it is drawn in each way all the same.
    assert_eq!(author(&text.replace("mixed : BOOL", "mixed : BOOL := TRUE")), ["R4"]);
}

#[test]
fn a_fault_of_the_plant_hides_what_comes_behind_it() {
    let text = TANK.replace(
        "  drive low",
        "  each { IF level > 80.0 THEN level := level / (level - level) END_IF }\n  drive low",
    );
    let found = author(&format!("{text}prove never X1 with Tank\n"));
    assert!(found[0].starts_with("the plant has a fault"), "{found:?}");
}

#[test]
fn wrong_properties_are_problems_at_their_place() {
    let problems = |asked: &str| {
        let source = Source::new("chart.g7", format!("{TANK}{asked}\n").into_bytes(), 0);
        let found = g7_rig::testing::problems(&source, None).expect("a plant");
        found.iter().map(|p| format!("{} {}", p.code.id, source.place(p.at))).collect::<Vec<_>>()
    };
    assert_eq!(problems("prove never level > 1.0 with Tonk"), ["G0550 chart.g7:16:30"]);
    assert_eq!(problems("prove never level > 1.0 or X1 with Tank"), ["G0551 chart.g7:16:13"]);
    assert_eq!(problems("prove never level with Tank"), ["G0552 chart.g7:16:13"]);
    assert_eq!(problems("prove never depth > 1.0 with Tank").len(), 1);
    assert_eq!(problems("prove never level > 1.0 with Tank"), [""; 0]);
}
