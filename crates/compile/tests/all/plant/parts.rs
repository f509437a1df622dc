//! Queues and tracks of parts.

use super::support::{near, run};

#[test]
fn the_first_in_is_the_first_out() {
    let mut p = run("
        parts Q(c : INT) max 3 := (1), (2)
        state first, last : INT
        state empty, full : BOOL
        on V { Q.enter(3) }
        on W { Q.leave() }
        each { first := Q.first.c  last := Q.last.c  empty := Q.empty  full := Q.full }");
    p.ticks(1);
    assert_eq!((p.int("Q.count"), p.int("first"), p.int("last")), (2, 1, 2));
    assert!(!p.bool("empty") && !p.bool("full"));
    p.output("V", true).ticks(1);
    assert_eq!((p.int("Q.count"), p.int("first"), p.int("last")), (3, 1, 3));
    assert!(p.bool("full"));
    for (left, first) in [(2, 2), (1, 3), (0, 0)] {
        p.output("W", true).ticks(1).output("W", false).ticks(1);
        assert_eq!((p.int("Q.count"), p.int("first")), (left, first));
    }
    assert!(p.bool("empty"));
    assert_eq!(p.int("last"), 0);
    // Nothing leaves an empty queue.
    p.output("W", true).ticks(1);
    assert_eq!(p.int("Q.count"), 0);
}

#[test]
fn the_last_in_can_leave_first() {
    let mut p = run("
        parts Q(c : INT) max 3 := (1), (2), (3)
        state first, last : INT
        each { Q.leave_last()  first := Q.first.c  last := Q.last.c }");
    for (left, first, last) in [(2, 1, 2), (1, 1, 1), (0, 0, 0), (0, 0, 0)] {
        p.ticks(1);
        assert_eq!((p.int("Q.count"), p.int("first"), p.int("last")), (left, first, last));
    }
}

#[test]
fn what_finds_no_room_is_lost() {
    let mut p = run("parts Q(c : INT) max 2 := (7)  each { Q.enter(8) }");
    p.ticks(4);
    assert_eq!((p.int("Q.count"), p.int("Q.lost")), (2, 3));
    assert_eq!((p.int("Q.c.0"), p.int("Q.c.1")), (7, 8));
}

#[test]
fn parts_of_several_attributes_keep_them_together() {
    let mut p = run("
        parts Q(c : INT, w : REAL, ok : BOOL) max 3
        state w : REAL
        state ok : BOOL
        on V { Q.enter(1, 0.5, TRUE)  Q.enter(2, 1.5, FALSE)  Q.leave()  Q.enter(3, 2.5, TRUE) }
        each { w := Q.first.w  ok := Q.last.ok }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!((p.int("Q.c.0"), p.int("Q.c.1"), p.int("Q.c.2")), (2, 3, 0));
    near(p.real("w").into(), 1.5);
    assert!(p.bool("ok"));
}

#[test]
fn parts_without_attributes_are_only_counted() {
    let mut p = run("parts Q() max 5 := (), ()  on V { Q.enter() }  on W { Q.clear() }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!(p.int("Q.count"), 3);
    p.output("W", true).ticks(1);
    assert_eq!(p.int("Q.count"), 0);
}

#[test]
fn parts_on_a_track_move_to_its_ends_and_no_further() {
    let mut p = run("
        parts T(c : INT) max 4 length 1.0 := (1, 0.5), (2)
        rate T := 0.5 when V
        rate T := -1.0 when W");
    p.ticks(1);
    near(p.lreal("T.position.0"), 0.5);
    near(p.lreal("T.position.1"), 0.0);
    p.output("V", true).ticks(50);
    near(p.lreal("T.position.0"), 0.75);
    near(p.lreal("T.position.1"), 0.25);
    p.ticks(100);
    near(p.lreal("T.position.0"), 1.0);
    near(p.lreal("T.position.1"), 0.75);
    p.output("V", false).output("W", true).ticks(200);
    near(p.lreal("T.position.0"), 0.0);
    near(p.lreal("T.position.1"), 0.0);
    // There is no third part to move.
    near(p.lreal("T.position.2"), 0.0);
}

#[test]
fn a_part_is_seen_from_the_begin_of_a_range_to_before_its_end() {
    let mut p = run("
        parts T(c : INT) max 4 length 1.0 := (1, 0.5), (2, 0.25)
        state at, end, gap : BOOL
        state c, none, both : INT
        each {
          at := T.at(0.5, 0.6)
          end := T.at(0.4, 0.5)
          gap := T.at(0.3, 0.45)
          c := T.c(0.2, 0.3)
          none := T.c(0.9, 1.0)
          both := T.c(0.0, 1.0)
        }");
    p.ticks(1);
    assert!(p.bool("at") && !p.bool("end") && !p.bool("gap"));
    assert_eq!((p.int("c"), p.int("none")), (2, 0));
    // Of several, the one that came first.
    assert_eq!(p.int("both"), 1);
}

#[test]
fn one_part_alone_moves_and_is_seen_and_none_on_an_empty_track() {
    let mut p = run("
        parts T(c : INT) max 3 length 1.0 := (7)
        state seen : BOOL
        rate T := 50.0
        each { seen := T.at(0.4, 2.0) }
        on V { T.clear() }");
    p.ticks(1);
    assert!(!p.bool("seen"));
    p.ticks(1);
    near(p.lreal("T.position.0"), 0.5);
    assert!(p.bool("seen"));
    p.output("V", true).ticks(2);
    assert_eq!(p.int("T.count"), 0);
    near(p.lreal("T.position.0"), 0.0);
    assert!(!p.bool("seen"));
}

#[test]
fn a_part_is_taken_out_of_the_middle_and_those_behind_close_up() {
    let mut p = run("
        parts T(c : INT) max 4 length 1.0 := (1, 0.8), (2, 0.5), (3, 0.5), (4, 0.1)
        on V { T.take(0.4, 0.6) }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!(p.int("T.count"), 3);
    assert_eq!((p.int("T.c.0"), p.int("T.c.1"), p.int("T.c.2")), (1, 3, 4));
    near(p.lreal("T.position.2"), 0.1);
    p.output("V", false).ticks(1).output("V", true).ticks(1);
    p.output("V", false).ticks(1).output("V", true).ticks(1);
    // The third time there is none.
    assert_eq!((p.int("T.count"), p.int("T.c.0"), p.int("T.c.1")), (2, 1, 4));
}

#[test]
fn a_part_that_enters_begins_at_zero_wherever_the_one_before_stood() {
    let mut p = run("
        parts T(c : INT) max 2 length 1.0 := (1, 0.9)
        on V { T.leave()  T.enter(2) }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!((p.int("T.count"), p.int("T.c.0")), (1, 2));
    near(p.lreal("T.position.0"), 0.0);
}

#[test]
fn the_values_of_a_part_that_enters_are_those_before_it_does() {
    let mut p = run("parts Q(a : INT, b : INT) max 3 := (1, 2)  on V { Q.enter(Q.last.b, Q.last.a) }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!((p.int("Q.a.1"), p.int("Q.b.1")), (2, 1));
}

#[test]
fn all_parts_of_a_track_go_the_same_way_by_chance_too() {
    let mut p = run("
        parts T(c : INT) max 4 length 100.0 := (1), (2), (3)
        rate T := random(1.0, 2.0)");
    p.seed(5).ticks(100);
    assert!(p.lreal("T.position.0") > 0.99);
    near(p.lreal("T.position.0"), p.lreal("T.position.2"));
}

#[test]
fn the_last_part_of_a_full_track_can_be_taken() {
    let mut p = run("
        parts T(c : INT) max 2 length 1.0 := (1, 0.2), (2, 0.9)
        on V { T.take(0.8, 1.0) }
        on W { T.take(0.0, 1.0) }");
    p.ticks(1).output("V", true).ticks(1);
    assert_eq!((p.int("T.count"), p.int("T.c.0"), p.int("T.c.1")), (1, 1, 0));
    p.output("W", true).ticks(1);
    assert_eq!((p.int("T.count"), p.int("T.c.0")), (0, 0));
}
