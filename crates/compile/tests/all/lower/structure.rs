//! Words, steps, groups, situations, orders.

use g7_engine::{NONE, Op, Rows, Situation, StepId};

use super::support::{Look, compiled};

#[test]
fn the_variable_area_holds_inputs_then_outputs_then_the_rest() {
    let c = compiled(
        "var n : INT := -2
         output lamp : BOOL := TRUE safe TRUE
         input a : BOOL
         var name : STRING(10) := 'pump 7 on'
         var c1 : CTU
         output speed : REAL safe 1.5
         input level : DINT
         var after : BOOL",
    );
    let t = c.tables();
    assert_eq!(t.inputs, Rows { start: 0, end: 2 });
    assert_eq!(t.outputs, Rows { start: 2, end: 4 });
    assert_eq!((c.addr("a").0, c.addr("level").0), (0, 1));
    assert_eq!((c.addr("lamp").0, c.addr("speed").0), (2, 3));
    assert_eq!(t.safe, [1, u64::from(1.5f32.to_bits())]);
    assert_eq!(c.addr("n").0, 4);
    assert_eq!(t.init[4], -2i64 as u64, "integers are sign-extended");
    assert_eq!(t.init[2], 1);
    // Length in bytes, then two words of text, the first byte lowest.
    let text = c.addr("name").0 as usize;
    assert_eq!(text, 5);
    assert_eq!(t.init[text..text + 3], [9, u64::from_le_bytes(*b"pump 7 o"), u64::from(b'n')]);
    // An instance has its members, then its memory.
    assert_eq!(c.addr("c1").0, 8);
    assert_eq!((c.addr("c1.CU").0, c.addr("c1.CV").0), (8, 12));
    assert_eq!(c.addr("after").0, 14);
}

const NESTED: &str = "
    input a : BOOL
    chart G { initial step 1  macro M = Outer  step 2
      t1: 1 -> M when a  t2: M -> 2 when a  t3: 2 -> 1 when a }
    chart H { initial step 9 }
    macrochart Inner { entry step I  exit step O  t6: I -> O when a }
    macrochart Outer { entry step E  macro N = Inner  exit step S
      t4: E -> N when a  t5: N -> S when a }
    macrochart Left { entry step Q  exit step R  Q -> R when a }";

#[test]
fn a_chart_and_its_expansions_are_contiguous() {
    let c = compiled(NESTED);
    let order: Vec<&str> = (0..c.symbols.steps()).map(|i| c.symbols.step_name(StepId(i))).collect();
    assert_eq!(order, ["1", "2", "M.E", "M.S", "N.I", "N.O", "9"], "an unused expansion is left out");
    let t = c.tables();
    let groups: Vec<(u32, u32)> = t.groups.iter().map(|g| (g.steps.start, g.steps.end)).collect();
    assert_eq!(groups, [(0, 6), (2, 6), (4, 6), (6, 7)]);
    assert_eq!(t.charts.len(), 2);
    assert_eq!(t.steps.iter().map(|s| s.chart).collect::<Vec<_>>(), [0, 0, 0, 0, 0, 0, 1]);
    // Only macro-steps have an activity that is counted.
    assert!(c.extra("1").groups.is_empty());
    let inner = c.extra("N.I").groups;
    assert_eq!(inner.end - inner.start, 2);
}

#[test]
fn arcs_into_a_macro_step_go_to_its_entry_step_and_come_from_its_exit_step() {
    let c = compiled(NESTED);
    assert_eq!((c.from("t1"), c.to("t1")), (vec!["1".into()], vec!["M.E".to_owned()]));
    assert_eq!((c.from("t2"), c.to("t2")), (vec!["M.S".into()], vec!["2".to_owned()]));
    assert_eq!((c.from("t4"), c.to("t4")), (vec!["M.E".into()], vec!["N.I".to_owned()]));
    assert_eq!((c.from("t5"), c.to("t5")), (vec!["N.O".into()], vec!["M.S".to_owned()]));
    assert!(c.symbols.macro_steps.iter().all(|m| m.step.is_none()), "nobody needs a step for them");
}

