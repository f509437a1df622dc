//! Stored actions, control blocks, direct outputs, watches.

use g7_engine::{Addr, INPUTS, NONE, Op};

use super::support::{Look, compiled};

fn direct(text: &str) -> Option<Addr> {
    let c = compiled(text);
    let at = c.tables().steps[c.step("1").0 as usize].direct;
    assert_eq!(at.0 == NONE, !c.tables().contributions.is_empty(), "one or the other");
    (at.0 != NONE).then_some(at)
}

#[test]
fn an_output_of_one_step_alone_is_written_with_the_step() {
    assert_eq!(direct("output V : BOOL chart G { initial step 1 { N V } }"), Some(Addr(0)));
    let not = [
        // Two steps, a condition, a mask, another writer, another association.
        "chart G { initial step 1 { N V } step 2 { N V } 1 -> 2 when TRUE }",
        "input a : BOOL chart G { initial step 1 { N V if a } }",
        "chart G { initial step 1 { N V } } chart H { initial step 2 { mask V } }",
        "chart G { initial step 1 { N V } } chart H { initial step 2 { mask G } }",
        "profile pl7 chart G { initial step 1 { N V } } post { V := FALSE }",
        "profile iec61131 chart G { initial step 1 { N V } step 2 { S V } 1 -> 2 when TRUE }",
        // Somebody may look at it within the evolution.
        "chart G { initial step 1 { N V } step 2 1 -> 2 when V }",
        "var n : INT chart G { initial step 1 { N V } step 2 { P1 n := BOOL_TO_INT(V) } 1 -> 2 when TRUE }",
        "output W : BOOL chart G { initial step 1 { N V } step 2 { N W if V } 1 -> 2 when TRUE }",
        "var n : INT chart G { initial step 1 { N V on ↑V: n := 1 } }",
        "var m : BOOL pre { m := V } chart G { initial step 1 { N V } }",
        // Its value would not be that of the block.
        "chart G every 20ms { initial step 1 { N V } }",
    ];
    for text in not {
        assert_eq!(direct(&format!("output V : BOOL {text}")), None, "{text}");
    }
    assert_eq!(direct("output V : BOOL := TRUE chart G { initial step 1 { N V } }"), None);
    assert_eq!(direct("var V : BOOL retain chart G { initial step 1 { N V } }"), None);
    // Actions at the end of the scan see no difference.
    let late = "output V : BOOL output W : BOOL chart G { initial step 1 { N V } } post { W := V }";
    assert_eq!(direct(late), Some(Addr(0)));
}

#[test]
fn a_step_has_one_direct_output_and_blocks_for_the_others() {
    let c = compiled("output V, W : BOOL chart G { initial step 1 { N V N W } }");
    let t = c.tables();
    assert_eq!(t.steps[0].direct, c.addr("V"));
    assert_eq!((t.blocks.len(), t.blocks[0].output, t.blocks[0].plain), (1, c.addr("W"), true));
    assert_eq!(c.start().scan().value("W"), "TRUE");
}

/// The inputs of control blocks, `block.input`, in the order of the steps.
fn inputs(text: &str) -> Vec<String> {
    let c = compiled(text);
    let t = c.tables();
    t.contributions.iter().map(|c| format!("{}.{}", c.block, INPUTS[usize::from(c.input)])).collect()
}

const SET_RESET: &str = "output V : BOOL input a : BOOL
    chart G { initial step 1 { S V } step 2 { R V if a } 1 -> 2 when a 2 -> 1 when a }";

#[test]
fn set_and_reset_are_stored_actions_or_inputs_of_the_block_by_profile() {
    for profile in ["iec60848", "pl7", "jgrafchart"] {
        let c = compiled(&format!("profile {profile} {SET_RESET}"));
        assert!(c.tables().blocks.is_empty(), "{profile}");
        let rows = c.extra("2").on;
        assert_eq!(rows.end - rows.start, 1);
        let action = c.tables().actions[c.tables().action_lists[rows.start as usize] as usize];
        assert_eq!(c.ops(action.body), [Op::Push(0), Op::Store(c.addr("V"))]);
        assert_eq!(c.ops(action.condition), [Op::Load(c.addr("a"))]);
    }
    for profile in ["iec61131", "unity"] {
        assert_eq!(inputs(&format!("profile {profile} {SET_RESET}")), ["0.S", "0.R"], "{profile}");
    }
}

