//! Limits of a controller's tables, periods, and what a debugger does to a state.

use crate::common;

use common::{Arc, chart};
use g7_engine::{
    Addr, Chart, Code, FaultKind, Limits, Op, Program, Rows, Rules, State, StepId, Tables, begin, eval, scan,
    set_step,
};

/// Step 0 forks into 1 and 2 on input 0; step 1 has a transition behind it, step 2 has two.
fn fork() -> Tables {
    let arcs: Vec<Arc> = vec![
        (vec![0], vec![1, 2], Some(0)),
        (vec![1], vec![0], Some(1)),
        (vec![2], vec![0], Some(1)),
        (vec![2], vec![1], Some(1)),
    ];
    chart(Rules::IEC61131, 3, 2, &[0], &arcs)
}

/// The report of a scan that ends with two active steps and three enabled transitions
/// under these limits; and whether the flag (a word behind all others) was set.
fn limited(active: u32, enabled: u32) -> (Option<FaultKind>, u64) {
    let mut t = fork();
    let flag = Addr(t.init.len() as u32);
    t.init.push(0);
    t.limits = Some((flag, Limits { active, enabled }));
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    scan(&p, &mut s, &[0, 0], 0).expect("one step, one transition");
    let fault = scan(&p, &mut s, &[1, 0], 1).err().map(|f| f.kind);
    (fault, s.word(flag))
}

#[test]
fn a_table_may_be_full_but_not_more() {
    assert_eq!(limited(2, 3), (None, 0));
    assert_eq!(limited(1, 3), (Some(FaultKind::Table), 1));
    assert_eq!(limited(2, 2), (Some(FaultKind::Table), 1));
    assert_eq!(limited(9, 1), (Some(FaultKind::Table), 1));
}

#[test]
fn a_chart_with_a_period_evolves_in_the_first_scan_whenever_that_is() {
    for (start, period) in [(-1_000, 100), (0, 100), (5_000, 100), (-1_000, 1)] {
        let mut t = fork();
        // Row 0 is "in each scan".
        t.periods = vec![0, period];
        t.charts[0].period = 1;
        let p = Program::new(t).expect("tables are sound");
        let mut s = State::new(&p);
        let r = scan(&p, &mut s, &[1, 0], start).expect("no fault");
        assert_eq!(r.cleared, 1, "first scan at {start}, period {period}");
    }
}

#[test]
fn periods_run_each_by_itself() {
    let (mut t, own) = (fork(), 3);
    // Chart 1: a copy of chart 0 with steps 3 to 5.
    t.periods = vec![0, 30, 20];
    let more = chart(
        Rules::IEC61131,
        6,
        2,
        &[0, own],
        &[
            (vec![0], vec![1], Some(0)),
            (vec![3], vec![4], Some(0)),
            (vec![1], vec![0], Some(-1)),
            (vec![4], vec![3], Some(-1)),
        ],
    );
    t = Tables { periods: t.periods, ..more };
    t.charts = [1, 2].map(|period| Chart { period, ..t.charts[0] }).to_vec();
    for step in t.steps.iter_mut().skip(3) {
        step.chart = 1;
    }
    for i in [1, 3] {
        t.transitions[i].chart = 1;
    }
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    let mut changed = Vec::new();
    for now in (0..=120).step_by(10) {
        let on = u64::from(now / 10 % 2 == 0);
        let before: Vec<bool> = (0..6).map(|i| s.is_active(StepId(i))).collect();
        scan(&p, &mut s, &[on, 0], now).expect("no fault");
        let differs = |i: usize| s.is_active(StepId(i as u32)) != before[i];
        changed.push((now, differs(1), differs(4)));
    }
    // Input 0 is TRUE at 0, 20, 40, …: a period of 30 sees it change each time, one of
    // 20 sees it TRUE for ever.
    let first: Vec<i64> = changed.iter().filter(|c| c.1).map(|c| c.0).collect();
    let second: Vec<i64> = changed.iter().filter(|c| c.2).map(|c| c.0).collect();
    assert_eq!(first, [0, 30, 60, 90, 120]);
    assert_eq!(second, [0]);
}

#[test]
fn inputs_are_as_many_as_the_programs_and_time_does_not_go_back() {
    let p = Program::new(fork()).expect("tables are sound");
    let fault = |s: &mut State, inputs: &[u64], now| begin(&p, s, inputs, now).err().map(|f| f.kind);
    let mut s = State::new(&p);
    assert_eq!(fault(&mut s, &[0], 10), Some(FaultKind::Inputs));
    assert_eq!(fault(&mut s, &[0, 0, 0], 10), Some(FaultKind::Inputs));
    assert!(!s.is_started());
    scan(&p, &mut s, &[0, 0], 10).expect("no fault");
    assert!(s.is_started() && !s.is_stopped());
    assert_eq!(fault(&mut s, &[0], 20), Some(FaultKind::Inputs));
    assert_eq!(fault(&mut s, &[0, 0], 9), Some(FaultKind::Inputs));
    assert_eq!(fault(&mut s, &[0, 0], 10), None);
}

#[test]
fn code_is_run_on_a_state_as_it_is() {
    let mut t = fork();
    let start = t.code.len() as u32;
    t.code.extend([Op::Load(Addr(0)), Op::Push(1), Op::Xor]);
    let code = Code { start, end: start + 3 };
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    for (input, wanted) in [(0, 1), (1, 0)] {
        scan(&p, &mut s, &[input, 0], input as i64).expect("no fault");
        assert_eq!(eval(&p, &mut s, code), Ok(wanted));
    }
}

#[test]
fn a_step_set_from_outside_is_seen_by_the_next_scan() {
    let p = Program::new(fork()).expect("tables are sound");
    let mut s = State::new(&p);
    scan(&p, &mut s, &[0, 0], 0).expect("no fault");
    let image = s.image().to_vec();
    // A request for the present state, or for a missing step, changes nothing.
    set_step(&p, &mut s, StepId(0), true);
    set_step(&p, &mut s, StepId(1), false);
    set_step(&p, &mut s, StepId(3), true);
    assert_eq!(s.image(), image);
    set_step(&p, &mut s, StepId(1), true);
    assert_eq!(s.active().collect::<Vec<_>>(), [StepId(0), StepId(1)]);
    set_step(&p, &mut s, StepId(0), false);
    assert_eq!(s.active().collect::<Vec<_>>(), [StepId(1)]);
    // The same inputs as before: a scan that nothing else wakes.
    let r = scan(&p, &mut s, &[0, 1], 1).expect("no fault");
    assert_eq!((r.cleared, s.active().collect::<Vec<_>>()), (1, vec![StepId(0)]));
}

#[test]
fn locals_are_gone_when_a_scan_is_over() {
    let mut t = fork();
    let first = t.init.len() as u32;
    t.init.extend([0, 0]);
    t.locals = Rows { start: first, end: first + 2 };
    let start = t.code.len() as u32;
    t.code.extend([Op::Push(5), Op::Store(Addr(first)), Op::Push(6), Op::Store(Addr(first + 1))]);
    t.pre = Code { start, end: start + 4 };
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    scan(&p, &mut s, &[0, 0], 0).expect("no fault");
    assert_eq!([s.word(Addr(first)), s.word(Addr(first + 1))], [0, 0]);
}
