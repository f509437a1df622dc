//! raw engine timing
#![allow(clippy::disallowed_methods, missing_docs)]
use g7_engine::*;
use std::time::Instant;

fn tables(loops: u32, len: u32) -> Tables {
    let n = loops * len;
    let mut t = Tables::default();
    t.rules = Rules::IEC61131;
    t.init = vec![0; n as usize + 1];
    t.inputs = Rows { start: 0, end: 1 };
    t.outputs = Rows { start: 1, end: n + 1 };
    t.safe = vec![0; n as usize];
    t.periods = vec![0];
    t.groups = vec![Group { steps: Rows { start: 0, end: n }, initial: Rows::default(), watches: Rows::default() }];
    t.charts = vec![Chart { group: GroupId(0), period: 0 }];
    for l in 0..loops {
        for i in 0..len {
            let s = l * len + i;
            t.steps.push(Step { out: Rows { start: s, end: s + 1 }, direct: Addr(1 + s), extra: NONE, chart: 0 });
            t.outs.push(s);
            t.transitions.push(Transition {
                guard: Guard::Word(Addr(0)), from: StepId(s), to: StepId(l * len + (i + 1) % len),
                more_from: Rows::default(), more_to: Rows::default(), chart: 0, on_clearing: NONE, shares: false, priority: NONE, simple: true,
            });
        }
        t.initial.push(StepId(l * len));
    }
    t
}
fn main() {
    for (name, loops, len) in [("linear 10", 1, 10), ("linear 1000", 1, 1000), ("linear 10000", 1, 10000), ("linear 100000", 1, 100_000), ("par 100", 10, 10), ("par 1000", 100, 10)] {
        let p = Program::new(tables(loops, len)).unwrap();
        let mut s = State::new(&p);
        let mut now = 0;
        let mut out = vec![];
        for go in [1u64, 0] {
            let n = 2_000_000 / u64::from(loops).max(1);
            let mut best = f64::MAX;
            for _ in 0..5 {
                let t0 = Instant::now();
                for _ in 0..n { now += 1_000_000; scan(&p, &mut s, &[go], now).unwrap(); }
                best = best.min(t0.elapsed().as_nanos() as f64 / n as f64);
            }
            out.push(best);
        }
        println!("{name}: {:.1} / {:.1}  active {}", out[0], out[1], s.active().count());
    }
}