#[test]
fn a_pulse_on_a_variable_brings_all_of_it_into_the_control_block() {
    let text =
        "output V : BOOL chart G { initial step 1 { S V P V } step 2 { R V D 2s V } 1 -> 2 when TRUE }";
    assert_eq!(inputs(text), ["0.S", "0.P", "0.R", "0.D"]);
}

#[test]
fn delayed_and_limited_continuous_actions_look_at_the_time_of_the_step() {
    let c = compiled("output V, W : BOOL input a : BOOL chart G { initial step 1 { D 2s V if a L 3s W } }");
    let t = c.tables();
    assert_eq!(inputs_of(&c), ["N", "N"]);
    assert!(t.blocks.iter().all(|b| b.plain) && t.watches.is_empty());
    let step = c.step("1");
    let conditions: Vec<&[Op]> = t.contributions.iter().map(|r| c.ops(r.condition)).collect();
    let (ge, lt) = (g7_engine::Cmp::Ge, g7_engine::Cmp::Lt);
    let i64 = g7_engine::Num::I64;
    assert_eq!(
        conditions[0],
        [Op::Load(c.addr("a")), Op::StepTime(step), Op::Push(2_000_000_000), Op::Compare(ge, i64), Op::And]
    );
    assert_eq!(conditions[1], [Op::StepTime(step), Op::Push(3_000_000_000), Op::Compare(lt, i64)]);
    let c = compiled("profile pl7 output V : BOOL chart G { initial step 1 { D 2s V } }");
    assert_eq!(inputs_of(&c), ["D"]);
    assert_eq!(c.ops(c.tables().contributions[0].time), [Op::Push(2_000_000_000)]);
}

fn inputs_of(c: &g7_compile::Compiled) -> Vec<&'static str> {
    c.tables().contributions.iter().map(|r| INPUTS[usize::from(r.input)]).collect()
}

#[test]
fn masks_are_conditions_of_a_chart_and_the_gate_of_a_variable() {
    let c = compiled(
        "output V, W : BOOL
         chart G { initial macro M = E1 step 3 { N W } M -> 3 when TRUE }
         macrochart E1 { entry step E { N V } exit step S E -> S when TRUE }
         chart H { initial step 8 { mask G } step 9 { mask W } 8 -> 9 when TRUE }",
    );
    let t = c.tables();
    let masked = [Op::Active(c.step("8")), Op::Not];
    assert!(t.contributions.iter().all(|r| c.ops(r.condition) == masked), "in expansions too");
    let gate = t.blocks.iter().find(|b| b.output == c.addr("W")).expect("W").gate;
    assert_eq!(c.ops(gate), [Op::Active(c.step("9")), Op::Not]);
    assert!(t.blocks.iter().find(|b| b.output == c.addr("V")).expect("V").gate.is_empty());
}

const ORDER: &str = "var n : INT input a : BOOL
    chart G {
      initial step 1 { P0 n := 1  on ↑a: n := 2  P1 n := 3 }
      step 2 { P0 n := 4  P1 n := 5 }
      1 -> 2 when a on clearing { n := 6 }
      2 -> 1 when a }";

/// The store of each action, by rank.
fn stored(text: &str) -> Vec<u64> {
    let c = compiled(text);
    let t = c.tables();
    let value = |code| match c.ops(code) {
        [Op::Push(v), Op::Store(_)] => *v,
        other => panic!("{other:?}"),
    };
    t.actions.iter().map(|a| value(a.body)).collect()
}

#[test]
fn the_rank_of_actions_is_the_kind_or_pulses_outside() {
    assert_eq!(stored(ORDER), [6, 1, 4, 3, 5, 2], "clearing, deactivation, activation, event");
    assert_eq!(stored(&format!("profile pl7 {ORDER}")), [6, 1, 4, 3, 5, 2], "the same under PL7");
    assert_eq!(stored(&format!("profile unity {ORDER}")), [6, 2, 3, 5, 1, 4], "at the end P1 first, P0 last");
}

#[test]
fn named_actions_have_one_block_and_pulses_by_profile() {
    let text = "var n : INT action Count { n := n + 1 }
        chart G { initial step 1 { P1 Count } step 2 { N Count } step 3 { P0 Count }
          1 -> 2 when TRUE 2 -> 3 when TRUE }";
    let c = compiled(text);
    assert_eq!(inputs_of(&c), ["N"], "P1 and P0 are stored actions");
    assert!(!c.extra("1").on.is_empty() && !c.extra("3").off.is_empty());
    let bodies: Vec<_> = c.tables().actions.iter().map(|a| a.body).collect();
    assert!(bodies.windows(2).all(|w| w[0] == w[1]), "the body is written once");
    let c = compiled(&format!("profile iec61131 {text}"));
    assert_eq!(inputs_of(&c), ["P1", "N", "P0"]);
    assert_eq!(c.tables().blocks.len(), 1);
    assert_eq!(&*c.symbols.blocks[0].name, "Count");
}

