//! Runs the loop with small programs made by hand.
#![allow(missing_docs, reason = "a test")]

use g7_engine::{Addr, Arith, Code, FaultKind, Num, Op, Program, Rows, Rules, Tables};
use g7_host::{Coupling, Force, Halt, Runner, Start, Tape, TapeError};
use g7_model::Nanos;

/// A program of four words: input, output, kept, other. Each scan does `output := input`, `kept :=
/// kept + 1`, `other := other + 1`; `kept` is an INT and ends at 32767.
fn counter() -> Program {
    let add = |a| [Op::Load(Addr(a)), Op::Push(1), Op::Arith(Arith::Add, Num::I16), Op::Store(Addr(a))];
    let mut code = vec![Op::Load(Addr(0)), Op::Store(Addr(1))];
    code.extend(add(2));
    code.extend(add(3));
    program(code, vec![0, 0, 0, 0], 1)
}

/// A program that does `output := input + 10`; its output is 3 at the start.
fn adder() -> Program {
    let code = vec![Op::Load(Addr(0)), Op::Push(10), Op::Arith(Arith::Add, Num::I64), Op::Store(Addr(1))];
    program(code, vec![0, 3], 0)
}

fn program(code: Vec<Op>, init: Vec<u64>, safe: u64) -> Program {
    let post = Code { start: 0, end: code.len() as u32 };
    Program::new(Tables {
        rules: Rules::PL7,
        init,
        inputs: Rows { start: 0, end: 1 },
        outputs: Rows { start: 1, end: 2 },
        safe: vec![safe],
        periods: vec![0],
        post,
        code,
        ..Tables::default()
    })
    .expect("tables are sound")
}

/// Time between two scans.
const PERIOD: Nanos = Nanos::new(10);

#[test]
fn scans_come_at_the_period_with_the_inputs_of_then() {
    let program = counter();
    let mut runner = Runner::new(program.clone(), PERIOD);
    for (scan, input) in [(0, 0), (1, 1), (2, 0)] {
        assert_eq!(runner.due(), PERIOD * scan);
        runner.set_input(0, input);
        runner.scan().unwrap();
        assert_eq!((runner.state().now(), runner.outputs()), (scan * 10, &[input][..]));
    }
}

#[test]
fn the_plant_moves_before_the_charts_read() {
    let (charts, plant) = (counter(), adder());
    let coupling = Coupling { to_plant: vec![(0, 0)], to_charts: vec![(0, 0)] };
    let mut runner = Runner::new(charts.clone(), PERIOD).with_plant(plant.clone(), coupling);
    assert!(runner.is_driven(0));
    // The charts' output is 0 before the first scan, so the plant answers 10, which the first scan
    // reads.
    for expected in [10, 20, 30] {
        runner.scan().unwrap();
        assert_eq!(runner.outputs(), [expected]);
    }
}

#[test]
fn missed_scans_are_left_out_and_counted() {
    let program = counter();
    let mut runner = Runner::new(program.clone(), PERIOD);
    runner.scan().unwrap();
    runner.catch_up(Nanos::new(9));
    assert_eq!((runner.due(), runner.missed()), (PERIOD, 0));
    runner.catch_up(Nanos::new(45));
    assert_eq!((runner.due(), runner.missed()), (PERIOD * 4, 3));
    runner.scan().unwrap();
    assert_eq!((runner.state().scans(), runner.due()), (2, PERIOD * 5));
}

#[test]
fn a_forced_input_goes_over_plant_and_user_until_released() {
    let (charts, plant) = (counter(), adder());
    let coupling = Coupling { to_plant: Vec::new(), to_charts: vec![(0, 0)] };
    let mut runner = Runner::new(charts.clone(), PERIOD).with_plant(plant.clone(), coupling);
    runner.force(Force::Input(0), 7);
    runner.scan().unwrap();
    assert_eq!(runner.outputs(), [7]);
    assert!(runner.release(Force::Input(0)));
    assert!(!runner.release(Force::Input(0)));
    runner.scan().unwrap();
    assert_eq!(runner.outputs(), [10]);
}

#[test]
fn a_forced_output_is_seen_outside_and_falls_back_when_released() {
    let program = counter();
    let mut runner = Runner::new(program.clone(), PERIOD);
    runner.set_input(0, 5);
    runner.force(Force::Output(Addr(1)), 9);
    assert_eq!(runner.outputs(), [9], "at once");
    runner.scan().unwrap();
    assert_eq!(runner.outputs(), [9]);
    runner.release(Force::Output(Addr(1)));
    assert_eq!(runner.outputs(), [5], "the charts' own");
}

#[test]
fn a_warm_restart_keeps_what_is_retained_and_a_cold_one_nothing() {
    let program = counter();
    let mut runner =
        Runner::new(program.clone(), PERIOD).with_retained(std::iter::once(2..3).collect()).with_flags(None);
    runner.scan().unwrap();
    runner.scan().unwrap();
    runner.restart(Start::Warm);
    assert_eq!(runner.state().words(), [0, 0, 2, 0]);
    runner.restart(Start::Cold);
    assert_eq!(runner.state().words(), [0, 0, 0, 0]);
    assert_eq!(runner.due(), PERIOD * 2, "time goes on");
}

