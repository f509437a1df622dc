//! Small charts whose answers follow from the rules, one for each question.

use g7_engine::StepId;
use g7_model::{FileId, ProfileName};
use g7_syntax::parse;
use g7_tests::generate::sample;
use g7_verify::{
    Asked, Budget, Claim, Compare, Difference, Equality, Evidence, Explicit, Layer, Model, Reason,
    Satisfiability, Verdict, ask, compare, replay,
};

fn budget() -> Budget<'static> {
    Budget { states: 200_000, scans: usize::MAX, bytes: 256 << 20, stop: &|| false }
}

fn asked(text: &str) -> Asked {
    let (document, problems) = parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (asked, problems) = ask(&document, None);
    asked.unwrap_or_else(|| panic!("{problems:?}"))
}

/// A letter for each verdict: Proved, Refuted, Open; for a run the number of its scans.
fn letter(v: &Verdict) -> String {
    match v {
        Verdict::Proved(Evidence::Run(r)) => format!("P{}", r.moves.len()),
        Verdict::Refuted(Evidence::Run(r)) => format!("R{}", r.moves.len()),
        Verdict::Proved(_) => "P".to_owned(),
        Verdict::Refuted(_) => "R".to_owned(),
        Verdict::Open(_) => "O".to_owned(),
    }
}

/// The answers of a layer by itself.
fn of_layer(asked: &Asked, model: &Model<'_>, layer: &dyn Layer) -> Vec<(Claim, Verdict)> {
    let mut answers = vec![None; asked.questions.len()];
    layer.answer(model, &asked.questions, &mut answers, &budget());
    let claims = asked.questions.iter().map(|q| q.claim.clone());
    claims.zip(answers.into_iter().map(|a| a.expect("each question has an answer"))).collect()
}

/// True if the solver's run for a claim need not be a shortest one.
fn has_long_runs(claim: &Claim) -> bool {
    matches!(claim, Claim::Asked(_) | Claim::NoDeadlock | Claim::LeadsTo { .. })
}

/// The answers of the search, with which those of the solver agree.
fn answers(text: &str) -> Vec<(Claim, Verdict)> {
    let asked = asked(text);
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let all = of_layer(&asked, &model, &Explicit);
    let solved = of_layer(&asked, &model, &Satisfiability { turns: 12 });
    for ((claim, a), (_, b)) in all.iter().zip(&solved) {
        let agree = [a, b].iter().any(|v| letter(v) == "O")
            || letter(a) == letter(b)
            // These runs need not be the shortest ones.
            || has_long_runs(claim) && letter(a)[..1] == letter(b)[..1];
        assert!(agree, "{claim:?}: {a:?} or {b:?}\n{text}");
    }
    for (claim, verdict) in all.iter().chain(&solved) {
        if let Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) = verdict {
            assert!(replay(&model, claim, run), "{claim:?}");
        }
    }
    all
}

fn answer(text: &str, is: impl Fn(&Claim) -> bool) -> String {
    let all = answers(text);
    all.iter().find(|(c, _)| is(c)).map(|(_, v)| letter(v)).expect("the question is asked")
}

/// The answers to the author's questions.
fn author(text: &str) -> Vec<String> {
    answers(text).iter().filter(|(c, _)| c.is_own()).map(|(_, v)| letter(v)).collect()
}

const DOOR: &str = "input a, b : BOOL\noutput m : BOOL\nchart G {\n  initial step 1\n  step 2 { N m }\n  step 3\n  \
                    1 -> 2 when a\n  2 -> 1 when b\n  2 -> 3 when a and not a\n}\n";

