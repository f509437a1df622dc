//! The short way for bare programs and the general way agree, scan by scan.

mod common;

use common::{Arc, Chance, chart};
use g7_engine::{Addr, Code, FaultKind, NONE, Op, Program, Rules, State, StepId, Tables, scan, set_step};

/// Up to `n` different steps.
fn some(chance: &mut Chance, n: u32) -> Vec<u32> {
    let mut list: Vec<u32> =
        (0..chance.below(3) + u32::from(chance.below(8) > 0)).map(|_| chance.below(n)).collect();
    list.sort_unstable();
    list.dedup();
    list
}

fn random(chance: &mut Chance, rules: Rules) -> Tables {
    let most = if chance.below(4) == 0 { 200 } else { 9 };
    let steps = 1 + chance.below(most);
    let count = 1 + chance.below(2 * steps);
    let arcs: Vec<Arc> = (0..count)
        .map(|_| {
            let lone = chance.below(2) == 0;
            let (pre, post) = if lone {
                (vec![chance.below(steps)], vec![chance.below(steps)])
            } else {
                (some(chance, steps), some(chance, steps))
            };
            let waits_for = match chance.below(6) {
                0 => None,
                1 => Some(-1 - chance.below(3) as i32),
                _ => Some(chance.below(3) as i32),
            };
            (pre, post, waits_for)
        })
        .collect();
    let initial = some(chance, steps);
    chart(rules, steps, 3, &initial, &arcs)
}

/// The same tables with a PRE that does nothing: enough to leave the short way.
fn with_frame(t: &Tables) -> Tables {
    let mut t = t.clone();
    let start = t.code.len() as u32;
    t.code.extend([Op::Push(0), Op::Drop]);
    t.pre = Code { start, end: start + 2 };
    t
}

/// The image without its first word, which tells the two programs apart.
fn memory(s: &State) -> &[u64] {
    &s.image()[1..]
}

#[test]
fn both_ways_reach_the_same_situations() {
    let mut chance = Chance(7);
    let mut moved = 0u64;
    for round in 0..3000 {
        let rules = if round % 3 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules =
            Rules { multi_token: chance.below(2) == 0, keep_step_time: chance.below(2) == 0, ..rules };
        let tables = random(&mut chance, rules);
        let long = Program::new(with_frame(&tables)).expect("tables are sound");
        let short = Program::new(tables).expect("tables are sound");
        let (mut a, mut b) = (State::new(&short), State::new(&long));
        for k in 0..30 {
            let inputs: Vec<u64> = (0..3).map(|_| u64::from(chance.below(2))).collect();
            let (x, y) = (scan(&short, &mut a, &inputs, k * 7), scan(&long, &mut b, &inputs, k * 7));
            assert_eq!(x.is_ok(), y.is_ok(), "round {round}, scan {k}: {x:?} {y:?}");
            assert_eq!(memory(&a), memory(&b), "round {round}, scan {k}");
            match (x, y) {
                (Ok(x), Ok(y)) => {
                    assert_eq!(x.cleared, y.cleared, "round {round}, scan {k}");
                    // Transitions of one pass clear at once: no order to compare.
                    let sorted = |s: &State| {
                        let mut list = s.cleared().to_vec();
                        list.sort_unstable();
                        list
                    };
                    // A long search cuts the list, in the middle of a pass.
                    if a.cleared().len() == x.cleared as usize {
                        assert_eq!(sorted(&a), sorted(&b), "round {round}, scan {k}");
                    }
                    moved += u64::from(x.cleared);
                }
                (Err(x), Err(y)) => {
                    assert!(matches!(x.kind, FaultKind::Unstable { .. }), "{x:?}");
                    assert_eq!(x, y, "round {round}, scan {k}");
                    break;
                }
                _ => {}
            }
        }
    }
    assert!(moved > 50_000, "only {moved} clearings: the charts stand still and show nothing");
}

/// A chart that one token walks through, near and far; here and there a choice,
/// a fork of two that are joined never, or a step without an output.
fn walk(chance: &mut Chance, rules: Rules) -> Tables {
    let steps = [2, 5, 64, 65, 130, 5000][chance.below(6) as usize];
    let forks = chance.below(8) == 0;
    let mut arcs: Vec<Arc> = Vec::new();
    for from in 0..steps {
        for _ in 0..=u32::from(chance.below(16) == 0) {
            let to = if chance.below(4) == 0 { chance.below(steps) } else { (from + 1) % steps };
            let mut post = vec![to];
            if forks && chance.below(40) == 0 {
                post.push((to + 1) % steps);
            }
            let input = chance.below(3) as i32;
            let waits_for = match chance.below(8) {
                0 => None,
                1 => Some(-1 - input),
                _ => Some(input),
            };
            arcs.push((vec![from], post, waits_for));
        }
    }
    let first = chance.below(steps);
    let mut t = chart(rules, steps, 3, &[first], &arcs);
    for step in &mut t.steps {
        if chance.below(5) == 0 {
            step.direct = Addr(NONE);
        }
    }
    t
}

#[test]
fn a_lone_token_goes_the_same_way() {
    let mut chance = Chance(11);
    let mut lone = 0u64;
    for round in 0..200 {
        let rules = if round % 4 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules = Rules { keep_step_time: chance.below(2) == 0, ..rules };
        let tables = walk(&mut chance, rules);
        let steps = tables.steps.len() as u32;
        let long = Program::new(with_frame(&tables)).expect("tables are sound");
        let short = Program::new(tables).expect("tables are sound");
        let (mut a, mut b) = (State::new(&short), State::new(&long));
        let mut inputs = vec![0; 3];
        for k in 0..60 {
            // Inputs that stand still for a while let the scans be quiet.
            if chance.below(3) > 0 {
                inputs = (0..3).map(|_| u64::from(chance.below(2))).collect();
            }
            if chance.below(30) == 0 {
                let (step, on) = (StepId(chance.below(steps)), chance.below(2) == 0);
                set_step(&short, &mut a, step, on);
                set_step(&long, &mut b, step, on);
            }
            let (x, y) = (scan(&short, &mut a, &inputs, k * 7), scan(&long, &mut b, &inputs, k * 7));
            assert_eq!(
                x.as_ref().map(|r| r.cleared),
                y.as_ref().map(|r| r.cleared),
                "round {round}, scan {k}"
            );
            assert_eq!(memory(&a), memory(&b), "round {round}, scan {k}");
            let Ok(x) = x else { break };
            lone += u64::from(x.cleared == 1 && a.active().count() == 1);
            if x.cleared == 1 {
                assert_eq!(a.cleared(), b.cleared(), "round {round}, scan {k}");
            }
        }
    }
    assert!(lone > 2_500, "only {lone} moves of a lone token");
}
