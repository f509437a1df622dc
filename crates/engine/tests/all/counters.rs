//! Counters stop at the ends of INT (IEC 61131-3:2003, 2.5.2.3.3: PVmax and PVmin).

use crate::common;

use common::chart;
use g7_engine::{Addr, Block, Code, Op, Program, Rules, State, eval};

/// The count after one call of an instance whose words are these.
fn counted(block: Block, words: &[i64], cv: usize) -> i64 {
    let mut t = chart(Rules::IEC61131, 1, 0, &[0], &[]);
    t.init = words.iter().map(|w| *w as u64).collect();
    t.outputs = Default::default();
    t.safe = Vec::new();
    t.steps[0].direct = Addr(u32::MAX);
    t.code = vec![Op::Fb(block, Addr(0)), Op::Load(Addr(cv as u32))];
    let code = Code { start: 0, end: 2 };
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    eval(&p, &mut s, code).expect("no fault") as i64
}

#[test]
fn counters_stop_at_the_ends_of_their_type() {
    const UP: i64 = i16::MAX as i64;
    const DOWN: i64 = i16::MIN as i64;
    // CU, R, PV, Q, CV, memory.
    let ctu = |cv| counted(Block::Ctu, &[1, 0, 5, 0, cv, 0], 4);
    assert_eq!((ctu(3), ctu(UP - 1), ctu(UP)), (4, UP, UP));
    // CD, LD, PV, Q, CV, memory.
    let ctd = |cv| counted(Block::Ctd, &[1, 0, 5, 0, cv, 0], 4);
    assert_eq!((ctd(3), ctd(DOWN + 1), ctd(DOWN)), (2, DOWN, DOWN));
    // CU, CD, R, LD, PV, QU, QD, CV, two memories.
    let ctud = |up, down, cv| counted(Block::Ctud, &[up, down, 0, 0, 5, 0, 0, cv, 0, 0], 7);
    assert_eq!((ctud(1, 0, 3), ctud(1, 0, UP - 1), ctud(1, 0, UP)), (4, UP, UP));
    assert_eq!((ctud(0, 1, 3), ctud(0, 1, DOWN + 1), ctud(0, 1, DOWN)), (2, DOWN, DOWN));
    assert_eq!(ctud(1, 1, 3), 3, "both at once count nothing");
}
