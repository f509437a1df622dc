//! Charts made of tables by hand, for tests that need no compiler.
#![allow(dead_code, reason = "each test file takes what it needs")]

use g7_engine::{
    Addr, Chart, Group, GroupId, NONE, Receptivity, Rows, Rules, Step, StepId, Tables, Transition,
};

/// A transition: preceding steps, succeeding steps, the input it waits for
/// (`None` for TRUE, a negative one for the complement of input `-1 - n`).
pub(crate) type Arc = (Vec<u32>, Vec<u32>, Option<i32>);

/// Tables of one chart of `steps` steps with an output each and BOOL inputs.
pub(crate) fn chart(rules: Rules, steps: u32, inputs: u32, initial: &[u32], arcs: &[Arc]) -> Tables {
    let mut t = Tables { rules, ..Tables::default() };
    t.init = vec![0; (inputs + steps) as usize];
    t.inputs = Rows { start: 0, end: inputs };
    t.outputs = Rows { start: inputs, end: inputs + steps };
    t.safe = vec![0; steps as usize];
    t.periods = vec![0];
    t.groups.push(Group {
        steps: Rows { start: 0, end: steps },
        initial: Rows::default(),
        watches: Rows::default(),
    });
    t.charts.push(Chart { group: GroupId(0), period: 0 });
    t.initial = initial.iter().map(|s| StepId(*s)).collect();
    let mut watched: Vec<Vec<u32>> = vec![Vec::new(); steps as usize];
    let uses = |s: u32| arcs.iter().filter(|(pre, ..)| pre.contains(&s)).count();
    for (rank, (pre, post, waits_for)) in arcs.iter().enumerate() {
        let more = |t: &mut Tables, list: &[u32]| {
            let start = t.arcs.len() as u32;
            t.arcs.extend(list.iter().skip(1).map(|s| StepId(*s)));
            Rows { start, end: t.arcs.len() as u32 }
        };
        let (more_from, more_to) = (more(&mut t, pre), more(&mut t, post));
        match pre.first() {
            Some(first) => watched[*first as usize].push(rank as u32),
            None => t.sources.push(rank as u32),
        }
        t.transitions.push(Transition {
            receptivity: match waits_for {
                None => Receptivity::True,
                Some(i) if *i < 0 => Receptivity::NotWord(Addr((-1 - i) as u32)),
                Some(i) => Receptivity::Word(Addr(*i as u32)),
            },
            from: StepId(pre.first().copied().unwrap_or(NONE)),
            to: StepId(post.first().copied().unwrap_or(NONE)),
            more_from,
            more_to,
            chart: 0,
            on_clearing: NONE,
            shares: pre.iter().any(|s| uses(*s) > 1),
            priority: NONE,
            drops: false,
            uncounted: false,
            simple: pre.first().is_some_and(|first| {
                arcs.iter().filter(|(p, ..)| p.contains(first)).all(|(p, ..)| p.len() == 1)
            }),
        });
    }
    for (s, list) in watched.into_iter().enumerate() {
        let start = t.outs.len() as u32;
        t.outs.extend(list);
        let out = Rows { start, end: t.outs.len() as u32 };
        t.steps.push(Step { out, direct: Addr(inputs + s as u32), extra: NONE, chart: 0 });
    }
    t
}

/// A small generator (splitmix64).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    /// A number below `n`.
    pub(crate) fn below(&mut self, n: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % u64::from(n.max(1))) as u32
    }
}
