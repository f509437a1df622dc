//! Ranks, receptivities, tasks, `enable`, freezing, system bits.

use g7_engine::{NONE, Op, Receptivity};

use super::support::{Look, compiled};

#[test]
fn rank_is_the_priority_then_the_text() {
    let c = compiled(
        "profile iec61131  input a : BOOL
         chart G { initial step 1  step 2  step 3  step 4
           t1: 1 -> 2 when a  t2: 1 -> 3 when a priority 2  t3: 1 -> 4 when a priority 1  t4: 2 -> 1 when a }",
    );
    let ranks: Vec<u32> = ["t3", "t2", "t1", "t4"].iter().map(|l| c.rank(l)).collect();
    assert_eq!(ranks, [0, 1, 2, 3]);
    assert_eq!(c.transition("t2").priority, 2);
    assert_eq!(c.transition("t1").priority, NONE);
    let out = c.tables().steps[c.step("1").0 as usize].out;
    assert_eq!(c.tables().outs[out.start as usize..out.end as usize], [0, 1, 2]);
}

#[test]
fn under_sequential_rank_is_the_level_then_the_text_and_numbers_only_exclude() {
    let c = compiled(
        "profile jgrafchart  input a : BOOL
         macrochart E1 { entry step E  exit step S  t1: E -> S when a priority 1 }
         chart G { initial step 1  macro M = E1  t2: 1 -> M when a priority 7  t3: M -> 1 when a priority 3 }
         chart H { initial step 5  step 6  t4: 5 -> 6 when a }",
    );
    let ranks: Vec<u32> = ["t2", "t3", "t4", "t1"].iter().map(|l| c.rank(l)).collect();
    assert_eq!(ranks, [0, 1, 2, 3], "the expansion comes behind the outermost charts");
    assert_eq!(c.transition("t2").priority, 7);
}

#[test]
fn a_single_variable_needs_no_code() {
    let c = compiled(
        "input a : BOOL  const YES : BOOL := TRUE
         chart G { initial step 1
           t1: 1 -> 1 when TRUE  t2: 1 -> 1 when a  t3: 1 -> 1 when not a  t4: 1 -> 1 when YES
           t5: 1 -> 1 when FALSE  t6: 1 -> 1 when a and X1 }",
    );
    let a = c.addr("a");
    let guards: Vec<Receptivity> =
        ["t1", "t2", "t3", "t4"].iter().map(|l| c.transition(l).receptivity).collect();
    assert_eq!(guards, [Receptivity::True, Receptivity::Word(a), Receptivity::NotWord(a), Receptivity::True]);
    let Receptivity::Code(never) = c.transition("t5").receptivity else { panic!("code") };
    assert_eq!(c.ops(never), [Op::Push(0)]);
    let Receptivity::Code(both) = c.transition("t6").receptivity else { panic!("code") };
    assert_eq!(c.ops(both), [Op::Load(a), Op::Active(c.step("1")), Op::And]);
}

#[test]
fn source_and_sink_and_shared_steps() {
    let c = compiled(
        "input a : BOOL
         chart G { initial step 1  step 2  step 3
           s: () -> 1 when a  k: 3 -> () when a  j: (1, 2) -> 3 when a  o: 2 -> 3 when a  l: 1 -> 2 when a }",
    );
    assert!(c.from("s").is_empty() && c.to("k").is_empty());
    assert_eq!(c.tables().sources, [c.rank("s")]);
    assert_eq!(c.from("j"), ["1", "2"]);
    assert!(c.transition("j").shares && c.transition("o").shares && c.transition("l").shares);
    assert!(!c.transition("k").shares);
    assert!(c.transition("k").simple);
    assert!(!c.transition("l").simple && !c.transition("o").simple, "1 and 2 also join in j");
}

#[test]
fn enable_holds_a_chart_and_its_expansions() {
    let c = compiled(
        "input a : BOOL
         chart G { initial step 1 { enable H }  step 2  step 3 { enable H }  1 -> 2 when a  2 -> 3 when a }
         chart H { initial step 5  macro M = E1  t1: 5 -> M when a  M -> 5 when a }
         macrochart E1 { entry step E  exit step S  t2: E -> S when TRUE }
         chart K { initial step 9  t3: 9 -> 9 when a }",
    );
    let Receptivity::Code(code) = c.transition("t1").receptivity else { panic!("code") };
    let (one, three) = (Op::Active(c.step("1")), Op::Active(c.step("3")));
    assert_eq!(c.ops(code), [one, three, Op::Or, Op::Load(c.addr("a")), Op::And]);
    let Receptivity::Code(code) = c.transition("t2").receptivity else { panic!("code") };
    assert_eq!(c.ops(code), [one, three, Op::Or]);
    assert_eq!(c.transition("t3").receptivity, Receptivity::Word(c.addr("a")));
}

#[test]
fn the_receptivity_of_a_transition_held_back_is_not_looked_at() {
    let c = compiled(
        "input a : BOOL  var n : INT
         chart G { initial step 1  step 2 { enable H }  1 -> 2 when a }
         chart H { initial step 5  step 6  5 -> 6 when 1 / n > 0 }",
    );
    let mut run = c.start();
    assert_eq!(run.scan().situation(), "1 5");
    run.set("a", 1);
    assert_eq!(run.try_scan().expect_err("a fault").kind, g7_engine::FaultKind::DivisionByZero);
}

