//! Rungs as Structured Text: what they do, in ClassicLadder's order.

use crate::support::{Bench, errors, lines, own, read};

fn bench(name: &str) -> Bench {
    let bytes = own("classicladder", name);
    let (document, problems) = read("classicladder", &bytes);
    assert!(errors(&problems).is_empty(), "{:?}", lines(&bytes, &problems));
    Bench::new(&document)
}

#[test]
fn timers_counters_and_boxes_do_what_they_do_there() {
    let mut press = bench("press.clprj");
    press.scan().set("start", 1).scan().set("start", 0).set("low", 1).scan();
    assert_eq!(press.active(), ["2"]);
    // A rising %X2: one more in %W0 and in the counter.
    assert_eq!((press.get("W0"), press.get("C0_V")), (1, 1));
    // (1 & 6) | 1
    assert_eq!(press.get("W1"), 1);
    // An on-delay of 5 times 100 ms.
    press.run(480);
    assert_eq!(press.get("up"), 0);
    press.run(40);
    assert_eq!(press.get("up"), 1);
    assert_eq!(press.get("W0"), 1);
    for strokes in 2..=3 {
        press.set("low", 0).set("high", 1).scan().set("high", 0).set("low", 1).scan();
        assert_eq!(press.get("W0"), strokes);
    }
    // (3 & 6) | 1, the lamp from two strokes on, the counter at its preset sets %B3.
    assert_eq!((press.get("W1"), press.get("Q2"), press.get("B3")), (3, 1, 1));
}

#[test]
fn jumps_make_loops_and_leave_rungs_out() {
    let mut jumps = bench("jumps.clp");
    jumps.scan();
    // Rung 1 jumps to itself while %W0 < 4, which is looked at one column before %W0
    // is counted up: so 5. Rung 3 adds 10 in each scan.
    assert_eq!((jumps.get("W0"), jumps.get("W2")), (5, 10));
    jumps.set("I0", 1).scan();
    assert_eq!((jumps.get("W0"), jumps.get("W2")), (5, 10));
    jumps.set("I0", 0).scan();
    assert_eq!(jumps.get("W2"), 20);
}

#[test]
fn a_subroutine_runs_only_where_it_is_called() {
    let mut jumps = bench("jumps.clp");
    jumps.scan();
    assert_eq!((jumps.get("Q3"), jumps.get("W3")), (0, 0));
    // MAXI(%W2,-5) - %TM0.P, behind the 10 that rung 3 has added twice.
    jumps.set("I1", 1).scan();
    assert_eq!((jumps.get("Q3"), jumps.get("W3")), (1, 20));
    // The falling edge of %I4 resets what the line above has set.
    jumps.set("I4", 1).scan();
    assert_eq!(jumps.get("Q3"), 1);
    jumps.set("I4", 0).scan();
    assert_eq!(jumps.get("Q3"), 0);
    jumps.scan();
    assert_eq!(jumps.get("Q3"), 1);
}

#[test]
fn old_timers_and_monostables_are_blocks_of_the_standard() {
    let mut jumps = bench("jumps.clp");
    jumps.scan().set("I2", 1).scan();
    // Two seconds; the second output is on while it runs.
    assert_eq!((jumps.get("Q0"), jumps.get("Q2")), (0, 1));
    jumps.run(1900);
    assert_eq!(jumps.get("Q0"), 0);
    jumps.run(200);
    assert_eq!((jumps.get("Q0"), jumps.get("Q2")), (1, 0));
    // Three times 100 ms from the rising edge, however long the input is on.
    jumps.set("I3", 1).scan();
    assert_eq!(jumps.get("Q1"), 1);
    jumps.run(400);
    assert_eq!(jumps.get("Q1"), 0);
}

#[test]
fn a_variable_by_index_is_chosen_among_all_of_its_kind() {
    let mut tables = bench("tables.clprj");
    tables.scan();
    // %W2[%W0] is %W2 at first; the coil of %Q0[%W0] follows the contact of %I0[%W0].
    assert_eq!((tables.get("W2"), tables.get("B0"), tables.get("Q0")), (10, 0, 0));
    tables.set("I0", 1).scan();
    // The comparison is looked at before the addition of the same rung.
    assert_eq!((tables.get("W2"), tables.get("B0"), tables.get("Q0")), (20, 0, 1));
    tables.scan();
    assert_eq!((tables.get("W2"), tables.get("B0")), (30, 1));
    // %I2 counts %W0 up at the end of the rung: from the next scan on all is one further.
    tables.set("I2", 1).scan().set("I2", 0).set("I1", 1).scan();
    assert_eq!((tables.get("W0"), tables.get("W2"), tables.get("W3")), (1, 40, 10));
    assert_eq!((tables.get("Q1"), tables.get("B0")), (1, 0));
    // Out of all reach nothing is written, and what is read is 0.
    tables.set("I2", 1).scan().scan().scan().scan().scan();
    assert_eq!((tables.get("W0"), tables.get("B0")), (6, 0));
}
