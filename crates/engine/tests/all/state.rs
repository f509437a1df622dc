//! A state as a value: compared, hashed, saved and read word by word.

use crate::common;

use std::hash::{DefaultHasher, Hash, Hasher};

use common::{Arc, chart};
use g7_engine::{
    Addr, Code, GroupId, ImageError, NONE, Op, Program, Rows, Rules, State, StepId, Tables, scan,
};

/// Steps 0 to 1 behind input 0; two inputs, so step `s` has output word `2 + s`.
fn program() -> Program {
    let arcs = [(vec![0], vec![1], Some(0)), (vec![1], vec![0], Some(1))];
    Program::new(chart(Rules::IEC61131, 2, 2, &[0], &arcs)).expect("tables are sound")
}

fn hash(s: &State) -> u64 {
    let mut h = DefaultHasher::new();
    s.hash(&mut h);
    h.finish()
}

#[test]
fn equal_words_are_equal_states_and_others_are_not() {
    let p = program();
    let (mut a, mut b) = (State::new(&p), State::new(&p));
    assert!(a == b && hash(&a) == hash(&b));
    scan(&p, &mut a, &[1, 0], 0).expect("no fault");
    assert!(a != b);
    assert_ne!(hash(&a), hash(&b));
    scan(&p, &mut b, &[1, 0], 0).expect("no fault");
    assert!(a == b && hash(&a) == hash(&b));
    assert_eq!(a.image(), b.image());
}

#[test]
fn a_single_word_makes_a_difference() {
    let p = program();
    let mut a = State::new(&p);
    scan(&p, &mut a, &[0, 0], 0).expect("no fault");
    let b = a.clone();
    a.set_word(&p, Addr(3), 1);
    assert!(a != b);
    assert_ne!(a.image(), b.image());
}

#[test]
fn the_variable_area_is_inputs_then_outputs() {
    let p = program();
    let mut s = State::new(&p);
    scan(&p, &mut s, &[1, 7], 0).expect("no fault");
    assert_eq!(s.words(), [1, 7, 0, 1]);
    let by_one: Vec<u64> = (0..5).map(|a| s.word(Addr(a))).collect();
    assert_eq!(by_one, [1, 7, 0, 1, 0]);
    s.set_word(&p, Addr(1), 9);
    s.set_word(&p, Addr(4), 9);
    assert_eq!(s.words(), [1, 9, 0, 1]);
}

#[test]
fn bytes_keep_every_bit() {
    let p = program();
    let mut s = State::new(&p);
    let wide = 0x8123_4567_89AB_CDEF;
    scan(&p, &mut s, &[0, wide], 0x0102_0304_0506_0708).expect("no fault");
    let bytes = s.to_bytes();
    assert_eq!(bytes.len(), 8 * s.image().len());
    let back = State::from_bytes(&p, &bytes).expect("its own bytes");
    assert_eq!(back.image(), s.image());
    assert_eq!((back.word(Addr(1)), back.now()), (wide, 0x0102_0304_0506_0708));
    assert_eq!(State::from_bytes(&p, &bytes[1..]).err(), Some(ImageError::Length));
}

#[test]
fn times_run_from_activation_and_stand_after_it() {
    let p = program();
    let mut s = State::new(&p);
    scan(&p, &mut s, &[0, 0], 10).expect("no fault");
    scan(&p, &mut s, &[1, 0], 25).expect("no fault");
    scan(&p, &mut s, &[0, 0], 40).expect("no fault");
    // Step 0 was active from 10 to 25, step 1 is since 25.
    assert_eq!((s.step_time(&p, StepId(0)), s.step_time(&p, StepId(1))), (15, 15));
    assert_eq!((s.step_age(&p, StepId(0)), s.step_age(&p, StepId(1))), (15, 15));
    scan(&p, &mut s, &[0, 0], 70).expect("no fault");
    assert_eq!((s.step_time(&p, StepId(0)), s.step_time(&p, StepId(1))), (15, 45));
    assert!(!s.is_active(StepId(2)) && !s.is_active(StepId(64)) && !s.is_active(StepId(u32::MAX)));
    assert!(!s.group_active(&p, GroupId(1)));
    assert_eq!((s.now(), s.scans()), (70, 4));
}

#[test]
fn a_lean_state_has_no_times_that_nobody_reads() {
    let arcs: Vec<Arc> = (0..1000).map(|i| (vec![i], vec![(i + 1) % 1000], Some(0))).collect();
    let mut tables = chart(Rules::IEC61131, 1000, 1, &[0], &arcs);
    tables.steps.iter_mut().for_each(|step| step.direct = Addr(NONE));
    tables.init.truncate(1);
    tables.outputs = Rows { start: 1, end: 1 };
    tables.safe = Vec::new();
    let bytes = |t: Tables| 8 * State::new(&Program::new(t).expect("tables are sound")).image().len();
    let all = bytes(tables.clone());
    let lean = bytes(Tables { lean: true, ..tables.clone() });
    assert_eq!(all - lean, 8000, "a word for each step");
    assert!(lean < 1000, "{lean} bytes");
    // A time that is read is kept.
    tables.code = vec![Op::StepTime(StepId(7)), Op::Drop];
    tables.pre = Code { start: 0, end: 2 };
    assert_eq!(bytes(Tables { lean: true, ..tables }), lean + 8);
}
