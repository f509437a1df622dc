//! Charts at work: what JGrafchart's language reference says of macro-steps with
//! exception transitions, procedures, step fusion sets and what comes from outside.

use crate::support::{Bench, errors, lines, own, read};

fn bench(name: &str) -> Bench {
    let (document, problems) = read("jgrafchart", &own("jgrafchart", name));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}");
    Bench::new(&document)
}

/// The problems of a file.
fn said(name: &str) -> Vec<String> {
    let bytes = own("jgrafchart", name);
    let (_, problems) = read("jgrafchart", &bytes);
    lines(&bytes, &problems)
}

#[test]
fn an_ordinary_transition_waits_for_the_exit_step() {
    let mut b = bench("exceptions.xml");
    assert_eq!(b.set("go", 1).scan().active(), ["Fill", "In"]);
    assert_eq!(b.set("on", 1).scan().active(), ["Fill", "Pump"]);
    assert_eq!(b.scan().active(), ["Fill", "Out"]);
    assert_eq!(b.scan().active(), ["Idle"]);
    // S and X of the step inside, S of the exit step; S and X of the macro-step.
    assert_eq!((b.get("log"), b.get("whole")), (235, 18));
}

#[test]
fn an_exception_leaves_at_any_step_and_runs_the_abortive_actions() {
    let mut b = bench("exceptions.xml");
    b.set("go", 1).scan();
    b.set("on", 1).scan();
    // The transition behind Pump is marked in the same scan; the exception takes it along.
    assert_eq!(b.set("alarm", 1).scan().active(), ["Safe"]);
    assert_eq!((b.get("log"), b.get("whole")), (24, 19));
    assert_eq!(b.scan().active(), ["Safe"]);
    assert_eq!(b.set("alarm", 0).set("go", 0).scan().active(), ["Idle"]);
    assert_eq!((b.get("log"), b.get("whole")), (24, 19));
}

#[test]
fn an_exception_goes_before_an_ordinary_transition_whatever_their_numbers() {
    let mut b = bench("exceptions.xml");
    b.set("go", 1).scan();
    b.set("on", 1).scan().scan();
    assert_eq!(b.active(), ["Fill", "Out"]);
    // The ordinary transition has number 1, the exception 2.
    assert_eq!(b.set("alarm", 1).scan().active(), ["Safe"]);
    // The exit step has no `A`, the macro-step's `X` does not run.
    assert_eq!((b.get("log"), b.get("whole")), (235, 19));
}

#[test]
fn among_exceptions_the_best_number_fires() {
    let mut b = bench("exceptions.xml");
    b.set("go", 1).scan();
    assert_eq!(b.set("alarm", 1).set("stop", 1).scan().active(), ["Still"]);
}

#[test]
fn an_exception_waits_for_its_macro_step() {
    let mut b = bench("exceptions.xml");
    assert_eq!(b.set("alarm", 1).scan().active(), ["Idle"]);
    // Marked against the state before: the macro-step is activated all the same.
    assert_eq!(b.set("go", 1).scan().active(), ["Fill", "In"]);
    assert_eq!(b.scan().active(), ["Safe"]);
}

#[test]
fn an_exception_takes_what_is_nested() {
    let mut b = bench("nested.xml");
    b.set("go", 1).scan();
    b.set("go", 0).scan();
    assert_eq!(b.active(), ["Whole", "Part", "First"]);
    // Both exceptions and the transition inside are marked: the outer one takes all.
    b.set("go", 1).set("inner", 1).set("outer", 1).scan();
    assert_eq!(b.active(), ["Safe"]);
    assert_eq!((b.get("log"), b.get("part")), (46, 2));
}

#[test]
fn an_inner_exception_stays_inside() {
    let mut b = bench("nested.xml");
    b.set("go", 1).scan();
    b.set("go", 0).scan();
    b.set("go", 1).set("inner", 1).scan();
    assert_eq!(b.active(), ["Whole", "Mend"]);
    assert_eq!((b.get("log"), b.get("part")), (45, 2));
}

#[test]
fn each_exit_step_has_its_port() {
    for (input, there) in [("a", "Agreed"), ("b", "Refused")] {
        let mut b = bench("ways-out.xml");
        b.scan().scan();
        b.set(input, 1).scan();
        assert_eq!(b.scan().active(), [there]);
    }
}

#[test]
fn a_procedure_begins_anew_with_each_call() {
    let mut b = bench("procedures.xml");
    assert_eq!(b.set("go", 1).scan().active(), ["One.In"]);
    // The scan behind that of the call leaves the procedure as it is.
    assert_eq!(b.set("go", 0).scan().active(), ["One.In"]);
    assert_eq!(b.scan().active(), ["One.Out"]);
    assert_eq!(b.get("sum"), 1);
    assert_eq!(b.scan().active(), ["More.In"]);
    b.scan().scan();
    assert_eq!(b.get("sum"), 11);
    // The second round: both copies have forgotten the first.
    b.set("go", 1).scan().scan();
    assert_eq!(b.active(), ["One.In"]);
    b.scan().scan().scan().scan().scan();
    assert_eq!(b.get("sum"), 22);
}

#[test]
fn fused_steps_are_one_step() {
    let mut b = bench("fusion.xml");
    assert_eq!(b.set("a", 1).scan().active(), ["Here"]);
    // The actions of both ran, in the order of the set.
    assert_eq!(b.get("log"), 12);
    assert_eq!(b.set("a", 0).set("b", 1).scan().active(), ["Idle"]);
}

#[test]
fn values_of_sockets_and_expressions_are_there_as_the_scan_begins() {
    let mut b = bench("outside.xml");
    b.set("open", 1).set("count", 4).scan();
    assert_eq!(b.active(), ["Warn", "Tick"]);
    assert_eq!((b.get("horn"), b.get("shown"), b.get("late")), (1, 5, 1));
    assert_eq!(b.set("count", 3).scan().active(), ["Idle", "Tick"]);
    // Every third scan is one of `Slow`, from the first one on; its initial step is active before that.
    for _ in 0..8 {
        b.scan();
    }
    assert_eq!(b.get("Slow.ticks"), 4);
}

#[test]
fn what_differs_is_said() {
    assert_eq!(said("exceptions.xml"), Vec::<String>::new());
    assert_eq!(said("nested.xml"), Vec::<String>::new());
    assert_eq!(said("ways-out.xml"), Vec::<String>::new());
    assert_eq!(said("procedures.xml"), Vec::<String>::new());
    assert_eq!(said("fusion.xml"), Vec::<String>::new());
    let sockets = said("outside.xml");
    assert_eq!(sockets.len(), 6, "{sockets:?}");
    assert!(sockets.iter().all(|line| line.starts_with("G0614") && line.contains("the socket is not there")));
}
