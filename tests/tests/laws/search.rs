//! The search of `g7-verify` gives shortest runs that the engine replays, says
//! "never" only where it has seen everything, and else names the bound.

use g7_compile::{Compiled, compile};
use g7_engine::{State, StepId, scan};
use g7_model::FileId;
use g7_verify::{Answer, Bound, Explorer, Inputs, Limits, Moment, Move, Next, Which};

const SECOND: i64 = 1_000_000_000;
const WIDE: Limits = Limits { states: 10_000, scans: 100_000 };

fn chart(text: &str) -> Compiled {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&document);
    compiled.unwrap_or_else(|| panic!("{problems:?}"))
}

/// Searches for a step that is active at the end of a scan.
fn search(c: &Compiled, step: &str, which: Which, waits: &[i64], limits: Limits) -> (Answer, usize) {
    let p = &c.program;
    let wanted: StepId = c.symbols.step(step).expect("a step");
    let inputs = p.tables().inputs;
    let values = vec![vec![0, 1]; (inputs.end - inputs.start) as usize];
    let moves = Inputs::new(p, which, values, waits.to_vec());
    let mut explorer = Explorer::new(p, limits);
    let answer = explorer.search(&moves, |s, moment| (moment == Moment::End && s.is_active(wanted)).into());
    if let Answer::Found(run) = &answer {
        assert!(replay(c, run).is_active(wanted), "the run leads there");
    }
    (answer, explorer.states())
}

fn replay(c: &Compiled, run: &[Move]) -> State {
    let mut state = State::new(&c.program);
    let mut now = 0;
    for m in run {
        now += m.wait;
        scan(&c.program, &mut state, &m.inputs, now).expect("no fault");
    }
    state
}

fn length(answer: &Answer) -> Option<usize> {
    if let Answer::Found(run) = answer { Some(run.len()) } else { None }
}

/// One transition a scan clears under IEC 61131-3: three transitions, three scans,
/// though another way takes more.
#[test]
fn a_shortest_run_is_found() {
    let c = chart(
        "profile iec61131\ninput a, b : BOOL\nchart G {
          initial step 1 { } step 2 { } step 3 { } step 4 { } step 5 { }
          1 -> 2 when a
          2 -> 3 when b and not a
          3 -> 4 when a
          1 -> 5 when b and not a
          5 -> 2 when a }",
    );
    for which in [Which::All, Which::Asked { together: 4 }] {
        let (answer, _) = search(&c, "G.4", which, &[0], WIDE);
        assert_eq!(length(&answer), Some(3), "{which:?}: {answer:?}");
    }
}

/// No run reaches a step behind `a and not a`; who has not tried everything does
/// not say so.
#[test]
fn never_is_said_by_those_who_tried_everything() {
    let c = chart(
        "profile iec61131\ninput a, b : BOOL\nchart G {
          initial step 1 { } step 2 { } step 3 { }
          1 -> 2 when a
          2 -> 1 when b
          2 -> 3 when a and b and not a }",
    );
    assert_eq!(search(&c, "G.3", Which::All, &[0], WIDE).0, Answer::Never);
    let some = Which::Asked { together: 4 };
    assert_eq!(search(&c, "G.3", some, &[0], WIDE).0, Answer::Open(Bound::Moves));
}

/// A clock that is compared with 5 s need not be followed beyond it, so the search
/// ends; five waits of a second lead there.
#[test]
fn time_is_followed_as_far_as_it_is_read() {
    let c = chart(
        "profile iec60848\ninput a : BOOL\nchart G {
          initial step 1 { } step 2 { } step 3 { } step 4 { }
          1 -> 2 when G.X1.t >= 5s and a
          1 -> 3 when 5s/(a)
          2 -> 4 when a and not a
          3 -> 4 when a and not a }",
    );
    let waits = [0, SECOND];
    assert_eq!(length(&search(&c, "G.2", Which::All, &waits, WIDE).0), Some(6));
    // The first scan sees `a`; 5 s later the delay is over.
    assert_eq!(length(&search(&c, "G.3", Which::All, &waits, WIDE).0), Some(6));
    let (answer, states) = search(&c, "G.4", Which::All, &waits, WIDE);
    assert_eq!(answer, Answer::Never);
    assert!(states < 200, "{states} states");
}

/// A counter without end: the search gives up at its bounds and says which.
#[test]
fn bounds_are_told() {
    let c = chart(
        "profile iec61131\ninput a : BOOL\nvar n : LINT\npost { n := n + 1; }\nchart G {
          initial step 1 { } step 2 { }
          1 -> 2 when n < 0 and a }",
    );
    let states = Limits { states: 50, ..WIDE };
    assert_eq!(search(&c, "G.2", Which::All, &[0], states).0, Answer::Open(Bound::States));
    let scans = Limits { scans: 50, ..WIDE };
    assert_eq!(search(&c, "G.2", Which::All, &[0], scans).0, Answer::Open(Bound::Scans));
}

/// Faults are shown too, also that of a chart that never rests.
#[test]
fn faults_are_shown() {
    let c = chart(
        "profile iec60848\ninput a : BOOL\nchart G {
          initial step 1 { } step 2 { }
          1 -> 2 when a
          2 -> 1 when a }",
    );
    let moves = Inputs::new(&c.program, Which::All, vec![vec![0, 1]], vec![0]);
    let mut faults = Vec::new();
    let answer = Explorer::new(&c.program, WIDE).search(&moves, |_, moment| {
        faults.extend(if let Moment::Fault(fault) = moment { Some(fault.kind.word()) } else { None });
        Next::Go
    });
    assert_eq!(answer, Answer::Never);
    assert!(!faults.is_empty() && faults.iter().all(|f| *f == "unstable"), "{faults:?}");
}