#[test]
fn pulses_of_assignments_are_stored_and_a_condition_makes_them_a_block_under_action_control() {
    let text = "var n : INT input a : BOOL chart G { initial step 1 { P1 n := 1 P0 n := 2 if a } }";
    let c = compiled(text);
    assert!(c.tables().blocks.is_empty());
    let c = compiled(&format!("profile iec61131 {text}"));
    assert_eq!(inputs_of(&c), ["P0"]);
    assert!(!c.extra("1").on.is_empty());
}

#[test]
fn events_and_periodic_actions_hang_on_their_step() {
    let c = compiled(
        "var n : INT input a : BOOL
         chart G { initial step 1 { on ↑a: n := 1  each scan: n := n + 1 if a } }",
    );
    let e = c.extra("1");
    assert_eq!((e.events.end - e.events.start, e.periodics.end - e.periodics.start), (1, 1));
    let periodic = c.tables().actions[c.tables().periodics[0] as usize];
    assert_eq!(c.ops(periodic.condition), [Op::Load(c.addr("a"))]);
}

#[test]
fn equal_edges_share_a_watch() {
    let c = compiled(
        "input a, b : BOOL
         chart G { initial step 1
           t1: 1 -> 1 when ↑a  t2: 1 -> 1 when ↓a and ↑a  t3: 1 -> 1 when ↑(a and b)
           t4: 1 -> 1 when ↑(a and b) or ↑(2s/↑a)  t5: 1 -> 1 when 2s/↑a }",
    );
    let t = c.tables();
    // a; a and b; 2s/↑a; its edge.
    assert_eq!(t.watches.len(), 4);
    let (a, b) = (c.addr("a"), c.addr("b"));
    let pairs: Vec<(Addr, u32)> = t.word_watches.iter().map(|(w, k)| (*w, k.0)).collect();
    assert_eq!(pairs, [(a, 0), (a, 1), (b, 1)], "the timer reads the watch, not the word");
    let readers = t.watches[0].watches;
    assert_eq!(t.watch_lists[readers.start as usize..readers.end as usize], [g7_engine::WatchId(2)]);
    assert!(t.watches[2].times.is_some() && t.watches[3].times.is_none());
    assert!(t.watches.iter().all(|w| !w.always));
}

#[test]
fn equal_edges_of_charts_with_other_periods_do_not() {
    let c = compiled(
        "input a : BOOL
         chart G { initial step 1  1 -> 1 when ↑a }  chart H every 20ms { initial step 2  2 -> 2 when ↑a }",
    );
    assert_eq!(c.tables().watches.iter().map(|w| w.period).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn the_time_of_an_active_step_is_no_watch() {
    let c = compiled("chart G { initial step 1  step 2  t1: 1 -> 2 when 3s/X1  t2: 2 -> 1 when ↑(3s/X1) }");
    let t = c.tables();
    let step = c.step("1");
    let code = [
        Op::Active(step),
        Op::StepTime(step),
        Op::Push(3_000_000_000),
        Op::Compare(g7_engine::Cmp::Ge, g7_engine::Num::I64),
        Op::And,
    ];
    let g7_engine::Receptivity::Code(guard) = c.transition("t1").receptivity else { panic!("code") };
    assert_eq!(c.ops(guard), code);
    assert_eq!((t.watches.len(), t.watches[0].always), (1, true), "its edge is one");
    assert_eq!(c.ops(t.watches[0].code), code);
    let watched = c.extra("1").watches;
    assert_eq!(watched.end - watched.start, 1);
}

#[test]
fn a_second_time_makes_it_a_timer() {
    let c = compiled("chart G { initial step 1  step 2  t1: 1 -> 2 when 3s/X1/1s }");
    let times = c.tables().watches[0].times.expect("a timer");
    assert_eq!(c.ops(times.0), [Op::Push(3_000_000_000)]);
    assert_eq!(c.ops(times.1), [Op::Push(1_000_000_000)]);
}