#[test]
fn what_is_never_reached_is_found() {
    // Under search for stability 1 -> 2 clears in the first scan, if a comes with it.
    let step = |n: u32| answer(DOOR, |c| *c == Claim::Active(StepId(n)));
    assert_eq!([step(0), step(1), step(2)], ["P1", "P1", "R"]);
    let clears = |n: u32| answer(DOOR, |c| *c == Claim::Clears(n));
    assert_eq!([clears(0), clears(1), clears(2)], ["P1", "P1", "R"]);
    assert_eq!(answer(DOOR, |c| matches!(c, Claim::On(_))), "P1");
    assert_eq!(answer(DOOR, |c| matches!(c, Claim::Asked(_))), "P1");
    let unread = "input a, b : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a 3 -> 1 when b }\n";
    let asked: Vec<String> = answers(unread)
        .iter()
        .filter(|(c, _)| matches!(c, Claim::Asked(_)))
        .map(|(_, v)| letter(v))
        .collect();
    assert_eq!(asked, ["P1", "R"], "nothing that is reached waits for b");
    // a and b together: the search goes round for ever.
    assert_eq!(answer(DOOR, |c| *c == Claim::NoInstability), "R1");
}

/// The initial situation is the first one, also where it is left in the same evolution.
#[test]
fn an_initial_step_that_is_left_at_once_was_active() {
    let chart = "input a : BOOL\nchart G {\n  initial step 1\n  step 2\n  step 3\n  1 -> 2 when TRUE\n  \
                 2 -> 3 when a\n  3 -> 2 when not a\n}\n";
    let found = answer(chart, |c| *c == Claim::Active(StepId(0)));
    assert!(found.starts_with('P'), "{found}");
}

#[test]
fn deadlocks_are_told_apart_from_ends() {
    let wait = "input a, b : BOOL\nchart G { initial step 1 step 2 1 -> 2 when a 2 -> 1 when b }\n";
    assert_eq!(answer(&format!("profile iec61131\n{wait}"), |c| *c == Claim::NoDeadlock), "P");
    let end = "input a : BOOL\nchart G { initial step 1 step 2 1 -> 2 when a }\n";
    assert_eq!(answer(end, |c| *c == Claim::NoDeadlock), "P");
    // The second join waits for a step that has been left for ever.
    let dead = "input a : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a; (2, 3) -> 1 when a }\n";
    assert_eq!(answer(dead, |c| *c == Claim::NoDeadlock), "R1");
    // A timer leads out, however long it takes.
    let timed = "profile iec61131\nscan 10ms\ninput a : BOOL\nchart G { initial step 1 step 2 1 -> 2 when a 2 -> 1 when 200ms/X2 }\n";
    assert_eq!(answer(timed, |c| *c == Claim::NoDeadlock), "P");
}

#[test]
fn conflicts_follow_the_profile() {
    let chart = |profile: &str, first: &str, second: &str| {
        format!(
            "profile {profile}\ninput a, b : BOOL\nchart G {{ initial step 1 step 2 step 3 1 -> 2 when a{first} 1 -> 3 when b{second} \
             2 -> 1 when not a 3 -> 1 when not b }}\n"
        )
    };
    let conflict = |text: &str| answer(text, |c| *c == Claim::NoConflict);
    assert_eq!(conflict(&chart("iec60848", "", "")), "R1");
    assert_eq!(conflict(&chart("iec61131", " priority 1", " priority 2")), "P", "the author has chosen");
    let apart = "input a, b : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a and not b 1 -> 3 when b and not a \
                 2 -> 1 when not a 3 -> 1 when not b }\n";
    assert_eq!(conflict(apart), "P");
    // Two tokens in one sequence: 2 is entered while active.
    let twice = "profile iec60848\ninput a, b : BOOL\nchart G { initial step 1 step 2 step 3 1 -> (2, 3) when a 3 -> 2 when b and not a 2 -> 1 when a and b and X1 }\n";
    assert_eq!(answer(twice, |c| *c == Claim::NoUnsafe).chars().next(), Some('R'));
}