#[test]
fn after_a_fault_outputs_are_safe_and_scans_refused_until_restart() {
    let program = counter();
    let mut runner = Runner::new(program.clone(), PERIOD);
    runner.set_word(Addr(2), 32767);
    let halt = runner.scan().unwrap_err();
    assert!(matches!(halt, Halt::Charts(f) if f.kind == FaultKind::Overflow));
    assert_eq!(runner.outputs(), [1], "declared safe");
    assert_eq!(runner.scan(), Err(halt));
    runner.restart(Start::Cold);
    assert!(runner.scan().is_ok());
}

#[test]
fn a_tape_plays_back_to_the_same_bytes_and_notices_another_program() {
    let program = counter();
    let mut runner = Runner::new(program.clone(), PERIOD).with_tape();
    for i in 0..50 {
        runner.set_input(0, i % 3);
        if i == 20 {
            runner.set_word(Addr(3), 77);
        }
        if i == 30 {
            runner.restart(Start::Cold);
        }
        runner.scan().unwrap();
    }
    let tape = runner.tape().unwrap();
    let read = Tape::from_text(&tape.to_text()).unwrap();
    assert_eq!(read.to_text(), tape.to_text());
    assert_eq!(read.scans(), 50);
    let mut seen = 0;
    let state = read.replay(&program, |_, _| seen += 1).unwrap();
    assert_eq!((state.to_bytes(), seen), (runner.state().to_bytes(), 50));
    let other = adder();
    assert_eq!(read.replay(&other, |_, _| {}).unwrap_err().scan, 0);
    let why = |text: &str| Tape::from_text(text).unwrap_err();
    for (bad, reason) in [
        ("", TapeError::Other),
        ("time,a\n", TapeError::Other),
        ("g7 tape 2 1\n", TapeError::Version),
        ("g7 tape 3 x", TapeError::Line(1)),
        ("g7 tape 3 1 0\nz\nr\nend 0\n", TapeError::Line(2)),
        ("g7 tape 3 1 0\nr\ns 1", TapeError::Cut(2)),
        ("g7 tape 3 1 0\nr\n", TapeError::Cut(2)),
        ("g7 tape 3 1 0\nr\nend 7\n", TapeError::Line(3)),
    ] {
        assert_eq!(why(bad), reason, "{bad:?}");
    }
    let text = tape.text_about(0xabc);
    assert_eq!(Tape::from_text(&text).unwrap().of(), 0xabc);
    // Wherever it is cut, the record is not taken for a whole one.
    let cuts = (0..text.len()).filter(|at| text.is_char_boundary(*at));
    for at in cuts {
        why(&text[..at]);
    }
}

/// Steps 1 -> 2 -> 3 with receptivities that are always true, under search for stability.
fn transient() -> Program {
    use g7_engine::{NONE, Receptivity, Step, StepId, Transition};
    let none = Rows::default();
    let step = |out: u32| Step {
        out: Rows { start: out.min(2), end: (out + 1).min(2) },
        direct: Addr(NONE),
        extra: NONE,
        chart: 0,
    };
    let go = |from, to| Transition {
        receptivity: Receptivity::True,
        from: StepId(from),
        to: StepId(to),
        more_from: none,
        more_to: none,
        chart: 0,
        on_clearing: NONE,
        shares: false,
        priority: NONE,
        simple: true,
        drops: false,
        uncounted: false,
    };
    Program::new(Tables {
        steps: vec![step(0), step(1), step(2)],
        transitions: vec![go(0, 1), go(1, 2)],
        outs: vec![0, 1],
        initial: vec![StepId(0)],
        charts: vec![g7_engine::Chart { group: g7_engine::GroupId(0), period: 0 }],
        groups: vec![g7_engine::Group { steps: Rows { start: 0, end: 3 }, initial: none, watches: none }],
        periods: vec![0],
        ..Tables::default()
    })
    .expect("tables are sound")
}

#[test]
fn a_scan_made_pass_by_pass_is_the_same_scan() {
    let program = transient();
    let active = |r: &Runner| r.shown().active().map(|s| s.0).collect::<Vec<_>>();
    let mut slow = Runner::new(program.clone(), PERIOD).with_tape();
    assert_eq!((slow.pass(), active(&slow)), (Ok(false), vec![1]));
    assert!(slow.is_within_scan());
    assert_eq!((slow.pass(), active(&slow)), (Ok(false), vec![2]));
    assert_eq!((slow.pass(), active(&slow)), (Ok(true), vec![2]), "a pass that changes nothing ends it");
    assert_eq!(slow.due(), PERIOD);
    let mut fast = Runner::new(program.clone(), PERIOD).with_tape();
    fast.scan().unwrap();
    assert_eq!(slow.state().to_bytes(), fast.state().to_bytes());
    assert_eq!(slow.tape().unwrap().to_text(), fast.tape().unwrap().to_text());
}