#[test]
fn a_macro_step_with_actions_has_a_step_of_its_own() {
    let c = compiled(
        "input a : BOOL  output V : BOOL
         chart G { initial macro M = E1 { N V }  macro K = E2  step 2
           t1: M -> K when a  t2: K -> M when K.t > 1s  t3: 2 -> M when a }
         macrochart E1 { entry step E  exit step S  E -> S when a }
         macrochart E2 { entry step E  exit step S  E -> S when a }",
    );
    let has: Vec<bool> = c.symbols.macro_steps.iter().map(|m| m.step.is_some()).collect();
    assert_eq!(has, [true, false], "M has an action");
    // It comes on before the entry step. What leads on waits for the exit step alone.
    assert_eq!((c.from("t1"), c.to("t1")), (vec!["M.S".into()], vec!["K.E".to_owned()]));
    assert_eq!(c.to("t3"), ["M", "M.E"]);
    let pseudo = c.symbols.macro_steps[0].step.expect("M acts");
    assert_eq!(c.tables().drops, [(c.rank("t1"), pseudo)]);
    assert!(c.transition("t1").drops && !c.transition("t2").drops);
    assert!(!c.symbols.is_listed(pseudo));
    assert_eq!(c.tables().steps[pseudo.0 as usize].direct, c.addr("V"));
    assert_eq!(c.tables().initial, [pseudo, c.step("M.E")], "it starts with its entry step");
    let mut run = c.start();
    assert_eq!((run.scan().situation(), run.value("V")), ("M.E".into(), "TRUE".to_owned()));
    run.set("a", 1).scan();
    assert_eq!((run.situation(), run.value("V")), ("K.S".into(), "FALSE".to_owned()));
}

#[test]
fn the_time_of_a_macro_step_runs_while_a_step_of_its_expansion_is_active() {
    let c = compiled(
        "input a : BOOL  var t : TIME
         chart G { step 1  initial macro M = E1  M -> 1 when not a  1 -> M when a }
         macrochart E1 { entry step E  exit step S  E -> S when a }  post { t := M.t }",
    );
    let mut run = c.start();
    assert_eq!(run.scan().value("t"), "T#0s");
    run.set("a", 1).scan();
    assert_eq!((run.situation(), run.value("t")), ("M.S".into(), "T#10ms".to_owned()));
    run.scan().set("a", 0).scan();
    assert_eq!((run.situation(), run.value("t")), ("1".into(), "T#30ms".to_owned()));
    assert_eq!(run.scan().value("t"), "T#30ms", "kept");
}

#[test]
fn what_stands_for_a_macro_step_is_no_step_of_the_expansion_round_it() {
    let c = compiled(
        "input a : BOOL  output V : BOOL
         chart G { initial macro M = E1  step 1  M -> 1 when a }
         macrochart E1 { entry step E  macro N = E2 { N V }  exit step S  E -> N when a  N -> S when a }
         macrochart E2 { entry step I  exit step O  I -> O when a }",
    );
    let counted = |step: g7_engine::StepId| {
        let row = c.tables().steps[step.0 as usize].extra;
        let groups = c.tables().extras[row as usize].groups;
        groups.end - groups.start
    };
    let stand_in = c.symbols.macro_steps[1].step.expect("N acts");
    assert_eq!((counted(stand_in), counted(c.step("M.E")), counted(c.step("N.I"))), (0, 1, 2));
}

#[test]
fn pre_and_post_of_a_chart_with_a_period_run_when_it_is_due() {
    let c = compiled(
        "var n, m : INT  post { m := m + 1 }
         chart G every 20ms { post { n := n + 1 }  initial step 1 }",
    );
    let mut run = c.start();
    run.scan().scan().scan();
    assert_eq!((run.value("n"), run.value("m")), ("2".into(), "3".to_owned()));
}

#[test]
fn the_activity_of_a_macro_step_is_that_of_its_group() {
    let c = compiled(
        "input a : BOOL  var x : BOOL
         chart G { initial macro M = E1  step 2  t1: M -> 2 when a }
         chart H { initial step 5  step 6  t2: 5 -> 6 when XM or X2 }
         macrochart E1 { entry step E  exit step S  E -> S when a }",
    );
    let g7_engine::Receptivity::Code(code) = c.transition("t2").receptivity else { panic!("code") };
    let group = c.symbols.macro_steps[0].group;
    assert_eq!(c.ops(code), [Op::GroupActive(group), Op::Active(c.step("2")), Op::Or]);
}