#[test]
fn a_freeze_takes_effect_at_the_service_point() {
    let c = compiled(
        "profile unity  input a, f : BOOL
         pre { FREEZECHART(G, f) }
         chart G { initial step 1  step 2  1 -> 2 when a  2 -> 1 when a }
         chart H { initial step 5  t1: 5 -> 5 when a }",
    );
    assert_eq!(c.transition("t1").receptivity, Receptivity::Word(c.addr("a")), "the other chart runs on");
    let mut run = c.start();
    run.set("a", 1).set("f", 1).scan();
    assert_eq!(run.situation(), "1 5", "frozen by PRE in the same scan");
    run.set("f", 0).scan();
    assert_eq!(run.situation(), "2 5");
}

#[test]
fn s23_stops_every_transition_where_it_is_named() {
    let c = compiled(
        "profile pl7  input a, stop : BOOL
         pre { %S23 := stop }
         chart G { initial step 1  step 2  1 -> 2 when a  2 -> 1 when a }",
    );
    let mut run = c.start();
    run.set("a", 1).set("stop", 1).scan();
    assert_eq!(run.situation(), "1");
    run.set("stop", 0).scan();
    assert_eq!(run.situation(), "2");
}

#[test]
fn s21_and_s22_act_before_the_evolution_and_fall_back() {
    let c = compiled(
        "profile pl7  input a, init, off : BOOL  var seen : BOOL
         pre { %S21 := init  %S22 := off }  post { seen := %S21 }
         chart G { initial step 1  macro M = E1  1 -> M when a  M -> 1 when a }
         macrochart E1 { entry step E  exit step S  E -> S when FALSE }",
    );
    let mut run = c.start();
    run.set("a", 1).scan();
    assert_eq!(run.situation(), "M.E");
    run.set("a", 0).set("init", 1).scan();
    assert_eq!((run.situation(), run.value("seen")), ("1".into(), "FALSE".to_owned()));
    run.set("init", 0).set("off", 1).scan();
    assert_eq!(run.situation(), "");
}

#[test]
fn s24_empties_the_macro_steps_whose_bits_are_set() {
    let c = compiled(
        "profile pl7  input a, go : BOOL
         pre { IF go THEN %SW22 := 8; %SW23 := 32768; %S24 := TRUE; END_IF }
         chart G { initial macro M3 = E3  initial macro M31 = E31  initial macro M4 = E4
           step 1  M3 -> 1 when a  M31 -> 1 when a  M4 -> 1 when a }
         macrochart E3 { entry step E  exit step S  E -> S when a }
         macrochart E31 { entry step E  exit step S  E -> S when a }
         macrochart E4 { entry step E  exit step S  E -> S when a }",
    );
    let mut run = c.start();
    assert_eq!(run.scan().situation(), "M3.E M31.E M4.E");
    run.set("go", 1).scan();
    assert_eq!(run.situation(), "M4.E", "bit 3 of %SW22 and bit 15 of %SW23");
}

#[test]
fn s0_is_true_in_the_first_scan() {
    let c = compiled("profile pl7  var cold : BOOL  post { cold := %S0 }  chart G { initial step 1 }");
    assert_eq!(c.symbols.s0, Some(c.addr("%S0")));
    let mut run = c.start();
    assert_eq!(run.scan().value("cold"), "TRUE");
    assert_eq!(run.scan().value("cold"), "FALSE");
}

const TASK: &str = "
    input a, b, go : BOOL
    chart G { initial step 1  step 2 { call Grip }  step 3  t1: 1 -> 2 when a  t2: 2 -> 3 when TRUE }
    chart H { initial step 5  step 6 { call Grip }  step 7  t3: 5 -> 6 when b  t4: 6 -> 7 when TRUE }
    task Grip { entry step E  step W  exit step S  t5: E -> W when TRUE  t6: W -> S when go }";

#[test]
fn a_call_takes_the_task_to_its_end_and_back() {
    let c = compiled(TASK);
    assert_eq!(c.from("t2"), ["2", "S"]);
    assert_eq!(c.to("t2"), ["E", "3"]);
    let mut run = c.start();
    assert_eq!(run.scan().situation(), "1 5 E", "the task waits in its entry step");
    run.set("a", 1).scan();
    assert_eq!(run.situation(), "2 5 W");
    run.set("b", 1).scan();
    assert_eq!(run.situation(), "2 6 W", "the second caller waits");
    run.set("go", 1).scan();
    // Handed back to 2; then the task works for 6 at once, to its end.
    assert_eq!(run.situation(), "3 7 E");
}

#[test]
fn a_task_works_for_the_first_of_two_callers() {
    for profile in ["iec61131", "pl7", "unity", "jgrafchart"] {
        let c = compiled(&format!("profile {profile} {TASK}"));
        let mut run = c.start();
        run.scan().set("a", 1).set("b", 1).scan().scan().scan();
        assert_eq!(run.situation(), "2 6 W", "{profile}");
        run.set("go", 1).scan();
        run.set("go", 0).scan().scan();
        assert_eq!(run.situation(), "3 6 W", "{profile}");
    }
}

#[test]
fn a_task_whose_caller_is_gone_goes_back_by_itself() {
    let c = compiled(&format!(
        "{TASK}  input kill : BOOL
        chart K {{ initial step 8  step 9 {{ force G := {{1}} }}  8 -> 9 when kill }}"
    ));
    let mut run = c.start();
    run.scan().set("a", 1).scan();
    run.set("a", 0).set("kill", 1).scan();
    assert_eq!(run.situation(), "1 5 9 W");
    run.set("go", 1).scan();
    assert_eq!(run.situation(), "1 5 9 E");
    let hidden = (0..c.symbols.transitions()).filter(|r| !c.symbols.is_written(*r)).count();
    assert_eq!(hidden, 1, "the way back is no transition of the text");
}
