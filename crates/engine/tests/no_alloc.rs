//! A scan allocates nothing. The compiler cannot see that; this test can.

mod common;

use allocation_counter::measure;
use common::{Arc, chart};
use g7_engine::{Fault, FaultKind, Program, Rules, State, scan};

/// A fork into three, a join, an OR divergence and a self-loop.
fn arcs() -> Vec<Arc> {
    vec![
        (vec![0], vec![1, 2, 3], Some(0)),
        (vec![1, 2, 3], vec![4], Some(1)),
        (vec![4], vec![0], Some(0)),
        (vec![4], vec![5], Some(1)),
        (vec![5], vec![5], None),
        (vec![5], vec![0], Some(-1)),
    ]
}

#[test]
fn scan_allocates_nothing() {
    for rules in [Rules::IEC60848, Rules::IEC61131, Rules::PL7, Rules::UNITY, Rules::JGRAFCHART] {
        let program = Program::new(chart(rules, 6, 2, &[0], &arcs())).expect("tables are sound");
        let mut state = State::new(&program);
        let mut cleared = 0;
        let counted = measure(|| {
            for k in 0..200i64 {
                let inputs = [(k % 3 == 0) as u64, (k % 3 == 1) as u64];
                // An unstable chart stops; that must not allocate either.
                if let Ok(report) = scan(&program, &mut state, &inputs, k * 1_000_000) {
                    cleared += report.cleared;
                }
            }
        });
        assert_eq!(counted.count_total, 0, "{rules:?}");
        assert!(cleared > 2, "{rules:?}: nothing moved");
    }
}

/// One token that never rests clears far more transitions in a scan than there are.
#[test]
fn a_scan_without_end_allocates_nothing() {
    let ring: Vec<Arc> = vec![(vec![0], vec![1], None), (vec![1], vec![2], None), (vec![2], vec![0], None)];
    let rules = Rules { bound: 10_000, ..Rules::IEC60848 };
    let program = Program::new(chart(rules, 3, 1, &[0], &ring)).expect("tables are sound");
    let mut state = State::new(&program);
    let mut done = None;
    let counted = measure(|| done = Some(scan(&program, &mut state, &[0], 0)));
    assert_eq!(counted.count_total, 0);
    assert!(matches!(done, Some(Err(Fault { kind: FaultKind::Unstable { .. }, .. }))), "{done:?}");
}

/// A search makes millions of these steps: from an image to a state, a scan, and to
/// the canonical image of the successor.
#[test]
fn a_step_of_a_search_allocates_nothing() {
    for rules in [Rules::IEC60848, Rules::IEC61131, Rules::PL7, Rules::UNITY, Rules::JGRAFCHART] {
        let program = Program::new(chart(rules, 6, 2, &[0], &arcs())).expect("tables are sound");
        let mut state = State::new(&program);
        let mut image = Vec::with_capacity(state.image().len());
        state.canonical(&program, &mut image);
        let counted = measure(|| {
            for k in 0..200i64 {
                state.restore(&program, &image).expect("a canonical image");
                let inputs = [(k % 2) as u64, ((k / 2) % 2) as u64];
                scan(&program, &mut state, &inputs, k * 1_000_000).ok();
                state.canonical(&program, &mut image);
            }
        });
        assert_eq!(counted.count_total, 0, "{rules:?}");
    }
}
