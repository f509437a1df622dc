//! States, rates, limits, events and drives.

use super::support::{compiled, near, run, run_text, text};

#[test]
fn a_rate_is_a_way_in_a_second_and_the_first_tick_takes_no_time() {
    let mut p = run("state x : LREAL := 5.0  rate x := 2.0");
    p.ticks(1);
    near(p.lreal("x"), 5.0);
    p.ticks(100);
    near(p.lreal("x"), 7.0);
    p.period = 250_000_000;
    // The tick that follows still comes ten milliseconds behind the one before.
    p.ticks(1);
    near(p.lreal("x"), 7.02);
    p.ticks(2);
    near(p.lreal("x"), 8.02);
}

#[test]
fn rates_of_a_state_add_up_and_go_only_when_they_may() {
    let mut p = run("state x : REAL  rate x := 8.0 when V  rate x := -5.0 when W  rate x := 1.0");
    p.ticks(101);
    near(p.real("x").into(), 1.0);
    p.output("V", true).ticks(100);
    near(p.real("x").into(), 10.0);
    p.output("W", true).ticks(100);
    near(p.real("x").into(), 14.0);
}

#[test]
fn a_state_stays_within_its_limits_whatever_moves_it() {
    let mut p = run("
        const most : LREAL := 0.5
        state x : LREAL in -0.25 .. most
        state n : INT := 3 in 0 .. 4
        state above, over : BOOL
        rate x := 1.0 when V
        rate x := -1.0 when not V
        each {
          above := above or x > most
          n := n + 3
          over := over or n > 4
        }");
    p.ticks(1000);
    near(p.lreal("x"), -0.25);
    p.output("V", true).ticks(1000);
    near(p.lreal("x"), 0.5);
    // Limited before the events, and again behind them.
    assert!(!p.bool("above"));
    assert!(p.bool("over"));
    assert_eq!(p.int("n"), 4);
    p.set("n", -7i64 as u64).ticks(1);
    assert_eq!(p.int("n"), 3);
}

#[test]
fn an_event_is_done_once_each_time_and_not_at_the_first_tick() {
    let mut p = run("state n : INT  on V { n := n + 1 }  on not V { n := n + 10 }");
    p.output("V", true).ticks(3);
    assert_eq!(p.int("n"), 0);
    p.output("V", false).ticks(3);
    assert_eq!(p.int("n"), 10);
    p.output("V", true).ticks(3);
    assert_eq!(p.int("n"), 11);
}

#[test]
fn events_and_each_are_done_in_the_order_of_the_text() {
    let mut p = run("
        state x, y : INT
        each { x := x + 1 }
        on x = 3 { y := 10 * x }
        each { y := y + 1 x := x + 1 }");
    // x is 1, 3, 5 at the event; at the second tick it becomes 3.
    p.ticks(1);
    assert_eq!((p.int("x"), p.int("y")), (2, 1));
    p.ticks(1);
    assert_eq!((p.int("x"), p.int("y")), (4, 31));
    p.ticks(1);
    assert_eq!((p.int("x"), p.int("y")), (6, 32));
}

#[test]
fn drives_give_the_inputs_their_values_behind_all_else() {
    let mut p = run("state x : REAL  drive r := x * 2.0  drive a := x > 0.9  each { x := x + 0.5 }");
    p.ticks(1);
    near(f32::from_bits(p.driven("r") as u32).into(), 1.0);
    assert_eq!(p.driven("a"), 0);
    p.ticks(1);
    near(f32::from_bits(p.driven("r") as u32).into(), 2.0);
    assert_eq!(p.driven("a"), 1);
}

#[test]
fn a_state_may_have_the_name_of_the_input_it_drives_or_hide_an_output() {
    let mut p = run("state a, V : BOOL  each { a := not a  V := a }  drive a := a");
    p.ticks(1);
    assert_eq!(p.driven("a"), 1);
    assert!(p.bool("V"));
    // The hidden output is not read, the other one is.
    assert_eq!(p.plant.to_plant.len(), 1);
}

#[test]
fn variables_of_blocks_begin_anew_at_each_tick_and_are_their_own() {
    let mut p = run("
        state s, t : INT
        each {
          var i, sum : INT
          FOR i := 1 TO 4 DO sum := sum + i END_FOR
          s := s + sum
        }
        on V {
          var i : INT := 7
          i := i + 1
          t := i
        }");
    p.ticks(2);
    assert_eq!(p.int("s"), 20);
    p.output("V", true).ticks(1).output("V", false).ticks(1).output("V", true).ticks(1);
    assert_eq!(p.int("t"), 8);
}

#[test]
fn constants_and_functions_of_the_file_are_the_plants_too() {
    let file = "
        input a : BOOL
        output V : BOOL
        var n : INT
        const K, L : INT := 3
        function ofCharts(x : INT) : INT { ofCharts := x + n }
        function twice(x : INT) : INT { twice := times(x, 2) }
        function times(x : INT, y : INT) : INT { times := x * y }
        chart G {
          initial step 0 { N V P1 n := ofCharts(1) }
          step 1
          0 -> 1 when a -> 0 when not a
        }
        plant P {
          const K : INT := 30
          state s : INT
          each { s := twice(K) + L @ }
          drive a := s > 3
        }";
    // A function that reads what only charts have is no plant's affair …
    assert!(compiled(&file.replace('@', "")).is_ok());
    // … unless the plant calls it.
    assert_eq!(compiled(&file.replace('@', "+ ofCharts(1)")).err(), Some(vec!["G0202"]));
}

/// A local variable of a plant, and a function that it calls, are of the types of the file.
#[test]
fn local_variables_have_types_of_the_file() {
    let types = "type Mode : (Off, Slow := 4, Fast)\ntype Turn : INT(1..3)\n\
                 function Next(m : Mode, plus : Turn) : Mode { IF m = Mode.Off and plus > 1 THEN Next := Fast END_IF }\n";
    let items = "state n, k : INT
        each {
          var mode : Mode := Slow
          var turn : Turn
          k := turn
          turn := turn + n
          mode := Next(Mode.Off, turn)
          n := Mode_TO_INT(mode)
        }";
    let mut p = run_text(&format!("{types}{}", text(items)));
    p.ticks(1);
    assert_eq!((p.int("n"), p.int("k")), (0, 1));
    p.set("n", 1).ticks(1);
    assert_eq!((p.int("n"), p.int("k")), (5, 1));
}