#[test]
fn faults_and_opposed_writes_are_found() {
    let divides = "profile iec61131\ninput a : BOOL\nvar n : INT := 2\nvar m : INT\nchart G { initial step 1 step 2 { P1 { n := n - 1; m := 10 / n } } \
                   1 -> 2 when a 2 -> 1 when not a }\n";
    // n is 1 behind the first activation, 0 in the second: a, not a, a.
    assert_eq!(answer(divides, |c| *c == Claim::NoFault).chars().next(), Some('R'));
    let writes = "input a : BOOL\nvar n : INT\nchart G { initial step 1 step 2 { P1 n := 1 } step 3 { P1 n := 2 } 1 -> (2, 3) when a; (2, 3) -> 1 when not a }\n";
    assert_eq!(answer(writes, |c| *c == Claim::NoOpposedWrites), "R1");
}

#[test]
fn the_questions_of_the_author() {
    let base = "profile iec61131\nscan 10ms\ninput a, b : BOOL\noutput m : BOOL\nchart G { initial step 1 step 2 { N m } \
                1 -> 2 when a 2 -> 1 when b or 50ms/X2 }\n";
    let ask = |text: &str| author(&format!("{base}{text}\n"));
    assert_eq!(
        ask("prove always X1 or X2\nprove never X1 and X2\nprove reachable m\nprove never X2"),
        ["P", "P", "P1", "R1"]
    );
    assert_eq!(ask("prove at most 1 of (X1, X2)\nprove at most 0 of (X1, X2)"), ["P", "R1"]);
    // X2 lasts at most 50 ms and one scan for the transition.
    assert_eq!(ask("prove after X2 within 60ms expect X1"), ["P"]);
    assert_eq!(ask("prove after X2 within 30ms expect X1"), ["R5"]);
    assert_eq!(ask("prove X2 leads to X1\nprove X1 leads to X2"), ["P", "P"]);
    assert_eq!(ask("prove after X2 until X1 expect m"), ["P"]);
    assert_eq!(ask("prove after X1 until m expect not X2"), ["P"]);
    assert_eq!(ask("prove after X1 until X7 expect X1".replace("X7", "b and a").as_str()), ["R2"]);
    assert_eq!(ask("prove between X1 and b and X1 never X2"), ["R3"]);
    assert_eq!(ask("prove between X2 and X1 never not m"), ["P"]);
}

#[test]
fn what_leads_nowhere_is_refuted() {
    let trap = "input a, b : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a and not b 2 -> 1 when b and not a 2 -> 3 when a and b }\n\
                prove X2 leads to X1\nprove X3 leads to X1\n";
    // X2 may go to 3 instead, from where nothing leads back.
    let found = author(trap);
    assert!(found.iter().all(|l| l.starts_with('R')), "{found:?}");
}