#[test]
fn enclosing_steps_activate_the_linked_steps_and_enclose_the_group() {
    let c = compiled(
        "input a : BOOL
         chart G { initial enclosing step 1 { enclose H }  step 2  t1: 1 -> 2 when a  t2: 2 -> 1 when a }
         chart H { step 5 *  initial step 6  enclosing step 7 * { enclose K }  5 -> 6 when a }
         chart K { step 8 *  initial step 9  8 -> 9 when a }",
    );
    let t = c.tables();
    let e = c.extra("1");
    assert_eq!(t.group_lists[e.encloses.start as usize].0, 1);
    let links = &t.arcs[e.links.start as usize..e.links.end as usize];
    assert_eq!(links, [c.step("5"), c.step("7")]);
    // 6 is initial and its enclosing step too; 9 does not start, since 7 is not
    // initial; links do not act at the start.
    assert_eq!(t.initial, [c.step("1"), c.step("6")]);
    let initial = t.groups[2].initial;
    assert_eq!(t.arcs[initial.start as usize..initial.end as usize], [c.step("9")], "INIT of K");
}

#[test]
fn forcing_orders_stand_behind_those_that_force_their_own_chart() {
    let c = compiled(
        "input a : BOOL
         chart C { initial step 5 }
         chart B { initial step 3 { force C := {5} }  step 4  3 -> 4 when a }
         chart A { initial step 1 { force B := INIT  force C := {*} }  step 2 { force B := {} }  1 -> 2 when a }",
    );
    let t = c.tables();
    let orders: Vec<(&str, u32)> = t.orders.iter().map(|o| (c.symbols.step_name(o.step), o.chart)).collect();
    // All orders on B before those on C, which B forces; then the present situation before the
    // named ones; then by their steps.
    assert_eq!(orders, [("1", 1), ("2", 1), ("1", 0), ("3", 0)]);
    let first = c.extra("1").orders;
    assert_eq!((first.start, first.end), (0, 1), "one row stands for the orders of a step");
    assert_eq!(t.orders[2].situation, Situation::Current);
    let Situation::Steps(rows) = t.orders[0].situation else { panic!("steps") };
    assert_eq!(t.arcs[rows.start as usize..rows.end as usize], [c.step("3")], "INIT of B");
    let Situation::Steps(rows) = t.orders[1].situation else { panic!("steps") };
    assert!(rows.is_empty());
}

#[test]
fn a_macro_step_is_forced_as_its_entry_step() {
    let c = compiled(
        "input a : BOOL  output V : BOOL
         chart A { initial step 1 { force G := {M} } }
         chart G { initial step 3  macro M = E1 { N V }  3 -> M when a  M -> 3 when a }
         macrochart E1 { entry step E  exit step S  E -> S when a }",
    );
    let Situation::Steps(rows) = c.tables().orders[0].situation else { panic!("steps") };
    let steps = &c.tables().arcs[rows.start as usize..rows.end as usize];
    assert_eq!(steps, [c.symbols.macro_steps[0].step.expect("M acts"), c.step("M.E")]);
}

#[test]
fn equal_periods_share_a_row_and_each_scan_is_row_zero() {
    let c = compiled(
        "input a : BOOL
         chart A every 20ms { initial step 1 }  chart B { initial step 2 }
         chart C every 30ms { initial step 3 }  chart D every 20ms { initial macro M = E1 }
         macrochart E1 { entry step E  exit step S  t1: E -> S when ↑a }",
    );
    let t = c.tables();
    assert_eq!(t.periods, [0, 20_000_000, 30_000_000]);
    assert_eq!(t.charts.iter().map(|c| c.period).collect::<Vec<_>>(), [1, 0, 2, 1]);
    assert_eq!(t.watches[0].period, 1, "an expansion has the period of its chart");
}

#[test]
fn limits_of_the_target_and_counts_where_they_are_asked_for() {
    let c = compiled("target tsx3710  chart G { initial step 1 }");
    let limits = c.tables().limits.expect("a target").1;
    assert_eq!((limits.active, limits.enabled), (96, 192));
    assert_eq!(c.tables().counts, None);
    for (name, active, enabled) in [("tsx3720", 128, 256), ("tsx57", 250, 400)] {
        let c = compiled(&format!("target {name}  chart G {{ initial step 1 }}"));
        let limits = c.tables().limits.expect("a target").1;
        assert_eq!((limits.active, limits.enabled), (active, enabled));
    }
    let c = compiled("profile pl7  var n : INT  chart G { initial step 1 { N n := %SW20 } }");
    let (steps, transitions) = c.tables().counts.expect("%SW20 is read");
    assert_eq!(steps, c.addr("%SW20"));
    assert_ne!(transitions, steps);
    assert_eq!(c.tables().limits, None);
    assert!(c.tables().steps.iter().all(|s| s.direct.0 == NONE));
}
