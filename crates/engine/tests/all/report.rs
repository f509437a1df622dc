//! The report of a scan, and the inputs and times that it refuses.

use crate::common;

use common::{Arc, chart};
use g7_engine::{
    Addr, Arith, Cmp, Code, FaultKind, Num, Op, Program, Receptivity, Rules, State, StepId, Tables, scan,
};

/// Three steps in a row behind one input, then a transition that waits.
fn row() -> Vec<Arc> {
    vec![(vec![0], vec![1], Some(0)), (vec![1], vec![2], Some(0)), (vec![2], vec![3], Some(1))]
}

/// The tables themselves, and the same with a PRE that does nothing, which goes
/// the general way.
fn both(rules: Rules) -> [Program; 2] {
    let short = chart(rules, 4, 2, &[0], &row());
    let mut long: Tables = short.clone();
    let start = long.code.len() as u32;
    long.code.extend([Op::Push(0), Op::Drop]);
    long.pre = Code { start, end: start + 2 };
    [short, long].map(|t| Program::new(t).expect("tables are sound"))
}

#[test]
fn a_report_counts_passes_and_clearings() {
    for p in both(Rules::IEC60848) {
        let mut s = State::new(&p);
        // Nothing to clear: one pass, which changes nothing.
        let r = scan(&p, &mut s, &[0, 0], 0).expect("no fault");
        assert_eq!((r.passes, r.cleared, s.cleared()), (1, 0, &[][..]));
        // 0 to 1, 1 to 2, and a pass that changes nothing.
        let r = scan(&p, &mut s, &[1, 0], 5).expect("no fault");
        assert_eq!((r.passes, r.cleared, s.cleared()), (3, 2, &[0, 1][..]));
        assert_eq!(s.active().collect::<Vec<_>>(), [StepId(2)]);
        let r = scan(&p, &mut s, &[1, 0], 6).expect("no fault");
        assert_eq!((r.passes, r.cleared, s.cleared()), (1, 0, &[][..]));
        assert_eq!((s.scans(), s.now()), (3, 6));
    }
    for p in both(Rules::IEC61131) {
        let mut s = State::new(&p);
        let r = scan(&p, &mut s, &[1, 0], 0).expect("no fault");
        assert_eq!((r.passes, r.cleared), (1, 1));
    }
}

#[test]
fn time_does_not_go_back_and_inputs_are_complete() {
    for p in both(Rules::IEC61131) {
        let mut s = State::new(&p);
        scan(&p, &mut s, &[0, 0], 100).expect("no fault");
        // The same instant once more is allowed.
        scan(&p, &mut s, &[1, 0], 100).expect("no fault");
        let mut back = s.clone();
        let fault = scan(&p, &mut back, &[1, 0], 99).expect_err("time went back");
        assert_eq!(fault.kind, FaultKind::Inputs);
        assert!(back.is_stopped());
        let fault = scan(&p, &mut back, &[1, 0], 200).expect_err("stopped");
        assert_eq!(fault.kind, FaultKind::Stopped);
        let fault = scan(&p, &mut s, &[1], 200).expect_err("an input is missing");
        assert_eq!(fault.kind, FaultKind::Inputs);
    }
}

#[test]
fn a_saved_state_goes_on_as_the_first_would() {
    for p in both(Rules::IEC60848) {
        let mut s = State::new(&p);
        scan(&p, &mut s, &[0, 0], 0).expect("no fault");
        let mut copy = State::from_bytes(&p, &s.to_bytes()).expect("its own bytes");
        assert_eq!(copy, s);
        for (k, inputs) in [[1, 0], [0, 0], [0, 1]].iter().enumerate() {
            let now = 10 * (k as i64 + 1);
            assert_eq!(scan(&p, &mut s, inputs, now), scan(&p, &mut copy, inputs, now));
            assert_eq!(copy.image(), s.image());
        }
        assert!(s.is_active(StepId(3)));
        assert!(State::from_bytes(&p, &[0; 3]).is_err());
    }
}

#[test]
fn a_fault_behind_a_quiet_scan_stops_the_program() {
    let mut t = chart(Rules::IEC61131, 2, 2, &[0], &[(vec![0], vec![1], Some(0)), (vec![1], vec![0], None)]);
    // 10 / first input < second input
    t.code = vec![
        Op::Push(10),
        Op::Load(Addr(0)),
        Op::Arith(Arith::Div, Num::I64),
        Op::Load(Addr(1)),
        Op::Compare(Cmp::Lt, Num::I64),
    ];
    t.transitions[0].receptivity = Receptivity::Code(Code { start: 0, end: 5 });
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    for k in 0..4 {
        assert_eq!(scan(&p, &mut s, &[1, 0], k).map(|r| r.cleared), Ok(0));
    }
    assert_eq!(scan(&p, &mut s, &[0, 0], 4).map_err(|f| f.kind).err(), Some(FaultKind::DivisionByZero));
    for inputs in [[0, 0], [1, 0], [1, 20]] {
        assert_eq!(scan(&p, &mut s, &inputs, 5).map_err(|f| f.kind).err(), Some(FaultKind::Stopped));
    }
}