/// Claims about all that can follow a state: search and solver agree on random charts of each profile.
#[test]
fn search_and_solver_agree_about_what_can_follow() {
    use g7_compile::ir::VarClass::{Input, Output};
    let all = [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ];
    #[allow(clippy::disallowed_methods, reason = "how much a test does is told by its environment")]
    let charts = std::env::var("G7_CHARTS").ok().and_then(|v| v.parse().ok()).unwrap_or(1u64);
    let (mut proved, mut refuted, mut open) = (0, 0, 0);
    // One chart of each takes a minute.
    let all = if charts > 1 { &all[..] } else { &all[1..2] };
    for (seed, profile) in (1..=charts).flat_map(|seed| all.iter().map(move |p| (seed, *p))) {
        let text = sample(seed, profile, 1).expect("a random chart can be read").text;
        let first = parse(&text, FileId(0)).0;
        let Some(plain) = ask(&first, None).0 else { continue };
        let flags = plain
            .compiled
            .symbols
            .variables
            .iter()
            .filter(|v| v.ty == g7_model::Type::Bool && v.elements == 1);
        let names: Vec<String> =
            flags.filter(|v| matches!(v.class, Input | Output)).map(|v| v.name.to_string()).collect();
        let [a, .., b] = names.as_slice() else { continue };
        let text = format!("{text}\nprove {a} leads to {b}\nprove {b} leads to not {a}\n");
        let Some(asked) = ask(&parse(&text, FileId(0)).0, None).0 else { continue };
        let follows = |c: &Claim| matches!(c, Claim::NoDeadlock | Claim::LeadsTo { .. });
        let mine: Vec<_> = asked.questions.iter().filter(|q| follows(&q.claim)).cloned().collect();
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let (mut searched, mut solved) = (vec![None; mine.len()], vec![None; mine.len()]);
        let budget = Budget { states: 5_000, scans: 50_000, ..budget() };
        Explicit.answer(&model, &mine, &mut searched, &budget);
        Satisfiability { turns: 5 }.answer(&model, &mine, &mut solved, &budget);
        for ((q, a), b) in mine.iter().zip(searched.iter().flatten()).zip(solved.iter().flatten()) {
            let both = format!("{}{}", &letter(a)[..1], &letter(b)[..1]);
            match both.as_str() {
                "PP" | "OP" => proved += 1,
                "RR" => refuted += 1,
                "PO" | "RO" | "OO" | "OR" => open += 1,
                _ => panic!("{} seed {seed}, {:?}: {a:?} or {b:?}\n{text}", profile.name(), q.claim),
            }
            if let Verdict::Refuted(Evidence::Run(run)) = b {
                assert!(replay(&model, &q.claim, run));
            }
        }
    }
    println!("{proved} proved, {refuted} refuted, {open} open");
    assert!(charts < 12 || proved > 20 && refuted > 10, "{proved} proved, {refuted} refuted, {open} open");
}

/// The solver answers for times that a search would wait through, and for more sequences than it can visit.
#[test]
fn what_can_follow_in_charts_that_no_search_visits() {
    let solved = |text: &str| -> Vec<String> {
        let asked = asked(text);
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let all = of_layer(&asked, &model, &Satisfiability { turns: 10 });
        let mine = |c: &Claim| matches!(c, Claim::NoDeadlock | Claim::LeadsTo { .. });
        all.iter().filter(|(c, _)| mine(c)).map(|(_, v)| letter(v)).collect()
    };
    let timed = "profile iec61131\nscan 10ms\ninput a : BOOL\noutput m : BOOL\nchart G { initial step 1 step 2 { N m } step 3 \
                 1 -> 2 when a 2 -> 1 when 1h/X2 TAIL }\nprove X2 leads to X1\n";
    assert_eq!(solved(&timed.replace("TAIL", "")), ["P", "P"]);
    // Step 3 has a way out that nothing takes.
    let trap = timed.replace("TAIL", "2 -> 3 when not a; 3 -> 1 when a and not a");
    assert_eq!(solved(&trap), ["R2", "R2"]);
    let lanes = |last: &str| {
        let mut text = String::from("profile iec61131\ninput go : BOOL\n");
        (1..=20).for_each(|i| text += &format!("input a{i} : BOOL\n"));
        text += "chart G {\n";
        (1..=20)
            .for_each(|i| text += &format!("  initial step {i}1\n  step {i}2\n  {i}1 -> {i}2 when a{i}\n"));
        let ends: Vec<String> = (1..=20).map(|i| format!("{i}2")).collect();
        let starts: Vec<String> = (1..=20).map(|i| format!("{i}1")).collect();
        text += &format!(
            "  step 9\n  ({}{last}) -> ({}) when go\n}}\nprove X12 leads to X11\n",
            ends.join(", "),
            starts.join(", ")
        );
        text
    };
    assert_eq!(solved(&lanes("")), ["P", "P"]);
    // The last transition waits for a step that is never active.
    assert_eq!(solved(&lanes(", 9")), ["R1", "R1"]);
}

#[test]
fn assumptions_restrict_the_inputs() {
    let base = "profile iec61131\ninput a, b : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a 1 -> 3 when a and b 2 -> 1 when not a 3 -> 1 when not a }\n";
    assert_eq!(author(&format!("{base}prove never a and b")), ["R1"]);
    assert_eq!(author(&format!("{base}assume not (a and b)\nprove never a and b")), ["P"]);
    assert_eq!(answer(&format!("{base}assume not (a and b)\n"), |c| *c == Claim::NoConflict), "P");
    // With an assumption that nothing satisfies every claim would hold.
    assert_eq!(author(&format!("{base}assume a and not a\nprove never X1\nprove always X1")), ["O", "O"]);
}

#[test]
fn numbers_are_tried_around_the_constants_they_are_compared_with() {
    let base = "profile iec61131\ninput n : INT\ninput k : INT\nvar s : INT\nchart G { initial step 1 step 2 1 -> 2 when n > 100 2 -> 1 when n = 50 }\n";
    assert_eq!(
        author(&format!("{base}prove reachable n = 101 and X2\nprove never n > 100 and X1 and n < 102")),
        ["P1", "P"]
    );
    let sums = "profile iec61131\ninput n : INT\nvar s : INT\nchart G { initial step 1 step 2 { P1 s := n / 2 } 1 -> 2 when n > 100 2 -> 1 when n = 50 }\nprove always X1 or X2\n";
    assert_eq!(author(sums), ["O"], "its half matters too");
}

#[test]
fn a_bound_is_told_with_how_far_it_is_sure() {
    let asked = asked(
        "profile iec61131\ninput a : BOOL\nvar n : INT\nchart G { initial step 1 step 2 { P1 n := n + 1 } 1 -> 2 when a 2 -> 1 when not a }\nprove never n = 30000\n",
    );
    let model = Model::new(&asked.compiled, Vec::new());
    let mut answers = vec![None; asked.questions.len()];
    Explicit.answer(&model, &asked.questions, &mut answers, &Budget { states: 100, ..budget() });
    let Some(Some(Verdict::Open(open))) = answers.last() else { panic!("{answers:?}") };
    assert!(open.scans > 10 && open.states > 100 && matches!(open.reason, Reason::States(_)), "{open:?}");
}

fn compared(a: &str, b: &str, situations: bool) -> Equality {
    let (a, b) = (asked(a), asked(b));
    let assume = [a.assume.clone(), b.assume.clone()];
    compare(&Compare { charts: [&a.compiled, &b.compiled], assume, situations }, &budget())
}

#[test]
fn equal_charts_and_charts_that_differ() {
    let two = "profile iec61131\ninput a, b : BOOL\noutput m : BOOL\nchart G { initial step 1 step 2 { N m } 1 -> 2 when a 2 -> 1 when b }\n";
    let renamed = two.replace("step 2", "step 7").replace("-> 2", "-> 7").replace("2 ->", "7 ->");
    assert!(matches!(compared(two, &renamed, false), Equality::Equal { .. }));
    let Equality::Apart { what, .. } = compared(two, &renamed, true) else { panic!("the names differ") };
    assert_eq!(what, Difference::Step("G.2".into()));
    // One waits for a alone, the other for a and b: told apart by the first scan, which judges the initial step.
    let Equality::Apart { moves, what } = compared(two, &two.replace("when a", "when a and not b"), false)
    else {
        panic!("they differ")
    };
    assert_eq!((moves[0].len(), moves[1].len(), what), (1, 1, Difference::Output("m".into())));
    assert!(matches!(
        compared(two, &two.replace("output m : BOOL", "output m, k : BOOL"), false),
        Equality::Unlike(_)
    ));
    // A search for stability passes through 2 in one scan.
    let stable = two.replace("iec61131", "iec60848");
    assert!(matches!(compared(two, &stable, false), Equality::Apart { .. }));
}
